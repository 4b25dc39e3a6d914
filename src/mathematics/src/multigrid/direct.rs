//! Direct solution of the linear problems of a network, with nodes in contact held at zero.

use super::factors::{Factors, LowerEntry};
use super::order::minimum_degree;
use crate::discrete::network::Network;

/// Order of the unknowns in the factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FactorOrder {
    /// Numbers of the nodes: as good as others on small grids.
    Natural,
    /// Minimum degree, for all else.
    MinimumDegree,
}

/// Stiffness matrix of a network, and its factors for one set of held nodes.
pub(crate) struct Direct {
    /// Place of each node in the factors.
    places: Vec<u32>,
    factors: Factors,
    /// Diagonal, right-hand side or solution, in the order of the factors.
    x: Vec<f64>,
}

impl Direct {
    pub(crate) fn new(network: &Network, order: FactorOrder) -> Self {
        let nodes = network.nodes();
        let places = match order {
            FactorOrder::Natural => (0..nodes as u32).collect(),
            FactorOrder::MinimumDegree => minimum_degree(network),
        };
        let mut lower = Vec::new();
        for node in 0..nodes {
            let couplings = network.row(node);
            for (&other, &weight) in couplings.others.iter().zip(couplings.weights) {
                let [row, column] = [node, other as usize].map(|node| places[node]);
                if row > column {
                    lower.push(LowerEntry { row, column, value: -weight });
                }
            }
        }
        Self { places, factors: Factors::new(nodes, lower), x: vec![0.0; nodes] }
    }

    /// Number of multiplications of one factorisation.
    pub(crate) fn factor_work(&self) -> f64 {
        self.factors.factor_work()
    }

    /// Number of multiplications of one solution.
    pub(crate) fn solve_work(&self) -> f64 {
        self.factors.solve_work()
    }

    /// Number of multiplications of one step of the active set method: a factorisation, and a solution with refinement.
    pub(crate) fn step_work(&self) -> f64 {
        self.factor_work() + 2.0 * self.solve_work()
    }

    /// Number of bytes of the matrix and its factors.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<f64>() * self.x.len() + self.factors.bytes()
    }

    /// Factors the matrix with these entries on the diagonal; where an entry is infinite the node is held at zero.
    pub(crate) fn factor(&mut self, diagonal: impl IntoIterator<Item = f64>) {
        for (&place, diagonal) in self.places.iter().zip(diagonal) {
            self.x[place as usize] = diagonal;
        }
        self.factors.factor(&self.x);
    }

    /// Replaces a right-hand side by the solution; it must be zero at held nodes.
    pub(crate) fn solve(&mut self, values: &mut [f64]) {
        for (&place, value) in self.places.iter().zip(&*values) {
            self.x[place as usize] = *value;
        }
        self.factors.solve(&mut self.x);
        for (&place, value) in self.places.iter().zip(values) {
            *value = self.x[place as usize];
        }
    }
}
