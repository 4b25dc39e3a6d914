//! Panels of the boundary: between ends of contact, corners and jumps, short where a singularity is near.

use super::arcs::StickArcs;
use super::complex::distance;
use super::curve::SAME;
use super::jumps::Jumps;
use super::map::{Angle, half_sine};
use super::place::{BoundaryPlace, tangent};
use super::potential::Potential;
use super::rule::{GaussNode, cut};
use crate::problem::complex::Complex;

/// Panels shorter than this are not cut further.
const SHORTEST: f64 = 1e-13;
/// Panels at a vertex on the boundary that are shorter than this are not cut further.
const SHORTEST_AT_VERTEX: f64 = 1e-3;

/// Singularity at a point of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Special {
    /// End of contact, by its number along the boundary.
    End(usize),
    /// Corner of the square.
    Corner,
    /// End of a jump of f.
    Crossing,
}

/// Piece of one side, with a singularity at one end at most.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel {
    /// Corner from which its points are seen.
    pub corner: i32,
    /// Start as a distance from that corner.
    pub from: f64,
    /// End as a distance from that corner.
    pub to: f64,
    /// Singularity at the start or at the end of the panel.
    pub special: Option<Special>,
    /// True if nodes are counted from the end of the panel, because the singularity is there.
    pub reversed: bool,
    /// Number of contact arcs that begin before the panel or at its start.
    pub arcs: usize,
    pub contact: bool,
    pub tangent: Complex,
    /// dv/dn on the panel if it slips; if it sticks, dv/dn on the gap at its end of contact, zero without one.
    pub flux: f64,
}

/// Number of nodes that are treated side by side.
pub(super) const LANES: usize = 8;

/// Rule on (0, 1), graded like `x^power` towards the singularity of a panel.
#[derive(Clone, Copy)]
pub(super) struct GradedRule<'a> {
    pub nodes: &'a [GaussNode],
    pub power: i32,
}

/// Quadrature nodes of a panel; if there are fewer, the last one is repeated.
#[derive(Clone, Copy, Default)]
pub(super) struct Nodes {
    /// Distances from the panel's corner.
    pub t: [f64; LANES],
    /// Distances from the end of the panel at which the singularity is.
    pub offset: [f64; LANES],
    /// Weights with respect to the length of the boundary.
    pub weight: [f64; LANES],
    /// Sines of the halves of their angles.
    pub sin: [f64; LANES],
    /// Cosines of the halves of their angles.
    pub cos: [f64; LANES],
    /// Derivatives of their angles along the boundary.
    pub slope: [f64; LANES],
}

impl Nodes {
    pub(super) fn angle(&self, k: usize) -> Angle {
        Angle { sin: self.sin[k], cos: self.cos[k], slope: self.slope[k] }
    }
}

impl Panel {
    /// Direction in which derivatives of psi enter: the tangent in contact, the inner normal elsewhere.
    pub(super) fn direction(&self) -> Complex {
        if self.contact { self.tangent } else { self.tangent.turned() }
    }

    /// Vector by which the constant vector that a target at `t` subtracts differs from the gradient of psi there.
    ///
    /// The part along the inner normal is the flux, as in the data. Beside an end of contact the vector has no other
    /// part, so that nothing jumps at the end; on other panels that slip it is the flux times `-2 z`, which does not
    /// jump at corners.
    pub(super) fn shift(&self, t: f64) -> Complex {
        let normal = self.tangent.turned().scaled(self.flux);
        if self.contact || self.end().is_some() {
            return normal;
        }
        let along = self.place(t).point().dot(self.tangent);
        normal - self.tangent.scaled(2.0 * self.flux * along)
    }

    pub(super) fn place(&self, t: f64) -> BoundaryPlace {
        BoundaryPlace { corner: self.corner, t }
    }

    /// Distance from the panel's corner of a place that is at most two sides away.
    pub(super) fn local(&self, place: BoundaryPlace) -> f64 {
        let corners = (place.corner - self.corner + 1).rem_euclid(4) - 1;
        place.t + f64::from(corners)
    }

    /// Distance of a place from the panel along the boundary, not positive on the panel.
    pub(super) fn distance(&self, place: BoundaryPlace) -> f64 {
        let t = self.local(place);
        (self.from - t).max(t - self.to)
    }

    /// Number of the end of contact at one end of the panel, if there is one.
    pub(super) fn end(&self) -> Option<usize> {
        match self.special {
            Some(Special::End(end)) => Some(end),
            _ => None,
        }
    }

    /// Corner or crossing at one end of the panel, if there is one.
    pub(super) fn kink(&self) -> Option<Special> {
        self.special.filter(|s| !matches!(s, Special::End(_)))
    }

    /// Power for the grading of targets: v and l behave like a power of the distance from an end of contact, and
    /// their series next to corners and crossings contain logarithms.
    pub(super) fn target_power(&self) -> i32 {
        match self.special {
            None => 1,
            Some(Special::End(_)) => 2,
            Some(_) => 3,
        }
    }

    /// Nodes of a rule, or of the first [`LANES`] nodes of it.
    #[inline(always)]
    pub(super) fn nodes(&self, rule: GradedRule) -> Nodes {
        let length = self.to - self.from;
        let (start, sign) = if self.reversed { (self.to, -1.0) } else { (self.from, 1.0) };
        let mut nodes = Nodes::default();
        for k in 0..LANES {
            let GaussNode { x, weight } = rule.nodes[k.min(rule.nodes.len() - 1)];
            let (scale, slope) = match rule.power {
                1 => (x, 1.0),
                2 => (x * x, 2.0 * x),
                _ => (x * x * x, 3.0 * x * x),
            };
            nodes.offset[k] = length * scale;
            nodes.weight[k] = length * slope * weight;
        }
        for k in 0..LANES {
            nodes.t[k] = start + sign * nodes.offset[k];
            let angle = Angle::from_corner(nodes.t[k]);
            (nodes.sin[k], nodes.cos[k], nodes.slope[k]) = (angle.sin, angle.cos, angle.slope);
        }
        nodes
    }
}

/// Ends of contact.
pub(super) struct Ends {
    /// Beginnings and ends of contact in turn, anticlockwise.
    pub places: Vec<BoundaryPlace>,
    /// Their angles, each from its own corner.
    pub angles: Vec<Angle>,
    /// dv/dn on the gap after each arc.
    pub flux: Vec<f64>,
}

impl Ends {
    /// Takes the places, with corners counted on from the first place.
    pub(super) fn new(StickArcs { mut places, flux }: StickArcs) -> Self {
        if let Some(&first) = places.first() {
            for place in &mut places[1..] {
                *place = place.following(first);
            }
        }
        let angles = places.iter().map(|place| Angle::from_corner(place.t)).collect();
        Self { places, angles, flux }
    }

    /// The arcs without the angles.
    pub(super) fn arcs_and_flux(&self) -> StickArcs {
        StickArcs { places: self.places.clone(), flux: self.flux.clone() }
    }

    /// Number of contact arcs; none stands for contact everywhere.
    pub(super) fn arcs(&self) -> usize {
        self.places.len() / 2
    }

    /// dv/dn on the gap at the `j`-th end.
    pub(super) fn flux_at(&self, j: usize) -> f64 {
        let arcs = self.arcs();
        // Before a beginning lies the gap after the arc before.
        self.flux[(j.div_ceil(2) + arcs - 1) % arcs]
    }

    /// Place at which the first panel begins.
    pub(super) fn start(&self) -> BoundaryPlace {
        self.places.first().copied().unwrap_or(BoundaryPlace { corner: 0, t: 0.0 })
    }

    /// (-1)^k |P|^{1/2} at nodes of a panel, P the product over all ends of 2 sin((theta - end) / 2).
    #[inline(always)]
    pub(super) fn roots(&self, panel: &Panel, nodes: &Nodes) -> [f64; LANES] {
        let mut product = [1.0; LANES];
        for (j, (place, angle)) in self.places.iter().zip(&self.angles).enumerate() {
            if panel.end() == Some(j) {
                // Relative to a distance that is not known from the angles.
                let end = place.distance_from(panel.corner);
                let reversed = panel.reversed;
                for (product, &offset) in product.iter_mut().zip(&nodes.offset) {
                    let t = if reversed { end } else { end + offset };
                    *product *= 2.0 * half_sine(t, offset);
                }
            } else {
                let [sin, cos] = angle.seen_from(place.corner - panel.corner);
                for (product, (s, c)) in product.iter_mut().zip(nodes.sin.iter().zip(&nodes.cos)) {
                    *product *= 2.0 * (s * cos - c * sin);
                }
            }
        }
        let sign = if panel.arcs % 2 == 1 { -1.0 } else { 1.0 };
        product.map(|p| sign * p.abs().sqrt())
    }
}

/// Singularity of the solution at a point of the boundary.
#[derive(Clone, Copy)]
struct Break {
    place: BoundaryPlace,
    special: Special,
}

/// Ends of contact, and corners and crossings that are not at one of them, in order.
fn breaks(ends: &Ends, crossings: &[Complex]) -> Vec<Break> {
    let start = ends.start();
    let mut breaks = Vec::new();
    for (j, &place) in ends.places.iter().enumerate() {
        breaks.push(Break { place, special: Special::End(j) });
    }
    let corners = [0, 1, 2, 3].map(|corner| BoundaryPlace { corner, t: 0.0 });
    let corners = corners.map(|place| Break { place, special: Special::Corner });
    let crossings = crossings.iter().map(|&z| BoundaryPlace::nearest(z));
    let crossings = crossings.map(|place| Break { place, special: Special::Crossing });
    for Break { place, special } in corners.into_iter().chain(crossings) {
        let place = place.following(start);
        let z = place.point();
        if breaks.iter().all(|other| (other.place.point() - z).norm() > SHORTEST) {
            breaks.push(Break { place, special });
        }
    }
    breaks.sort_by(|a, b| a.place.after(start).total_cmp(&b.place.after(start)));
    breaks
}

/// Part of the boundary from one singularity to the next.
struct Stretch {
    from: BoundaryPlace,
    to: BoundaryPlace,
    length: f64,
    /// Numbers of the singularities at its ends.
    ends: [usize; 2],
}

impl Stretch {
    /// Place at a distance from the start, seen from the corner of the nearer end.
    fn place(&self, s: f64) -> BoundaryPlace {
        match s <= 0.5 * self.length {
            true => BoundaryPlace::new(self.from.corner, self.from.t + s),
            false => BoundaryPlace::new(self.to.corner, self.to.t - (self.length - s)),
        }
    }

    /// Place at which to cut a part of the stretch, if the part cannot be a panel.
    ///
    /// No panel has singularities at both ends, or is longer than twice its distance to a vertex, or to a singularity
    /// that is not at an end of it. If it has a singularity at an end, nodes are sparse at the other end, and it must
    /// not be longer than its distance to a vertex.
    fn cut(&self, [a, b]: [f64; 2], points: &[Complex], psi: &Potential) -> Option<f64> {
        let (length, middle) = (b - a, 0.5 * (a + b));
        let segment = [a, b].map(|s| self.place(s).point());
        let own = [(a == 0.0).then_some(self.ends[0]), (b == self.length).then_some(self.ends[1])];
        let both = own == self.ends.map(Some);
        if length <= SHORTEST {
            return None;
        }
        let mut others = points.iter().enumerate().filter(|&(k, _)| !own.contains(&Some(k)));
        let near = others.find(|&(_, &z)| length > 2.0 * distance(segment, z));
        if let Some((_, &z)) = near.filter(|_| !both) {
            let [before, after] = segment.map(|end| (end - z).norm());
            let piece = (2.0 * before.min(after)).max(SHORTEST);
            let beside = if before < after { a + piece } else { b - piece };
            return Some(if piece < 0.5 * length { beside } else { middle });
        }
        let longest = if own == [None; 2] { 2.0 } else { 1.0 };
        let along = [segment[0], (segment[0] + segment[1]).scaled(0.5), segment[1]];
        let is_too_long = psi.singular(along).any(|v| {
            // A vertex at such an end, where two jumps meet on the boundary, is left to the grading of nodes.
            let at_end = (0..2).any(|k| own[k].is_some() && (segment[k] - v).norm() < 10.0 * SAME);
            length > longest * distance(segment, v) && (length > SHORTEST_AT_VERTEX || !at_end)
        });
        (both || is_too_long).then_some(middle)
    }
}

/// Panels, in order from the first end of contact on.
pub(super) fn panels(ends: &Ends, Jumps { crossings, psi, .. }: &Jumps) -> Vec<Panel> {
    let breaks = breaks(ends, crossings);
    let points: Vec<Complex> = breaks.iter().map(|at| at.place.point()).collect();
    let (mut panels, mut arcs, mut contact) = (Vec::new(), 0, ends.arcs() == 0);
    for (k, &Break { place: from, special }) in breaks.iter().enumerate() {
        if let Special::End(j) = special {
            contact = j % 2 == 0;
            arcs += usize::from(contact);
        }
        let next = (k + 1) % breaks.len();
        let Break { place: mut to, special: other } = breaks[next];
        to.corner += if next == 0 { 4 } else { 0 };
        let length = to.after(from);
        let stretch = Stretch { from, to, length, ends: [k, next] };
        for [a, b] in cut([0.0, length], |part| stretch.cut(part, &points, psi)) {
            let corner = stretch.place(0.5 * (a + b)).corner;
            let [from, to] = [a, b].map(|s| stretch.place(s).distance_from(corner));
            let tangent = tangent(corner, from + to);
            let reversed = b == length;
            let special = if a == 0.0 { Some(special) } else { reversed.then_some(other) };
            let flux = match special {
                Some(Special::End(j)) => ends.flux_at(j),
                _ if contact => 0.0,
                _ => ends.flux[arcs - 1],
            };
            panels.push(Panel {
                corner,
                from,
                to,
                special,
                reversed,
                arcs,
                contact,
                tangent,
                flux,
            });
        }
    }
    panels
}
