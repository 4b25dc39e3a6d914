//! The seven-point stencil on one row of one colour, and what the boundary does to it.

use super::level::{is_long, mirrored, row, share};
use super::surface::place;
use crate::multigrid::rows::{Colour, Rows, max_abs, worse};

const SIXTH: f64 = 1.0 / 6.0;

/// What holds on the boundary of a level.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// `y >= 0`: the Signorini problem itself.
    Obstacle,
    /// A linear correction problem; `1 / (6 + spring)` for each boundary node, 0 in contact.
    Springs(&'a [f64]),
}

/// A boundary node as the stencil meets it.
#[derive(Clone, Copy)]
pub(super) struct SurfaceNode {
    pub(super) place: usize,
    /// Part of the cell around it that lies inside the cube.
    share: f64,
}

impl Boundary<'_> {
    /// Exact minimiser in one boundary unknown; `sum` is its load plus its neighbours.
    #[inline(always)]
    pub(super) fn relax(self, node: SurfaceNode, sum: f64) -> f64 {
        match self {
            Boundary::Obstacle => (sum * SIXTH).max(0.0),
            Boundary::Springs(inverse) => sum * inverse[node.place],
        }
    }

    /// Residual that the coarser grid may see, and natural residual, at a boundary node.
    ///
    /// Nodes in contact are truncated: no coarser correction moves them.
    #[inline(always)]
    fn residual(self, node: SurfaceNode, h: f64, value: f64, sum: f64) -> (f64, f64) {
        match self {
            Boundary::Obstacle => {
                let residual = sum - 6.0 * value;
                let natural = value.min(-residual * node.share * h).abs();
                let in_contact = value == 0.0 && residual <= 0.0;
                (if in_contact { 0.0 } else { residual }, natural)
            }
            Boundary::Springs(inverse) => match inverse[node.place] {
                0.0 => (0.0, 0.0),
                inverse => (sum - value / inverse, 0.0),
            },
        }
    }

    /// A value that a correction has moved, if it may.
    #[inline(always)]
    pub(super) fn corrected(self, node: SurfaceNode, value: f64, correction: f64) -> f64 {
        match self {
            Boundary::Obstacle if value > 0.0 => (value + correction).max(0.0),
            Boundary::Springs(inverse) if inverse[node.place] > 0.0 => value + correction,
            _ => value,
        }
    }
}

/// Walks along row `(j, k)` of one colour: `inner` gets the range of places inside the cube, `edge` each
/// place on the boundary with its node.
#[inline(always)]
pub(super) fn walk<T: ?Sized>(
    n: usize,
    [j, k]: [usize; 2],
    colour: Colour,
    target: &mut T,
    inner: impl FnOnce(&mut T, std::ops::Range<usize>),
    mut edge: impl FnMut(&mut T, usize, SurfaceNode),
) {
    let half = n / 2;
    let long = is_long(colour, j, k);
    let (len, first_column) = if long { (half + 1, 0) } else { (half, 1) };
    let in_row = share(n, j) * share(n, k);
    let mut on_boundary = |target: &mut T, m: usize| {
        let i = 2 * m + first_column;
        let node = SurfaceNode { place: place(n, [i, j, k]), share: in_row * share(n, i) };
        edge(target, m, node);
    };
    if in_row < 1.0 {
        (0..len).for_each(|m| on_boundary(target, m));
    } else if long {
        on_boundary(target, 0);
        inner(target, 1..half);
        on_boundary(target, half);
    } else {
        inner(target, 0..half);
    }
}

/// The load and the neighbours of one row of one colour.
///
/// `along` is the same row of the other colour, `across` its rows `(j -+ 1, k)` and `(j, k -+ 1)`.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    n: usize,
    j: usize,
    k: usize,
    colour: Colour,
    load: &'a [f64],
    along: &'a [f64],
    across: [&'a [f64]; 4],
}

impl<'a> Row<'a> {
    #[inline(always)]
    pub(super) fn new(
        n: usize,
        [j, k]: [usize; 2],
        colour: Colour,
        load: &'a [Rows; 2],
        other: &'a [f64],
    ) -> Self {
        let ([south, north], [below, above]) = (mirrored(n, j), mirrored(n, k));
        let places = [(south, k), (north, k), (j, below), (j, above)];
        Self {
            n,
            j,
            k,
            colour,
            load: &load[colour as usize][row(n, j, k)],
            along: &other[row(n, j, k)],
            across: places.map(|(j, k)| &other[row(n, j, k)]),
        }
    }

    /// Half a sweep; the factor acts inside, boundary unknowns are minimised exactly.
    #[inline(always)]
    pub(super) fn relax(self, boundary: Boundary, factor: f64, target: &mut [f64]) {
        let edge = |node, _, sum| boundary.relax(node, sum);
        if factor == 1.0 {
            self.update(target, |_, sum| SIXTH * sum, edge);
        } else {
            let (keep, take) = (1.0 - factor, SIXTH * factor);
            self.update(target, |value, sum| keep * value + take * sum, edge);
        }
    }

    /// Replaces the values of the row by their residuals, zero where truncated; returns the largest
    /// natural residual, in units of the load.
    #[inline(always)]
    pub(super) fn replace_by_residual(self, boundary: Boundary, target: &mut [f64]) -> f64 {
        let Self { n, j, k, colour, .. } = self;
        let h = 1.0 / n as f64;
        let mut largest = 0.0_f64;
        self.update(
            target,
            |value, sum| sum - 6.0 * value,
            |node, value, sum| {
                let (residual, natural) = boundary.residual(node, h, value, sum);
                largest = worse(largest, natural);
                residual
            },
        );
        let inside = |target: &mut [f64], range: std::ops::Range<usize>| {
            largest = worse(largest, h * max_abs(&target[range]));
        };
        walk(n, [j, k], colour, target, inside, |_, _, _| ());
        largest
    }

    /// Replaces each `t` of `target` by `inner(t, sum)` inside and `edge(node, t, sum)` on the boundary,
    /// where `sum` is the load plus the neighbours.
    #[inline(always)]
    fn update(
        self,
        target: &mut [f64],
        inner: impl Fn(f64, f64) -> f64,
        mut edge: impl FnMut(SurfaceNode, f64, f64) -> f64,
    ) {
        let Self { n, j, k, colour, load, along, across: [south, north, below, above] } = self;
        // Place of the western neighbour of place 0; a long row begins where the other one has none.
        let offset = usize::from(is_long(colour, j, k));
        let last = if offset == 1 { n / 2 - 1 } else { n / 2 };
        let at_edge = |target: &mut [f64], m: usize, node: SurfaceNode| {
            let west = along[m.saturating_sub(offset)];
            let east = along[(m + 1 - offset).min(last)];
            let sum = (west + east) + ((south[m] + north[m]) + (below[m] + above[m]));
            target[m] = edge(node, target[m], load[m] + sum);
        };
        let inside = |target: &mut [f64], range: std::ops::Range<usize>| {
            let (start, len) = (range.start, range.len());
            let west = &along[start - offset..][..len];
            let east = &along[start + 1 - offset..][..len];
            let (load, target) = (&load[range.clone()], &mut target[range.clone()]);
            let (south, north) = (&south[range.clone()], &north[range.clone()]);
            let (below, above) = (&below[range.clone()], &above[range]);
            for m in 0..len {
                let across = (south[m] + north[m]) + (below[m] + above[m]);
                let sum = load[m] + ((west[m] + east[m]) + across);
                target[m] = inner(target[m], sum);
            }
        };
        walk(n, [j, k], colour, target, inside, at_edge);
    }
}
