//! One candidate against one table: what is prepared once for all runs, and one iteration of them.

mod runs;

use super::space::Geometry;
use super::variant::{ResidualTime, Variant};
use super::{COARSEST, IdentifyError, Target};
use crate::discrete::grid::Grid;
use crate::discrete::load::load;
use crate::discrete::transfer::Prolongation;
use crate::problem::law::Law;
use crate::saddle::Pair;
use crate::saddle::batch::{GradientMeasure, LANES, Lanes, V};
use std::ops::{Add, Mul};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Result of a forced run: misfit of each published count.
#[derive(Clone, Debug, PartialEq)]
pub struct Forced {
    /// `misfit[k][level]`: zero if and only if row k stops there at the published count, given
    /// that it did so on the coarser grids.
    pub misfit: Vec<Vec<f64>>,
    /// Change of the multiplier in the last iteration on the finest grid, one per row; empty if the
    /// run was cut short.
    pub delta_a: Vec<f64>,
    /// Sum of all entries of `misfit`.
    pub total: f64,
}

impl Forced {
    /// True if every count comes out.
    pub fn is_exact(&self) -> bool {
        self.total == 0.0 && !self.delta_a.is_empty()
    }
}

/// A table as the iteration gives it, when it stops by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// `counts[k][level]`; `None` where the iteration was given up.
    pub counts: Vec<Vec<Option<usize>>>,
    /// Last change of the multiplier on the finest grid, one per row.
    pub delta_a: Vec<f64>,
}

/// Runs candidates of some geometries under one variant against one table, in the lanes of [`Lanes`].
///
/// Everything that does not depend on the values of f is prepared once: the load vectors of the
/// pieces, of which that of f is the combination, and all buffers. Clone it for another thread.
pub struct Evaluator<'a> {
    target: &'a Target,
    variant: Variant,
    prolongation: Prolongation,
    /// `basis[geometry][level][p]`: load vector of the indicator of piece p.
    basis: Arc<Vec<Vec<Vec<Vec<f64>>>>>,
    levels: Vec<Level>,
    entered: Vec<u64>,
    /// When set, forced runs and screenings are given up.
    halt: Option<&'a AtomicBool>,
}

/// A grid with the iterates on it.
struct Level {
    grid: Grid,
    lanes: Lanes,
    /// In each lane, the node that last failed the comparison: the likeliest to fail next.
    witness: [usize; LANES],
}

impl<'a> Evaluator<'a> {
    /// Prepares the load vectors and buffers.
    ///
    /// # Errors
    /// [`IdentifyError`] if the target is not a table.
    pub fn new(
        target: &'a Target,
        variant: &Variant,
        geometries: &[Geometry],
    ) -> Result<Self, IdentifyError> {
        target.validate()?;
        let (against_x, against_y) = variant.mirrored();
        let basis = |geometry: &Geometry, level: usize| -> Vec<Vec<f64>> {
            let grid = grid(level);
            let turn = |v: Vec<f64>| mirror(grid, v, against_x, against_y);
            let piece = |p| turn(load(grid, &geometry.indicator(p), variant.load));
            (0..geometry.pieces()).map(piece).collect()
        };
        let levels = |geometry| (0..target.levels()).map(|level| basis(geometry, level)).collect();
        let basis: Vec<_> = geometries.iter().map(levels).collect();
        Ok(Self::with_basis(target, *variant, basis.into()))
    }

    fn with_basis(
        target: &'a Target,
        variant: Variant,
        basis: Arc<Vec<Vec<Vec<Vec<f64>>>>>,
    ) -> Self {
        let (against_x, against_y) = variant.mirrored();
        let prolongation = match variant.prolongation {
            // Turning the square over once swaps its diagonals.
            Prolongation::RisingDiagonal if against_x != against_y => Prolongation::FallingDiagonal,
            Prolongation::FallingDiagonal if against_x != against_y => Prolongation::RisingDiagonal,
            rule => rule,
        };
        let level = |level| {
            let grid = grid(level);
            let lanes = Lanes::new(grid, Law::SIGNORINI, variant.order, variant.corner_weight());
            Level { grid, lanes, witness: [0; LANES] }
        };
        let levels = (0..target.levels()).map(level).collect();
        let entered = vec![0; target.levels()];
        Self { target, variant, prolongation, levels, basis, entered, halt: None }
    }

    /// Evaluator whose forced runs end as one that misses every count once `halt` is set.
    pub fn halted_by(self, halt: &'a AtomicBool) -> Self {
        Self { halt: Some(halt), ..self }
    }

    /// The table that runs are compared with.
    pub(super) fn target(&self) -> &'a Target {
        self.target
    }

    fn is_halted(&self) -> bool {
        self.halt.is_some_and(|halt| halt.load(Ordering::Relaxed))
    }

    /// Number of runs that have entered each grid so far.
    pub fn entered(&self) -> &[u64] {
        &self.entered
    }

    /// Sweep and dual step; `judge` is called when the variant evaluates the gradient.
    fn iterate(
        &mut self,
        level: usize,
        mut judge: impl FnMut(&mut Level, GradientMeasure),
    ) -> [f64; LANES] {
        let (at, measure) = (&mut self.levels[level], self.variant.measure.in_lanes());
        at.lanes.sweep();
        let early = self.variant.residual == ResidualTime::BeforeDual;
        if early {
            judge(at, measure);
        }
        let change = at.lanes.step([true; LANES]);
        if !early {
            judge(at, measure);
        }
        change
    }

    /// The load vector of the f with these values.
    fn load(&self, geometry: usize, level: usize, values: &[f64]) -> Vec<f64> {
        let mut load = vec![0.0; self.levels[level].grid.nodes()];
        combine(&mut load, &self.basis[geometry][level], values);
        load
    }

    /// Prepares one row for an f in each lane, from zero or from what the grid before has come to.
    fn enter_all(&mut self, geometry: usize, level: usize, values: [&[f64]; LANES], row: usize) {
        let (coarser, rest) = self.levels.split_at_mut(level);
        let at = &mut rest[0];
        let of_piece = |p| V(values.map(|values| values[p]));
        let values: Vec<_> = (0..values[0].len()).map(of_piece).collect();
        let loads = at.lanes.enter_all(self.target.r[row]);
        combine(loads, &self.basis[geometry][level], &values);
        if let Some(coarser) = coarser.last() {
            let multiplier = self.variant.prolong_multiplier;
            at.lanes.prolong(&coarser.lanes, self.prolongation, multiplier);
        }
    }

    /// Pair from which lane `k` starts on the next grid.
    fn passed_on(&self, level: usize, k: usize) -> Pair {
        let Level { grid, lanes, .. } = &self.levels[level];
        let mut pair = lanes.pair(k).prolonged(*grid, self.prolongation);
        if !self.variant.prolong_multiplier {
            pair.a.fill(0.0);
        }
        pair
    }
}

/// Sets the load of the f with these values on the pieces; or loads, one in each lane.
fn combine<T>(load: &mut [T], basis: &[Vec<f64>], values: &[T])
where
    T: Copy + Default + Add<Output = T> + Mul<f64, Output = T>,
{
    assert_eq!(values.len(), basis.len());
    load.fill(T::default());
    for (&value, piece) in values.iter().zip(basis) {
        for (load, &share) in load.iter_mut().zip(piece) {
            *load = *load + value * share;
        }
    }
}

/// The grid of a column of the table.
pub(super) fn grid(level: usize) -> Grid {
    Grid::new(COARSEST << level).expect("fine enough")
}

impl Clone for Evaluator<'_> {
    fn clone(&self) -> Self {
        let basis = Arc::clone(&self.basis);
        Self { halt: self.halt, ..Self::with_basis(self.target, self.variant, basis) }
    }
}

fn mirror(grid: Grid, mut v: Vec<f64>, against_x: bool, against_y: bool) -> Vec<f64> {
    if against_x {
        v.chunks_exact_mut(grid.side()).for_each(<[f64]>::reverse);
    }
    if against_y {
        v = v.chunks_exact(grid.side()).rev().flatten().copied().collect();
    }
    v
}
