//! How nodes lie in memory and how boundary nodes are numbered, on the square and on the cube.
//!
//! Nodes lie in *rows* along x, and rows in *slabs*: a slab is a row of the square, a plane of the cube.
//! The five- or seven-point stencil of a slab needs the slabs beside it and no others.

use std::ops::Range;

use super::rows::{Colour, stride};

/// The number of axes, as a type.
pub trait Dimension: Send + Sync + 'static {
    const AXES: usize;
}

/// Part of a cell around a node that lies inside, along one axis.
#[inline(always)]
pub(super) fn share(n: usize, i: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

/// The neighbours `i - 1` and `i + 1`, mirrored at the boundary.
#[inline(always)]
pub(super) fn mirrored(n: usize, i: usize) -> [usize; 2] {
    [if i > 0 { i - 1 } else { 1 }, if i < n { i + 1 } else { n - 1 }]
}

/// Rows in a slab.
#[inline(always)]
pub(super) fn rows_per_slab<D: Dimension>(n: usize) -> usize {
    if D::AXES == 2 { 1 } else { n + 1 }
}

/// Places of one colour in a slab.
#[inline(always)]
pub(super) fn slab<D: Dimension>(n: usize) -> usize {
    rows_per_slab::<D>(n) * stride(n)
}

/// Nodes of a grid.
pub(super) fn nodes<D: Dimension>(n: usize) -> usize {
    (n + 1).pow(D::AXES as u32)
}

/// Boundary nodes of a grid: they are numbered in natural order.
pub(super) fn boundary_nodes<D: Dimension>(n: usize) -> usize {
    nodes::<D>(n) - (n - 1).pow(D::AXES as u32)
}

/// Boundary nodes before slab `s`.
#[inline(always)]
pub(super) fn boundary_before<D: Dimension>(n: usize, s: usize) -> usize {
    let (whole, between) = if D::AXES == 2 { (n + 1, 2) } else { ((n + 1) * (n + 1), 4 * n) };
    if s == 0 { 0 } else { whole + (s.min(n) - 1) * between + if s > n { whole } else { 0 } }
}

/// A row: `r` counts the rows of slab `s`.
#[derive(Clone, Copy, Debug)]
pub struct At {
    pub(super) n: usize,
    pub(super) r: usize,
    pub(super) s: usize,
}

impl At {
    /// The rows of slab `s`.
    #[inline(always)]
    pub(super) fn of_slab<D: Dimension>(n: usize, s: usize) -> impl Iterator<Item = Self> {
        (0..rows_per_slab::<D>(n)).map(move |r| Self { n, r, s })
    }

    /// Places of this row in one colour of its slab.
    #[inline(always)]
    pub(super) fn in_slab(self) -> Range<usize> {
        self.r * stride(self.n)..(self.r + 1) * stride(self.n)
    }

    /// Whether the row of this colour starts on the boundary and has `n / 2 + 1` nodes, one more than the
    /// other.
    #[inline(always)]
    pub(super) fn is_long(self, colour: Colour) -> bool {
        colour.first_column(self.r + self.s) == 0
    }

    /// Whether no node of the row but its ends lies on the boundary.
    #[inline(always)]
    pub(super) fn is_inner<D: Dimension>(self) -> bool {
        let inner = |i: usize| 0 < i && i < self.n;
        inner(self.s) && (D::AXES == 2 || inner(self.r))
    }

    /// Part of the cells around the row that lies inside, across it.
    #[inline(always)]
    pub(super) fn share<D: Dimension>(self) -> f64 {
        let across = share(self.n, self.s);
        if D::AXES == 2 { across } else { across * share(self.n, self.r) }
    }

    /// Number of its first boundary node. In a row that lies on the boundary all nodes are numbered, in
    /// another the two ends.
    #[inline(always)]
    pub(super) fn first_boundary<D: Dimension>(self) -> usize {
        let Self { n, r, s } = self;
        let in_plane = |j: usize| if j == 0 { 0 } else { n + 1 + 2 * (j - 1) };
        match D::AXES {
            2 => in_plane(s),
            _ if s == 0 || s == n => boundary_before::<D>(n, s) + r * (n + 1),
            _ => boundary_before::<D>(n, s) + in_plane(r),
        }
    }
}

/// Number of a boundary node `[i, j]` or `[i, j, k]`.
#[inline(always)]
pub(super) fn boundary_number<D: Dimension>(n: usize, node: &[usize]) -> usize {
    let at = match *node {
        [_, j] => At { n, r: 0, s: j },
        [_, j, k] => At { n, r: j, s: k },
        _ => unreachable!("two or three axes"),
    };
    let along = if at.is_inner::<D>() { usize::from(node[0] == n) } else { node[0] };
    at.first_boundary::<D>() + along
}
