//! Energy and moments, from integrals over the boundary and along the jumps of f.
//!
//! With `q = |x|^2 / 4` and psi, all is on the boundary and on jumps, J = left f - right f:
//! ```text
//! int f v   = int f psi + oint (psi l - v psi_n),
//! int f psi = oint f (psi q_n - q psi_n) - oint f^2 (x.n) q / 4 + sum int J (psi q_n - q psi_n) - J (f + f') (x.n) q /
//! 4, J(v)      = 1/2 oint v l - 1/2 int f v - int over gaps of q v.
//! ```
//! A crossing of f that is joined with a split has f of another interval on the piece between both; the change is
//! added, by the integrand in the middle of the piece ([`JoinedPiece`](super::boundary::JoinedPiece)).
//!
//! J(v) less the integral of v l where v should be zero has an error that is quadratic in the residual.

use super::boundary::{JoinedPiece, State, Walk};
use super::field::PlaneNode;
use super::fit::Fit;
use super::psi::Psi;
use super::setup::Setup;
use crate::problem::complex::Complex;
use crate::spectral::curve::Arc;
use crate::spectral::rule::{GaussNode, gauss, halved};

/// Integrals.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrals {
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
    pub(super) fn new(setup: &Setup, fit: &Fit, nodes: &[PlaneNode]) -> Self {
        let mut sums = Self::on_boundary(setup, fit, nodes);
        sums.add_jumps(setup);
        for piece in fit.walk.joined_pieces() {
            sums.add_joined(setup, &fit.walk, piece);
        }
        sums.completed()
    }

    /// The part of the boundary.
    pub(super) fn on_boundary(setup: &Setup, fit: &Fit, nodes: &[PlaneNode]) -> Self {
        let mut sums = Self::default();
        let origin = setup.centre;
        for node in nodes {
            let weight = node.spot.weight;
            let (z, f) = (node.spot.z, fit.walk.intervals[node.spot.interval].f);
            let outward = (z - origin).dot(node.normal());
            let square = 0.25 * (z - origin).norm2();
            sums.force += weight * node.flux;
            sums.flux_work += weight * node.value * node.flux;
            sums.work += weight * (node.psi * node.flux - node.value * node.psi_flux);
            match &setup.jumps.psi {
                Psi::Jumps(_) => {
                    sums.source += 0.5 * weight * f * outward;
                    sums.work += weight
                        * f
                        * (0.5 * outward * node.psi
                            - square * node.psi_flux
                            - 0.25 * f * outward * square);
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
    pub(super) fn completed(mut self) -> Self {
        self.plain = 0.5 * self.flux_work - 0.5 * self.work - self.slipping;
        self.energy = self.plain - self.held;
        self
    }

    /// Adds what f beside a piece changes in the part of the boundary.
    pub(super) fn add_joined(&mut self, setup: &Setup, walk: &Walk, piece: JoinedPiece) {
        let (JoinedPiece { f, counted, span: [from, to], .. }, length) = (piece, piece.length());
        let split = &walk.splits[piece.split];
        let ring = &setup.rings[split.ring];
        let place = ring.place(split.t + 0.5 * (from + to));
        let side = &ring.sides[place.side];
        let (z, normal) = (side.point(place.s), -side.tangent(place.s).turned());
        let (change, square) = (f - counted, 0.25 * (z - setup.centre).norm2());
        let outward = (z - setup.centre).dot(normal);
        let psi = setup.jumps.psi.value(z);
        let psi_flux = setup.jumps.psi.gradients(&[z])[0].dot(normal);
        self.source += 0.5 * length * change * outward;
        self.work += length
            * change
            * (0.5 * outward * psi - square * psi_flux - 0.25 * (f + counted) * outward * square);
    }

    fn add_jumps(&mut self, setup: &Setup) {
        let rule = gauss(32);
        for edge in &setup.jumps.edges {
            let curve = edge.arc.curve;
            let (mut points, mut normals) = (Vec::new(), Vec::new());
            for [from, to] in pieces(setup, edge.arc) {
                for &GaussNode { x, weight } in &rule {
                    // Short steps at both ends.
                    let part = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
                    let slope = 30.0 * x * x * (1.0 - x) * (1.0 - x);
                    let s = from + (to - from) * part;
                    points.push(curve.at(s));
                    normals
                        .push((-curve.direction(s).turned()).scaled(weight * slope * (to - from)));
                }
            }
            self.add_jump(setup, edge.values, &points, &normals);
        }
    }

    /// Adds the part of a jump from f on its left and right, by points with normals to the right as long as their
    /// weights.
    pub(super) fn add_jump(
        &mut self,
        setup: &Setup,
        [left, right]: [f64; 2],
        points: &[Complex],
        normals: &[Complex],
    ) {
        for ((z, &normal), gradient) in
            points.iter().zip(normals).zip(setup.jumps.psi.gradients(points))
        {
            let seen = *z - setup.centre;
            let (outward, square) = (seen.dot(normal), 0.25 * seen.norm2());
            let psi = setup.jumps.psi.value(*z);
            self.source += 0.5 * (left - right) * outward;
            self.work += (left - right)
                * ((0.5 * psi - 0.25 * (left + right) * square) * outward
                    - square * gradient.dot(normal));
        }
    }
}

/// Pieces of an edge, short next to singular points of psi.
fn pieces(setup: &Setup, arc: Arc) -> Vec<[f64; 2]> {
    let ends = arc.span.map(|s| arc.curve.at(s));
    let others: Vec<Complex> = setup
        .jumps
        .singular
        .iter()
        .copied()
        .filter(|z| ends.iter().all(|end| (*z - *end).norm() > 1e-10))
        .collect();
    halved(arc.span, |[from, to]| {
        let middle = arc.curve.at(0.5 * (from + to));
        let length = to - from;
        length > 1e-9
            && (length * arc.curve.curvature > 1.6
                || others.iter().any(|&z| length > (z - middle).norm()))
    })
}
