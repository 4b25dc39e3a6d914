//! Saddle-point methods on one grid: a minimisation over y, then a step (12) of the multiplier, in turn.
//!
//! Uzawa's algorithm minimises the functional M(., a) of (7) over y until its gradient is small. The
//! paper's references descend inside; here it is the Gauss-Seidel sweep (9)-(11) with the multiplier held
//! fixed, itself a descent, coordinate by coordinate. The paper's method sweeps once: it is Uzawa's
//! algorithm with one inner sweep, and the sweep is the unit in which all methods are compared.
//!
//! Requirements: r > 0; a load vector with negative sum. M(., a) then has a minimum, because a constant
//! costs at least linearly upwards and quadratically downwards. It is not strongly convex, though: where
//! no boundary node is penalised (`r y >= a` all around) its Hessian is the singular matrix A, and in the
//! end each sweep only moves y down by `h^2 / 2` times the sum of F, until some node is. If F sums to
//! zero or more M(., a) has no minimum; that drift goes up for ever and the run ends at its cap, as an
//! outcome. With the proximal term each inner problem is well posed whatever F, and y^k drifts instead.
//!
//! References: N. N. Maksimova, equations (7)-(13); the misprints are mended as the report says.
//! D. Bertsekas, Constrained Optimization and Lagrange Multiplier Methods, for Uzawa's algorithm;
//! R. V. Namm and A. S. Tkachenko, Izv. vuzov. Matematika, 2010, no. 4, for the proximal term (the
//! paper's refs 5 and 6); G. Woo, R. V. Namm, S. A. Sachkoff, Comput. Math. Math. Phys. 46 (2006) 23-33.

use super::gradient::{Gradient, dual_step};
use super::stopping::{StopReason, StopRule};
use super::sweep::sweep;
use super::{Outcome, Pair};
use crate::discrete::grid::Grid;
use crate::discrete::norms::largest;
use serde::{Deserialize, Serialize};

/// How far y is minimised before each step of the multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// One sweep: the paper's method.
    ArrowHurwicz,
    /// Sweeps until the gradient of M(., a), with the proximal term, is small enough.
    Uzawa {
        /// Factor c >= 0 of the added term `c / 2 ||v - v^k||^2` in L2(Omega), v^k being the last
        /// minimiser; zero for the plain algorithm. Unit: one over length squared. Lumped mass, `h^2`
        /// at interior nodes, half on edges, a quarter at corners, keeps the term on the diagonal.
        weight: f64,
        /// Bound on the absolute value of every component that is always small enough, in units of F.
        inner: f64,
        /// Whether a tenth of the gradient (8) at the last step of the multiplier, and of the largest
        /// component of F before the first, is enough as well: further costs more and gains nothing.
        loose: bool,
    },
}

impl Method {
    /// The proximal weight c.
    pub(crate) fn weight(self) -> f64 {
        match self {
            Self::ArrowHurwicz => 0.0,
            Self::Uzawa { weight, .. } => weight,
        }
    }

    /// Bound on the inner gradient when the gradient (8) was `gradient`; none if one sweep is enough.
    pub(crate) fn inner_bound(self, gradient: f64) -> Option<f64> {
        match self {
            Self::ArrowHurwicz => None,
            Self::Uzawa { inner, loose, .. } => {
                Some(if loose { (0.1 * gradient).max(inner) } else { inner })
            }
        }
    }
}

/// What the iteration needs besides grid, load vector and method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Duality parameter r > 0, the step of the multiplier.
    pub r: f64,
    /// Bound of the stopping rule, tried after each step of the multiplier; the paper takes 10^-N on grid N.
    pub tolerance: f64,
    /// Which stopping rule; always with the gradient (8), without the proximal term.
    pub rule: StopRule,
    /// Sweeps after which to give up; an iteration of the paper is one sweep.
    pub max_iterations: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self { r: 1.0, tolerance: 1e-5, rule: StopRule::Signed, max_iterations: 1_000_000 }
    }
}

/// What the monitor sees after each iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Iterations done on this grid.
    pub number: usize,
    /// `max_i dM/dy_i` at (y^(n), a^(n)).
    pub gradient_signed: f64,
    /// `max_i |dM/dy_i|` there.
    pub gradient_abs: f64,
    /// `max_i |a_i^(n) - a_i^(n-1)|`.
    pub delta_a: f64,
}

/// Called after each step of the multiplier.
pub type OnIteration<'a> = &'a mut dyn FnMut(&Iteration);

/// Iterates on `pair` in place until the rule is met or the cap is hit; returns how it ended and the number of sweeps.
///
/// Without a monitor the residuals are only compared with the tolerance, row by row until one
/// exceeds it; with one they are computed in full. The iterates are the same. An inner bound below the
/// rounding errors of the gradient is never met and ends at the cap.
///
/// # Panics
/// If a slice has the wrong length for `grid`, or `params.r` is not positive.
pub fn solve(
    grid: Grid,
    load: &[f64],
    method: Method,
    params: &Params,
    pair: &mut Pair,
    mut monitor: Option<OnIteration>,
) -> (Outcome, usize) {
    let mut steps = Steps::new(grid, load, method, params.r);
    let stop = loop {
        if let Err(stop) = steps.step(pair, params.max_iterations) {
            break stop;
        }
        let (number, delta_a) = (steps.iterations, steps.delta_a);
        if let Some(monitor) = monitor.as_mut() {
            let (gradient_signed, gradient_abs) = steps.gradient.extrema(load, pair);
            monitor(&Iteration { number, gradient_signed, gradient_abs, delta_a });
        }
        if (!params.rule.asks_dual() || delta_a <= params.tolerance)
            && steps.gradient.within(load, pair, params.tolerance, params.rule.is_printed())
        {
            break StopReason::Converged;
        }
    };
    let extrema = steps.gradient.extrema(load, pair);
    (Outcome::at(grid, load, pair, (steps.iterations, steps.delta_a), extrema, stop), steps.sweeps)
}

/// [`solve`] by the paper's method.
///
/// # Panics
/// As [`solve`].
pub fn arrow_hurwicz(grid: Grid, load: &[f64], params: &Params, pair: &mut Pair) -> Outcome {
    solve(grid, load, Method::ArrowHurwicz, params, pair, None).0
}

/// A method on one grid, one step of the multiplier at a time, without a stopping rule.
pub struct Steps<'a> {
    grid: Grid,
    load: &'a [f64],
    method: Method,
    r: f64,
    /// Nodes of the boundary, in the order of the multiplier.
    boundary: Vec<usize>,
    /// (8), without the proximal term.
    gradient: Gradient,
    /// The same with it.
    inner: Gradient,
    /// Bound on the latter.
    bound: Option<f64>,
    /// The proximal term's share of an interior node.
    shift: f64,
    /// F, plus the proximal term's `shift y^k`.
    target: Vec<f64>,
    /// Steps of the multiplier done.
    iterations: usize,
    /// Sweeps done.
    sweeps: usize,
    /// Last change of the multiplier.
    delta_a: f64,
}

impl<'a> Steps<'a> {
    /// Before the first step.
    ///
    /// # Panics
    /// If `load` has the wrong length for `grid`, or `r` is not positive.
    pub fn new(grid: Grid, load: &'a [f64], method: Method, r: f64) -> Self {
        assert!(r > 0.0, "the duality parameter r must be positive");
        assert!(load.len() == grid.nodes());
        let shift = method.weight() * grid.h() * grid.h();
        Self {
            grid,
            load,
            method,
            r,
            boundary: grid.boundary().collect(),
            gradient: Gradient::new(grid, r, 0.0),
            inner: Gradient::new(grid, r, shift),
            bound: method.inner_bound(largest(load)),
            shift,
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

    /// The minimisation over y and the step (12).
    ///
    /// # Errors
    /// The reason to end the run instead: `max_sweeps` are done, or a value is no longer finite.
    ///
    /// # Panics
    /// If `pair` has the wrong length for the grid.
    pub fn step(&mut self, pair: &mut Pair, max_sweeps: usize) -> Result<(), StopReason> {
        assert!(pair.y.len() == self.grid.nodes() && pair.a.len() == self.boundary.len());
        self.regularise(pair);
        loop {
            if self.sweeps >= max_sweeps {
                return Err(StopReason::IterationLimit);
            }
            self.sweeps += 1;
            sweep(self.grid, &self.target, self.shift, self.r, &mut pair.y, &pair.a);
            let Some(bound) = self.bound else { break };
            // What is not a number spreads to the boundary within as many sweeps as there are rows.
            if !self.boundary.iter().all(|&node| pair.y[node].is_finite()) {
                return Err(StopReason::Diverged);
            }
            if self.inner.within(&self.target, pair, bound, true) {
                break;
            }
        }
        self.iterations += 1;
        self.delta_a =
            dual_step(&self.boundary, self.r, &pair.y, &mut pair.a).ok_or(StopReason::Diverged)?;
        if matches!(self.method, Method::Uzawa { loose: true, .. }) {
            self.bound = self.method.inner_bound(self.gradient.extrema(self.load, pair).1);
        }
        Ok(())
    }

    /// Sets the proximal term to pull towards y as it is now.
    fn regularise(&mut self, pair: &Pair) {
        if self.shift > 0.0 {
            let (n, side) = (self.grid.cells(), self.grid.side());
            let half = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
            for (k, target) in self.target.iter_mut().enumerate() {
                let (i, j) = (k % side, k / side);
                *target = self.load[k] + half(i) * half(j) * self.shift * pair.y[k];
            }
        }
    }
}

#[cfg(test)]
mod tests;
