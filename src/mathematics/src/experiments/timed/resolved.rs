//! The spectral solver, from resolution to resolution.

use super::{Prepared, TimedFacts, TimedRun};
use crate::experiments::rows::row_of;
use crate::problem::source::Source;
use crate::spectral::{SpectralError, SpectralParams, spectral};
use serde::Serialize;

/// Resolutions (nodes, levels) from three digits to all; the last is the reference.
const RESOLUTIONS: [(usize, u32); 8] =
    [(6, 2), (8, 3), (10, 3), (12, 4), (14, 5), (16, 6), (20, 8), (24, 9)];

/// Table `spectral`: the spectral solver at one resolution.
#[derive(Serialize)]
struct ResolvedRow {
    problem: String,
    nodes: usize,
    levels: u32,
    /// Error of the energy against a finer resolution, relative; at least one rounding.
    error: f64,
}

/// Runs at all resolutions but the reference, from f to the energy.
pub(super) fn runs((problem, f): (String, Source)) -> Prepared {
    let [resolutions @ .., finest] =
        RESOLUTIONS.map(|(nodes, levels)| SpectralParams { nodes, levels });
    let reference = energy(&f, finest).map_err(|e| format!("{problem}: {e}"))?;
    let mut runs = Vec::new();
    for resolution in resolutions {
        let (f, problem) = (f.clone(), problem.clone());
        runs.push(TimedRun::new(
            format!("spectral, {problem}"),
            move || energy(&f, resolution),
            move |energy: Result<f64, SpectralError>| {
                // An answer that fails the solver's own checks is left out.
                let Ok(energy) = energy else { return Ok(None) };
                let error = (energy / reference - 1.0).abs().max(f64::EPSILON);
                let SpectralParams { nodes, levels } = resolution;
                let row = ResolvedRow { problem: problem.clone(), nodes, levels, error };
                Ok(Some(TimedFacts { table: "spectral", row: row_of(row) }))
            },
        ));
    }
    Ok(runs)
}

fn energy(f: &Source, resolution: SpectralParams) -> Result<f64, SpectralError> {
    Ok(spectral(f, resolution)?.energy)
}
