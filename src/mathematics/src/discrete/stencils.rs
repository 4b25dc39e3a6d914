//! The uniform grid of the square as a network.

use super::grid::Grid;
use super::network::{Coupling, Network};
use crate::problem::law::ContactNode;

impl Network {
    /// Network of the five-point matrix of the square: the paper's triangulation, with nodes and boundary nodes in the
    /// order of [`Grid`].
    pub fn of_square(grid: Grid) -> Self {
        Self::uniform(grid.cells(), grid.contact_nodes())
    }

    /// Network of the five-point matrix with `n` cells per side, with all boundary nodes in contact. Their measures are
    /// in cells, as many as the halves of sides around the node.
    pub(crate) fn of_stencil(n: usize) -> Self {
        let mut network = Self::uniform(n, Vec::new());
        let mut contact = Vec::with_capacity(4 * n);
        for (node, entry) in network.diagonal().iter().enumerate() {
            let share = entry / 4.0;
            if share < 1.0 {
                contact.push(ContactNode { node, measure: 2.0 * share * sides(share) });
            }
        }
        network.set_contact(contact);
        network
    }

    /// Network of the five-point matrix with `n` cells per side, x fastest.
    ///
    /// Neighbours inside are coupled by 1, neighbours on the boundary by 1/2, the part of their cells inside.
    fn uniform(n: usize, contact: Vec<ContactNode>) -> Self {
        let share = |i: usize| if i == 0 || i == n { 0.5 } else { 1.0 };
        let area = 1.0 / n.pow(2) as f64;
        let (mut couplings, mut masses) = (Vec::new(), Vec::new());
        for j in 0..=n {
            for i in 0..=n {
                let node = (j * (n + 1) + i) as u32;
                masses.push(share(i) * share(j) * area);
                if i < n {
                    couplings.push(Coupling { nodes: [node, node + 1], weight: share(j) });
                }
                if j < n {
                    let above = node + n as u32 + 1;
                    couplings.push(Coupling { nodes: [node, above], weight: share(i) });
                }
            }
        }
        Self::new(&couplings, contact, Vec::new(), masses)
    }
}

/// Number of sides of the square on which a node lies whose cell has this share inside: 1/2, or 1/4 in a corner.
#[inline(always)]
pub(crate) fn sides(share: f64) -> f64 {
    if share == 0.5 { 1.0 } else { 2.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::network::Row;

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
}
