//! When multigrid stops, on the square and on the cube alike.

use super::{Goal, MultigridParams, Outcome, StopReason};

/// The discretisation error is reached if the residual that the coarser grid sees is this part of the load there,
/// in the root mean square: the algebraic error is then below a tenth of it in the energy norm, in all of 20 000
/// random problems. Where contact ends, single nodes have large residuals, and next to no energy.
const DISCRETISATION: f64 = 0.01;
/// A cycle that reduces the natural residual by less is suspected to work on rounding errors.
const STAGNATION: f64 = 0.5;
/// Natural residual of nodes that were minimised one by one, in roundings, generously.
pub(crate) const FLOOR: f64 = 32.0;
/// A residual this near to that of two cycles ago, relatively, tells of two contact sets that take turns.
const CIRCLE: f64 = 1e-3;
/// Growth of the natural residual, over its first value or the load, that ends the iteration.
const DIVERGENCE: f64 = 1e12;

/// A hierarchy of grids, as far as the stopping tests know it. Residuals are natural ones, those of the
/// scaled load.
pub(super) trait Hierarchy {
    /// One cycle on the finest grid, with this part of the correction; returns the residual of the red nodes.
    /// The black ones are minimised last. A `last` cycle does not smooth for a next.
    fn cycle(&mut self, last: bool, part: f64) -> f64;
    /// Root mean square of the residual that the coarser grid sees, over that of the load there.
    fn smooth_residual(&mut self) -> f64;
    /// Residual of all nodes.
    fn check(&mut self) -> f64;
    /// What one rounding of the largest value leaves in a residual.
    fn rounding(&mut self) -> f64;
    /// `max |F|` of the scaled load.
    fn load_scale(&self) -> f64;
    /// What the load was divided by.
    fn scale(&self) -> f64;
    fn work_units(&self) -> f64;
}

/// Cycles until the goal is reached; `first` is the residual before the first one.
pub(super) fn iterate(grids: &mut impl Hierarchy, first: f64, params: &MultigridParams) -> Outcome {
    let diverging = DIVERGENCE * first.max(grids.load_scale());
    let (mut kkt, mut cycles) = (first, 0);
    let [mut previous, mut before] = [f64::INFINITY; 2];
    let stop = loop {
        if cycles == params.max_cycles {
            break StopReason::CycleLimit;
        }
        let last = params.goal == Goal::DiscretisationError;
        // Each of two contact sets may lead to the other; half a correction leaves that circle.
        let circling = (kkt - before).abs() <= CIRCLE * kkt;
        (before, previous) = (previous, kkt);
        kkt = grids.cycle(last, if circling { 0.5 } else { 1.0 });
        cycles += 1;
        let raw = kkt * grids.scale();
        if !kkt.is_finite() || kkt > diverging {
            break StopReason::Diverged;
        }
        match params.goal {
            Goal::DiscretisationError if grids.smooth_residual() <= DISCRETISATION => {
                break StopReason::Converged;
            }
            // What the cycle measured leaves out the black nodes; minimised last, they have residuals of
            // rounding errors only. Where these might matter, all nodes are checked before claiming.
            Goal::Kkt(tolerance) if raw <= tolerance => {
                if (kkt + FLOOR * grids.rounding()) * grids.scale() > tolerance {
                    kkt = grids.check();
                }
                if kkt * grids.scale() <= tolerance {
                    break StopReason::Converged;
                }
            }
            _ => {}
        }
        if kkt >= STAGNATION * previous {
            let floor = FLOOR * grids.rounding();
            if kkt <= floor {
                kkt = grids.check();
                if kkt <= floor {
                    break StopReason::RoundingFloor;
                }
            }
        }
    };
    let kkt = kkt * grids.scale();
    Outcome { stop, cycles, kkt, work_units: grids.work_units() }
}

/// The outcome where the finest grid is the coarsest, and has been solved directly.
pub(super) fn direct(grids: &mut impl Hierarchy, goal: Goal) -> Outcome {
    let kkt = grids.check() * grids.scale();
    let stop = match goal {
        Goal::Kkt(tolerance) if kkt > tolerance => StopReason::RoundingFloor,
        Goal::RoundingFloor => StopReason::RoundingFloor,
        Goal::Kkt(_) | Goal::DiscretisationError => StopReason::Converged,
    };
    Outcome { stop, cycles: 0, kkt, work_units: grids.work_units() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hierarchy whose cycles and checks leave what is said here, the last first.
    struct Told {
        cycles: Vec<f64>,
        checks: Vec<f64>,
        rounding: f64,
        scale: f64,
        /// Parts of corrections that were asked for.
        parts: Vec<f64>,
    }

    impl Told {
        fn new(cycles: Vec<f64>, checks: Vec<f64>, rounding: f64) -> Self {
            Self { cycles, checks, rounding, scale: 1.0, parts: Vec::new() }
        }
    }

    impl Hierarchy for Told {
        fn cycle(&mut self, _last: bool, part: f64) -> f64 {
            self.parts.push(part);
            self.cycles.pop().expect("no more cycles are asked for")
        }
        fn smooth_residual(&mut self) -> f64 {
            self.checks.pop().expect("no more checks are asked for")
        }
        fn check(&mut self) -> f64 {
            self.checks.pop().expect("no more checks are asked for")
        }
        fn rounding(&mut self) -> f64 {
            self.rounding
        }
        fn load_scale(&self) -> f64 {
            1.0
        }
        fn scale(&self) -> f64 {
            self.scale
        }
        fn work_units(&self) -> f64 {
            0.0
        }
    }

    fn ended(mut told: Told, goal: Goal) -> (StopReason, usize, f64) {
        let params = MultigridParams { goal, max_cycles: 9 };
        let outcome = iterate(&mut told, 1.0, &params);
        assert!(told.cycles.is_empty() && told.checks.is_empty());
        (outcome.stop, outcome.cycles, outcome.kkt)
    }

    #[test]
    fn a_tolerance_is_claimed_unchecked_only_well_above_rounding() {
        for scale in [1.0, 2f64.powi(300), 2f64.powi(-300)] {
            let told =
                |cycles, checks, rounding| Told { scale, ..Told::new(cycles, checks, rounding) };
            let goal = Goal::Kkt(1e-9 * scale);
            let end = ended(told(vec![1e-10, 1e-3], vec![], 1e-12), goal);
            assert_eq!(end, (StopReason::Converged, 2, 1e-10 * scale));
            // The black nodes may have more: the first check says so.
            let end = ended(told(vec![1e-10, 9e-10], vec![2e-10, 2e-9], 1e-10), goal);
            assert_eq!(end, (StopReason::Converged, 2, 2e-10 * scale));
        }
    }

    #[test]
    fn what_does_not_fall_any_more_is_at_the_floor_or_goes_on() {
        let told = |cycles, checks| Told::new(cycles, checks, 1e-12);
        let end = ended(told(vec![6e-12, 9e-12, 1e-3], vec![7e-12]), Goal::RoundingFloor);
        assert_eq!(end, (StopReason::RoundingFloor, 3, 7e-12));
        // Stagnation far above the floor is none of it.
        let end = ended(told(vec![2e-4; 9], vec![]), Goal::RoundingFloor);
        assert_eq!(end, (StopReason::CycleLimit, 9, 2e-4));
        let end = ended(told(vec![2e12], vec![]), Goal::RoundingFloor);
        assert_eq!(end, (StopReason::Diverged, 1, 2e12));
        let (stop, ..) = ended(told(vec![f64::NAN], vec![]), Goal::RoundingFloor);
        assert_eq!(stop, StopReason::Diverged);
    }

    #[test]
    fn the_discretisation_error_takes_as_many_cycles_as_the_smooth_residual_asks_for() {
        let told = |cycles, smooth| Told::new(cycles, smooth, 1e-12);
        let end = ended(told(vec![0.04], vec![0.009]), Goal::DiscretisationError);
        assert_eq!(end, (StopReason::Converged, 1, 0.04));
        let smooth = vec![0.009, 0.011, 0.05];
        let end = ended(told(vec![0.04, 0.06, 0.07], smooth), Goal::DiscretisationError);
        assert_eq!(end, (StopReason::Converged, 3, 0.04));
    }

    #[test]
    fn half_a_correction_is_asked_for_where_residuals_repeat_after_two_cycles() {
        let parts = |mut cycles: Vec<f64>| {
            cycles.reverse();
            let max_cycles = cycles.len();
            let mut told = Told::new(cycles, vec![], 1e-12);
            let params = MultigridParams { goal: Goal::RoundingFloor, max_cycles };
            iterate(&mut told, 1.0, &params);
            told.parts
        };
        assert_eq!(parts(vec![0.3, 0.8, 0.3001, 0.01, 0.005]), [1.0, 1.0, 1.0, 0.5, 1.0]);
        // Not if they are only of the same size.
        assert_eq!(parts(vec![0.3, 0.8, 0.302, 0.81]), [1.0; 4]);
    }
}
