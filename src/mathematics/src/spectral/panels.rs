//! Panels of the border: between ends of contact, corners and jumps, short where something is near.

use super::complex::{Complex, distance};
use super::curve::SAME;
use super::jumps::Jumps;
use super::map::{Angle, half_sine};
use super::place::{BorderPlace, tangent};
use super::potential::Potential;
use super::rule::cut;

/// Panels shorter than this are not cut further.
const SHORTEST: f64 = 1e-13;
/// Panels at a vertex on the border.
const SHORTEST_AT_VERTEX: f64 = 1e-3;

/// Singularity at a point of the border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Special {
    /// An end of contact, by its number along the border.
    End(usize),
    Corner,
    /// A jump of f ends here.
    Crossing,
}

/// A piece of one side, with something particular at one end at most.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel {
    /// Corner from which its points are seen.
    pub corner: i32,
    /// Ends as distances from that corner.
    pub from: f64,
    pub to: f64,
    /// Singularity at its start, or at its end.
    pub special: Option<Special>,
    /// True if nodes are counted from the end of the panel, where something is, rather than from its start.
    pub reversed: bool,
    /// Contact arcs begun before it.
    pub arcs: usize,
    pub contact: bool,
    pub tangent: Complex,
}

/// Nodes that are treated side by side.
pub(super) const LANES: usize = 8;

/// Quadrature nodes of a panel; the last one fills what is left.
#[derive(Clone, Copy, Default)]
pub(super) struct Nodes {
    /// Distances from the panel's corner.
    pub t: [f64; LANES],
    /// Distances from the end of the panel where something is.
    pub offset: [f64; LANES],
    /// Weights with respect to the length of the border.
    pub weight: [f64; LANES],
    /// Sines, cosines and slopes of their angles.
    pub sin: [f64; LANES],
    pub cos: [f64; LANES],
    pub slope: [f64; LANES],
}

impl Nodes {
    pub(super) fn angle(&self, k: usize) -> Angle {
        Angle { sin: self.sin[k], cos: self.cos[k], slope: self.slope[k] }
    }
}

impl Panel {
    /// The direction in which derivatives of psi enter: the tangent in contact, the inner normal elsewhere.
    pub(super) fn direction(&self) -> Complex {
        if self.contact { self.tangent } else { self.tangent.turned() }
    }

    pub(super) fn place(&self, t: f64) -> BorderPlace {
        BorderPlace { corner: self.corner, t }
    }

    /// The end of contact at one of its ends, if any.
    pub(super) fn end(&self) -> Option<usize> {
        match self.special {
            Some(Special::End(end)) => Some(end),
            _ => None,
        }
    }

    /// True if a corner or crossing is at one of its ends.
    pub(super) fn kink(&self) -> Option<Special> {
        self.special.filter(|s| !matches!(s, Special::End(_)))
    }

    /// Grading of targets: v and l behave like a power of the distance from an end of contact, and
    /// their series next to corners and crossings contain logarithms.
    pub(super) fn target_power(&self) -> i32 {
        match self.special {
            None => 1,
            Some(Special::End(_)) => 2,
            Some(_) => 3,
        }
    }

    /// Nodes of a part of a rule on (0, 1), graded like `x^power` towards the end where something is.
    #[inline(always)]
    pub(super) fn nodes(&self, rule: &[[f64; 2]], power: i32) -> Nodes {
        let length = self.to - self.from;
        let (start, sign) = if self.reversed { (self.to, -1.0) } else { (self.from, 1.0) };
        let mut nodes = Nodes::default();
        for k in 0..LANES {
            let [x, w] = rule[k.min(rule.len() - 1)];
            let (scale, slope) = match power {
                1 => (x, 1.0),
                2 => (x * x, 2.0 * x),
                _ => (x * x * x, 3.0 * x * x),
            };
            nodes.offset[k] = length * scale;
            nodes.weight[k] = length * slope * w;
        }
        for k in 0..LANES {
            nodes.t[k] = start + sign * nodes.offset[k];
            let angle = Angle::from_corner(nodes.t[k]);
            (nodes.sin[k], nodes.cos[k], nodes.slope[k]) = (angle.sin, angle.cos, angle.slope);
        }
        nodes
    }
}

/// The ends of contact, seen from all corners.
pub(super) struct Ends {
    /// Beginnings and ends of contact in turn, anticlockwise.
    pub places: Vec<BorderPlace>,
    pub angles: Vec<Angle>,
}

impl Ends {
    /// Their corners are counted on from the first.
    pub(super) fn new(mut places: Vec<BorderPlace>) -> Self {
        if let Some(&first) = places.first() {
            places[1..].iter_mut().for_each(|place| *place = place.following(first));
        }
        let angles = places.iter().map(|place| Angle::from_corner(place.t)).collect();
        Self { places, angles }
    }

    /// Number of contact arcs; none stands for contact everywhere.
    pub(super) fn arcs(&self) -> usize {
        self.places.len() / 2
    }

    /// Beginnings of panels.
    pub(super) fn start(&self) -> BorderPlace {
        self.places.first().copied().unwrap_or(BorderPlace { corner: 0, t: 0.0 })
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

/// The ends of contact with corners and crossings that are none of them, in order.
fn breaks(ends: &Ends, crossings: &[BorderPlace]) -> Vec<(BorderPlace, Special)> {
    let start = ends.start();
    let mut breaks: Vec<(BorderPlace, Special)> =
        ends.places.iter().enumerate().map(|(j, &place)| (place, Special::End(j))).collect();
    let apart = |breaks: &[(BorderPlace, Special)], z: Complex| {
        breaks.iter().all(|(other, _)| (other.point() - z).norm() > SHORTEST)
    };
    let corners = (0..4).map(|corner| (BorderPlace { corner, t: 0.0 }, Special::Corner));
    let crossings = crossings.iter().map(|&place| (place, Special::Crossing));
    for (place, special) in corners.chain(crossings) {
        let place = place.following(start);
        if apart(&breaks, place.point()) {
            breaks.push((place, special));
        }
    }
    breaks.sort_by(|a, b| a.0.after(start).total_cmp(&b.0.after(start)));
    breaks
}

/// The border from one particular point to the next.
struct Stretch {
    from: BorderPlace,
    to: BorderPlace,
    length: f64,
    /// The numbers of the points at its ends.
    ends: [usize; 2],
}

impl Stretch {
    /// The place at a distance from its start, seen from the corner of the nearer end.
    fn place(&self, s: f64) -> BorderPlace {
        match s <= 0.5 * self.length {
            true => BorderPlace::new(self.from.corner, self.from.t + s),
            false => BorderPlace::new(self.to.corner, self.to.t - (self.length - s)),
        }
    }

    /// Place at which to cut a part of it, if that cannot be a panel.
    ///
    /// No panel has something at both ends, or is longer than twice its distance to a vertex, or to a point where
    /// something is and that is not an end of it; if it has something at an end, nodes are sparse at the other,
    /// and it must not be longer than its distance to a vertex.
    fn cut(&self, [a, b]: [f64; 2], points: &[Complex], psi: &Potential) -> Option<f64> {
        let (length, middle) = (b - a, 0.5 * (a + b));
        let segment = [a, b].map(|s| self.place(s).point());
        let own = [(a == 0.0).then_some(self.ends[0]), (b == self.length).then_some(self.ends[1])];
        let both = own == self.ends.map(Some);
        if length <= SHORTEST {
            return None;
        }
        let is_near = |&(k, &z): &(usize, &Complex)| {
            !own.contains(&Some(k)) && length > 2.0 * distance(segment, z)
        };
        if let Some((_, &z)) = points.iter().enumerate().find(is_near).filter(|_| !both) {
            let [before, after] = segment.map(|end| (end - z).norm());
            let piece = (2.0 * before.min(after)).max(SHORTEST);
            let beside = if before < after { a + piece } else { b - piece };
            return Some(if piece < 0.5 * length { beside } else { middle });
        }
        let longest = if own == [None; 2] { 2.0 } else { 1.0 };
        let along = [segment[0], (segment[0] + segment[1]).scaled(0.5), segment[1]];
        // A vertex at such an end, where two jumps meet on the border, is left to the grading of nodes.
        let at_end =
            |v: Complex| (0..2).any(|k| own[k].is_some() && (segment[k] - v).norm() < 10.0 * SAME);
        let near = |v| {
            length > longest * distance(segment, v) && (length > SHORTEST_AT_VERTEX || !at_end(v))
        };
        (both || psi.singular(along).any(near)).then_some(middle)
    }
}

/// The panels, in order from the first end of contact on.
pub(super) fn panels(ends: &Ends, Jumps { crossings, psi, .. }: &Jumps) -> Vec<Panel> {
    let breaks = breaks(ends, crossings);
    let points: Vec<Complex> = breaks.iter().map(|(place, _)| place.point()).collect();
    let (mut panels, mut arcs, mut contact) = (Vec::new(), 0, ends.arcs() == 0);
    for (k, &(from, special)) in breaks.iter().enumerate() {
        if let Special::End(j) = special {
            contact = j % 2 == 0;
            arcs += usize::from(contact);
        }
        let next = (k + 1) % breaks.len();
        let (mut to, other) = breaks[next];
        to.corner += if next == 0 { 4 } else { 0 };
        let length = to.after(from);
        let stretch = Stretch { from, to, length, ends: [k, next] };
        for [a, b] in cut([0.0, length], |part| stretch.cut(part, &points, psi)) {
            let corner = stretch.place(0.5 * (a + b)).corner;
            let [from, to] = [a, b].map(|s| stretch.place(s).distance_from(corner));
            let tangent = tangent(corner, from + to);
            let reversed = b == length;
            let special = if a == 0.0 { Some(special) } else { reversed.then_some(other) };
            panels.push(Panel { corner, from, to, special, reversed, arcs, contact, tangent });
        }
    }
    panels
}
