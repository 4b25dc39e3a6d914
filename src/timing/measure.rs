//! Run times of every solver: medians with their noise, never part of any test or artifact.
//!
//! Load vectors, and for [`Scaling`] the workspace too, are made before the clock starts. Saddle-point methods check
//! the optimality conditions after every eighth of the sweeps made so far; these checks are part of their time.
//! Central is [`measure`].

mod adapted;
mod goals;
mod median;

use super::bandwidth;
use crate::timing::recorded::{
    Goal, Machine, PUBLISHED, SCHEMA, Scaling, SolverTime, Spectral, Timings,
};
use goals::goals;
use median::{MedianTime, time};
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::kkt::kkt;
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::experiments::known::KnownSolution;
use signorini_mathematics::experiments::problems::{CONTACT, PAPER};
use signorini_mathematics::experiments::work::{OnGrid, R};
use signorini_mathematics::multigrid::{Multigrid, MultigridParams};
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::{NestedGrids, Pair, Params, StopRule, solve_nested};
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::spectral::{self, spectral};
use std::sync::atomic::{AtomicBool, Ordering};

/// Measurements to make.
#[derive(Clone, Debug)]
pub struct TimingPlan {
    /// Runs per median; fewer where a run takes long.
    pub repeats: usize,
    /// Coarse grids and little data, to see that everything works, not to record.
    pub quick: bool,
    /// Solvers to time.
    pub solvers: Vec<Solver>,
    /// Cells per side of the finest grid: a power of two.
    pub finest: usize,
    /// Set to end the measurements early; the one that has begun is finished.
    pub interrupted: &'static AtomicBool,
}

/// Problem on which multigrid is timed.
pub const TIMED: Exact = Exact::FreeCorner;
/// Problems with a formula for the solution and a contact set that is not the whole boundary.
const FORMULAS: [Exact; 2] = [Exact::FreeSegment, TIMED];
/// Seconds that a single run may take by extrapolation from the coarser grid.
const LONGEST: f64 = 4.0;
/// Resolutions (nodes, levels) of the spectral solver, from three digits to all; the last is the reference.
const RESOLUTIONS: [(usize, u32); 8] =
    [(6, 2), (8, 3), (10, 3), (12, 4), (14, 5), (16, 6), (20, 8), (24, 9)];

/// Measures run times; `say` gets the name of the next measurement, once per solver, problem and grid.
///
/// 1. Memory bandwidth.
/// 2. Multigrid from grid to grid, with one thread and with two.
/// 3. Every solver on grids, on every problem and grid, to each of its goals.
/// 4. The spectral solver at every resolution.
/// 5. Adaptive and uniform refinement of the L-shape.
///
/// Easily broken: a time includes everything that its run does, so that allocation, loads and checks have to be on the
/// side of the clock on which the field of [`Timings`] says that they are.
///
/// If it is interrupted, the times measured until then are returned.
///
/// # Errors
/// A sentence if a solver fails.
pub fn measure(plan: &TimingPlan, mut say: impl FnMut(&str)) -> Result<Timings, String> {
    let machine = Machine::here(plan.repeats);
    if let Some(warning) = machine.busy() {
        say(&warning);
    }
    say("memory bandwidth");
    let bandwidth = bandwidth::bandwidth(if plan.quick { 1 << 20 } else { 1 << 25 }, 5);
    let mut multigrid = Vec::new();
    if plan.has(Solver::Multigrid) {
        multigrid = scaling(plan, &mut say)?;
    }
    let mut solver = Vec::new();
    for case in cases(plan)? {
        for one in Solver::on_grids().into_iter().filter(|&one| plan.has(one)) {
            solver.extend(reached(one, &case, plan, &mut say)?);
        }
        if let Some(f) = case.paper.filter(|_| plan.has(Solver::ArrowHurwicz)) {
            say(&format!("{}, {}, {PUBLISHED}", Solver::ArrowHurwicz, case.name));
            solver.push(published(&case, f, plan)?);
        }
    }
    let mut spectral = Vec::new();
    if plan.has(Solver::Spectral) {
        for (name, f) in PAPER.into_iter().chain(CONTACT).take_while(|_| !plan.ended()) {
            say(&format!("{}, {name}", Solver::Spectral));
            spectral.extend(resolved(name, f, plan)?);
        }
    }
    let mut adapted = Vec::new();
    if plan.has(Solver::Multigrid) {
        adapted = adapted::times(plan, &mut say)?;
    }
    Ok(Timings {
        schema: SCHEMA,
        bandwidth,
        machine,
        multigrid,
        solver,
        spectral,
        peer: Vec::new(),
        own_mesh: Vec::new(),
        adapted,
    })
}

impl TimingPlan {
    /// True if the solver is to be timed, and nobody has ended the measurements.
    fn has(&self, solver: Solver) -> bool {
        !self.ended() && self.solvers.contains(&solver)
    }

    fn ended(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

/// Times multigrid on all grids from 1/32 on, with one thread and with two, to both goals.
fn scaling(plan: &TimingPlan, say: &mut impl FnMut(&str)) -> Result<Vec<Scaling>, String> {
    let threads: Vec<usize> =
        if crate::timing::machine::cores() > 1 { vec![1, 2] } else { vec![1] };
    let mut measured = Vec::new();
    for cells in (5..).map(|level| 1 << level).take_while(|n| *n <= plan.finest && !plan.ended()) {
        say(&format!("multigrid, h = 1/{cells}"));
        let grid = Grid::new(cells).map_err(|e| e.to_string())?;
        let load = load(grid, &Source::from(TIMED), LoadRule::default());
        let problem = Law::SIGNORINI.with_load(&load);
        let mut workspace = Multigrid::square(cells).map_err(|e| e.to_string())?;
        let mut y = vec![0.0; load.len()];
        for &threads in &threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.map_err(|e| format!("cannot start {threads} threads: {e}"))?;
            for goal in Goal::ALL.into_iter().take_while(|_| !plan.ended()) {
                let params = MultigridParams { goal: goal.asked(), ..MultigridParams::default() };
                let outcome = workspace.solve(problem, None, &params).map_err(|e| e.to_string())?;
                let MedianTime { seconds, spread } = pool.install(|| {
                    time(plan.repeats, || {
                        let _ = workspace.solve(problem, None, &params);
                        // A caller waits for the solution in the order of the load.
                        workspace.write_solution(&mut y);
                    })
                });
                let (work_units, traffic) = (outcome.work_units, workspace.traffic());
                let scaling =
                    Scaling { cells, threads, goal, work_units, traffic, seconds, spread };
                measured.push(scaling);
            }
        }
    }
    Ok(measured)
}

/// Problem on which solvers are timed.
struct TimedProblem {
    name: String,
    levels: Vec<OnGrid>,
    /// f, if the problem is one of the paper's.
    paper: Option<&'static str>,
}

impl TimedProblem {
    fn new(
        known: &KnownSolution,
        grids: &[Grid],
        paper: Option<&'static str>,
    ) -> Result<Self, String> {
        let levels = grids.iter().map(|&grid| OnGrid::new(known, grid));
        Ok(Self { name: known.name().into(), levels: levels.collect::<Result<_, _>>()?, paper })
    }
}

/// Returns the paper's problems and those that test contact, judged by the energy; then those with a formula.
fn cases(plan: &TimingPlan) -> Result<Vec<TimedProblem>, String> {
    let finest = plan.finest.min(if plan.quick { 32 } else { 1024 });
    let grids = (3..).map(|level| 1 << level).take_while(|n| *n <= finest);
    let grids: Vec<Grid> =
        grids.map(Grid::new).collect::<Result<_, _>>().map_err(|e| e.to_string())?;
    let skipped = usize::from(plan.quick);
    let mut cases = Vec::new();
    if plan.ended() {
        return Ok(cases);
    }
    for (name, f) in PAPER.into_iter().skip(skipped) {
        let known = KnownSolution::spectral(name, f, spectral::SpectralParams::FINER)?;
        cases.push(TimedProblem::new(&known, &grids, Some(f))?);
    }
    for (name, f) in CONTACT.into_iter().skip(skipped) {
        let known = KnownSolution::spectral(name, f, spectral::SpectralParams::FINER)?;
        cases.push(TimedProblem::new(&known, &grids, None)?);
    }
    for exact in FORMULAS.into_iter().skip(skipped) {
        cases.push(TimedProblem::new(&KnownSolution::Formula(exact), &grids, None)?);
    }
    Ok(cases)
}

fn source(f: &str) -> Result<Source, String> {
    f.parse().map_err(|e| format!("{f}: {e}"))
}

fn true_energy(f: &str, (nodes, levels): (usize, u32)) -> Result<f64, String> {
    let solution = spectral(&source(f)?, spectral::SpectralParams { nodes, levels });
    Ok(solution.map_err(|e| format!("{f}: {e}"))?.energy)
}

/// Times the spectral solver at all resolutions but the reference that give an answer.
fn resolved(problem: &str, f: &str, plan: &TimingPlan) -> Result<Vec<Spectral>, String> {
    let [resolutions @ .., finest] = RESOLUTIONS;
    let reference = true_energy(f, finest)?;
    let mut measured = Vec::new();
    for resolution in resolutions.into_iter().take_while(|_| !plan.ended()) {
        // A resolution whose answer fails the solver's own checks is left out.
        let Ok(energy) = true_energy(f, resolution) else { continue };
        let MedianTime { seconds, spread } = time(plan.repeats, || {
            let _ = true_energy(f, resolution);
        });
        let error = (energy / reference - 1.0).abs().max(f64::EPSILON);
        let ((nodes, levels), problem) = (resolution, problem.into());
        measured.push(Spectral { problem, nodes, levels, error, seconds, spread });
    }
    Ok(measured)
}

/// Times the paper's method as in its tables, r = 10, on the finest of its grids that exists here.
fn published(case: &TimedProblem, f: &str, plan: &TimingPlan) -> Result<SolverTime, String> {
    let f = source(f)?;
    let last = case.levels.iter().rev().find(|level| level.grid.cells() <= 64);
    let level = last.ok_or("no grid for the published stop")?;
    let finest = level.grid.cells().ilog2();
    let cells: Vec<usize> = (2..=finest).map(|level| 1 << level).collect();
    let grids = nested(&cells).map_err(|e| e.to_string())?;
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, LoadRule::default())).collect();
    let params = &Params { r: R, rule: StopRule::Signed, ..Params::default() };
    let nested = NestedGrids { grids: &grids, prolongation: Prolongation::default() };
    let solve = || solve_nested(&nested, Law::SIGNORINI.with_loads(&loads), params, &mut ()).1;
    let Pair { y, .. } = solve();
    let MedianTime { seconds, spread } = time(plan.repeats, || {
        solve();
    });
    Ok(SolverTime {
        solver: Solver::ArrowHurwicz,
        problem: case.name.clone(),
        cells: level.grid.cells(),
        goal: PUBLISHED.into(),
        error: level.error(&y),
        discretisation: level.discretisation,
        kkt: kkt(level.grid, Law::SIGNORINI, &y, &level.load).relative,
        seconds,
        spread,
    })
}

/// Times one solver on all grids from 1/16 on, to all its goals.
fn reached(
    solver: Solver,
    case: &TimedProblem,
    plan: &TimingPlan,
    say: &mut impl FnMut(&str),
) -> Result<Vec<SolverTime>, String> {
    let problem = &case.name;
    let goals = goals(solver);
    let mut before = vec![0.0; goals.len()];
    let mut measured = Vec::new();
    for k in (2..=case.levels.len()).take_while(|_| !plan.ended()) {
        let levels = &case.levels[..k];
        let level = &levels[k - 1];
        let cells = level.grid.cells();
        say(&format!("{solver}, {problem}, h = 1/{cells}"));
        for (goal, before) in goals.iter().zip(&mut before) {
            if plan.ended() || goal.growth() * *before > LONGEST {
                continue;
            }
            let name = goal.in_words();
            let y = goal.solve(levels).ok_or_else(|| {
                format!("{solver} does not reach {name} on {problem}, h = 1/{cells}")
            })?;
            let MedianTime { seconds, spread } = time(plan.repeats, || {
                goal.solve(levels);
            });
            *before = seconds;
            measured.push(SolverTime {
                solver,
                problem: problem.clone(),
                cells,
                goal: name,
                error: level.error(&y),
                discretisation: level.discretisation,
                kkt: kkt(level.grid, Law::SIGNORINI, &y, &level.load).relative,
                seconds,
                spread,
            });
        }
    }
    Ok(measured)
}
