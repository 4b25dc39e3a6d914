//! The run of multigrid, one for the grids of the square and for nested networks.
//!
//! # Algorithm
//! 1. Solve without the limits of the laws; if the flux then exceeds one somewhere, solve again with them. A start that
//!    has the limits is solved with them at once.
//! 2. Each time, solve on the coarsest level, and start each finer level from the one before.
//! 3. Apply steps on the finest level. After each step:
//!    1. Stop with `Diverged` if the residual is not finite or has grown by [`DIVERGENCE`].
//!    2. Stop with `Converged` if the goal is met. A step leaves rounding errors in the residual that it returns. Where
//!       these may matter, the residual is computed from the nodal vector first.
//!    3. If the residual has hardly fallen, or is computed by a recurrence, compare it with [`ROUNDING_FLOOR`]
//!       roundings; if it is below, compute it from the nodal vector, and stop with `RoundingFloor` if it still is.
//!
//! # Easily broken
//! A residual from the nodal vector costs a sweep of the finest level, so it is computed only where the result may
//! depend on it.

use super::{Goal, InputError, MultigridParams};
use crate::discrete::end::{End, Stop};

/// Reduction of the natural residual by a step, or of its computed values, from which on rounding errors are suspected.
const STAGNATION: f64 = 0.5;
/// Generous bound of the natural residual after exact minimisation at each node, in roundings of the largest value.
pub(crate) const ROUNDING_FLOOR: f64 = 32.0;
/// Multiple of the rounding floor up to which a computed residual that no longer falls is one of rounding errors.
const NEAR_FLOOR: f64 = 1e3;
/// Growth of the natural residual, over its first value or the load, that ends the iteration.
const DIVERGENCE: f64 = 1e12;

/// Nested levels, coarsest first, with a nodal vector on one of them: a problem under laws `[0, limit]`, whose load
/// is divided by a power of two. Residuals are natural ones of this load.
pub(crate) trait Hierarchy {
    /// True if a step computes the residual by a recurrence, which goes on falling where that of the nodal vector does
    /// not.
    const BY_RECURRENCE: bool;

    /// Number of the finest level, from 0.
    fn finest(&self) -> usize;

    /// Sets the loads of all levels, with the limits of the flux or without.
    ///
    /// # Errors
    /// If the input is wrong, or the flux cannot balance the load.
    fn set_problem(&mut self, has_limits: bool) -> Result<LoadScale, InputError>;

    /// Solves on the coarsest level. Returns the reason for the end, if this is the finest level as well.
    ///
    /// # Errors
    /// If the flux cannot balance the load there.
    fn solve_coarsest(&mut self) -> Result<Stop, InputError>;

    /// Interpolates the nodal vector from the level before, and smooths; returns the residual.
    ///
    /// # Errors
    /// If a limit is no limit on this level.
    fn refine(&mut self, level: usize) -> Result<f64, InputError>;

    /// Improves the nodal vector on a coarser level enough to start the next one.
    fn settle(&mut self, level: usize);

    /// Takes the start on the finest level that is given; returns its residual, or none if there is no such start.
    ///
    /// # Errors
    /// If the start is wrong.
    fn start(&mut self) -> Result<Option<f64>, InputError> {
        Ok(None)
    }

    /// True if the start is the solution of a like problem with the limits, so that solving without them first gains
    /// nothing.
    fn starts_with_limits(&self) -> bool {
        false
    }

    /// Applies one step on the finest level, where the residual is this one; returns the next one.
    fn step(&mut self, residual: f64) -> f64;

    /// True if the last steps have lowered the residual so little that other levels are worth their cost.
    fn is_slow(&self) -> bool {
        false
    }

    /// True if the algebraic error is at most a tenth of the discretisation error.
    fn is_within_discretisation_error(&mut self) -> bool;

    /// True if the last step has lowered the energy by little beside what is left of a distance, which is this one at
    /// the zero vector and falls as the energy does.
    fn gains_little(&mut self, _distance: f64) -> bool {
        false
    }

    /// Residual on the finest level, computed from the nodal vector.
    fn computed_residual(&mut self) -> f64;

    /// Residual that one rounding of the largest value makes on the finest level.
    fn rounding(&mut self) -> f64;

    /// Residual of the nodal vector of the finest level with the limits or without.
    ///
    /// # Errors
    /// If a limit is none.
    fn residual_under(&mut self, has_limits: bool) -> Result<f64, InputError>;

    /// Work so far, in sweeps of the finest level.
    fn work_units(&self) -> f64;
}

/// Size of a load that is divided by a power of two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoadScale {
    /// The power of two.
    pub(crate) scale: f64,
    /// Largest absolute value afterwards.
    pub(crate) largest: f64,
}

/// Solves the problem of `levels`, whose laws have finite limits or none.
///
/// # Errors
/// If the input is wrong, or the flux cannot balance the load.
pub(crate) fn solve(
    levels: &mut impl Hierarchy,
    has_limits: bool,
    params: &MultigridParams,
) -> Result<End, InputError> {
    let first = has_limits && levels.starts_with_limits();
    let (mut stop, mut iterations) = solve_with(levels, first, params)?;
    if has_limits && !first && exceeds(levels)? {
        (stop, iterations) = solve_with(levels, true, params)?;
    }
    Ok(End { iterations, work_units: levels.work_units(), stop, delta_a: None })
}

/// True if the flux of the solution without limits somewhere exceeds one: otherwise it is the solution with them, too.
fn exceeds(levels: &mut impl Hierarchy) -> Result<bool, InputError> {
    let without = levels.residual_under(false)?;
    Ok(levels.residual_under(true)? > without)
}

/// Solves the problem with the limits or without; returns the reason for the end, and the number of steps on the finest
/// level.
fn solve_with(
    levels: &mut impl Hierarchy,
    has_limits: bool,
    params: &MultigridParams,
) -> Result<(Stop, usize), InputError> {
    let load = levels.set_problem(has_limits)?;
    if levels.finest() == 0 {
        return Ok((levels.solve_coarsest()?, 0));
    }
    let residual = match levels.start()? {
        Some(residual) => residual,
        None => nested_iteration(levels)?,
    };
    Ok(iterate(levels, load, residual, params))
}

/// Starts each level from the one before; returns the residual on the finest level.
fn nested_iteration(levels: &mut impl Hierarchy) -> Result<f64, InputError> {
    levels.solve_coarsest()?;
    for level in 1..levels.finest() {
        levels.refine(level)?;
        levels.settle(level);
    }
    levels.refine(levels.finest())
}

/// Applies steps on the finest level until the goal is reached; returns the reason for the end, and the number of
/// steps.
fn iterate<H: Hierarchy>(
    levels: &mut H,
    LoadScale { scale, largest }: LoadScale,
    first: f64,
    params: &MultigridParams,
) -> (Stop, usize) {
    let diverging = DIVERGENCE * first.max(largest);
    let (mut residual, mut computed, mut steps) = (first, f64::INFINITY, 0);
    let stop = loop {
        if steps == params.max_cycles || levels.is_slow() {
            break Stop::IterationLimit;
        }
        let before = residual;
        residual = levels.step(before);
        steps += 1;
        if !residual.is_finite() || residual > diverging {
            break Stop::Diverged;
        }
        match params.goal {
            Goal::DiscretisationError if levels.is_within_discretisation_error() => {
                break Stop::Converged;
            }
            Goal::Gain(distance) if levels.gains_little(distance / scale / scale) => {
                break Stop::Converged;
            }
            Goal::Kkt(tolerance)
                if steps >= params.least_cycles && residual * scale <= tolerance =>
            {
                if H::BY_RECURRENCE
                    || (residual + ROUNDING_FLOOR * levels.rounding()) * scale > tolerance
                {
                    residual = levels.computed_residual();
                }
                if residual * scale <= tolerance {
                    break Stop::Converged;
                }
            }
            _ => {}
        }
        if H::BY_RECURRENCE || residual >= STAGNATION * before {
            let floor = ROUNDING_FLOOR * levels.rounding();
            if residual <= floor {
                residual = levels.computed_residual();
                let no_longer_falls = H::BY_RECURRENCE
                    && residual >= STAGNATION * computed
                    && residual <= NEAR_FLOOR * floor;
                if residual <= floor || no_longer_falls {
                    break Stop::RoundingFloor;
                }
                computed = residual;
            }
        }
    };
    (stop, steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hierarchy that returns given residuals.
    struct Scripted {
        /// Residuals after the steps; the last entry comes first.
        steps: Vec<f64>,
        /// Results of the checks; the last entry comes first.
        checks: Vec<f64>,
        rounding: f64,
        /// Residual that was returned last.
        last: f64,
    }

    impl Scripted {
        fn new(steps: Vec<f64>, checks: Vec<f64>, rounding: f64) -> Self {
            Self { steps, checks, rounding, last: f64::NAN }
        }

        /// Iterates to the goal, and fails if a scripted residual is left over.
        fn iterate(mut self, scale: f64, goal: Goal) -> (Stop, usize, f64) {
            let params = MultigridParams { goal, max_cycles: 9, ..MultigridParams::default() };
            let load = LoadScale { scale, largest: 1.0 };
            let (stop, steps) = iterate(&mut self, load, 1.0, &params);
            assert!(self.steps.is_empty() && self.checks.is_empty());
            (stop, steps, self.last * scale)
        }

        fn check(&mut self) -> f64 {
            self.checks.pop().expect("a scripted check")
        }
    }

    impl Hierarchy for Scripted {
        const BY_RECURRENCE: bool = false;

        fn step(&mut self, _residual: f64) -> f64 {
            self.last = self.steps.pop().expect("a scripted step");
            self.last
        }
        fn is_within_discretisation_error(&mut self) -> bool {
            self.check() <= 0.01
        }
        fn computed_residual(&mut self) -> f64 {
            self.last = self.check();
            self.last
        }
        fn rounding(&mut self) -> f64 {
            self.rounding
        }
        fn finest(&self) -> usize {
            1
        }
        fn set_problem(&mut self, _has_limits: bool) -> Result<LoadScale, InputError> {
            unreachable!()
        }
        fn solve_coarsest(&mut self) -> Result<Stop, InputError> {
            unreachable!()
        }
        fn refine(&mut self, _level: usize) -> Result<f64, InputError> {
            unreachable!()
        }
        fn settle(&mut self, _level: usize) {}
        fn residual_under(&mut self, _has_limits: bool) -> Result<f64, InputError> {
            unreachable!()
        }
        fn work_units(&self) -> f64 {
            0.0
        }
    }

    #[test]
    fn tolerance_near_rounding_is_checked_at_all_nodes() {
        for scale in [1.0, 2f64.powi(300), 2f64.powi(-300)] {
            let goal = Goal::Kkt(1e-9 * scale);
            let script = Scripted::new(vec![1e-10, 1e-3], vec![], 1e-12);
            let end = script.iterate(scale, goal);
            assert_eq!(end, (Stop::Converged, 2, 1e-10 * scale));
            // The black nodes may have larger residuals, as in the first check.
            let script = Scripted::new(vec![1e-10, 9e-10], vec![2e-10, 2e-9], 1e-10);
            let end = script.iterate(scale, goal);
            assert_eq!(end, (Stop::Converged, 2, 2e-10 * scale));
        }
    }

    fn to_the_floor(steps: Vec<f64>, checks: Vec<f64>) -> (Stop, usize, f64) {
        Scripted::new(steps, checks, 1e-12).iterate(1.0, Goal::RoundingFloor)
    }

    #[test]
    fn stagnation_is_the_rounding_floor_only_near_rounding() {
        let end = to_the_floor(vec![6e-12, 9e-12, 1e-3], vec![7e-12]);
        assert_eq!(end, (Stop::RoundingFloor, 3, 7e-12));
        let end = to_the_floor(vec![2e-4; 9], vec![]);
        assert_eq!(end, (Stop::IterationLimit, 9, 2e-4));
        let end = to_the_floor(vec![2e12], vec![]);
        assert_eq!(end, (Stop::Diverged, 1, 2e12));
        let (stop, ..) = to_the_floor(vec![f64::NAN], vec![]);
        assert_eq!(stop, Stop::Diverged);
    }

    fn to_the_discretisation_error(steps: Vec<f64>, smooth: Vec<f64>) -> (Stop, usize, f64) {
        Scripted::new(steps, smooth, 1e-12).iterate(1.0, Goal::DiscretisationError)
    }

    #[test]
    fn discretisation_error_is_judged_by_the_smooth_residual() {
        let end = to_the_discretisation_error(vec![0.04], vec![0.009]);
        assert_eq!(end, (Stop::Converged, 1, 0.04));
        let end = to_the_discretisation_error(vec![0.04, 0.06, 0.07], vec![0.009, 0.011, 0.05]);
        assert_eq!(end, (Stop::Converged, 3, 0.04));
    }
}
