//! One grid of the hierarchy, red and black nodes stored apart.

use std::ops::{Deref, DerefMut};

use rayon::prelude::*;

/// Nodes `(i, j)` with `i + j` even are red, the others black.
///
/// The four corners are red because the number of cells per side is even.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colour {
    Red,
    Black,
}

impl Colour {
    pub(super) const BOTH: [Colour; 2] = [Colour::Red, Colour::Black];

    pub(super) fn other(self) -> Self {
        match self {
            Colour::Red => Colour::Black,
            Colour::Black => Colour::Red,
        }
    }

    /// Column of the first node of this colour in row `j`: 0 in a long row, 1 in a short one.
    pub(super) fn first_column(self, j: usize) -> usize {
        (j + self as usize) & 1
    }
}

/// Places per row of one colour on a grid of `n` by `n` cells.
///
/// `n / 2 + 1` nodes, rounded up to full cache lines. That makes it an odd number of lines for the
/// usual `n`; otherwise the same places of all rows would compete for the same few sets of the cache.
pub(super) fn stride(n: usize) -> usize {
    (n / 2 + 1).next_multiple_of(LINE)
}

/// Rows per task at least in loops over all rows.
const MIN_ROWS: usize = 64;
/// Numbers in a cache line.
pub(super) const LINE: usize = 8;

/// All rows of one colour, the first one at the start of a cache line.
pub(super) struct Rows {
    storage: Vec<f64>,
    first: usize,
}

impl Rows {
    fn zeros(len: usize) -> Self {
        let storage = vec![0.0; len + LINE];
        let first = storage.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE);
        Self { storage, first }
    }
}

impl Deref for Rows {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        let end = self.storage.len() - LINE + self.first;
        &self.storage[self.first..end]
    }
}

impl DerefMut for Rows {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        let end = self.storage.len() - LINE + self.first;
        &mut self.storage[self.first..end]
    }
}

/// Values and load on a grid of `n` by `n` cells.
///
/// Row `j` of a colour holds its nodes by growing column. A *long* row starts and ends on the boundary
/// and has `n / 2 + 1` nodes, a *short* row has one less. All neighbours of a node have the other
/// colour, and lie next to each other in memory, so that the five-point stencil becomes plain vector
/// arithmetic on contiguous slices.
pub(super) struct Level {
    pub(super) n: usize,
    /// Solution during nested iteration, correction while a finer level is being solved.
    pub(super) values: [Rows; 2],
    /// Load of the problem, or restricted residual while a finer level is being solved.
    pub(super) load: [Rows; 2],
    /// `max |load|` of the problem of this level.
    pub(super) load_scale: f64,
    /// 1 / (diagonal + spring) for each boundary node in perimeter order, 0 for a node in contact.
    pub(super) inverse_diagonal: Vec<f64>,
}

impl Level {
    pub(super) fn new(n: usize) -> Self {
        let zeros = || Rows::zeros((n + 1) * stride(n));
        Self {
            n,
            values: [zeros(), zeros()],
            load: [zeros(), zeros()],
            load_scale: 0.0,
            inverse_diagonal: Vec::new(),
        }
    }

    pub(super) fn stride(&self) -> usize {
        stride(self.n)
    }

    pub(super) fn nodes(&self) -> usize {
        (self.n + 1) * (self.n + 1)
    }

    fn locate(&self, i: usize, j: usize) -> (usize, usize) {
        ((i + j) & 1, j * self.stride() + i / 2)
    }

    pub(super) fn value(&self, i: usize, j: usize) -> f64 {
        let (colour, at) = self.locate(i, j);
        self.values[colour][at]
    }

    pub(super) fn set_value(&mut self, i: usize, j: usize, value: f64) {
        let (colour, at) = self.locate(i, j);
        self.values[colour][at] = value;
    }

    pub(super) fn load_at(&self, i: usize, j: usize) -> f64 {
        let (colour, at) = self.locate(i, j);
        self.load[colour][at]
    }

    /// Copies a row-major field of `(n + 1)^2` numbers into red and black rows; returns what
    /// `of_row` makes of each row, in order.
    pub(super) fn split<T: Send>(
        n: usize,
        natural: &[f64],
        colours: &mut [Rows; 2],
        of_row: impl Fn(&[f64]) -> T + Sync,
    ) -> Vec<T> {
        let stride = stride(n);
        let [red, black] = colours;
        let rows = red.par_chunks_exact_mut(stride).zip(black.par_chunks_exact_mut(stride));
        rows.zip(natural.par_chunks_exact(n + 1))
            .enumerate()
            .with_min_len(MIN_ROWS)
            .map(|(j, ((red, black), source))| {
                let [long, short] = long_and_short(j, [red, black]);
                deinterleave(source, long, short);
                of_row(source)
            })
            .collect()
    }

    /// Multiplies an array of both colours by a number.
    pub(super) fn scale(colours: &mut [Rows; 2], factor: f64) {
        for half in colours {
            half.par_iter_mut().with_min_len(1 << 14).for_each(|value| *value *= factor);
        }
    }

    /// Writes the values, times `factor`, as a row-major field of `(n + 1)^2` numbers.
    pub(super) fn merge_values(&self, factor: f64, natural: &mut [f64]) {
        let stride = self.stride();
        natural.par_chunks_exact_mut(self.n + 1).enumerate().with_min_len(MIN_ROWS).for_each(
            |(j, target)| {
                let row = j * stride..(j + 1) * stride;
                let [red, black] = [&self.values[0][row.clone()], &self.values[1][row]];
                let [long, short] = long_and_short(j, [red, black]);
                interleave(long, short, target);
                for value in target {
                    *value *= factor;
                }
            },
        );
    }

    /// The largest absolute value.
    pub(super) fn max_abs(&self) -> f64 {
        self.values.iter().map(|half| max_abs(half)).fold(0.0, worse)
    }

    /// Calls `visit(p, i, j)` for every boundary node, counter-clockwise from the corner (0, 0).
    pub(super) fn for_each_boundary_node(n: usize, mut visit: impl FnMut(usize, usize, usize)) {
        for k in 0..n {
            visit(k, k, 0);
        }
        for k in 0..n {
            visit(n + k, n, k);
        }
        for k in 0..n {
            visit(2 * n + k, n - k, n);
        }
        for k in 0..n {
            visit(3 * n + k, 0, n - k);
        }
    }

    /// Residual `F - A y` and diagonal of `A` at a boundary node.
    pub(super) fn boundary_residual(&self, i: usize, j: usize) -> (f64, f64) {
        let n = self.n;
        let along_x = if j == 0 || j == n { 0.5 } else { 1.0 };
        let along_y = if i == 0 || i == n { 0.5 } else { 1.0 };
        let (mut sum, mut diagonal) = (self.load_at(i, j), 0.0);
        let mut couple = |weight: f64, i: usize, j: usize| {
            sum += weight * self.value(i, j);
            diagonal += weight;
        };
        if i > 0 {
            couple(along_x, i - 1, j);
        }
        if i < n {
            couple(along_x, i + 1, j);
        }
        if j > 0 {
            couple(along_y, i, j - 1);
        }
        if j < n {
            couple(along_y, i, j + 1);
        }
        (sum - diagonal * self.value(i, j), diagonal)
    }
}

/// Orders what belongs to the red and the black part of row `j` by the kind of row.
#[inline(always)]
pub(super) fn long_and_short<T>(j: usize, [red, black]: [T; 2]) -> [T; 2] {
    if j.is_multiple_of(2) { [red, black] } else { [black, red] }
}

/// `target = long[0], short[0], long[1], ..., long[last]`.
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

/// The inverse of [`interleave`].
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

/// The larger number; NaN if one is.
#[inline(always)]
pub(super) fn worse(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// `max |x_i|`, NaN if a number is; independent lanes so that it vectorises.
#[inline(always)]
pub(super) fn max_abs(x: &[f64]) -> f64 {
    const LANES: usize = 8;
    let (mut largest, mut sums) = ([0.0_f64; LANES], [0.0; LANES]);
    let (chunks, tail) = x.as_chunks::<LANES>();
    for chunk in chunks {
        for lane in 0..LANES {
            let size = chunk[lane].abs();
            largest[lane] = if size > largest[lane] { size } else { largest[lane] };
            // A maximum forgets NaN, a sum does not.
            sums[lane] += size;
        }
    }
    let lanes =
        largest.into_iter().zip(sums).map(|(max, sum)| if sum.is_nan() { sum } else { max });
    lanes.chain(tail.iter().map(|value| value.abs())).fold(0.0, worse)
}
