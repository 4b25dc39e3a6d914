//! Many runs, on one grid or over nested ones, dealt out to the vector lanes.

use super::batch::{LANES, Lanes, Order};
use super::engine::{self, run_alone, within};
use super::solve::{gradient_extrema, judged};
use crate::discrete::end::{End, Outcome};
use crate::discrete::grid::Grid;
use crate::discrete::stop::Stop;
use crate::problem::law::Law;
use crate::saddle::{
    Engine, Goals, JobGoal, Method, NestedGrids, NestedLevels, Pair, RunStart, RunState, StopRule,
    run_nested, tolerance,
};
use std::array::from_fn;
use std::cmp::Reverse;
use std::collections::VecDeque;
use std::convert::Infallible;

/// A run to be done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Job<'a> {
    /// Law on the boundary.
    pub law: Law,
    /// Load vector F.
    pub load: &'a [f64],
    /// Start of the run.
    pub start: &'a Pair,
    /// The method.
    pub method: Method,
    /// Duality parameter r > 0.
    pub r: f64,
    /// Condition that ends it.
    pub goal: JobGoal,
    /// Sweeps after which to give up, at the earliest after the first.
    pub cap: usize,
}

impl Job<'_> {
    /// Judges the end of this run and its last pair.
    pub(crate) fn outcome(&self, grid: Grid, end: End, pair: &Pair) -> Outcome {
        let mut engine = super::engine(grid, self.law, &RunStart { pair, ..self.run() });
        let gradient = gradient_extrema(&mut *engine);
        judged(grid.into(), self.law.with_load(self.load), pair, end, gradient)
    }

    /// True if another job has the same iterates, until one of them ends.
    fn has_run_of(&self, other: &Self) -> bool {
        let apart = |job: &Self| (job.r, job.law, job.method, job.cap);
        apart(self) == apart(other) && self.load == other.load && self.start == other.start
    }

    fn run(&self) -> RunStart<'_> {
        RunStart { load: self.load, method: self.method, r: self.r, pair: self.start }
    }
}

/// Does all jobs; the ends and last pairs are in the order of the jobs. Lanes are busy the longer, the earlier long
/// runs come. Jobs that differ in their goals alone have one run.
///
/// # Panics
/// As [`Lanes::enter`].
pub(crate) fn run(grid: Grid, jobs: &[Job]) -> Vec<(End, Pair)> {
    if let [job] = jobs {
        // The engine of one run takes less time than eight lanes of which seven are idle.
        let mut engine = super::engine(grid, job.law, &job.run());
        let state = RunState::new(&job.run(), job.cap);
        let end = run_alone(&mut *engine, state, &mut |engine, run| {
            within(engine, [job.goal.bound(run)])[0]
        });
        return vec![(end, engine.pair(0).into_owned())];
    }
    let mut lanes = Lanes::new(grid, Law::SIGNORINI, Order::Lexicographic, 1.0);
    let mut queue = JobQueue {
        jobs,
        waiting: same_runs(jobs).into(),
        open: [const { Vec::new() }; LANES],
        ends: vec![None; jobs.len()],
    };
    let first = from_fn(|lane| queue.enter(&mut lanes, lane));
    engine::run(&mut lanes, first, &mut queue);
    queue.ends.into_iter().flatten().collect()
}

/// Numbers of the jobs, those together that have the same run up to its end.
fn same_runs(jobs: &[Job]) -> Vec<Vec<usize>> {
    let mut runs: Vec<Vec<usize>> = Vec::new();
    for (number, job) in jobs.iter().enumerate() {
        match runs.iter_mut().find(|run| jobs[run[0]].has_run_of(job)) {
            Some(run) => run.push(number),
            None => runs.push(vec![number]),
        }
    }
    runs
}

/// Jobs of which the next ones enter each lane that is free.
struct JobQueue<'a> {
    jobs: &'a [Job<'a>],
    /// Numbers of jobs that wait, those of one run together.
    waiting: VecDeque<Vec<usize>>,
    /// Numbers of the jobs in each lane whose goals are not reached.
    open: [Vec<usize>; LANES],
    /// Ends so far.
    ends: Vec<Option<(End, Pair)>>,
}

impl JobQueue<'_> {
    /// Puts the next jobs into a lane.
    fn enter(&mut self, lanes: &mut Lanes, lane: usize) -> Option<RunState> {
        self.open[lane] = self.waiting.pop_front()?;
        let job = self.jobs[self.open[lane][0]];
        lanes.enter(lane, job.law, &job.run());
        Some(RunState::new(&job.run(), job.cap))
    }
}

impl Goals<Lanes, LANES> for JobQueue<'_> {
    fn reached(&mut self, lanes: &mut Lanes, runs: [Option<&RunState>; LANES]) -> [bool; LANES] {
        let most = self.open.iter().map(Vec::len).max().unwrap_or(0);
        // The last ones first, so that those before keep their places.
        for place in (0..most).rev() {
            let job = |lane: usize| self.open[lane].get(place).map(|number| &self.jobs[*number]);
            let reached = within(lanes, from_fn(|lane| job(lane)?.goal.bound(runs[lane]?)));
            for (lane, run) in runs.iter().enumerate().filter(|(lane, _)| reached[*lane]) {
                let end = run.expect("it has a bound").end(Stop::Converged);
                let number = self.open[lane].remove(place);
                self.ends[number] = Some((end, lanes.pair(lane).into_owned()));
            }
        }
        from_fn(|lane| runs[lane].is_some() && self.open[lane].is_empty())
    }

    fn ended(&mut self, lanes: &mut Lanes, lane: usize, end: End) -> Option<RunState> {
        for number in std::mem::take(&mut self.open[lane]) {
            self.ends[number] = Some((end, lanes.pair(lane).into_owned()));
        }
        self.enter(lanes, lane)
    }
}

/// A run of the paper's method over nested grids.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NestedJob<'a> {
    /// Law on the boundary.
    pub law: Law,
    /// Load vectors, one per level.
    pub loads: &'a [Vec<f64>],
    /// Duality parameter r > 0.
    pub r: f64,
    /// Stopping rule, with the paper's tolerances.
    pub rule: StopRule,
}

/// Does all runs, from zero, as [`solve_nested`](crate::saddle::solve_nested) does; per run, the ends and pairs on all
/// levels. `cap(run, k)` bounds the sweeps on the k-th level; what it cuts off goes on to the next one.
///
/// On each level the runs begin that are expected to be the longest: those under a rule with a dual bound, and of these
/// those that were the longest on the level before.
///
/// # Panics
/// If the levels do not belong together, or a load has the wrong length.
pub(crate) fn run_all_nested(
    levels: &NestedGrids,
    runs: &[NestedJob],
    cap: impl Fn(usize, usize) -> usize,
) -> Vec<Vec<(End, Pair)>> {
    let mut pairs = vec![Pair::zero(levels.domain(0)); runs.len()];
    let mut done: Vec<Vec<(End, Pair)>> = vec![Vec::with_capacity(levels.count()); runs.len()];
    let mut order: Vec<usize> = (0..runs.len()).collect();
    let on_level = |k: usize, pairs: &mut Vec<Pair>| {
        order.sort_by_key(|&number| {
            let before = done[number].last().map_or(0, |(end, _)| end.sweeps());
            Reverse((runs[number].rule.asks_dual(), before))
        });
        let job = |&number: &usize| {
            let NestedJob { law, loads, r, rule } = runs[number];
            let (load, goal) = (&loads[k][..], JobGoal::Rule(rule, tolerance(k + 1)));
            let (method, start) = (Method::ArrowHurwicz, &pairs[number]);
            Job { law, load, start, method, r, goal, cap: cap(number, k) }
        };
        let jobs: Vec<_> = order.iter().map(job).collect();
        for (&number, ended) in order.iter().zip(run(levels.grids[k], &jobs)) {
            done[number].push(ended);
        }
        for (pair, done) in pairs.iter_mut().zip(&done) {
            pair.clone_from(&done[k].1);
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = run_nested(levels, &mut pairs, on_level);
    done
}

#[cfg(test)]
mod tests;
