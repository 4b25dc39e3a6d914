//! True solutions from the spectral solver: values for reference, and finite elements measured against them.

mod elements;
mod plane;
mod reference;

use super::known::{KnownSolution, SAMPLED};
use super::problems::CONTACT;
use super::{Findings, Rows};
use crate::machine::threads::try_map;
use crate::problem::exact::Exact;
use crate::saddle::Pair;
use elements::against;
use plane::{PlanePlan, against_plane};
use reference::values;
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TruthPlan {
    /// Names, and right-hand sides in the notation of scenes.
    problems: Vec<(String, String)>,
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
            ("corner-disc", "disc(0.5,0.5,0.3)=4; else=-1"),
        ];
        let mut problems: Vec<_> = first.into_iter().collect();
        problems.extend(others.map(|(name, f)| (name.to_owned(), f.to_owned())));
        Self {
            problems,
            cells: vec![16, 32, 64, 128, 256],
            sampled: SAMPLED,
            plane: PlanePlan::all(),
        }
    }
}

/// Table `references`: the solution of a problem, and how certain it is.
#[derive(Serialize)]
struct ReferenceRow {
    problem: String,
    /// f in the notation of scenes.
    f: String,
    /// Width of the bracket of the energy over it; none without a bracket.
    bracket: Option<f64>,
    /// Absolute value of the total force plus the integral of f, over the integral of |f|: zero but for errors.
    balance: f64,
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
/// 1. Solves each problem by the spectral solver; of the first ones, gives the solution at the nodes of a grid.
/// 2. Solves each problem, and those with a formula, with finite elements on all grids.
/// 3. Measures errors and guaranteed bounds against the true solutions.
/// 4. Does the same on other domains.
///
/// # Errors
/// A sentence if a right-hand side cannot be read, or there is no solution.
pub(super) fn truth(plan: &TruthPlan) -> Result<Findings, String> {
    let mut known = try_map(&plan.problems, |(name, f)| KnownSolution::spectral(name, f))?;
    let (mut references, mut numbers) = (Vec::new(), Vec::new());
    for found in known.iter().filter_map(KnownSolution::found) {
        let checks = found.solution.checks;
        references.push(ReferenceRow {
            problem: found.name.clone(),
            f: found.f.to_string(),
            bracket: checks.bracket,
            balance: checks.balance.abs(),
        });
        numbers.extend(values(&found.name, &found.solution));
    }
    let (mut samples, mut multipliers) = (Vec::new(), Vec::new());
    for found in known.iter().filter_map(KnownSolution::found).take(SAMPLED_PROBLEMS) {
        let Pair { y, a } = found.at_nodes(plan.sampled)?;
        let problem = &found.name;
        samples.extend(y.into_iter().map(|v| SampleRow { problem: problem.clone(), v }));
        multipliers.extend(a.into_iter().map(|a| MultiplierRow { problem: problem.clone(), a }));
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
        ("values".into(), Rows::of(numbers)),
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
