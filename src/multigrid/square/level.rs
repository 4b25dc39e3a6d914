//! One grid of the hierarchy, red and black nodes stored apart.

use crate::multigrid::rows::{Rows, max_abs, stride, worse};

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
