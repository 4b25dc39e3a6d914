//! Memory layout of the nodes and numbering of the boundary nodes, on the square and on the cube.
//!
//! Nodes lie in *rows* along x, and rows in *slabs*: a slab is a row of the square, a plane of the cube.
//! The five- or seven-point stencil of a slab needs the two neighbouring slabs and no others.

use std::ops::Range;

use super::rows::{Colour, stride};

/// Number of axes, as a type.
pub(super) trait Dimension: Send + Sync + 'static {
    const AXES: usize;
}

/// Part of the cell around node `i` that lies inside, along one axis.
#[inline(always)]
pub(super) fn share(n: usize, i: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

/// True if neither end of an axis with `n` cells is at node `i`.
#[inline(always)]
pub(super) fn is_inside(n: usize, i: usize) -> bool {
    0 < i && i < n
}

/// Neighbours `i - 1` and `i + 1`, mirrored at the boundary.
#[inline(always)]
pub(super) fn mirrored(n: usize, i: usize) -> [usize; 2] {
    [if i > 0 { i - 1 } else { 1 }, if i < n { i + 1 } else { n - 1 }]
}

/// Number of rows in a slab.
#[inline(always)]
pub(super) fn rows_per_slab<D: Dimension>(n: usize) -> usize {
    if D::AXES == 2 { 1 } else { n + 1 }
}

/// Number of places of one colour in a slab.
#[inline(always)]
pub(super) fn places_per_slab<D: Dimension>(n: usize) -> usize {
    rows_per_slab::<D>(n) * stride(n)
}

/// Number of nodes of a grid.
pub(super) fn nodes<D: Dimension>(n: usize) -> usize {
    (n + 1).pow(D::AXES as u32)
}

/// Number of boundary nodes of a grid. They are numbered in natural order.
pub(super) fn boundary_nodes<D: Dimension>(n: usize) -> usize {
    nodes::<D>(n) - (n - 1).pow(D::AXES as u32)
}

/// Number of boundary nodes before slab `s`.
#[inline(always)]
pub(super) fn boundary_before<D: Dimension>(n: usize, s: usize) -> usize {
    let (whole, between) = if D::AXES == 2 { (n + 1, 2) } else { ((n + 1) * (n + 1), 4 * n) };
    if s == 0 { 0 } else { whole + (s.min(n) - 1) * between + if s > n { whole } else { 0 } }
}

/// Slab `s` of a grid with `n` cells per side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab {
    pub(super) n: usize,
    pub(super) s: usize,
}

impl Slab {
    /// Rows of the slab.
    #[inline(always)]
    pub(super) fn rows<D: Dimension>(self) -> impl Iterator<Item = At> {
        let Self { n, s } = self;
        (0..rows_per_slab::<D>(n)).map(move |r| At { n, r, s })
    }
}

/// Row `r` of slab `s` of a grid with `n` cells per side.
#[derive(Clone, Copy, Debug)]
pub(super) struct At {
    pub(super) n: usize,
    pub(super) r: usize,
    pub(super) s: usize,
}

impl At {
    /// Places of this row in one colour of its slab.
    #[inline(always)]
    pub(super) fn in_slab(self) -> Range<usize> {
        self.r * stride(self.n)..(self.r + 1) * stride(self.n)
    }

    /// True if the row of this colour starts on the boundary and has `n / 2 + 1` nodes, one more than the row of the
    /// other colour.
    #[inline(always)]
    pub(super) fn is_long(self, colour: Colour) -> bool {
        colour.first_column(self.r + self.s) == 0
    }

    /// True if only the two ends of the row lie on the boundary.
    #[inline(always)]
    pub(super) fn is_inner<D: Dimension>(self) -> bool {
        is_inside(self.n, self.s) && (D::AXES == 2 || is_inside(self.n, self.r))
    }

    /// Part of the cells around the row that lies inside, across the row.
    #[inline(always)]
    pub(super) fn share<D: Dimension>(self) -> f64 {
        let across = share(self.n, self.s);
        if D::AXES == 2 { across } else { across * share(self.n, self.r) }
    }

    /// Number of the first boundary node of the row. All nodes of a row that lies on the boundary are numbered, of
    /// any other row only the two ends.
    #[inline(always)]
    pub(super) fn first_boundary<D: Dimension>(self) -> usize {
        let Self { n, r, s } = self;
        match D::AXES {
            2 => first_boundary_in_plane(n, s),
            _ if s == 0 || s == n => boundary_before::<D>(n, s) + r * (n + 1),
            _ => boundary_before::<D>(n, s) + first_boundary_in_plane(n, r),
        }
    }
}

/// One row of one colour, of which `slabs` holds all slabs from `first` on.
#[inline(always)]
pub(super) fn row_from<D: Dimension>(slabs: &[f64], first: usize, at: At) -> &[f64] {
    let start = ((at.s - first) * rows_per_slab::<D>(at.n) + at.r) * stride(at.n);
    &slabs[start..][..stride(at.n)]
}

/// Number of the first boundary node of row `j` of a plane, among the boundary nodes of the plane.
#[inline(always)]
fn first_boundary_in_plane(n: usize, j: usize) -> usize {
    if j == 0 { 0 } else { n + 1 + 2 * (j - 1) }
}

/// Number of the boundary node `[i, j]` or `[i, j, k]`.
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
