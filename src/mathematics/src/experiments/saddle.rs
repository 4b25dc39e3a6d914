//! Saddle-point methods run until a goal is reached that the methods themselves do not see.

use crate::discrete::grid::Grid;
use crate::problem::law::Law;
use crate::saddle::{Method, Pair, RunStart, RunState, SaddleDomain, run_alone};

/// Uzawa's algorithm, each inner minimisation to a tenth of the gradient, with a proximal term of this weight.
pub const fn loose_uzawa(weight: f64) -> Method {
    Method::Uzawa { weight, inner: 0.0, loose: true }
}

/// Number of sweeps between two checks of the goal, and limit of sweeps.
#[derive(Clone, Copy, Debug)]
pub struct CheckInterval {
    /// Sweeps so far over the sweeps of Arrow-Hurwicz between two checks, of which there is at least one. Uzawa's
    /// algorithm is checked after each step of the multiplier.
    pub share: usize,
    /// Sweeps after which the method has failed.
    pub limit: usize,
}

/// A method on one discrete problem, and the checks of the goal.
#[derive(Clone, Copy, Debug)]
pub struct CheckedRun<'a> {
    /// Grid.
    pub grid: Grid,
    /// Load vector.
    pub load: &'a [f64],
    /// Method.
    pub method: Method,
    /// Duality parameter r > 0.
    pub r: f64,
    /// Number of sweeps between two checks of the goal.
    pub checks: CheckInterval,
}

impl CheckedRun<'_> {
    /// Changes `pair` until `done`, which is called before the first sweep too; returns the number of sweeps.
    ///
    /// `None` if the method diverged, or the limit of sweeps was reached.
    ///
    /// # Panics
    /// If `load` or `pair` does not belong to `grid`, or r is not positive.
    pub fn sweeps_until(
        &self,
        pair: &mut Pair,
        done: &mut dyn FnMut(&Pair) -> bool,
    ) -> Option<usize> {
        let &Self { grid, load, method, r, checks } = self;
        if done(pair) {
            return Some(0);
        }
        let start = RunStart { load, method, r, pair };
        let mut engine = grid.engine(Law::SIGNORINI, &start);
        let (state, mut next) = (RunState::new(&start, checks.limit), 1);
        let end = run_alone(&mut *engine, state, &mut |engine, run| {
            if run.sweeps < next {
                return false;
            }
            next = run.sweeps
                + match method {
                    Method::ArrowHurwicz => (run.sweeps / checks.share).max(1),
                    Method::Uzawa { .. } => 1,
                };
            done(&engine.pair(0))
        });
        let last = engine.pair(0).into_owned();
        drop(engine);
        *pair = last;
        end.count()
    }
}
