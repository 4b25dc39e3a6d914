//! True solutions from the spectral solver: values for reference, and finite elements measured against them.

mod elements;
mod plane;
mod reference;

use super::known::KnownSolution;
use super::problems::CONTACT;
use super::{Findings, Rows};
use crate::discrete::grid::Grid;
use crate::machine::threads::try_map;
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::saddle::Pair;
use crate::spectral::{Checks, SpectralParams, spectral};
use elements::against;
use plane::{PlanePlan, against_plane};
use reference::{ValueRow, values};
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TruthPlan {
    /// Names, and right-hand sides in the notation of scenes.
    problems: Vec<(String, String)>,
    /// Two resolutions whose common digits are given, as nodes of a panel and levels of panels.
    resolutions: [(usize, u32); 2],
    /// Cells per side of the grids on which finite elements are measured.
    cells: Vec<usize>,
    /// Cells per side of the grid at whose nodes the solutions of the first two problems are given.
    sampled: usize,
    /// Problems on other domains than the square.
    plane: Vec<PlanePlan>,
}

impl TruthPlan {
    /// Plan of the book: the paper's problems `first`, then others, with several arcs of contact and with discs.
    pub(super) fn new(first: impl IntoIterator<Item = (String, String)>) -> Self {
        let [strong, two_arcs] = CONTACT;
        let others = [
            ("four-arcs", "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5"),
            strong,
            two_arcs,
            ("two-discs", "disc(0.1,-0.2,0.3)=3; disc(-0.1,0.1,0.25)=-4; else=-1"),
            ("corner-disc", "disc(0.5,0.5,0.3)=4; else=-1"),
        ];
        let mut problems: Vec<_> = first.into_iter().collect();
        problems.extend(others.map(|(name, f)| (name.to_owned(), f.to_owned())));
        Self {
            problems,
            resolutions: [(20, 8), (24, 9)],
            cells: vec![16, 32, 64, 128, 256],
            sampled: 32,
            plane: PlanePlan::all(),
        }
    }
}

/// Table `references`: checks of the solution of a problem.
#[derive(Serialize)]
struct ReferenceRow {
    problem: String,
    /// f in the notation of scenes.
    f: String,
    /// Absolute value of the total force plus the integral of f, over the latter: zero but for errors.
    green: f64,
    /// Absolute value of the energy by Rellich's identity less the energy, over the latter: zero but for errors.
    rellich: f64,
}

/// Table `samples`: v at a node, row by row from the lower left corner.
#[derive(Serialize)]
struct SampleRow {
    problem: String,
    v: f64,
}

/// Table `multipliers`: the multiplier at a boundary node, anticlockwise from the lower left corner.
#[derive(Serialize)]
struct MultiplierRow {
    problem: String,
    a: f64,
}

/// Runs the experiment.
///
/// 1. Solves each problem at two resolutions, and keeps the digits on which they agree.
/// 2. Solves each problem, and those with a formula, with finite elements on all grids.
/// 3. Measures errors and guaranteed bounds against the true solutions.
/// 4. Does the same on other domains.
///
/// # Errors
/// A sentence if a right-hand side cannot be read, or there is no solution.
pub(super) fn truth(plan: &TruthPlan) -> Result<Findings, String> {
    let solved = try_map(&plan.problems, |(name, f)| {
        solve(name, f, plan.resolutions).map_err(|e| format!("{name}: {e}"))
    })?;
    let grid = Grid::new(plan.sampled).map_err(|e| e.clone())?;
    let (mut references, mut values, mut known) = (Vec::new(), Vec::new(), Vec::new());
    let (mut samples, mut multipliers) = (Vec::new(), Vec::new());
    for one in solved {
        if known.len() < SAMPLED_PROBLEMS
            && let Some(solution) = one.known.solution()
        {
            let problem = &one.reference.problem;
            let Pair { y, a } = solution.on_grid(grid);
            samples.extend(y.into_iter().map(|v| SampleRow { problem: problem.clone(), v }));
            multipliers
                .extend(a.into_iter().map(|a| MultiplierRow { problem: problem.clone(), a }));
        }
        references.push(one.reference);
        values.extend(one.values);
        known.push(one.known);
    }
    known.extend(Exact::ALL.map(KnownSolution::Formula));
    let elements = try_map(&known, |known| against(known, &plan.cells))?.into_iter().flatten();
    let (mut plane_truths, mut plane, mut plane_ways) = (Vec::new(), Vec::new(), Vec::new());
    for found in try_map(&plan.plane, against_plane)? {
        plane_truths.push(found.truth);
        plane.extend(found.rows);
        plane_ways.extend(found.ways);
    }
    Ok(Findings::from([
        ("references".into(), Rows::of(references)),
        ("values".into(), Rows::of(values)),
        ("elements".into(), Rows::of(elements)),
        ("plane_truths".into(), Rows::of(plane_truths)),
        ("plane".into(), Rows::of(plane)),
        ("plane_ways".into(), Rows::of(plane_ways)),
        ("samples".into(), Rows::of(samples)),
        ("multipliers".into(), Rows::of(multipliers)),
    ]))
}

/// Number of problems, the first, whose solutions are given at nodes.
const SAMPLED_PROBLEMS: usize = 2;

/// A problem, solved at two resolutions.
struct SolvedTwice {
    reference: ReferenceRow,
    values: Vec<ValueRow>,
    known: KnownSolution,
}

/// Solves a problem with the spectral solver at two resolutions; the finer one is the known solution.
fn solve(name: &str, text: &str, resolutions: [(usize, u32); 2]) -> Result<SolvedTwice, String> {
    let [rough, fine] = resolutions.map(|(nodes, levels)| SpectralParams { nodes, levels });
    let f: Source = text.parse().map_err(|e| format!("{e}"))?;
    let rough = spectral(&f, rough).map_err(|e| e.to_string())?;
    let fine = rough.at_resolution(fine).map_err(|e| e.to_string())?;
    let Checks { green, rellich, .. } = fine.checks;
    let (green, rellich) = (green.abs(), rellich.abs());
    let reference = ReferenceRow { problem: name.into(), f: f.to_string(), green, rellich };
    let values = values(name, [&rough, &fine]);
    Ok(SolvedTwice { reference, values, known: KnownSolution::of(name, f, fine) })
}
