//! The uniform grid of the square as a network.

use super::grid::Grid;
use super::network::{Coupling, Network};
use crate::problem::law::ContactNode;

impl Network {
    /// Network of the five-point matrix of the square: the paper's triangulation, with nodes and boundary nodes in the
    /// order of [`Grid`].
    pub fn of_square(grid: Grid) -> Self {
        Self::uniform(2, grid.cells(), 1.0, grid.contact_nodes())
    }

    /// Network of the stencil on two or three axes with `n` cells each, whose couplings inside are 1, with all boundary
    /// nodes in contact. Their measures are in units of `h^(axes - 1)`, as many as the parts of faces around the node.
    pub(crate) fn of_stencil(axes: usize, n: usize) -> Self {
        let mut network = Self::uniform(axes, n, 1.0, Vec::new());
        let inside = 2.0 * axes as f64;
        let on_boundary =
            network.diagonal().iter().enumerate().filter(|(_, entry)| **entry < inside);
        let node = |(node, entry): (usize, &f64)| {
            let share = entry / inside;
            ContactNode { node, measure: 2.0 * share * faces(share) }
        };
        let contact = on_boundary.map(node).collect();
        network.set_contact(contact);
        network
    }

    /// Network of the five- or seven-point stencil on two or three axes with `n` cells each, x fastest.
    ///
    /// Neighbours inside are coupled by `weight`, neighbours on the boundary by the part of `weight` that is the part
    /// of their cells inside.
    fn uniform(axes: usize, n: usize, weight: f64, contact: Vec<ContactNode>) -> Self {
        let side = [n + 1, n + 1, if axes == 3 { n + 1 } else { 1 }];
        let steps = [1, side[0], side[0] * side[1]];
        let share = |i: usize| if i == 0 || i == n { 0.5 } else { 1.0 };
        let volume = 1.0 / n.pow(axes as u32) as f64;
        let (mut couplings, mut masses) = (Vec::new(), Vec::new());
        for node in 0..side.iter().product() {
            let at: [usize; 3] = std::array::from_fn(|axis| node / steps[axis] % side[axis]);
            masses.push(at[..axes].iter().map(|&i| share(i)).product::<f64>() * volume);
            for axis in (0..axes).filter(|&axis| at[axis] < n) {
                let across: f64 = (0..axes)
                    .filter(|&other| other != axis)
                    .map(|other| share(at[other]))
                    .product();
                let nodes = [node as u32, (node + steps[axis]) as u32];
                couplings.push(Coupling { nodes, weight: weight * across });
            }
        }
        Self::new(&couplings, contact, Vec::new(), masses)
    }
}

/// Number of faces of the square or the cube on which a node lies, whose cell has this share inside: 1/2, 1/4 or 1/8.
#[inline(always)]
pub(crate) fn faces(share: f64) -> f64 {
    if share == 0.5 {
        1.0
    } else if share == 0.25 {
        2.0
    } else {
        3.0
    }
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
