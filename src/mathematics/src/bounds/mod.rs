//! Guaranteed two-sided bounds of the energy and of the error of a finite element solution: here on the square, and in
//! [`triangulation`] on meshes.
//!
//! # The identity
//! Let the [law](crate::problem::law) keep dv/dn in `[lo, hi]`, and let j(v) be the largest of `-l v` over the l of
//! this interval. Let K be the functions of H^1 where j(v) is finite on the boundary, J(v) = 1/2 |grad v|^2 - (f, v) +
//! the integral of j(v) over the boundary, and sigma a *flux*: `-div sigma = f` inside, `sigma.n` in `[lo, hi]` on the
//! boundary. For w in K integration by parts gives
//!
//! ```text
//! J(w) + 1/2 |sigma|^2 = 1/2 |grad w - sigma|^2 + <j(w) + sigma.n w> =: G(w, sigma),
//! ```
//!
//! where `< >` is the integral over the boundary, nowhere negative under it. Under the paper's law K has the functions
//! that are not negative on the boundary, and j is zero. The identity holds likewise with the solution u in place of w,
//! or its flux `grad u` in place of sigma. So J(u) lies between J(w) - G and J(w), is at most J(0) = 0, and
//! `1/2 |grad (u - v)|^2 <= J(v) - J(u)` for v in K, with equality where v vanishes on the part of the boundary that
//! sticks and has the sign of u on the others. No constant of Poincaré's or of the trace inequality appears, so the
//! bounds do not depend on the problem being only semicoercive. (Prager and Synge 1947; for Signorini's problem
//! Bartels, Gudi and Kaltenbach, arXiv 2407.10912.) Nothing is assumed of v: iteration errors, wrong loads and wrong
//! solutions make the bounds wide, not wrong.
//!
//! # Algorithm
//! 1. Set boundary values to zero that the law forbids, under the paper's law negative ones; their energy norm is added
//!    to the bounds of the error (`project`).
//! 2. Integrate f over all cells (`data.rs`) and compute the reactions at the boundary nodes, inside the interval of
//!    the law and so that they balance f: under the paper's law scaled, under others shifted by one constant
//!    (`flux.rs`). If they do not reach an end of the interval, the end plays no part, and values of v that slip to it
//!    become zero too (`bracketed`).
//! 3. In one sweep over the cells, row by row (`walk.rs`), form the flux (`flux.rs`, `strip.rs`), the recovery
//!    (`recovery.rs`), the sums of all energies (`regular.rs` where f is constant around a cell, else `cells.rs`), and
//!    the residual (`residual.rs`).
//! 4. Combine the sums to the bounds, widened by the rounding errors of sums of `n` terms. `summed` is the central
//!    function.
//!
//! # The flux
//! Horizontal differences of the nodal vector over h, at the midpoints of edges, are coefficients of
//! B-splines of degree 2 in x and 1 in y; vertical differences likewise with x and y exchanged. Beyond the boundary the
//! vector is continued by reflection plus twice the reaction, which makes `sigma.n` the linear interpolant of the
//! reactions (`flux.rs`). The divergence of this *spline flux* is the bilinear interpolant of the
//! five-point stencil's values at the nodes, which is f where f is constant. Where f jumps, its moments over the cells
//! give corrections in closed form: fluxes through edges, which transport the difference between the integrals of f
//! over cells and those of f times bilinear hat functions, and a field inside the cell. The construction is in the
//! spirit of Braess and Schöberl (Math. Comp. 77, 2008), but of second order, since the spline averages a flux on the
//! dual grid (Luce and Wohlmuth, SIAM J. Numer. Anal. 42, 2004) over one cell.
//!
//! Two remainders add to `|grad w - sigma|`. The first is the distance of f from a bilinear function in cells that a
//! jump cuts, times `h / (2 pi)` (Poincaré's constant on bilinear complements). The second is the residual of the
//! five-point equation: iteration errors, and the difference between the load vector and the integrals of f times
//! bilinear hats (`residual.rs`), which another load adds to: bounds are closest for the load against bilinear hats.
//!
//! # The recovery
//! w is the bilinear interpolant less a bubble on each edge that makes its slopes those of the flux, blended
//! over the cells; on the boundary the bubbles are limited so that w stays in K ([`recovery`]). J(w) is within
//! O(h^3) of J(u), and with it the whole bracket; J(v) is within O(h^2). The error of v is then bracketed by
//! `2 (J(v) - J(w) + G)` and, with w' the recovery without bubbles on the boundary, `2 (J(v) - J(w'))`.
//!
//! # Easily broken
//! - The bounds are guaranteed only if every sum's rounding errors are covered: a change of the order of summation must
//!   keep the chains of additions as short as `summed` assumes.
//! - Vector instructions need each function between `vectorised` and the loop to be inlined.

mod accuracy;
mod boundary;
mod cells;
mod data;
mod flux;
mod lanes;
mod moments;
mod recovery;
mod regular;
mod residual;
mod strip;
#[cfg(test)]
mod tests;
pub mod triangulation;
mod walk;

pub use accuracy::Accuracy;
use boundary::Slips;
use data::AllCells;
use walk::Total;

use crate::discrete::grid::Grid;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::text::plain;
use crate::problem::unsolvable::{Component, Unsolvable};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::f64::consts::PI;

/// Guaranteed bounds for a finite element solution, up to the quadrature error of an f that is not piecewise constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Ends of an interval that contains the energy J(u) of the true solution u.
    pub energy: [f64; 2],
    /// Ends of an interval that contains the L2 norm of `grad (u - v)`, v piecewise linear: on the square on triangles
    /// cut by rising diagonals.
    pub error: [f64; 2],
    /// Upper bound of the L2 norm of `grad (u - w)`, w the recovery of v, which is piecewise quadratic; none on meshes,
    /// which have no recovery.
    pub recovered: Option<f64>,
    /// Size of the energy between the boundary of the mesh and the curve on which it lies, which the bounds leave out:
    /// an estimate; none without a curve, and in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<f64>,
}

impl Bounds {
    /// Upper bound of the error relative to `|grad u|`; infinite if the bounds do not exclude `|grad u| = 0`, but zero
    /// if there is no error.
    pub fn relative(&self) -> f64 {
        // |grad u|^2 = -2 J(u) under every law, since j(u) = -(du/dn) u on the boundary.
        ratio(self.error[1], (-2.0 * self.energy[1]).max(0.0).sqrt())
    }

    /// Bounds that follow from an interval that contains the energy of the true solution u and that of v, where half
    /// the square of the error is at most its width.
    pub(crate) fn of_energy(energy: [f64; 2]) -> Self {
        let width = (energy[1] - energy[0]).max(0.0);
        Self { energy, error: [0.0, (2.0 * width).sqrt()], ..Self::NONE }
    }

    /// Bounds that say nothing.
    pub const NONE: Self = Self {
        energy: [f64::NEG_INFINITY, 0.0],
        error: [0.0, f64::INFINITY],
        recovered: None,
        curve: None,
    };

    /// Bounds that follow from these and others of the same solution.
    fn intersection(&self, other: &Self) -> Self {
        let common = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        Self {
            energy: common(self.energy, other.energy),
            error: common(self.error, other.error),
            recovered: match (self.recovered, other.recovered) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            },
            curve: self.curve.or(other.curve),
        }
    }

    /// Bounds widened by an energy between the polygon and the curve, which is half the square of an error there.
    fn with_curve(&self, energy: f64) -> Self {
        let ([low, high], [least, most]) = (self.energy, self.error);
        let error = [least, (most * most + 2.0 * energy).sqrt()];
        Self { energy: [low - energy, high], error, recovered: None, curve: None }
    }

    /// Width of the bracket of the energy over |J(u)|; infinite if the bracket contains zero and other numbers, zero if
    /// it is zero alone.
    pub fn relative_energy(&self) -> f64 {
        let [low, high] = self.energy;
        // J(u) is at most zero.
        ratio(high - low, -high)
    }

    /// The number of the bracket of the energy that is nearest to the energy of v; on the square mostly the upper end,
    /// which is the energy of the recovery.
    pub fn nearest_energy(&self, of_v: f64) -> f64 {
        of_v.max(self.energy[0]).min(self.energy[1])
    }
}

/// An error over a size, neither of them negative: without error zero, whatever the size.
fn ratio(error: f64, size: f64) -> f64 {
    if error == 0.0 {
        0.0
    } else if size > 0.0 {
        error / size
    } else {
        f64::INFINITY
    }
}

/// Reason for which there are no bounds.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoBound {
    /// No flux can balance f.
    #[error(transparent)]
    Unsolvable(#[from] Unsolvable),
    /// Rounding errors exceed the flux that is left to balance f.
    #[error("rounding errors exceed the flux that is left to balance f")]
    NotBalanced,
    /// The points at which f is sampled miss this part of the integral of |f|: the bounds would be those of another f.
    #[error("the points at which f is sampled miss {} of the integral of |f|", plain(*part, 2))]
    Missed {
        /// Part that is missed.
        part: f64,
    },
    /// A step of the proof does not apply to this true solution.
    #[error("what its proof needs was not found: {step}")]
    Unproved {
        /// The step.
        step: &'static str,
    },
    /// A sum overflows, squares underflow, or the vector or f contains a NaN.
    #[error("numbers exceed the range of double precision")]
    NotFinite,
}

/// Least integral of |f|, `sqrt(f64::MIN_POSITIVE / f64::EPSILON)`: below it, squares lose more by underflow than by
/// rounding.
const LEAST_MASS: f64 = 1e-146;

/// Returns bounds for the nodal vector `y` as an approximation of the solution for f under a law on the boundary. Any
/// vector may be given.
///
/// # Errors
/// If the flux cannot balance the integral of f, which must be negative for the paper's law, or numbers exceed the
/// range of double precision.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn bounds(grid: Grid, f: &Source, law: Law, y: &[f64]) -> Result<Bounds, NoBound> {
    bracketed(grid, f, law, y, None)
}

/// Returns the values of the recovery w of `y` on the grid of half the width, which determine it, and the bounds.
///
/// # Errors
/// See [`bounds`].
///
/// # Panics
/// See [`bounds`].
pub fn recovery(
    grid: Grid,
    f: &Source,
    law: Law,
    y: &[f64],
) -> Result<(Vec<f64>, Bounds), NoBound> {
    let side = 2 * grid.cells() + 1;
    let mut recovered = vec![0.0; side * side];
    let bounds = bracketed(grid, f, law, y, Some(&mut recovered))?;
    Ok((recovered, bounds))
}

/// Returns the bounds, and writes the recovery to which they belong to `recovered`.
///
/// If the reactions do not reach an end of a bounded interval, all wider intervals have the same solution, and values
/// of v that slip to that end are errors: with zero in their place the bounds hold as well, and do not feel how far the
/// end is.
fn bracketed(
    grid: Grid,
    f: &Source,
    law: Law,
    y: &[f64],
    mut recovered: Option<&mut [f64]>,
) -> Result<Bounds, NoBound> {
    assert_eq!(y.len(), grid.nodes());
    let data = AllCells::new(grid, f);
    Component::in_contact(Grid::PERIMETER, data.integral).check(law, 0.0)?;
    let projection = project(grid, Slips::of_law(law), y);
    let (found, slips) = summed(&data, law, &projection, recovered.as_deref_mut());
    let narrower = project(grid, slips, y);
    if narrower.distance == projection.distance {
        return found;
    }
    let mut other_recovered = recovered.as_ref().map(|values| vec![0.0; values.len()]);
    let (other, _) = summed(&data, law, &narrower, other_recovered.as_deref_mut());
    let Ok(other) = other else { return found };
    if found.as_ref().is_ok_and(|found| found.recovered <= other.recovered) {
        return found.map(|found| found.intersection(&other));
    }
    if let (Some(recovered), Some(other)) = (recovered, other_recovered) {
        recovered.copy_from_slice(&other);
    }
    Ok(found.map_or_else(|_| other.clone(), |found| found.intersection(&other)))
}

/// Returns the bounds for a vector in K, writes the recovery to `recovered`, and returns the ends of the interval of
/// the law that the reactions reach. This is the central function.
fn summed(
    data: &AllCells<'_>,
    law: Law,
    Projection { v, distance: projection_distance }: &Projection<'_>,
    recovered: Option<&mut [f64]>,
) -> (Result<Bounds, NoBound>, Slips) {
    let (total, slips) = walk::total(data, law, v, recovered);
    (combined(data.grid().cells(), &total, *projection_distance), slips)
}

/// Combines the sums over `n` by `n` cells to bounds.
fn combined(n: usize, total: &Total, projection_distance: f64) -> Result<Bounds, NoBound> {
    let &Total { sums, work, boundary_bubble_gain, residual, largest, mass, flow, .. } = total;
    // Where f is so small that its squares are zero, v may not be.
    if mass < LEAST_MASS && (mass > 0.0 || largest > 0.0) {
        return Err(NoBound::NotFinite);
    }
    let size = sums.recovered + 2.0 * largest * (mass + 4.0 * flow);
    // The longest chain of additions has as many terms as a row has cells, and fewer than 300 more.
    let rounding = (n + 300) as f64 * f64::EPSILON * size;
    // Rounding errors of the differences of values, in the residual and in the flux, if all have one sign.
    let flux_rounding = (8.0 * n as f64 / PI + 16.0) * n as f64 * f64::EPSILON * largest;
    // Rounding errors of the sum of the reactions.
    let flow_rounding = 8.0 * n as f64 * f64::EPSILON * flow;
    let distance = sums.distance.sqrt() + residual + flux_rounding + flow_rounding;
    let gap = 0.5 * distance * distance + work;
    let recovered_inside = 0.5 * sums.recovered - sums.recovered_load;
    let linear_inside = 0.5 * sums.linear - sums.linear_load;
    let recovered_energy = recovered_inside + total.recovered_potential;
    let linear_energy = linear_inside + total.linear_potential;
    let error_squared_max = 2.0 * (linear_energy - recovered_energy + gap + 2.0 * rounding);
    // v and the recovery without bubbles on the boundary are the same there.
    let error_squared_min =
        2.0 * (linear_inside - recovered_inside - boundary_bubble_gain - 2.0 * rounding);
    let energy = [recovered_energy - gap - rounding, recovered_energy + rounding];
    // The projection distance is a sum of two terms for each boundary node, none of them negative.
    let projection_rounding = (8 * n + 16) as f64 * f64::EPSILON * projection_distance;
    let error = [
        (root(error_squared_min) - projection_distance - projection_rounding).max(0.0),
        root(error_squared_max) + projection_distance + projection_rounding,
    ];
    let finite = [energy[0], energy[1], error_squared_max, projection_distance];
    if !finite.into_iter().all(f64::is_finite) {
        return Err(NoBound::NotFinite);
    }
    let recovered = root(2.0 * (gap + 2.0 * rounding));
    Ok(Bounds { energy: below_zero(energy), error, recovered: Some(recovered), curve: None })
}

/// An interval that contains J(u), without the numbers above J(0) = 0.
fn below_zero([low, high]: [f64; 2]) -> [f64; 2] {
    [low, high.min(0.0)]
}

/// Square root, 0 for negative numbers.
fn root(square: f64) -> f64 {
    square.max(0.0).sqrt()
}

/// A nodal vector without the values on the boundary that the law forbids.
struct Projection<'a> {
    v: Cow<'a, [f64]>,
    /// Distance from the vector before, in the energy norm.
    distance: f64,
}

/// Sets boundary values to zero whose signs are left out: negative ones for the paper's law.
fn project(grid: Grid, slips: Slips, y: &[f64]) -> Projection<'_> {
    let left_out = |value: f64| if slips.keep(value) == 0.0 { value } else { 0.0 };
    let below: Vec<f64> = grid.boundary().map(|node| left_out(y[node])).collect();
    if below.iter().all(|&value| value == 0.0) {
        return Projection { v: Cow::Borrowed(y), distance: 0.0 };
    }
    let mut v = y.to_vec();
    // A difference, since the maximum with zero would hide a NaN.
    grid.boundary().zip(&below).for_each(|(node, value)| v[node] -= value);
    // Edges on the boundary have weight 1/2, edges to the inside 1.
    let mut square = 0.0;
    for (b, value) in below.iter().enumerate() {
        let next = below[(b + 1) % below.len()];
        square += 0.5 * (next - value) * (next - value);
        square += if grid.is_corner(b) { 0.0 } else { value * value };
    }
    Projection { v: Cow::Owned(v), distance: square.sqrt() }
}
