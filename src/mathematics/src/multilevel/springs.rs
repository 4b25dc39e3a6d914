//! Springs: additions to the diagonals of coarser levels, where fine nodes are held between coarse nodes that are not.

use super::interpolation::Interpolation;
use crate::discrete::network::Network;

/// Level with the nodes that are held, and the springs at the others.
pub(super) struct HeldLevel<'a> {
    pub(super) network: &'a Network,
    /// Interpolation from the next coarser level.
    pub(super) interpolation: &'a Interpolation<'a>,
    /// Flag for each node, true if it is held.
    pub(super) held: &'a [bool],
    /// Additions to the diagonal.
    pub(super) springs: &'a [f64],
}

/// Computes the springs of the next coarser level, whose nodes are held as `coarse_held` says; returns the work in
/// visits of unknowns.
///
/// Let u be the sum of the coarse functions that are not held. On the fine level it loses its values at the held
/// nodes: its energy, and that of each coarse function with it, is then another one than on the coarse level. A
/// spring at a coarse node is this difference for its function and u, so that the nearly constant corrections, on which
/// the problem without fixed nodes depends most, have the right size.
pub(super) fn set_coarse_springs(
    level: &HeldLevel<'_>,
    coarse_held: &[bool],
    coarse: &mut [f64],
) -> f64 {
    coarse.fill(0.0);
    let HeldLevel { network, interpolation, held, springs } = *level;
    let mut transfer = Transfer { interpolation, coarse_held, coarse };
    for (node, &spring) in springs.iter().enumerate() {
        if spring != 0.0 {
            transfer.add(node, spring * transfer.sum_of_functions(node));
        }
    }
    for contact in network.contact() {
        let node = contact.node;
        let of_node = transfer.sum_of_functions(node);
        if !held[node] || of_node == 0.0 {
            continue;
        }
        let row = network.row(node);
        let mut lost = network.diagonal()[node] * of_node;
        for (&other, weight) in row.others.iter().zip(row.weights) {
            let other = other as usize;
            lost -= weight * transfer.sum_of_functions(other);
            if !held[other] {
                transfer.add(other, weight * of_node);
            }
        }
        transfer.add(node, -lost);
    }
    for (spring, held) in coarse.iter_mut().zip(coarse_held) {
        if *held || *spring < 0.0 {
            *spring = 0.0;
        }
    }
    network.contact().len() as f64
}

/// Transfer between the nodes of a level and the next coarser one.
struct Transfer<'a> {
    interpolation: &'a Interpolation<'a>,
    /// Flag for each coarse node, true if it is held.
    coarse_held: &'a [bool],
    /// Values at the coarse nodes.
    coarse: &'a mut [f64],
}

impl Transfer<'_> {
    /// Value at a fine node of the sum of the coarse functions that are not held.
    fn sum_of_functions(&self, node: usize) -> f64 {
        let mut sum = 0.0;
        self.interpolation.for_each(node, |parent, weight| {
            if !self.coarse_held[parent] {
                sum += weight;
            }
        });
        sum
    }

    /// Adds the part of a fine node's value that each coarse function has.
    fn add(&mut self, node: usize, value: f64) {
        self.interpolation.for_each(node, |parent, weight| self.coarse[parent] += weight * value);
    }
}
