//! Interpolation of nodal vectors between two levels; and springs, additions to the diagonals of coarser levels, where
//! fine nodes are held between coarse nodes that are not.

use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::Network;

/// Interpolation from the nodes of a coarser level to those of the next finer one.
pub(super) enum Interpolation<'a> {
    /// The nodes of the coarser level come first; each further node lies halfway between two of them.
    Midpoints(&'a NestedNetwork),
    /// Weights of coarser nodes at each node; none at fixed nodes.
    Weighted(WeightedRows),
}

/// Sparse matrix by rows: for each fine node, coarse nodes with their weights.
#[derive(Debug, Default)]
pub(super) struct WeightedRows {
    /// Position of the first entry of each row, and the number of all entries.
    starts: Vec<u32>,
    entries: Vec<WeightedNode>,
}

/// Coarse node with its weight at a fine one, or the other way round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WeightedNode {
    pub(super) node: u32,
    pub(super) weight: f64,
}

impl WeightedRows {
    pub(super) fn with_capacity(rows: usize, entries: usize) -> Self {
        let mut starts = Vec::with_capacity(rows + 1);
        starts.push(0);
        Self { starts, entries: Vec::with_capacity(entries) }
    }

    /// Adds the next row.
    pub(super) fn push(&mut self, row: &[WeightedNode]) {
        self.entries.extend_from_slice(row);
        self.starts.push(self.entries.len() as u32);
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    #[inline(always)]
    pub(super) fn row(&self, node: usize) -> &[WeightedNode] {
        &self.entries[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// All rows.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[WeightedNode]> {
        (0..self.len()).map(|node| self.row(node))
    }

    /// Transpose, with so many rows.
    pub(super) fn transposed(&self, rows: usize) -> Self {
        let mut starts = vec![0; rows + 1];
        for entry in &self.entries {
            starts[entry.node as usize + 1] += 1;
        }
        for row in 0..rows {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut entries = vec![WeightedNode { node: 0, weight: 0.0 }; self.entries.len()];
        for node in 0..self.len() {
            for entry in self.row(node) {
                let place = &mut next[entry.node as usize];
                entries[*place as usize] = WeightedNode { node: node as u32, weight: entry.weight };
                *place += 1;
            }
        }
        Self { starts, entries }
    }
}

impl Interpolation<'_> {
    /// Calls `visit` with the coarse nodes of a fine node and their weights.
    #[inline(always)]
    pub(super) fn for_each(&self, node: usize, mut visit: impl FnMut(usize, f64)) {
        match self {
            Self::Midpoints(fine) => match node.checked_sub(fine.coarse_nodes()) {
                None => visit(node, 1.0),
                Some(new) => {
                    fine.parents[new].iter().for_each(|&parent| visit(parent as usize, 0.5));
                }
            },
            Self::Weighted(rows) => {
                rows.row(node).iter().for_each(|entry| visit(entry.node as usize, entry.weight));
            }
        }
    }

    /// Interpolates a nodal vector of the coarser level.
    pub(super) fn interpolate(&self, coarse: &[f64]) -> Vec<f64> {
        match self {
            Self::Midpoints(fine) => fine.interpolate(coarse),
            Self::Weighted(rows) => rows.rows().map(|row| product(row, coarse)).collect(),
        }
    }

    /// Load vector of the coarser level, with so many nodes, that belongs to one of the finer level: the transpose of
    /// [`Interpolation::interpolate`].
    pub(super) fn restrict(&self, fine: &[f64], coarse_nodes: usize) -> Vec<f64> {
        match self {
            Self::Midpoints(level) => level.restrict(fine),
            Self::Weighted(rows) => {
                let mut coarse = vec![0.0; coarse_nodes];
                for (row, value) in rows.rows().zip(fine) {
                    for entry in row {
                        coarse[entry.node as usize] += entry.weight * value;
                    }
                }
                coarse
            }
        }
    }
}

/// Product of a row and a nodal vector of the coarser level.
#[inline(always)]
pub(super) fn product(row: &[WeightedNode], coarse: &[f64]) -> f64 {
    row.iter().map(|entry| entry.weight * coarse[entry.node as usize]).sum()
}

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
