//! One grid of the hierarchy on the cube, red and black nodes stored apart.

use rayon::prelude::*;

use crate::multigrid::rows::{Colour, Rows, max_abs, stride, worse};

/// Grids with fewer cells per side are walked by one thread: waking the others takes longer.
const PARALLEL_FROM: usize = 32;

/// Values and load on a grid with `n` cells per side.
///
/// Row `(j, k)` holds the nodes of one colour along x; rows follow each other as in natural order. All
/// neighbours of a node have the other colour, and those of a row lie in five rows side by side.
///
/// Loads are divided by the coupling of their node, `h` times 1, 1/2, 1/4 or 1/8. Mirrored at the
/// boundary, the stencil is then the same at all nodes: six times the value, less six neighbours.
pub(super) struct Level {
    pub(super) n: usize,
    /// Solution during nested iteration, correction while a finer level is being solved.
    pub(super) values: [Rows; 2],
    /// Load of the problem, or restricted residual while a finer level is being solved.
    pub(super) load: [Rows; 2],
    /// Largest absolute value of the load before the division.
    pub(super) load_scale: f64,
    /// `1 / (6 + spring)` for each boundary node, 0 for a node in contact.
    pub(super) inverse_diagonal: Vec<f64>,
}

impl Level {
    pub(super) fn new(n: usize) -> Self {
        let zeros = || Rows::zeros((n + 1) * plane(n));
        Self {
            n,
            values: [zeros(), zeros()],
            load: [zeros(), zeros()],
            load_scale: 0.0,
            inverse_diagonal: Vec::new(),
        }
    }

    pub(super) fn nodes(&self) -> usize {
        (self.n + 1).pow(3)
    }

    fn locate(&self, [i, j, k]: [usize; 3]) -> (usize, usize) {
        ((i + j + k) & 1, (k * (self.n + 1) + j) * stride(self.n) + i / 2)
    }

    pub(super) fn value(&self, node: [usize; 3]) -> f64 {
        let (colour, at) = self.locate(node);
        self.values[colour][at]
    }

    pub(super) fn set_value(&mut self, node: [usize; 3], value: f64) {
        let (colour, at) = self.locate(node);
        self.values[colour][at] = value;
    }

    pub(super) fn load_at(&self, node: [usize; 3]) -> f64 {
        let (colour, at) = self.locate(node);
        self.load[colour][at]
    }

    /// The residual `load - 6 y + neighbours` at a node.
    pub(super) fn residual(&self, node: [usize; 3]) -> f64 {
        let mut sum = self.load_at(node) - 6.0 * self.value(node);
        for axis in 0..3 {
            for neighbour in mirrored(self.n, node[axis]) {
                let mut other = node;
                other[axis] = neighbour;
                sum += self.value(other);
            }
        }
        sum
    }

    /// The largest absolute value.
    pub(super) fn max_abs(&self) -> f64 {
        self.values.iter().map(|half| max_abs(half)).fold(0.0, worse)
    }
}

/// Places per plane of one colour.
pub(super) fn plane(n: usize) -> usize {
    (n + 1) * stride(n)
}

/// Places of row `(j, k)` in the rows of one colour.
#[inline(always)]
pub(super) fn row(n: usize, j: usize, k: usize) -> std::ops::Range<usize> {
    let (stride, number) = (stride(n), k * (n + 1) + j);
    number * stride..(number + 1) * stride
}

/// The neighbours `i - 1` and `i + 1`, mirrored at the boundary.
#[inline(always)]
pub(super) fn mirrored(n: usize, i: usize) -> [usize; 2] {
    [if i > 0 { i - 1 } else { 1 }, if i < n { i + 1 } else { n - 1 }]
}

/// Part of a cell around a node that lies inside the cube, along one axis.
#[inline(always)]
pub(super) fn share(n: usize, i: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

/// Calls `of_plane(k, plane)` for every plane, on all threads if that is worth it; returns the largest
/// result.
pub(super) fn for_each_plane(
    n: usize,
    rows: &mut [f64],
    of_plane: impl Fn(usize, &mut [f64]) -> f64 + Sync + Send,
) -> f64 {
    if n < PARALLEL_FROM {
        let planes = rows.chunks_exact_mut(plane(n)).enumerate();
        return planes.map(|(k, plane)| of_plane(k, plane)).fold(0.0, worse);
    }
    let planes = rows.par_chunks_exact_mut(plane(n)).enumerate();
    planes.map(|(k, plane)| of_plane(k, plane)).reduce(|| 0.0, worse)
}

/// The same for the planes of both colours together.
pub(super) fn for_each_pair_of_planes(
    n: usize,
    [red, black]: &mut [Rows; 2],
    of_planes: impl Fn(usize, [&mut [f64]; 2]) -> f64 + Sync + Send,
) -> f64 {
    if n < PARALLEL_FROM {
        let planes = red.chunks_exact_mut(plane(n)).zip(black.chunks_exact_mut(plane(n)));
        let results = planes.enumerate().map(|(k, (red, black))| of_planes(k, [red, black]));
        return results.fold(0.0, worse);
    }
    let planes = red.par_chunks_exact_mut(plane(n)).zip(black.par_chunks_exact_mut(plane(n)));
    let results = planes.enumerate().map(|(k, (red, black))| of_planes(k, [red, black]));
    results.reduce(|| 0.0, worse)
}

/// Whether the row `(j, k)` of this colour starts on the boundary, and has one node more.
#[inline(always)]
pub(super) fn is_long(colour: Colour, j: usize, k: usize) -> bool {
    colour.first_column(j + k) == 0
}
