//! The five- or seven-point stencil on one row of one colour, and the condition at its boundary nodes.

use super::layout::{
    At, Dimension, Slab, boundary_nodes, mirrored, row_from, rows_per_slab, share,
};
use super::level::MultigridLevel;
use super::rows::{self, Colour, stride};
use crate::discrete::stencils::faces;
use crate::machine::simd::Largest;
use crate::problem::law::ContactNode;

/// Boundary condition of a level.
#[derive(Clone, Copy)]
pub(super) enum Boundary<'a> {
    /// The law `[0, limit]`: the problem itself. The limit is that of a node in one face, in units of the load; infinite for
    /// the paper's law.
    Law { limit: f64 },
    /// A linear correction problem; `1 / (2 d + spring)` for each boundary node, 0 in contact.
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
    /// Limit of the flux into the node, from that of a node in one face.
    #[inline(always)]
    fn limit(self, limit: f64) -> f64 {
        limit * faces(self.share)
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
    pub(super) fn relax<D: Dimension>(self, node: BoundaryNode, sum: f64) -> f64 {
        match self {
            // Without a limit no node slips down, and the general formulas would take longer for the same bits.
            Boundary::Law { limit: f64::INFINITY } => (sum * inverse::<D>()).max(0.0),
            Boundary::Law { limit } => {
                let (up, down) = (sum, sum + node.limit(limit));
                (up * inverse::<D>()).max((down * inverse::<D>()).min(0.0))
            }
            Boundary::Springs(inverse) => sum * inverse[node.number],
        }
    }

    #[inline(always)]
    fn residual<D: Dimension>(
        self,
        node: BoundaryNode,
        coupling: f64,
        value: f64,
        sum: f64,
    ) -> BoundaryResidual {
        match self {
            Boundary::Law { limit: f64::INFINITY } => {
                let residual = sum - diagonal::<D>() * value;
                let natural = value.min(-residual * (node.share * coupling)).abs();
                let in_contact = value == 0.0 && residual <= 0.0;
                let truncated = if in_contact { 0.0 } else { residual };
                BoundaryResidual { truncated, natural, in_contact }
            }
            Boundary::Law { limit } => {
                let up = sum - diagonal::<D>() * value;
                let down = up + node.limit(limit);
                let [above, below] = [up, down].map(|residual| -residual * (node.share * coupling));
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

/// Diagonal of the stencil.
#[inline(always)]
pub(super) fn diagonal<D: Dimension>() -> f64 {
    2.0 * D::AXES as f64
}

/// Number of multiplications that are counted as the visit of one unknown.
pub(super) fn multiplications_per_visit<D: Dimension>() -> f64 {
    diagonal::<D>() + 1.0
}

/// One over the diagonal of the stencil.
#[inline(always)]
pub(super) fn inverse<D: Dimension>() -> f64 {
    1.0 / diagonal::<D>()
}

/// Coupling of neighbours inside, `h^(d - 2)`.
pub(super) fn coupling<D: Dimension>(n: usize) -> f64 {
    if D::AXES == 2 { 1.0 } else { 1.0 / n as f64 }
}

/// Boundary nodes in a row of one colour, with their places.
#[inline(always)]
pub(super) fn edges<D: Dimension>(
    at: At,
    colour: Colour,
) -> impl Iterator<Item = (usize, BoundaryNode)> {
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
        (m, BoundaryNode { number: first + k * next, share: across * along })
    })
}

/// Calls `action(number, [i, r, s])` for every boundary node in the order of the numbers: column `i` of row `r` of
/// slab `s`.
pub(super) fn for_each_boundary_node<D: Dimension>(
    n: usize,
    mut action: impl FnMut(usize, [usize; 3]),
) {
    let mut number = 0;
    for s in 0..=n {
        for at in (Slab { n, s }).rows::<D>() {
            let step = if at.is_inner::<D>() { n } else { 1 };
            for i in (0..=n).step_by(step) {
                action(number, [i, at.r, s]);
                number += 1;
            }
        }
    }
}

/// Boundary nodes in the order of their numbers, with their positions in natural order.
pub(super) fn contact_nodes<D: Dimension>(n: usize) -> Vec<ContactNode> {
    let mut nodes = Vec::with_capacity(boundary_nodes::<D>(n));
    let face = (1.0 / n as f64).powi(D::AXES as i32 - 1);
    for_each_boundary_node::<D>(n, |_, [i, r, s]| {
        let across = if D::AXES == 2 { 1.0 } else { share(n, r) };
        let share = share(n, i) * across * share(n, s);
        nodes.push(ContactNode {
            node: (s * rows_per_slab::<D>(n) + r) * (n + 1) + i,
            measure: 2.0 * share * faces(share) * face,
        });
    });
    nodes
}

/// Energy of a level under the law, up to a factor, with one node after the other.
pub(super) fn energy<D: Dimension>(level: &MultigridLevel) -> f64 {
    let n = level.n;
    let [mut values, mut load] = [vec![0.0; level.nodes], vec![0.0; level.nodes]];
    rows::merge(n, &level.values, 1.0, &mut values);
    rows::merge(n, &level.load, 1.0, &mut load);
    let steps = [1, n + 1, (n + 1) * (n + 1)];
    let mut energy = 0.0;
    for (k, (value, load)) in values.iter().zip(&load).enumerate() {
        let (mut flow, mut part) = (0.0, 1.0);
        for step in &steps[..D::AXES] {
            let i = k / step % (n + 1);
            for neighbour in mirrored(n, i) {
                flow += value - values[k - i * step + neighbour * step];
            }
            part *= share(n, i);
        }
        let limit = if part < 1.0 && *value < 0.0 { level.limit * faces(part) } else { 0.0 };
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
    at: At,
    colour: Colour,
    load: &'a [f64],
    /// Row of the other colour at the same position.
    along: &'a [f64],
    /// The slice that begins one place before `along`.
    before: &'a [f64],
    /// Rows of the other colour in the neighbouring slabs and, on the cube, beside the row in its slab: south, north,
    /// below, above.
    across: [&'a [f64]; 4],
}

impl<'a> StencilRow<'a> {
    /// Takes `load`, the load of the colour on the whole grid, and `other`, the other colour from slab `first` on.
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
        let [below, above] = mirrored(n, s);
        let [south, north] = if D::AXES == 2 { [r, r] } else { mirrored(n, r) };
        let own = ((s - first) * rows + r) * stride;
        Self {
            at,
            colour,
            load: &load[(s * rows + r) * stride..][..stride],
            along: &other[own..][..stride],
            before: &other[own.saturating_sub(1)..][..stride],
            // Written out: a call of `map` is not inlined, and takes as long as a short row.
            across: [
                row_from::<D>(other, first, At { n, r: south, s }),
                row_from::<D>(other, first, At { n, r: north, s }),
                row_from::<D>(other, first, At { n, r, s: below }),
                row_from::<D>(other, first, At { n, r, s: above }),
            ],
        }
    }

    /// Half a sweep over the row. The factor is applied inside; boundary unknowns are minimised exactly.
    #[inline(always)]
    pub(super) fn relax<D: Dimension>(self, boundary: Boundary, factor: f64, target: &mut [f64]) {
        if factor == 1.0 {
            self.update::<D>(
                target,
                |_, _, sum| inverse::<D>() * sum,
                |_, node, sum| boundary.relax::<D>(node, sum),
            );
        } else {
            let (keep, take) = (1.0 - factor, inverse::<D>() * factor);
            self.update::<D>(
                target,
                |_, value, sum| keep * value + take * sum,
                |_, node, sum| boundary.relax::<D>(node, sum),
            );
        }
    }

    /// Sets `target` to the residuals of the row, zero at nodes in contact. Under the law, adds natural
    /// residuals and contact flags to the report.
    #[inline(always)]
    pub(super) fn residual<D: Dimension>(
        self,
        boundary: Boundary,
        values: &[f64],
        target: &mut [f64],
        report: &mut ResidualReport,
    ) {
        let (half, coupling) = (self.at.n / 2, coupling::<D>(self.at.n));
        let inside = &values[..half];
        self.update::<D>(
            target,
            |m, _, sum| sum - diagonal::<D>() * inside[m],
            |m, node, sum| {
                let residual = boundary.residual::<D>(node, coupling, values[m], sum);
                if let Boundary::Law { .. } = boundary {
                    report.add(node, &residual);
                }
                residual.truncated
            },
        );
        if let Boundary::Law { .. } = boundary
            && self.at.is_inner::<D>()
        {
            // The slice begins at the first place, which is aligned; a boundary node there is left out.
            let first = target[0];
            if self.at.is_long(self.colour) {
                target[0] = 0.0;
            }
            report.natural.see(coupling, &target[..half]);
            target[0] = first;
        }
    }

    /// Replaces each value `t` of the row by `inside(m, t, sum)` inside and by `on_boundary(m, node, sum)` at boundary
    /// nodes, where `m` is its place and `sum` the load plus the neighbours.
    ///
    /// The first loop covers the whole row, so that it is aligned. In a long row the first value is that of a boundary
    /// node, which the second loop replaces.
    #[inline(always)]
    fn update<D: Dimension>(
        self,
        target: &mut [f64],
        inside: impl Fn(usize, f64, f64) -> f64,
        mut on_boundary: impl FnMut(usize, BoundaryNode, f64) -> f64,
    ) {
        let Self { at, colour, load, along, before, across } = self;
        if at.is_inner::<D>() {
            let sides = match at.is_long(colour) {
                true => [before, along],
                false => [along, &along[1..]],
            };
            update_slice::<D>(&mut target[..at.n / 2], load, sides, across, inside);
        }
        for (m, node) in edges::<D>(at, colour) {
            target[m] = on_boundary(m, node, self.edge_sum::<D>(m));
        }
    }

    /// Load plus neighbours of a boundary node, mirrored.
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

/// The hot loop of all solvers here. Every slice is at least as long as `target`.
#[inline(always)]
fn update_slice<D: Dimension>(
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
