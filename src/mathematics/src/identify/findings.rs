//! Findings about a recovered f: which other f explains its table, how far it may move, and that a blind search finds it.

use super::evaluate::{Evaluator, grid};
use super::identifiability::{Identifiability, Slice, identifiability, slice};
use super::rank::explain;
use super::search::{Request, SearchReport, search};
use super::space::{Candidate, Geometry, Lattice, Space};
use super::variant::Variant;
use super::{Found, IdentifyError, Target};
use crate::discrete::load::load;
use crate::problem::source::Source;
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;

/// Questions that [`findings`] answers, besides how far f may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Questions {
    /// The space of the blind search.
    pub space: Space,
    /// Values, as [`Lattice::parse_all`] reads them.
    pub values: String,
    /// Number of candidates that the blind search keeps.
    pub top: usize,
    /// The map: how far the first and the last value move, either way.
    pub reach: [f64; 2],
    /// Points of the map along each axis.
    pub points: usize,
}

/// Another f that may explain the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Values on the quadrants: lower left, lower right, upper left, upper right.
    pub values: Vec<f64>,
    /// Score and table.
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

/// Finds out about `f`, which is constant on the quadrants, and about `alternatives`.
///
/// Each alternative is four decimals separated by `;`. Runs on the threads of the current rayon pool, on whose number the results do not depend.
///
/// # Errors
/// [`IdentifyError`] if the target is no table, a question makes no sense, or f has other pieces.
pub fn findings(
    target: &Target,
    variant: &Variant,
    f: &Source,
    alternatives: &[String],
    questions: &Questions,
) -> Result<Findings, IdentifyError> {
    let (own, values) =
        Geometry::of_quadrants(f).ok_or_else(|| IdentifyError::Pieces(f.to_string()))?;
    let quadrants = Geometry::quadrants();
    let on_quadrants = quadrant_values(f);
    let blind = Request {
        space: questions.space,
        values: Lattice::parse_all(&questions.values)?,
        variant: *variant,
        negative_integral: true,
        exact_grids: 3,
        top: questions.top,
    };
    let mut evaluator = Evaluator::new(target, variant, std::slice::from_ref(&quadrants))?;
    let alternative = |text: &String| {
        let lattices = Lattice::parse_all(text)?;
        let places = lattices.iter().map(Lattice::places).max().unwrap_or(0);
        let ticks: Vec<i64> =
            lattices.iter().flat_map(|l| l.refined(places).ticks().to_vec()).collect();
        if lattices.len() != 4 || ticks.len() != 4 {
            return Err(IdentifyError::Values(text.clone()));
        }
        let candidate = Candidate { geometry: 0, ticks, places };
        let values = candidate.values();
        let found = explain(&mut evaluator, &quadrants, &candidate);
        let source = quadrants.source(&values);
        let sum = |level: usize| load(grid(level), &source, variant.load).iter().sum();
        let sums = (0..target.levels()).map(sum).collect();
        Ok(Alternative { chosen: values == on_quadrants, values, found, sums })
    };
    let alternatives = alternatives.iter().map(alternative).collect::<Result<_, _>>()?;
    let on_own_pieces = Evaluator::new(target, variant, &[own])?;
    let first_and_last = [0, values.len() - 1];
    let Questions { reach, points, .. } = *questions;
    Ok(Findings {
        schema: 1,
        target: target.clone(),
        alternatives,
        identifiability: identifiability(&evaluator, &on_quadrants),
        slice: slice(&on_own_pieces, &values, first_and_last, reach, points),
        search: search(&blind, target, &AtomicBool::new(false), &mut |_| ())?,
    })
}

/// f in the middle of the quadrants: lower left, lower right, upper left, upper right.
fn quadrant_values(f: &Source) -> Vec<f64> {
    [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)].map(|(x, y)| f.at([x, y])).to_vec()
}
