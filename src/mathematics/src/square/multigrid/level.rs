//! One grid of the hierarchy, with red and black nodes stored apart.

use super::rows::{Buffers, Colour, ColourRows, boundary_nodes, nodes, stride};
use crate::machine::simd::{Largest, vectorised};

/// Values and load on a grid with `n` cells per side.
///
/// Each entry of the load is divided by the part of the cell around its node that lies inside. With values mirrored at
/// the boundary the stencil is then the same at all nodes: four times the value, less the neighbours. All neighbours of
/// a node have the other colour, and the neighbours of a row of nodes lie in contiguous rows, so that the stencil is
/// plain arithmetic on contiguous slices.
pub(super) struct MultigridLevel {
    pub(super) n: usize,
    pub(super) nodes: usize,
    /// Red and black values: the solution during nested iteration, the correction while a finer level is being solved.
    pub(super) values: [ColourRows; 2],
    /// Red and black load: of the problem, or the restricted residual while a finer level is being solved.
    pub(super) load: [ColourRows; 2],
    /// Largest absolute value of the load before the division by the shares of the nodes.
    pub(super) load_scale: f64,
    /// Limit of the flux into a node on one side, in units of the load; infinite for the paper's law.
    pub(super) limit: f64,
    /// `1 / (4 + spring)` for each boundary node, 0 for a node in contact.
    pub(super) inverse_diagonal: Vec<f64>,
    /// Flag for each boundary node, true if `y = 0` and the flux inside the law's interval at the last restriction.
    pub(super) in_contact: Vec<bool>,
    /// Scratch memory for each block of rows.
    pub(super) buffers: Vec<Buffers>,
}

impl MultigridLevel {
    pub(super) fn new(n: usize) -> Self {
        let places = (n + 1) * stride(n);
        Self {
            n,
            nodes: nodes(n),
            values: [ColourRows::zeros(places), ColourRows::zeros(places)],
            load: [ColourRows::zeros(places), ColourRows::zeros(places)],
            load_scale: 0.0,
            limit: f64::INFINITY,
            inverse_diagonal: vec![0.0; boundary_nodes(n)],
            in_contact: vec![false; boundary_nodes(n)],
            buffers: Vec::new(),
        }
    }

    /// Allocates scratch memory for at least this many blocks of rows.
    pub(super) fn reserve(&mut self, blocks: usize) {
        let n = self.n;
        self.buffers.resize_with(blocks.max(self.buffers.len()), || Buffers::new(n));
    }

    /// Value at node `k` in natural order.
    pub(super) fn value(&self, k: usize) -> f64 {
        let Location { colour, place } = Location::of_node(self.n, k);
        self.values[colour as usize][place]
    }

    /// Largest absolute value.
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

/// Location of a node in the memory of a grid.
#[derive(Clone, Copy)]
pub(super) struct Location {
    pub(super) colour: Colour,
    /// Place in the rows of this colour.
    pub(super) place: usize,
}

impl Location {
    /// Location of node `k` in natural order.
    pub(super) fn of_node(n: usize, k: usize) -> Self {
        let (i, row) = (k % (n + 1), k / (n + 1));
        let colour = if (i + row).is_multiple_of(2) { Colour::Red } else { Colour::Black };
        Self { colour, place: row * stride(n) + i / 2 }
    }
}
