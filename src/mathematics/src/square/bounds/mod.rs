//! Guaranteed bounds on the square, by [the identity](crate::bounds) of all of them, with a flux and a recovery of
//! second order.
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
//! over the cells; on the boundary the bubbles are limited so that w stays in K. J(w) is within
//! O(h^3) of J(u), and with it the whole bracket; J(v) is within O(h^2). The error of v is then bracketed by
//! `2 (J(v) - J(w) + G)` and, with w' the recovery without bubbles on the boundary, `2 (J(v) - J(w'))`.
//!
//! # Easily broken
//! - The bounds are guaranteed only if every sum's rounding errors are covered: a change of the order of summation must
//!   keep the chains of additions as short as `summed` assumes.
//! - Vector instructions need each function between `vectorised` and the loop to be inlined.

mod cells;
mod data;
mod flux;
mod moments;
mod regular;
mod residual;
mod strip;
#[cfg(test)]
mod tests;
mod walk;

use data::AllCells;
use walk::Total;

use crate::bounds::boundary::Slips;
use crate::bounds::{Bounds, LEAST_MASS, NoBound, below_zero, root};
use crate::discrete::grid::Grid;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::unsolvable::Component;
use std::borrow::Cow;
use std::f64::consts::PI;

/// Returns bounds for the nodal vector `y` as an approximation of the solution for f under a law on the boundary. Any
/// vector may be given.
///
/// If the reactions do not reach an end of a bounded interval, all wider intervals have the same solution, and values
/// of v that slip to that end are errors: with zero in their place the bounds hold as well, and do not feel how far the
/// end is.
///
/// # Errors
/// If the flux cannot balance the integral of f, which must be negative for the paper's law, or numbers exceed the
/// range of double precision.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn bounds(grid: Grid, f: &Source, law: Law, y: &[f64]) -> Result<Bounds, NoBound> {
    assert_eq!(y.len(), grid.nodes());
    let data = AllCells::new(grid, f);
    Component::whole(law, Grid::PERIMETER, data.integral).check(0.0)?;
    let projection = project(grid, Slips::ALL.and(law), y);
    let (found, slips) = summed(&data, law, &projection);
    let narrower = project(grid, slips, y);
    if narrower.distance == projection.distance {
        return found;
    }
    match (found, summed(&data, law, &narrower).0) {
        (Ok(found), Ok(other)) => Ok(found.intersection(&other)),
        (found, other) => found.or(other),
    }
}

/// Returns the bounds for a vector in K, and the ends of the interval of the law that the reactions reach. This is the
/// central function.
fn summed(
    data: &AllCells<'_>,
    law: Law,
    Projection { v, distance: projection_distance }: &Projection<'_>,
) -> (Result<Bounds, NoBound>, Slips) {
    let (total, slips) = walk::total(data, law, v);
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
    let recovered = Some(recovered);
    Ok(Bounds { energy: below_zero(energy), error, recovered, ..Bounds::NONE })
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
