//! Rows of nodes along x with red and black nodes stored apart, the layout of the grids of a hierarchy: the five-point
//! stencil of a row needs the two neighbouring rows and no others. Numbers of the boundary nodes, and scratch memory of
//! a pass over a block of rows.

use crate::machine::simd::vectorised;
use crate::machine::threads::{TASK, in_tasks};
use rayon::prelude::*;
use std::ops::{Deref, DerefMut};

/// Colour of a node: red if the sum of its indices is even, otherwise black.
///
/// The corners are red because the number of cells per side is even.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colour {
    Red,
    Black,
}

impl Colour {
    #[inline(always)]
    pub(super) fn other(self) -> Self {
        match self {
            Colour::Red => Colour::Black,
            Colour::Black => Colour::Red,
        }
    }

    /// Column of the first node of this colour in row `j`: 0 in a long row, 1 in a short one.
    #[inline(always)]
    pub(super) fn first_column(self, j: usize) -> usize {
        (j + self as usize) & 1
    }
}

/// Number of places per row of one colour on a grid with `n` cells per side: `n / 2 + 1` nodes, rounded up to full
/// cache lines.
///
/// For the usual `n` this is an odd number of lines. With an even number the same places of all rows would compete for
/// the same few sets of the cache.
#[inline(always)]
pub(super) fn stride(n: usize) -> usize {
    (n / 2 + LINE) / LINE * LINE
}

/// Least number of places of one colour per task.
pub(super) const MIN_PLACES: usize = TASK / 2;
/// Least number of places of one colour that a loop works on at a time. Its data stay in the cache, and the setup of
/// the loop is shared by several short rows.
pub(super) const CHUNK: usize = 1 << 11;
/// Count of `f64` in a cache line.
pub(super) const LINE: usize = 8;

/// All rows of one colour. The first row starts at a cache line.
pub(super) struct ColourRows {
    storage: Vec<f64>,
    /// Index in `storage` at which the first row starts.
    first: usize,
}

impl ColourRows {
    pub(super) fn zeros(len: usize) -> Self {
        let storage = vec![0.0; len + LINE];
        let first = storage.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE);
        Self { storage, first }
    }
}

impl Deref for ColourRows {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        let end = self.storage.len() - LINE + self.first;
        &self.storage[self.first..end]
    }
}

impl DerefMut for ColourRows {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        let end = self.storage.len() - LINE + self.first;
        &mut self.storage[self.first..end]
    }
}

/// Rows of both colours as slices.
pub(super) fn as_slices(colours: &[ColourRows; 2]) -> [&[f64]; 2] {
    [&colours[0], &colours[1]]
}

/// Multiplies every number of both colours by `factor`.
pub(super) fn scale(colours: &mut [ColourRows; 2], factor: f64) {
    if factor != 1.0 {
        for_each(colours, |value| *value *= factor);
    }
}

/// Applies `change` to every number of both colours.
pub(super) fn for_each(colours: &mut [ColourRows; 2], change: impl Fn(&mut f64) + Sync) {
    for half in colours {
        in_tasks(half.par_iter_mut(), 1).for_each(&change);
    }
}

/// Copies red and black rows, multiplied by `factor`, into a field in natural order, rows of `n + 1` numbers.
///
/// # Panics
/// If `natural` does not have one number for each node.
pub(super) fn merge(n: usize, colours: &[ColourRows; 2], factor: f64, natural: &mut [f64]) {
    let (stride, rows) = (stride(n), CHUNK.div_ceil(stride(n)));
    assert_eq!(natural.len() * stride, colours[0].len() * (n + 1), "one number for each node");
    let [red, black] = colours.each_ref().map(|half| half.par_chunks(rows * stride));
    let chunks = red.zip(black).zip(natural.par_chunks_mut(rows * (n + 1))).enumerate();
    in_tasks(chunks, 2 * rows * stride).for_each(|(chunk, ((red, black), target))| {
        vectorised(
            #[inline(always)]
            || {
                let halves = red.chunks_exact(stride).zip(black.chunks_exact(stride));
                for (j, (halves, row)) in halves.zip(target.chunks_exact_mut(n + 1)).enumerate() {
                    let [long, short] = long_and_short(chunk * rows + j, halves.into());
                    interleave(long, short, row);
                }
                if factor != 1.0 {
                    target.iter_mut().for_each(|value| *value *= factor);
                }
            },
        );
    });
}

/// Orders the red and the black part of row `j` by length: a *long* row of a colour starts and ends on the boundary
/// and has `n / 2 + 1` nodes, a *short* row has one less.
#[inline(always)]
pub(super) fn long_and_short<T>(j: usize, [red, black]: [T; 2]) -> [T; 2] {
    if j.is_multiple_of(2) { [red, black] } else { [black, red] }
}

/// Sets `target` to `long[0], short[0], long[1], ..., long[last]`.
#[inline(always)]
pub(super) fn interleave(long: &[f64], short: &[f64], target: &mut [f64]) {
    let cells = target.len() / 2;
    let (long, end) = long.split_at(cells);
    for ((pair, &first), &second) in target.chunks_exact_mut(2).zip(long).zip(short) {
        pair[0] = first;
        pair[1] = second;
    }
    target[2 * cells] = end[0];
}

/// Splits `source` into `long` and `short`: the inverse of [`interleave`].
#[inline(always)]
pub(super) fn deinterleave(source: &[f64], long: &mut [f64], short: &mut [f64]) {
    let cells = source.len() / 2;
    let (long, end) = long.split_at_mut(cells);
    for ((pair, first), second) in source.chunks_exact(2).zip(long).zip(short) {
        *first = pair[0];
        *second = pair[1];
    }
    end[0] = source[2 * cells];
}

/// Part of the cell around node `i` that lies inside, along one axis.
#[inline(always)]
pub(super) fn share(n: usize, i: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

/// Neighbours `i - 1` and `i + 1`, mirrored at the boundary.
#[inline(always)]
pub(super) fn mirrored(n: usize, i: usize) -> [usize; 2] {
    [if i > 0 { i - 1 } else { 1 }, if i < n { i + 1 } else { n - 1 }]
}

/// Number of nodes of a grid.
pub(super) fn nodes(n: usize) -> usize {
    (n + 1) * (n + 1)
}

/// Number of boundary nodes of a grid. They are numbered in natural order.
pub(super) fn boundary_nodes(n: usize) -> usize {
    4 * n
}

/// Number of boundary nodes before row `j`, where `j` is at most `n + 1`.
pub(super) fn boundary_before(n: usize, j: usize) -> usize {
    if j > n { boundary_nodes(n) } else { GridRow { n, j }.first_boundary() }
}

/// Row `j`, from below, of a grid with `n` cells per side.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridRow {
    pub(super) n: usize,
    pub(super) j: usize,
}

impl GridRow {
    /// True if the row of this colour starts on the boundary and has `n / 2 + 1` nodes, one more than the row of the
    /// other colour.
    #[inline(always)]
    pub(super) fn is_long(self, colour: Colour) -> bool {
        colour.first_column(self.j) == 0
    }

    /// True if only the two ends of the row lie on the boundary.
    #[inline(always)]
    pub(super) fn is_inner(self) -> bool {
        0 < self.j && self.j < self.n
    }

    /// Part of the cells around the row that lies inside, across the row.
    #[inline(always)]
    pub(super) fn share(self) -> f64 {
        share(self.n, self.j)
    }

    /// Number of the first boundary node of the row. All nodes of the first and the last row are numbered, of any other
    /// row only the two ends.
    #[inline(always)]
    pub(super) fn first_boundary(self) -> usize {
        if self.j == 0 { 0 } else { self.n + 1 + 2 * (self.j - 1) }
    }

    /// The row of one colour, of which `rows` holds all rows from `first` on.
    #[inline(always)]
    pub(super) fn of(self, rows: &[f64], first: usize) -> &[f64] {
        &rows[(self.j - first) * stride(self.n)..][..stride(self.n)]
    }
}

/// Number of the boundary node `[i, j]`.
pub(super) fn boundary_number(n: usize, [i, j]: [usize; 2]) -> usize {
    let row = GridRow { n, j };
    row.first_boundary() + if row.is_inner() { usize::from(i == n) } else { i }
}

/// Scratch memory of a pass over one block of rows.
pub(super) struct Buffers {
    /// Residuals of the last three rows of red nodes; row `j` is at index `j % 3`.
    pub(super) residuals: [Vec<f64>; 3],
    /// Sums over coarse rows, at even columns.
    pub(super) even: Vec<f64>,
    /// Sums over coarse rows, at odd columns.
    pub(super) odd: Vec<f64>,
    /// A coarse row in natural order.
    pub(super) row: Vec<f64>,
}

impl Buffers {
    /// Allocates buffers for a grid with `n` cells per side.
    pub(super) fn new(n: usize) -> Self {
        let residuals = [(); 3].map(|()| vec![0.0; stride(n)]);
        let [even, odd, row] = [(); 3].map(|()| vec![0.0; n / 2 + 1]);
        Self { residuals, even, odd, row }
    }
}
