//! A discrete problem as a network: nodes, the weights that couple them, and where `y >= 0` holds.
//!
//! The energy of values `y` is half the sum of `weight (y_k - y_m)^2` over all couplings, so that the
//! stiffness matrix has `-weight` beside the diagonal and rows that sum to zero. That is all a direct
//! method needs to know of a grid.

use super::banded::Banded;
use super::layout::Dimension;

/// How far apart the numbers of coupled nodes are at most.
pub(super) fn band<D: Dimension>(n: usize) -> usize {
    (n + 1).pow(D::AXES as u32 - 1)
}

/// Couplings of all nodes.
pub(super) struct Network {
    /// Where the couplings of each node begin, and the end.
    starts: Vec<usize>,
    /// The other node of a coupling, which has the higher number, and the weight.
    couplings: Vec<(usize, f64)>,
    constrained: Vec<bool>,
}

impl Network {
    /// The five- or seven-point stencil on two or three axes with `n` cells each, x fastest; `weight` couples neighbours inside, on the
    /// boundary the part of it that their cells have inside.
    pub(super) fn new(axes: usize, n: usize, weight: f64) -> Self {
        // No cells along an axis that does not exist.
        let cells = [n, n, if axes == 2 { 0 } else { n }];
        let ends = |axis: usize, i: usize| cells[axis] > 0 && (i == 0 || i == cells[axis]);
        let share = |axis: usize, i: usize| if ends(axis, i) { 0.5 } else { 1.0 };
        let step = [1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)];
        let mut network = Self { starts: vec![0], couplings: vec![], constrained: vec![] };
        for k in 0..=cells[2] {
            for j in 0..=cells[1] {
                for i in 0..=cells[0] {
                    let (at, own) = ([i, j, k], network.constrained.len());
                    for axis in (0..3).filter(|&axis| at[axis] < cells[axis]) {
                        let across = (0..3).filter(|&other| other != axis);
                        let share: f64 = across.map(|other| share(other, at[other])).product();
                        network.couplings.push((own + step[axis], share * weight));
                    }
                    network.starts.push(network.couplings.len());
                    network.constrained.push((0..3).any(|axis| ends(axis, at[axis])));
                }
            }
        }
        network
    }

    pub(super) fn nodes(&self) -> usize {
        self.constrained.len()
    }

    /// Whether the solution must not be negative at this node.
    pub(super) fn is_constrained(&self, node: usize) -> bool {
        self.constrained[node]
    }

    /// Couplings of a node to nodes with higher numbers, by growing number.
    pub(super) fn couplings(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        self.couplings[self.starts[node]..self.starts[node + 1]].iter().copied()
    }

    /// The diagonal of the stiffness matrix.
    pub(super) fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.nodes()];
        for node in 0..self.nodes() {
            for (other, weight) in self.couplings(node) {
                diagonal[node] += weight;
                diagonal[other] += weight;
            }
        }
        diagonal
    }

    /// The stiffness matrix, with this many couplings beside the diagonal at most.
    pub(super) fn matrix(&self, band: usize) -> Banded {
        let mut matrix = Banded::zeros(self.nodes(), band);
        for (node, diagonal) in self.diagonal().into_iter().enumerate() {
            *matrix.entry(node, node) = diagonal;
            for (other, weight) in self.couplings(node) {
                *matrix.entry(other, node) = -weight;
            }
        }
        matrix
    }

    /// The contact set of the next step of the primal-dual active set method, from the solution `y` with contact
    /// where `active`: keeps contact where the multiplier is not negative, adds negative values.
    ///
    /// The node with the largest multiplier is kept when all others leave, so that no system is singular.
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

    /// `A y - F`: where `y >= 0` is demanded, the reaction.
    pub(super) fn gradient(&self, y: &[f64], load: &[f64]) -> Vec<f64> {
        let mut gradient: Vec<_> = load.iter().map(|entry| -entry).collect();
        for node in 0..self.nodes() {
            for (other, weight) in self.couplings(node) {
                let flow = weight * (y[node] - y[other]);
                gradient[node] += flow;
                gradient[other] -= flow;
            }
        }
        gradient
    }
}
