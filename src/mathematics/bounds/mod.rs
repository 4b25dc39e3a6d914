//! Guaranteed two-sided bounds of the energy and of the error of a finite element solution on the square.
//!
//! # The identity
//! Let K be the functions of H^1 that are not negative on the boundary, J(v) = 1/2 |grad v|^2 - (f, v), and
//! sigma a *flux*: `-div sigma = f` inside, `sigma.n >= 0` on the boundary. For w in K integration by parts
//! gives
//!
//! ```text
//! J(w) + 1/2 |sigma|^2 = 1/2 |grad w - sigma|^2 + <sigma.n, w> =: G(w, sigma),
//! ```
//!
//! and the same with the solution u, whose flux is `grad u`, in place of either. So J(u) lies between
//! J(w) - G and J(w), and `1/2 |grad (u - v)|^2 <= J(v) - J(u)` for v in K, with equality where v vanishes on
//! the contact set. No constant of Poincaré's or of the trace appears: that the problem is only
//! semicoercive does not matter. (Prager and Synge 1947; for Signorini's problem Bartels, Gudi and
//! Kaltenbach, arXiv 2407.10912.) Nothing is asked of v: iteration errors, wrong loads and wrong
//! solutions make the bounds wide, not wrong.
//!
//! # The flux
//! Horizontal differences of the nodal vector over h, at the middles of edges, are coefficients of
//! B-splines of degree 2 in x and 1 in y; vertical ones the other way round. Beyond the boundary the vector
//! is continued by reflection plus twice the reaction, which makes `sigma.n` the linear interpolant of the
//! reactions (`flux.rs`). The divergence of this *spline flux* is the bilinear interpolant of what the
//! five-point stencil gives at the nodes: f, where f is constant. Where f jumps, its moments over the cells
//! give corrections in closed form: fluxes through edges that move the integrals of f times the bilinear
//! hat functions to the cells, and a field inside the cell. In the spirit of Braess and Schöberl (Math.
//! Comp. 77, 2008), but of second order, since the spline averages a flux on the dual grid (Luce and
//! Wohlmuth, SIAM J. Numer. Anal. 42, 2004) over one cell.
//!
//! What is left adds to `|grad w - sigma|`: the distance of f from a bilinear function in cells that a jump
//! cuts, times `h / (2 pi)` (Poincaré's constant on bilinear complements); and the residual of the
//! five-point equation, which holds iteration errors and what the load vector differs from the integrals
//! against bilinear hats (`residual.rs`). If that vector has the integrals against linear hats, and jumps cut cells,
//! the difference is the divergence of fluxes in closed form (`strip.rs`), which leave less of it than half.
//!
//! # The recovery
//! w is the bilinear interpolant less a bubble on each edge that makes its slopes those of the flux, blended
//! over the cells; on the boundary the bubbles are cut so that w stays in K ([`recovery`]). J(w) is within
//! O(h^3) of J(u), and with it the whole bracket; J(v) is within O(h^2). The error of v is then bracketed by
//! `2 (J(v) - J(w) + G)` and, with the bubbles on the boundary left out, `2 (J(v) - J(w'))`.
//!
//! # Cost and rounding
//! One pass over the vector, row by row, with closed forms for all integrals (`cells.rs`), summed over many cells
//! side by side. Where f is constant around a cell they are quadratic forms of the twelve values there
//! (`regular.rs`). The bounds are widened by what rounding errors can add up to in sums of `n` terms.

mod cells;
mod data;
mod flux;
mod moments;
mod recovery;
mod regular;
mod residual;
mod strip;
mod walk;

use crate::discrete::grid::Grid;
use crate::problem::source::Source;
use std::borrow::Cow;
use std::f64::consts::PI;

/// What is guaranteed of a finite element solution, up to the quadrature of an f that is not piecewise
/// constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Ends of an interval that holds the energy J(u) of the true solution u.
    pub energy: [f64; 2],
    /// Ends of an interval that holds the L2 norm of `grad (u - v)`, v piecewise linear on triangles cut by
    /// rising diagonals.
    pub error: [f64; 2],
    /// A bound of the L2 norm of `grad (u - w)`, w the recovery, which is piecewise quadratic.
    pub recovered: f64,
}

impl Bounds {
    /// A bound of the error relative to `|grad u|`; infinite where that cannot be told from zero.
    pub fn relative(&self) -> f64 {
        // |grad u|^2 = -2 J(u), as the reactions do no work on u.
        let size = (-2.0 * self.energy[1]).max(0.0).sqrt();
        if size > 0.0 { self.error[1] / size } else { f64::INFINITY }
    }

    /// The width of the bracket of the energy over |J(u)|; infinite where that cannot be told from zero.
    pub fn relative_energy(&self) -> f64 {
        let [low, high] = self.energy;
        // J(u) is at most zero.
        if high < 0.0 { (high - low) / -high } else { f64::INFINITY }
    }
}

/// Why there is no bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoBound {
    /// The continuous problem has no, or no unique, solution.
    #[error("the integral of f is not negative")]
    NotCoercive,
    /// A sum overflowed, squares underflow, or the vector holds no number somewhere.
    #[error("numbers exceed the range of double precision")]
    NotFinite,
}

/// Least integral of |f|: below, what underflows from squares is no longer small beside rounding errors of the energy,
/// `sqrt(f64::MIN_POSITIVE / f64::EPSILON)`.
const LEAST_MASS: f64 = 1e-146;

/// Bounds for the nodal vector `y` as an approximation of the solution for f, however it came about.
///
/// # Errors
/// If the integral of f is not negative, or numbers exceed the range of double precision.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn bounds(grid: Grid, f: &Source, y: &[f64]) -> Result<Bounds, NoBound> {
    summed(grid, f, y, None)
}

/// The recovery w of `y` on the grid of half the width, whose nodes determine it, and the bounds.
///
/// # Errors
/// As [`bounds`].
///
/// # Panics
/// As [`bounds`].
pub fn recovery(grid: Grid, f: &Source, y: &[f64]) -> Result<(Vec<f64>, Bounds), NoBound> {
    let side = 2 * grid.cells() + 1;
    let mut recovered = vec![0.0; side * side];
    let bounds = summed(grid, f, y, Some(&mut recovered))?;
    Ok((recovered, bounds))
}

fn summed(
    grid: Grid,
    f: &Source,
    y: &[f64],
    recovered: Option<&mut [f64]>,
) -> Result<Bounds, NoBound> {
    assert_eq!(y.len(), grid.nodes());
    let n = grid.cells();
    let (v, moved) = admissible(grid, y);
    let walk::Total { sums, work, trace, residual, largest, mass } =
        walk::total(grid, f, &v, recovered)?;
    if mass < LEAST_MASS {
        return Err(NoBound::NotFinite);
    }
    let size = sums.recovered + 2.0 * largest * mass;
    // No sum has more terms one after the other than a row of cells has, and some.
    let rounding = (n + 300) as f64 * f64::EPSILON * size;
    // Differences of rounded values, were all errors of one sign: in the residual, and in the flux.
    let noise = (8.0 * n as f64 / PI + 16.0) * n as f64 * f64::EPSILON * largest;
    let distance = sums.distance.sqrt() + residual + noise;
    let gap = 0.5 * distance * distance + work;
    let upper = 0.5 * sums.recovered - sums.recovered_load;
    let linear = 0.5 * sums.linear - sums.linear_load;
    let above = 2.0 * (linear - upper + gap + 2.0 * rounding);
    let below = 2.0 * (linear - upper - trace - 2.0 * rounding);
    let root = |square: f64| square.max(0.0).sqrt();
    let energy = [upper - gap - rounding, upper + rounding];
    // Its own rounding errors: it is a sum of two terms for each boundary node, none of them negative.
    let astray = (8 * n + 16) as f64 * f64::EPSILON * moved;
    let error = [(root(below) - moved - astray).max(0.0), root(above) + moved + astray];
    if !(energy[0].is_finite() && energy[1].is_finite() && above.is_finite() && moved.is_finite()) {
        return Err(NoBound::NotFinite);
    }
    let recovered = root(2.0 * (gap + 2.0 * rounding));
    Ok(Bounds { energy, error, recovered })
}

/// The nodal vector without its negative values on the boundary, and how far that is in the energy norm.
fn admissible(grid: Grid, y: &[f64]) -> (Cow<'_, [f64]>, f64) {
    let below: Vec<f64> = grid.boundary().map(|node| y[node].min(0.0)).collect();
    if below.iter().all(|&value| value == 0.0) {
        return (Cow::Borrowed(y), 0.0);
    }
    let mut v = y.to_vec();
    // A difference, as the maximum with zero would hide a NaN.
    grid.boundary().zip(&below).for_each(|(node, value)| v[node] -= value);
    // Edges on the boundary have weight 1/2, those inward 1.
    let mut square = 0.0;
    for (b, value) in below.iter().enumerate() {
        let next = below[(b + 1) % below.len()];
        square += 0.5 * (next - value) * (next - value);
        square += if grid.is_corner(b) { 0.0 } else { value * value };
    }
    (Cow::Owned(v), square.sqrt())
}
