//! The five- or seven-point stencil on one row of one colour, and what the boundary does to it.

use super::layout::{At, Dimension, mirrored, rows_per_slab};
use super::rows::{Colour, stride};
use crate::discrete::simd::Largest;

/// What holds on the boundary of a level.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// `y >= 0`: the Signorini problem itself.
    Obstacle,
    /// A linear correction problem; `1 / (2 d + spring)` for each boundary node, 0 in contact.
    Springs(&'a [f64]),
}

/// A boundary node as the stencil meets it.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub(super) number: usize,
    /// Part of the cell around it that lies inside.
    share: f64,
}

impl Boundary<'_> {
    /// Exact minimiser in one boundary unknown; `sum` is its load plus its neighbours.
    #[inline(always)]
    pub(super) fn relax<D: Dimension>(self, edge: Edge, sum: f64) -> f64 {
        match self {
            Boundary::Obstacle => (sum * inverse::<D>()).max(0.0),
            Boundary::Springs(inverse) => sum * inverse[edge.number],
        }
    }

    /// Residual that the coarser grid may see, natural residual, and whether the node is in contact.
    ///
    /// Nodes in contact are truncated: no coarser correction moves them.
    #[inline(always)]
    fn residual<D: Dimension>(
        self,
        edge: Edge,
        coupling: f64,
        value: f64,
        sum: f64,
    ) -> (f64, f64, bool) {
        match self {
            Boundary::Obstacle => {
                let residual = sum - diagonal::<D>() * value;
                let natural = value.min(-residual * (edge.share * coupling)).abs();
                let in_contact = value == 0.0 && residual <= 0.0;
                (if in_contact { 0.0 } else { residual }, natural, in_contact)
            }
            Boundary::Springs(inverse) => match inverse[edge.number] {
                0.0 => (0.0, 0.0, true),
                inverse => (sum - value / inverse, 0.0, false),
            },
        }
    }

    /// A value that a correction has moved, if it may.
    #[inline(always)]
    pub(super) fn corrected(self, edge: Edge, value: f64, correction: f64) -> f64 {
        match self {
            Boundary::Obstacle if value > 0.0 => (value + correction).max(0.0),
            Boundary::Springs(inverse) if inverse[edge.number] > 0.0 => value + correction,
            _ => value,
        }
    }
}

/// The diagonal of the stencil.
#[inline(always)]
pub(super) fn diagonal<D: Dimension>() -> f64 {
    2.0 * D::AXES as f64
}

/// Multiplications per visit of an unknown, as work is counted.
pub(super) fn visit<D: Dimension>() -> f64 {
    diagonal::<D>() + 1.0
}

/// One over the diagonal.
#[inline(always)]
pub(super) fn inverse<D: Dimension>() -> f64 {
    1.0 / diagonal::<D>()
}

/// The coupling of neighbours inside, `h^(d - 2)`.
pub(super) fn coupling<D: Dimension>(n: usize) -> f64 {
    if D::AXES == 2 { 1.0 } else { 1.0 / n as f64 }
}

/// The boundary nodes in a row of one colour, with their places.
#[inline(always)]
pub(super) fn edges<D: Dimension>(at: At, colour: Colour) -> impl Iterator<Item = (usize, Edge)> {
    let (half, long, first) = (at.n / 2, at.is_long(colour), at.first_boundary::<D>());
    let across = at.share::<D>();
    let (count, step, first, next) = match (at.is_inner::<D>(), long) {
        (true, true) => (2, half, first, 1),
        (true, false) => (0, 0, first, 0),
        (false, true) => (half + 1, 1, first, 2),
        (false, false) => (half, 1, first + 1, 2),
    };
    (0..count).map(move |k| {
        let m = k * step;
        let along = if long && (m == 0 || m == half) { 0.5 } else { 1.0 };
        (m, Edge { number: first + k * next, share: across * along })
    })
}

/// Calls `visit(number, [i, r, s])` for every boundary node, by growing number: column `i` of row `r` of slab `s`.
pub(super) fn for_each_boundary_node<D: Dimension>(
    n: usize,
    mut visit: impl FnMut(usize, [usize; 3]),
) {
    let mut number = 0;
    for s in 0..=n {
        for at in At::of_slab::<D>(n, s) {
            let step = if at.is_inner::<D>() { n } else { 1 };
            for i in (0..=n).step_by(step) {
                visit(number, [i, at.r, s]);
                number += 1;
            }
        }
    }
}

/// The load and the neighbours of one row of one colour.
///
/// `along` is the same row of the other colour, `across` are its rows in the slabs before and after and, on
/// the cube, those beside it in its slab.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    at: At,
    colour: Colour,
    load: &'a [f64],
    along: &'a [f64],
    /// The same from one place before the row.
    before: &'a [f64],
    across: [&'a [f64]; 4],
}

impl<'a> Row<'a> {
    /// `load` is that of the colour on the whole grid; `other` holds the other colour from slab `first` on.
    #[inline(always)]
    pub(super) fn new<D: Dimension>(
        at: At,
        colour: Colour,
        load: &'a [f64],
        other: &'a [f64],
        first: usize,
    ) -> Self {
        let At { n, r, s } = at;
        let (rows, stride) = (rows_per_slab::<D>(n), stride(n));
        let row = |r: usize, s: usize| &other[((s - first) * rows + r) * stride..][..stride];
        let [below, above] = mirrored(n, s);
        let [south, north] = if D::AXES == 2 { [r, r] } else { mirrored(n, r) };
        let number = s * rows + r;
        Self {
            at,
            colour,
            load: &load[number * stride..][..stride],
            along: row(r, s),
            before: &other[(((s - first) * rows + r) * stride).saturating_sub(1)..][..stride],
            across: [row(south, s), row(north, s), row(r, below), row(r, above)],
        }
    }

    /// Half a sweep; the factor acts inside, boundary unknowns are minimised exactly.
    #[inline(always)]
    pub(super) fn relax<D: Dimension>(self, boundary: Boundary, factor: f64, target: &mut [f64]) {
        let edge = |_, edge, sum| boundary.relax::<D>(edge, sum);
        if factor == 1.0 {
            self.update::<D>(target, |_, _, sum| inverse::<D>() * sum, edge);
        } else {
            let (keep, take) = (1.0 - factor, inverse::<D>() * factor);
            self.update::<D>(target, |_, value, sum| keep * value + take * sum, edge);
        }
    }

    /// Sets `target` to the residuals of the row, zero where truncated; `natural` takes in the natural residuals of
    /// an obstacle problem, in units of the load, and `see` is told of each of its boundary nodes whether it is in
    /// contact.
    #[inline(always)]
    pub(super) fn residual<D: Dimension>(
        self,
        boundary: Boundary,
        values: &[f64],
        target: &mut [f64],
        natural: &mut Largest,
        mut see: impl FnMut(usize, bool),
    ) {
        let (half, coupling) = (self.at.n / 2, coupling::<D>(self.at.n));
        let inside = &values[..half];
        self.update::<D>(
            target,
            |m, _, sum| sum - diagonal::<D>() * inside[m],
            |m, edge, sum| {
                let (residual, of_node, in_contact) =
                    boundary.residual::<D>(edge, coupling, values[m], sum);
                if let Boundary::Obstacle = boundary {
                    natural.put(of_node);
                    see(edge.number, in_contact);
                }
                residual
            },
        );
        if let Boundary::Obstacle = boundary
            && self.at.is_inner::<D>()
        {
            // From the first place on, which is aligned, but without it if it lies on the boundary.
            let first = target[0];
            if self.at.is_long(self.colour) {
                target[0] = 0.0;
            }
            natural.see(coupling, &target[..half]);
            target[0] = first;
        }
    }

    /// Replaces each `t` of `target` by `inner(m, t, sum)` inside and `edge(m, node, sum)` on the boundary, where `m`
    /// is its place and `sum` the load plus the neighbours.
    #[inline(always)]
    fn update<D: Dimension>(
        self,
        target: &mut [f64],
        inner: impl Fn(usize, f64, f64) -> f64,
        mut edge: impl FnMut(usize, Edge, f64) -> f64,
    ) {
        let Self { at, colour, load, along, before, across } = self;
        let half = at.n / 2;
        if at.is_inner::<D>() {
            // The whole row, aligned; a long one begins with a place that is none, and gets its ends after it.
            let [west, east] = match at.is_long(colour) {
                true => [before, along],
                false => [along, &along[1..]],
            };
            update_inner::<D>(&mut target[..half], load, [west, east], across, inner);
        }
        for (m, node) in edges::<D>(at, colour) {
            target[m] = edge(m, node, self.edge_sum::<D>(m));
        }
    }

    /// The load plus the neighbours of a boundary node, mirrored.
    #[inline(always)]
    fn edge_sum<D: Dimension>(self, m: usize) -> f64 {
        let Self { at, load, along, across: [south, north, below, above], .. } = self;
        let [west, east] = match at.is_long(self.colour) {
            true => [m.saturating_sub(1), m.min(at.n / 2 - 1)],
            false => [m, m + 1],
        };
        let mut across = below[m] + above[m];
        if D::AXES == 3 {
            across += south[m] + north[m];
        }
        load[m] + ((along[west] + along[east]) + across)
    }
}

/// The hot loop: every slice has the length of `target`.
#[inline(always)]
fn update_inner<D: Dimension>(
    target: &mut [f64],
    load: &[f64],
    [west, east]: [&[f64]; 2],
    [south, north, below, above]: [&[f64]; 4],
    inner: impl Fn(usize, f64, f64) -> f64,
) {
    let len = target.len();
    let (west, east, load) = (&west[..len], &east[..len], &load[..len]);
    let (south, north, below, above) = (&south[..len], &north[..len], &below[..len], &above[..len]);
    for m in 0..len {
        let mut across = below[m] + above[m];
        if D::AXES == 3 {
            across += south[m] + north[m];
        }
        target[m] = inner(m, target[m], load[m] + ((west[m] + east[m]) + across));
    }
}
