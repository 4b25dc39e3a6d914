//! Stopping test of multigrid.
//!
//! # Algorithm
//! After each cycle on the finest grid:
//! 1. Stop with `Diverged` if the residual is not finite or has grown by [`DIVERGENCE`].
//! 2. Stop with `Converged` if the goal is met. A cycle measures the residual at the red nodes only; it leaves rounding
//!    errors at the black ones. Where these may matter, all nodes are checked first.
//! 3. If the residual has hardly fallen, compare it with [`ROUNDING_FLOOR`] roundings; if it is below, check all nodes
//!    and stop with `RoundingFloor`.
//! 4. If the residual is that of two cycles before, two contact sets alternate: the next cycle applies half a
//!    correction. Where the law limits the flux, and two cycles have hardly lowered the residual, all later ones apply
//!    the part of the correction with the least energy.
//!
//! # Easily broken
//! A check of all nodes costs a sweep of the finest grid, so it is made only where the result may depend on it.

use super::{Goal, MultigridParams};
use crate::discrete::stop::Stop;

/// Ratio of the residual to the load, both on the finest grid but one in the root mean square, below which the
/// discretisation error is reached.
///
/// The algebraic error is then below a tenth of the discretisation error in the energy norm, in all of 20 000 random
/// problems. The largest residual would not do: single nodes at the ends of contact have large residuals and next to
/// no energy.
const DISCRETISATION: f64 = 0.01;
/// Reduction of the natural residual by a cycle from which on rounding errors are suspected.
const STAGNATION: f64 = 0.5;
/// Reduction of the natural residual by each of two cycles from which on, where values have both signs, the part of the
/// correction is chosen by its energy.
const STALLING: f64 = 0.3;
/// Generous bound of the natural residual after exact minimisation at each node, in roundings of the largest value.
pub(crate) const ROUNDING_FLOOR: f64 = 32.0;
/// Relative difference between the residuals of this cycle and of two cycles before, below which two contact sets are
/// taken to alternate.
const ALTERNATION: f64 = 1e-3;
/// Growth of the natural residual, over its first value or the load, that ends the iteration.
const DIVERGENCE: f64 = 1e12;

/// Operations of a hierarchy of grids that the stopping test calls. Residuals are natural ones of the scaled load.
pub(super) trait CycledHierarchy {
    /// Applies one cycle on the finest grid with a part of the correction, and returns the residual of the red nodes.
    fn cycle(&mut self, position: CyclePosition, part: CyclePart) -> f64;
    /// True if the law limits the flux, so that values have both signs.
    fn has_limit(&self) -> bool;
    /// Root mean square of the residual on the finest grid but one, over that of the load there.
    fn smooth_residual(&mut self) -> f64;
    /// Residual of all nodes.
    fn full_residual(&mut self) -> f64;
    /// Residual that one rounding of the largest value makes.
    fn rounding(&mut self) -> f64;
}

/// Position of a cycle in the iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CyclePosition {
    /// The cycle is expected to be the last: it does not smooth for a next one.
    Last,
    /// Other cycles follow.
    Inner,
}

/// Part of the correction that a cycle adds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CyclePart {
    /// This multiple of it.
    Fixed(f64),
    /// The part with the least energy.
    LeastEnergy,
}

/// Quantities of the scaled problem before the first cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct InitialState {
    /// Natural residual of the scaled load.
    pub(super) residual: f64,
    /// `max |F|` of the scaled load.
    pub(super) load: f64,
    /// Power of two by which the load was divided.
    pub(super) scale: f64,
}

/// Applies cycles until the goal is reached; returns the reason for the end, and the number of cycles.
pub(super) fn iterate(
    grids: &mut impl CycledHierarchy,
    initial: InitialState,
    params: &MultigridParams,
) -> (Stop, usize) {
    let InitialState { residual: first, load, scale } = initial;
    let position = match params.goal {
        Goal::DiscretisationError => CyclePosition::Last,
        Goal::Kkt(_) | Goal::RoundingFloor => CyclePosition::Inner,
    };
    let diverging = DIVERGENCE * first.max(load);
    let (mut kkt, mut cycles) = (first, 0);
    let [mut previous, mut before] = [f64::INFINITY; 2];
    let mut has_stalled = false;
    let stop = loop {
        if cycles == params.max_cycles {
            break Stop::IterationLimit;
        }
        // Each of two contact sets may lead to the other; half a correction ends the alternation.
        let alternates = (kkt - before).abs() <= ALTERNATION * kkt;
        has_stalled |= kkt > STALLING * previous && previous > STALLING * before;
        let part = if has_stalled && grids.has_limit() {
            CyclePart::LeastEnergy
        } else if alternates {
            CyclePart::Fixed(0.5)
        } else {
            CyclePart::Fixed(1.0)
        };
        (before, previous) = (previous, kkt);
        kkt = grids.cycle(position, part);
        cycles += 1;
        if !kkt.is_finite() || kkt > diverging {
            break Stop::Diverged;
        }
        match params.goal {
            Goal::DiscretisationError if grids.smooth_residual() <= DISCRETISATION => {
                break Stop::Converged;
            }
            Goal::Kkt(tolerance) if kkt * scale <= tolerance => {
                if (kkt + ROUNDING_FLOOR * grids.rounding()) * scale > tolerance {
                    kkt = grids.full_residual();
                }
                if kkt * scale <= tolerance {
                    break Stop::Converged;
                }
            }
            _ => {}
        }
        if kkt >= STAGNATION * previous {
            let floor = ROUNDING_FLOOR * grids.rounding();
            if kkt <= floor {
                kkt = grids.full_residual();
                if kkt <= floor {
                    break Stop::RoundingFloor;
                }
            }
        }
    };
    (stop, cycles)
}

/// Reason for the end where the finest grid is the coarsest, and has been solved directly with this residual.
pub(super) fn direct(kkt: f64, goal: Goal) -> Stop {
    match goal {
        Goal::Kkt(tolerance) if kkt > tolerance => Stop::RoundingFloor,
        Goal::RoundingFloor => Stop::RoundingFloor,
        Goal::Kkt(_) | Goal::DiscretisationError => Stop::Converged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INITIAL: InitialState = InitialState { residual: 1.0, load: 1.0, scale: 1.0 };

    /// A hierarchy that returns given residuals.
    struct ScriptedHierarchy {
        /// Residuals after the cycles; the last entry comes first.
        cycles: Vec<f64>,
        /// Results of the checks; the last entry comes first.
        checks: Vec<f64>,
        rounding: f64,
        /// Multiples of the correction that were requested.
        parts: Vec<CyclePart>,
        /// Residual that was returned last.
        last: f64,
    }

    impl ScriptedHierarchy {
        fn new(cycles: Vec<f64>, checks: Vec<f64>, rounding: f64) -> Self {
            Self { cycles, checks, rounding, parts: Vec::new(), last: f64::NAN }
        }

        /// Iterates to the goal, and fails if a scripted residual is left over.
        fn iterate(mut self, scale: f64, goal: Goal) -> (Stop, usize, f64) {
            let params = MultigridParams { goal, max_cycles: 9 };
            let (stop, cycles) = iterate(&mut self, InitialState { scale, ..INITIAL }, &params);
            assert!(self.cycles.is_empty() && self.checks.is_empty());
            (stop, cycles, self.last * scale)
        }
    }

    impl CycledHierarchy for ScriptedHierarchy {
        fn cycle(&mut self, _position: CyclePosition, part: CyclePart) -> f64 {
            self.parts.push(part);
            self.last = self.cycles.pop().expect("a scripted cycle");
            self.last
        }
        fn has_limit(&self) -> bool {
            false
        }
        fn smooth_residual(&mut self) -> f64 {
            self.checks.pop().expect("a scripted check")
        }
        fn full_residual(&mut self) -> f64 {
            self.last = self.checks.pop().expect("a scripted check");
            self.last
        }
        fn rounding(&mut self) -> f64 {
            self.rounding
        }
    }

    #[test]
    fn tolerance_near_rounding_is_checked_at_all_nodes() {
        for scale in [1.0, 2f64.powi(300), 2f64.powi(-300)] {
            let goal = Goal::Kkt(1e-9 * scale);
            let script = ScriptedHierarchy::new(vec![1e-10, 1e-3], vec![], 1e-12);
            let end = script.iterate(scale, goal);
            assert_eq!(end, (Stop::Converged, 2, 1e-10 * scale));
            // The black nodes may have larger residuals, as in the first check.
            let script = ScriptedHierarchy::new(vec![1e-10, 9e-10], vec![2e-10, 2e-9], 1e-10);
            let end = script.iterate(scale, goal);
            assert_eq!(end, (Stop::Converged, 2, 2e-10 * scale));
        }
    }

    fn to_the_floor(cycles: Vec<f64>, checks: Vec<f64>) -> (Stop, usize, f64) {
        ScriptedHierarchy::new(cycles, checks, 1e-12).iterate(1.0, Goal::RoundingFloor)
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

    fn to_the_discretisation_error(cycles: Vec<f64>, smooth: Vec<f64>) -> (Stop, usize, f64) {
        ScriptedHierarchy::new(cycles, smooth, 1e-12).iterate(1.0, Goal::DiscretisationError)
    }

    #[test]
    fn discretisation_error_is_judged_by_the_smooth_residual() {
        let end = to_the_discretisation_error(vec![0.04], vec![0.009]);
        assert_eq!(end, (Stop::Converged, 1, 0.04));
        let end = to_the_discretisation_error(vec![0.04, 0.06, 0.07], vec![0.009, 0.011, 0.05]);
        assert_eq!(end, (Stop::Converged, 3, 0.04));
    }

    /// Multiples of the correction that are requested if the cycles leave these residuals, the first entry first.
    fn requested_parts(mut cycles: Vec<f64>) -> Vec<CyclePart> {
        cycles.reverse();
        let params = MultigridParams { max_cycles: cycles.len(), ..MultigridParams::default() };
        let mut script = ScriptedHierarchy::new(cycles, vec![], 1e-12);
        iterate(&mut script, INITIAL, &params);
        script.parts
    }

    #[test]
    fn alternating_residuals_halve_the_correction() {
        assert_eq!(
            requested_parts(vec![0.3, 0.8, 0.3001, 0.01, 0.005]),
            [1.0, 1.0, 1.0, 0.5, 1.0].map(CyclePart::Fixed)
        );
        // Residuals of about the same size do not alternate.
        assert_eq!(requested_parts(vec![0.3, 0.8, 0.302, 0.81]), [CyclePart::Fixed(1.0); 4]);
    }
}
