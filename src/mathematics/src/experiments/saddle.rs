//! Saddle-point methods run until a goal is reached that the methods themselves do not see.

use crate::discrete::grid::Grid;
use crate::problem::law::Law;
use crate::saddle::{Method, Pair, RunStart, RunState, engine, run_alone};

/// Number of sweeps between two checks of the goal, and limit of sweeps.
#[derive(Clone, Copy, Debug)]
pub(super) struct CheckInterval {
    /// Sweeps so far over the sweeps of Arrow-Hurwicz between two checks, of which there is at least one. Uzawa's
    /// algorithm is checked after each step of the multiplier.
    pub(super) share: usize,
    /// Sweeps after which the method has failed.
    pub(super) limit: usize,
}

/// Runs a method on a grid until `done`, which is called before the first sweep too; returns the last pair, and the
/// number of sweeps.
///
/// `None` if the method diverged, or the limit of sweeps was reached.
///
/// # Panics
/// If the load or the pair does not belong to `grid`, or r is not positive.
pub(super) fn sweeps_until(
    grid: Grid,
    start: &RunStart<'_>,
    checks: CheckInterval,
    done: &mut dyn FnMut(&Pair) -> bool,
) -> Option<(Pair, usize)> {
    if done(start.pair) {
        return Some((start.pair.clone(), 0));
    }
    let mut engine = engine(grid, Law::SIGNORINI, start);
    let (state, mut next) = (RunState::new(start, checks.limit), 1);
    let end = run_alone(&mut *engine, state, &mut |engine, run| {
        if run.sweeps < next {
            return false;
        }
        next = run.sweeps
            + match start.method {
                Method::ArrowHurwicz => (run.sweeps / checks.share).max(1),
                Method::Uzawa { .. } => 1,
            };
        done(&engine.pair(0))
    });
    let sweeps = end.count()?;
    Some((engine.pair(0).into_owned(), sweeps))
}
