//! The engine on the square: the fast sweep, and the gradient (8) row by row.

use super::Pair;
use super::engine::{Engine, RunStart};
use super::plain::Duality;
use super::stopping::{GradientMeasure, GradientTerms, RoundingFloor, size};
use super::sweep::GaussSeidel;
use crate::discrete::grid::Grid;
use crate::discrete::stiffness::residual_row;
use crate::problem::law::Law;
use std::borrow::Cow;

/// One run on the square.
pub(super) struct OnSquare<'a> {
    grid: Grid,
    duality: Duality,
    load: &'a [f64],
    /// Load vector of the inner problem: F plus `shift y^k`, halved on edges, quartered at corners.
    target: Cow<'a, [f64]>,
    /// Diagonal entry `c h^2` of the proximal term at an interior node.
    shift: f64,
    /// Positions of the boundary nodes in a nodal vector, in boundary order.
    boundary: Vec<usize>,
    gradient: Gradient,
    /// Gradient of the inner problem, with the proximal term.
    inner: Gradient,
    /// Iterates.
    pair: Pair,
}

impl<'a> OnSquare<'a> {
    /// Prepares a run.
    ///
    /// # Panics
    /// If a vector has the wrong length for `grid`, or r is not positive.
    pub(super) fn new(
        grid: Grid,
        law: Law,
        &RunStart { load, method, r, pair }: &RunStart<'a>,
    ) -> Self {
        assert!(r > 0.0, "the duality parameter r must be positive");
        assert!(load.len() == grid.nodes() && pair.y.len() == load.len());
        assert!(pair.a.len() == grid.boundary_nodes());
        let shift = method.weight() * grid.h() * grid.h();
        let duality = Duality { law, r };
        let mut engine = Self {
            grid,
            duality,
            load,
            target: load.into(),
            shift,
            boundary: grid.boundary().collect(),
            gradient: Gradient::new(grid, duality, 0.0),
            inner: Gradient::new(grid, duality, shift),
            pair: pair.clone(),
        };
        engine.centre(0);
        engine
    }

    /// Gradient that a measure is of, with its load vector and the pair.
    fn measured(&mut self, measure: GradientMeasure) -> (&mut Gradient, RowData<'_>) {
        let Self { load, target, gradient, inner, pair, .. } = self;
        match measure {
            GradientMeasure::Inner => (inner, RowData { load: target, pair, measure }),
            _ => (gradient, RowData { load, pair, measure }),
        }
    }
}

impl Engine<1> for OnSquare<'_> {
    fn sweep(&mut self) {
        let Self { grid, duality, target, shift, pair: Pair { y, a }, .. } = self;
        GaussSeidel::new(*grid, target, *shift, *duality, a).sweep(y);
    }

    fn dual_step(&mut self, _: [bool; 1]) -> [f64; 1] {
        [self.duality.step(self.boundary.iter().copied(), &mut self.pair)]
    }

    fn centre(&mut self, _: usize) {
        if self.shift > 0.0 {
            let (n, side) = (self.grid.cells(), self.grid.side());
            for (k, target) in self.target.to_mut().iter_mut().enumerate() {
                let weights =
                    [k % side, k / side].map(|i| if i == 0 || i == n { 0.5 } else { 1.0 });
                *target = self.load[k] + weights[0] * weights[1] * self.shift * self.pair.y[k];
            }
        }
    }

    fn within(&mut self, measure: GradientMeasure, [bound]: [Option<f64>; 1]) -> [bool; 1] {
        let (gradient, data) = self.measured(measure);
        [bound.is_some_and(|bound| gradient.within(&data, bound))]
    }

    fn worst(&mut self, measure: GradientMeasure) -> [f64; 1] {
        let (gradient, data) = self.measured(measure);
        [gradient.worst(&data)]
    }

    fn floor(&self, _: usize) -> RoundingFloor {
        GradientTerms::on_square(self.grid, self.shift, self.duality.r)
            .floor([&self.target[..], &self.pair.y, &self.pair.a].map(size))
    }

    fn pair(&self, _: usize) -> Cow<'_, Pair> {
        Cow::Borrowed(&self.pair)
    }
}

/// Gradient (8) of the modified functional with respect to y, evaluated row by row.
struct Gradient {
    grid: Grid,
    duality: Duality,
    /// Lumped mass of the proximal term, added to the diagonal as in [`GaussSeidel`].
    shift: f64,
    row: Vec<f64>,
    /// Row that failed the last comparison: the likeliest to fail the next.
    failed: usize,
}

/// Load vector and pair at which a measure is evaluated.
struct RowData<'a> {
    load: &'a [f64],
    pair: &'a Pair,
    measure: GradientMeasure,
}

impl Gradient {
    fn new(grid: Grid, duality: Duality, shift: f64) -> Self {
        Self { grid, duality, shift, row: vec![0.0; grid.side()], failed: 0 }
    }

    /// Writes row `j` of the gradient, for [`GradientMeasure::Kkt`] with the residuals of the law at boundary nodes.
    fn evaluate(&mut self, j: usize, &RowData { load, pair, measure }: &RowData<'_>) {
        let (grid, n) = (self.grid, self.grid.cells());
        residual_row(grid, j, &pair.y, load, &mut self.row);
        let y = &pair.y[j * grid.side()..][..grid.side()];
        if self.shift > 0.0 {
            let mass = if j == 0 || j == n { 0.5 * self.shift } else { self.shift };
            self.row.iter_mut().zip(y).for_each(|(g, y)| *g += mass * y);
            self.row[0] -= 0.5 * mass * y[0];
            self.row[n] -= 0.5 * mass * y[n];
        }
        let step = if j == 0 || j == n { 1 } else { n };
        for i in (0..=n).step_by(step) {
            if measure == GradientMeasure::Kkt {
                self.row[i] = self.duality.law.residual(y[i], self.row[i], grid.h());
            } else {
                self.subtract_reaction(i, j, pair, y[i]);
            }
        }
    }

    /// Subtracts `h P(a - r y)`, the term of the boundary node in column `i` and row `j`, from the row.
    #[inline(always)]
    fn subtract_reaction(&mut self, i: usize, j: usize, pair: &Pair, y: f64) {
        let a = pair.a[self.grid.boundary_index(i, j)];
        self.row[i] -= self.grid.h() * self.duality.law.project(a - self.duality.r * y);
    }

    /// True if the measure of every component is at most `bound`; NaN never is.
    #[expect(clippy::needless_bitwise_bool, reason = "a row without early exit vectorises")]
    fn within(&mut self, data: &RowData<'_>, bound: f64) -> bool {
        let side = self.grid.side();
        let first = self.failed;
        for k in 0..side {
            let j = (first + k) % side;
            self.evaluate(j, data);
            // No early exit inside a row, so that the comparison vectorises.
            let ok = if data.measure == GradientMeasure::Signed {
                self.row.iter().fold(true, |ok, g| ok & (*g <= bound))
            } else {
                self.row.iter().fold(true, |ok, g| ok & (g.abs() <= bound))
            };
            if !ok {
                self.failed = j;
                return false;
            }
        }
        true
    }

    /// Returns the largest measure of a component, NaN if one is.
    fn worst(&mut self, data: &RowData<'_>) -> f64 {
        let mut worst = f64::NEG_INFINITY;
        for j in 0..self.grid.side() {
            self.evaluate(j, data);
            for &g in &self.row {
                if g.is_nan() {
                    return g;
                }
                worst = worst.max(data.measure.of(g));
            }
        }
        worst
    }
}
