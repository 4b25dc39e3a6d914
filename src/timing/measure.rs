//! Run times of every solver: medians with their noise, never part of any test or artifact.
//!
//! All that can be is made ready before the clock starts: load vectors, and for [`Scaling`] the workspace
//! too. Saddle-point methods check the optimality conditions after every eighth of the sweeps made so
//! far; these checks are part of their time.

mod goals;

use super::bandwidth;
use crate::discrete::grid::{Grid, nested};
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::transfer::Prolongation;
use crate::experiments::known::KnownSolution;
use crate::experiments::problems::{CONTACT, PAPER};
use crate::experiments::work::{OnGrid, R};
use crate::multigrid::{Multigrid, MultigridParams};
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::saddle::{Pair, Params, StopRule, arrow_hurwicz, solve_nested};
use crate::spectral::{self, spectral};
use crate::timing::recorded::{
    Goal, Machine, PUBLISHED, Reached, SCHEMA, Scaling, Spectral, Sweep, Timings,
};
use crate::timing::solver::Solver;
use goals::goals;
use std::time::Instant;

/// What to measure.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Runs per median; fewer where a run takes long.
    pub repeats: usize,
    /// Coarse grids and little data: to see that it works, not to record.
    pub quick: bool,
    /// The solvers to time.
    pub solvers: Vec<Solver>,
    /// Cells per side of the finest grid: a power of two.
    pub finest: usize,
}

/// The problem on which multigrid is timed.
pub const TIMED: Exact = Exact::FreeCorner;
/// The problems with a formula for the solution that have a part of the boundary to find.
const FORMULAS: [Exact; 2] = [Exact::FreeSegment, TIMED];
/// Seconds that a single run may take by extrapolation from the coarser grid.
const LONGEST: f64 = 4.0;
/// Seconds that the runs of one median take together at most, once there are three.
const BUDGET: f64 = 2.0;
/// A measurement shorter than this repeats the run until it is as long.
const SHORTEST: f64 = 1e-3;
/// Nodes and levels of the spectral solver, from three digits to all; the last is the reference.
const RESOLUTIONS: [(usize, u32); 8] =
    [(6, 2), (8, 3), (10, 3), (12, 4), (14, 5), (16, 6), (20, 8), (24, 9)];

/// Measures; `say` is told what comes next, once per solver, problem and grid.
///
/// # Errors
/// A sentence if a solver fails.
pub fn measure(plan: &Plan, mut say: impl FnMut(&str)) -> Result<Timings, String> {
    let machine = Machine::here(plan.repeats);
    say("memory bandwidth");
    let bandwidth = bandwidth::bandwidth(if plan.quick { 1 << 20 } else { 1 << 25 }, 5);
    let wanted = |solver| plan.solvers.contains(&solver);
    let sweep = wanted(Solver::ArrowHurwicz).then(|| {
        say("sweep of Arrow-Hurwicz");
        sweep(plan)
    });
    let multigrid = match wanted(Solver::Multigrid) {
        true => scaling(plan, &mut say)?,
        false => Vec::new(),
    };
    let mut solver = Vec::new();
    for Case { name: problem, levels, paper } in cases(plan)? {
        for one in Solver::ON_GRIDS.into_iter().filter(|&one| wanted(one)) {
            solver.extend(reached(one, &problem, &levels, plan, &mut say)?);
        }
        if let Some(f) = paper.filter(|_| wanted(Solver::ArrowHurwicz)) {
            say(&format!("{}, {problem}, {PUBLISHED}", Solver::ArrowHurwicz));
            solver.push(published(&problem, f, &levels, plan)?);
        }
    }
    let mut spectral = Vec::new();
    for (name, f) in PAPER.into_iter().chain(CONTACT).filter(|_| wanted(Solver::Spectral)) {
        say(&format!("{}, {name}", Solver::Spectral));
        spectral.extend(resolved(name, f, plan)?);
    }
    let peer = Vec::new();
    Ok(Timings { schema: SCHEMA, machine, bandwidth, sweep, multigrid, solver, spectral, peer })
}

/// Median and spread of the time of `run` in seconds, after one run that does not count.
fn time(repeats: usize, mut run: impl FnMut()) -> (f64, f64) {
    let mut once = |times: usize| {
        let start = Instant::now();
        (0..times).for_each(|_| run());
        start.elapsed().as_secs_f64() / times as f64
    };
    let first = once(1);
    let times = ((SHORTEST / first).ceil() as usize).max(1);
    let mut seconds = Vec::new();
    while seconds.len() < repeats && (seconds.len() < 3 || seconds.iter().sum::<f64>() < BUDGET) {
        seconds.push(once(times));
    }
    seconds.sort_by(f64::total_cmp);
    let quantile = |quarters: usize| seconds[quarters * (seconds.len() - 1) / 4];
    (quantile(2), (quantile(3) - quantile(1)) / quantile(2))
}

fn sweep(plan: &Plan) -> Sweep {
    const CELLS: usize = 64;
    const ITERATIONS: usize = 2000;
    let grid = Grid::new(CELLS).expect("fine enough");
    let load = load(grid, &Source::Exact(Exact::FreeCorner), LoadRule::default());
    // A tolerance out of reach, so that all iterations are made.
    let params = Params {
        tolerance: f64::MIN_POSITIVE,
        rule: StopRule::Printed,
        max_iterations: ITERATIONS,
        ..Params::default()
    };
    let (seconds, spread) = time(plan.repeats, || {
        arrow_hurwicz(grid, &load, &params, &mut Pair::zero(grid));
    });
    Sweep { cells: CELLS, ns: 1e9 * seconds / (ITERATIONS * grid.nodes()) as f64, spread }
}

fn scaling(plan: &Plan, say: &mut impl FnMut(&str)) -> Result<Vec<Scaling>, String> {
    let threads: Vec<usize> =
        if crate::timing::machine::cores() > 1 { vec![1, 2] } else { vec![1] };
    let mut measured = Vec::new();
    for cells in (5..).map(|level| 1 << level).take_while(|n| *n <= plan.finest) {
        say(&format!("multigrid, h = 1/{cells}"));
        let grid = Grid::new(cells).map_err(|e| e.to_string())?;
        let load = load(grid, &Source::Exact(TIMED), LoadRule::default());
        let mut workspace = Multigrid::square(cells).map_err(|e| e.to_string())?;
        let mut y = vec![0.0; load.len()];
        for &threads in &threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.map_err(|e| format!("cannot start {threads} threads: {e}"))?;
            for goal in Goal::ALL {
                let params = MultigridParams { goal: goal.asked(), ..MultigridParams::default() };
                // What a caller waits for: the solution in the order of the load.
                let mut solve = || {
                    let outcome = workspace.solve(&load, None, &params);
                    workspace.write_solution(&mut y);
                    outcome
                };
                let outcome = solve().map_err(|e| e.to_string())?;
                let (seconds, spread) = pool.install(|| {
                    time(plan.repeats, || {
                        let _ = solve();
                    })
                });
                let bytes = workspace.bytes() as f64 / grid.nodes() as f64;
                let (work_units, traffic) = (outcome.work_units, workspace.traffic());
                let scaling =
                    Scaling { cells, threads, goal, work_units, bytes, traffic, seconds, spread };
                measured.push(scaling);
            }
        }
    }
    Ok(measured)
}

struct Case {
    name: String,
    levels: Vec<OnGrid>,
    /// f, if it is the paper's.
    paper: Option<&'static str>,
}

/// The paper's problems and those that test contact, judged by the energy; then those with a formula.
fn cases(plan: &Plan) -> Result<Vec<Case>, String> {
    let finest = plan.finest.min(if plan.quick { 32 } else { 1024 });
    let grids = (3..).map(|level| 1 << level).take_while(|n| *n <= finest);
    let grids: Vec<Grid> =
        grids.map(Grid::new).collect::<Result<_, _>>().map_err(|e| e.to_string())?;
    let skipped = usize::from(plan.quick);
    let paper = PAPER.into_iter().skip(skipped).map(|(name, f)| (name, f, Some(f)));
    let contact = CONTACT.into_iter().skip(skipped).map(|(name, f)| (name, f, None));
    let mut known = Vec::new();
    for (name, f, paper) in paper.chain(contact) {
        known.push((KnownSolution::spectral(name, f, spectral::Params::FINER)?, paper));
    }
    let formulas = FORMULAS.into_iter().skip(skipped);
    known.extend(formulas.map(|exact| (KnownSolution::Formula(exact), None)));
    let case = |(known, paper): &(KnownSolution, Option<&'static str>)| {
        let levels =
            grids.iter().map(|&grid| OnGrid::new(known, grid)).collect::<Result<_, _>>()?;
        Ok(Case { name: known.name().into(), levels, paper: *paper })
    };
    known.iter().map(case).collect()
}

fn source(f: &str) -> Result<Source, String> {
    f.parse().map_err(|e| format!("{f}: {e}"))
}

fn true_energy(f: &str, (nodes, levels): (usize, u32)) -> Result<f64, String> {
    let solution = spectral(&source(f)?, spectral::Params { nodes, levels });
    Ok(solution.map_err(|e| format!("{f}: {e}"))?.energy)
}

/// The spectral solver at all resolutions but the reference, as far as they give an answer.
fn resolved(problem: &str, f: &str, plan: &Plan) -> Result<Vec<Spectral>, String> {
    let [resolutions @ .., finest] = RESOLUTIONS;
    let reference = true_energy(f, finest)?;
    // A resolution whose answer fails the solver's own checks is left out.
    let line = |resolution: (usize, u32)| {
        let energy = true_energy(f, resolution).ok()?;
        let (seconds, spread) = time(plan.repeats, || {
            let _ = true_energy(f, resolution);
        });
        let error = (energy / reference - 1.0).abs().max(f64::EPSILON);
        let (nodes, levels) = resolution;
        Some(Spectral { problem: problem.into(), nodes, levels, error, seconds, spread })
    };
    Ok(resolutions.into_iter().filter_map(line).collect())
}

/// The paper's method as in its tables, r = 10, on the finest of its grids that is there.
fn published(problem: &str, f: &str, levels: &[OnGrid], plan: &Plan) -> Result<Reached, String> {
    let f = source(f)?;
    let last = levels.iter().rev().find(|level| level.grid.cells() <= 64);
    let level = last.ok_or("no grid for the published stop")?;
    let cells: Vec<usize> =
        (2..).map(|level| 1 << level).take_while(|n| *n <= level.grid.cells()).collect();
    let grids = nested(&cells).map_err(|e| e.to_string())?;
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, LoadRule::default())).collect();
    let params = Params { r: R, rule: StopRule::Signed, ..Params::default() };
    let solve = || solve_nested(&grids, &loads, &params, Prolongation::default(), &mut ()).1;
    let y = solve().y;
    let median = time(plan.repeats, || {
        solve();
    });
    Ok(Reached::new([problem, PUBLISHED], Solver::ArrowHurwicz, level, &y, median))
}

impl Reached {
    /// What this solver made of a problem on a grid, up to a goal, and its median time with the spread.
    fn new(
        [problem, goal]: [&str; 2],
        solver: Solver,
        level: &OnGrid,
        y: &[f64],
        (seconds, spread): (f64, f64),
    ) -> Self {
        Self {
            solver,
            problem: problem.into(),
            cells: level.grid.cells(),
            goal: goal.into(),
            error: level.error(y),
            discretisation: level.discretisation,
            kkt: kkt(level.grid, y, &level.load).relative,
            seconds,
            spread,
        }
    }
}

/// One solver on all grids from 1/16 on, for all its goals.
fn reached(
    solver: Solver,
    problem: &str,
    levels: &[OnGrid],
    plan: &Plan,
    say: &mut impl FnMut(&str),
) -> Result<Vec<Reached>, String> {
    let goals = goals(solver);
    let mut before = vec![0.0; goals.len()];
    let mut measured = Vec::new();
    for k in 2..=levels.len() {
        let level = &levels[k - 1];
        let cells = level.grid.cells();
        say(&format!("{solver}, {problem}, h = 1/{cells}"));
        for (g, (goal, growth, solve)) in goals.iter().enumerate() {
            if growth * before[g] > LONGEST {
                continue;
            }
            let y = solve(&levels[..k]).ok_or_else(|| {
                format!("{solver} does not reach {goal} on {problem}, h = 1/{cells}")
            })?;
            let median = time(plan.repeats, || {
                solve(&levels[..k]);
            });
            before[g] = median.0;
            measured.push(Reached::new([problem, goal], solver, level, &y, median));
        }
    }
    Ok(measured)
}
