//! One grid of the hierarchy, red and black nodes stored apart.

use super::buffers::Buffers;
use super::layout::{Dimension, boundary_nodes, nodes, slab};
use super::rows::{Rows, stride};
use crate::discrete::simd::{Largest, vectorised};

/// Values and load on a grid with `n` cells per side.
///
/// Loads are divided by the coupling of their node, that is by `h^(d - 2)` and the part of the cell around
/// the node that lies inside. Mirrored at the boundary, the stencil is then the same at all nodes: `2 d`
/// times the value, less the neighbours. All neighbours of a node have the other colour, and those of a row
/// lie in rows side by side, so that the stencil is plain arithmetic on contiguous slices.
pub struct Level {
    pub(super) n: usize,
    pub(super) nodes: usize,
    /// Places of one colour in a slab.
    slab: usize,
    /// Solution during nested iteration, correction while a finer level is being solved.
    pub(super) values: [Rows; 2],
    /// Load of the problem, or restricted residual while a finer level is being solved.
    pub(super) load: [Rows; 2],
    /// Largest absolute value of the load before the division.
    pub(super) load_scale: f64,
    /// `1 / (2 d + spring)` for each boundary node, 0 for a node in contact.
    pub(super) inverse_diagonal: Vec<f64>,
    /// The boundary nodes with `y = 0` and `A y >= F`, as the last restriction saw them.
    pub(super) in_contact: Vec<bool>,
    /// What passes need beside, for each block of slabs.
    pub(super) buffers: Vec<Buffers>,
}

impl Level {
    pub(super) fn new<D: Dimension>(n: usize) -> Self {
        let zeros = || Rows::zeros((n + 1) * slab::<D>(n));
        Self {
            n,
            nodes: nodes::<D>(n),
            slab: slab::<D>(n),
            values: [zeros(), zeros()],
            load: [zeros(), zeros()],
            load_scale: 0.0,
            inverse_diagonal: vec![0.0; boundary_nodes::<D>(n)],
            in_contact: vec![false; boundary_nodes::<D>(n)],
            buffers: Vec::new(),
        }
    }

    /// Makes room for this many blocks of slabs.
    pub(super) fn reserve(&mut self, blocks: usize) {
        let (n, slab) = (self.n, self.slab);
        self.buffers.resize_with(blocks.max(self.buffers.len()), || Buffers::new(n, slab));
    }

    /// Memory that one thread needs, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let halves = self.values.iter().chain(&self.load).map(|half| size_of_val(&half[..]));
        let buffers = self.buffers.first().map(Buffers::bytes);
        halves.chain(buffers).sum::<usize>()
            + size_of_val(&self.inverse_diagonal[..])
            + self.in_contact.len()
    }

    /// The value at node `k` in natural order.
    pub(super) fn value(&self, k: usize) -> f64 {
        let (colour, place) = locate(self.n, k);
        self.values[colour][place]
    }

    /// The largest absolute value.
    pub(super) fn max_abs(&self) -> f64 {
        vectorised(
            #[inline(always)]
            || {
                let mut largest = Largest::default();
                self.values.iter().for_each(|half| largest.see(1.0, half));
                largest.value()
            },
        )
    }
}

/// Colour and place of node `k` in natural order.
pub(super) fn locate(n: usize, k: usize) -> (usize, usize) {
    let (i, row) = (k % (n + 1), k / (n + 1));
    ((i + row) & 1, row * stride(n) + i / 2)
}
