//! Convergence of the paper's method: the spectral radius of one iteration on the contact set of the solution, and the
//! factor per iteration by which the method itself converges in the end.
//!
//! On a contact set that no longer changes, (9)-(12) is linear in the error. In contact,
//! `y_i = (h a_i - sum A_ij y_j) / (A_ii + h r)` and `a_i <- a_i - r y_i`; elsewhere `y_i = - sum A_ij y_j / A_ii`, and
//! a is zero. Powers of this map grow like powers of its spectral radius. A vector for one r is the start for the next,
//! so that few iterations are enough.

use super::{Settings, Solver, solve};
use crate::discrete::grid::Grid;
use crate::discrete::network::{ContactRow, Network};
use crate::discrete::norms::largest;
use crate::levels::Problem;
use crate::problem::law::Law;
use crate::saddle::{self, Pair, Params, StopRule};

/// Relative change of a gap from block to block of iterations at which it is taken for settled.
const SETTLED: f64 = 1e-3;
/// Most blocks of iterations.
const BLOCKS: usize = 400;

/// Convergence of the paper's method on one grid.
#[derive(Clone, Debug)]
pub struct Convergence {
    /// Number of nodes in contact.
    pub contact: usize,
    /// One minus the spectral radius of one iteration, for each r.
    pub gaps: Vec<f64>,
    /// One minus the factor by which the changes of y shrink from one iteration to the next, once the contact set is
    /// that of the solution, from zero and with the r that is measured.
    pub measured: f64,
}

impl Problem {
    /// Computes the spectral radius of one iteration for each r, the largest first, and measures the method itself with
    /// `measured_r`, on the finest grid of the square. The central function of this module.
    ///
    /// # Errors
    /// A sentence if the problem is on a mesh, or cannot be solved, or a factor does not settle.
    pub fn convergence(&self, r: &[f64], measured_r: f64) -> Result<Convergence, String> {
        let case = Case::new(self)?;
        let mut pair = Pair::zero(&case.network);
        pair.y.fill(1.0);
        let gaps = r.iter().map(|&r| case.gap(r, &mut pair)).collect::<Result<_, _>>()?;
        let contact = case.held.iter().filter(|&&held| held).count();
        Ok(Convergence { contact, gaps, measured: case.measured(measured_r)? })
    }
}

/// Discrete problem with the contact set of its solution.
struct Case<'a> {
    grid: Grid,
    network: Network,
    load: &'a [f64],
    /// True at the boundary nodes with a positive multiplier.
    held: Vec<bool>,
}

impl<'a> Case<'a> {
    fn new(problem: &'a Problem) -> Result<Self, String> {
        let grid = problem.lattices().ok_or("convergence is known on the square")?.finest();
        let solved = solve(problem, &Settings::of(Solver::ActiveSet)).map_err(|e| e.to_string())?;
        let held = solved.pair().a.iter().map(|&a| a > 0.0).collect();
        let network = Network::of_square(grid, Law::SIGNORINI);
        Ok(Self { grid, network, load: problem.load(), held })
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
        self.network.sweep(load, y, |b, ContactRow { sum, diagonal, measure, .. }| {
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

    /// Takes this number of iterations of the method itself.
    fn advance(&self, r: f64, count: usize, pair: &mut Pair) {
        let (rule, tolerance) = (StopRule::PrintedDual, 0.0);
        let params = Params { r, rule, tolerance, max_iterations: count, ..Params::default() };
        saddle::solve((self.grid, Law::SIGNORINI), self.load, &params, pair);
    }

    /// One minus the factor of the method itself from zero, once its contact set stays the final one and the factor has
    /// settled.
    fn measured(&self, r: f64) -> Result<f64, String> {
        let mut pair = Pair::zero(&self.network);
        // Change of y in the last iteration of a block; one minus the factor of a block, NaN under another contact set
        // than the final one.
        let (mut change, mut gap) = (f64::NAN, f64::NAN);
        for _ in 0..BLOCKS {
            self.advance(r, self.block() - 1, &mut pair);
            let before = pair.y.clone();
            self.advance(r, 1, &mut pair);
            let changes: Vec<f64> = pair.y.iter().zip(&before).map(|(y, old)| y - old).collect();
            let now = largest(&changes);
            let next = self.gap_of(now / change);
            let is_final = pair.a.iter().zip(&self.held).all(|(&a, &held)| (a > 0.0) == held);
            if is_final && (next - gap).abs() <= SETTLED * next {
                return Ok(next);
            }
            // A factor under another contact set says nothing.
            (change, gap) = (now, if is_final { next } else { f64::NAN });
        }
        Err(format!("the method does not settle with r = {r}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::{Diagonal, LoadRule};

    #[test]
    fn each_iteration_converges_as_the_method_does_and_small_r_slows_it_down() {
        let r = [1e6, 1e4, 1e3, 100.0, 30.0, 10.0, 3.0, 1.0, 0.5, 0.2];
        for f in [F, "exact(free-corner)"] {
            let (grids, rule) =
                (vec![Grid::new(8).unwrap()], LoadRule::Exact { diagonal: Diagonal::default() });
            let problem = Problem::on_square(grids, f.parse().unwrap(), rule, Law::SIGNORINI);
            let Convergence { gaps, measured, .. } =
                problem.unwrap().convergence(&r, 10.0).unwrap();
            assert!(gaps.iter().all(|gap| (1e-4..1.0).contains(gap)), "{f}: {gaps:?}");
            assert!((measured / gaps[5] - 1.0).abs() < 0.02, "{f}: {measured} {gaps:?}");
            if f != F {
                // Of Uzawa's method on boundary values that alternate from node to node.
                let expected = 0.2 / 8.0 / 8f64.sqrt();
                assert!((gaps[9] / expected - 1.0).abs() < 0.06, "{gaps:?}");
            }
        }
    }

    /// f of the paper's second problem.
    const F: &str = "quadrant(ll)=-6; else=1.998";
}
