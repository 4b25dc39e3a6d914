//! Which boundary nodes are in contact, iteration by iteration, on the finest grid of a published table.

use super::problems::{Discrete, Problem};
use super::truth::arc_length;
use crate::discrete::grid::Grid;
use crate::saddle::{Method, Params, Steps, StopRule, arrow_hurwicz, on_nested, tolerance};
use crate::spectral::spectral;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Everything the experiment depends on.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The paper's problems.
    pub problems: Vec<Problem>,
}

/// The contact of one problem, for each of the paper's r.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Strips {
    /// Number of its table.
    pub number: u8,
    /// Cells per side of the grid.
    pub cells: usize,
    /// One per r.
    pub strips: Vec<Strip>,
    /// The contact arcs of the true solution: from and to, as arc lengths in sides, anticlockwise from the
    /// lower left corner; one that passes this corner ends before it begins.
    pub truth: Vec<[f64; 2]>,
}

impl Strips {
    /// Problem and grid in words.
    pub fn title(&self) -> String {
        format!("Problem {}, h = 1/{}", self.number, self.cells)
    }
}

/// The contact of one run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Strip {
    /// Duality parameter.
    pub r: f64,
    /// After each iteration, the runs of boundary nodes in contact: first, and one past the
    /// last, counted anticlockwise from the lower left corner.
    pub contact: Vec<Vec<[usize; 2]>>,
}

/// Runs the paper's method under the signed rule, and watches the last grid.
///
/// # Errors
/// A sentence if f cannot be read, grids do not nest, or there is no solution.
pub fn strips(plan: &Plan) -> Result<Vec<Strips>, String> {
    plan.problems.iter().map(of_problem).collect()
}

fn of_problem(problem: &Problem) -> Result<Strips, String> {
    let Discrete { f, grids, loads } = problem.discrete()?;
    let solution = spectral(&f, crate::spectral::Params::default())
        .map_err(|e| format!("{}: {e}", problem.f))?;
    let truth = solution.contact.iter().map(|arc| [arc.from, arc.to].map(arc_length)).collect();
    Ok(Strips {
        number: problem.number,
        cells: problem.grids.last().copied().unwrap_or(0),
        strips: problem.r.par_iter().map(|&r| strip(problem, &grids, &loads, r)).collect(),
        truth,
    })
}

fn strip(problem: &Problem, grids: &[Grid], loads: &[Vec<f64>], r: f64) -> Strip {
    let mut contact = Vec::new();
    on_nested(grids, loads, problem.prolongation, |level, grid, load, pair| {
        let params = Params {
            r,
            tolerance: tolerance(level),
            rule: StopRule::Signed,
            max_iterations: problem.max_iterations,
        };
        let start = pair.clone();
        let outcome = arrow_hurwicz(grid, load, &params, pair);
        if level == grids.len() {
            // The solver does not show its iterates: as many iterations as it took are made once more.
            let mut again = start;
            let mut steps = Steps::new(grid, load, Method::ArrowHurwicz, r);
            for _ in 0..outcome.iterations {
                if steps.step(&mut again, usize::MAX).is_break() {
                    break;
                }
                contact.push(runs(&again.in_contact(grid)));
            }
        }
        (outcome, outcome.stop)
    });
    Strip { r, contact }
}

/// Runs of boundary nodes in contact: first, and one past the last.
pub fn runs(in_contact: &[bool]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (b, _) in in_contact.iter().enumerate().filter(|(_, contact)| **contact) {
        match runs.last_mut() {
            Some(run) if run[1] == b => run[1] = b + 1,
            _ => runs.push([b, b + 1]),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_disjoint_and_ascend() {
        assert_eq!(runs(&[true, false, true, true, false]), [[0, 1], [2, 4]]);
    }
}
