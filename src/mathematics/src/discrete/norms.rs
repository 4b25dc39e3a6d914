//! Errors of a discrete solution against a known one, and largest values.

use crate::machine::simd::Largest;
use serde::Serialize;

/// Errors of a discrete solution `v_h`, which is linear on the cells of its triangulation.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Errors {
    /// L2 norm of `v - v_h`.
    pub l2: f64,
    /// L2 norm of `grad (v - v_h)`.
    pub h1: f64,
    /// Largest error at a node.
    pub max: f64,
    /// L2 norm on the boundary of the error of the multiplier; none where it is not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplier_l2: Option<f64>,
}

/// The largest absolute value of some numbers; those that are NaN are passed over.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// The sum of some numbers, added from the first to the last.
pub fn sum(values: &[f64]) -> f64 {
    values.iter().sum()
}

/// The largest absolute value of some numbers, NaN if one is.
pub fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut largest = Largest::default();
    values.into_iter().for_each(|value| largest.put(value));
    largest.value()
}
