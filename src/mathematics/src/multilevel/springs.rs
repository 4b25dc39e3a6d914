//! Springs: additions to the diagonals of coarser networks, where fine nodes are held between coarse nodes that are
//! not.

use crate::discrete::nested::NestedNetwork;

/// Nodes of a network that are held, and the springs at the others.
pub(super) struct HeldLevel<'a> {
    /// Flag for each node, true if it is held.
    pub(super) held: &'a [bool],
    /// Additions to the diagonal.
    pub(super) springs: &'a [f64],
}

/// Computes the springs of the network coarser than `level`; returns the work in visits of unknowns.
///
/// Let u be the sum of the coarse functions that are not held. On the fine network it loses its values at the held
/// nodes: its energy, and that of each coarse function with it, is then another one than on the coarse network. A
/// spring at a coarse node is this difference for its function and u, so that the nearly constant corrections, on which
/// the problem without fixed nodes depends most, have the right size.
pub(super) fn set_coarse_springs(
    level: &NestedNetwork,
    fine: &HeldLevel<'_>,
    coarse: &mut [f64],
) -> f64 {
    coarse.fill(0.0);
    let network = &level.network;
    let mut transfer = Transfer { level, held: fine.held, coarse };
    for contact in network.contact() {
        let node = contact.node;
        let of_node = transfer.sum_of_functions(node);
        if !fine.held[node] {
            transfer.add(node, fine.springs[node] * of_node);
            continue;
        }
        if of_node == 0.0 || node < transfer.coarse.len() {
            continue;
        }
        let row = network.row(node);
        let mut lost = network.diagonal()[node] * of_node;
        for (&other, weight) in row.others.iter().zip(row.weights) {
            let other = other as usize;
            lost -= weight * transfer.sum_of_functions(other);
            if !fine.held[other] {
                transfer.add(other, weight * of_node);
            }
        }
        transfer.add(node, -lost);
    }
    for (spring, held) in coarse.iter_mut().zip(fine.held) {
        if *held || *spring < 0.0 {
            *spring = 0.0;
        }
    }
    network.contact().len() as f64
}

/// Transfer between the nodes of a network and the next coarser one.
struct Transfer<'a> {
    level: &'a NestedNetwork,
    held: &'a [bool],
    /// Values at the coarse nodes.
    coarse: &'a mut [f64],
}

impl Transfer<'_> {
    /// Coarse nodes between which a node lies; `None` if it is a coarse node.
    fn parents(&self, node: usize) -> Option<[usize; 2]> {
        let new = node.checked_sub(self.coarse.len())?;
        Some(self.level.parents[new].map(|parent| parent as usize))
    }

    /// Value at a fine node of the sum of the coarse functions that are not held.
    fn sum_of_functions(&self, node: usize) -> f64 {
        let is_free = |node: usize| if self.held[node] { 0.0 } else { 1.0 };
        match self.parents(node) {
            None => is_free(node),
            Some([a, b]) => 0.5 * (is_free(a) + is_free(b)),
        }
    }

    /// Adds the part of a fine node's value that each coarse function has.
    fn add(&mut self, node: usize, value: f64) {
        match self.parents(node) {
            None => self.coarse[node] += value,
            Some(parents) => parents.into_iter().for_each(|node| self.coarse[node] += 0.5 * value),
        }
    }
}
