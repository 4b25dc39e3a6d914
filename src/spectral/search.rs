//! The search for the contact set: Newton's method and corrections in turn, until all signs are right.

use super::Params;
use super::contact::{SHORTEST_ROUND_CORNER, Signs, TOLERANCE, corrected, without_short};
use super::panels::{Ends, Place};
use super::problem::Problem;
use super::sources::Rules;
use super::trace::Trace;

/// A resolution and what it can tell apart.
struct Level {
    rules: Rules,
    /// Newton's method ends with a step shorter than this.
    shortest: f64,
    /// Negative multipliers and values that count, relative to the largest.
    tolerance: [f64; 2],
}

impl Level {
    fn new(params: Params) -> Self {
        Self { rules: Rules::new(params), shortest: 1e-7, tolerance: TOLERANCE }
    }

    /// Six digits, at a small part of the cost of fourteen; `None` if not even these are asked for.
    fn rough(params: Params) -> Option<Self> {
        const ROUGH: Params = Params { nodes: 8, levels: 3 };
        let level = Self { shortest: 1e-5, tolerance: [1e-5, 1e-5], ..Self::new(ROUGH) };
        (params.nodes > ROUGH.nodes).then_some(level)
    }

    /// What Newton's method finds for a number of arcs; `None` if it does not converge, or no arc is left.
    fn attempt(&self, problem: &Problem, places: Vec<Place>) -> Option<(Found, Signs)> {
        let (moved, steps) = problem.newton(places, &self.rules, self.shortest)?;
        let ends = Ends::new(without_short(moved, SHORTEST_ROUND_CORNER)?);
        let trace = Trace::new(problem, &ends, &self.rules);
        let signs = corrected(&trace, &ends, self.tolerance);
        Some((Found { ends: ends.places, trace, rules: self.rules.clone(), steps }, signs))
    }
}

/// A solution at one resolution.
pub(super) struct Found {
    pub ends: Vec<Place>,
    pub trace: Trace,
    pub rules: Rules,
    /// Newton steps.
    pub steps: usize,
}

/// The solution with all signs right, from a contact set of a grid. A low resolution prepares each attempt of
/// the high one, which is then left with a single Newton step, and with signs that the low one cannot tell.
pub(super) fn from_grid(problem: &Problem, start: Vec<Place>, params: Params) -> Option<Found> {
    search(problem, start, &Level::new(params), Level::rough(params).as_ref())
}

/// The solution, from its own contact set at another resolution.
pub(super) fn refined(problem: &Problem, start: Vec<Place>, params: Params) -> Option<Found> {
    search(problem, start, &Level::new(params), None)
}

fn search(
    problem: &Problem,
    mut places: Vec<Place>,
    level: &Level,
    rough: Option<&Level>,
) -> Option<Found> {
    // If a few do not do, a contact set of a finer grid is the better start.
    const ROUNDS: usize = 5;
    let mut steps = 0;
    for _ in 0..ROUNDS {
        if let Some((found, signs)) = rough.and_then(|rough| rough.attempt(problem, places.clone()))
        {
            steps += found.steps;
            match signs {
                Signs::Right => places = found.ends,
                Signs::Better(better) => {
                    places = better;
                    continue;
                }
                Signs::NothingLeft => {}
            }
        }
        let (found, signs) = level.attempt(problem, places)?;
        steps += found.steps;
        match signs {
            Signs::Right => return Some(Found { steps, ..found }),
            Signs::Better(better) => places = better,
            Signs::NothingLeft => return None,
        }
    }
    None
}
