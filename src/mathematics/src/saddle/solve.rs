//! Runs of the methods on one grid or network, each until its stopping rule is met.

use super::Pair;
use super::batch::{LANES, Lanes, Order};
use super::engine::{Engine, Goals, MeasureBound, RunStart, RunState, run, within};
use super::method::Method;
use super::network::OnNetwork;
use super::stopping::{GradientMeasure, StopRule};
use crate::discrete::domain::DiscreteDomain;
use crate::discrete::end::{End, Outcome, Stop};
use crate::discrete::kkt::{has_solution, judge};
use crate::discrete::transfer::Prolongation;
use serde::{Deserialize, Serialize};
use std::array::from_fn;

/// Parameters of the iteration, besides grid, law and load vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Method.
    pub method: Method,
    /// Duality parameter r > 0, the step of the multiplier.
    pub r: f64,
    /// Bound of the stopping rule, evaluated after each step of the multiplier; the paper takes 10^-N on grid N.
    pub tolerance: f64,
    /// Stopping rule. It uses the gradient (8), without the proximal term.
    pub rule: StopRule,
    /// KKT residual over the largest component of F that ends the run in place of the rule; none with a rule.
    pub kkt: Option<f64>,
    /// Limit on the number of sweeps; an iteration of the paper is one sweep.
    pub max_iterations: usize,
    /// Interpolation of pairs to the next grid of the square.
    pub prolongation: Prolongation,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            method: Method::ArrowHurwicz,
            r: 1.0,
            tolerance: 1e-5,
            rule: StopRule::Signed,
            kkt: None,
            max_iterations: 1_000_000,
            prolongation: Prolongation::default(),
        }
    }
}

/// State after one iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Iterations done on this grid.
    pub number: usize,
    /// `max_i dM/dy_i` at (y^(n), a^(n)).
    pub gradient_signed: f64,
    /// `max_i |dM/dy_i|` at the same pair.
    pub gradient_abs: f64,
    /// `max_i |a_i^(n) - a_i^(n-1)|`.
    pub delta_a: f64,
}

/// Condition that ends a run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RunGoal {
    /// A stopping rule with its tolerance, tried after each step of the multiplier.
    Rule(StopRule, f64),
    /// The natural KKT residual over the largest component of F, tried after each step of the multiplier.
    Kkt(f64),
}

impl RunGoal {
    /// Bound that ends a run if it holds after a step of the multiplier; none if this step was too long.
    ///
    /// Tolerances of a rule below the rounding errors of Uzawa's method count as those; the paper's method has no inner
    /// bound, and ends where the rule holds.
    fn bound(self, run: &RunState) -> Option<MeasureBound> {
        match self {
            Self::Kkt(target) => {
                Some(MeasureBound { measure: GradientMeasure::Kkt, bound: target * run.load })
            }
            Self::Rule(rule, tolerance) => {
                let dual_bound_holds =
                    !rule.asks_dual() || run.delta_a <= tolerance.max(run.floor.dual);
                let bound = tolerance.max(run.floor.gradient);
                dual_bound_holds.then_some(MeasureBound { measure: rule.measure(), bound })
            }
        }
    }
}

/// Run on one grid or network.
#[derive(Clone, Copy)]
pub(super) struct AskedRun<'a> {
    /// Load vector.
    pub(super) load: &'a [f64],
    pub(super) params: Params,
    /// Pair from which the run starts.
    pub(super) start: &'a Pair,
    /// True if the history is wanted, which makes each iteration more expensive.
    pub(super) has_history: bool,
}

impl AskedRun<'_> {
    fn start(&self) -> RunStart<'_> {
        let Params { method, r, .. } = self.params;
        RunStart { load: self.load, method, r, pair: self.start }
    }

    fn goal(&self) -> RunGoal {
        let Params { rule, tolerance, kkt, .. } = self.params;
        kkt.map_or(RunGoal::Rule(rule, tolerance), RunGoal::Kkt)
    }
}

/// End of a run on one grid or network.
pub(super) struct LevelEnd {
    pub(super) outcome: Outcome,
    /// Last pair.
    pub(super) pair: Pair,
    /// All iterations, if they are wanted.
    pub(super) history: Vec<Iteration>,
}

/// Iterates on `pair` until the stopping rule is met or the limit on sweeps is reached.
///
/// # Panics
/// If a vector has the wrong length for the domain, or `params.r` is not positive.
pub fn solve<'a>(
    domain: impl Into<DiscreteDomain<'a>>,
    load: &[f64],
    params: &Params,
    pair: &mut Pair,
) -> Outcome {
    let run = AskedRun { load, params: *params, start: pair, has_history: false };
    let ends = solve_together(domain.into(), &[run]);
    let [end] = <[LevelEnd; 1]>::try_from(ends).ok().expect("a run has an end");
    *pair = end.pair;
    end.outcome
}

/// Most runs on a grid that are faster one after the other than in the lanes of one engine.
const FEW: usize = 2;

/// Runs each until its stopping rule is met or its limit on sweeps is reached: on a grid side by side in the lanes of
/// an engine. The iterates of a run are the same whatever others are beside it.
///
/// A gradient is compared with the tolerance row by row, up to the first row that exceeds it; for a history, all rows
/// are evaluated.
///
/// # Panics
/// If a vector has the wrong length for the domain, or an r is not positive.
pub(super) fn solve_together(domain: DiscreteDomain<'_>, runs: &[AskedRun<'_>]) -> Vec<LevelEnd> {
    match domain {
        DiscreteDomain::Grid(grid, law) if runs.len() > FEW => {
            let mut lanes = Lanes::<LANES>::new(grid, law, Order::Lexicographic, 1.0);
            in_lanes(&mut lanes, domain, runs, Lanes::enter)
        }
        DiscreteDomain::Grid(grid, law) => {
            let mut lane = Lanes::<1, f64>::new(grid, law, Order::Lexicographic, 1.0);
            in_lanes(&mut lane, domain, runs, Lanes::enter)
        }
        DiscreteDomain::Network(network) => {
            let mut ends = Vec::with_capacity(runs.len());
            for run in runs {
                let mut engine = OnNetwork::new(network, &run.start());
                ends.extend(in_lanes(&mut engine, domain, &[*run], |_, _, _| ()));
            }
            ends
        }
    }
}

/// Puts a run into a lane of an engine.
type Enter<E> = fn(&mut E, usize, &RunStart<'_>);

/// Runs in the lanes of an engine until all have ended; one that ends makes room for the next.
fn in_lanes<const K: usize, E: Engine<K>>(
    engine: &mut E,
    domain: DiscreteDomain<'_>,
    runs: &[AskedRun<'_>],
    enter: Enter<E>,
) -> Vec<LevelEnd> {
    let histories = vec![Vec::new(); runs.len()];
    let ends = runs.iter().map(|_| None).collect();
    let mut goals = LaneGoals { domain, runs, enter, lanes: [0; K], next: 0, histories, ends };
    let states = from_fn(|lane| goals.enter_next(engine, lane));
    run(engine, states, &mut goals);
    goals.ends.into_iter().map(|end| end.expect("all runs have ended")).collect()
}

/// Goals of the runs in the lanes of an engine, and the runs that wait for a lane.
struct LaneGoals<'r, E, const K: usize> {
    domain: DiscreteDomain<'r>,
    runs: &'r [AskedRun<'r>],
    enter: Enter<E>,
    /// Number of the run in each lane.
    lanes: [usize; K],
    /// Number of the run that is the next to enter a lane.
    next: usize,
    histories: Vec<Vec<Iteration>>,
    ends: Vec<Option<LevelEnd>>,
}

impl<E: Engine<K>, const K: usize> LaneGoals<'_, E, K> {
    /// Puts the next run, if one waits, into a lane.
    fn enter_next(&mut self, engine: &mut E, lane: usize) -> Option<RunState> {
        let run = self.runs.get(self.next)?;
        self.lanes[lane] = self.next;
        self.next += 1;
        (self.enter)(engine, lane, &run.start());
        let unit = self.domain.unit(run.load);
        Some(RunState::new(run.params.method, unit, run.params.max_iterations))
    }

    /// Notes the iteration of each run whose history is wanted.
    fn note(&mut self, engine: &mut E, runs: [Option<&RunState>; K]) {
        let noted: [_; K] =
            from_fn(|lane| runs[lane].filter(|_| self.runs[self.lanes[lane]].has_history));
        if noted.iter().all(Option::is_none) {
            return;
        }
        let gradients = gradient_extrema(engine);
        for (lane, run) in noted.into_iter().enumerate() {
            let Some(&RunState { iterations: number, delta_a, .. }) = run else { continue };
            let [gradient_signed, gradient_abs] = gradients.map(|of| of[lane]);
            let iteration = Iteration { number, gradient_signed, gradient_abs, delta_a };
            self.histories[self.lanes[lane]].push(iteration);
        }
    }
}

impl<E: Engine<K>, const K: usize> Goals<E, K> for LaneGoals<'_, E, K> {
    fn reached(&mut self, engine: &mut E, runs: [Option<&RunState>; K]) -> [bool; K] {
        self.note(engine, runs);
        let bounds = from_fn(|lane| self.runs[self.lanes[lane]].goal().bound(runs[lane]?));
        within(engine, bounds)
    }

    fn ended(&mut self, engine: &mut E, lane: usize, end: End) -> Option<RunState> {
        let number = self.lanes[lane];
        let gradient = gradient_extrema(engine).map(|of| of[lane]);
        let pair = engine.pair(lane).into_owned();
        let outcome = judged(self.domain, self.runs[number].load, &pair, end, gradient);
        let history = std::mem::take(&mut self.histories[number]);
        self.ends[number] = Some(LevelEnd { outcome, pair, history });
        self.enter_next(engine, lane)
    }
}

/// Judges `pair` after the end of an iteration; `gradient` has the largest component of (8), and the largest absolute
/// value.
fn judged(
    domain: DiscreteDomain<'_>,
    load: &[f64],
    pair: &Pair,
    end: End,
    [gradient_signed, gradient_abs]: [f64; 2],
) -> Outcome {
    let judgement = judge(domain, &pair.y, load);
    let finite = [judgement.energy, gradient_abs, judgement.kkt.natural]
        .iter()
        .all(|value| value.is_finite())
        && judgement.kkt.min_lambda.is_none_or(f64::is_finite);
    let end = End { stop: if finite { end.stop } else { Stop::Diverged }, ..end };
    let has_solution = has_solution(domain, load);
    let outcome = Outcome::new(end, &judgement, domain.cells(), load, has_solution);
    let (gradient_signed, gradient_abs) = (Some(gradient_signed), Some(gradient_abs));
    Outcome { gradient_signed, gradient_abs, ..outcome }
}

/// In each lane the largest component of the gradient (8), and the largest absolute value of a component; NaN if one
/// is.
fn gradient_extrema<const K: usize>(engine: &mut impl Engine<K>) -> [[f64; K]; 2] {
    [GradientMeasure::Signed, GradientMeasure::Printed].map(|measure| engine.worst(measure))
}

#[cfg(test)]
mod tests;
