//! Runs over nested grids and networks: on each from the interpolated pair of the one before.

use super::Pair;
use super::solve::{Iteration, OnIteration, Params, solve};
use crate::discrete::domain::DiscreteDomain;
use crate::discrete::end::Outcome;
use crate::discrete::grid::Grid;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::norms::largest;
use crate::discrete::stop::Stop;
use crate::discrete::transfer::{Prolongation, prolong, prolong_boundary};
use crate::problem::law::Law;

/// Returns the paper's tolerance on its `level`-th grid, counted from 1: `10^-level`.
pub fn tolerance(level: usize) -> f64 {
    // A power of ten up to 10^22 is exact, so that the quotient is the double nearest to 10^-level.
    1.0 / 10f64.powi(level as i32)
}

/// Nested grids or networks, coarsest first.
pub trait NestedLevels {
    /// Number of grids or networks.
    fn count(&self) -> usize;

    /// The k-th grid or network, counted from 0.
    fn domain(&self, k: usize) -> DiscreteDomain<'_>;

    /// Linear interpolation of a pair from the grid or network before the k-th one.
    fn interpolated(&self, k: usize, coarse: &Pair) -> Pair;
}

/// Nested grids of the square, and how pairs on them are interpolated.
#[derive(Clone, Copy, Debug)]
pub struct NestedGrids<'a> {
    /// Grids, coarsest first, as [`crate::discrete::grid::nested`] gives them.
    pub grids: &'a [Grid],
    /// Interpolation to the next grid.
    pub prolongation: Prolongation,
}

impl NestedLevels for NestedGrids<'_> {
    fn count(&self) -> usize {
        self.grids.len()
    }

    fn domain(&self, k: usize) -> DiscreteDomain<'_> {
        self.grids[k].into()
    }

    fn interpolated(&self, k: usize, Pair { y, a }: &Pair) -> Pair {
        Pair { y: prolong(self.grids[k - 1], y, self.prolongation), a: prolong_boundary(a) }
    }
}

impl NestedLevels for [NestedNetwork] {
    fn count(&self) -> usize {
        self.len()
    }

    fn domain(&self, k: usize) -> DiscreteDomain<'_> {
        (&self[k].network).into()
    }

    fn interpolated(&self, k: usize, Pair { y, a }: &Pair) -> Pair {
        let a = self[k].interpolate_boundary(&self[k - 1].network, a);
        Pair { y: self[k].interpolate(y), a }
    }
}

/// Does the work on each level in turn, from pairs on the coarsest one and then from the interpolated pairs.
///
/// `on_level` receives the number of the level, counted from 0, and the pairs, which it changes.
///
/// # Errors
/// The first error of `on_level`; the pairs are then those on its level.
pub fn run_nested<L: NestedLevels + ?Sized, P: AsMut<[Pair]> + ?Sized, E>(
    levels: &L,
    pairs: &mut P,
    mut on_level: impl FnMut(usize, &mut P) -> Result<(), E>,
) -> Result<(), E> {
    for k in 0..levels.count() {
        if k > 0 {
            pairs.as_mut().iter_mut().for_each(|pair| *pair = levels.interpolated(k, pair));
        }
        on_level(k, pairs)?;
    }
    Ok(())
}

/// Observer of a run over nested grids or networks; every method has a default that does nothing.
pub trait Monitor {
    /// True if [`Monitor::iteration`] is to be called, which makes each iteration more expensive.
    fn wants_iterations(&self) -> bool {
        false
    }

    /// Called after each iteration on this level, counted from 1.
    fn iteration(&mut self, _level: usize, _iteration: &Iteration) {}

    /// Called before sparse factors of the finest level, with so many nodes, are made again and again, which takes
    /// time.
    fn factors(&mut self, _nodes: usize) {}

    /// Called at the end on each level, counted from 1, with the last pair.
    fn level(&mut self, _level: usize, _pair: &Pair) {}
}

/// The observer that does nothing.
impl Monitor for () {}

/// Part of the largest component of the load to which minimisations of Uzawa's method are exact; the sweeps of one grow
/// with the digits.
const EXACT: f64 = 1e-6;

/// Solves on each level in turn, starting from zero and then from the interpolated pair.
///
/// On the k-th level `params.tolerance` is replaced by [`tolerance`]`(k)`, and the inner bound of Uzawa's method by a
/// tenth of this, or of the KKT residual that ends the run; where that is a tiny part of the load, minimisations are
/// loose. Returns the outcome on each level and
/// the last pair; ends after a level on which the iteration diverged.
///
/// # Panics
/// If there are no levels, a load vector has the wrong length, or `params.r` is not positive.
pub fn solve_nested<L: NestedLevels + ?Sized>(
    levels: &L,
    law: Law,
    loads: &[Vec<f64>],
    params: &Params,
    monitor: &mut dyn Monitor,
) -> (Vec<Outcome>, Pair) {
    let mut pair = [Pair::zero(levels.domain(0))];
    let mut outcomes = Vec::with_capacity(levels.count());
    // A run that has diverged ends: the outcome says so.
    let _ = run_nested(levels, &mut pair, |k, [pair]: &mut [Pair; 1]| {
        let (level, tolerance) = (k + 1, tolerance(k + 1));
        let load = largest(&loads[k]);
        let bound = params.kkt.map_or(tolerance, |kkt| kkt * load);
        let method = params.method.with_inner(0.1 * bound).above(EXACT * load);
        let params = Params { method, tolerance, ..*params };
        let watched = monitor.wants_iterations();
        let mut on_iteration = |iteration: &Iteration| monitor.iteration(level, iteration);
        let on_iteration = watched.then_some(&mut on_iteration as OnIteration);
        let outcome =
            solve(levels.domain(k), law.with_load(&loads[k]), &params, pair, on_iteration);
        monitor.level(level, pair);
        outcomes.push(outcome);
        if outcome.end.stop == Stop::Diverged { Err(outcome.end.stop) } else { Ok(()) }
    });
    let [pair] = pair;
    (outcomes, pair)
}
