//! Friction where v has both signs: the arcs between them on which the boundary sticks, from the true solutions.
//!
//! A flux that jumped from -g, where v > 0, to g, where v < 0, would let v grow without bound beside the jump, with the
//! wrong sign. So an arc lies between that sticks. It is about `C exp(-k / g)` long, where k grows with the slope of v
//! there: short arcs are on no grid.

use super::{Findings, Rows};
use crate::machine::threads::map;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::{SpectralParams, spectral_under};
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StickingPlan {
    /// f on the square, as text.
    f: String,
    /// Bounds of the friction.
    g: Vec<f64>,
}

impl Default for StickingPlan {
    /// The left half pushed up and the right half down, up to the g at which the corners begin to stick too.
    fn default() -> Self {
        let g = vec![1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.45];
        Self { f: "halfplane(1,0,0)=8; else=-8".into(), g }
    }
}

/// Longest arc that sticks under one bound of the friction.
#[derive(Clone, Debug, Serialize)]
struct StickingArc {
    /// f on the square, as text.
    f: String,
    /// Bound of the friction.
    g: f64,
    /// Number of arcs that stick.
    arcs: usize,
    /// Length of the longest one.
    length: f64,
}

/// Law `length = C exp(-k / g)` that fits best: least squares in logarithms.
#[derive(Clone, Copy, Debug, Serialize)]
struct StickingLaw {
    /// Factor C.
    factor: f64,
    /// Constant k.
    rate: f64,
    /// Greatest factor, at least 1, between a length and this law.
    misfit: f64,
}

/// Measures the arcs: the central function of this module. Tables `arcs`, one row per bound of the friction, and
/// `law`.
///
/// # Errors
/// A sentence if f cannot be read, or a problem has no solution that is found.
pub(super) fn sticking(plan: &StickingPlan) -> Result<Findings, String> {
    let arcs = map(&plan.g, 1, |&g| longest_arc(&plan.f, g));
    let arcs = arcs.into_iter().collect::<Result<Vec<_>, _>>()?;
    let law = law(&arcs);
    Ok(Findings::from([("arcs".into(), Rows::of(arcs)), ("law".into(), Rows::of([law]))]))
}

/// Fits the law to the arcs.
fn law(arcs: &[StickingArc]) -> StickingLaw {
    let logs: Vec<_> = arcs.iter().map(|arc| [1.0 / arc.g, libm::log(arc.length)]).collect();
    let count = logs.len() as f64;
    let [mean_x, mean_y] = [0, 1].map(|d| logs.iter().map(|log| log[d]).sum::<f64>() / count);
    let covariance: f64 = logs.iter().map(|[x, y]| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = logs.iter().map(|[x, _]| (x - mean_x) * (x - mean_x)).sum();
    let rate = -covariance / variance;
    let factor = libm::exp(mean_y + rate * mean_x);
    let misfits = arcs.iter().map(|arc| {
        let ratio = arc.length / (factor * libm::exp(-rate / arc.g));
        ratio.max(1.0 / ratio)
    });
    StickingLaw { factor, rate, misfit: misfits.fold(1.0, f64::max) }
}

/// Measures the longest arc under one bound.
fn longest_arc(f: &str, g: f64) -> Result<StickingArc, String> {
    let source: Source = f.parse().map_err(|e| format!("f: {e}"))?;
    let in_words = |e: &dyn std::fmt::Display| format!("friction {g}: {e}");
    let law = Law::friction(g).map_err(|e| in_words(&e))?;
    let solution =
        spectral_under(law, &source, SpectralParams::default()).map_err(|e| in_words(&e))?;
    let lengths = solution.contact.iter().map(|arc| {
        let [[x0, y0], [x1, y1]] = [arc.from, arc.to];
        ((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0)).sqrt()
    });
    let length = lengths.fold(0.0, f64::max);
    Ok(StickingArc { f: f.into(), g, arcs: solution.contact.len(), length })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arcs_shrink_exponentially_as_friction_gets_weaker() {
        let found = sticking(&StickingPlan::default()).unwrap();
        let (arcs, law) = (&found["arcs"], &found["law"]);
        assert_eq!(arcs.numbers("arcs").unwrap(), [2.0; 7]);
        let lengths = arcs.numbers("length").unwrap();
        assert!(lengths.is_sorted_by(|one, next| *one > 2.0 * next && *next > 0.0));
        assert!(lengths[0] > 1e-2 && lengths[6] < 1e-4, "{lengths:?}");
        let [misfit, rate, factor] =
            ["misfit", "rate", "factor"].map(|name| law.numbers(name).unwrap()[0]);
        assert!(misfit < 1.5, "{law:?}");
        // No arc of the square is longer than the law at g = infinity would have it be.
        assert!(rate > 0.0 && factor > lengths[0], "{law:?}");
    }

    #[test]
    fn a_plan_that_cannot_be_solved_is_refused_with_its_g() {
        let plan = StickingPlan { f: "else=-1".into(), g: vec![0.1] };
        let refusal = sticking(&plan).unwrap_err();
        assert!(refusal.starts_with("friction 0.1: "), "{refusal}");
    }
}
