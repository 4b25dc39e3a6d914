//! The search for the contact set: Newton's method and corrections in turn, until all signs are right.

use super::Params;
use super::contact::{TOLERANCE, corrected, without_short};
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

    /// What Newton's method finds for a number of arcs, and a better contact set, as of [`corrected`]; `None` if
    /// it does not converge, or no arc is left.
    fn attempt(
        &self,
        problem: &Problem,
        places: Vec<Place>,
    ) -> Option<(Found, Option<Option<Vec<Place>>>)> {
        let (moved, steps) = problem.newton(places, &self.rules, self.shortest)?;
        let ends = Ends::new(without_short(moved)?);
        let trace = Trace::new(problem, &ends, &self.rules);
        let better = corrected(&trace, &ends, self.tolerance);
        Some((Found { ends: ends.places, trace, rules: self.rules.clone(), steps }, better))
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
/// the high one, which is then left with a single Newton step, and with signs that the low one cannot tell;
/// where it misleads, the high one is tried alone.
pub(super) fn from_grid(problem: &Problem, start: Vec<Place>, params: Params) -> Option<Found> {
    let level = Level::new(params);
    let rough = Level::rough(params);
    rough
        .and_then(|rough| search(problem, start.clone(), &level, Some(&rough)))
        .or_else(|| search(problem, start, &level, None))
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
    const ROUNDS: usize = 12;
    let mut steps = 0;
    for _ in 0..ROUNDS {
        if let Some((found, better)) =
            rough.and_then(|rough| rough.attempt(problem, places.clone()))
        {
            steps += found.steps;
            match better {
                None => places = found.ends,
                Some(Some(better)) => {
                    places = better;
                    continue;
                }
                Some(None) => {}
            }
        }
        let (found, better) = level.attempt(problem, places)?;
        steps += found.steps;
        let Some(better) = better else { return Some(Found { steps, ..found }) };
        places = better?;
    }
    None
}
