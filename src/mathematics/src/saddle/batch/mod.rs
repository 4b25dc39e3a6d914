//! Many runs of the saddle-point methods on one grid at once, one per vector lane, each as if it were alone.
//!
//! A sweep waits at each node for its western neighbour, and all runs wait alike: eight of them
//! side by side cost less than three one after the other, and rows in pairs shorten the wait. A run's
//! stopping rule is first tried at the node that broke it last; all nodes are tried only when that one no
//! longer does. Iterates and counts are those of [`solve`](crate::saddle::solve) to the last bit.

mod arithmetic;
mod lanes;
mod measure;

pub use arithmetic::V;
pub use lanes::{Lanes, Order};

use super::engine::{self, within};
use super::solve::{gradient_extrema, judged};
use crate::discrete::end::{End, Outcome};
use crate::discrete::grid::Grid;
use crate::problem::law::Law;
use crate::saddle::{
    Engine, Goals, JobGoal, Method, NestedGrids, Pair, RunStart, RunState, SaddleDomain, StopRule,
    run_nested, tolerance,
};
use std::array::from_fn;
use std::convert::Infallible;

/// Runs side by side.
pub const LANES: usize = 8;

/// A run to be done.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
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
    pub fn outcome(&self, grid: Grid, law: Law, end: End, pair: &Pair) -> Outcome {
        let mut engine = grid.engine(law, &RunStart { pair, ..self.run() });
        let gradient = gradient_extrema(&mut *engine);
        judged(grid, law.with_load(self.load), pair, end, gradient)
    }

    fn run(&self) -> RunStart<'_> {
        RunStart { load: self.load, method: self.method, r: self.r, pair: self.start }
    }
}

/// Does all jobs under one law; the ends and last pairs are in the order of the jobs.
///
/// # Panics
/// If a load vector or a start has the wrong length for `grid`.
pub fn run(grid: Grid, law: Law, jobs: &[Job]) -> Vec<(End, Pair)> {
    let mut lanes = Lanes::new(grid, law, Order::Lexicographic, 1.0);
    let mut queue = JobQueue { jobs, next: 0, in_lanes: [0; LANES], ends: vec![None; jobs.len()] };
    let first = from_fn(|lane| queue.enter(&mut lanes, lane));
    engine::run(&mut lanes, first, &mut queue);
    queue.ends.into_iter().flatten().collect()
}

/// Jobs of which the next one enters each lane that is free.
struct JobQueue<'a> {
    jobs: &'a [Job<'a>],
    /// Number of the next job.
    next: usize,
    /// Number of the job in each lane.
    in_lanes: [usize; LANES],
    /// Ends so far.
    ends: Vec<Option<(End, Pair)>>,
}

impl JobQueue<'_> {
    /// Puts the next job into a lane.
    fn enter(&mut self, lanes: &mut Lanes, lane: usize) -> Option<RunState> {
        let job = self.jobs.get(self.next)?;
        self.in_lanes[lane] = self.next;
        self.next += 1;
        lanes.enter(lane, &job.run());
        Some(RunState::new(&job.run(), job.cap))
    }
}

impl Goals<Lanes, LANES> for JobQueue<'_> {
    fn reached(&mut self, lanes: &mut Lanes, runs: [Option<&RunState>; LANES]) -> [bool; LANES] {
        let bounds = from_fn(|lane| self.jobs[self.in_lanes[lane]].goal.bound(runs[lane]?));
        within(lanes, bounds)
    }

    fn ended(&mut self, lanes: &mut Lanes, lane: usize, end: End) -> Option<RunState> {
        self.ends[self.in_lanes[lane]] = Some((end, lanes.pair(lane).into_owned()));
        self.enter(lanes, lane)
    }
}

/// A run of the paper's method over nested grids.
#[derive(Clone, Copy, Debug)]
pub struct NestedJob<'a> {
    /// Load vectors, one per grid.
    pub loads: &'a [Vec<f64>],
    /// Duality parameter r > 0.
    pub r: f64,
    /// Stopping rule, with the paper's tolerances.
    pub rule: StopRule,
}

/// Does all runs under one law, from zero, as [`solve_nested`](crate::saddle::solve_nested) does; per run, the ends and
/// pairs on all grids. `cap(run, k)` bounds the sweeps on the k-th grid; what it cuts off goes on to the next one.
///
/// # Panics
/// If the grids are not as [`crate::discrete::grid::nested`] gives them, or a load has the wrong length.
pub fn run_all_nested(
    levels: NestedGrids<'_>,
    law: Law,
    runs: &[NestedJob],
    cap: impl Fn(usize, usize) -> usize,
) -> Vec<Vec<(End, Pair)>> {
    let mut pairs = vec![Pair::zero(levels.grids[0]); runs.len()];
    let mut done = vec![Vec::with_capacity(levels.grids.len()); runs.len()];
    let on_level = |k: usize, pairs: &mut Vec<Pair>| {
        let mut jobs = Vec::with_capacity(runs.len());
        for (number, (run, start)) in runs.iter().zip(&*pairs).enumerate() {
            jobs.push(Job {
                load: &run.loads[k],
                start,
                method: Method::ArrowHurwicz,
                r: run.r,
                goal: JobGoal::Rule(run.rule, tolerance(k + 1)),
                cap: cap(number, k),
            });
        }
        let ends = self::run(levels.grids[k], law, &jobs);
        for ((ended, done), pair) in ends.into_iter().zip(&mut done).zip(pairs) {
            pair.clone_from(&ended.1);
            done.push(ended);
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = run_nested(&levels, &mut pairs, on_level);
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::{LoadRule, load};
    use crate::discrete::network::Network;
    use crate::discrete::stop::Stop;
    use crate::saddle::{GradientMeasure, Params, arrow_hurwicz, solve};

    fn setting() -> (Grid, Vec<f64>, Pair) {
        let grid = Grid::new(16).unwrap();
        let f = "quadrant(ll)=-6; else=1.998".parse().unwrap();
        (grid, load(grid, &f, LoadRule::LumpedAverage {}), Pair::zero(grid))
    }

    fn laws() -> [Law; 2] {
        [Law::SIGNORINI, Law::friction(0.6).unwrap()]
    }

    #[test]
    fn each_lane_is_arrow_hurwicz_to_the_last_bit() {
        let (grid, load, start) = setting();
        let all = || [0.3, 1.0, 5.0, 1e6].iter().flat_map(|&r| StopRule::ALL.map(|rule| (r, rule)));
        let job = |(r, rule)| {
            let (method, goal) = (Method::ArrowHurwicz, JobGoal::Rule(rule, 1e-4));
            Job { load: &load, start: &start, method, r, goal, cap: 1000 }
        };
        for law in laws() {
            let ends = run(grid, law, &all().map(job).collect::<Vec<_>>());
            for ((r, rule), (ours, last)) in all().zip(ends) {
                let params =
                    Params { r, rule, tolerance: 1e-4, max_iterations: 1000, ..Params::default() };
                let mut pair = start.clone();
                let theirs = arrow_hurwicz(grid, law.with_load(&load), &params, &mut pair);
                assert_eq!(ours.sweeps(), theirs.end.iterations);
                assert_eq!(ours.delta_a, theirs.end.delta_a);
                assert_eq!(job((r, rule)).outcome(grid, law, ours, &last), theirs);
                assert_eq!(last, pair);
            }
        }
    }

    #[test]
    fn all_engines_have_the_same_pairs_and_measures_to_the_last_bit() {
        let (grid, load, start) = setting();
        let network = Network::of_square(grid);
        for law in laws() {
            let run = RunStart { load: &load, method: Method::ArrowHurwicz, r: 3.0, pair: &start };
            let (mut square, mut definition) =
                (grid.engine(law, &run), (&network).engine(law, &run));
            let mut lanes = Lanes::new(grid, law, Order::Lexicographic, 1.0);
            lanes.enter(5, &run);
            for _ in 0..20 {
                square.sweep();
                definition.sweep();
                lanes.sweep();
                let change = square.dual_step([true])[0];
                assert_eq!(definition.dual_step([true]), [change]);
                assert_eq!(lanes.dual_step([true; LANES])[5], change);
                for measure in GradientMeasure::ALL {
                    let worst = square.worst(measure)[0];
                    assert_eq!(definition.worst(measure), [worst], "{measure:?}");
                    assert_eq!(lanes.worst(measure)[5], worst, "{measure:?}");
                    assert_eq!(square.within(measure, [Some(worst)]), [true]);
                    assert_eq!(definition.within(measure, [Some(worst)]), [true]);
                    assert!(lanes.within(measure, [Some(worst); LANES])[5]);
                }
            }
            assert_eq!(square.pair(0), definition.pair(0));
            assert_eq!(square.pair(0), lanes.pair(5));
        }
    }

    #[test]
    fn what_is_no_number_anywhere_meets_no_goal() {
        let (grid, load, start) = setting();
        for node in [0, 7, grid.nodes() / 2, grid.nodes() - 1] {
            let mut load = load.clone();
            load[node] = f64::NAN;
            let rules = StopRule::ALL.map(|rule| JobGoal::Rule(rule, f64::MAX));
            for goal in rules.into_iter().chain([JobGoal::Kkt(f64::MAX)]) {
                let method = Method::ArrowHurwicz;
                // One sweep leaves numbers before the node; a cap of none is one as well.
                for cap in [0, 1] {
                    let job = Job { load: &load, start: &start, method, r: 1.0, goal, cap };
                    let (end, _) = &run(grid, Law::SIGNORINI, &[job])[0];
                    assert!(end.stop != Stop::Converged, "node {node}, {goal:?}");
                    assert_eq!(end.sweeps(), 1);
                }
            }
        }
    }

    #[test]
    fn and_uzawa_with_and_without_the_proximal_term() {
        let (grid, load, start) = setting();
        let all = [(0.0, 3.0, false), (1.0, 3.0, true), (10.0, 1e4, false), (0.0, 1e4, true)];
        let jobs = all.map(|(weight, r, loose)| {
            let method = Method::Uzawa { weight, inner: 1e-5, loose };
            let goal = JobGoal::Rule(StopRule::Printed, 1e-4);
            Job { load: &load, start: &start, method, r, goal, cap: 100_000 }
        });
        for law in laws() {
            for (job, (ours, last)) in jobs.iter().zip(run(grid, law, &jobs)) {
                let params = Params {
                    method: job.method,
                    r: job.r,
                    tolerance: 1e-4,
                    rule: StopRule::Printed,
                    ..Params::default()
                };
                let mut pair = start.clone();
                let run = solve(grid, law.with_load(&load), &params, &mut pair, None);
                assert_eq!(ours, run.end);
                assert_eq!((ours.stop, &last), (Stop::Converged, &pair));
            }
        }
    }
}
