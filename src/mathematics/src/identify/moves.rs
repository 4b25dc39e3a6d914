//! Greatest moves of the measure of the stopping rule on the coarsest grid when the values of f move: with them, one
//! run discards all f near its own.
//!
//! The iterates are continuous in f, and linear in parts: of each step the greatest slopes of its parts, all of one
//! sign, make a step for bounds on the moves. From zero such bounds hold for all f.

use super::grid;
use super::variant::{ResidualTime, Variant};
use crate::discrete::network::Network;
use crate::problem::law::Law;
use crate::saddle::batch::Order;

/// Iterations on the coarsest grid after which no run is asked for those near it: the bounds grow with each.
pub(super) const MOST_ITERATIONS: usize = 32;

/// Returns, for each of the first iterations with r, how far the measure moves at most if no value of f moves by more
/// than one; `basis` has the load vector of the indicator of each piece.
pub(super) fn greatest_moves(
    variant: &Variant,
    r: f64,
    basis: &[Vec<f64>],
    iterations: usize,
) -> Vec<f64> {
    let grid = grid(0);
    let network = &Network::of_square(grid, Law::SIGNORINI);
    let load = (0..grid.nodes()).map(|node| basis.iter().map(|piece| piece[node].abs()).sum());
    let mut corner = vec![1.0; grid.nodes()];
    for (b, node) in grid.boundary().enumerate() {
        if grid.is_corner(b) {
            corner[node] = variant.corner_weight();
        }
    }
    let order = order(network, variant.order);
    let time = variant.residual;
    let mut moves = Moves {
        network,
        r,
        weights: corner.into_iter().map(|weight| grid.h() * weight).collect(),
        load: load.collect(),
        y: vec![0.0; grid.nodes()],
        a: vec![0.0; grid.boundary_nodes()],
    };
    (0..iterations).map(|_| moves.iterate(&order, time)).collect()
}

/// The nodes in the order of a sweep.
fn order(network: &Network, order: Order) -> Vec<usize> {
    let nodes = 0..network.nodes();
    let (inner, boundary): (Vec<_>, Vec<_>) =
        nodes.clone().partition(|&node| network.place(node).is_none());
    match order {
        Order::Lexicographic => nodes.collect(),
        Order::BoundaryFirst => [boundary, inner].concat(),
        Order::InteriorFirst => [inner, boundary].concat(),
    }
}

/// Bounds on the moves of load and iterates.
struct Moves<'a> {
    network: &'a Network,
    r: f64,
    /// Weight of the multiplier in (7) at each node of the boundary.
    weights: Vec<f64>,
    load: Vec<f64>,
    y: Vec<f64>,
    a: Vec<f64>,
}

impl Moves<'_> {
    /// Bounds after one more iteration; returns the bound of the measure.
    fn iterate(&mut self, order: &[usize], time: ResidualTime) -> f64 {
        let before = self.a.clone();
        for &node in order {
            self.relax(node);
        }
        let multiplier = match time {
            ResidualTime::AfterDual => &self.a,
            ResidualTime::BeforeDual => &before,
        };
        let at = |node| self.gradient(node, multiplier);
        (0..self.y.len()).map(at).fold(0.0, f64::max)
    }

    /// (9)-(11) at a node, and there (12), in which y is what it was in the sweep: a sum of load and neighbours that is
    /// large lifts y off the boundary and makes a zero, any other leaves y and a - r y as the second formulas have
    /// them.
    fn relax(&mut self, node: usize) {
        let sum = self.network.row(node).add_to(self.load[node], &self.y);
        let diagonal = self.network.diagonal()[node];
        self.y[node] = sum / diagonal;
        if let Some(b) = self.network.place(node) {
            let (h, r) = (self.weights[node], self.r);
            let a = self.a[b];
            self.y[node] += h * a / (diagonal + h * r);
            self.a[b] = (diagonal * a + r * sum) / (diagonal + h * r);
        }
    }

    /// Bound of a component of the gradient (8).
    fn gradient(&self, node: usize, multiplier: &[f64]) -> f64 {
        let y = self.network.diagonal()[node] * self.y[node];
        let gradient = self.network.row(node).add_to(self.load[node] + y, &self.y);
        let pull = |b: usize| self.weights[node] * (multiplier[b] + self.r * self.y[node]);
        self.network.place(node).map_or(gradient, |b| gradient + pull(b))
    }
}
