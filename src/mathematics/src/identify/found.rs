//! Counts and values of Delta a of a table that come out for one f.

use super::agrees;
use super::evaluate::{Evaluator, Table};
use super::space::Geometry;
use crate::square::load::integral;
use serde::{Deserialize, Serialize};

/// A right-hand side, and how much of the table comes out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// f as [`crate::problem::source::Source`] writes it.
    pub f: String,
    /// Integral of f over the square; (2) asks for less than zero.
    pub integral: f64,
    /// Counts that come out.
    pub exact: usize,
    /// Number of counts.
    pub cells: usize,
    /// Delta a per row.
    pub delta_a: Vec<f64>,
    /// Values of Delta a that agree to the two printed digits.
    pub delta_a_exact: usize,
}

/// Runs the f with these `values` on the pieces of a geometry, which has this `number` in the evaluator.
///
/// # Panics
/// If there is no such geometry, or not one value per piece.
pub fn found(
    evaluator: &mut Evaluator<'_>,
    number: usize,
    geometry: &Geometry,
    values: &[f64],
) -> Found {
    let target = evaluator.target();
    let Table { counts, delta_a } = evaluator.free(number, values);
    let pairs = counts.iter().flatten().zip(target.counts.iter().flatten());
    let source = geometry.source(values);
    let same = delta_a.iter().zip(&target.delta_a).filter(|(a, b)| agrees(**a, **b));
    Found {
        f: source.to_string(),
        integral: integral(&source),
        exact: pairs.filter(|(ours, published)| **ours == Some(**published)).count(),
        cells: target.cells(),
        delta_a_exact: same.count(),
        delta_a,
    }
}
