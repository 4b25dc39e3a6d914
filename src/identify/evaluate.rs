//! One candidate against one table: forced and free runs, grid by grid.

use super::engine::{LANES, Lane, Level};
use super::space::Geometry;
use super::variant::Variant;
use super::{COARSEST, IdentifyError, Target};
use crate::discrete::grid::Grid;
use crate::discrete::load::load;
use crate::discrete::transfer::Prolongation;
use crate::saddle::tolerance;
use std::sync::Arc;

/// Misfit of a stop that comes too early, beyond what the measure lacks: a stop is a stop.
const EARLY: f64 = 0.02;
/// Largest misfit of one cell; beyond it the size says nothing.
const CELL_CAP: f64 = 3.0;
/// Iterations a free run makes on a grid, in multiples of the largest published count, plus this many.
const FREE_FACTOR: usize = 4;
const FREE_EXTRA: usize = 20;

/// When a forced run is given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Total misfit above which nothing more is wanted.
    pub misfit: f64,
    /// Number of coarse grids on which no misfit at all is allowed.
    pub exact_grids: usize,
}

impl Limit {
    /// The run goes to its end.
    pub const NONE: Self = Self { misfit: f64::INFINITY, exact_grids: 0 };
    /// The run ends at the first count that does not come out.
    pub const EXACT: Self = Self { misfit: 0.0, exact_grids: 0 };
}

/// What a forced run says: how far each published count is from coming out.
#[derive(Clone, Debug, PartialEq)]
pub struct Forced {
    /// `misfit[k][level]`: zero if and only if row k stops there at the published count, given
    /// that it did so on the coarser grids.
    pub misfit: Vec<Vec<f64>>,
    /// Change of the multiplier in the last iteration on the finest grid, one per row; empty if the
    /// run was cut short.
    pub delta_a: Vec<f64>,
    /// Grids run to the end before the misfit passed the limit.
    pub levels: usize,
    /// Sum of all entries of `misfit`.
    pub total: f64,
}

impl Forced {
    /// Whether every count comes out.
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

/// Runs candidates of some geometries under one variant against one table.
///
/// Everything that does not depend on the values of f is prepared once: the load vectors of the
/// pieces, of which that of f is the combination, and all buffers. Clone it for another thread.
pub struct Evaluator<'a> {
    target: &'a Target,
    variant: Variant,
    prolongation: Prolongation,
    r: Lane,
    /// `basis[geometry][level][p]`: load vector of the indicator of piece p.
    basis: Arc<Vec<Vec<Vec<Vec<f64>>>>>,
    levels: Vec<Level>,
    loads: Vec<Vec<f64>>,
    entered: Vec<u64>,
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
        let grid = |level: usize| Grid::new(COARSEST << level).expect("fine enough");
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
        let mut r = [1.0; LANES];
        r[..target.r.len()].copy_from_slice(&target.r);
        let grids =
            (0..target.levels()).map(|level| Grid::new(COARSEST << level).expect("fine enough"));
        Self {
            target,
            variant,
            prolongation,
            r,
            levels: grids.clone().map(|grid| Level::new(grid, &variant)).collect(),
            loads: grids.map(|grid| vec![0.0; grid.nodes()]).collect(),
            basis,
            entered: vec![0; target.levels()],
        }
    }

    /// How many runs have entered each grid so far.
    pub fn entered(&self) -> &[u64] {
        &self.entered
    }

    /// Makes the published number of iterations on every grid, for all rows.
    ///
    /// Gives up as soon as the misfit passes `limit`.
    ///
    /// # Panics
    /// If there is no such geometry, or not one value per piece.
    pub fn forced(&mut self, geometry: usize, values: &[f64], limit: Limit) -> Forced {
        let (rows, grids) = (self.target.r.len(), self.target.levels());
        let mut forced = Forced {
            misfit: vec![vec![0.0; grids]; rows],
            delta_a: Vec::new(),
            levels: 0,
            total: 0.0,
        };
        self.levels[0].reset();
        for level in 0..grids {
            self.combine(geometry, level, values);
            let mut delta_a = vec![0.0; rows];
            let last: Vec<usize> =
                (0..rows).map(|k| self.target.counts[k][level] + self.variant.uncounted).collect();
            let end = last.iter().copied().max().unwrap_or(0);
            let tolerance = tolerance(level + 1);
            let most = if level < limit.exact_grids { 0.0 } else { limit.misfit };
            for n in 1..=end {
                let (change, early) =
                    self.levels[level].iterate(&self.loads[level], &self.r, &self.variant);
                let ends = |k: usize| n == last[k];
                let mut running = [false; LANES];
                (0..rows).for_each(|k| running[k] = n <= last[k] && n > self.variant.uncounted);
                // Before its last iteration a lane only has to be above the tolerance.
                let settled = early.is_none()
                    && !(0..rows).any(ends)
                    && self.levels[level].surely_above(
                        &self.loads[level],
                        &self.r,
                        self.variant.measure,
                        &running,
                        tolerance,
                    );
                if !settled {
                    let measure = early.unwrap_or_else(|| {
                        self.levels[level].gradient_noting(
                            &self.loads[level],
                            &self.r,
                            self.variant.measure,
                        )
                    });
                    for k in (0..rows).filter(|&k| running[k]) {
                        let cell = &mut forced.misfit[k][level];
                        *cell = (*cell + misfit(measure[k], tolerance, ends(k))).min(CELL_CAP);
                    }
                    let so_far: f64 = forced.misfit.iter().map(|row| row[level]).sum();
                    if forced.total + so_far > most {
                        forced.total += so_far;
                        return forced;
                    }
                }
                for k in (0..rows).filter(|&k| ends(k)) {
                    delta_a[k] = change[k];
                    self.pass_on(level, k);
                }
            }
            forced.levels = level + 1;
            forced.total += forced.misfit.iter().map(|row| row[level]).sum::<f64>();
            if level + 1 == grids {
                forced.delta_a = delta_a;
            }
        }
        forced
    }

    /// The table of counts as the stopping rule gives it.
    ///
    /// # Panics
    /// If there is no such geometry, or not one value per piece.
    pub fn free(&mut self, geometry: usize, values: &[f64]) -> Table {
        let (rows, grids) = (self.target.r.len(), self.target.levels());
        let mut table = Table { counts: vec![vec![None; grids]; rows], delta_a: vec![0.0; rows] };
        self.levels[0].reset();
        for level in 0..grids {
            self.combine(geometry, level, values);
            let tolerance = tolerance(level + 1);
            let most = (0..rows).map(|k| self.target.counts[k][level]).max().unwrap_or(0);
            let mut done = [true; LANES];
            done[..rows].fill(false);
            for n in 1..=FREE_FACTOR * most + FREE_EXTRA {
                let (change, early) =
                    self.levels[level].iterate(&self.loads[level], &self.r, &self.variant);
                (0..rows).filter(|&k| !done[k]).for_each(|k| table.delta_a[k] = change[k]);
                let Some(counted) = n.checked_sub(self.variant.uncounted).filter(|&c| c > 0) else {
                    continue;
                };
                let running = done.map(|done| !done);
                let load = &self.loads[level];
                if early.is_none()
                    && self.levels[level].surely_above(
                        load,
                        &self.r,
                        self.variant.measure,
                        &running,
                        tolerance,
                    )
                {
                    continue;
                }
                let measure = early.unwrap_or_else(|| {
                    self.levels[level].gradient_noting(load, &self.r, self.variant.measure)
                });
                for k in 0..rows {
                    if !done[k] && measure[k] <= tolerance {
                        done[k] = true;
                        table.counts[k][level] = Some(counted);
                        self.pass_on(level, k);
                    }
                }
                if done.iter().all(|&done| done) {
                    break;
                }
            }
            (0..rows).filter(|&k| !done[k]).for_each(|k| self.pass_on(level, k));
        }
        table
    }

    fn pass_on(&mut self, level: usize, k: usize) {
        if let [coarse, fine, ..] = &mut self.levels[level..] {
            fine.start_from(coarse, k, self.prolongation, self.variant.prolong_multiplier);
        }
    }

    fn combine(&mut self, geometry: usize, level: usize, values: &[f64]) {
        self.entered[level] += 1;
        let (basis, load) = (&self.basis[geometry][level], &mut self.loads[level]);
        assert_eq!(values.len(), basis.len());
        load.fill(0.0);
        for (piece, &value) in basis.iter().zip(values) {
            for (f, p) in load.iter_mut().zip(piece) {
                *f += value * p;
            }
        }
    }
}

impl Clone for Evaluator<'_> {
    fn clone(&self) -> Self {
        Self::with_basis(self.target, self.variant, Arc::clone(&self.basis))
    }
}

/// By how much a measure fails what its place in the run asks for.
fn misfit(measure: f64, tolerance: f64, last: bool) -> f64 {
    if measure.is_nan() {
        CELL_CAP
    } else if last {
        if measure > tolerance { libm::log(measure / tolerance) } else { 0.0 }
    } else if measure <= tolerance {
        EARLY + (1.0 - measure / tolerance).min(CELL_CAP)
    } else {
        0.0
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
