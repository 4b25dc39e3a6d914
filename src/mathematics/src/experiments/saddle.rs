//! Saddle-point methods run until a goal is reached that the methods themselves do not see.

use crate::discrete::grid::Grid;
use crate::saddle::{Method, Pair, Steps};

/// Uzawa's algorithm, each inner minimisation to a tenth of the gradient, with a proximal term of this weight.
pub const fn loose_uzawa(weight: f64) -> Method {
    Method::Uzawa { weight, inner: 0.0, loose: true }
}

/// Number of sweeps between two checks of the goal, and limit of sweeps.
#[derive(Clone, Copy, Debug)]
pub struct CheckInterval {
    /// Sweeps of Arrow-Hurwicz between checks are the sweeps made so far over this number, and at least
    /// one; Uzawa's algorithm is checked after each step of the multiplier.
    pub share: usize,
    /// Sweeps after which the method has failed.
    pub cap: usize,
}

/// Runs `method` on `pair` until `done`, which is given the sweeps so far; returns the sweeps made.
///
/// `None` if the method diverged, or the cap was not enough. `done` is asked before the first sweep too.
///
/// # Panics
/// If `load` or `pair` does not belong to `grid`, or r is not positive.
pub fn sweeps_until(
    method: Method,
    (grid, load): (Grid, &[f64]),
    r: f64,
    checks: CheckInterval,
    pair: &mut Pair,
    mut done: impl FnMut(usize, &Pair) -> bool,
) -> Option<usize> {
    let mut steps = Steps::new(grid, load, method, r);
    while !done(steps.sweeps(), pair) {
        let many = match method {
            Method::ArrowHurwicz => (steps.sweeps() / checks.share).max(1),
            Method::Uzawa { .. } => 1,
        };
        for _ in 0..many {
            if steps.step(pair, checks.cap).is_break() {
                return None;
            }
        }
    }
    Some(steps.sweeps())
}
