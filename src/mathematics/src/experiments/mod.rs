//! Numerical experiments that go past the paper, as pure functions from a plan to plain data.
//!
//! Errors, sweeps, work units and changed counts depend on no machine: they are hashed, cached and pinned like all
//! other results. Run times are measured elsewhere, by `signorini bench`, of the runs that [`timed`] prepares.
//!
//! Each experiment is one function of its plan, the central function of its module, and an entry of [`EXPERIMENTS`],
//! by which whoever runs them all needs to know none.

mod known;
pub mod problems;
mod radius;
mod rows;
mod saddle;
pub mod timed;
mod work;

pub use rows::{Findings, Row, Rows};

use problems::TableProblem;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Experiment: a plan, and findings that depend on it alone.
pub struct Experiment {
    /// Name.
    pub name: &'static str,
    /// Plan of the book for the paper's problems.
    pub plan: fn(&[TableProblem]) -> Value,
    /// Findings for a plan.
    ///
    /// # Errors
    /// A sentence if the value is no plan of this experiment, or it cannot be carried out.
    pub run: fn(&Value) -> Result<Findings, String>,
}

/// All experiments of the book.
pub const EXPERIMENTS: [Experiment; 1] = [Experiment {
    name: "radius",
    plan: |problems| json(radius::RadiusPlan::new(named(problems))),
    run: |plan| found(plan, radius::radius),
}];

/// The paper's problems by name, with f in the notation of scenes.
fn named(problems: &[TableProblem]) -> Vec<(String, String)> {
    problems.iter().map(|problem| (problem.name(), problem.statement.f.clone())).collect()
}

fn json(data: impl Serialize) -> Value {
    serde_json::to_value(data).expect("plans and findings are plain data")
}

/// Runs an experiment on a plan in JSON.
fn found<P: DeserializeOwned>(
    plan: &Value,
    run: fn(&P) -> Result<Findings, String>,
) -> Result<Findings, String> {
    run(&P::deserialize(plan).map_err(|e| e.to_string())?)
}

/// Exponent p of the power law `y = c x^p` that fits best: least squares in logarithms.
///
/// `None` if there are fewer than two different x, or if a number is not positive.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<_> = points.iter().map(|&(x, y)| (libm::log(x), libm::log(y))).collect();
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / logs.len() as f64;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / logs.len() as f64;
    let covariance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let variance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.0 - mean_x)).sum();
    Some(covariance / variance).filter(|exponent| exponent.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_power_laws() {
        let law: Vec<_> = (1..6).map(|k| (f64::from(k), 7.0 * f64::from(k).powi(3))).collect();
        assert!((exponent(&law).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(exponent(&law[..1]), None);
    }
}
