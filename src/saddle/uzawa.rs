//! Uzawa's algorithm for the modified functional (7), plain and with iterative proximal regularisation.
//!
//! Idea: minimise M(., a) over y until its gradient is small, then step the multiplier by (12).
//! Descent is what the paper's references use inside; here it is the Gauss-Seidel sweep
//! (9)-(11) with the multiplier held fixed, itself a descent, coordinate by coordinate. So every method
//! pays in the same coin, the sweep, and one sweep per step of the multiplier is Arrow-Hurwicz exactly.
//!
//! Requirements: r > 0; a load vector with negative sum. M(., a) then has a minimum, because a constant
//! costs at least linearly upwards and quadratically downwards. It is not strongly convex, though: where
//! no boundary node is penalised (`r y >= a` all around) its Hessian is the singular matrix A, and in the
//! end each sweep only moves y down by `h^2 / 2` times the sum of F, until some node is. If F sums to
//! zero or more M(., a) has no minimum; that drift goes up for ever and the run ends at its cap, as an
//! outcome. With the proximal term each inner problem is well posed whatever F, and y^k drifts instead.
//!
//! References: D. Bertsekas, Constrained Optimization and Lagrange Multiplier Methods, for the algorithm;
//! R. V. Namm and A. S. Tkachenko, Izv. vuzov. Matematika, 2010, no. 4, for the proximal term (the
//! paper's refs 5 and 6); G. Woo, R. V. Namm, S. A. Sachkoff, Comput. Math. Math. Phys. 46 (2006) 23-33.

use super::arrow_hurwicz::{OnIteration, Outcome};
use super::gradient::{DualStep, Gradient};
use super::stopping::{StopReason, StopRule};
use super::sweep::sweep;
use super::{Pair, Params};
use crate::discrete::grid::Grid;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// What the iteration needs besides grid and load vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UzawaParams {
    /// Duality parameter r > 0, the step of the multiplier.
    pub r: f64,
    /// Bound of the stopping rule, tried after each step of the multiplier.
    pub tolerance: f64,
    /// Which stopping rule; always with the gradient (8), without the proximal term.
    pub rule: StopRule,
    /// The inner minimisation ends with every component of its gradient at most `inner * tolerance`
    /// in absolute value. Infinity leaves one sweep: the Arrow-Hurwicz method.
    pub inner: f64,
    /// Steps of the multiplier after which to give up.
    pub max_iterations: usize,
    /// Sweeps, over all inner minimisations, after which to give up.
    pub max_sweeps: usize,
}

impl Default for UzawaParams {
    fn default() -> Self {
        let Params { r, tolerance, rule, max_iterations } = Params::default();
        Self { r, tolerance, rule, inner: 0.1, max_iterations, max_sweeps: max_iterations }
    }
}

/// What the proximal method needs besides grid and load vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProximalParams {
    /// All that it shares with the plain method.
    pub uzawa: UzawaParams,
    /// Factor c > 0 of the added term `c / 2 ||v - v^k||^2` in L2(Omega); its inverse is a step in
    /// artificial time, so that a small c means a weak term. Unit: one over length squared.
    pub weight: f64,
}

impl Default for ProximalParams {
    /// The weight of Namm and Tkachenko, 1.
    fn default() -> Self {
        Self { uzawa: UzawaParams::default(), weight: 1.0 }
    }
}

/// How a solve on one grid ended, and what it cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UzawaOutcome {
    /// The end itself; `iterations` are steps of the multiplier.
    pub end: Outcome,
    /// Gauss-Seidel sweeps, over all inner minimisations: what to compare with Arrow-Hurwicz.
    pub sweeps: usize,
}

/// Iterates on `pair` in place until the rule is met, a cap is hit, or the monitor breaks.
///
/// The monitor is called after each step of the multiplier. An inner tolerance below the rounding
/// errors of the gradient is never met and ends at `max_sweeps`.
///
/// # Panics
/// If a slice has the wrong length for `grid`, or `params.r` is not positive.
pub fn uzawa(
    grid: Grid,
    load: &[f64],
    params: &UzawaParams,
    pair: &mut Pair,
    monitor: Option<OnIteration>,
) -> UzawaOutcome {
    run(grid, load, params, 0.0, pair, monitor)
}

/// [`uzawa`] with `c / 2 ||v - v^k||^2` added to M(v, a^k), v^k being the last minimiser.
///
/// The norm of L2(Omega) is taken with lumped mass, `h^2` at interior nodes, half on edges, a quarter
/// at corners, which keeps the term on the diagonal of the sweep.
///
/// # Panics
/// As [`uzawa`], and if `params.weight` is not positive.
pub fn uzawa_proximal(
    grid: Grid,
    load: &[f64],
    params: &ProximalParams,
    pair: &mut Pair,
    monitor: Option<OnIteration>,
) -> UzawaOutcome {
    assert!(params.weight > 0.0, "the proximal weight must be positive");
    run(grid, load, &params.uzawa, params.weight * grid.h() * grid.h(), pair, monitor)
}

/// Both methods: `shift` is the proximal term's share of an interior node, none for the plain one.
fn run(
    grid: Grid,
    load: &[f64],
    params: &UzawaParams,
    shift: f64,
    pair: &mut Pair,
    mut monitor: Option<OnIteration>,
) -> UzawaOutcome {
    let stopping = (params.rule, params.tolerance);
    let mut dual = DualStep::new(grid, load, params.r, stopping, pair);
    let mut inner = Inner {
        grid,
        r: params.r,
        shift,
        load: load.to_vec(),
        gradient: Gradient::new(grid, params.r, shift),
        tolerance: params.inner * params.tolerance,
        sweeps: 0,
        max_sweeps: params.max_sweeps,
    };
    let stop = loop {
        if dual.iterations == params.max_iterations {
            break StopReason::IterationLimit;
        }
        if let ControlFlow::Break(stop) = inner.minimise(load, &dual.boundary, pair) {
            break stop;
        }
        if let ControlFlow::Break(stop) = dual.step(pair, &mut monitor) {
            break stop;
        }
    };
    let end = Outcome::at(grid, pair, dual, stop);
    UzawaOutcome { end, sweeps: inner.sweeps }
}

/// The minimisation over y of M(., a), or of M(., a) with the proximal term.
struct Inner {
    grid: Grid,
    r: f64,
    shift: f64,
    /// F, plus the proximal term's `shift y^k`.
    load: Vec<f64>,
    gradient: Gradient,
    tolerance: f64,
    sweeps: usize,
    max_sweeps: usize,
}

impl Inner {
    /// Sweeps until the gradient is within the tolerance; at least once.
    fn minimise(
        &mut self,
        load: &[f64],
        boundary: &[usize],
        pair: &mut Pair,
    ) -> ControlFlow<StopReason> {
        if self.shift > 0.0 {
            let n = self.grid.cells();
            let half = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
            for (k, target) in self.load.iter_mut().enumerate() {
                let (i, j) = (k % self.grid.side(), k / self.grid.side());
                *target = load[k] + half(i) * half(j) * self.shift * pair.y[k];
            }
        }
        loop {
            if self.sweeps >= self.max_sweeps {
                return ControlFlow::Break(StopReason::IterationLimit);
            }
            self.sweeps += 1;
            sweep(self.grid, &self.load, self.shift, self.r, &mut pair.y, &pair.a);
            // What is not a number spreads to the boundary within as many sweeps as there are rows.
            if !boundary.iter().all(|&node| pair.y[node].is_finite()) {
                return ControlFlow::Break(StopReason::Diverged);
            }
            if self.gradient.within(&self.load, pair, self.tolerance, true) {
                return ControlFlow::Continue(());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::{LoadRule, load};
    use crate::saddle::{Iteration, arrow_hurwicz};

    const PROBLEMS: [&str; 2] = ["quadrant(ll)=3; else=-1.002", "quadrant(ll)=-6; else=1.998"];

    fn setting(f: &str) -> (Grid, Vec<f64>) {
        let grid = Grid::new(16).unwrap();
        (grid, load(grid, &f.parse().unwrap(), LoadRule::LumpedAverage))
    }

    fn tight(r: f64) -> UzawaParams {
        let (tolerance, rule) = (1e-9, StopRule::Printed);
        UzawaParams { r, tolerance, rule, ..UzawaParams::default() }
    }

    /// Both methods from zero.
    fn both(
        grid: Grid,
        load: &[f64],
        params: &UzawaParams,
        weight: f64,
    ) -> [(UzawaOutcome, Pair); 2] {
        let (mut plain, mut proximal) = (Pair::zero(grid), Pair::zero(grid));
        let first = uzawa(grid, load, params, &mut plain, None);
        let params = ProximalParams { uzawa: *params, weight };
        let second = uzawa_proximal(grid, load, &params, &mut proximal, None);
        [(first, plain), (second, proximal)]
    }

    fn distance(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).fold(0.0, |worst, (a, b)| (a - b).abs().max(worst))
    }

    #[test]
    fn every_method_finds_the_solution_of_arrow_hurwicz() {
        for f in PROBLEMS {
            let (grid, load) = setting(f);
            let UzawaParams { tolerance, rule, .. } = tight(10.0);
            let mut want = Pair::zero(grid);
            let params = Params { r: 10.0, tolerance, rule, ..Params::default() };
            assert_eq!(
                arrow_hurwicz(grid, &load, &params, &mut want, None).stop,
                StopReason::Converged
            );
            for r in [1.0, 10.0, 1e3, 1e6] {
                for (outcome, pair) in both(grid, &load, &tight(r), 1.0) {
                    let at = format!("{f}, r = {r}: {outcome:?}");
                    assert_eq!(outcome.end.stop, StopReason::Converged, "{at}");
                    // Where a stays positive the gradient sees only h r of what is left of y.
                    let bound = 2e-9 * (1.0 / (grid.h() * r)).max(1.0);
                    assert!(outcome.end.kkt.natural <= bound, "{at}");
                    assert!(distance(&pair.y, &want.y) <= 1e-6, "{at}");
                    assert!(distance(&pair.a, &want.a) <= 1e-5, "{at}");
                    assert!(outcome.sweeps >= outcome.end.iterations, "{at}");
                }
            }
        }
    }

    #[test]
    fn one_sweep_inside_is_arrow_hurwicz_to_the_last_bit() {
        let (grid, load) = setting(PROBLEMS[0]);
        let loose = UzawaParams { inner: f64::INFINITY, ..tight(3.0) };
        let mut ours = Pair::zero(grid);
        let outcome = uzawa(grid, &load, &loose, &mut ours, None);
        let mut theirs = Pair::zero(grid);
        let params =
            Params { r: 3.0, tolerance: 1e-9, rule: StopRule::Printed, ..Params::default() };
        assert_eq!(outcome.end, arrow_hurwicz(grid, &load, &params, &mut theirs, None));
        assert_eq!(outcome.sweeps, outcome.end.iterations);
        assert_eq!(ours, theirs);
    }

    #[test]
    fn a_nearly_empty_contact_set_is_no_obstacle() {
        // The mean of f is less than 1e-4 of its size; the solution leaves the boundary almost everywhere.
        let (grid, load) = setting("quadrant(ll)=-6.001; else=2");
        for weight in [0.1, 1.0, 10.0] {
            let [_, (outcome, pair)] = both(grid, &load, &tight(10.0), weight);
            assert_eq!(outcome.end.stop, StopReason::Converged, "{outcome:?}");
            assert!(outcome.end.kkt.natural <= 1e-8, "{outcome:?}");
            let contact = pair.a.iter().filter(|&&a| a > 0.0).count();
            assert!((1..=8).contains(&contact), "{contact} nodes in contact");
        }
    }

    #[test]
    fn without_a_minimum_both_end_at_a_cap() {
        let (grid, load) = setting("else=0.5");
        let capped = UzawaParams { max_sweeps: 3000, max_iterations: 100, ..tight(1.0) };
        let [(plain, up), (proximal, _)] = both(grid, &load, &capped, 100.0);
        assert_eq!((plain.end.stop, plain.sweeps), (StopReason::IterationLimit, 3000));
        assert_eq!(plain.end.iterations, 0, "the inner problem has no minimum");
        let mut further = up.clone();
        uzawa(grid, &load, &capped, &mut further, None);
        let drift = 3000.0 * 0.5 * grid.h() * grid.h() * load.iter().sum::<f64>();
        for (low, high) in up.y.iter().zip(&further.y) {
            assert!((high - low - drift).abs() < 1e-9 * drift, "{} {drift}", high - low);
        }
        assert_eq!(proximal.end.stop, StopReason::IterationLimit);
        assert!(proximal.end.iterations > 0, "each proximal problem has one");
    }

    #[test]
    fn either_cap_holds() {
        let (grid, load) = setting(PROBLEMS[1]);
        for (outcome, _) in both(grid, &load, &UzawaParams { max_iterations: 2, ..tight(1.0) }, 1.0)
        {
            assert_eq!((outcome.end.stop, outcome.end.iterations), (StopReason::IterationLimit, 2));
        }
        for (outcome, _) in both(grid, &load, &UzawaParams { max_sweeps: 7, ..tight(1.0) }, 1.0) {
            assert_eq!((outcome.end.stop, outcome.sweeps), (StopReason::IterationLimit, 7));
        }
    }

    #[test]
    fn what_is_no_number_diverges() {
        let (grid, good) = setting(PROBLEMS[0]);
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            let mut load = good.clone();
            load[grid.index(8, 8)] = bad;
            for (outcome, _) in both(grid, &load, &tight(1.0), 1.0) {
                assert_eq!(outcome.end.stop, StopReason::Diverged, "{bad}");
                assert!(outcome.sweeps < 100);
            }
        }
        let huge: Vec<f64> = good.iter().map(|f| f * 1e308).collect();
        for (outcome, _) in both(grid, &huge, &tight(1.0), 1.0) {
            assert_ne!(outcome.end.stop, StopReason::Converged);
        }
    }

    #[test]
    fn the_monitor_sees_each_step_and_may_end_the_run() {
        let (grid, load) = setting(PROBLEMS[1]);
        let mut seen = 0;
        let mut third = |iteration: &Iteration| {
            seen = iteration.number;
            if seen == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let outcome = uzawa(grid, &load, &tight(1.0), &mut Pair::zero(grid), Some(&mut third));
        assert_eq!((outcome.end.stop, outcome.end.iterations), (StopReason::Interrupted, 3));
        assert_eq!(seen, 3);
    }
}
