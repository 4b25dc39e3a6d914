//! Saddle-point methods on one grid, in two alternating steps.
//!
//! 1. Minimise M(., a) of (7) over y, for a fixed multiplier a, by Gauss-Seidel sweeps (9)-(11).
//! 2. Update the multiplier by (12), and evaluate the stopping rule.
//!
//! Uzawa's algorithm sweeps in step 1 until the gradient of M(., a) is small (the paper's references use gradient
//! descent there). The paper's method sweeps once: Arrow-Hurwicz is Uzawa's algorithm with one inner sweep. The sweep is
//! the unit in which all methods are compared.
//!
//! Requirements: r > 0, and a load vector with negative sum. M(., a) then has a minimum: as the constant part of y
//! grows, M grows at least linearly, and as it falls, quadratically. M(., a) is not strongly convex: while
//! `r y >= a` at every boundary node its Hessian is the singular matrix A, and a sweep only moves y down by `h^2 / 2`
//! times the sum of F. If F sums to zero or more, M(., a) has no minimum: y grows without bound, and the run ends at the
//! limit on sweeps. With the proximal term each inner problem has a minimum for every F, and the sequence y^k grows
//! instead.
//!
//! References: N. N. Maksimova, equations (7)-(13), with the misprints corrected as in the book.
//! D. Bertsekas, Constrained Optimization and Lagrange Multiplier Methods, for Uzawa's algorithm;
//! R. V. Namm and A. S. Tkachenko, Izv. vuzov. Matematika, 2010, no. 4, for the proximal term (the
//! paper's refs 5 and 6); G. Woo, R. V. Namm, S. A. Sachkoff, Comput. Math. Math. Phys. 46 (2006) 23-33.

use super::engine::{End, Engine, MeasureBound, RunStart, RunState, run_alone, within};
use super::network::OnNetwork;
use super::square::OnSquare;
use super::stopping::{GradientMeasure, StopRule};
use super::{Outcome, Pair};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::DiscreteDomain;
use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::network::Network;
use crate::problem::law::Law;
use serde::{Deserialize, Serialize};

/// Accuracy of the minimisation over y before each step of the multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// One sweep: the paper's method.
    ArrowHurwicz,
    /// Sweeps until the gradient of M(., a), with the proximal term, is small enough.
    Uzawa {
        /// Factor c >= 0 of the added term `c / 2 ||v - v^k||^2` in L2(Omega), with the last minimiser v^k; zero for
        /// the plain algorithm. Unit: one over length squared. The mass matrix is lumped and therefore diagonal: `h^2`
        /// at interior nodes, half on edges, a quarter at corners.
        weight: f64,
        /// Bound on the absolute value of every component of the gradient, in units of F.
        inner: f64,
        /// True to relax the bound to a tenth of the gradient (8) after the last step of the multiplier (of the
        /// largest component of F before the first): a more accurate minimisation does not reduce the total work.
        loose: bool,
    },
}

impl Method {
    /// Proximal weight c.
    pub(crate) fn weight(self) -> f64 {
        match self {
            Self::ArrowHurwicz => 0.0,
            Self::Uzawa { weight, .. } => weight,
        }
    }

    /// Bound on the inner gradient after the gradient (8) was `gradient`; `None` if one sweep is enough.
    pub(crate) fn inner_bound(self, gradient: f64) -> Option<f64> {
        match self {
            Self::ArrowHurwicz => None,
            Self::Uzawa { inner, loose, .. } => {
                Some(if loose { (0.1 * gradient).max(inner) } else { inner })
            }
        }
    }

    /// The method with this bound on the inner gradient.
    pub fn with_inner(self, inner: f64) -> Self {
        match self {
            Self::ArrowHurwicz => self,
            Self::Uzawa { weight, loose, .. } => Self::Uzawa { weight, inner, loose },
        }
    }

    /// The method whose minimisations are as exact as is of use, where the rounding errors of the inner gradient are as
    /// large as `floor`: loose, if the bound that was asked for is out of reach.
    pub(super) fn above(self, floor: f64) -> Self {
        match self {
            Self::Uzawa { weight, inner, loose } => {
                Self::Uzawa { weight, inner, loose: loose || inner < floor }
            }
            Self::ArrowHurwicz => self,
        }
    }
}

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
pub type OnIteration<'a> = &'a mut dyn FnMut(&Iteration);

/// Condition that ends a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JobGoal {
    /// A stopping rule with its tolerance, tried after each step of the multiplier.
    Rule(StopRule, f64),
    /// The natural KKT residual over the largest component of F, tried after each step of the multiplier.
    Kkt(f64),
}

impl JobGoal {
    /// Bound that ends a run if it holds after a step of the multiplier; none if this step was too long.
    ///
    /// Tolerances of a rule below the rounding errors of Uzawa's method count as those; the paper's method has no inner
    /// bound, and ends where the rule holds.
    pub(super) fn bound(self, run: &RunState) -> Option<MeasureBound> {
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

/// Grid or network on which the methods run.
pub trait SaddleDomain: DiscreteDomain {
    /// Engine for one run.
    ///
    /// # Panics
    /// If a vector has the wrong length for the domain, or r is not positive.
    fn engine<'a>(self, law: Law, run: &RunStart<'a>) -> Box<dyn Engine<1> + 'a>
    where
        Self: 'a;
}

impl SaddleDomain for Grid {
    fn engine<'a>(self, law: Law, run: &RunStart<'a>) -> Box<dyn Engine<1> + 'a>
    where
        Self: 'a,
    {
        Box::new(OnSquare::new(self, law, run))
    }
}

impl SaddleDomain for &Network {
    fn engine<'a>(self, law: Law, run: &RunStart<'a>) -> Box<dyn Engine<1> + 'a>
    where
        Self: 'a,
    {
        Box::new(OnNetwork::new(self, law, run))
    }
}

/// Iterates on `pair` until the stopping rule is met or the limit on sweeps is reached.
///
/// Without a monitor the gradient is compared with the tolerance row by row, up to the first row that exceeds it; with
/// a monitor all rows are evaluated. The iterates are the same.
///
/// # Panics
/// If a vector has the wrong length for the domain, or `params.r` is not positive.
pub fn solve(
    domain: impl SaddleDomain,
    problem: LawAndLoad<'_>,
    params: &Params,
    pair: &mut Pair,
    monitor: Option<OnIteration>,
) -> Outcome {
    let LawAndLoad { law, load } = problem;
    let start = RunStart { load, method: params.method, r: params.r, pair };
    let mut engine = domain.engine(law, &start);
    let state = RunState::new(&start, params.max_iterations);
    let end = run_to_rule(&mut *engine, state, params, monitor);
    let gradient = gradient_extrema(&mut *engine);
    let last = engine.pair(0).into_owned();
    drop(engine);
    *pair = last;
    Outcome::judge(domain, problem, pair, &end, gradient)
}

/// Solves by the paper's method whatever `params.method` says, without a monitor.
///
/// # Panics
/// As [`solve`].
pub fn arrow_hurwicz(
    domain: impl SaddleDomain,
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
    let goal = JobGoal::Rule(params.rule, params.tolerance);
    run_alone(engine, state, &mut |engine, run| {
        if let Some(monitor) = monitor.as_mut() {
            let [gradient_signed, gradient_abs] = gradient_extrema(engine);
            let RunState { iterations: number, delta_a, .. } = *run;
            monitor(&Iteration { number, gradient_signed, gradient_abs, delta_a });
        }
        within(engine, [goal.bound(run)])[0]
    })
}

/// Largest component of the gradient (8), and largest absolute value of a component; NaN if one is.
pub(super) fn gradient_extrema(engine: &mut dyn Engine<1>) -> [f64; 2] {
    [GradientMeasure::Signed, GradientMeasure::Printed].map(|measure| engine.worst(measure)[0])
}

#[cfg(test)]
mod tests;
