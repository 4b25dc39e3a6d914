//! Many runs of Arrow-Hurwicz and Uzawa on one grid at once, one per vector lane, each as if it were alone.
//!
//! A sweep waits at each node for its western neighbour, and all runs wait alike: eight of them
//! side by side cost less than three one after the other. A run's stopping rule is first tried at the node that broke it
//! last; all nodes are looked at only when that one no longer does. The counts are those of
//! [`solve`](crate::saddle::solve).

mod iterates;

use crate::discrete::grid::Grid;
use crate::saddle::{Method, Pair, StopRule};
use iterates::{Lanes, Measure};
use std::array::from_fn;

/// Runs side by side.
pub const LANES: usize = 8;

/// When a run has reached its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
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
    /// Where it starts.
    pub start: &'a Pair,
    /// The method.
    pub method: Method,
    /// Duality parameter r > 0.
    pub r: f64,
    /// When it ends.
    pub goal: Goal,
    /// Sweeps after which to give up.
    pub cap: usize,
}

/// How a run ended.
#[derive(Clone, Debug)]
pub struct End {
    /// Sweeps done.
    pub sweeps: usize,
    /// Whether the goal was reached.
    pub met: bool,
    /// Change of the multiplier in its last step.
    pub delta_a: f64,
    /// The last pair.
    pub pair: Pair,
}

/// Does all jobs; the ends are in the order of the jobs.
///
/// # Panics
/// If a load vector or a start has the wrong length for `grid`.
pub fn run(grid: Grid, jobs: &[Job]) -> Vec<End> {
    let mut ends: Vec<Option<End>> = vec![None; jobs.len()];
    let mut waiting = jobs.iter().enumerate();
    let mut lanes = Lanes::new(grid);
    let mut runs: [Option<Run>; LANES] = [const { None }; LANES];
    loop {
        for (lane, run) in runs.iter_mut().enumerate().filter(|(_, run)| run.is_none()) {
            *run = waiting.next().map(|(number, job)| Run::enter(&mut lanes, lane, number, job));
        }
        if runs.iter().all(Option::is_none) {
            return ends.into_iter().flatten().collect();
        }
        lanes.sweep();
        let steps = from_fn(|lane| {
            runs[lane].as_mut().is_some_and(|run| match run.job.method {
                Method::ArrowHurwicz => true,
                Method::Uzawa { .. } => {
                    lanes.within(lane, Measure::Inner, run.inner, &mut run.inner_witness, run.job)
                }
            })
        });
        let changes = lanes.step(steps);
        for lane in 0..LANES {
            let Some(run) = runs[lane].as_mut() else { continue };
            run.sweeps += 1;
            if steps[lane] {
                run.delta_a = changes[lane];
                run.after_step(&mut lanes, lane);
            }
            let met = steps[lane] && run.met(&mut lanes, lane);
            if met || run.sweeps == run.job.cap {
                let Run { sweeps, delta_a, .. } = *run;
                ends[run.number] = Some(End { sweeps, met, delta_a, pair: lanes.pair(lane) });
                runs[lane] = None;
            }
        }
    }
}

/// A job in a lane.
struct Run<'a> {
    number: usize,
    job: &'a Job<'a>,
    sweeps: usize,
    delta_a: f64,
    /// Bound on the inner gradient.
    inner: f64,
    /// Nodes that broke the goal and the inner bound when last looked at.
    witness: usize,
    inner_witness: usize,
    /// Largest component of F.
    scale: f64,
}

impl<'a> Run<'a> {
    fn enter(lanes: &mut Lanes, lane: usize, number: usize, job: &'a Job) -> Self {
        let scale = job.load.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
        let inner = job.method.inner_bound(scale).unwrap_or_default();
        lanes.enter(lane, job, job.method.weight());
        Self { number, job, sweeps: 0, delta_a: 0.0, inner, witness: 0, inner_witness: 0, scale }
    }

    /// Prepares the next inner minimisation.
    fn after_step(&mut self, lanes: &mut Lanes, lane: usize) {
        if let Method::Uzawa { inner, loose, .. } = self.job.method {
            if loose {
                let (gradient, _) = lanes.worst(lane, Measure::Printed, self.job);
                self.inner = self.job.method.inner_bound(gradient).unwrap_or(inner);
            }
            lanes.regularise(lane, self.job.load);
        }
    }

    /// Whether the goal is reached, after a step of the multiplier.
    fn met(&mut self, lanes: &mut Lanes, lane: usize) -> bool {
        let (measure, bound, dual) = match self.job.goal {
            Goal::Kkt(target) => (Measure::Kkt, target * self.scale, false),
            Goal::Rule(StopRule::Signed, tolerance) => (Measure::Signed, tolerance, false),
            Goal::Rule(StopRule::Printed, tolerance) => (Measure::Printed, tolerance, false),
            Goal::Rule(StopRule::SignedDual, tolerance) => (Measure::Signed, tolerance, true),
            Goal::Rule(StopRule::PrintedDual, tolerance) => (Measure::Printed, tolerance, true),
        };
        (!dual || self.delta_a <= bound)
            && lanes.within(lane, measure, bound, &mut self.witness, self.job)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::{LoadRule, load};
    use crate::saddle::{Params, StopReason, arrow_hurwicz, solve};

    fn setting() -> (Grid, Vec<f64>, Pair) {
        let grid = Grid::new(16).unwrap();
        let f = "quadrant(ll)=-6; else=1.998".parse().unwrap();
        (grid, load(grid, &f, LoadRule::LumpedAverage), Pair::zero(grid))
    }

    #[test]
    fn each_lane_is_arrow_hurwicz_to_the_last_bit() {
        let (grid, load, start) = setting();
        let all = || [0.3, 1.0, 5.0, 1e6].iter().flat_map(|&r| StopRule::ALL.map(|rule| (r, rule)));
        let job = |(r, rule)| {
            let (method, goal) = (Method::ArrowHurwicz, Goal::Rule(rule, 1e-4));
            Job { load: &load, start: &start, method, r, goal, cap: 1000 }
        };
        let ends = run(grid, &all().map(job).collect::<Vec<_>>());
        for ((r, rule), ours) in all().zip(ends) {
            let params = Params { r, rule, tolerance: 1e-4, max_iterations: 1000 };
            let mut pair = start.clone();
            let theirs = arrow_hurwicz(grid, &load, &params, &mut pair, None);
            assert_eq!((ours.sweeps, ours.delta_a), (theirs.iterations, theirs.delta_a));
            assert_eq!(ours.met, theirs.stop == StopReason::Converged);
            assert_eq!(ours.pair, pair);
        }
    }

    #[test]
    fn and_uzawa_with_and_without_the_proximal_term() {
        let (grid, load, start) = setting();
        let all = [(0.0, 3.0, false), (1.0, 3.0, true), (10.0, 1e4, false), (0.0, 1e4, true)];
        let jobs = all.map(|(weight, r, loose)| {
            let method = Method::Uzawa { weight, inner: 1e-5, loose };
            let goal = Goal::Rule(StopRule::Printed, 1e-4);
            Job { load: &load, start: &start, method, r, goal, cap: 100_000 }
        });
        for (job, ours) in jobs.iter().zip(run(grid, &jobs)) {
            let params =
                Params { r: job.r, tolerance: 1e-4, rule: StopRule::Printed, ..Params::default() };
            let mut pair = start.clone();
            let (end, sweeps) = solve(grid, &load, job.method, &params, &mut pair, None);
            assert_eq!((ours.sweeps, ours.delta_a), (sweeps, end.delta_a));
            assert_eq!((ours.met, &ours.pair), (true, &pair));
        }
    }
}
