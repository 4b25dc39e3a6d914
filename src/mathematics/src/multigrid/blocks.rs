//! Blocks of slabs on which threads work independently.

use std::ops::Range;

use super::buffers::Buffers;
use super::layout::{Dimension, Slab, boundary_before, nodes, places_per_slab};
use super::rows::{Colour, ColourRows, MIN_PLACES};
use super::stencil::{Boundary, ContactFlags, LevelEquation, ResidualReport, StencilRow, edges};
use super::transfer::{CoarseLoad, Weighting};
use crate::machine::simd::Largest;
use crate::machine::threads::stays;

/// Least number of slabs per block: half of them must hold the slabs that the longest pass leaves to the seams.
pub(super) const MIN_BLOCK: usize = 24;

/// Number of blocks into which a pass over `n + 1` slabs is cut.
pub(super) fn blocks<D: Dimension>(n: usize) -> usize {
    if stays(nodes::<D>(n)) {
        return 1;
    }
    let slabs = MIN_BLOCK.max(MIN_PLACES.div_ceil(places_per_slab::<D>(n)));
    (4 * rayon::current_num_threads()).min((n + 1) / slabs).max(1)
}

/// Slabs at which the grid is cut: all even, except the last, `n + 1`.
pub(super) struct Cuts(Vec<usize>);

impl Cuts {
    pub(super) fn new(n: usize, blocks: usize) -> Self {
        Self((0..blocks).map(|block| (block * n / blocks) & !1).chain([n + 1]).collect())
    }

    /// Cuts between blocks.
    pub(super) fn inner(&self) -> &[usize] {
        &self.0[1..self.0.len() - 1]
    }

    /// Cuts in the middle of the blocks: one block around every inner cut of these.
    pub(super) fn middles(&self, n: usize) -> Self {
        let between = self.inner().windows(2).map(|pair| usize::midpoint(pair[0], pair[1]) & !1);
        Self([0].into_iter().chain(between).chain([n + 1]).collect())
    }
}

/// Arrays that a pass over a grid writes.
pub(super) struct PassOutput<'a> {
    pub(super) n: usize,
    pub(super) values: &'a mut [ColourRows; 2],
    pub(super) in_contact: &'a mut [bool],
    pub(super) coarse_load: &'a mut [ColourRows; 2],
    pub(super) buffers: &'a mut [Buffers],
}

impl PassOutput<'_> {
    /// One block with all slabs, for one thread.
    pub(super) fn whole(&mut self) -> SlabBlock<'_> {
        let Self { n, values: [red, black], coarse_load: [coarse_red, coarse_black], .. } = self;
        SlabBlock {
            slabs: 0..*n + 1,
            values: [red, black],
            contact: ContactFlags { flags: self.in_contact, first: 0 },
            coarse_load: [coarse_red, coarse_black],
            buffers: &mut self.buffers[0],
        }
    }

    /// Blocks between the cuts.
    pub(super) fn split<D: Dimension>(&mut self, cuts: &Cuts) -> Vec<SlabBlock<'_>> {
        let Self { n, values: [red, black], coarse_load: [coarse_red, coarse_black], .. } = self;
        let n = *n;
        let [mut red, mut black]: [&mut [f64]; 2] = [red, black];
        let [mut coarse_red, mut coarse_black]: [&mut [f64]; 2] = [coarse_red, coarse_black];
        let mut in_contact = &mut *self.in_contact;
        let mut blocks = Vec::with_capacity(self.buffers.len());
        for (pair, buffers) in cuts.0.windows(2).zip(self.buffers.iter_mut()) {
            let slabs = pair[0]..pair[1];
            let fine = slabs.len() * places_per_slab::<D>(n);
            let coarse_slabs = slabs.end.div_ceil(2) - slabs.start.div_ceil(2);
            let coarse = coarse_slabs * places_per_slab::<D>(n / 2);
            let first = boundary_before::<D>(n, slabs.start);
            let boundary_nodes = boundary_before::<D>(n, slabs.end) - first;
            let flags = take_front(&mut in_contact, boundary_nodes);
            blocks.push(SlabBlock {
                slabs,
                values: [take_front(&mut red, fine), take_front(&mut black, fine)],
                contact: ContactFlags { flags, first },
                coarse_load: [
                    take_front(&mut coarse_red, coarse),
                    take_front(&mut coarse_black, coarse),
                ],
                buffers,
            });
        }
        blocks
    }
}

/// Cuts the first `len` items off a slice.
#[expect(clippy::mut_mut, reason = "the slice itself is shortened")]
fn take_front<'a, T>(rest: &mut &'a mut [T], len: usize) -> &'a mut [T] {
    let (front, left) = std::mem::take(rest).split_at_mut(len);
    *rest = left;
    front
}

/// Consecutive slabs of both colours, and the coarse slabs that a pass over them may write.
pub(super) struct SlabBlock<'a> {
    pub(super) slabs: Range<usize>,
    pub(super) values: [&'a mut [f64]; 2],
    contact: ContactFlags<'a>,
    coarse_load: [&'a mut [f64]; 2],
    pub(super) buffers: &'a mut Buffers,
}

impl SlabBlock<'_> {
    /// Computes the residual of a red slab, restricts it, and sets the contact flags of the slab.
    ///
    /// `first` is the first slab that is restricted; `natural` collects the natural residuals under the law.
    #[inline(always)]
    pub(super) fn restrict<D: Weighting>(
        &mut self,
        slab: Slab,
        first: usize,
        equation: LevelEquation,
        natural: &mut Largest,
    ) {
        let LevelEquation { load, boundary } = equation;
        let places = places_per_slab::<D>(slab.n);
        let start = self.slabs.start;
        let [red, black] = &self.values;
        let own = (slab.s - start) * places..(slab.s - start + 1) * places;
        // Local, so that the compiler keeps its fields in registers.
        let ContactFlags { flags, first: first_node } = &mut self.contact;
        let mut contact = ContactFlags { flags, first: *first_node };
        if let Boundary::Law { .. } = boundary {
            for at in slab.rows::<D>() {
                let black = &black[own.clone()][at.in_slab()];
                for (m, node) in edges::<D>(at, Colour::Black) {
                    contact.set(node, black[m] == 0.0);
                }
            }
        }
        let (red, target) = (&red[own], self.buffers.residuals(slab.s));
        let mut report = ResidualReport { natural, contact: Some(&mut contact) };
        for at in slab.rows::<D>() {
            let load = load[Colour::Red as usize];
            let row = StencilRow::new::<D>(at, Colour::Red, load, black, start);
            let (values, target) = (&red[at.in_slab()], &mut target[at.in_slab()]);
            row.residual::<D>(boundary, values, target, &mut report);
        }
        let [red, black] = &mut self.coarse_load;
        let coarse_load = CoarseLoad { first: start.div_ceil(2), red, black };
        self.buffers.restrict::<D>(slab, first, coarse_load);
    }
}
