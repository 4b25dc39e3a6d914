//! Friction where v has both signs: the arcs between them on which the boundary sticks, from the true solutions.
//!
//! A flux that jumped from -g, where v > 0, to g, where v < 0, would let v grow without bound beside the jump, with the
//! wrong sign. So an arc lies between that sticks. It is about `C exp(-k / g)` long, where k grows with the slope of v
//! there: short arcs are on no grid.

use crate::machine::threads::map;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::{SpectralParams, spectral_under};
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StickingPlan {
    /// f on the square, as text.
    pub f: String,
    /// Bounds of the friction.
    pub g: Vec<f64>,
}

impl Default for StickingPlan {
    /// The left half pushed up and the right half down, up to the g at which the corners begin to stick too.
    fn default() -> Self {
        let g = vec![1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.45];
        Self { f: "halfplane(1,0,0)=8; else=-8".into(), g }
    }
}

/// Findings of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StickingFindings {
    /// f on the square, as text.
    pub f: String,
    /// Lines, one per bound of the friction.
    pub lines: Vec<StickingLine>,
    /// Factor C of the law `length = C exp(-k / g)` that fits best: least squares in logarithms.
    pub factor: f64,
    /// Constant k of this law.
    pub rate: f64,
    /// Greatest factor, at least 1, between a length and this law.
    pub misfit: f64,
}

/// Longest arc that sticks under one bound of the friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StickingLine {
    /// Bound of the friction.
    pub g: f64,
    /// Number of arcs that stick.
    pub arcs: usize,
    /// Length of the longest one.
    pub length: f64,
}

/// Measures the arcs: the central function of this module.
///
/// # Errors
/// A sentence if f cannot be read, or a problem has no solution that is found.
pub fn sticking(plan: &StickingPlan) -> Result<StickingFindings, String> {
    let f: Source = plan.f.parse().map_err(|e| format!("f: {e}"))?;
    let lines = map(&plan.g, 1, |&g| line(&f, g)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let logs: Vec<_> = lines.iter().map(|line| [1.0 / line.g, libm::log(line.length)]).collect();
    let count = logs.len() as f64;
    let [mean_x, mean_y] = [0, 1].map(|d| logs.iter().map(|log| log[d]).sum::<f64>() / count);
    let covariance: f64 = logs.iter().map(|[x, y]| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = logs.iter().map(|[x, _]| (x - mean_x) * (x - mean_x)).sum();
    let rate = -covariance / variance;
    let factor = libm::exp(mean_y + rate * mean_x);
    let misfits = lines.iter().map(|line| {
        let ratio = line.length / (factor * libm::exp(-rate / line.g));
        ratio.max(1.0 / ratio)
    });
    let misfit = misfits.fold(1.0, f64::max);
    Ok(StickingFindings { f: plan.f.clone(), lines, factor, rate, misfit })
}

/// Measures the longest arc under one bound.
fn line(f: &Source, g: f64) -> Result<StickingLine, String> {
    let in_words = |e: &dyn std::fmt::Display| format!("friction {g}: {e}");
    let law = Law::friction(g).map_err(|e| in_words(&e))?;
    let solution = spectral_under(law, f, SpectralParams::default()).map_err(|e| in_words(&e))?;
    let lengths = solution.contact.iter().map(|arc| {
        let [[x0, y0], [x1, y1]] = [arc.from, arc.to];
        ((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0)).sqrt()
    });
    let length = lengths.fold(0.0, f64::max);
    Ok(StickingLine { g, arcs: solution.contact.len(), length })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arcs_shrink_exponentially_as_friction_gets_weaker() {
        let found = sticking(&StickingPlan::default()).unwrap();
        assert!(found.lines.iter().all(|line| line.arcs == 2 && line.length > 0.0));
        assert!(found.lines.is_sorted_by(|one, next| one.length > 2.0 * next.length));
        let (first, last) = (found.lines[0].length, found.lines[6].length);
        assert!(first > 1e-2 && last < 1e-4, "{first} {last}");
        assert!(found.misfit < 1.5, "{found:?}");
        // No arc of the square is longer than the law at g = infinity would have it be.
        assert!(found.rate > 0.0 && found.factor > first, "{found:?}");
    }

    #[test]
    fn a_plan_that_cannot_be_solved_is_refused_with_its_g() {
        let plan = StickingPlan { f: "else=-1".into(), g: vec![0.1] };
        let refusal = sticking(&plan).unwrap_err();
        assert!(refusal.starts_with("friction 0.1: "), "{refusal}");
    }
}
