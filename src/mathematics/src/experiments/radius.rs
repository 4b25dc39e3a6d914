//! Convergence of the paper's method: the spectral radius of one iteration on the contact set of the solution, and the
//! factor per iteration by which the method itself converges in the end.
//!
//! On a contact set that no longer changes, (9)-(12) is linear in the error. In contact,
//! `y_i = (h a_i - sum A_ij y_j) / (A_ii + h r)` and `a_i <- a_i - r y_i`; elsewhere `y_i = - sum A_ij y_j / A_ii`, and
//! a is zero. Powers of this map grow like powers of its spectral radius. A vector for one r is the start for the next,
//! so that few iterations are enough.

use super::saddle::{CheckInterval, sweeps_until};
use super::{Findings, Rows};
use crate::discrete::grid::Grid;
use crate::discrete::load::{Diagonal, LoadRule};
use crate::discrete::network::{ContactRow, Network};
use crate::discrete::norms::largest;
use crate::levels::Problem;
use crate::machine::threads::map;
use crate::problem::law::Law;
use crate::saddle::{Method, Pair, RunStart};
use crate::solvers::{Settings, Solver, solve};
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct RadiusPlan {
    /// Problems: name and f on the square, integrated exactly.
    problems: Vec<(String, String)>,
    /// Cells per side of the grids.
    cells: Vec<usize>,
    /// Duality parameters, from the largest on.
    r: Vec<f64>,
    /// Duality parameter with which the method itself runs, from zero.
    measured_r: f64,
}

impl RadiusPlan {
    /// The paper's problems, and one that is in contact nearly everywhere.
    pub(super) fn new(mut problems: Vec<(String, String)>) -> Self {
        problems.push(("free-corner".into(), "exact(free-corner)".into()));
        let r = vec![1e6, 1e4, 1e3, 100.0, 30.0, 10.0, 3.0, 1.0, 0.5, 0.2];
        Self { problems, cells: vec![8, 16, 32], r, measured_r: 10.0 }
    }
}

/// Spectral radius of one iteration.
#[derive(Clone, Debug, Serialize)]
struct RadiusRow {
    /// Name of the problem.
    problem: String,
    /// Cells per side.
    cells: usize,
    /// Number of nodes in contact.
    contact: usize,
    /// Duality parameter.
    r: f64,
    /// One minus the radius.
    gap: f64,
    /// One minus the radius, over h^2.
    per_h2: f64,
}

/// Convergence of the method itself, once its contact set is that of the solution.
#[derive(Clone, Debug, Serialize)]
struct MeasuredRow {
    /// Name of the problem.
    problem: String,
    /// Cells per side.
    cells: usize,
    /// Duality parameter.
    r: f64,
    /// One minus the factor by which the changes of y shrink from one iteration to the next.
    gap: f64,
    /// Iterations after which it was measured.
    iterations: usize,
}

/// Relative change of a gap from block to block of iterations at which it is taken for settled.
const SETTLED: f64 = 1e-3;
/// Most blocks of iterations.
const BLOCKS: usize = 400;

/// Computes the radii and measures the method: the central function of this module. Tables `radii`, one row per
/// problem, grid and r, and `measured`, one row per problem and grid.
///
/// # Errors
/// A sentence if a problem cannot be read or solved, or a factor does not settle.
pub(super) fn radius(plan: &RadiusPlan) -> Result<Findings, String> {
    let found = map(&plan.problems, 1, |(name, f)| {
        let (mut radii, mut measured) = (Vec::new(), Vec::new());
        for &cells in &plan.cells {
            let in_words = |reason: String| format!("{name} on 1/{cells}: {reason}");
            let case = Case::new(f, cells).map_err(in_words)?;
            let mut pair = Pair::zero(case.grid);
            pair.y.fill(1.0);
            for &r in &plan.r {
                let gap = case.gap(r, &mut pair).map_err(in_words)?;
                let contact = case.held.iter().filter(|&&held| held).count();
                let per_h2 = gap * (cells * cells) as f64;
                radii.push(RadiusRow { problem: name.clone(), cells, contact, r, gap, per_h2 });
            }
            let r = plan.measured_r;
            let (gap, iterations) = case.measured(r).map_err(in_words)?;
            measured.push(MeasuredRow { problem: name.clone(), cells, r, gap, iterations });
        }
        Ok((radii, measured))
    });
    let (mut radii, mut measured) = (Vec::new(), Vec::new());
    for of_problem in found.into_iter().collect::<Result<Vec<_>, String>>()? {
        radii.extend(of_problem.0);
        measured.extend(of_problem.1);
    }
    let tables = [("radii", Rows::of(radii)), ("measured", Rows::of(measured))];
    Ok(tables.map(|(name, rows)| (name.into(), rows)).into())
}

/// Discrete problem with the contact set of its solution.
struct Case {
    grid: Grid,
    network: Network,
    load: Vec<f64>,
    /// True at the boundary nodes with a positive multiplier.
    held: Vec<bool>,
}

impl Case {
    fn new(f: &str, cells: usize) -> Result<Self, String> {
        let grid = Grid::new(cells)?;
        let f = f.parse().map_err(|e| format!("f: {e}"))?;
        let rule = LoadRule::Exact { diagonal: Diagonal::default() };
        let problem = Problem::on_square(vec![grid], f, rule, Law::SIGNORINI);
        let problem = problem.map_err(|e| e.to_string())?;
        let run = solve(&problem, &Settings::of(Solver::ActiveSet)).map_err(|e| e.to_string())?;
        let held = run.pair().a.iter().map(|&a| a > 0.0).collect();
        Ok(Self { grid, network: Network::of_square(grid), load: problem.load().to_vec(), held })
    }

    /// Number of iterations in a block: a quarter of what smooth errors take.
    fn block(&self) -> usize {
        self.grid.cells() * self.grid.cells() / 4
    }

    /// One minus the spectral radius of an iteration, by its powers on a pair, which becomes the dominant one.
    fn gap(&self, r: f64, pair: &mut Pair) -> Result<f64, String> {
        let zero = vec![0.0; self.load.len()];
        let mut before = f64::NAN;
        for _ in 0..BLOCKS {
            let start = largest(&pair.y);
            for entry in pair.y.iter_mut().chain(&mut pair.a) {
                *entry /= start;
            }
            for _ in 0..self.block() {
                self.iterate(&zero, r, pair);
            }
            let gap = self.gap_of(largest(&pair.y));
            if (gap - before).abs() <= SETTLED * gap {
                return Ok(gap);
            }
            before = gap;
        }
        Err(format!("no spectral radius with r = {r}"))
    }

    /// One minus the factor per iteration that in a block makes this factor.
    fn gap_of(&self, factor: f64) -> f64 {
        -libm::expm1(libm::log(factor) / self.block() as f64)
    }

    /// One iteration on the contact set.
    fn iterate(&self, load: &[f64], r: f64, Pair { y, a }: &mut Pair) {
        self.network.sweep(load, y, |b, ContactRow { sum, diagonal, measure }| {
            if self.held[b] {
                (sum + measure * a[b]) / (diagonal + measure * r)
            } else {
                sum / diagonal
            }
        });
        for ((a, contact), held) in a.iter_mut().zip(self.network.contact()).zip(&self.held) {
            *a = if *held { *a - r * y[contact.node] } else { 0.0 };
        }
    }

    /// One minus the factor of the method itself from zero, once its contact set stays the final one and the factor has
    /// settled; and the number of iterations.
    fn measured(&self, r: f64) -> Result<(f64, usize), String> {
        let (method, pair) = (Method::ArrowHurwicz, &Pair::zero(self.grid));
        let start = RunStart { load: &self.load, method, r, pair };
        let (mut iterations, mut last) = (0, Vec::new());
        let (mut change, mut before) = (f64::NAN, f64::NAN);
        // All iterations are looked at.
        let checks = CheckInterval { share: usize::MAX, limit: BLOCKS * self.block() };
        let settled = sweeps_until(self.grid, &start, checks, &mut |pair| {
            let (at, is_start) = (iterations % self.block(), iterations == 0);
            iterations += 1;
            if at + 1 == self.block() {
                last.clone_from(&pair.y);
            }
            if at > 0 || is_start {
                return false;
            }
            let changes: Vec<f64> = pair.y.iter().zip(&last).map(|(y, last)| y - last).collect();
            let now = largest(&changes);
            let gap = self.gap_of(now / change);
            let is_final = pair.a.iter().zip(&self.held).all(|(&a, &held)| (a > 0.0) == held);
            let is_settled = is_final && (gap - before).abs() <= SETTLED * gap;
            // A factor under another contact set says nothing.
            (change, before) = (now, if is_final { gap } else { f64::NAN });
            is_settled
        });
        let (_, iterations) = settled.ok_or(format!("the method does not settle with r = {r}"))?;
        Ok((before, iterations))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_iteration_converges_as_the_method_does_and_small_r_slows_it_down() {
        let plan = RadiusPlan { cells: vec![8], ..RadiusPlan::new(vec![("2".into(), F.into())]) };
        let found = radius(&plan).unwrap();
        let (radii, measured) = (&found["radii"], &found["measured"]);
        let gaps = radii.numbers("gap").unwrap();
        assert!(gaps.len() == 20 && gaps.iter().all(|gap| (1e-4..1.0).contains(gap)), "{gaps:?}");
        for row in measured.iter() {
            let same = radii.wherever("problem", row["problem"].clone()).unwrap();
            let computed = same.wherever("r", 10.0).unwrap().numbers("gap").unwrap()[0];
            let gap = row["gap"].as_f64().unwrap();
            assert!((gap / computed - 1.0).abs() < 0.02, "{gap} {computed}");
        }
        // Of Uzawa's method on boundary values that alternate from node to node.
        let small = radii.wherever("r", 0.2).unwrap().wherever("problem", "free-corner").unwrap();
        let expected = 0.2 / 8.0 / 8f64.sqrt();
        assert!((small.numbers("gap").unwrap()[0] / expected - 1.0).abs() < 0.06, "{small:?}");
    }

    /// f of the paper's second problem.
    const F: &str = "quadrant(ll)=-6; else=1.998";
}
