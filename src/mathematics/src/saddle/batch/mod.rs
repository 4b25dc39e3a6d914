//! Many runs of the saddle-point methods on one grid at once, one per vector lane, each as if it were alone.
//!
//! A sweep waits at each node for its western neighbour, and all runs wait alike: eight of them
//! side by side cost less than three one after the other, and rows in pairs shorten the wait. A run's
//! stopping rule is first tried at the node that broke it last; all nodes are tried only when that one no
//! longer does. Iterates and counts are those of [`solve`](crate::saddle::solve) to the last bit, unless
//! values of Uzawa's method are not finite: that run ends at its cap.

mod arithmetic;
mod lanes;
mod measure;

pub use arithmetic::V;
pub use lanes::{LaneStart, Lanes, Order};
pub use measure::GradientMeasure;

use crate::discrete::grid::Grid;
use crate::discrete::stop::Stop;
use crate::discrete::transfer::Prolongation;
use crate::problem::law::Law;
use crate::saddle::gradient::{Duality, Gradient};
use crate::saddle::outcome::LastStep;
use crate::saddle::{Method, Outcome, Pair, StopRule, tolerance};
use std::array::from_fn;

/// Runs side by side.
pub const LANES: usize = 8;

/// Condition that ends a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JobGoal {
    /// A stopping rule with its tolerance, tried after each step of the multiplier.
    Rule(StopRule, f64),
    /// The natural KKT residual over the largest component of F, tried after each step of the multiplier.
    Kkt(f64),
}

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

/// End of a run.
#[derive(Clone, Debug)]
pub struct End {
    /// Sweeps done.
    pub sweeps: usize,
    /// Why it ended.
    pub stop: Stop,
    /// Change of the multiplier in its last step.
    pub delta_a: f64,
    /// The last pair.
    pub pair: Pair,
}

impl End {
    /// The sweeps, if the goal was reached.
    pub fn count(&self) -> Option<usize> {
        (self.stop == Stop::Converged).then_some(self.sweeps)
    }

    /// Converts to an [`Outcome`] that counts sweeps as iterations.
    pub fn outcome(&self, grid: Grid, law: Law, job: &Job) -> Outcome {
        let gradient =
            Gradient::new(grid, Duality { law, r: job.r }, 0.0).extrema(job.load, &self.pair);
        let last =
            LastStep { iterations: self.sweeps, delta_a: self.delta_a, gradient, stop: self.stop };
        Outcome::judge(grid, law, job.load, &self.pair, &last)
    }
}

/// Does all jobs under one law; the ends are in the order of the jobs.
///
/// # Panics
/// If a load vector or a start has the wrong length for `grid`.
pub fn run(grid: Grid, law: Law, jobs: &[Job]) -> Vec<End> {
    let mut ends: Vec<Option<End>> = vec![None; jobs.len()];
    let mut waiting = jobs.iter().enumerate();
    let mut lanes = Lanes::new(grid, law, Order::Lexicographic, 1.0);
    let mut runs: [Option<LaneRun>; LANES] = [const { None }; LANES];
    // Nodes that broke the bound on the inner gradient when last tried.
    let mut inner_witnesses = [0; LANES];
    loop {
        for (lane, run) in runs.iter_mut().enumerate().filter(|(_, run)| run.is_none()) {
            if let Some((number, job)) = waiting.next() {
                let &Job { load, start, method, r, .. } = job;
                lanes.enter(lane, &LaneStart { r, load, weight: method.weight(), start });
                *run = Some(LaneRun::new(number, job));
            }
        }
        if runs.iter().all(Option::is_none) {
            return ends.into_iter().flatten().collect();
        }
        lanes.sweep();
        let inner = from_fn(|lane| runs[lane].as_ref().and_then(|run| run.inner));
        let within = lanes.all_within(GradientMeasure::Inner, inner, &mut inner_witnesses);
        let steps = from_fn(|lane| runs[lane].is_some() && (inner[lane].is_none() || within[lane]));
        let changes = lanes.step(steps);
        let loose = |lane: usize| steps[lane] && runs[lane].as_ref().is_some_and(LaneRun::is_loose);
        let gradients = (0..LANES).any(loose).then(|| lanes.worst(GradientMeasure::Printed));
        for lane in 0..LANES {
            let Some(run) = runs[lane].as_mut() else { continue };
            run.sweeps += 1;
            if steps[lane] {
                run.delta_a = changes[lane];
                if let Some(gradients) = gradients.filter(|_| run.is_loose()) {
                    run.inner = run.job.method.inner_bound(gradients[lane]);
                }
                lanes.regularise(lane);
            }
            if let Some(stop) = run.stop(&lanes, lane, steps[lane]) {
                let LaneRun { sweeps, delta_a, number, .. } = *run;
                ends[number] = Some(End { sweeps, stop, delta_a, pair: lanes.pair(lane) });
                runs[lane] = None;
            }
        }
    }
}

/// A job in a lane.
struct LaneRun<'a> {
    number: usize,
    job: &'a Job<'a>,
    sweeps: usize,
    delta_a: f64,
    /// Bound on the inner gradient.
    inner: Option<f64>,
    /// The node that broke the goal when last tried.
    witness: usize,
    /// Largest component of F.
    scale: f64,
}

impl<'a> LaneRun<'a> {
    fn new(number: usize, job: &'a Job<'a>) -> Self {
        let scale = job.load.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
        let inner = job.method.inner_bound(scale);
        Self { number, job, sweeps: 0, delta_a: 0.0, inner, witness: 0, scale }
    }

    /// True if the inner bound follows the gradient.
    fn is_loose(&self) -> bool {
        matches!(self.job.method, Method::Uzawa { loose: true, .. })
    }

    /// Why the run ends after a sweep, if it does.
    fn stop(&mut self, lanes: &Lanes, lane: usize, stepped: bool) -> Option<Stop> {
        match stepped {
            true if self.delta_a.is_nan() => Some(Stop::Diverged),
            true if self.met(lanes, lane) => Some(Stop::Converged),
            _ => (self.sweeps >= self.job.cap).then_some(Stop::IterationLimit),
        }
    }

    /// True if the goal is reached, after a step of the multiplier.
    fn met(&mut self, lanes: &Lanes, lane: usize) -> bool {
        let (measure, bound, dual) = match self.job.goal {
            JobGoal::Kkt(target) => (GradientMeasure::Kkt, target * self.scale, false),
            JobGoal::Rule(rule, tolerance) => {
                let measure = if rule.is_printed() {
                    GradientMeasure::Printed
                } else {
                    GradientMeasure::Signed
                };
                (measure, tolerance, rule.asks_dual())
            }
        };
        (!dual || self.delta_a <= bound) && lanes.within(lane, measure, bound, &mut self.witness)
    }
}

/// A run of the paper's method over nested grids.
#[derive(Clone, Copy, Debug)]
pub struct Nested<'a> {
    /// Load vectors, one per grid.
    pub loads: &'a [Vec<f64>],
    /// Duality parameter r > 0.
    pub r: f64,
    /// Stopping rule, with the paper's tolerances.
    pub rule: StopRule,
}

/// Nested grids, and how their solutions are interpolated.
#[derive(Clone, Copy, Debug)]
pub struct NestedGrids<'a> {
    /// Grids, coarsest first, as [`crate::discrete::grid::nested`] gives them.
    pub grids: &'a [Grid],
    /// Interpolation to the next grid.
    pub prolongation: Prolongation,
}

/// Does all runs under one law, from zero, as [`solve_nested`](crate::saddle::solve_nested) does; per run, the ends on all
/// grids. `cap(run, k)` bounds the sweeps on the k-th grid; what it cuts off goes on to the next one.
///
/// # Panics
/// If the grids are not as [`crate::discrete::grid::nested`] gives them, or a load has the wrong length.
pub fn run_nested(
    NestedGrids { grids, prolongation }: NestedGrids<'_>,
    law: Law,
    runs: &[Nested],
    cap: impl Fn(usize, usize) -> usize,
) -> Vec<Vec<End>> {
    let mut pairs = vec![Pair::zero(grids[0]); runs.len()];
    let mut done = vec![Vec::with_capacity(grids.len()); runs.len()];
    for (k, &grid) in grids.iter().enumerate() {
        let jobs: Vec<Job> = runs
            .iter()
            .zip(&pairs)
            .enumerate()
            .map(|(number, (nested, start))| Job {
                load: &nested.loads[k],
                start,
                method: Method::ArrowHurwicz,
                r: nested.r,
                goal: JobGoal::Rule(nested.rule, tolerance(k + 1)),
                cap: cap(number, k),
            })
            .collect();
        let ends = run(grid, law, &jobs);
        for ((end, done), pair) in ends.into_iter().zip(&mut done).zip(&mut pairs) {
            if k + 1 < grids.len() {
                *pair = end.pair.prolonged(grid, prolongation);
            }
            done.push(end);
        }
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::{LoadRule, load};
    use crate::saddle::{Params, arrow_hurwicz, solve};

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
            for ((r, rule), ours) in all().zip(ends) {
                let params =
                    Params { r, rule, tolerance: 1e-4, max_iterations: 1000, ..Params::default() };
                let mut pair = start.clone();
                let theirs = arrow_hurwicz(grid, law.with_load(&load), &params, &mut pair);
                assert_eq!((ours.sweeps, ours.delta_a), (theirs.iterations, theirs.delta_a));
                assert_eq!(ours.outcome(grid, law, &job((r, rule))), theirs);
                assert_eq!(ours.pair, pair);
            }
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
                    let end = &run(grid, Law::SIGNORINI, &[job])[0];
                    assert!(end.stop != Stop::Converged, "node {node}, {goal:?}");
                    assert_eq!(end.sweeps, 1);
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
            for (job, ours) in jobs.iter().zip(run(grid, law, &jobs)) {
                let params = Params {
                    method: job.method,
                    r: job.r,
                    tolerance: 1e-4,
                    rule: StopRule::Printed,
                    ..Params::default()
                };
                let mut pair = start.clone();
                let run = solve(grid, law.with_load(&load), &params, &mut pair, None);
                assert_eq!((ours.sweeps, ours.delta_a), (run.sweeps, run.outcome.delta_a));
                assert_eq!((ours.stop, &ours.pair), (Stop::Converged, &pair));
            }
        }
    }
}
