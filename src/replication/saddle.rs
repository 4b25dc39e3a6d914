//! Settings of a saddle-point method in a scene.

use crate::pipeline::error::{Error, Failure, Result};
use serde::{Deserialize, Serialize};
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::saddle::{Params, StopRule};

/// Settings of a saddle-point method.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SaddleSettings {
    /// Interpolation to the next grid of the square.
    pub prolongation: Prolongation,
    /// Duality parameters.
    pub r: Vec<f64>,
    /// Stopping rules; the first is the one compared with the paper.
    pub stop: Vec<StopRule>,
    /// Limit on iterations per level.
    pub max_iterations: usize,
    /// The r whose solution is drawn: the middle one, unless the scene names another.
    pub draw_r: f64,
}

/// Stopping rule and r of one run of a saddle-point method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RuleAndR {
    pub rule: StopRule,
    pub r: f64,
}

/// Keys of a scene about a saddle-point method.
pub(super) struct SaddleKeys {
    pub prolongation: Option<Prolongation>,
    pub r: Option<Vec<f64>>,
    pub stop: Option<Vec<StopRule>>,
    pub max_iterations: Option<usize>,
    pub draw_r: Option<f64>,
}

impl SaddleKeys {
    /// Returns the settings, where a key is missing the paper's for a published table and else those of `solve`.
    pub(super) fn settings(self, of_the_paper: bool) -> SaddleSettings {
        let (r, rule) = match of_the_paper {
            true => (vec![1e6, 10.0, 5.0, 1.0, 0.5], StopRule::Signed),
            false => (vec![SaddleSettings::R], SaddleSettings::RULE),
        };
        let r = self.r.unwrap_or(r);
        SaddleSettings {
            prolongation: self.prolongation.unwrap_or_default(),
            stop: self.stop.unwrap_or_else(|| vec![rule]),
            max_iterations: self.max_iterations.unwrap_or(Params::default().max_iterations),
            // No r at all is refused later.
            draw_r: self.draw_r.or(r.get(r.len() / 2).copied()).unwrap_or(f64::NAN),
            r,
        }
    }
}

impl SaddleSettings {
    /// The r of `solve`, unless an option or a scene names another.
    pub(crate) const R: f64 = 10.0;
    /// The stopping rule of `solve`, unless an option or a scene names another.
    pub(crate) const RULE: StopRule = StopRule::Printed;

    /// Returns the settings as far as they say which runs there are; what else those read is as usual.
    pub(super) fn runs(&self) -> Self {
        let Params { max_iterations, .. } = Params::default();
        Self { prolongation: Prolongation::default(), max_iterations, ..self.clone() }
    }

    /// Makes the checks that a parser cannot.
    pub(super) fn check(&self) -> std::result::Result<(), Failure> {
        if self.r.is_empty() || self.stop.is_empty() {
            let example = "r = [10], stop = [\"signed\"]";
            return Err(format!("`r` and `stop` must not be empty; e.g. {example}").into());
        }
        for &r in &self.r {
            positive_r(r)?;
        }
        if let Some(r) = repeated(&self.r) {
            return Err(format!("`r` lists {r} twice; remove one").into());
        }
        if let Some(rule) = repeated(&self.stop) {
            return Err(format!("`stop` lists {rule} twice; remove one").into());
        }
        if self.max_iterations == 0 {
            return Err("`max_iterations` must be at least 1".into());
        }
        let drawn = self.draw_r;
        if !self.r.contains(&drawn) {
            return Err(format!("`draw_r` = {drawn} is not among `r`; add it there").into());
        }
        Ok(())
    }
}

/// Returns the first item that equals an earlier one.
pub(super) fn repeated<T: PartialEq>(items: &[T]) -> Option<&T> {
    items.iter().enumerate().find(|(k, item)| items[..*k].contains(item)).map(|(_, item)| item)
}

/// Checks that r is a positive number that the name of a task can show without an exponent.
pub(crate) fn positive_r(r: f64) -> Result<f64> {
    if (1e-12..=1e12).contains(&r) {
        return Ok(r);
    }
    Err(Error::input(format!(
        "r = {r:?} must be a positive number from 1e-12 to 1e12; the paper takes 0.5 to 1e6"
    )))
}
