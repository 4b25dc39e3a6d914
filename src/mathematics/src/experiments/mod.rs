//! Numerical experiments that go past the paper, as pure functions from a plan to plain data.
//!
//! Results (errors, sweeps, work units, flipped counts) depends on no machine: it is hashed,
//! cached and pinned like everything else. Time is measured apart, by `signorini bench`.

pub mod accuracy;
pub mod claims;
pub mod cube;
pub mod known;
mod numbers;
pub mod problems;
pub mod rounding;
pub mod saddle;
pub mod stress;
pub mod trial;
pub mod truth;
pub mod work;

use serde::{Deserialize, Serialize};

/// Least and greatest of some numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Least.
    pub least: f64,
    /// Greatest.
    pub greatest: f64,
}

impl Range {
    /// `None` without numbers.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        values.into_iter().fold(None, |range: Option<Self>, x| {
            let (least, greatest) = range.map_or((x, x), |r| (r.least.min(x), r.greatest.max(x)));
            Some(Self { least, greatest })
        })
    }
}

/// The double nearest to a power of ten.
pub fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().expect("a number")
}

/// Exponent p of the power law `y = c x^p` that fits best: least squares in logarithms.
///
/// NaN if there are fewer than two different x.
pub fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|&(x, y)| (libm::log(x), libm::log(y))).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let variance: f64 = logs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
    covariance / variance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_power_laws() {
        let law: Vec<_> = (1..6).map(|k| (f64::from(k), 7.0 * f64::from(k).powi(3))).collect();
        assert!((exponent(&law) - 3.0).abs() < 1e-12);
        assert!(exponent(&law[..1]).is_nan());
    }
}
