//! Primal-dual active set method with a direct solver: the oracle for the multigrid method.
//!
//! # Idea
//! Guess the contact set, solve the linear problem with `y = 0` there, then drop the nodes with a
//! negative multiplier and add those with a negative value. This is the semismooth Newton method for
//! `l = max(0, l - c y)`. For a nonsingular M-matrix and a bound at every node it converges from every start
//! in finitely many steps (Hintermüller, Ito and Kunisch 2002, theorem 3.2). Here the matrix is singular and
//! only the boundary is bounded: one node is kept in contact, so that every step has a solution, and that the
//! contact set comes to rest is observed, not proved. Hence the limit on steps and the watch for a return.
//!
//! # Cost
//! One sparse Cholesky factorisation per step: `O(n^3)` operations and `O(n^2 log n)` memory on the square, `O(n^6)`
//! and `O(n^4)` on the cube.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Col, Side};

use super::MultigridStop;
use super::input::{InputError, LoadStats, check_length};
use super::layout::Dimension;
use super::network::Network;
use super::stencil::coupling;

/// Limit on the number of linear systems.
const MAX_STEPS: usize = 100;

/// Result without the solution itself.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// `Converged` if the contact set came to rest; `RoundingFloor` if it returned to an earlier one,
    /// which was seen only where multipliers or values are zero up to rounding errors.
    pub stop: MultigridStop,
    /// Linear systems solved.
    pub steps: usize,
}

/// Minimises `1/2 y'Ay - F'y` over `y >= 0` on the boundary; see [`solve`](super::solve) for `A` and the layout of
/// `load` and the solution. Starts from contact everywhere.
///
/// # Errors
/// If `n` is below 2, a length is wrong, a number is not finite, or the sum of the load is not negative.
pub fn active_set<D: Dimension>(n: usize, load: &[f64]) -> Result<(Vec<f64>, Outcome), InputError> {
    if n < 2 {
        return Err(InputError::GridSize(n, "at least 2"));
    }
    on_network(&Network::new(D::AXES, n, coupling::<D>(n)), load)
}

fn on_network(network: &Network, load: &[f64]) -> Result<(Vec<f64>, Outcome), InputError> {
    check_length(network.nodes(), load)?;
    LoadStats::measure(load).check()?;
    let system = System::new(network, load);
    let mut active: Vec<_> = (0..load.len()).map(|k| network.is_constrained(k)).collect();
    let mut seen = Vec::new();
    let mut y = vec![0.0; load.len()];
    let mut steps = 0;
    let stop = loop {
        if steps == MAX_STEPS {
            break MultigridStop::CycleLimit;
        }
        y = system.solve(&active);
        steps += 1;
        if !y.iter().all(|value| value.is_finite()) {
            break MultigridStop::Diverged;
        }
        let next = system.next_contact(&active, &y);
        if next == active {
            break MultigridStop::Converged;
        }
        if seen.contains(&next) {
            break MultigridStop::RoundingFloor;
        }
        seen.push(std::mem::replace(&mut active, next));
    };
    for (k, value) in y.iter_mut().enumerate() {
        if network.is_constrained(k) {
            *value = value.max(0.0);
        }
    }
    Ok((y, Outcome { stop, steps }))
}

/// The matrix of a network with a symbolic factorisation that serves every contact set.
struct System<'a> {
    network: &'a Network,
    load: &'a [f64],
    /// Lower triangle: in each column the diagonal, then the couplings in the order of the network.
    pattern: SymbolicSparseColMat<usize>,
    factorisation: SymbolicLlt<usize>,
}

impl<'a> System<'a> {
    fn new(network: &'a Network, load: &'a [f64]) -> Self {
        let size = load.len();
        let mut column_starts = vec![0];
        let mut rows = Vec::new();
        for k in 0..size {
            rows.push(k);
            rows.extend(network.couplings(k).map(|(row, _)| row));
            column_starts.push(rows.len());
        }
        let pattern = SymbolicSparseColMat::new_checked(size, size, column_starts, None, rows);
        let factorisation = SymbolicLlt::try_new(pattern.as_ref(), Side::Lower)
            .expect("the pattern is valid and fits into memory");
        Self { network, load, pattern, factorisation }
    }

    /// Solves `A y = F` with `y = 0` where `active`; one step of iterative refinement.
    fn solve(&self, active: &[bool]) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.pattern.row_idx().len());
        let diagonal = self.network.diagonal();
        for k in 0..active.len() {
            values.push(if active[k] { 1.0 } else { diagonal[k] });
            let entry = |(row, weight): (usize, f64)| {
                if active[k] || active[row] { 0.0 } else { -weight }
            };
            values.extend(self.network.couplings(k).map(entry));
        }
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), &values[..]);
        let factors = Llt::try_new_with_symbolic(self.factorisation.clone(), matrix, Side::Lower)
            .expect("positive definite: at least one node is in contact");
        let mut y = vec![0.0; active.len()];
        for _ in 0..2 {
            let gradient = self.network.gradient(&y, self.load);
            let residual =
                Col::from_fn(active.len(), |k| if active[k] { 0.0 } else { -gradient[k] });
            let correction = factors.solve(&residual);
            for (value, correction) in y.iter_mut().zip(correction.iter()) {
                *value += correction;
            }
        }
        y
    }

    /// Keeps contact where the multiplier is not negative, adds negative values.
    fn next_contact(&self, active: &[bool], y: &[f64]) -> Vec<bool> {
        let gradient = self.network.gradient(y, self.load);
        let keeps = |k: usize| match (self.network.is_constrained(k), active[k]) {
            (false, _) => false,
            (true, true) => gradient[k] >= 0.0,
            (true, false) => y[k] < 0.0,
        };
        let mut next: Vec<_> = (0..active.len()).map(keeps).collect();
        if !next.contains(&true) {
            let largest = (0..active.len())
                .filter(|&k| active[k])
                .max_by(|&a, &b| gradient[a].total_cmp(&gradient[b]));
            next[largest.expect("at least one node is in contact")] = true;
        }
        next
    }
}
