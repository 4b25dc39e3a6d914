//! Runs over nested grids and networks: on each from the interpolated pair of the one before.

use super::Pair;
use super::solve::{AskedRun, Iteration, Params, solve_together};
use crate::discrete::end::{Outcome, Stop};
use crate::discrete::nested::DiscreteLevels;
use crate::discrete::transfer::{Prolongation, prolong, prolong_boundary};

/// Returns the paper's tolerance on its `level`-th grid, counted from 1: `10^-level`.
pub fn tolerance(level: usize) -> f64 {
    // A power of ten up to 10^22 is exact, so that the quotient is the double nearest to 10^-level.
    1.0 / 10f64.powi(level as i32)
}

impl Pair {
    /// Returns the linear interpolation of a pair to the k-th level from the one before, on a grid by this rule at the
    /// centres of cells.
    pub fn interpolated(&self, levels: DiscreteLevels<'_>, k: usize, rule: Prolongation) -> Self {
        let Self { y, a } = self;
        match levels {
            DiscreteLevels::Grids(grids, _) => {
                Self { y: prolong(grids[k - 1], y, rule), a: prolong_boundary(a) }
            }
            DiscreteLevels::Networks(networks) => {
                let a = networks[k].interpolate_boundary(&networks[k - 1].network, a);
                Self { y: networks[k].interpolate(y), a }
            }
        }
    }
}

/// Observer of a run over nested grids or networks; every method has a default that does nothing.
pub trait Monitor {
    /// True if histories are wanted, which makes each iteration more expensive.
    fn has_history(&self) -> bool {
        false
    }

    /// Called before sparse factors of the finest level, with so many nodes, are made again and again, which takes
    /// time.
    fn factors(&mut self, _nodes: usize) {}

    /// Called at the end on each level, coarsest first, with the last pair and, if it is wanted, the history.
    fn level(&mut self, _pair: &Pair, _history: &[Iteration]) {}
}

/// The observer that does nothing.
impl Monitor for () {}

/// Part of the largest component of the load to which minimisations of Uzawa's method are exact; the sweeps of one grow
/// with the digits.
const EXACT: f64 = 1e-6;

/// Run over nested grids or networks.
#[derive(Clone, Copy, Debug)]
pub struct NestedRun<'a> {
    /// Load vectors of all levels.
    pub loads: &'a [Vec<f64>],
    /// Parameters, whose tolerance and inner bound follow from the level.
    pub params: Params,
}

impl NestedRun<'_> {
    /// Parameters on the k-th level, counted from 0: the tolerance is [`tolerance`]`(k + 1)`, the inner bound of
    /// Uzawa's method a tenth of this, or of the KKT residual that ends the run; where that is a tiny part of the load,
    /// minimisations are loose.
    fn params_on(&self, levels: DiscreteLevels<'_>, k: usize) -> Params {
        let (tolerance, load) = (tolerance(k + 1), levels.level(k).unit(&self.loads[k]));
        let bound = self.params.kkt.map_or(tolerance, |kkt| kkt * load);
        let method = self.params.method.with_inner(0.1 * bound).above(EXACT * load);
        Params { method, tolerance, ..self.params }
    }
}

/// Solves on each level in turn, starting from zero and then from the interpolated pair. Returns the outcome on each
/// level and the last pair; ends after a level on which the iteration diverged.
///
/// # Panics
/// If there are no levels, a load vector has the wrong length, or `params.r` is not positive.
pub fn solve_nested(
    levels: DiscreteLevels<'_>,
    loads: &[Vec<f64>],
    params: &Params,
    monitor: &mut dyn Monitor,
) -> (Vec<Outcome>, Pair) {
    let run = NestedRun { loads, params: *params };
    solve_nested_together(levels, &[run], &mut [monitor]).swap_remove(0)
}

/// As [`solve_nested`], for several runs, each with its observer: on grids side by side, which takes less
/// time than one after the other, and gives the same bits.
///
/// # Panics
/// As [`solve_nested`].
pub fn solve_nested_together(
    levels: DiscreteLevels<'_>,
    runs: &[NestedRun<'_>],
    monitors: &mut [&mut dyn Monitor],
) -> Vec<(Vec<Outcome>, Pair)> {
    let zero = Pair::zero(levels.level(0));
    let mut found = vec![(Vec::with_capacity(levels.count()), zero); runs.len()];
    let mut going: Vec<usize> = (0..runs.len()).collect();
    for k in 0..levels.count() {
        if k > 0 {
            for &number in &going {
                let rule = runs[number].params.prolongation;
                found[number].1 = found[number].1.interpolated(levels, k, rule);
            }
        }
        let on_level = going.iter().map(|&number| AskedRun {
            load: &runs[number].loads[k],
            params: runs[number].params_on(levels, k),
            start: &found[number].1,
            has_history: monitors[number].has_history(),
        });
        let on_level: Vec<_> = on_level.collect();
        let ends = solve_together(levels.level(k), &on_level);
        for (&number, end) in going.iter().zip(ends) {
            monitors[number].level(&end.pair, &end.history);
            found[number].0.push(end.outcome);
            found[number].1 = end.pair;
        }
        going.retain(|&number| found[number].0[k].end.stop != Stop::Diverged);
        // The longest first, so that all lanes are full nearly to the end.
        going.sort_by(|&one, &other| {
            let [one, other] = [one, other].map(|number| found[number].0[k].end.work_units);
            other.total_cmp(&one)
        });
    }
    found
}
