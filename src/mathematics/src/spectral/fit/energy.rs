//! Energy and moments, from integrals over the boundary and along the jumps of f.
//!
//! All is on the boundary and on jumps:
//! ```text
//! int f v = int f psi + oint (psi l - v psi_n),     int f psi for each piece of f by a quadratic function:
//! J(v)    = 1/2 oint v l - 1/2 int f v - int over gaps of q v.
//! ```
//! on the boundary by `|x|^2 / 4` from the middle of the domain, along jumps by [`quadratic`].
//!
//! A crossing of f that is joined with a split has f of another interval on the piece between both; the change is
//! added, by the integrand in the middle of the piece ([`JoinedPiece`]).
//!
//! J(v) less the integral of v l where v should be zero has an error that is quadratic in the residual.

use super::field::PlaneNode;
use crate::problem::complex::Complex;
use crate::spectral::fit::Fit;
use crate::spectral::geometry::boundary::{JoinedPiece, State, Walk};
use crate::spectral::geometry::curve::Arc;
use crate::spectral::geometry::rule::{GaussNode, gauss, halved};
use crate::spectral::setup::Setup;
use crate::spectral::source::groups::{GroupEdge, PieceSide};
use crate::spectral::source::psi::Psi;
use crate::spectral::source::quadratic::Quadratic;

/// Integrals.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::spectral) struct Integrals {
    /// J(v), less the integral of v l where v should be zero.
    pub energy: f64,
    /// J(v).
    pub plain: f64,
    /// Integral of f.
    pub source: f64,
    /// Integral of dv/dn over the boundary.
    pub force: f64,
    /// Integral of f v.
    pub work: f64,
    /// Integral of v dv/dn over the boundary.
    pub flux_work: f64,
    /// That where v should be zero.
    held: f64,
    /// Integral of q v where dv/dn should be q.
    slipping: f64,
}

impl Integrals {
    pub(in crate::spectral) fn new(setup: &Setup, fit: &Fit, nodes: &[PlaneNode]) -> Self {
        let mut sums = Self::on_boundary(setup, fit, nodes);
        sums.add_jumps(setup);
        for piece in fit.walk.joined_pieces() {
            sums.add_joined(setup, &fit.walk, piece);
        }
        sums.completed()
    }

    /// The part of the boundary.
    pub(in crate::spectral) fn on_boundary(setup: &Setup, fit: &Fit, nodes: &[PlaneNode]) -> Self {
        let mut sums = Self::default();
        let all = Quadratic::round(setup.centre);
        for node in nodes {
            let weight = node.spot.weight;
            let (z, f) = (node.spot.z, fit.walk.intervals[node.spot.interval].f);
            sums.force += weight * node.flux;
            sums.flux_work += weight * node.value * node.flux;
            sums.work += weight * (node.psi * node.flux - node.value * node.psi_flux);
            match &setup.jumps.psi {
                Psi::Jumps(_) => {
                    let own = BorderPoint {
                        z,
                        normal: node.normal().scaled(weight),
                        psi: node.psi,
                        psi_flux: weight * node.psi_flux,
                    };
                    sums.add_side(PieceSide::of_jump(all, [f, 0.0]), own);
                }
                Psi::Polynomial(f) => {
                    sums.source += weight * z.dot(node.normal()) * f.radial(z);
                    sums.work += weight * z.dot(node.normal()) * f.radial_with_psi(z);
                }
            }
            match node.state {
                State::Held => sums.held += weight * node.value * node.flux,
                State::Flux(q) => sums.slipping += weight * q * node.value,
            }
        }
        sums
    }

    /// With the energy, from all other integrals.
    pub(in crate::spectral) fn completed(mut self) -> Self {
        self.plain = 0.5 * self.flux_work - 0.5 * self.work - self.slipping;
        self.energy = self.plain - self.held;
        self
    }

    /// Adds what f beside a piece changes in the part of the boundary.
    pub(in crate::spectral) fn add_joined(
        &mut self,
        setup: &Setup,
        walk: &Walk,
        piece: JoinedPiece,
    ) {
        let (JoinedPiece { f, counted, span: [from, to], .. }, length) = (piece, piece.length());
        let split = &walk.splits[piece.split];
        let ring = &setup.rings[split.ring];
        let place = ring.place(split.t + 0.5 * (from + to));
        let side = &ring.sides[place.side];
        let (z, normal) = (side.point(place.s), -side.tangent(place.s).turned());
        let psi = &setup.jumps.psi;
        let own = BorderPoint::new(psi.value(z), psi.gradients(&[z])[0], z, normal.scaled(length));
        self.add_side(PieceSide::of_jump(Quadratic::round(setup.centre), [f, counted]), own);
    }

    fn add_jumps(&mut self, setup: &Setup) {
        let rule = gauss(32);
        for group in &setup.jumps.groups {
            for own in &group.edges {
                let curve = own.edge.arc.curve;
                let (mut points, mut normals) = (Vec::new(), Vec::new());
                for [from, to] in pieces(setup, group.middle, own.edge.arc) {
                    for &GaussNode { x, weight } in rule {
                        // Short steps at both ends.
                        let part = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
                        let slope = 30.0 * x * x * (1.0 - x) * (1.0 - x);
                        let s = from + (to - from) * part;
                        points.push(curve.at(s));
                        let length = weight * slope * (to - from);
                        normals.push((-curve.direction(s).turned()).scaled(length));
                    }
                }
                let (values, gradients) = (group.psi.values(&points), group.psi.gradients(&points));
                self.add_jump(own, [&points, &normals], (&values, &gradients));
            }
        }
    }

    /// Adds the part of a jump, by points with normals to the right as long as their weights, and psi with its
    /// gradients there.
    pub(in crate::spectral) fn add_jump(
        &mut self,
        edge: &GroupEdge,
        [points, normals]: [&[Complex]; 2],
        (values, gradients): (&[f64], &[Complex]),
    ) {
        for (i, &z) in points.iter().enumerate() {
            let own = BorderPoint::new(values[i], gradients[i], z, normals[i]);
            edge.sides.iter().for_each(|&side| self.add_side(side, own));
        }
    }

    /// Adds a point of the border of a piece of f.
    fn add_side(&mut self, PieceSide { quadratic, f, square }: PieceSide, own: BorderPoint) {
        let outward = (own.z - quadratic.centre).dot(own.normal);
        let (value, slope) = quadratic.at(own.z);
        self.source += 0.5 * f * outward;
        self.work += f * (own.psi * slope.dot(own.normal) - value * own.psi_flux)
            - 0.25 * square * outward * value;
    }
}

/// Point of a border of f.
#[derive(Clone, Copy)]
struct BorderPoint {
    z: Complex,
    /// Normal as long as the weight of the point.
    normal: Complex,
    psi: f64,
    /// Derivative of psi along the normal, times the weight.
    psi_flux: f64,
}

impl BorderPoint {
    fn new(psi: f64, gradient: Complex, z: Complex, normal: Complex) -> Self {
        Self { z, normal, psi, psi_flux: gradient.dot(normal) }
    }
}

/// Pieces of an edge of a group, short next to singular points of psi.
fn pieces(setup: &Setup, middle: Complex, arc: Arc) -> Vec<[f64; 2]> {
    // No shorter than this, in lengths of the edge if that is short.
    let least = 1e-9 * (arc.span[1] - arc.span[0]).abs().min(1.0);
    let ends = arc.span.map(|s| arc.curve.at(s));
    let singular = setup.jumps.singular.iter().map(|&z| z - middle);
    let others: Vec<Complex> =
        singular.filter(|z| ends.iter().all(|end| (*z - *end).norm() > 0.1 * least)).collect();
    halved(arc.span, |[from, to]| {
        let middle = arc.curve.at(0.5 * (from + to));
        let length = to - from;
        length > least
            && (length * arc.curve.curvature > 1.6
                || others.iter().any(|&z| length > (z - middle).norm()))
    })
}
