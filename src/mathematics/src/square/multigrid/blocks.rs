//! Blocks of rows on which threads work independently.

use std::ops::Range;

use super::rows::{
    Buffers, Colour, ColourRows, GridRow, MIN_PLACES, boundary_before, nodes, stride,
};
use super::stencil::{Boundary, ContactFlags, LevelEquation, ResidualReport, StencilRow, edges};
use super::transfer::CoarseLoad;
use crate::machine::simd::Largest;
use crate::machine::threads::stays;

/// Least number of rows per block: half of them must hold the rows that the longest pass leaves to the seams.
pub(super) const MIN_BLOCK: usize = 24;

/// Number of blocks into which a pass over `n + 1` rows is cut.
pub(super) fn blocks(n: usize) -> usize {
    if stays(nodes(n)) {
        return 1;
    }
    let rows = MIN_BLOCK.max(MIN_PLACES.div_ceil(stride(n)));
    (4 * rayon::current_num_threads()).min((n + 1) / rows).max(1)
}

/// Rows at which the grid is cut: all even, except the last, `n + 1`.
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
    /// One block with all rows, for one thread.
    pub(super) fn whole(&mut self) -> RowBlock<'_> {
        let Self { n, values: [red, black], coarse_load: [coarse_red, coarse_black], .. } = self;
        RowBlock {
            rows: 0..*n + 1,
            values: [red, black],
            contact: ContactFlags { flags: self.in_contact, first: 0 },
            coarse_load: [coarse_red, coarse_black],
            buffers: &mut self.buffers[0],
        }
    }

    /// Blocks between the cuts.
    pub(super) fn split(&mut self, cuts: &Cuts) -> Vec<RowBlock<'_>> {
        let Self { n, values: [red, black], coarse_load: [coarse_red, coarse_black], .. } = self;
        let n = *n;
        let [mut red, mut black]: [&mut [f64]; 2] = [red, black];
        let [mut coarse_red, mut coarse_black]: [&mut [f64]; 2] = [coarse_red, coarse_black];
        let mut in_contact = &mut *self.in_contact;
        let mut blocks = Vec::with_capacity(self.buffers.len());
        for (pair, buffers) in cuts.0.windows(2).zip(self.buffers.iter_mut()) {
            let rows = pair[0]..pair[1];
            let fine = rows.len() * stride(n);
            let coarse_rows = rows.end.div_ceil(2) - rows.start.div_ceil(2);
            let coarse = coarse_rows * stride(n / 2);
            let first = boundary_before(n, rows.start);
            let boundary_nodes = boundary_before(n, rows.end) - first;
            let flags = take_front(&mut in_contact, boundary_nodes);
            blocks.push(RowBlock {
                rows,
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

/// Consecutive rows of both colours, and the coarse rows that a pass over them may write.
pub(super) struct RowBlock<'a> {
    pub(super) rows: Range<usize>,
    pub(super) values: [&'a mut [f64]; 2],
    contact: ContactFlags<'a>,
    coarse_load: [&'a mut [f64]; 2],
    pub(super) buffers: &'a mut Buffers,
}

impl RowBlock<'_> {
    /// Computes the residual of a red row, restricts it, and sets the contact flags of the row.
    ///
    /// `first` is the first row that is restricted; `natural` collects the natural residuals under the law.
    #[inline(always)]
    pub(super) fn restrict(
        &mut self,
        row: GridRow,
        first: usize,
        equation: LevelEquation,
        natural: &mut Largest,
    ) {
        let LevelEquation { load, boundary } = equation;
        let (stride, start) = (stride(row.n), self.rows.start);
        let [red, black] = &self.values;
        let own = (row.j - start) * stride..(row.j - start + 1) * stride;
        // Local, so that the compiler keeps its fields in registers.
        let ContactFlags { flags, first: first_node } = &mut self.contact;
        let mut contact = ContactFlags { flags, first: *first_node };
        if let Boundary::Law { .. } = boundary {
            let black = &black[own.clone()];
            for (m, node) in edges(row, Colour::Black) {
                contact.set(node, black[m] == 0.0);
            }
        }
        let (red, target) = (&red[own], &mut self.buffers.residuals(row.j)[..stride]);
        let mut report = ResidualReport { natural, contact: Some(&mut contact) };
        let stencil = StencilRow::new(row, Colour::Red, load[Colour::Red as usize], black, start);
        stencil.residual(boundary, red, target, &mut report);
        let [red, black] = &mut self.coarse_load;
        let coarse_load = CoarseLoad { first: start.div_ceil(2), red, black };
        self.buffers.restrict(row, first, coarse_load);
    }
}
