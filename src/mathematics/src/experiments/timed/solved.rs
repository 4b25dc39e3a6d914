//! All solvers on grids, on problems with known solutions, to each of their goals.

use super::goal::TimedGoal;
use super::{Prepared, TimedFacts, TimedPlan, TimedRun};
use crate::discrete::grid::{Grid, nested};
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::transfer::Prolongation;
use crate::experiments::known::KnownSolution;
use crate::experiments::rows::row_of;
use crate::experiments::work::{OnGrid, R};
use crate::problem::exact::Exact;
use crate::problem::law::Law;
use crate::saddle::{NestedGrids, Params, StopRule, solve_nested};
use crate::solvers::Solver;
use serde::Serialize;
use std::sync::Arc;

/// Problems with a formula for the solution and a contact set that is not the whole boundary.
const FORMULAS: [Exact; 2] = [Exact::FreeSegment, TimedPlan::SCALED];
/// Cells per side of the finest grid on which the paper's method stops as in the tables.
const PUBLISHED_FINEST: usize = 64;

/// Table `solver`: a solver on a grid.
#[derive(Serialize)]
struct SolvedRow {
    solver: Solver,
    /// Name of the problem, as in `exact(name)` where its solution has a formula.
    problem: String,
    cells: usize,
    /// Goal, in words.
    goal: String,
    /// Error against the known solution, as [`OnGrid::error`] measures it.
    error: f64,
    /// Error of the discrete solution, measured likewise.
    discretisation: f64,
    /// Natural residual over the largest component of the load.
    kkt: f64,
}

/// Problem on which solvers run.
struct TimedProblem {
    known: KnownSolution,
    levels: Vec<OnGrid>,
}

/// Runs on the paper's problems and those that test contact, `known` and judged by the energy; then on those with a
/// formula. A quick plan leaves out the first of each kind.
pub(super) fn runs(plan: &TimedPlan, known: Vec<KnownSolution>) -> impl Iterator<Item = Prepared> {
    let skipped = usize::from(plan.quick);
    let papers = plan.problems.len();
    let formulas = FORMULAS.into_iter().skip(skipped).map(KnownSolution::Formula);
    let known = known.into_iter().enumerate();
    let known = known.filter(move |(k, _)| skipped == 0 || (*k != 0 && *k != papers));
    let cases = known.map(move |(k, known)| (known, k < papers));
    let cases = cases.chain(formulas.map(|known| (known, false)));
    let is_asked = plan.solvers.iter().any(|solver| Solver::on_grids().contains(solver));
    cases.filter(move |_| is_asked).map(|(known, is_papers)| of_problem(plan, known, is_papers))
}

/// Runs of all solvers, each on all grids from 1/16 on, to all its goals; then of the paper's method as in its tables.
fn of_problem(plan: &TimedPlan, known: KnownSolution, is_papers: bool) -> Prepared {
    let finest = plan.finest.min(if plan.quick { 32 } else { 1024 });
    let mut levels = Vec::new();
    for cells in (3..).map(|level| 1 << level).take_while(|cells| *cells <= finest) {
        let grid = Grid::new(cells).map_err(|e| e.clone())?;
        levels.push(OnGrid::new(&known, grid)?);
    }
    let problem = Arc::new(TimedProblem { known, levels });
    let mut runs = Vec::new();
    for solver in Solver::on_grids().into_iter().filter(|solver| plan.solvers.contains(solver)) {
        for level in 1..problem.levels.len() {
            let goals = TimedGoal::of(solver).into_iter();
            runs.extend(goals.map(|goal| to_goal(&problem, solver, level, goal)));
        }
    }
    if is_papers && plan.solvers.contains(&Solver::ArrowHurwicz) {
        runs.push(published(&problem)?);
    }
    Ok(runs)
}

/// Run of a solver to a goal on one of the grids of a problem.
fn to_goal(problem: &Arc<TimedProblem>, solver: Solver, level: usize, goal: TimedGoal) -> TimedRun {
    let [solving, judging] = [(); 2].map(|()| Arc::clone(problem));
    let (name, cells) = (problem.known.name(), problem.levels[level].grid.cells());
    let run = TimedRun::new(
        format!("{solver}, {name}, h = 1/{cells}"),
        move || goal.solve(&solving.levels[..=level]),
        move |y: Option<Vec<f64>>| {
            let (name, goal) = (judging.known.name(), goal.in_words());
            let y = y.ok_or_else(|| {
                format!("{solver} does not reach {goal} on {name}, h = 1/{cells}")
            })?;
            Ok(Some(judging.facts(solver, level, goal, &y)))
        },
    );
    let series = format!("{solver}, {name}, {}", goal.in_words());
    TimedRun { series, growth: goal.growth(), ..run }
}

/// Run of the paper's method as in its tables, r = 10, on the finest of its grids that exists here.
fn published(problem: &Arc<TimedProblem>) -> Result<TimedRun, String> {
    let last = problem.levels.iter().rposition(|level| level.grid.cells() <= PUBLISHED_FINEST);
    let last = last.ok_or("no grid for the published stop")?;
    let finest = problem.levels[last].grid.cells().ilog2();
    let cells: Vec<usize> = (2..=finest).map(|level| 1 << level).collect();
    let grids = nested(&cells).map_err(|e| e.clone())?;
    let f = problem.known.f();
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, LoadRule::default())).collect();
    let judging = Arc::clone(problem);
    let solver = Solver::ArrowHurwicz;
    Ok(TimedRun::new(
        format!("{solver}, {}, {}", problem.known.name(), TimedPlan::PUBLISHED),
        move || {
            let nested = NestedGrids { grids: &grids, prolongation: Prolongation::default() };
            let params = Params { r: R, rule: StopRule::Signed, ..Params::default() };
            solve_nested(&nested, Law::SIGNORINI, &loads, &params, &mut ()).1
        },
        move |pair| Ok(Some(judging.facts(solver, last, TimedPlan::PUBLISHED.into(), &pair.y))),
    ))
}

impl TimedProblem {
    /// Facts about a nodal vector on one of the grids.
    fn facts(&self, solver: Solver, level: usize, goal: String, y: &[f64]) -> TimedFacts {
        let level = &self.levels[level];
        let row = SolvedRow {
            solver,
            problem: self.known.name().into(),
            cells: level.grid.cells(),
            goal,
            error: level.error(y),
            discretisation: level.discretisation,
            kkt: kkt(level.grid, Law::SIGNORINI, y, &level.load).relative,
        };
        TimedFacts { table: "solver", row: row_of(row) }
    }
}
