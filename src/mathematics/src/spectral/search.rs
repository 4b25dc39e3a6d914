//! The search for the contact set: Newton's method and corrections in turn, until all signs are right.

use super::SpectralParams;
use super::arcs::StickArcs;
use super::contact::{SHORTEST_ROUND_CORNER, corrected, without_short};
use super::panels::Ends;
use super::problem::SpectralProblem;
use super::rule::Rules;
use super::trace::Trace;

/// Solution with all signs right.
pub(super) struct FoundTrace {
    pub(super) trace: Trace,
    /// Number of Newton steps.
    pub(super) steps: usize,
}

/// Finds the solution with all signs right, from a contact set; `None` if that is not reached.
///
/// With `rough` the contact set may be that of a grid: Newton's method finds six digits first, at a small part of the
/// cost of fourteen, and a single step is left to the method with all digits.
pub(super) fn search(
    problem: &SpectralProblem,
    mut arcs: StickArcs,
    params: SpectralParams,
    rough: bool,
) -> Option<FoundTrace> {
    const ROUGH: SpectralParams = SpectralParams { nodes: 8, levels: 3 };
    /// If a few do not do, a contact set of a finer grid is the better start.
    const ROUNDS: usize = 5;
    let rough = (rough && params.nodes > ROUGH.nodes).then(|| Rules::new(ROUGH));
    let rules = Rules::new(params);
    let mut steps = 0;
    for _ in 0..ROUNDS {
        if let Some(rough) = &rough {
            let found = problem.newton(arcs, rough, 1e-5)?;
            (arcs, steps) = (found.arcs, steps + found.steps);
        }
        let found = problem.newton(arcs, &rules, 1e-7)?;
        steps += found.steps;
        let ends = Ends::new(without_short(found.arcs, SHORTEST_ROUND_CORNER)?);
        let trace = Trace::new(problem, ends, &rules);
        arcs = corrected(&trace, problem.law)?;
        if arcs.places == trace.ends.places {
            return Some(FoundTrace { trace, steps });
        }
    }
    None
}
