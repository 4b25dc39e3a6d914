//! True solutions from the spectral solver: values for reference, and finite elements measured against them.

mod elements;
mod reference;

pub use elements::{Elements, ElementsLevel};
pub use reference::{Numbers, Reference, ReferenceArc, ReferenceValue};

use super::known::KnownSolution;
use super::problems::CONTACT;
use crate::discrete::norms::worst;
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::spectral::{SpectralParams, spectral};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Plan of the computation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TruthPlan {
    /// Names, and right-hand sides in the notation of scenes.
    pub problems: Vec<(String, String)>,
    /// The two resolutions whose common digits are given, as nodes of a panel and levels of panels.
    pub resolutions: [(usize, u32); 2],
    /// Cells per side of the grids on which finite elements are measured.
    pub cells: Vec<usize>,
    /// Cells per side of the grid at whose nodes the solutions of the first two problems are given.
    pub sampled: usize,
}

impl TruthPlan {
    /// The paper's problems `first`, then others, with several arcs of contact and with discs.
    pub fn new(first: impl IntoIterator<Item = (String, String)>) -> Self {
        let [strong, two_arcs] = CONTACT;
        let others = [
            ("four-arcs", "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5"),
            strong,
            two_arcs,
            ("two-discs", "disc(0.1,-0.2,0.3)=3; disc(-0.1,0.1,0.25)=-4; else=-1"),
            ("corner-disc", "disc(0.5,0.5,0.3)=4; else=-1"),
        ];
        let others = others.map(|(name, f)| (name.to_owned(), f.to_owned()));
        Self {
            problems: first.into_iter().chain(others).collect(),
            resolutions: [(20, 8), (24, 9)],
            cells: vec![16, 32, 64, 128, 256],
            sampled: 32,
        }
    }
}

/// Results.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Truth {
    /// One per problem.
    pub references: Vec<Reference>,
    /// Finite elements on the same problems, then on those with solutions in closed form.
    pub elements: Vec<Elements>,
    /// Cells per side of the grid of `samples`.
    pub sampled: usize,
    /// v of the first two problems at the nodes, row by row from the lower left corner.
    pub samples: Vec<Vec<f64>>,
    /// Numbers that the chapter quotes for all of them.
    pub summary: TruthSummary,
}

/// Accuracy with which identities and bounds hold.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct TruthSummary {
    /// The largest [`Reference::green`], its sign left out.
    pub green: f64,
    /// Largest [`Reference::rellich`].
    pub rellich: f64,
    /// Brackets of a true energy that is known.
    pub brackets: usize,
    /// Those that hold it.
    pub held: usize,
}

impl TruthSummary {
    fn of(references: &[Reference], elements: &[Elements]) -> Self {
        let worst = |of: fn(&Reference) -> f64| worst(references.iter().map(of));
        let held = || elements.iter().flat_map(|one| &one.levels).filter_map(|level| level.holds);
        Self {
            green: worst(|one| one.green),
            rellich: worst(|one| one.rellich),
            brackets: held().count(),
            held: held().filter(|held| *held).count(),
        }
    }
}

/// Runs the experiment.
///
/// # Errors
/// A sentence if a right-hand side cannot be read, or there is no solution.
pub fn truth(plan: &TruthPlan) -> Result<Truth, String> {
    let [rough, fine] = plan.resolutions.map(|(nodes, levels)| SpectralParams { nodes, levels });
    let solved = |(name, text): &(String, String)| {
        let f: Source = text.parse().map_err(|e| format!("{name}: {e}"))?;
        let failed = |e| format!("{name}: {e}");
        let rough = spectral(&f, rough).map_err(failed)?;
        let fine = rough.at_resolution(fine).map_err(failed)?;
        Ok((Reference::of(name, &f, &rough, &fine), KnownSolution::of(name, f, fine)))
    };
    let solved: Vec<(Reference, KnownSolution)> =
        plan.problems.par_iter().map(solved).collect::<Result<_, String>>()?;
    let (references, mut known): (Vec<_>, Vec<_>) = solved.into_iter().unzip();
    let sampled = known.iter().take(2).filter_map(KnownSolution::solution);
    let samples = sampled.map(|solution| solution.at_nodes(plan.sampled)).collect();
    known.extend(Exact::ALL.map(KnownSolution::Formula));
    let elements = known
        .par_iter()
        .map(|known| Elements::against(known, &plan.cells))
        .collect::<Result<Vec<_>, _>>()?;
    let summary = TruthSummary::of(&references, &elements);
    Ok(Truth { references, elements, sampled: plan.sampled, samples, summary })
}
