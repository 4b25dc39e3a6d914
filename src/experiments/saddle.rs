//! Saddle-point methods run until a goal is reached that the methods themselves do not see.

use crate::discrete::grid::Grid;
use crate::saddle::{
    Pair, Params, ProximalParams, StopReason, StopRule, UzawaOutcome, UzawaParams, arrow_hurwicz,
    uzawa, uzawa_proximal,
};
use serde::{Deserialize, Serialize};

/// A saddle-point method. Uzawa's inner minimisations reduce the gradient tenfold: carried further
/// they cost more and gain nothing (see [`claims`](super::claims)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// One sweep before each step of the multiplier.
    ArrowHurwicz,
    /// A minimisation before each step of the multiplier.
    Uzawa,
    /// The same with the proximal term of weight 1.
    UzawaProximal,
}

/// How often to look, and when to give up.
#[derive(Clone, Copy, Debug)]
pub struct Looks {
    /// Sweeps between looks are the sweeps made so far over this number, and at least one.
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
    looks: Looks,
    pair: &mut Pair,
    mut done: impl FnMut(usize, &Pair) -> bool,
) -> Option<usize> {
    let scale = load.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
    let (mut sweeps, mut gradient) = (0, scale);
    loop {
        if done(sweeps, pair) {
            return Some(sweeps);
        }
        let rest = looks.cap.checked_sub(sweeps).filter(|rest| *rest > 0)?;
        let outcome = if method == Method::ArrowHurwicz {
            let some = (sweeps / looks.share).clamp(1, rest);
            let params =
                Params { r, tolerance: 0.0, rule: StopRule::Printed, max_iterations: some };
            let end = arrow_hurwicz(grid, load, &params, pair, None);
            UzawaOutcome { end, sweeps: end.iterations }
        } else {
            let params = UzawaParams {
                r,
                tolerance: 0.1 * gradient,
                rule: StopRule::Printed,
                inner: 1.0,
                max_iterations: 1,
                max_sweeps: rest,
            };
            match method {
                Method::Uzawa => uzawa(grid, load, &params, pair, None),
                _ => {
                    let params = ProximalParams { uzawa: params, ..ProximalParams::default() };
                    uzawa_proximal(grid, load, &params, pair, None)
                }
            }
        };
        if outcome.end.stop == StopReason::Diverged {
            return None;
        }
        sweeps += outcome.sweeps;
        gradient = outcome.end.gradient_abs;
    }
}
