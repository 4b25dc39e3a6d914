//! The five-point stencil on one row of one colour, and what the boundary does to it.

use crate::multigrid::rows::{Colour, LINE, Rows, max_abs, stride, worse};

/// What holds on the boundary of a level.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// `y >= 0`: the Signorini problem itself.
    Obstacle,
    /// A linear correction problem; `1 / (diagonal + spring)` in perimeter order, 0 in contact.
    Springs(&'a [f64]),
}

impl Boundary<'_> {
    /// Exact minimiser in one boundary unknown; `sum` is its load plus its weighted neighbours.
    #[inline(always)]
    pub(super) fn relax(self, node: EdgeNode, sum: f64) -> f64 {
        match self {
            Boundary::Obstacle => (sum * node.inverse_diagonal).max(0.0),
            Boundary::Springs(inverse) => sum * inverse[node.perimeter],
        }
    }

    /// Residual that the coarser grid may see, and natural residual, at a boundary node.
    ///
    /// Nodes in contact are truncated: no coarser correction moves them.
    #[inline(always)]
    pub(super) fn residual(self, node: EdgeNode, value: f64, sum: f64) -> (f64, f64) {
        match self {
            Boundary::Obstacle => {
                let residual = sum - value / node.inverse_diagonal;
                let natural = value.min(-residual).abs();
                let in_contact = value == 0.0 && residual <= 0.0;
                (if in_contact { 0.0 } else { residual }, natural)
            }
            Boundary::Springs(inverse) => match inverse[node.perimeter] {
                0.0 => (0.0, 0.0),
                inverse => (sum - value / inverse, 0.0),
            },
        }
    }

    /// Whether a correction may move a boundary node that has this value.
    #[inline(always)]
    pub(super) fn is_free(self, node: usize, value: f64) -> bool {
        match self {
            Boundary::Obstacle => value > 0.0,
            Boundary::Springs(inverse) => inverse[node] > 0.0,
        }
    }

    #[inline(always)]
    pub(super) fn project(self, value: f64) -> f64 {
        match self {
            Boundary::Obstacle => value.max(0.0),
            Boundary::Springs(_) => value,
        }
    }
}

/// A boundary node as the stencil meets it.
#[derive(Clone, Copy)]
pub(super) struct EdgeNode {
    /// Place counted counter-clockwise from the corner (0, 0).
    pub(super) perimeter: usize,
    /// 1 / 2 on an edge, 1 in a corner (without springs).
    pub(super) inverse_diagonal: f64,
}

/// Place of node `(i, j)` of the boundary, counter-clockwise from the corner (0, 0).
#[inline(always)]
pub(super) fn perimeter(n: usize, i: usize, j: usize) -> usize {
    if j == 0 {
        i
    } else if i == n {
        n + j
    } else if j == n {
        3 * n - i
    } else {
        4 * n - j
    }
}

/// The load and the neighbours of one row of one colour.
///
/// `along` is the same row of the other colour, `below` and `above` are its rows `j - 1` and `j + 1`;
/// on the first and last row the one that exists is given twice.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub(super) n: usize,
    pub(super) j: usize,
    pub(super) colour: Colour,
    pub(super) load: &'a [f64],
    pub(super) along: &'a [f64],
    pub(super) below: &'a [f64],
    pub(super) above: &'a [f64],
}

impl<'a> Row<'a> {
    /// Row `j` of a grid; `other` holds the rows of the other colour from row `first` on.
    #[inline(always)]
    pub(super) fn new(
        n: usize,
        j: usize,
        colour: Colour,
        load: &'a [Rows; 2],
        other: &'a [f64],
        first: usize,
    ) -> Self {
        let stride = stride(n);
        let row = |j: usize| &other[(j - first) * stride..(j - first + 1) * stride];
        Self {
            n,
            j,
            colour,
            load: &load[colour as usize][j * stride..(j + 1) * stride],
            along: row(j),
            below: row(if j > 0 { j - 1 } else { 1 }),
            above: row(if j < n { j + 1 } else { n - 1 }),
        }
    }

    /// Replaces the values of the row by their residuals, zero where truncated; returns the largest
    /// natural residual.
    #[inline(always)]
    pub(super) fn replace_by_residual(self, boundary: Boundary, target: &mut [f64]) -> f64 {
        let (n, j) = (self.n, self.j);
        let mut largest = 0.0_f64;
        self.update(
            target,
            |value, sum| sum - 4.0 * value,
            |node, value, sum| {
                let (residual, natural) = boundary.residual(node, value, sum);
                largest = worse(largest, natural);
                residual
            },
        );
        let inner = match (j == 0 || j == n, self.colour.first_column(j) == 0) {
            (true, _) => 0..0,
            (false, true) => 1..n / 2,
            (false, false) => 0..n / 2,
        };
        worse(largest, max_abs(&target[inner]))
    }

    /// Replaces each `t` of `target` by `inner(t, sum)` inside and `edge(node, t, sum)` on the boundary,
    /// where `sum` is the load plus the weighted neighbours.
    #[inline(always)]
    pub(super) fn update(
        self,
        target: &mut [f64],
        inner: impl Fn(f64, f64) -> f64,
        mut edge: impl FnMut(EdgeNode, f64, f64) -> f64,
    ) {
        let Row { n, j, colour, load, along, below, above } = self;
        let half = n / 2;
        let long = colour.first_column(j) == 0;
        if j == 0 || j == n {
            let mut on_edge = |k: usize, i: usize, sum: f64, inverse_diagonal: f64| {
                let node = EdgeNode { perimeter: perimeter(n, i, j), inverse_diagonal };
                target[k] = edge(node, target[k], load[k] + sum);
            };
            if long {
                on_edge(0, 0, 0.5 * (along[0] + above[0]), 1.0);
                for k in 1..half {
                    on_edge(k, 2 * k, 0.5 * (along[k - 1] + along[k]) + above[k], 0.5);
                }
                on_edge(half, n, 0.5 * (along[half - 1] + above[half]), 1.0);
            } else {
                for k in 0..half {
                    on_edge(k, 2 * k + 1, 0.5 * (along[k] + along[k + 1]) + above[k], 0.5);
                }
            }
        } else if long {
            let mut end = |k: usize, i: usize, neighbour: f64| {
                let node = EdgeNode { perimeter: perimeter(n, i, j), inverse_diagonal: 0.5 };
                let sum = load[k] + (neighbour + 0.5 * (below[k] + above[k]));
                target[k] = edge(node, target[k], sum);
            };
            end(0, 0, along[0]);
            end(half, n, along[half - 1]);
            // Up to the first full cache line, so that the rest of the loop is aligned.
            let line = LINE.min(half);
            for range in [1..line, line..half] {
                update_inner(
                    &mut target[range.clone()],
                    &load[range.clone()],
                    &along[range.start - 1..range.end],
                    &below[range.clone()],
                    &above[range],
                    &inner,
                );
            }
        } else {
            update_inner(
                &mut target[..half],
                &load[..half],
                &along[..half + 1],
                &below[..half],
                &above[..half],
                &inner,
            );
        }
    }
}

/// The hot loop: every slice has the length of `target`, `along` one more.
#[inline(always)]
fn update_inner(
    target: &mut [f64],
    load: &[f64],
    along: &[f64],
    below: &[f64],
    above: &[f64],
    inner: impl Fn(f64, f64) -> f64,
) {
    let len = target.len();
    let (west, east) = (&along[..len], &along[1..len + 1]);
    let (load, below, above) = (&load[..len], &below[..len], &above[..len]);
    for k in 0..len {
        let sum = load[k] + ((west[k] + east[k]) + (below[k] + above[k]));
        target[k] = inner(target[k], sum);
    }
}
