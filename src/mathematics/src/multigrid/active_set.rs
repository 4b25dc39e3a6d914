//! Primal-dual active set method with a direct solver, which checks multigrid.
//!
//! # Idea
//! This is the semismooth Newton method for `l = max(0, l - c y)`, with the multiplier `l`. For a nonsingular M-matrix
//! and a bound at every node it converges from every start in finitely many steps (Hintermüller, Ito and Kunisch 2002,
//! theorem 3.2). Here the matrix is singular, and only boundary values are bounded: convergence is observed, not
//! proved. Hence the limit on the number of steps, and the list of all contact sets so far.
//!
//! # Algorithm
//! 1. Take all boundary nodes to be in contact.
//! 2. Solve the linear problem with `y = 0` at the nodes in contact.
//! 3. Remove the nodes with a negative multiplier from the contact set, and add those with a negative value. If the set
//!    would be empty, keep the node with the largest multiplier: otherwise the next system is singular.
//! 4. Stop if the contact set has not changed, or has returned to an earlier one; otherwise go to step 2.
//!
//! # Cost
//! One banded Cholesky factorisation per step: `O(n^4)` operations and `O(n^3)` memory on the square, `O(n^7)`
//! and `O(n^5)` on the cube.

use super::MultigridStop;
use super::banded::Banded;
use super::input::{InputError, LoadStats, check_length};
use super::layout::Dimension;
use super::network::{Network, band};
use super::stencil::coupling;

/// Cells per side of the finest grid of the square whose matrix and factors are worth their memory: 270 MB.
pub const MOST_ON_SQUARE: usize = 256;
/// Cells per side of the finest grid of the cube whose matrix and factors are worth their memory: 160 MB.
pub const MOST_ON_CUBE: usize = 24;

/// Limit on the number of linear systems.
const MAX_STEPS: usize = 100;

/// Result of the active set method without the solution itself.
#[derive(Clone, Copy, Debug)]
pub struct ActiveSetOutcome {
    /// `Converged` if a step left the contact set as it was; `RoundingFloor` if a step led to an earlier contact set,
    /// which was seen only where multipliers or values are zero up to rounding errors.
    pub stop: MultigridStop,
    /// Number of linear systems solved.
    pub steps: usize,
}

/// Minimises `1/2 y'Ay - F'y` over `y >= 0` on the boundary; see [`solve_square`](super::solve_square) for `A` and the layout of
/// `load` and the solution. Starts from contact everywhere.
///
/// # Errors
/// If `n` is below 2, a length is wrong, a number is not finite, or the sum of the load is not negative.
pub fn active_set<D: Dimension>(
    n: usize,
    load: &[f64],
) -> Result<(Vec<f64>, ActiveSetOutcome), InputError> {
    if n < 2 {
        return Err(InputError::GridSize { cells: n, rule: "at least 2", nearest: vec![2] });
    }
    on_network(&Network::new(D::AXES, n, coupling::<D>(n)), band::<D>(n), load)
}

fn on_network(
    network: &Network,
    band: usize,
    load: &[f64],
) -> Result<(Vec<f64>, ActiveSetOutcome), InputError> {
    check_length(network.nodes(), load)?;
    LoadStats::measure(load).check()?;
    let (matrix, mut factor) = (network.matrix(band), Banded::zeros(network.nodes(), band));
    let mut active: Vec<_> = (0..load.len()).map(|k| network.is_constrained(k)).collect();
    let mut seen = Vec::new();
    let mut y = vec![0.0; load.len()];
    let mut steps = 0;
    let stop = loop {
        if steps == MAX_STEPS {
            break MultigridStop::CycleLimit;
        }
        y = solve(network, &matrix, &mut factor, load, &active);
        steps += 1;
        if !y.iter().all(|value| value.is_finite()) {
            break MultigridStop::Diverged;
        }
        let next = network.next_contact(&active, &y, load);
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
    Ok((y, ActiveSetOutcome { stop, steps }))
}

/// Solves `A y = F` with `y = 0` where `active`, with one step of iterative refinement.
///
/// `factor` is a buffer for the factors of the matrix without the rows of active nodes.
fn solve(
    network: &Network,
    matrix: &Banded,
    factor: &mut Banded,
    load: &[f64],
    active: &[bool],
) -> Vec<f64> {
    factor.copy_from(matrix);
    (0..active.len()).filter(|&node| active[node]).for_each(|node| factor.fix(node));
    factor.factor();
    let mut y = vec![0.0; active.len()];
    for _ in 0..2 {
        let mut correction = network.gradient(&y, load);
        for (value, active) in correction.iter_mut().zip(active) {
            *value = if *active { 0.0 } else { -*value };
        }
        factor.solve(&mut correction);
        y.iter_mut().zip(&correction).for_each(|(value, correction)| *value += correction);
    }
    y
}
