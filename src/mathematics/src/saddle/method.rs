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

use super::gradient::{Duality, Extrema, Gradient, dual_step};
use super::outcome::LastStep;
use super::stopping::{GradientTerms, RoundingFloor, SWEEPS_TO_FLOOR, StopRule};
use super::sweep::GaussSeidel;
use super::{Outcome, Pair};
use crate::discrete::grid::Grid;
use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::norms::largest;
use crate::discrete::stop::Stop;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

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

/// Outcome of [`solve`], and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaddleRun {
    /// Outcome of the last pair.
    pub outcome: Outcome,
    /// Number of Gauss-Seidel sweeps.
    pub sweeps: usize,
}

/// Iterates on `pair` in place until the stopping rule is met or the limit on sweeps is reached.
///
/// The central function of this room. Without a monitor the gradient is compared with the tolerance row by row, up to
/// the first row that exceeds the tolerance; with a monitor all rows are evaluated. The iterates are the same. Bounds
/// of Uzawa's method below the rounding errors of the gradient count as those; the paper's method has no inner bound,
/// and ends where the stopping rule holds.
///
/// # Panics
/// If a slice has the wrong length for `grid`, or `params.r` is not positive.
pub fn solve(
    grid: Grid,
    LawAndLoad { law, load }: LawAndLoad<'_>,
    params: &Params,
    pair: &mut Pair,
    mut monitor: Option<OnIteration>,
) -> SaddleRun {
    let mut steps = Steps::new(grid, load, params.method, Duality { law, r: params.r });
    let stop = loop {
        if let ControlFlow::Break(stop) = steps.step(pair, params.max_iterations) {
            break stop;
        }
        let (number, delta_a) = (steps.iterations, steps.delta_a);
        if let Some(monitor) = monitor.as_mut() {
            let Extrema { signed, absolute } = steps.gradient.extrema(load, pair);
            let (gradient_signed, gradient_abs) = (signed, absolute);
            monitor(&Iteration { number, gradient_signed, gradient_abs, delta_a });
        }
        let RoundingFloor { gradient, dual } = steps.floor;
        let tolerance = params.tolerance.max(gradient);
        if (!params.rule.asks_dual() || delta_a <= params.tolerance.max(dual))
            && steps.gradient.within(load, pair, tolerance, params.rule.is_printed())
        {
            break Stop::Converged;
        }
    };
    let last = LastStep {
        iterations: steps.iterations,
        delta_a: steps.delta_a,
        gradient: steps.gradient.extrema(load, pair),
        stop,
    };
    SaddleRun { outcome: Outcome::judge(grid, law, load, pair, &last), sweeps: steps.sweeps }
}

/// Solves by the paper's method whatever `params.method` says, without a monitor.
///
/// # Panics
/// If a slice has the wrong length for `grid`, or `params.r` is not positive.
pub fn arrow_hurwicz(
    grid: Grid,
    problem: LawAndLoad<'_>,
    params: &Params,
    pair: &mut Pair,
) -> Outcome {
    solve(grid, problem, &Params { method: Method::ArrowHurwicz, ..*params }, pair, None).outcome
}

/// Iteration of a method on one grid, one step of the multiplier at a time, without a stopping rule.
pub struct Steps<'a> {
    grid: Grid,
    load: &'a [f64],
    method: Method,
    duality: Duality,
    /// Positions of the boundary nodes in a nodal vector, in boundary order.
    boundary: Vec<usize>,
    /// Gradient (8), without the proximal term.
    gradient: Gradient,
    /// Gradient of the inner problem, with the proximal term.
    inner: Gradient,
    /// Bound on the inner gradient; `None` if one sweep is enough.
    bound: Option<f64>,
    /// Diagonal entry `c h^2` of the proximal term at an interior node.
    shift: f64,
    /// Terms of the inner gradient.
    terms: GradientTerms,
    /// Rounding errors of Uzawa's method.
    floor: RoundingFloor,
    /// Load vector of the inner problem: F plus `shift y^k`, halved on edges, quartered at corners.
    target: Vec<f64>,
    /// Steps of the multiplier done.
    iterations: usize,
    /// Sweeps done.
    sweeps: usize,
    /// Last change of the multiplier.
    delta_a: f64,
}

impl<'a> Steps<'a> {
    /// Prepares the iteration, before its first step.
    ///
    /// # Panics
    /// If `load` has the wrong length for `grid`, or r is not positive.
    pub fn new(grid: Grid, load: &'a [f64], method: Method, duality: Duality) -> Self {
        assert!(duality.r > 0.0, "the duality parameter r must be positive");
        assert!(load.len() == grid.nodes());
        let shift = method.weight() * grid.h() * grid.h();
        Self {
            grid,
            load,
            method,
            duality,
            boundary: grid.boundary().collect(),
            gradient: Gradient::new(grid, duality, 0.0),
            inner: Gradient::new(grid, duality, shift),
            bound: method.inner_bound(largest(load)),
            shift,
            terms: GradientTerms {
                matrix: 8.0 + shift + grid.h() * duality.r,
                most_measure: grid.h(),
                least_measure: grid.h(),
            },
            floor: RoundingFloor::default(),
            target: load.to_vec(),
            iterations: 0,
            sweeps: 0,
            delta_a: 0.0,
        }
    }

    /// Sweeps done so far.
    pub fn sweeps(&self) -> usize {
        self.sweeps
    }

    /// Minimises over y and takes the step (12).
    ///
    /// Breaks with a reason to end the run if `max_sweeps` are done, or if a value is no longer finite.
    ///
    /// # Panics
    /// If `pair` has the wrong length for the grid.
    pub fn step(&mut self, pair: &mut Pair, max_sweeps: usize) -> ControlFlow<Stop> {
        assert!(pair.y.len() == self.grid.nodes() && pair.a.len() == self.boundary.len());
        self.regularise(pair);
        loop {
            if self.sweeps >= max_sweeps {
                return ControlFlow::Break(Stop::IterationLimit);
            }
            self.sweeps += 1;
            GaussSeidel::new(self.grid, &self.target, self.shift, self.duality, &pair.a)
                .sweep(&mut pair.y);
            let Some(bound) = self.bound else { break };
            // A NaN spreads to the boundary within as many sweeps as there are rows.
            if !self.boundary.iter().all(|&node| pair.y[node].is_finite()) {
                return ControlFlow::Break(Stop::Diverged);
            }
            if self.sweeps.is_multiple_of(SWEEPS_TO_FLOOR) {
                self.floor = self.terms.floor(largest(&self.target), pair);
            }
            if self.inner.within(&self.target, pair, bound.max(self.floor.gradient), true) {
                break;
            }
        }
        self.iterations += 1;
        let Some(delta_a) = dual_step(self.duality, &self.boundary, pair) else {
            return ControlFlow::Break(Stop::Diverged);
        };
        self.delta_a = delta_a;
        let method = self.method.above(self.floor.gradient);
        if matches!(method, Method::Uzawa { loose: true, .. }) {
            self.bound = method.inner_bound(self.gradient.extrema(self.load, pair).absolute);
        }
        ControlFlow::Continue(())
    }

    /// Centres the proximal term at the present y.
    fn regularise(&mut self, pair: &Pair) {
        if self.shift > 0.0 {
            let (n, side) = (self.grid.cells(), self.grid.side());
            for (k, target) in self.target.iter_mut().enumerate() {
                let weights =
                    [k % side, k / side].map(|i| if i == 0 || i == n { 0.5 } else { 1.0 });
                *target = self.load[k] + weights[0] * weights[1] * self.shift * pair.y[k];
            }
        }
    }
}

#[cfg(test)]
mod tests;
