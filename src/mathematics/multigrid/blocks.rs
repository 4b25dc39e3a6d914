//! Blocks of slabs that threads work on independently.

use std::ops::Range;

use super::buffers::Buffers;
use super::layout::{At, Dimension, boundary_before, nodes, slab};
use super::rows::{Colour, MIN_PLACES, Rows};
use super::stencil::{Boundary, Row, edges};
use super::transfer::Weighting;
use crate::discrete::simd::Largest;
use crate::discrete::threads::stays;

/// Slabs per block at least: half of them must hold what the longest pass leaves to the seams.
pub(super) const MIN_BLOCK: usize = 24;

/// How many blocks a pass over `n + 1` slabs is cut into.
pub(super) fn blocks<D: Dimension>(n: usize) -> usize {
    if stays(nodes::<D>(n)) {
        return 1;
    }
    let slabs = MIN_BLOCK.max(MIN_PLACES.div_ceil(slab::<D>(n)));
    (4 * rayon::current_num_threads()).min((n + 1) / slabs).max(1)
}

/// Slabs at which the grid is cut: all even, except the last, `n + 1`.
pub(super) struct Cuts(Vec<usize>);

impl Cuts {
    pub(super) fn new(n: usize, blocks: usize) -> Self {
        Self((0..blocks).map(|block| (block * n / blocks) & !1).chain([n + 1]).collect())
    }

    /// The cuts between blocks.
    pub(super) fn inner(&self) -> &[usize] {
        &self.0[1..self.0.len() - 1]
    }

    /// Cuts in the middle of the blocks: one piece around every inner cut.
    pub(super) fn middles(&self, n: usize) -> Self {
        let between = self.inner().windows(2).map(|pair| ((pair[0] + pair[1]) / 2) & !1);
        Self([0].into_iter().chain(between).chain([n + 1]).collect())
    }
}

/// What a pass over a grid may write.
pub(super) struct Target<'a> {
    pub(super) n: usize,
    pub(super) values: &'a mut [Rows; 2],
    pub(super) in_contact: &'a mut [bool],
    pub(super) coarse_load: &'a mut [Rows; 2],
    pub(super) buffers: &'a mut [Buffers],
}

impl Target<'_> {
    /// Everything, for one thread.
    pub(super) fn whole(&mut self) -> Block<'_> {
        let Self { n, values: [red, black], coarse_load: [coarse_red, coarse_black], .. } = self;
        Block {
            slabs: 0..*n + 1,
            values: [red, black],
            in_contact: self.in_contact,
            first_edge: 0,
            coarse_load: [coarse_red, coarse_black],
            buffers: &mut self.buffers[0],
        }
    }

    /// Hands each block its part.
    pub(super) fn split<D: Dimension>(&mut self, cuts: &Cuts) -> Vec<Block<'_>> {
        let Self { n, values: [red, black], coarse_load: [coarse_red, coarse_black], .. } = self;
        let (n, mut in_contact) = (*n, &mut *self.in_contact);
        let mut rest: [&mut [f64]; 4] = [red, black, coarse_red, coarse_black];
        let mut take = |k: usize, len: usize| {
            let (piece, left) = std::mem::take(&mut rest[k]).split_at_mut(len);
            rest[k] = left;
            piece
        };
        let mut block = |(pair, buffers): (&[usize], _)| {
            let slabs = pair[0]..pair[1];
            let fine = slabs.len() * slab::<D>(n);
            let coarse = (slabs.end.div_ceil(2) - slabs.start.div_ceil(2)) * slab::<D>(n / 2);
            let first_edge = boundary_before::<D>(n, slabs.start);
            let edges = boundary_before::<D>(n, slabs.end) - first_edge;
            let (contact, left) = std::mem::take(&mut in_contact).split_at_mut(edges);
            in_contact = left;
            Block {
                slabs,
                values: [take(0, fine), take(1, fine)],
                in_contact: contact,
                first_edge,
                coarse_load: [take(2, coarse), take(3, coarse)],
                buffers,
            }
        };
        cuts.0.windows(2).zip(self.buffers.iter_mut()).map(&mut block).collect()
    }
}

/// A run of slabs of both colours, with the coarse slabs it may write.
pub(super) struct Block<'a> {
    pub(super) slabs: Range<usize>,
    pub(super) values: [&'a mut [f64]; 2],
    in_contact: &'a mut [bool],
    /// Number of the first boundary node.
    first_edge: usize,
    coarse_load: [&'a mut [f64]; 2],
    pub(super) buffers: &'a mut Buffers,
}

impl Block<'_> {
    /// Residual and restriction of red slab `s`; `first` is the first slab that is restricted; `natural` takes in
    /// the natural residuals.
    #[inline(always)]
    pub(super) fn restrict<D: Weighting>(
        &mut self,
        (n, s, first): (usize, usize, usize),
        boundary: Boundary,
        load: [&[f64]; 2],
        natural: &mut Largest,
    ) {
        let slab = slab::<D>(n);
        let start = self.slabs.start;
        let [red, black] = &self.values;
        let own = (s - start) * slab..(s - start + 1) * slab;
        let (in_contact, first_edge) = (&mut *self.in_contact, self.first_edge);
        if let Boundary::Obstacle = boundary {
            for at in At::of_slab::<D>(n, s) {
                let black = &black[own.clone()][at.in_slab()];
                for (m, edge) in edges::<D>(at, Colour::Black) {
                    in_contact[edge.number - first_edge] = black[m] == 0.0;
                }
            }
        }
        let (red, target) = (&red[own], self.buffers.residuals(s));
        let mut see = |number: usize, contact| in_contact[number - first_edge] = contact;
        for at in At::of_slab::<D>(n, s) {
            let row = Row::new::<D>(at, Colour::Red, load[Colour::Red as usize], black, start);
            let (values, target) = (&red[at.in_slab()], &mut target[at.in_slab()]);
            row.residual::<D>(boundary, values, target, natural, &mut see);
        }
        let [coarse_red, coarse_black] = &mut self.coarse_load;
        let coarse_load = (start.div_ceil(2), [&mut **coarse_red, &mut **coarse_black]);
        self.buffers.restrict::<D>((n, s, first), coarse_load);
    }
}
