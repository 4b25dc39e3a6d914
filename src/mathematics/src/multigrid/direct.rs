//! Direct solution of the linear problems of a network, with nodes in contact held at zero.

use super::banded::Banded;
use crate::discrete::network::Network;

/// Order of the unknowns in the band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BandOrder {
    /// Numbers of the nodes: best on uniform grids.
    Natural,
    /// Reverse Cuthill-McKee, for other networks.
    Reordered,
}

/// Stiffness matrix of a network, and its factors for one set of held nodes.
pub(crate) struct Direct {
    /// Place of each node in the band.
    places: Vec<u32>,
    matrix: Banded,
    factors: Banded,
    /// Right-hand side and solution, in the order of the band.
    x: Vec<f64>,
}

impl Direct {
    pub(crate) fn new(network: &Network, order: BandOrder) -> Self {
        let nodes = network.nodes();
        let places = match order {
            BandOrder::Natural => (0..nodes as u32).collect(),
            BandOrder::Reordered => reverse_cuthill_mckee(network),
        };
        let mut band = 1;
        for_each_entry(network, &places, |row, column, _| band = band.max(row - column));
        let mut matrix = Banded::zeros(nodes, band);
        for_each_entry(network, &places, |row, column, weight| {
            *matrix.entry(row, column) = -weight;
        });
        for (&place, diagonal) in places.iter().zip(network.diagonal()) {
            *matrix.entry(place as usize, place as usize) = *diagonal;
        }
        Self { places, matrix, factors: Banded::zeros(nodes, band), x: vec![0.0; nodes] }
    }

    /// Number of multiplications of one factorisation.
    pub(crate) fn factor_work(&self) -> f64 {
        self.matrix.factor_work()
    }

    /// Number of multiplications of one solution.
    pub(crate) fn solve_work(&self) -> f64 {
        self.matrix.solve_work()
    }

    /// Number of multiplications of one step of the active set method: a factorisation, and a solution with refinement.
    pub(crate) fn step_work(&self) -> f64 {
        self.factor_work() + 2.0 * self.solve_work()
    }

    /// Number of bytes of the matrix and its factors.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<f64>() * (2 * self.factors.entries() + self.x.len())
    }

    /// Factors the matrix with these entries on the diagonal; where an entry is infinite the node is held at zero.
    pub(crate) fn factor(&mut self, diagonal: impl IntoIterator<Item = f64>) {
        self.factors.copy_from(&self.matrix);
        for (&place, diagonal) in self.places.iter().zip(diagonal) {
            let place = place as usize;
            if diagonal.is_finite() {
                *self.factors.entry(place, place) = diagonal;
            } else {
                self.factors.fix(place);
            }
        }
        self.factors.factor();
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

/// Calls `visit` with the row, the column and the weight of each coupling, the row being the greater place.
fn for_each_entry(network: &Network, places: &[u32], mut visit: impl FnMut(usize, usize, f64)) {
    for node in 0..network.nodes() {
        let row = network.row(node);
        for (&other, &weight) in row.others.iter().zip(row.weights) {
            let [one, two] = [node, other as usize].map(|node| places[node] as usize);
            if one > two {
                visit(one, two, weight);
            }
        }
    }
}

/// Returns the place of each node in an order in which coupled nodes are near each other: breadth first from a node
/// with few couplings in each connected component, reversed (Cuthill and McKee 1969; George 1971).
pub(crate) fn reverse_cuthill_mckee(network: &Network) -> Vec<u32> {
    let nodes = network.nodes();
    let degree = |node: u32| network.row(node as usize).others.len();
    let mut starts: Vec<u32> = (0..nodes as u32).collect();
    starts.sort_by_key(|&node| degree(node));
    let (mut order, mut seen) = (Vec::with_capacity(nodes), vec![false; nodes]);
    for start in starts {
        if seen[start as usize] {
            continue;
        }
        seen[start as usize] = true;
        order.push(start);
        let mut next = order.len() - 1;
        while next < order.len() {
            let before = order.len();
            for &other in network.row(order[next] as usize).others {
                if !seen[other as usize] {
                    seen[other as usize] = true;
                    order.push(other);
                }
            }
            order[before..].sort_by_key(|&node| degree(node));
            next += 1;
        }
    }
    let mut places = vec![0; nodes];
    for (place, node) in order.into_iter().rev().enumerate() {
        places[node as usize] = place as u32;
    }
    places
}
