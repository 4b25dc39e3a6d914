//! One candidate against one table: what is prepared once for all runs, and one iteration of them.

mod runs;

use super::moves::{MOST_ITERATIONS, greatest_moves};
use super::space::Geometry;
use super::variant::{ResidualTime, Variant};
use super::{IdentifyError, Target, grid};
use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::problem::law::Law;
use crate::saddle::batch::{LANES, Lanes, V};
use crate::saddle::{Engine, Goals, Method, Pair, RunState, run};
use crate::square::load::load;
use std::ops::{Add, Mul};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A table as the iteration gives it, when it stops by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// `counts[k][level]`; `None` where the iteration was given up.
    pub counts: Vec<Vec<Option<usize>>>,
    /// Last change of the multiplier on the finest grid, one per row.
    pub delta_a: Vec<f64>,
}

/// Runs candidates of some geometries under one variant against one table, in the lanes of `Lanes`.
///
/// Everything that does not depend on the values of f is prepared once: the load vectors of the
/// pieces, of which that of f is the combination, and all buffers. Clone it for another thread.
#[derive(Clone)]
pub struct Evaluator<'a> {
    target: &'a Target,
    variant: Variant,
    /// `basis[geometry][level][p]`: load vector of the indicator of piece p.
    basis: Arc<Vec<Vec<Vec<Vec<f64>>>>>,
    /// `moves[geometry][row][n - 1]`: how far the measure after n iterations on the coarsest grid moves at most with
    /// the values of f.
    moves: Arc<Vec<Vec<Vec<f64>>>>,
    grids: Vec<Grid>,
    /// Iterates on each grid.
    lanes: Vec<Lanes>,
    entered: Vec<u64>,
    /// When set, screenings are given up.
    halt: Option<&'a AtomicBool>,
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
        let basis = |geometry: &Geometry, level: usize| -> Vec<Vec<f64>> {
            let piece = |p| load(grid(level), &geometry.indicator(p), variant.load);
            (0..geometry.pieces()).map(piece).collect()
        };
        let levels = |geometry| (0..target.levels()).map(|level| basis(geometry, level)).collect();
        let basis: Vec<_> = geometries.iter().map(levels).collect();
        let moves = |basis: &Vec<Vec<Vec<f64>>>| {
            let of_row = |(&r, counts): (&f64, &Vec<usize>)| {
                let iterations = (counts[0] + variant.uncounted).min(MOST_ITERATIONS);
                greatest_moves(variant, r, &basis[0], iterations)
            };
            target.r.iter().zip(&target.counts).map(of_row).collect()
        };
        let moves: Vec<_> = basis.iter().map(moves).collect();
        let grids: Vec<_> = (0..target.levels()).map(grid).collect();
        let mut lanes = Vec::with_capacity(grids.len());
        for &grid in &grids {
            lanes.push(Lanes::new(grid, Law::SIGNORINI, variant.order, variant.corner_weight()));
        }
        Ok(Self {
            target,
            variant: *variant,
            basis: basis.into(),
            moves: moves.into(),
            grids,
            lanes,
            entered: vec![0; target.levels()],
            halt: None,
        })
    }

    /// Evaluator whose screenings discard all that is left once `halt` is set.
    pub fn halted_by(self, halt: &'a AtomicBool) -> Self {
        Self { halt: Some(halt), ..self }
    }

    /// The table that runs are compared with.
    pub(super) fn target(&self) -> &'a Target {
        self.target
    }

    /// Number of candidates whose screening has entered each grid so far, without those that passed it.
    pub fn entered(&self) -> &[u64] {
        &self.entered
    }

    /// Iterates on a grid in the lanes that have a limit, up to it; returns the ends, and in `pairs`, if they are
    /// wanted, the last pairs.
    ///
    /// `judge` is called in each iteration, when the variant evaluates the gradient, with the number of the iteration
    /// and the lanes that are under way; it returns the lanes that end.
    fn iterate(
        &mut self,
        level: usize,
        limits: [Option<usize>; LANES],
        pairs: Option<&mut [Pair]>,
        judge: impl FnMut(&mut Lanes, usize, [bool; LANES]) -> [bool; LANES],
    ) -> [Option<End>; LANES] {
        let time = self.variant.residual;
        let runs = limits.map(|limit| Some(RunState::new(Method::ArrowHurwicz, 0.0, limit?)));
        let (over, ends) = ([false; LANES], [None; LANES]);
        let mut judged = JudgedLanes { time, judge, number: 0, over, pairs, ends };
        run(&mut self.lanes[level], runs, &mut judged);
        judged.ends
    }

    /// The load vector of the f with these values.
    fn load(&self, geometry: usize, level: usize, values: &[f64]) -> Vec<f64> {
        let mut load = vec![0.0; self.grids[level].nodes()];
        combine(&mut load, &self.basis[geometry][level], values);
        load
    }

    /// Prepares one row for an f in each lane, from zero or from what the grid before has come to.
    fn enter_all(&mut self, geometry: usize, level: usize, values: [&[f64]; LANES], row: usize) {
        let (coarser, rest) = self.lanes.split_at_mut(level);
        let lanes = &mut rest[0];
        let of_piece = |p| V::of(values.map(|values| values[p]));
        let values: Vec<_> = (0..values[0].len()).map(of_piece).collect();
        let loads = lanes.enter_all(self.target.r[row]);
        combine(loads, &self.basis[geometry][level], &values);
        if let Some(coarser) = coarser.last() {
            lanes.prolong(coarser, self.variant.prolongation, self.variant.prolong_multiplier);
        }
    }
}

/// Goals that are judged when a variant evaluates the gradient.
struct JudgedLanes<'a, J> {
    time: ResidualTime,
    judge: J,
    /// Number of the last iteration.
    number: usize,
    /// Lanes that end.
    over: [bool; LANES],
    /// Last pairs, if they are wanted.
    pairs: Option<&'a mut [Pair]>,
    ends: [Option<End>; LANES],
}

impl<J> Goals<Lanes, LANES> for JudgedLanes<'_, J>
where
    J: FnMut(&mut Lanes, usize, [bool; LANES]) -> [bool; LANES],
{
    fn before_step(&mut self, lanes: &mut Lanes, runs: &[Option<RunState>; LANES]) {
        self.number += 1;
        if self.time == ResidualTime::BeforeDual {
            self.over = (self.judge)(lanes, self.number, runs.each_ref().map(Option::is_some));
        }
    }

    fn reached(&mut self, lanes: &mut Lanes, runs: [Option<&RunState>; LANES]) -> [bool; LANES] {
        if self.time == ResidualTime::AfterDual {
            self.over = (self.judge)(lanes, self.number, runs.map(|run| run.is_some()));
        }
        self.over
    }

    fn ended(&mut self, lanes: &mut Lanes, lane: usize, end: End) -> Option<RunState> {
        self.ends[lane] = Some(end);
        if let Some(pairs) = &mut self.pairs {
            pairs[lane] = lanes.pair(lane).into_owned();
        }
        None
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
