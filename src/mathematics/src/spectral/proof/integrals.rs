//! Energy and moments, from integrals over the boundary and along the jumps of f.
//!
//! All is on the boundary and on jumps:
//! ```text
//! int f v = int f psi + oint (psi l - v psi_n),     int f psi for each piece of f by a quadratic function:
//! J(v)    = 1/2 oint v l - 1/2 int f v - int over gaps of q (v - at).
//! ```
//! on the boundary by `|x|^2 / 4` from the middle of the domain, along jumps by
//! [`quadratic`](crate::spectral::source::quadratic).
//!
//! A crossing of f that is joined with a split has f of another interval on the piece between both; the change is
//! added, by the integrand in the middle of the piece ([`JoinedPiece`]).
//!
//! J(v) less the integral of (v - at) l where v should be `at`, which is called the energy, has an error that is
//! quadratic in the residual. Half of the integral of |grad v|^2 is the integral of `at` times l less the energy, but
//! for such an error.

use crate::problem::complex::Complex;
use crate::spectral::fit::Fit;
use crate::spectral::fit::field::PlaneNode;
use crate::spectral::geometry::boundary::{JoinedPiece, State, Walk};
use crate::spectral::setup::Setup;
use crate::spectral::source::groups::{GroupEdge, PieceSide};
use crate::spectral::source::psi::Psi;
use crate::spectral::source::quadratic::Quadratic;

/// Integrals.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrals {
    /// Integral of f.
    pub source: f64,
    /// Integral of dv/dn over the boundary.
    pub force: f64,
    /// Integral of f v.
    pub(super) work: f64,
    /// Integral of v dv/dn over the boundary.
    pub(super) flux_work: f64,
    /// Integral of (v - at) dv/dn where v should be `at`.
    held: f64,
    /// Integral of q (v - at) where dv/dn should be q.
    slipping: f64,
    /// Integral of `at` dv/dn over the boundary.
    pub given: f64,
}

impl Integrals {
    /// The part of the boundary.
    pub(super) fn on_boundary(setup: &Setup, fit: &Fit, nodes: &[PlaneNode]) -> Self {
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
                Psi::Smooth(own) => {
                    let ([source, work], outward) = (own.radial(z), z.dot(node.normal()));
                    sums.source += weight * outward * source;
                    sums.work += weight * outward * work;
                }
            }
            sums.given += weight * node.at * node.flux;
            match node.state {
                State::Held => sums.held += weight * node.above() * node.flux,
                State::Flux(q) => sums.slipping += weight * q * node.above(),
            }
        }
        sums
    }

    /// J(v), less the integral of (v - at) l where v should be `at`.
    pub(super) fn energy(&self) -> f64 {
        0.5 * self.flux_work - 0.5 * self.work - self.slipping - self.held
    }

    /// Adds what f beside a piece changes in the part of the boundary.
    pub(super) fn add_joined(&mut self, setup: &Setup, walk: &Walk, piece: JoinedPiece) {
        let (JoinedPiece { f, counted, span: [from, to], .. }, length) = (piece, piece.length());
        let split = &walk.splits[piece.split];
        let ring = &setup.domain.rings[split.ring];
        let place = ring.place(split.t + 0.5 * (from + to));
        let side = &ring.sides[place.side];
        let (z, normal) = (side.point(place.s), -side.tangent(place.s).turned());
        let psi = &setup.jumps.psi;
        let own = BorderPoint::new(psi.value(z), psi.gradients(&[z])[0], z, normal.scaled(length));
        self.add_side(PieceSide::of_jump(Quadratic::round(setup.centre), [f, counted]), own);
    }

    /// Adds the part of a jump, by points with normals to the right as long as their weights, and psi with its
    /// gradients there.
    pub(super) fn add_jump(
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
