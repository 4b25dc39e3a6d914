//! A discrete problem as a network for direct solvers: nodes, weights that couple them, and the nodes with `y >= 0`.
//!
//! The energy of values `y` is half the sum of `weight (y_k - y_m)^2` over all couplings, so that the stiffness matrix
//! has `-weight` beside the diagonal and rows that sum to zero.

use super::banded::Banded;
use super::layout::Dimension;

/// Largest difference between the numbers of coupled nodes.
pub(super) fn band<D: Dimension>(n: usize) -> usize {
    (n + 1).pow(D::AXES as u32 - 1)
}

/// Couplings of all nodes.
pub(super) struct Network {
    /// Index of the first coupling of each node, and the number of all couplings.
    starts: Vec<usize>,
    couplings: Vec<Coupling>,
    /// Flag for each node, true if the solution must not be negative there.
    constrained: Vec<bool>,
}

/// Coupling of a node to a node with a higher number.
#[derive(Clone, Copy)]
pub(super) struct Coupling {
    /// Number of the other node.
    other: usize,
    weight: f64,
}

impl Network {
    /// Network of the five- or seven-point stencil on two or three axes with `n` cells each, x fastest.
    ///
    /// Neighbours inside are coupled by `weight`, neighbours on the boundary by the part of `weight` that is the part
    /// of their cells inside.
    pub(super) fn new(axes: usize, n: usize, weight: f64) -> Self {
        // No cells along an axis that does not exist.
        let cells = [n, n, if axes == 2 { 0 } else { n }];
        let step = [1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)];
        let mut network = Self { starts: vec![0], couplings: vec![], constrained: vec![] };
        for k in 0..=cells[2] {
            for j in 0..=cells[1] {
                for i in 0..=cells[0] {
                    let (at, own) = ([i, j, k], network.constrained.len());
                    for axis in (0..3).filter(|&axis| at[axis] < cells[axis]) {
                        let across = (0..3).filter(|&other| other != axis);
                        let share: f64 =
                            across.map(|other| share(cells[other], at[other])).product();
                        let other = own + step[axis];
                        network.couplings.push(Coupling { other, weight: share * weight });
                    }
                    network.starts.push(network.couplings.len());
                    network.constrained.push((0..3).any(|axis| is_end(cells[axis], at[axis])));
                }
            }
        }
        network
    }

    pub(super) fn nodes(&self) -> usize {
        self.constrained.len()
    }

    /// True if the solution must not be negative at this node.
    pub(super) fn is_constrained(&self, node: usize) -> bool {
        self.constrained[node]
    }

    /// Couplings of a node to nodes with higher numbers, in the order of these numbers.
    fn couplings(&self, node: usize) -> impl Iterator<Item = Coupling> {
        self.couplings[self.starts[node]..self.starts[node + 1]].iter().copied()
    }

    /// Diagonal of the stiffness matrix.
    pub(super) fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.nodes()];
        for node in 0..self.nodes() {
            for Coupling { other, weight } in self.couplings(node) {
                diagonal[node] += weight;
                diagonal[other] += weight;
            }
        }
        diagonal
    }

    /// Stiffness matrix, whose entries lie at most `band` places from the diagonal.
    pub(super) fn matrix(&self, band: usize) -> Banded {
        let mut matrix = Banded::zeros(self.nodes(), band);
        for (node, diagonal) in self.diagonal().into_iter().enumerate() {
            *matrix.entry(node, node) = diagonal;
            for Coupling { other, weight } in self.couplings(node) {
                *matrix.entry(other, node) = -weight;
            }
        }
        matrix
    }

    /// Contact set of the next step of the primal-dual active set method, where `y` is the solution with contact at the
    /// `active` nodes: active nodes whose multiplier is not negative, and other nodes whose value is negative.
    ///
    /// If there are none, the active node with the largest multiplier, so that no system is singular.
    pub(super) fn next_contact(&self, active: &[bool], y: &[f64], load: &[f64]) -> Vec<bool> {
        let gradient = self.gradient(y, load);
        let mut next = vec![false; active.len()];
        let (mut largest, mut keep) = (f64::NEG_INFINITY, None);
        for node in (0..active.len()).filter(|&node| self.is_constrained(node)) {
            next[node] = if active[node] { gradient[node] >= 0.0 } else { y[node] < 0.0 };
            if active[node] && gradient[node] > largest {
                (largest, keep) = (gradient[node], Some(node));
            }
        }
        if !next.contains(&true) {
            keep.into_iter().for_each(|node| next[node] = true);
        }
        next
    }

    /// Gradient `A y - F` of the energy, which is the multiplier at nodes in contact.
    pub(super) fn gradient(&self, y: &[f64], load: &[f64]) -> Vec<f64> {
        let mut gradient: Vec<_> = load.iter().map(|entry| -entry).collect();
        for node in 0..self.nodes() {
            for Coupling { other, weight } in self.couplings(node) {
                let flow = weight * (y[node] - y[other]);
                gradient[node] += flow;
                gradient[other] -= flow;
            }
        }
        gradient
    }
}

/// True if an axis with this number of cells has an end at node `i`; an axis without cells has none.
fn is_end(cells: usize, i: usize) -> bool {
    cells > 0 && (i == 0 || i == cells)
}

/// Part of the cell around node `i` that lies inside, along an axis with this number of cells.
fn share(cells: usize, i: usize) -> f64 {
    if is_end(cells, i) { 0.5 } else { 1.0 }
}
