//! The spectral solver on the square, from f to the energy.

use super::{Prepared, TimedFacts, TimedRun};
use crate::discrete::grid::nested;
use crate::discrete::load::LoadRule;
use crate::experiments::rows::row_of;
use crate::levels::Problem;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::solvers::true_solution;
use crate::spectral::TrueSolution;
use serde::Serialize;

/// Table `spectral`: the spectral solver on one problem.
#[derive(Serialize)]
struct SpectralRow {
    problem: String,
    unknowns: usize,
    /// Guaranteed error of the energy, the width of its bracket over it; at least one rounding.
    error: f64,
}

/// Run from f to the energy.
pub(super) fn run((problem, f): (String, Source)) -> Prepared {
    Ok(vec![TimedRun::new(
        format!("spectral, {problem}"),
        move || solved(&f),
        move |found: Result<TrueSolution, String>| {
            let TrueSolution { energy, bracket, unknowns, .. } = found?;
            // A solution without a bracket is left out.
            let Ok([low, high]) = bracket else { return Ok(None) };
            let error = ((high - low) / energy.abs()).max(f64::EPSILON);
            let row = SpectralRow { problem: problem.clone(), unknowns, error };
            Ok(Some(TimedFacts { table: "spectral", row: row_of(row) }))
        },
    )])
}

fn solved(f: &Source) -> Result<TrueSolution, String> {
    let grids = nested(&[2]).map_err(|e| e.clone())?;
    let problem = Problem::on_square(grids, f.clone(), LoadRule::default(), Law::SIGNORINI);
    true_solution(&problem.map_err(|e| e.to_string())?).map_err(|e| e.to_string())
}
