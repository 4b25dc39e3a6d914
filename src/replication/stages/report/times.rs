//! What the chapter on cost says about recorded times: fits, crossovers, and what was to be reached.

use crate::experiments::accuracy::Findings;
use crate::experiments::targets::Target;
use crate::experiments::{Range, exponent};
use crate::timing::measure::{SOLVERS, TIMED};
use crate::timing::recorded::{self, Goal, Reached, Scaling, Timings, to_discretisation};
use serde::Serialize;

/// Recorded times, digested.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Times {
    /// Multigrid, one line per grid.
    grids: Vec<Grid>,
    /// Power laws of its time, per number of threads and goal.
    fits: Vec<Fit>,
    /// All solvers to the discretisation error, per problem.
    comparisons: Vec<Comparison>,
    /// The noisiest medians, worst first.
    noise: Vec<Noise>,
    outdated: Option<Outdated>,
    /// The spectral solver beside multigrid, if it was timed.
    spectral: Option<Spectral>,
    /// Other people's times over ours: least and greatest.
    peers: Option<[f64; 2]>,
    /// Nanoseconds per unknown that were to be reached, were time inverse to the bandwidth of updates.
    scaled: [f64; 2],
    /// One thread's time over that of two, for both goals.
    #[serde(skip)]
    speedup: Option<[f64; 2]>,
    /// Nanoseconds per node of a sweep of the paper's method.
    #[serde(skip)]
    sweep: Option<f64>,
}

/// The distance of the quartiles over a median.
#[derive(Clone, Debug, Serialize)]
struct Noise {
    solver: String,
    cells: usize,
    spread: f64,
}

/// Where multigrid has changed since it was timed.
#[derive(Clone, Debug, Serialize)]
struct Outdated {
    cells: usize,
    /// Work units to the rounding floor, as timed and as it is.
    then: f64,
    now: f64,
}

/// Multigrid on one grid.
#[derive(Clone, Debug, Serialize)]
struct Grid {
    cells: usize,
    unknowns: usize,
    /// Bytes of the workspace per unknown.
    bytes: f64,
    /// To the discretisation error, then to the rounding floor.
    goals: Vec<Timed>,
}

#[derive(Clone, Debug, Serialize)]
struct Timed {
    work_units: f64,
    /// Nanoseconds per unknown, by threads: one, then two if there are.
    ns: Vec<f64>,
    /// Nanoseconds per unknown and work unit, one thread.
    per_unit: f64,
    /// Nanoseconds per unknown in which the memory could have moved the bytes, one thread.
    stream: f64,
}

#[derive(Clone, Debug, Serialize)]
struct Fit {
    goal: &'static str,
    threads: usize,
    exponent: f64,
    /// Unknowns on the coarsest and the finest grid of the fit.
    from: usize,
    to: usize,
    /// Nanoseconds per unknown: least and greatest.
    ns: [f64; 2],
}

#[derive(Clone, Debug, Serialize)]
struct Comparison {
    problem: String,
    solvers: [&'static str; 5],
    rows: Vec<Row>,
    /// Per solver but multigrid: the finest grid on which it is fastest, and its time over multigrid's on
    /// the finest grid it has been run on.
    against: Vec<Against>,
}

/// What an error of [`Spectral::error`] in the energy takes, over problems.
#[derive(Clone, Debug, Serialize)]
struct Spectral {
    error: f64,
    milliseconds: Range,
    /// Multigrid's time over it, on a grid so fine that it would have this error.
    ratio: Range,
}

#[derive(Clone, Debug, Serialize)]
struct Row {
    cells: usize,
    seconds: Vec<Option<f64>>,
    best: &'static str,
}

#[derive(Clone, Debug, Serialize)]
struct Against {
    solver: &'static str,
    /// Finest grid on which it is at least as fast as multigrid.
    until: Option<usize>,
    /// Finest grid with both, and the ratio of times there.
    cells: usize,
    ratio: f64,
}

/// Nanoseconds per unknown that were to be reached on a machine that updates [`THEIR_UPDATE`] GB/s in place.
const WANTED: [f64; 2] = [8.0, 30.0];
const THEIR_UPDATE: f64 = 60.0;
/// Bounds: exponent of the growth of time, two threads over one, ns per node of a sweep, PETSc over ours.
const PROPORTIONAL: f64 = 1.05;
const SPEEDUP: f64 = 1.6;
const SWEEP: f64 = 1.5;
const PEERS: f64 = 100.0;
/// Error of the energy, relative, at which the spectral solver and multigrid are compared.
const FAR: f64 = 1e-10;
/// Cells per side of the grid on which two threads are judged.
const THREADS_AT: usize = 2048;
/// Power laws are fitted to grids with at least so many unknowns.
const FIT_FROM: usize = 100_000;

fn unknowns(cells: usize) -> usize {
    (cells + 1) * (cells + 1)
}

fn ns(line: &Scaling) -> f64 {
    1e9 * line.seconds / unknowns(line.cells) as f64
}

impl Times {
    pub(super) fn of(timings: &Timings, accuracy: &Findings) -> Self {
        let mut problems: Vec<&String> = timings.solver.iter().map(|line| &line.problem).collect();
        problems.dedup();
        let ratios = || timings.peer.iter().map(|peer| peer.theirs / peer.ours);
        let least = ratios().reduce(f64::min);
        Self {
            grids: grids(timings),
            fits: fits(&timings.multigrid),
            comparisons: problems
                .into_iter()
                .map(|problem| Comparison::of(problem, &timings.solver))
                .collect(),
            noise: noise(timings),
            outdated: Outdated::of(timings, accuracy),
            spectral: Spectral::of(timings),
            peers: least.zip(ratios().reduce(f64::max)).map(|(least, most)| [least, most]),
            scaled: WANTED.map(|ns| ns * THEIR_UPDATE / timings.bandwidth.update),
            speedup: speedup(timings),
            sweep: timings.sweep.as_ref().map(|sweep| sweep.ns),
        }
    }

    /// Times against what was to be reached.
    pub(super) fn targets(&self) -> Vec<Target> {
        let mut targets = Vec::new();
        if let Some(grid) = self.grids.last() {
            for ((goal, wanted), (_, name)) in grid.goals.iter().zip(WANTED).zip(GOALS) {
                let name = format!("ns per unknown to the {name}, one thread, 1/{}", grid.cells);
                targets.push(Target::at_most(name, wanted, goal.ns[0]));
            }
        }
        for fit in self.fits.iter().filter(|fit| fit.threads == 1) {
            let name = format!("exponent of time over unknowns, {}, one thread", fit.goal);
            targets.push(Target::at_most(name, PROPORTIONAL, fit.exponent));
        }
        if let Some(ratios) = self.speedup {
            for (ratio, (_, name)) in ratios.into_iter().zip(GOALS) {
                let name = format!("two threads over one to the {name}, 1/{THREADS_AT}");
                targets.push(Target::at_least(name, SPEEDUP, ratio));
            }
        }
        if let Some(ns) = self.sweep {
            targets.push(Target::at_most("ns per node of the paper's iteration", SWEEP, ns));
        }
        if let Some([least, _]) = self.peers {
            targets.push(Target::at_least("PETSc's time over ours, the least", PEERS, least));
        }
        targets
    }
}

impl Spectral {
    /// Multigrid's error of the energy falls like the reciprocal of its unknowns, and its time grows with them.
    fn of(timings: &Timings) -> Option<Self> {
        let times = |lines: &[recorded::Spectral]| {
            let reached = lines.iter().filter(|line| line.error <= FAR);
            let spectral = reached.map(|line| line.seconds).reduce(f64::min)?;
            let solver = timings.solver.iter().filter(|line| line.solver == "multigrid");
            let multigrid = solver.filter(|line| line.problem == lines[0].problem);
            let best = multigrid.map(|line| line.seconds * line.error).reduce(f64::min)?;
            Some([spectral, best / FAR])
        };
        let problems = timings.spectral.chunk_by(|a, b| a.problem == b.problem);
        let times: Vec<_> = problems.filter_map(times).collect();
        Some(Self {
            error: FAR,
            milliseconds: Range::of(times.iter().map(|[spectral, _]| 1e3 * spectral))?,
            ratio: Range::of(times.iter().map(|[spectral, multigrid]| multigrid / spectral))?,
        })
    }
}

/// The two noisiest medians.
fn noise(timings: &Timings) -> Vec<Noise> {
    let multigrid = timings.multigrid.iter().map(|l| ("multigrid", l.cells, l.spread));
    let solvers = timings.solver.iter().map(|l| (l.solver.as_str(), l.cells, l.spread));
    let mut all: Vec<Noise> = multigrid
        .chain(solvers)
        .map(|(solver, cells, spread)| Noise { solver: solver.into(), cells, spread })
        .collect();
    all.sort_by(|a, b| b.spread.total_cmp(&a.spread));
    all.truncate(2);
    all
}

impl Outdated {
    /// On the finest grid that both know, if the work differs there.
    fn of(timings: &Timings, accuracy: &Findings) -> Option<Self> {
        let timed = accuracy.problems.iter().find(|problem| problem.name == TIMED.name())?;
        let mut both = timed.levels.iter().rev().filter_map(|level| {
            let (cells, [.., floor]) = (level.cost.cells, &level.cost.goals);
            let then = find(timings, cells, 1, Goal::Floor)?.work_units;
            Some(Self { cells, then, now: floor.work_units })
        });
        both.next().filter(|work| (work.then - work.now).abs() > 1e-6 * work.now)
    }
}

const GOALS: [(Goal, &str); 2] =
    [(Goal::Discretisation, "discretisation error"), (Goal::Floor, "rounding floor")];

fn find(timings: &Timings, cells: usize, threads: usize, goal: Goal) -> Option<&Scaling> {
    timings
        .multigrid
        .iter()
        .find(|line| line.cells == cells && line.threads == threads && line.goal == goal)
}

fn grids(timings: &Timings) -> Vec<Grid> {
    let mut all: Vec<usize> = timings.multigrid.iter().map(|line| line.cells).collect();
    all.dedup();
    let grid = |cells: usize| {
        let timed = |(goal, _): (Goal, _)| {
            let one = find(timings, cells, 1, goal)?;
            let lines = [Some(one), find(timings, cells, 2, goal)];
            Some(Timed {
                work_units: one.work_units,
                ns: lines.into_iter().flatten().map(ns).collect(),
                per_unit: ns(one) / one.work_units,
                stream: one.traffic / timings.bandwidth.update,
            })
        };
        let goals = GOALS.into_iter().map(timed).collect::<Option<Vec<_>>>()?;
        let bytes = find(timings, cells, 1, Goal::Floor)?.bytes;
        Some(Grid { cells, unknowns: unknowns(cells), bytes, goals })
    };
    all.into_iter().filter_map(grid).collect()
}

fn fits(lines: &[Scaling]) -> Vec<Fit> {
    let mut fits = Vec::new();
    for (goal, name) in GOALS {
        for threads in 1..=2 {
            let mine: Vec<_> = lines
                .iter()
                .filter(|l| l.goal == goal && l.threads == threads)
                .filter(|l| unknowns(l.cells) >= FIT_FROM)
                .collect();
            let (Some(first), Some(last)) = (mine.first(), mine.last()) else { continue };
            let points: Vec<_> =
                mine.iter().map(|l| (unknowns(l.cells) as f64, l.seconds)).collect();
            let exponent = exponent(&points);
            if exponent.is_finite() {
                let (from, to) = (unknowns(first.cells), unknowns(last.cells));
                let range = |f: fn(f64, f64) -> f64| mine.iter().map(|l| ns(l)).reduce(f);
                let ns = [range(f64::min), range(f64::max)].map(Option::unwrap_or_default);
                fits.push(Fit { goal: name, threads, exponent, from, to, ns });
            }
        }
    }
    fits
}

impl Comparison {
    fn of(problem: &str, lines: &[Reached]) -> Self {
        let times = SOLVERS.map(|solver| {
            let mine: Vec<_> =
                lines.iter().filter(|l| l.solver == solver && l.problem == problem).collect();
            to_discretisation(&mine).collect::<Vec<_>>()
        });
        let mut grids: Vec<usize> = times.iter().flatten().map(|(cells, _)| *cells).collect();
        grids.sort_unstable();
        grids.dedup();
        let at = |k: usize, cells: usize| {
            times[k].iter().find(|(grid, _)| *grid == cells).map(|(_, seconds)| *seconds)
        };
        let row = |cells: usize| {
            let seconds: Vec<_> = (0..SOLVERS.len()).map(|k| at(k, cells)).collect();
            let there = seconds.iter().enumerate().filter_map(|(k, s)| Some((k, (*s)?)));
            let best = there.min_by(|a, b| a.1.total_cmp(&b.1)).map_or("", |(k, _)| SOLVERS[k]);
            Row { cells, seconds, best }
        };
        let rows: Vec<_> = grids.into_iter().map(row).collect();
        let multigrid = SOLVERS.len() - 1;
        let against = (0..multigrid).filter_map(|k| {
            let both = |row: &Row| Some((row.cells, row.seconds[k]? / row.seconds[multigrid]?));
            let ratios: Vec<_> = rows.iter().filter_map(both).collect();
            let until = ratios.iter().filter(|(_, ratio)| *ratio <= 1.0).map(|r| r.0).max();
            let &(cells, ratio) = ratios.last()?;
            Some(Against { solver: SOLVERS[k], until, cells, ratio })
        });
        let against = against.collect();
        Self { problem: problem.into(), solvers: SOLVERS, rows, against }
    }
}

fn speedup(timings: &Timings) -> Option<[f64; 2]> {
    let on = |threads: usize, goal| find(timings, THREADS_AT, threads, goal).map(ns);
    let ratio = |goal| Some(on(1, goal)? / on(2, goal)?);
    Some([ratio(Goal::Discretisation)?, ratio(Goal::Floor)?])
}
