//! The discrete problem on any triangulation: nodes, the couplings between them, and their parts of the boundary.
//!
//! The energy of a nodal vector y is half the sum of `weight (y_i - y_j)^2` over all couplings, less `<F, y>`: the
//! stiffness matrix (5) has `-weight` beside the diagonal, and rows that sum to zero. In (7)-(12) the part of the boundary
//! at a node takes the place of h.

use super::cube;
use super::grid::Grid;

/// Node of the boundary where y must not be negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactNode {
    /// Number of the node.
    pub node: u32,
    /// Length or area of the boundary at the node: the integral of the hat function over the boundary in contact.
    pub measure: f64,
}

/// Coupling of two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Numbers of the nodes.
    pub nodes: [u32; 2],
    /// Minus the entry of the stiffness matrix (5).
    pub weight: f64,
}

/// Discrete problem without its load vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Position of the first coupling of each node in `others` and `weights`, and the number of all.
    starts: Vec<u32>,
    /// Coupled nodes, for each node in cyclic order from itself on: first those with higher numbers, then those with
    /// lower ones, both increasing. The order of additions is part of the method.
    others: Vec<u32>,
    /// Weights of the couplings.
    weights: Vec<f64>,
    /// Diagonal of the stiffness matrix.
    diagonal: Vec<f64>,
    /// Nodes in contact, in the order of a boundary vector.
    contact: Vec<ContactNode>,
    /// Nodes at which y = 0.
    fixed: Vec<u32>,
    /// Integrals of the hat functions over the domain, the lumped mass matrix.
    masses: Vec<f64>,
}

/// Row of the stiffness matrix without its diagonal.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    /// Numbers of the coupled nodes.
    pub others: &'a [u32],
    /// Weights of the couplings.
    pub weights: &'a [f64],
}

impl Row<'_> {
    /// Returns `start` plus the sum of weight times y over the coupled nodes, added from left to right.
    #[inline(always)]
    pub fn add_to(self, start: f64, y: &[f64]) -> f64 {
        let mut sum = start;
        for (&other, weight) in self.others.iter().zip(self.weights) {
            sum += weight * y[other as usize];
        }
        sum
    }
}

impl Network {
    /// Network of as many nodes as there are `masses`, with each coupling given once.
    ///
    /// # Panics
    /// If there are more couplings than 32 bits number, or a node does not exist.
    pub fn new(
        couplings: &[Coupling],
        contact: Vec<ContactNode>,
        fixed: Vec<u32>,
        masses: Vec<f64>,
    ) -> Self {
        let nodes = masses.len();
        assert!(2 * couplings.len() < u32::MAX as usize, "more couplings than 32 bits number");
        let mut starts = vec![0; nodes + 1];
        for node in couplings.iter().flat_map(|coupling| coupling.nodes) {
            starts[node as usize + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, 0.0); 2 * couplings.len()];
        for &Coupling { nodes: [one, two], weight } in couplings {
            for (node, other) in [(one, two), (two, one)] {
                let place = &mut next[node as usize];
                entries[*place as usize] = (other, weight);
                *place += 1;
            }
        }
        let mut diagonal = vec![0.0; nodes];
        for node in 0..nodes {
            let row = &mut entries[starts[node] as usize..starts[node + 1] as usize];
            row.sort_unstable_by_key(|&(other, _)| (other < node as u32, other));
            diagonal[node] = row.iter().map(|(_, weight)| weight).sum();
        }
        let (others, weights) = entries.into_iter().unzip();
        Self { starts, others, weights, diagonal, contact, fixed, masses }
    }

    /// Network of the five-point matrix of the square: the paper's triangulation, with nodes and boundary nodes in the
    /// order of [`Grid`].
    pub fn of_square(grid: Grid) -> Self {
        let (side, h) = (grid.side(), grid.h());
        let share = |i: usize| if i == 0 || i == grid.cells() { 0.5 } else { 1.0 };
        let (mut couplings, mut masses) = (Vec::new(), Vec::new());
        for (j, i) in (0..side).flat_map(|j| (0..side).map(move |i| (j, i))) {
            let node = grid.index(i, j) as u32;
            masses.push(share(i) * share(j) * h * h);
            if i + 1 < side {
                couplings.push(Coupling { nodes: [node, node + 1], weight: share(j) });
            }
            if j + 1 < side {
                couplings.push(Coupling { nodes: [node, node + side as u32], weight: share(i) });
            }
        }
        let contact = grid.boundary().map(|node| ContactNode { node: node as u32, measure: h });
        Self::new(&couplings, contact.collect(), Vec::new(), masses)
    }

    /// Network of the seven-point matrix of the cube, with nodes and boundary nodes in the order of [`cube::Grid`].
    pub fn of_cube(grid: cube::Grid) -> Self {
        let (side, h) = (grid.cells() + 1, grid.h());
        let share = |i: usize| if i == 0 || i == grid.cells() { 0.5 } else { 1.0 };
        let steps = [1, side, side * side];
        let (mut couplings, mut masses) = (Vec::new(), Vec::new());
        for (node, at) in grid.indices().enumerate() {
            masses.push(grid.share(at) * h.powi(3));
            for axis in (0..3).filter(|&axis| at[axis] + 1 < side) {
                let across = share(at[(axis + 1) % 3]) * share(at[(axis + 2) % 3]);
                let nodes = [node as u32, (node + steps[axis]) as u32];
                couplings.push(Coupling { nodes, weight: h * across });
            }
        }
        let node = |(node, measure)| ContactNode { node: node as u32, measure };
        Self::new(&couplings, grid.boundary_shares().map(node).collect(), Vec::new(), masses)
    }

    /// Number of nodes, the length of a nodal vector.
    pub fn nodes(&self) -> usize {
        self.diagonal.len()
    }

    /// Number of couplings.
    pub fn couplings(&self) -> usize {
        self.others.len() / 2
    }

    /// Nodes in contact, in the order of a boundary vector.
    pub fn contact(&self) -> &[ContactNode] {
        &self.contact
    }

    /// Nodes at which y = 0.
    pub fn fixed(&self) -> &[u32] {
        &self.fixed
    }

    /// Diagonal of the stiffness matrix.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Integrals of the hat functions.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Row of a node.
    #[inline(always)]
    pub fn row(&self, node: usize) -> Row<'_> {
        let range = self.starts[node] as usize..self.starts[node + 1] as usize;
        Row { others: &self.others[range.clone()], weights: &self.weights[range] }
    }

    /// Writes the gradient `A y - F` of the energy to `out`, all three nodal vectors.
    pub fn gradient(&self, y: &[f64], load: &[f64], out: &mut [f64]) {
        for (node, out) in out.iter_mut().enumerate() {
            *out = self.diagonal[node] * y[node] - self.row(node).add_to(load[node], y);
        }
    }

    /// Energy `1/2 <A y, y> - <F, y>`.
    pub fn energy(&self, y: &[f64], load: &[f64]) -> f64 {
        let mut energy = 0.0;
        for node in 0..self.nodes() {
            let flow = self.diagonal[node] * y[node] - self.row(node).add_to(0.0, y);
            energy += y[node] * (0.5 * flow - load[node]);
        }
        energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_the_square_are_those_of_the_paper() {
        let network = Network::of_square(Grid::new(4).unwrap());
        let row = |node: usize| {
            let Row { others, weights } = network.row(node);
            (network.diagonal()[node], others.to_vec(), weights.to_vec())
        };
        assert_eq!(row(12), (4.0, vec![13, 17, 7, 11], vec![1.0; 4]));
        assert_eq!(row(2), (2.0, vec![3, 7, 1], vec![0.5, 1.0, 0.5]));
        assert_eq!(row(24), (1.0, vec![19, 23], vec![0.5; 2]));
        assert_eq!(network.masses().iter().sum::<f64>(), 1.0);
    }

    #[test]
    fn the_cube_has_the_gradient_of_its_own_rows() {
        let grid = cube::Grid::new(3).unwrap();
        let network = Network::of_cube(grid);
        let y: Vec<_> = (0..64).map(|k| f64::from(k * k % 17)).collect();
        let load: Vec<_> = (0..64).map(|k| f64::from(k % 5)).collect();
        let judged = cube::judge(grid, &y, &load);
        let mut gradient = vec![0.0; 64];
        network.gradient(&y, &load, &mut gradient);
        for (contact, flux) in network.contact().iter().zip(&judged.flux) {
            assert!((gradient[contact.node as usize] - flux).abs() < 1e-13);
        }
        assert!((network.energy(&y, &load) - judged.energy).abs() < 1e-11 * judged.energy.abs());
    }
}
