//! The gradient (8) of the modified functional and the step (12) of its multiplier, for every method here.

use super::Pair;
use crate::discrete::grid::Grid;
use crate::discrete::stiffness::residual_row;
use crate::problem::law::Law;

/// Parameters of the boundary term of (7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duality {
    /// Law on the boundary.
    pub law: Law,
    /// Duality parameter r > 0.
    pub r: f64,
}

/// Replaces `a` by `P(a - r y)` (12); returns the largest change, or `None` if a value is no longer finite.
pub(super) fn dual_step(
    Duality { law, r }: Duality,
    boundary: &[usize],
    pair: &mut Pair,
) -> Option<f64> {
    let (mut change, mut finite) = (0.0f64, true);
    for (a, &node) in pair.a.iter_mut().zip(boundary) {
        let next = *a - r * pair.y[node];
        finite &= next.is_finite();
        let next = law.project(next);
        change = change.max((next - *a).abs());
        *a = next;
    }
    finite.then_some(change)
}

/// Extrema of the gradient (8) over all nodes.
#[derive(Clone, Copy)]
pub(super) struct Extrema {
    /// Largest component.
    pub(super) signed: f64,
    /// Largest absolute value.
    pub(super) absolute: f64,
}

/// The gradient (8) of the modified functional with respect to y, evaluated row by row.
pub(super) struct Gradient {
    grid: Grid,
    duality: Duality,
    /// Lumped mass of the proximal term, added to the diagonal as in [`super::sweep::GaussSeidel`].
    shift: f64,
    row: Vec<f64>,
    /// Row that failed the last comparison: the likeliest to fail the next.
    failed: usize,
}

impl Gradient {
    pub(super) fn new(grid: Grid, duality: Duality, shift: f64) -> Self {
        Self { grid, duality, shift, row: vec![0.0; grid.side()], failed: 0 }
    }

    fn evaluate(&mut self, j: usize, load: &[f64], pair: &Pair) {
        let (grid, n) = (self.grid, self.grid.cells());
        residual_row(grid, j, &pair.y, load, &mut self.row);
        let y = &pair.y[j * grid.side()..][..grid.side()];
        if self.shift > 0.0 {
            let mass = if j == 0 || j == n { 0.5 * self.shift } else { self.shift };
            self.row.iter_mut().zip(y).for_each(|(g, y)| *g += mass * y);
            self.row[0] -= 0.5 * mass * y[0];
            self.row[n] -= 0.5 * mass * y[n];
        }
        if j == 0 || j == n {
            for (i, &value) in y.iter().enumerate() {
                self.subtract_reaction(i, j, pair, value);
            }
        } else {
            self.subtract_reaction(0, j, pair, y[0]);
            self.subtract_reaction(n, j, pair, y[n]);
        }
    }

    /// Subtracts `h P(a - r y)`, the term of the boundary node in column `i` and row `j`, from the row.
    #[inline(always)]
    fn subtract_reaction(&mut self, i: usize, j: usize, pair: &Pair, y: f64) {
        let a = pair.a[self.grid.boundary_index(i, j)];
        self.row[i] -= self.grid.h() * self.duality.law.project(a - self.duality.r * y);
    }

    /// True if every component, or its absolute value, is at most `tolerance`; NaN never is.
    #[expect(clippy::needless_bitwise_bool, reason = "a row without early exit vectorises")]
    pub(super) fn within(
        &mut self,
        load: &[f64],
        pair: &Pair,
        tolerance: f64,
        absolute: bool,
    ) -> bool {
        let side = self.grid.side();
        let first = self.failed;
        for k in 0..side {
            let j = (first + k) % side;
            self.evaluate(j, load, pair);
            // No early exit inside a row, so that the comparison vectorises.
            let ok = if absolute {
                self.row.iter().fold(true, |ok, g| ok & (g.abs() <= tolerance))
            } else {
                self.row.iter().fold(true, |ok, g| ok & (*g <= tolerance))
            };
            if !ok {
                self.failed = j;
                return false;
            }
        }
        true
    }

    /// Returns the extrema over all components; both are NaN if any component is.
    pub(super) fn extrema(&mut self, load: &[f64], pair: &Pair) -> Extrema {
        let (mut signed, mut absolute) = (f64::NEG_INFINITY, 0.0);
        for j in 0..self.grid.side() {
            self.evaluate(j, load, pair);
            for &g in &self.row {
                if g.is_nan() {
                    return Extrema { signed: f64::NAN, absolute: f64::NAN };
                }
                signed = signed.max(g);
                absolute = g.abs().max(absolute);
            }
        }
        Extrema { signed, absolute }
    }
}
