//! Saddle-point methods for the modified Lagrange functional (7), and their run over nested grids.

pub mod batch;
mod gradient;
mod method;
mod network;
mod outcome;
mod plain;
mod stopping;
mod sweep;

pub use gradient::Duality;
pub use method::{Iteration, Method, OnIteration, Params, SaddleRun, Steps, arrow_hurwicz, solve};
pub use network::{NetworkRun, solve_network, solve_networks};
pub use outcome::Outcome;
pub use plain::{Plain, PlainEnd};
pub use stopping::StopRule;

use crate::discrete::grid::Grid;
use crate::discrete::kkt::rounding;
use crate::discrete::law_and_load::LawAndLoads;
use crate::discrete::network::Network;
use crate::discrete::norms::largest;
use crate::discrete::stop::Stop;
use crate::discrete::transfer::{Prolongation, prolong, prolong_boundary};
use crate::problem::law::Law;

/// The pair (y, a) of (7): values of v at the nodes, and of the multiplier at the boundary nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Nodal vector.
    pub y: Vec<f64>,
    /// Boundary vector; its entries are in the interval of the law, under the paper's law non-negative.
    pub a: Vec<f64>,
}

impl Pair {
    /// Returns the zero pair, from which the paper starts on its coarsest grid.
    pub fn zero(grid: Grid) -> Self {
        Self { y: vec![0.0; grid.nodes()], a: vec![0.0; grid.boundary_nodes()] }
    }

    /// Returns the zero pair of a network.
    pub fn zero_on(network: &Network) -> Self {
        Self { y: vec![0.0; network.nodes()], a: vec![0.0; network.contact().len()] }
    }

    /// Returns the linear interpolation of both components on the grid of half the width.
    pub fn prolonged(&self, grid: Grid, rule: Prolongation) -> Self {
        Self { y: prolong(grid, &self.y, rule), a: prolong_boundary(&self.a) }
    }

    /// Contact at the boundary nodes: where the multiplier is inside the interval of the law or v is zero, up to rounding
    /// errors. Under the paper's law both are zero in a corner without load between nodes in contact.
    pub fn in_contact(&self, grid: Grid, law: Law) -> Vec<bool> {
        let h = grid.h();
        let zero = rounding(grid.cells(), largest(&self.y).max(h * largest(&self.a)));
        let of_node =
            |(node, a): (usize, &f64)| law.is_inside(*a, zero / h) || self.y[node].abs() <= zero;
        grid.boundary().zip(&self.a).map(of_node).collect()
    }

    /// Contact at the nodes of a network, as [`Pair::in_contact`] has it at the boundary nodes of the square; nowhere else.
    pub fn in_contact_on(&self, network: &Network, law: Law) -> Vec<bool> {
        let forces = network.contact().iter().zip(&self.a).map(|(contact, a)| contact.measure * a);
        let forces: Vec<f64> = forces.collect();
        let cells = (network.nodes() as f64).sqrt() as usize;
        let zero = rounding(cells, largest(&self.y).max(largest(&forces)));
        let mut in_contact = vec![false; network.nodes()];
        for (contact, a) in network.contact().iter().zip(&self.a) {
            let node = contact.node;
            in_contact[node] =
                law.is_inside(*a, zero / contact.measure) || self.y[node].abs() <= zero;
        }
        in_contact
    }

    /// Multiplier at all nodes of a network, zero where there is no contact condition.
    pub fn multiplier_on(&self, network: &Network) -> Vec<f64> {
        let mut multiplier = vec![0.0; network.nodes()];
        for (contact, a) in network.contact().iter().zip(&self.a) {
            multiplier[contact.node] = *a;
        }
        multiplier
    }
}

/// Returns the paper's tolerance on its `level`-th grid, counted from 1: `10^-level`.
pub fn tolerance(level: usize) -> f64 {
    // A power of ten up to 10^22 is exact, so that the quotient is the double nearest to 10^-level.
    1.0 / 10f64.powi(level as i32)
}

/// Observer of a run over nested grids; every method has a default that does nothing.
pub trait Monitor {
    /// True if [`Monitor::iteration`] is to be called, which makes each iteration more expensive.
    fn wants_iterations(&self) -> bool {
        false
    }

    /// Called after each iteration on the grid of this level, counted from 1.
    fn iteration(&mut self, _level: usize, _iteration: &Iteration) {}

    /// Called after each grid, with its last pair.
    fn level(&mut self, _grid: Grid, _pair: &Pair) {}
}

/// The observer that does nothing.
impl Monitor for () {}

/// Solves on each of the nested `grids` in turn, starting from zero and then from the prolonged pair.
///
/// The k-th load vector is that on `grids[k]`. On the k-th grid `params.tolerance` is replaced by
/// [`tolerance`]`(k)`. Returns the outcome on each grid and the last pair; ends after a grid on which the
/// iteration diverged.
///
/// # Panics
/// If the grids are not as [`crate::discrete::grid::nested`] gives them, or a load vector has the wrong length.
pub fn solve_nested(
    grids: &[Grid],
    LawAndLoads { law, loads }: LawAndLoads<'_>,
    params: &Params,
    prolongation: Prolongation,
    monitor: &mut impl Monitor,
) -> (Vec<Outcome>, Pair) {
    on_nested(grids, loads, prolongation, |level, grid, load, pair| {
        let params = Params { tolerance: tolerance(level), ..*params };
        let watched = monitor.wants_iterations();
        let mut on_iteration = |iteration: &Iteration| monitor.iteration(level, iteration);
        let on_iteration = watched.then_some(&mut on_iteration as OnIteration);
        let outcome = solve(grid, law.with_load(load), &params, pair, on_iteration).outcome;
        monitor.level(grid, pair);
        (outcome, outcome.stop)
    })
}

/// Runs any method on each of the nested `grids` in turn, as [`solve_nested`] does.
///
/// `solve` receives the level, counted from 1, the grid, its load vector, and the pair to work on; it returns a result
/// and the reason for the end. Returns the results of all grids, and the last pair.
///
/// # Panics
/// If the grids are not as [`crate::discrete::grid::nested`] gives them.
pub fn on_nested<T>(
    grids: &[Grid],
    loads: &[Vec<f64>],
    prolongation: Prolongation,
    mut solve: impl FnMut(usize, Grid, &[f64], &mut Pair) -> (T, Stop),
) -> (Vec<T>, Pair) {
    let mut pair = Pair::zero(grids[0]);
    let mut kept = Vec::with_capacity(grids.len());
    for (k, (&grid, load)) in grids.iter().zip(loads).enumerate() {
        if k > 0 {
            pair = pair.prolonged(grids[k - 1], prolongation);
        }
        let (outcome, stop) = solve(k + 1, grid, load, &mut pair);
        kept.push(outcome);
        if stop == Stop::Diverged {
            break;
        }
    }
    (kept, pair)
}
