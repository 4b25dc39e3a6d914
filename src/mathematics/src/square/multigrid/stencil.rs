//! The five-point stencil on one row of one colour, and the condition at its boundary nodes.

use super::level::MultigridLevel;
use super::rows::{self, Colour, GridRow, boundary_nodes, mirrored, share, stride};
use crate::discrete::stiffness::sides;
use crate::machine::simd::Largest;
use crate::problem::law::{ContactNode, Law};

/// Diagonal of the stencil.
pub(super) const DIAGONAL: f64 = 4.0;
/// One over the diagonal of the stencil.
pub(super) const INVERSE: f64 = 1.0 / DIAGONAL;
/// Number of multiplications that are counted as the visit of one unknown.
pub(super) const MULTIPLICATIONS_PER_VISIT: f64 = DIAGONAL + 1.0;

/// Boundary condition of a level.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// The law `[0, limit]`: the problem itself. The limit is that of a node on one side, in units of the load;
    /// infinite for the paper's law.
    Law { limit: f64 },
    /// A linear correction problem; `1 / (4 + spring)` for each boundary node, 0 in contact.
    Springs(&'a [f64]),
}

/// Load and boundary condition of a level.
#[derive(Clone, Copy)]
pub(super) struct LevelEquation<'a> {
    /// Red and black load.
    pub(super) load: [&'a [f64]; 2],
    pub(super) boundary: Boundary<'a>,
}

/// A boundary node and its weight in the stencil.
#[derive(Clone, Copy)]
pub(super) struct BoundaryNode {
    pub(super) number: usize,
    /// Part of the cell around the node that lies inside.
    share: f64,
}

impl BoundaryNode {
    /// Limit of the flux into the node, from that of a node on one side.
    #[inline(always)]
    fn limit(self, limit: f64) -> f64 {
        limit * sides(self.share)
    }
}

/// Residual at a boundary node.
struct BoundaryResidual {
    /// Residual for the coarser grid; zero in contact, since no coarser correction moves such a node.
    truncated: f64,
    /// Natural residual under the law, in units of the load.
    natural: f64,
    in_contact: bool,
}

impl Boundary<'_> {
    /// Exact minimiser in one boundary unknown; `sum` is its load plus its neighbours.
    #[inline(always)]
    pub(super) fn relax(self, node: BoundaryNode, sum: f64) -> f64 {
        match self {
            Boundary::Law { limit } => {
                let (up, down) = (sum, sum + node.limit(limit));
                (up * INVERSE).max((down * INVERSE).min(0.0))
            }
            Boundary::Springs(inverse) => sum * inverse[node.number],
        }
    }

    #[inline(always)]
    fn residual(self, node: BoundaryNode, value: f64, sum: f64) -> BoundaryResidual {
        match self {
            Boundary::Law { limit } => {
                let up = sum - DIAGONAL * value;
                let down = up + node.limit(limit);
                let [above, below] = [up, down].map(|residual| -residual * node.share);
                let natural = above.min(value.max(below)).abs();
                let in_contact = value == 0.0 && up <= 0.0 && down >= 0.0;
                let truncated = if in_contact {
                    0.0
                } else if value < 0.0 || (value == 0.0 && up < 0.0) {
                    down
                } else {
                    up
                };
                BoundaryResidual { truncated, natural, in_contact }
            }
            Boundary::Springs(inverse) => match inverse[node.number] {
                0.0 => BoundaryResidual { truncated: 0.0, natural: 0.0, in_contact: true },
                inverse => {
                    let truncated = sum - value / inverse;
                    BoundaryResidual { truncated, natural: 0.0, in_contact: false }
                }
            },
        }
    }

    /// Value after a correction. Nodes at zero keep their value; under the law no value changes its sign.
    #[inline(always)]
    pub(super) fn corrected(self, node: BoundaryNode, value: f64, correction: f64) -> f64 {
        match self {
            Boundary::Law { .. } if value > 0.0 => (value + correction).max(0.0),
            Boundary::Law { .. } if value < 0.0 => (value + correction).min(0.0),
            Boundary::Springs(inverse) if inverse[node.number] > 0.0 => value + correction,
            _ => value,
        }
    }
}

/// Boundary nodes in a row of one colour, with their places.
#[inline(always)]
pub(super) fn edges(row: GridRow, colour: Colour) -> impl Iterator<Item = (usize, BoundaryNode)> {
    let (half, long, first) = (row.n / 2, row.is_long(colour), row.first_boundary());
    let across = row.share();
    let (count, step, first, next) = match (row.is_inner(), long) {
        (true, true) => (2, half, first, 1),
        (true, false) => (0, 0, first, 0),
        (false, true) => (half + 1, 1, first, 2),
        (false, false) => (half, 1, first + 1, 2),
    };
    (0..count).map(move |k| {
        let m = k * step;
        let along = if long && (m == 0 || m == half) { 0.5 } else { 1.0 };
        (m, BoundaryNode { number: first + k * next, share: across * along })
    })
}

/// Boundary nodes under a law in the order of their numbers, with their positions in natural order.
pub(super) fn contact_nodes(n: usize, law: Law) -> Vec<ContactNode> {
    let mut nodes = Vec::with_capacity(boundary_nodes(n));
    let measure = 1.0 / n as f64;
    for j in 0..=n {
        let step = if (GridRow { n, j }).is_inner() { n } else { 1 };
        for i in (0..=n).step_by(step) {
            nodes.push(ContactNode { node: j * (n + 1) + i, measure, law });
        }
    }
    nodes
}

/// Energy of a level under the law, up to a factor, with one node after the other.
pub(super) fn energy(level: &MultigridLevel) -> f64 {
    let n = level.n;
    let [mut values, mut load] = [vec![0.0; level.nodes], vec![0.0; level.nodes]];
    rows::merge(n, &level.values, 1.0, &mut values);
    rows::merge(n, &level.load, 1.0, &mut load);
    let mut energy = 0.0;
    for (k, (value, load)) in values.iter().zip(&load).enumerate() {
        let (mut flow, mut part) = (0.0, 1.0);
        for step in [1, n + 1] {
            let i = k / step % (n + 1);
            for neighbour in mirrored(n, i) {
                flow += value - values[k - i * step + neighbour * step];
            }
            part *= share(n, i);
        }
        let limit = if part < 1.0 && *value < 0.0 { level.limit * sides(part) } else { 0.0 };
        energy += part * value * (0.5 * flow - load - limit);
    }
    energy
}

/// Contact flags of consecutive boundary nodes.
pub(super) struct ContactFlags<'a> {
    pub(super) flags: &'a mut [bool],
    /// Number of the first boundary node.
    pub(super) first: usize,
}

impl ContactFlags<'_> {
    #[inline(always)]
    pub(super) fn set(&mut self, node: BoundaryNode, in_contact: bool) {
        self.flags[node.number - self.first] = in_contact;
    }
}

/// Results that the residuals under the law leave beside the residuals themselves.
pub(super) struct ResidualReport<'a, 'f> {
    /// Largest natural residual so far, in units of the load.
    pub(super) natural: &'a mut Largest,
    /// Flags to be set for the boundary nodes; `None` if they are not needed.
    pub(super) contact: Option<&'a mut ContactFlags<'f>>,
}

impl ResidualReport<'_, '_> {
    #[inline(always)]
    fn add(&mut self, node: BoundaryNode, residual: &BoundaryResidual) {
        self.natural.put(residual.natural);
        if let Some(contact) = &mut self.contact {
            contact.set(node, residual.in_contact);
        }
    }
}

/// Load and neighbours of one row of one colour.
#[derive(Clone, Copy)]
pub(super) struct StencilRow<'a> {
    row: GridRow,
    colour: Colour,
    load: &'a [f64],
    /// Row of the other colour at the same position.
    along: &'a [f64],
    /// The slice that begins one place before `along`.
    before: &'a [f64],
    /// Neighbouring rows of the other colour.
    below: &'a [f64],
    above: &'a [f64],
}

impl<'a> StencilRow<'a> {
    /// Takes `load`, the load of the colour on the whole grid, and `other`, the other colour from row `first` on.
    #[inline(always)]
    pub(super) fn new(
        row: GridRow,
        colour: Colour,
        load: &'a [f64],
        other: &'a [f64],
        first: usize,
    ) -> Self {
        let GridRow { n, j } = row;
        let [below, above] = mirrored(n, j);
        let own = (j - first) * stride(n);
        Self {
            row,
            colour,
            load: row.of(load, 0),
            along: row.of(other, first),
            before: &other[own.saturating_sub(1)..][..stride(n)],
            below: GridRow { n, j: below }.of(other, first),
            above: GridRow { n, j: above }.of(other, first),
        }
    }

    /// Half a sweep over the row. The factor is applied inside; boundary unknowns are minimised exactly.
    #[inline(always)]
    pub(super) fn relax(self, boundary: Boundary, factor: f64, target: &mut [f64]) {
        if factor == 1.0 {
            self.update(
                target,
                |_, _, sum| INVERSE * sum,
                |_, node, sum| boundary.relax(node, sum),
            );
        } else {
            let (keep, take) = (1.0 - factor, INVERSE * factor);
            self.update(
                target,
                |_, value, sum| keep * value + take * sum,
                |_, node, sum| boundary.relax(node, sum),
            );
        }
    }

    /// Sets `target` to the residuals of the row, zero at nodes in contact. Under the law, adds natural
    /// residuals and contact flags to the report.
    #[inline(always)]
    pub(super) fn residual(
        self,
        boundary: Boundary,
        values: &[f64],
        target: &mut [f64],
        report: &mut ResidualReport,
    ) {
        let half = self.row.n / 2;
        let inside = &values[..half];
        self.update(
            target,
            |m, _, sum| sum - DIAGONAL * inside[m],
            |m, node, sum| {
                let residual = boundary.residual(node, values[m], sum);
                if let Boundary::Law { .. } = boundary {
                    report.add(node, &residual);
                }
                residual.truncated
            },
        );
        if let Boundary::Law { .. } = boundary
            && self.row.is_inner()
        {
            // The slice begins at the first place, which is aligned; a boundary node there is left out.
            let first = target[0];
            if self.row.is_long(self.colour) {
                target[0] = 0.0;
            }
            report.natural.see(1.0, &target[..half]);
            target[0] = first;
        }
    }

    /// Replaces each value `t` of the row by `inside(m, t, sum)` inside and by `on_boundary(m, node, sum)` at boundary
    /// nodes, where `m` is its place and `sum` the load plus the neighbours.
    ///
    /// The first loop covers the whole row, so that it is aligned. In a long row the first value is that of a boundary
    /// node, which the second loop replaces.
    #[inline(always)]
    fn update(
        self,
        target: &mut [f64],
        inside: impl Fn(usize, f64, f64) -> f64,
        mut on_boundary: impl FnMut(usize, BoundaryNode, f64) -> f64,
    ) {
        let Self { row, colour, load, along, before, below, above } = self;
        if row.is_inner() {
            let [west, east] = match row.is_long(colour) {
                true => [before, along],
                false => [along, &along[1..]],
            };
            update_slice(&mut target[..row.n / 2], load, [west, east, below, above], inside);
        }
        for (m, node) in edges(row, colour) {
            target[m] = on_boundary(m, node, self.edge_sum(m));
        }
    }

    /// Load plus neighbours of a boundary node, mirrored.
    #[inline(always)]
    fn edge_sum(self, m: usize) -> f64 {
        let Self { row, load, along, below, above, .. } = self;
        let [west, east] = match row.is_long(self.colour) {
            true => [m.saturating_sub(1), m.min(row.n / 2 - 1)],
            false => [m, m + 1],
        };
        load[m] + ((along[west] + along[east]) + (below[m] + above[m]))
    }
}

/// The hot loop of all solvers here. Every slice is at least as long as `target`.
#[inline(always)]
fn update_slice(
    target: &mut [f64],
    load: &[f64],
    [west, east, below, above]: [&[f64]; 4],
    inner: impl Fn(usize, f64, f64) -> f64,
) {
    let len = target.len();
    let (west, east, load) = (&west[..len], &east[..len], &load[..len]);
    let (below, above) = (&below[..len], &above[..len]);
    for m in 0..len {
        let sum = load[m] + ((west[m] + east[m]) + (below[m] + above[m]));
        target[m] = inner(m, target[m], sum);
    }
}
