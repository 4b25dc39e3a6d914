//! The spectral solver, from resolution to resolution.

use super::{Prepared, TimedFacts, TimedRun};
use crate::problem::source::Source;
use crate::spectral::{SpectralError, SpectralParams, spectral};

/// Resolutions (nodes, levels) from three digits to all; the last is the reference.
const RESOLUTIONS: [(usize, u32); 8] =
    [(6, 2), (8, 3), (10, 3), (12, 4), (14, 5), (16, 6), (20, 8), (24, 9)];

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
                Ok(energy.ok().map(|energy| TimedFacts::Spectral {
                    problem: problem.clone(),
                    resolution,
                    error: (energy / reference - 1.0).abs().max(f64::EPSILON),
                }))
            },
        ));
    }
    Ok(runs)
}

fn energy(f: &Source, resolution: SpectralParams) -> Result<f64, SpectralError> {
    Ok(spectral(f, resolution)?.energy)
}
