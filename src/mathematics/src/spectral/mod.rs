//! True solution: on the square to rounding, by a conformal map and a scalar Riemann-Hilbert problem; on any domain in
//! the plane with straight and circular sides to ten digits and more (`plane`). Both are a [`TrueSolution`].
//!
//! The rest of this page is about the square.
//!
//! The problem is invariant under conformal maps, and for a piecewise constant f a particular solution is
//! known in closed form. What remains is a harmonic function on the disc whose boundary condition changes
//! at the ends of the contact arcs; for given ends it has an explicit solution. So the only unknowns are
//! these `2 m` numbers, found by Newton's method, and all errors are those of quadratures of analytic
//! functions: twelve to sixteen digits of the energy and the ends. At single points of 400 random problems v
//! has ten digits at least with [`SpectralParams::FINER`]; the multiplier `l = dv/dn`, like `s log s` at corners,
//! eight.
//!
//! # Derivation
//! *A particular solution.* Let psi solve `-Lap psi = f` without boundary conditions. With J the jump
//! from right to left across a straight edge with unit tangent t, and a, b its ends seen from z (complex numbers),
//! `d = Im(conj(t) a)`,
//! ```text
//! grad psi = -(1 / 2 pi) sum over edges of J d t conj(log(b / a)) - beta z / 2,
//! ```
//! where beta makes f right at one point; an arc has two terms more (`potential.rs`). At each vertex the
//! jumps sum to zero, so the ends of edges contribute harmonic functions outside of the square, which are
//! dropped: f is continued beyond each side, and psi is analytic up to the boundary but where a jump meets
//! it. A harmonic polynomial is subtracted so that grad psi vanishes in the corners. On the boundary it is
//! interpolated, once for all contact sets (`boundary.rs`); psi itself is an integral of it along curves
//! (`along.rs`).
//!
//! *The map.* `Phi(z) = e^{-i pi/4} sl(K e^{i pi/4} z)`, K = 1.854.., takes the square to the unit disc, p along the
//! boundary to the angle theta (`map.rs`). `h = v - psi` is harmonic there, so that `W = h_theta + i h_r`
//! is on the circle the limit of an analytic function with `W(0) = 0`. In contact `h_theta = -psi_theta`,
//! elsewhere `h_r = -psi_r`.
//!
//! *The Riemann-Hilbert problem.* Let `P(theta)` be the product of `2 sin((theta - e) / 2)` over all ends
//! e of the m contact arcs, `s = (-1)^k` on the k-th arc and on the gap after it, and
//! `delta = psi_theta / (s |P|^{1/2})` in contact, `-psi_r / (s |P|^{1/2})` elsewhere. A solution that is
//! bounded at the ends exists if and only if
//! ```text
//! integral of delta e^{i k theta} = 0    for k = -m/2, -m/2 + 1, .., m/2           (m + 1 equations),
//! integral of v_theta = 0                over all gaps but the longest            (m - 1 equations).
//! ```
//! Then, with `kappa(x) = 1 / sin(x / 2)` for odd m and `cot(x / 2)` for even m, `l dp/dtheta` in contact and
//! `v_theta` elsewhere are `s |P|^{1/2} Y(theta)`,
//! ```text
//! Y(theta) = -(1 / 2 pi) integral of (grad psi(z') - grad psi(z)) . e / (s |P|^{1/2}) kappa(theta - theta') dp',
//! ```
//! e the tangent in contact, the inner normal elsewhere. To subtract `grad psi(z)` changes nothing, since
//! linear functions are harmonic, and removes the principal value (`sources.rs`). Without a gap (m = 0)
//! the same holds with `P = 1`. The derivatives with respect to the ends are integrals of the same kind,
//! so Newton's matrix is exact (`newton.rs`).
//!
//! *The contact set.* It starts from multigrid on a coarse grid; where l is negative a gap is opened, where
//! v is negative an arc is inserted, until all signs hold (`contact.rs`): then, by convexity, it is the
//! solution. Round a corner in contact where f > 0, there is always a gap, of a length exponentially small
//! in 1 / f; below 1e-4 it is left out, at a cost of its fourth power.
//!
//! *The energy.* `J = -1/2 int f v` follows from Green's identity with psi, by integrals over the boundary
//! and the edges; Rellich's identity gives it once more from other data (`energy.rs`).
//!
//! *Borders that nearly touch.* Two curves are cut at the same points, however small the angle at which they meet
//! there; curves that overlap by, or lack, less than half of 2^-40 touch in one point, which moves the energy by the
//! power 3/2 of that. Where vertices are hardly apart short straight pieces join them, so that at each the jumps sum
//! to zero (`jumps.rs`). Moments of f, from psi on the boundary and from the jumps, are compared with those of the
//! pieces in closed form: the other checks do not see where psi belongs to another f.
//!
//! *Other laws.* Under a law with the flux in [lo, hi] (`problem/law.rs`) a gap has one sign of v, since the flux jumps
//! only across an arc that sticks, and its flux q is lo or hi. Then `h_r = q - psi_r` there, the data are the parts of
//! `grad psi - q n` with n the outer normal, and l and `v_theta` follow from the same formula if a constant vector is
//! subtracted that fits the data on both sides of an end: `c = grad psi(z) - q n` with the q of the gap at that end.
//! Its difference from the gradient is given back to the result (`panels::Panel::shift`). Unknowns and equations stay
//! the same, and `J = -1/2 int f v - 1/2 int l v`.
//!
//! Between v > 0 and v < 0 there is an arc that sticks, of a length exponentially small in 1 / (hi - lo), the logarithm
//! of which Newton's method changes (`newton.rs`). Such an arc cannot be left out: a problem that needs a shorter one
//! than is resolved is refused.
//!
//! # Limits
//! An f is refused if arcs or gaps of less than 2e-6 matter, arcs between opposite signs of v of less than 1e-7, and
//! where the integral of f is lost to rounding. Under the paper's law, of random f, one piece of which balances the
//! background, one in 4000 was refused where the integral was 1e-6 to 0.1 of the piece's, one in 600 where it was 1e-7
//! to 1e-6, one in five where it was 1e-8 to 1e-7. Where a piece of size r has values like r^-2 the energy loses digits
//! like r^-3, so that f is refused for r below about 2e-4.
//!
//! Under other laws more are refused: 9 % of 228 random f under friction, 16 % of 222 under a limit, all but one since
//! arcs between both signs of v may be too short. There a rectangle, quadrant, disc or half-plane had values of 0.3 to
//! 300 of either sign, the law an end of 0.06 to 10, both with uniform logarithms, and the background was such that the
//! integral lay anywhere in what the flux can balance.
//!
//! # Literature
//! - N. I. Muskhelishvili, Singular integral equations, Noordhoff (1953), for the Riemann-Hilbert problem
//!   with changing boundary conditions.
//! - S. Olver, Computation of equilibrium measures, J. Approx. Theory 163 (2011): Newton's method on the
//!   ends of a support; the multiplier of the scalar Signorini problem is such a measure.
//! - M. Maischak, E. P. Stephan, Adaptive hp-versions of BEM for Signorini problems, Appl. Numer. Math. 54
//!   (2005), the closest in accuracy before.
//! - F. Rellich, Darstellung der Eigenwerte von Lap u + lambda u = 0 durch ein Randintegral, Math. Z. 46
//!   (1940).

mod along;
mod arcs;
mod boundary;
mod changes;
mod checks;
mod complex;
mod contact;
mod curve;
mod domain;
mod elementary;
mod energy;
mod gradient;
mod jumps;
mod map;
mod newton;
mod panels;
mod parts;
mod place;
mod plane;
mod potential;
mod problem;
mod rule;
mod search;
mod sources;
mod touch;
mod trace;
mod truth;
mod way_out;

use crate::discrete::contact::ContactArc;
use crate::discrete::grid::Grid;
use crate::machine::threads::map_range;
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::unsolvable::{Component, Unsolvable};
use crate::saddle::Pair;
pub use checks::Checks;
use contact::ContactStart;
use energy::Energies;
use place::BoundaryPlace;
pub use plane::{PlaneChecks, PlaneError};
use problem::SpectralProblem;
use search::FoundTrace;
pub use touch::Touch;
use trace::{BoundaryValues, Sign, Trace};
pub use truth::{TrueChecks, TrueSolution, true_solution};
pub(crate) use truth::{check_plane, true_solution_on};

/// Starts that are tried in turn. The first is enough unless the integral of f nearly vanishes.
const STARTS: [ContactStart; 6] = [
    ContactStart { n: 64, careful: false },
    ContactStart { n: 64, careful: true },
    ContactStart { n: 256, careful: true },
    ContactStart { n: 256, careful: false },
    ContactStart { n: 1024, careful: true },
    ContactStart { n: 1024, careful: false },
];

/// Starts that take no more time than some solutions. Under a bounded law the others find hardly more, in minutes.
const QUICK: &[ContactStart] = STARTS.split_at(4).0;

/// Resolution of the quadratures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpectralParams {
    /// Gauss nodes of a panel, one at least.
    pub nodes: usize,
    /// Number of times that panels get shorter, by a factor of eight, towards corners and jumps of f.
    pub levels: u32,
}

impl SpectralParams {
    /// Resolution of the solution with which another is compared to estimate its error.
    pub const FINER: Self = Self { nodes: 24, levels: 9 };
}

impl Default for SpectralParams {
    /// Resolution for twelve digits of the energy, mostly fourteen.
    fn default() -> Self {
        Self { nodes: 16, levels: 6 }
    }
}

/// Reason for which there is no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpectralError {
    /// f is not piecewise constant.
    #[error("f must consist of constant pieces")]
    NotPieces,
    /// The flux through the boundary cannot balance f: the energy has no minimiser, or not one alone.
    #[error(transparent)]
    Unsolvable(#[from] Unsolvable),
    /// v has both signs on the boundary, and no arcs that stick were found for which all signs are right.
    #[error(
        "v has both signs on the boundary, and the arcs that stick between were not found under the law {0}: they \
         may be too short; widen the interval of the flux"
    )]
    ShortArcs(Law),
    /// No contact set was found for which all signs are right.
    #[error("no contact set with all signs right was found{}", .0.as_ref().map(Touch::to_string).unwrap_or_default())]
    NoContactSet(Option<Touch>),
    /// By the method for any domain in the plane.
    #[error(transparent)]
    Plane(#[from] PlaneError),
    /// On the square, neither by its closed form nor by the method for any domain.
    #[error("{square}; without the closed form: {plane}")]
    Neither {
        /// Reason of the closed form.
        square: Box<Self>,
        /// Reason of the other method.
        plane: Box<Self>,
    },
    /// A solution was found that fails a check.
    #[error("a check of the solution failed: {checks}{}", near.as_ref().map(Touch::to_string).unwrap_or_default())]
    Unchecked {
        /// All checks.
        checks: Checks,
        /// Borders of f that may be the reason.
        near: Option<Touch>,
    },
}

impl SpectralError {
    /// True if the input is the reason, and not that no solution was found.
    pub fn is_of_input(&self) -> bool {
        match self {
            Self::NotPieces | Self::Unsolvable(_) => true,
            Self::Plane(e) => e.is_of_input(),
            _ => false,
        }
    }

    /// True if borders of f that nearly touch may be the reason.
    pub fn is_of_touch(&self) -> bool {
        match self {
            Self::Neither { square, .. } => square.is_of_touch(),
            _ => {
                matches!(self, Self::Unchecked { near: Some(_), .. } | Self::NoContactSet(Some(_)))
            }
        }
    }
}

/// Solution of a problem.
pub struct Solution {
    /// J(v) = -1/2 int f v, plus half the integral of the law's potential.
    pub energy: f64,
    /// Contact arcs, anticlockwise.
    pub contact: Vec<ContactArc>,
    /// Checks of the solution.
    pub checks: Checks,
    /// Integral of f over the square.
    pub integral: f64,
    /// Number of Newton steps.
    pub steps: usize,
    problem: SpectralProblem,
    trace: Trace,
}

/// Multiplier dv/dn at a point of the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundaryPoint {
    /// The point.
    pub point: [f64; 2],
    /// dv/dn.
    pub multiplier: f64,
    /// Quadrature weight with respect to the length of the boundary.
    pub weight: f64,
}

/// Solves the problem for a piecewise constant f: the central function of this module.
///
/// 1. Finds the curves across which f jumps, and psi with its values on the boundary (`jumps`, `potential`,
///    `boundary`).
/// 2. Takes the contact set of a multigrid solution (`STARTS`).
/// 3. Moves its ends by Newton's method until a step is short (`newton`).
/// 4. Evaluates v and the multiplier on the boundary (`trace`), corrects the contact set (`contact`), and goes on with
///    step 3 until all signs are right (`search`).
/// 5. Computes the energy, and checks signs, identities and moments (`energy`); if a check fails, goes on with step 2
///    from the next start.
///
/// Easily broken: near a corner the distance from the corner, not the angle, must be carried along (`map`); common
/// points of two curves must have the same bits on both (`jumps`).
///
/// # Errors
/// If f is not piecewise constant, its integral is not negative, no contact set is found, or the
/// solution fails a check.
pub fn spectral(f: &Source, params: SpectralParams) -> Result<Solution, SpectralError> {
    spectral_under(Law::SIGNORINI, f, params)
}

/// Solves the problem under any law on the boundary, as [`spectral`] does under the paper's.
///
/// # Errors
/// As [`spectral`], with [`SpectralError::Unsolvable`] if the flux cannot balance the integral of f, and
/// [`SpectralError::ShortArcs`] if arcs that stick between v > 0 and v < 0 are not resolved.
pub fn spectral_under(
    law: Law,
    f: &Source,
    params: SpectralParams,
) -> Result<Solution, SpectralError> {
    solved_from(&STARTS, law, f, params)
}

/// Solves the problem from these starts in turn.
fn solved_from(
    starts: &[ContactStart],
    law: Law,
    f: &Source,
    params: SpectralParams,
) -> Result<Solution, SpectralError> {
    if f.is_smooth() {
        return Err(SpectralError::NotPieces);
    }
    let problem = SpectralProblem { law, ..SpectralProblem::new(f) };
    Component::in_contact(Grid::PERIMETER, problem.integral).check(law, 0.0)?;
    let mut error = SpectralError::NoContactSet(problem.jumps.nearly_touching());
    for start in starts {
        let Some(arcs) = start.arcs(f, law) else { continue };
        if arcs.have_both_signs() && matches!(error, SpectralError::NoContactSet(_)) {
            error = SpectralError::ShortArcs(law);
        }
        let Some(found) = search::search(&problem, arcs, params, true) else { continue };
        match Solution::checked(&problem, found, None) {
            Err(failed) => error = failed,
            solved => return solved,
        }
    }
    Err(error)
}

/// Solves the problem under a law at the usual resolution; returns the solution at the boundary nodes of a grid, with
/// zeros inside.
///
/// # Errors
/// As [`spectral_under`].
pub fn true_trace_on(grid: Grid, law: Law, f: &Source) -> Result<Pair, SpectralError> {
    let solution = spectral_under(law, f, SpectralParams::default())?;
    let mut pair = Pair { y: vec![0.0; grid.nodes()], a: Vec::new() };
    for (node, [value, multiplier]) in grid.boundary().zip(solution.trace_on(grid)) {
        pair.y[node] = value;
        pair.a.push(multiplier);
    }
    Ok(pair)
}

impl Solution {
    fn checked(
        problem: &SpectralProblem,
        FoundTrace { trace, steps }: FoundTrace,
        before: Option<f64>,
    ) -> Result<Self, SpectralError> {
        let energies = Energies::new(&trace, problem);
        let Energies { energy, rellich, force, .. } = energies;
        let integral = problem.integral;
        // The integral of f may vanish under other laws.
        let balanced = if problem.law.is_signorini() { integral } else { problem.mass };
        let signs = trace.signs(problem.law);
        let [least_multiplier, least_value] = [true, false].map(|contact| least(&signs, contact));
        // Inside, v is at least so large.
        let inside = 2.0 * energy.abs() / problem.mass;
        let size = trace.points.iter().map(|p| p.value.abs()).fold(inside, f64::max);
        let checks = Checks {
            least_multiplier,
            least_value,
            green: (force + integral) / balanced,
            rellich: rellich / energy - 1.0,
            moments: energies.moments_off(problem) * size / energy.abs(),
            resolution: before.map(|before| before / energy - 1.0),
        };
        if !checks.pass() {
            return Err(SpectralError::Unchecked { checks, near: problem.jumps.nearly_touching() });
        }
        let (contact, problem) = (trace.arcs(force), problem.clone());
        Ok(Self { energy, contact, checks, integral, steps, problem, trace })
    }

    /// Solution of this problem at another resolution, from the contact set of this solution.
    ///
    /// # Errors
    /// If that is not reached, or the solution fails a check: its energy must be that of this one to eight
    /// digits.
    pub fn at_resolution(&self, params: SpectralParams) -> Result<Self, SpectralError> {
        let found =
            search::search(&self.problem, self.trace.ends.arcs_and_flux(), params, false)
                .ok_or_else(|| SpectralError::NoContactSet(self.problem.jumps.nearly_touching()))?;
        Self::checked(&self.problem, found, Some(self.energy))
    }

    /// Total contact force; under another law than the paper's the flux through all of the boundary.
    pub fn force(&self) -> f64 {
        if self.problem.law.is_signorini() {
            return self.contact.iter().map(|arc| arc.force).sum();
        }
        self.boundary_points().map(|point| point.weight * point.multiplier).sum()
    }

    /// dv/dn at the quadrature nodes of the boundary, anticlockwise.
    pub(crate) fn boundary_points(&self) -> impl Iterator<Item = BoundaryPoint> {
        self.trace.points.iter().map(|p| BoundaryPoint {
            point: p.place.point().coordinates(),
            multiplier: p.multiplier,
            weight: p.weight,
        })
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn in a corner is that on one of its sides.
    pub fn on_boundary(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let BoundaryValues { value, multiplier, .. } =
            self.trace.at(BoundaryPlace::nearest(Complex::new(x, y)));
        [value, multiplier]
    }

    /// v in the corners: lower right, upper right, upper left, lower left.
    pub fn corners(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|corner| self.trace.corner_value(corner))
    }

    /// v at a point inside the square; at a distance d from a corner, to about 1e-16 / d^2.
    ///
    /// # Panics
    /// If the point does not lie in the square.
    pub fn value(&self, x: f64, y: f64) -> f64 {
        assert!(x.abs() <= 0.5 && y.abs() <= 0.5, "({x}, {y}) lies outside of the square");
        let z = Complex::new(x, y);
        self.problem.psi(z, &self.trace.rules) + self.trace.harmonic(z)
    }

    /// v at the nodes of a grid, and the multiplier at its boundary nodes.
    pub fn on_grid(&self, grid: Grid) -> Pair {
        let a = self.trace_on(grid).into_iter().map(|[_, multiplier]| multiplier);
        Pair { y: self.at_nodes(grid.cells()), a: a.collect() }
    }

    /// v and the multiplier at the boundary nodes of a grid.
    pub fn trace_on(&self, grid: Grid) -> Vec<[f64; 2]> {
        let nodes = (0..grid.boundary_nodes()).map(|b| grid.boundary_node(b));
        nodes.map(|(i, j)| self.under_law([grid.coordinate(i), grid.coordinate(j)])).collect()
    }

    /// v and the multiplier at a point of the boundary. What violates the law is a rounding error, which must not be
    /// taken for penetration.
    fn under_law(&self, point: [f64; 2]) -> [f64; 2] {
        let [value, multiplier] = self.on_boundary(point);
        let law = self.problem.law;
        [if law.hi().is_infinite() { value.max(0.0) } else { value }, law.project(multiplier)]
    }

    /// v at the nodes of the grid with `n` cells per side, row by row from the lower left corner.
    pub fn at_nodes(&self, n: usize) -> Vec<f64> {
        map_range(0..(n + 1) * (n + 1), n + 1, |k| self.at_node(n, [k % (n + 1), k / (n + 1)]))
    }

    /// v at the node in a column and a row of the grid with `n` cells per side.
    fn at_node(&self, n: usize, node: [usize; 2]) -> f64 {
        let [x, y] = node.map(|k| k as f64 / n as f64 - 0.5);
        if node.into_iter().any(|k| k == 0 || k == n) {
            self.under_law([x, y])[0]
        } else {
            self.value(x, y)
        }
    }
}

/// Least of the signs in contact, or elsewhere; zero without points.
fn least(signs: &[Sign], contact: bool) -> f64 {
    let own = signs.iter().filter(|sign| sign.contact == contact);
    // A multiplier that is not judged is not the least.
    let values = own.map(|sign| sign.value.unwrap_or(f64::INFINITY));
    values.min_by(f64::total_cmp).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(f: &Source, problem: &SpectralProblem) -> Result<Solution, SpectralError> {
        let arcs = STARTS[0].arcs(f, Law::SIGNORINI).unwrap();
        let found = search::search(problem, arcs, SpectralParams::default(), true).unwrap();
        Solution::checked(problem, found, None)
    }

    #[test]
    fn a_potential_of_another_f_is_refused_with_the_borders_that_nearly_touch() {
        let f = "disc(0,0,0.4)=1; disc(0.200001,0,0.2)=-2; else=-1".parse().unwrap();
        let mut problem = SpectralProblem::new(&f);
        assert!(solved(&f, &problem).is_ok());
        // As if the point where the discs meet were not known well.
        problem.jumps.psi.vertices[0].im += 3e-9;
        problem.boundary_psi = boundary::BoundaryPotential::new(&problem.jumps);
        let error = solved(&f, &problem).err().expect("the check sees it");
        let SpectralError::Unchecked { checks, .. } = &error else { panic!("{error}") };
        assert!(checks.moments > 1e-11 && checks.green.abs() < 1e-8, "{checks}");
        let borders = "the borders of disc(0,0,0.4) and disc(0.200001,0,0.2) nearly touch";
        assert!(error.to_string().ends_with(borders), "{error}");
    }
}
