//! One run of a method on one grid or network, until its stopping rule is met.

use super::Pair;
use super::batch::{Lanes, Order};
use super::engine::{Engine, MeasureBound, RunStart, RunState, run_alone, within};
use super::method::Method;
use super::network::OnNetwork;
use super::stopping::{GradientMeasure, StopRule};
use crate::discrete::domain::DiscreteDomain;
use crate::discrete::end::{End, Outcome};
use crate::discrete::kkt::{has_solution, judge};
use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::stop::Stop;
use crate::problem::law::Law;
use serde::{Deserialize, Serialize};

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
        }
    }
}

/// State after one iteration, as a monitor receives it.
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

/// Callback after each step of the multiplier.
pub(super) type OnIteration<'a> = &'a mut dyn FnMut(&Iteration);

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

/// Engine for one run on a grid or network.
///
/// # Panics
/// If a vector has the wrong length for the domain, or r is not positive.
pub(crate) fn engine<'a>(
    domain: impl Into<DiscreteDomain<'a>>,
    law: Law,
    run: &RunStart<'a>,
) -> Box<dyn Engine<1> + 'a> {
    match domain.into() {
        DiscreteDomain::Grid(grid) => {
            let mut lane = Lanes::<1, f64>::new(grid, law, Order::Lexicographic, 1.0);
            lane.enter(0, law, run);
            Box::new(lane)
        }
        DiscreteDomain::Network(network) => Box::new(OnNetwork::new(network, law, run)),
    }
}

/// Iterates on `pair` until the stopping rule is met or the limit on sweeps is reached.
///
/// Without a monitor the gradient is compared with the tolerance row by row, up to the first row that exceeds it; with
/// a monitor all rows are evaluated. The iterates are the same.
///
/// # Panics
/// If a vector has the wrong length for the domain, or `params.r` is not positive.
pub fn solve<'a>(
    domain: impl Into<DiscreteDomain<'a>>,
    problem: LawAndLoad<'_>,
    params: &Params,
    pair: &mut Pair,
    monitor: Option<OnIteration>,
) -> Outcome {
    let (domain, LawAndLoad { law, load }) = (domain.into(), problem);
    let start = RunStart { load, method: params.method, r: params.r, pair };
    let mut engine = engine(domain, law, &start);
    let state = RunState::new(&start, params.max_iterations);
    let end = run_to_rule(&mut *engine, state, params, monitor);
    let gradient = gradient_extrema(&mut *engine);
    let last = engine.pair(0).into_owned();
    drop(engine);
    *pair = last;
    judged(domain, problem, pair, end, gradient)
}

/// Solves by the paper's method whatever `params.method` says, without a monitor.
///
/// # Panics
/// As [`solve`].
pub fn arrow_hurwicz<'a>(
    domain: impl Into<DiscreteDomain<'a>>,
    problem: LawAndLoad<'_>,
    params: &Params,
    pair: &mut Pair,
) -> Outcome {
    solve(domain, problem, &Params { method: Method::ArrowHurwicz, ..*params }, pair, None)
}

/// Iterates until the stopping rule is met.
fn run_to_rule(
    engine: &mut dyn Engine<1>,
    state: RunState,
    params: &Params,
    mut monitor: Option<OnIteration>,
) -> End {
    let goal = params.kkt.map_or(RunGoal::Rule(params.rule, params.tolerance), RunGoal::Kkt);
    run_alone(engine, state, &mut |engine, run| {
        if let Some(monitor) = monitor.as_mut() {
            let [gradient_signed, gradient_abs] = gradient_extrema(engine);
            let RunState { iterations: number, delta_a, .. } = *run;
            monitor(&Iteration { number, gradient_signed, gradient_abs, delta_a });
        }
        within(engine, [goal.bound(run)])[0]
    })
}

/// Judges `pair` after the end of an iteration; `gradient` has the largest component of (8), and the largest absolute
/// value.
pub(super) fn judged(
    domain: DiscreteDomain<'_>,
    LawAndLoad { law, load }: LawAndLoad<'_>,
    pair: &Pair,
    end: End,
    [gradient_signed, gradient_abs]: [f64; 2],
) -> Outcome {
    let judgement = judge(domain, law, &pair.y, load);
    let finite = [judgement.energy, gradient_abs, judgement.kkt.natural]
        .iter()
        .all(|value| value.is_finite())
        && judgement.kkt.min_lambda.is_none_or(f64::is_finite);
    let end = End { stop: if finite { end.stop } else { Stop::Diverged }, ..end };
    let has_solution = has_solution(domain, law, load);
    let outcome = Outcome::new(end, &judgement, domain.cells(), load, has_solution);
    let (gradient_signed, gradient_abs) = (Some(gradient_signed), Some(gradient_abs));
    Outcome { gradient_signed, gradient_abs, ..outcome }
}

/// Largest component of the gradient (8), and largest absolute value of a component; NaN if one is.
pub(super) fn gradient_extrema(engine: &mut dyn Engine<1>) -> [f64; 2] {
    [GradientMeasure::Signed, GradientMeasure::Printed].map(|measure| engine.worst(measure)[0])
}

#[cfg(test)]
mod tests;
