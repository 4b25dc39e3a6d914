//! Findings about a recovered f: which other f explains its table, how far it may move, and that a blind search finds
//! it.

use super::evaluate::Evaluator;
use super::found::{Found, found};
use super::grid;
use super::identifiability::{Identifiability, Slice, identifiability, slice};
use super::search::SearchReport;
use super::space::Geometry;
use super::variant::Variant;
use super::{IdentifyError, Target};
use crate::problem::source::Source;
use crate::square::load::load;
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;

/// Questions that [`Target::findings`] answers, besides how far f may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Questions {
    /// Values that the blind search tries, `MIN:MAX:STEP`.
    pub values: String,
    /// The map: how far the first and the last value move, either way.
    pub reach: [f64; 2],
    /// Points of the map along each axis.
    pub points: usize,
}

/// Another f that may explain the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Values on the quadrants: lower left, lower right, upper left, upper right.
    pub values: [f64; 4],
    /// The f with its agreement.
    pub found: Found,
    /// Sum of its load vector on each grid of the table.
    pub sums: Vec<f64>,
    /// True if it is the recovered f itself.
    pub chosen: bool,
}

/// Findings about one table and its recovered f.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Version of this format.
    pub schema: u8,
    /// The table.
    pub target: Target,
    /// The alternatives asked about, in their order.
    pub alternatives: Vec<Alternative>,
    /// Room of each quadrant's value, and of the common factor.
    pub identifiability: Identifiability,
    /// Counts that come out when the first and the last value of f move.
    pub slice: Slice,
    /// The blind search.
    pub search: SearchReport,
}

impl Target {
    /// Finds out about `f`, which is constant on the quadrants, and about `alternatives`, by their values on these.
    ///
    /// Runs on the threads of the current rayon pool, on whose number the results do not depend.
    ///
    /// # Errors
    /// [`IdentifyError`] if this is no table, the values to search are none, or f has other pieces.
    pub fn findings(
        &self,
        variant: &Variant,
        f: &Source,
        alternatives: &[[f64; 4]],
        questions: &Questions,
    ) -> Result<Findings, IdentifyError> {
        let (own, values) =
            Geometry::of_quadrants(f).ok_or_else(|| IdentifyError::Pieces(f.to_string()))?;
        let on_quadrants = quadrant_values(f);
        let mut compared = Vec::new();
        for (&values, found) in alternatives.iter().zip(self.found(variant, alternatives)?) {
            let source = Geometry::quadrants().source(&values);
            let loads = (0..self.levels()).map(|level| load(grid(level), &source, variant.load));
            let sums = loads.map(|load| load.iter().sum()).collect();
            compared.push(Alternative { values, found, sums, chosen: values == on_quadrants });
        }
        let evaluator = Evaluator::new(self, variant, &[Geometry::quadrants()])?;
        let on_own_pieces = Evaluator::new(self, variant, &[own])?;
        let first_and_last = [0, values.len() - 1];
        let Questions { reach, points, values: range } = questions;
        Ok(Findings {
            schema: 1,
            target: self.clone(),
            alternatives: compared,
            identifiability: identifiability(&evaluator, &on_quadrants),
            slice: slice(&on_own_pieces, &values, first_and_last, *reach, *points),
            search: self.searched(range, variant, &AtomicBool::new(false))?,
        })
    }

    /// Runs right-hand sides that are constant on the quadrants, by their values there.
    ///
    /// # Errors
    /// [`IdentifyError`] if this is no table.
    pub fn found(&self, variant: &Variant, all: &[[f64; 4]]) -> Result<Vec<Found>, IdentifyError> {
        let quadrants = [Geometry::quadrants()];
        let mut evaluator = Evaluator::new(self, variant, &quadrants)?;
        Ok(all.iter().map(|values| found(&mut evaluator, 0, &quadrants[0], values)).collect())
    }
}

/// f in the middle of the quadrants: lower left, lower right, upper left, upper right.
fn quadrant_values(f: &Source) -> [f64; 4] {
    [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)].map(|(x, y)| f.at([x, y]))
}
