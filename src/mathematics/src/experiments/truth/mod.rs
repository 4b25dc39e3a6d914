//! True solutions from the spectral solver: values for reference, and finite elements measured against them.

mod elements;
mod reference;

pub use elements::{Elements, ElementsLevel, ElementsOrders};
pub use reference::{Numbers, Reference, ReferenceArc, ReferenceValue};

use super::known::KnownSolution;
use super::problems::CONTACT;
use crate::discrete::grid::Grid;
use crate::discrete::norms::worst;
use crate::machine::threads::map;
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::saddle::Pair;
use crate::spectral::{SpectralParams, spectral};
use reference::Resolutions;
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TruthPlan {
    /// Names, and right-hand sides in the notation of scenes.
    pub problems: Vec<(String, String)>,
    /// Two resolutions whose common digits are given, as nodes of a panel and levels of panels.
    pub resolutions: [(usize, u32); 2],
    /// Cells per side of the grids on which finite elements are measured.
    pub cells: Vec<usize>,
    /// Cells per side of the grid at whose nodes the solutions of the first two problems are given.
    pub sampled: usize,
}

impl TruthPlan {
    /// Plan of the book: the paper's problems `first`, then others, with several arcs of contact and with discs.
    pub fn new(first: impl IntoIterator<Item = (String, String)>) -> Self {
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
        }
    }
}

/// Result of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Truth {
    /// References, one per problem.
    pub references: Vec<Reference>,
    /// Finite elements on the same problems, then on those with solutions in closed form.
    pub elements: Vec<Elements>,
    /// Cells per side of the grid of `samples`.
    pub sampled: usize,
    /// v of the first two problems at the nodes, row by row from the lower left corner.
    pub samples: Vec<Vec<f64>>,
    /// Multipliers of the first two problems at the boundary nodes, anticlockwise from the lower left corner.
    pub multipliers: Vec<Vec<f64>>,
    /// Numbers over all problems that the chapter mentions.
    pub summary: TruthSummary,
}

/// Findings on identities and bounds over all problems.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct TruthSummary {
    /// Largest absolute value of [`Reference::green`].
    pub green: f64,
    /// Largest absolute value of [`Reference::rellich`].
    pub rellich: f64,
    /// Number of brackets of a true energy that is known.
    pub brackets: usize,
    /// Number of brackets that hold the true energy.
    pub held: usize,
    /// Greatest guaranteed bounds over the error.
    pub effectivity: EffectivitySummary,
}

/// Greatest guaranteed bounds of the error over the error.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct EffectivitySummary {
    /// Cells per side of the coarsest grid that counts.
    pub from: usize,
    /// Greatest with the default load.
    pub exact: f64,
    /// Greatest with the load against bilinear hats.
    pub bilinear: f64,
}

/// Cells per side from which the guaranteed bound of the error is close to the error.
const EFFECTIVE_FROM: usize = 64;

impl EffectivitySummary {
    fn of(elements: &[Elements]) -> Self {
        let levels = elements.iter().flat_map(|elements| &elements.levels);
        let fine = || levels.clone().filter(|level| level.cells >= EFFECTIVE_FROM);
        Self {
            from: EFFECTIVE_FROM,
            exact: worst(fine().map(|level| level.effectivity[1])),
            bilinear: worst(fine().map(|level| level.bilinear[1])),
        }
    }
}

impl TruthSummary {
    fn of(references: &[Reference], elements: &[Elements]) -> Self {
        let levels = elements.iter().flat_map(|elements| &elements.levels);
        let holds: Vec<bool> = levels.filter_map(|level| level.holds).collect();
        Self {
            green: worst(references.iter().map(|reference| reference.green)),
            rellich: worst(references.iter().map(|reference| reference.rellich)),
            brackets: holds.len(),
            held: holds.iter().filter(|holds| **holds).count(),
            effectivity: EffectivitySummary::of(elements),
        }
    }
}

/// Runs the experiment.
///
/// 1. Solves each problem at two resolutions, and keeps the digits on which they agree.
/// 2. Solves each problem, and those with a formula, with finite elements on all grids.
/// 3. Measures errors and guaranteed bounds against the true solutions.
///
/// # Errors
/// A sentence if a right-hand side cannot be read, or there is no solution.
pub fn truth(plan: &TruthPlan) -> Result<Truth, String> {
    let solved = map(&plan.problems, 1, |(name, f)| {
        solve(name, f, plan.resolutions).map_err(|e| format!("{name}: {e}"))
    });
    let solved: Vec<(Reference, KnownSolution)> =
        solved.into_iter().collect::<Result<_, String>>()?;
    let (references, mut known): (Vec<_>, Vec<_>) = solved.into_iter().unzip();
    let sampled = known.iter().take(2).filter_map(KnownSolution::solution);
    let grid = Grid::new(plan.sampled).map_err(|e| e.to_string())?;
    let sampled = sampled.map(|solution| solution.on_grid(grid));
    let (samples, multipliers) = sampled.map(|Pair { y, a }| (y, a)).unzip();
    known.extend(Exact::ALL.map(KnownSolution::Formula));
    let elements = map(&known, 1, |known| Elements::against(known, &plan.cells));
    let elements = elements.into_iter().collect::<Result<Vec<_>, _>>()?;
    let summary = TruthSummary::of(&references, &elements);
    Ok(Truth { references, elements, sampled: plan.sampled, samples, multipliers, summary })
}

/// Solves a problem with the spectral solver at two resolutions; the finer one is the known solution.
fn solve(
    name: &str,
    text: &str,
    resolutions: [(usize, u32); 2],
) -> Result<(Reference, KnownSolution), String> {
    let [rough, fine] = resolutions.map(|(nodes, levels)| SpectralParams { nodes, levels });
    let f: Source = text.parse().map_err(|e| format!("{e}"))?;
    let rough = spectral(&f, rough).map_err(|e| e.to_string())?;
    let fine = rough.at_resolution(fine).map_err(|e| e.to_string())?;
    let solutions = Resolutions { rough, fine };
    let reference = Reference::of(name, &f, &solutions);
    Ok((reference, KnownSolution::of(name, f, solutions.fine)))
}
