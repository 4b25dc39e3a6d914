//! Goals to which each solver runs.

use crate::discrete::kkt::kkt;
use crate::discrete::transfer::Prolongation;
use crate::experiments::saddle::{CheckInterval, sweeps_until};
use crate::experiments::work::{OnGrid, R};
use crate::multigrid::active_set::{MOST_CELLS, active_set};
use crate::multigrid::{Goal, MultigridParams, solve_square};
use crate::problem::law::Law;
use crate::saddle::{Method, NestedGrids, Pair, RunStart, run_nested};
use crate::solvers::Solver;
use serde::Serialize;

/// Goals of multigrid that are timed.
#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MultigridGoal {
    /// An algebraic error of at most a tenth of the discretisation error in the energy norm.
    Discretisation,
    /// The smallest residual in double precision.
    Floor,
}

impl MultigridGoal {
    /// Both goals, that of a larger residual first.
    pub(super) const ALL: [Self; 2] = [Self::Discretisation, Self::Floor];

    /// Name in words.
    fn in_words(self) -> &'static str {
        match self {
            Self::Discretisation => "discretisation error",
            Self::Floor => "rounding floor",
        }
    }

    /// Parameters of multigrid.
    pub(super) fn params(self) -> MultigridParams {
        let goal = match self {
            Self::Discretisation => Goal::DiscretisationError,
            Self::Floor => Goal::RoundingFloor,
        };
        MultigridParams { goal, ..MultigridParams::default() }
    }
}

/// Relative natural residuals at which saddle-point methods are stopped.
const TARGETS: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// Checks of a saddle-point method; the limit is never reached, because a series ends when a run takes too long.
const CHECKS: CheckInterval = CheckInterval { share: 8, limit: 1_000_000_000 };

/// Goal of a solver on nested grids.
#[derive(Clone, Copy)]
pub(super) enum TimedGoal {
    /// A saddle-point method to this relative natural residual.
    Saddle(Method, f64),
    /// The active-set method on the finest grid, until its contact set does not change.
    ActiveSet,
    /// Multigrid to a goal.
    Multigrid(MultigridGoal),
}

impl TimedGoal {
    /// Goals of a solver; none of the one without a grid.
    pub(super) fn of(solver: Solver) -> Vec<Self> {
        match (solver.entry().method, solver) {
            (Some(method), _) => {
                let method = method.loose();
                TARGETS.map(|target| Self::Saddle(method, target)).into()
            }
            (None, Solver::ActiveSet) => vec![Self::ActiveSet],
            (None, Solver::Multigrid) => MultigridGoal::ALL.map(Self::Multigrid).into(),
            (None, _) => Vec::new(),
        }
    }

    /// Name in words.
    pub(super) fn in_words(self) -> String {
        match self {
            Self::Saddle(_, target) => format!("relative KKT {target:e}"),
            Self::ActiveSet => "contact set at rest".into(),
            Self::Multigrid(goal) => goal.in_words().into(),
        }
    }

    /// Growth of the time from one grid to the next, as expected.
    pub(super) fn growth(self) -> f64 {
        match self {
            Self::Saddle(..) | Self::ActiveSet => 16.0,
            Self::Multigrid(_) => 4.0,
        }
    }

    /// Solves to this goal on the last of some nested grids; `None` if the solver fails.
    pub(super) fn solve(self, levels: &[OnGrid]) -> Option<Vec<f64>> {
        let OnGrid { grid, load, .. } = levels.last()?;
        match self {
            Self::Saddle(method, target) => over_grids(method, target, levels),
            Self::ActiveSet if grid.cells() > MOST_CELLS => None,
            Self::ActiveSet => active_set(grid.cells(), Law::SIGNORINI, load).ok().map(|(y, _)| y),
            Self::Multigrid(goal) => {
                let loaded = Law::SIGNORINI.with_load(load);
                solve_square(grid.cells(), loaded, &goal.params()).ok().map(|(y, _)| y)
            }
        }
    }
}

/// Runs a saddle-point method from zero over the nested grids, on each until the target is met.
fn over_grids(method: Method, target: f64, levels: &[OnGrid]) -> Option<Vec<f64>> {
    let grids: Vec<_> = levels.iter().map(|level| level.grid).collect();
    let nested = NestedGrids { grids: &grids, prolongation: Prolongation::default() };
    let mut pair = [Pair::zero(grids[0])];
    let reached: Result<(), ()> = run_nested(&nested, &mut pair, |k, [pair]: &mut [Pair; 1]| {
        let OnGrid { grid, load, .. } = &levels[k];
        let start = RunStart { load, method, r: R, pair };
        let is_reached =
            &mut |pair: &Pair| kkt(*grid, Law::SIGNORINI, &pair.y, load).relative <= target;
        let (last, _) = sweeps_until(*grid, &start, CHECKS, is_reached).ok_or(())?;
        *pair = last;
        Ok(())
    });
    let [pair] = pair;
    reached.is_ok().then_some(pair.y)
}
