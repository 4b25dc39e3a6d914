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
use super::direct::{BandOrder, Direct};
use super::input::{InputError, check_components, check_length};
use super::layout::Dimension;
use crate::discrete::cube;
use crate::discrete::grid::Grid;
use crate::discrete::network::{Network, count_components};

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
    /// Number of multiplications of the factorisations and solutions.
    pub work: f64,
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
    let fits = "the number of cells is at least 2";
    let network = match D::AXES {
        2 => Network::of_square(Grid::new(n).expect(fits)),
        _ => Network::of_cube(cube::Grid::new(n).expect(fits)),
    };
    on_network(&network, BandOrder::Natural, load)
}

/// Minimises `1/2 y'Ay - F'y` on any network, over `y >= 0` at its contact nodes and `y = 0` at its fixed nodes. Starts
/// from contact everywhere.
///
/// # Errors
/// If the length is wrong, a number is not finite, or without fixed nodes the sum of the load is not negative.
pub fn active_set_on(
    network: &Network,
    load: &[f64],
) -> Result<(Vec<f64>, ActiveSetOutcome), InputError> {
    on_network(network, BandOrder::Reordered, load)
}

fn on_network(
    network: &Network,
    order: BandOrder,
    load: &[f64],
) -> Result<(Vec<f64>, ActiveSetOutcome), InputError> {
    check_length(network.nodes(), load)?;
    let components = network.components();
    check_components(network, &components, load)?;
    let mut direct = Direct::new(network, order);
    let mut active = vec![false; load.len()];
    let held = network.contact().iter().map(|contact| contact.node).chain(network.fixed().to_vec());
    held.for_each(|node| active[node as usize] = true);
    let mut seen = Vec::new();
    let mut y = vec![0.0; load.len()];
    let mut steps = 0;
    let stop = loop {
        if steps == MAX_STEPS {
            break MultigridStop::CycleLimit;
        }
        solve(network, &mut direct, load, &active, &mut y);
        steps += 1;
        if !y.iter().all(|value| value.is_finite()) {
            break MultigridStop::Diverged;
        }
        let next = next_contact(network, &components, &active, &y, load);
        if next == active {
            break MultigridStop::Converged;
        }
        if seen.contains(&next) {
            break MultigridStop::RoundingFloor;
        }
        seen.push(std::mem::replace(&mut active, next));
    };
    for contact in network.contact() {
        let value = &mut y[contact.node as usize];
        *value = value.max(0.0);
    }
    let work = steps as f64 * (direct.factor_work() + 2.0 * direct.solve_work());
    Ok((y, ActiveSetOutcome { stop, steps, work }))
}

/// Replaces `y` by the solution of `A y = F` with `y = 0` where `active`, with one step of iterative refinement.
fn solve(network: &Network, direct: &mut Direct, load: &[f64], active: &[bool], y: &mut [f64]) {
    let diagonal = network.diagonal().iter().zip(active);
    direct.factor(diagonal.map(|(entry, active)| if *active { f64::INFINITY } else { *entry }));
    y.fill(0.0);
    let mut correction = vec![0.0; y.len()];
    for _ in 0..2 {
        network.gradient(y, load, &mut correction);
        for (value, active) in correction.iter_mut().zip(active) {
            *value = if *active { 0.0 } else { -*value };
        }
        direct.solve(&mut correction);
        y.iter_mut().zip(&correction).for_each(|(value, correction)| *value += correction);
    }
}

/// Returns the contact set of the next step of the primal-dual active set method, where `y` is the solution with contact
/// at the `active` nodes: active nodes whose multiplier is not negative, and other nodes whose value is negative. Fixed
/// nodes stay active.
///
/// If there are none in a connected component, the active node with the largest multiplier, so that no system is singular;
/// `components` has the component of each node.
pub(crate) fn next_contact(
    network: &Network,
    components: &[u32],
    active: &[bool],
    y: &[f64],
    load: &[f64],
) -> Vec<bool> {
    let mut next = vec![false; active.len()];
    let count = count_components(components);
    let mut largest = vec![(f64::NEG_INFINITY, None); count];
    let mut is_held = vec![false; count];
    for &node in network.fixed() {
        next[node as usize] = true;
        is_held[components[node as usize] as usize] = true;
    }
    for contact in network.contact() {
        let node = contact.node as usize;
        let component = components[node] as usize;
        let gradient = network.gradient_at(node, y, load);
        next[node] = if active[node] { gradient >= 0.0 } else { y[node] < 0.0 };
        is_held[component] |= next[node];
        if active[node] && gradient > largest[component].0 {
            largest[component] = (gradient, Some(node));
        }
    }
    for ((_, keep), is_held) in largest.into_iter().zip(is_held) {
        if let (Some(node), false) = (keep, is_held) {
            next[node] = true;
        }
    }
    next
}
