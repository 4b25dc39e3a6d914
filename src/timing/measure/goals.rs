//! To what each solver is run, and how.

use crate::discrete::kkt::kkt;
use crate::discrete::transfer::Prolongation;
use crate::experiments::saddle::{Checks, loose_uzawa, sweeps_until};
use crate::experiments::work::{OnGrid, R};
use crate::multigrid::active_set::active_set;
use crate::multigrid::square::Square;
use crate::multigrid::{self, MultigridParams};
use crate::saddle::{Method, Pair};
use crate::timing::recorded::Goal;
use crate::timing::solver::Solver;

/// Relative natural residuals at which saddle-point methods are stopped.
const TARGETS: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// The cap is out of reach: a series ends long before, when a run takes too long.
const CHECKS: Checks = Checks { share: 8, cap: 1_000_000_000 };

/// A solver to one goal on the last of some nested grids; the result, or nothing if it fails.
pub(super) type Solve = Box<dyn Fn(&[OnGrid]) -> Option<Vec<f64>>>;

/// The goals of a solver on grids: name, growth of the time from grid to grid, and how to get there.
pub(super) fn goals(solver: Solver) -> Vec<(String, f64, Solve)> {
    let saddle = |method: Method| {
        let to = |target: f64| -> (String, f64, Solve) {
            let solve = move |levels: &[OnGrid]| over_grids(method, target, levels);
            (format!("relative KKT {target:e}"), 16.0, Box::new(solve))
        };
        TARGETS.map(to).into_iter().collect()
    };
    match solver {
        Solver::ArrowHurwicz => saddle(Method::ArrowHurwicz),
        Solver::Uzawa => saddle(loose_uzawa(0.0)),
        Solver::UzawaProximal => saddle(loose_uzawa(1.0)),
        Solver::ActiveSet => vec![(
            "contact set at rest".into(),
            8.0,
            Box::new(|levels: &[OnGrid]| {
                let OnGrid { grid, load, .. } = levels.last()?;
                Some(active_set::<Square>(grid.cells(), load).ok()?.0)
            }),
        )],
        Solver::Multigrid => {
            let to = |goal: Goal| -> (String, f64, Solve) {
                let solve = move |levels: &[OnGrid]| {
                    let OnGrid { grid, load, .. } = levels.last()?;
                    let params =
                        MultigridParams { goal: goal.asked(), ..MultigridParams::default() };
                    Some(multigrid::solve_square(grid.cells(), load, None, &params).ok()?.0)
                };
                (goal.in_words().into(), 4.0, Box::new(solve))
            };
            Goal::ALL.map(to).into()
        }
        Solver::Spectral => Vec::new(),
    }
}

/// A saddle-point method from zero over the nested grids, each left when the target is met.
fn over_grids(method: Method, target: f64, levels: &[OnGrid]) -> Option<Vec<f64>> {
    let mut pair = Pair::zero(levels[0].grid);
    for (k, OnGrid { grid, load, .. }) in levels.iter().enumerate() {
        if k > 0 {
            pair = pair.prolonged(levels[k - 1].grid, Prolongation::default());
        }
        let done = |_, pair: &Pair| kkt(*grid, &pair.y, load).relative <= target;
        sweeps_until(method, (*grid, load), R, CHECKS, &mut pair, done)?;
    }
    Some(pair.y)
}
