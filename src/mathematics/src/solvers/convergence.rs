//! Convergence of the paper's method: the spectral radius of one iteration on the contact set of the solution, and the
//! factor per iteration by which the method itself converges in the end.
//!
//! On a contact set that no longer changes, (9)-(12) is linear in the error. In contact,
//! `y_i = (h a_i - sum A_ij y_j) / (A_ii + h r)` and `a_i <- a_i - r y_i`; elsewhere `y_i = - sum A_ij y_j / A_ii`, and
//! a is zero. Powers of this map grow like powers of its spectral radius. A vector for one r is the start for the next,
//! so that few iterations are enough.

use super::{Settings, Solver, solve};
use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::discrete::network::{ContactRow, Network};
use crate::discrete::norms::largest;
use crate::levels::Problem;
use crate::problem::law::Law;
use crate::saddle::batch::{Lanes, Order};
use crate::saddle::{Engine, Goals, Method, Pair, RunStart, RunState, run};

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
    /// Number of iterations after which it was measured.
    pub iterations: usize,
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
        let (measured, iterations) = case.measured(measured_r)?;
        Ok(Convergence { contact, gaps, measured, iterations })
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

    /// One minus the factor of the method itself from zero, once its contact set stays the final one and the factor has
    /// settled; and the number of iterations.
    fn measured(&self, r: f64) -> Result<(f64, usize), String> {
        let (method, pair) = (Method::ArrowHurwicz, &Pair::zero(&self.network));
        let start = RunStart { load: self.load, method, r, pair };
        let mut lane = Lanes::<1, f64>::new(self.grid, Law::SIGNORINI, Order::Lexicographic, 1.0);
        lane.enter(0, &start);
        let state = RunState::new(&start, BLOCKS * self.block());
        let (change, gap) = (f64::NAN, f64::NAN);
        let mut goal = FactorGoal { case: self, last: Vec::new(), change, gap, end: None };
        run(&mut lane, [Some(state)], &mut goal);
        match goal.end.and_then(|end| end.count()) {
            Some(iterations) => Ok((goal.gap, iterations + 1)),
            None => Err(format!("the method does not settle with r = {r}")),
        }
    }
}

/// Goal of the method itself: that its factor settles from block to block of iterations.
struct FactorGoal<'a> {
    case: &'a Case<'a>,
    /// y before the last iteration of a block.
    last: Vec<f64>,
    /// Change of y in the last iteration of the last block.
    change: f64,
    /// One minus the factor of the last block; NaN under another contact set than the final one.
    gap: f64,
    end: Option<End>,
}

impl Goals<Lanes<1, f64>, 1> for FactorGoal<'_> {
    fn reached(&mut self, lane: &mut Lanes<1, f64>, runs: [Option<&RunState>; 1]) -> [bool; 1] {
        let (case, at) = (self.case, runs[0].map_or(1, |run| run.iterations % self.case.block()));
        if at + 1 == case.block() {
            self.last.clone_from(&lane.pair(0).y);
        }
        if at > 0 {
            return [false];
        }
        let pair = lane.pair(0);
        let changes: Vec<f64> = pair.y.iter().zip(&self.last).map(|(y, last)| y - last).collect();
        let now = largest(&changes);
        let gap = case.gap_of(now / self.change);
        let is_final = pair.a.iter().zip(&case.held).all(|(&a, &held)| (a > 0.0) == held);
        let is_settled = is_final && (gap - self.gap).abs() <= SETTLED * gap;
        // A factor under another contact set says nothing.
        (self.change, self.gap) = (now, if is_final { gap } else { f64::NAN });
        [is_settled]
    }

    fn ended(&mut self, _: &mut Lanes<1, f64>, _: usize, end: End) -> Option<RunState> {
        self.end = Some(end);
        None
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
