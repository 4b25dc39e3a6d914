//! The search for the contact set: Newton's method and corrections in turn, until all signs are right.

use super::Params;
use super::contact::{SHORTEST_ROUND_CORNER, corrected, without_short};
use super::panels::Ends;
use super::place::Place;
use super::problem::Problem;
use super::rule::Rules;
use super::trace::Trace;

/// A solution at one resolution.
pub(super) struct Found {
    pub ends: Vec<Place>,
    pub trace: Trace,
    pub rules: Rules,
    /// Newton steps.
    pub steps: usize,
}

/// The solution with all signs right, from a contact set. With `rough` that may be one of a grid: Newton's method finds
/// six digits first, at a small part of the cost of fourteen, and a single step is left to that with all.
pub(super) fn search(
    problem: &Problem,
    mut places: Vec<Place>,
    params: Params,
    rough: bool,
) -> Option<Found> {
    const ROUGH: Params = Params { nodes: 8, levels: 3 };
    let rough = (rough && params.nodes > ROUGH.nodes).then(|| Rules::new(ROUGH));
    let rules = Rules::new(params);
    // If a few do not do, a contact set of a finer grid is the better start.
    const ROUNDS: usize = 5;
    let mut steps = 0;
    for _ in 0..ROUNDS {
        if let Some(rough) = &rough {
            let (moved, rough_steps) = problem.newton(places, rough, 1e-5)?;
            (places, steps) = (moved, steps + rough_steps);
        }
        let (moved, fine_steps) = problem.newton(places, &rules, 1e-7)?;
        steps += fine_steps;
        let ends = Ends::new(without_short(moved, SHORTEST_ROUND_CORNER)?);
        let trace = Trace::new(problem, &ends, &rules);
        places = corrected(&trace, &ends, &rules)?;
        if places == ends.places {
            return Some(Found { ends: places, trace, rules, steps });
        }
    }
    None
}
