//! The search for the contact set: Newton's method and corrections in turn, until all signs are right.

use super::SpectralParams;
use super::contact::{SHORTEST_ROUND_CORNER, corrected, without_short};
use super::panels::Ends;
use super::place::BorderPlace;
use super::problem::SpectralProblem;
use super::rule::Rules;
use super::trace::Trace;

/// The solution with all signs right, and how many Newton steps it took from a contact set. With `rough` that may be
/// one of a grid: Newton's method finds six digits first, at a small part of the cost of fourteen, and a single step is
/// left to that with all.
pub(super) fn search(
    problem: &SpectralProblem,
    mut places: Vec<BorderPlace>,
    params: SpectralParams,
    rough: bool,
) -> Option<(Trace, usize)> {
    const ROUGH: SpectralParams = SpectralParams { nodes: 8, levels: 3 };
    let rough = (rough && params.nodes > ROUGH.nodes).then(|| Rules::new(ROUGH));
    let rules = Rules::new(params);
    // If a few do not do, a contact set of a finer grid is the better start.
    const ROUNDS: usize = 5;
    let mut steps = 0;
    for _ in 0..ROUNDS {
        for (rules, shortest) in rough.iter().map(|rough| (rough, 1e-5)).chain([(&rules, 1e-7)]) {
            let (moved, more) = problem.newton(places, rules, shortest)?;
            (places, steps) = (moved, steps + more);
        }
        let ends = Ends::new(without_short(places, SHORTEST_ROUND_CORNER)?);
        let trace = Trace::new(problem, ends, &rules);
        places = corrected(&trace)?;
        if places == trace.ends.places {
            return Some((trace, steps));
        }
    }
    None
}
