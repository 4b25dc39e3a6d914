//! The equilibrated flux: reactions on the boundary, and the fluxes that f requires where it is not constant.

use super::data::{AllCells, ColumnSpan, Cursor, MomentRun, find_seams};
use crate::bounds::boundary::{BoundaryPart, PartLaw, Slips, shift_to_sum};
use crate::discrete::grid::Grid;
use crate::problem::law::Law;

/// Reactions on the four sides, h times fluxes that the law allows. The normal flux is their linear interpolant over h.
pub(super) struct Reactions {
    pub bottom: Vec<f64>,
    pub top: Vec<f64>,
    pub left: Vec<f64>,
    pub right: Vec<f64>,
    /// Upper bound of the integral of `|sigma.n|`, besides what balances f, and of the law's term over the size of v:
    /// zero for the paper's law.
    pub flow: f64,
    /// Ends of the interval that the reactions reach; both ends of one that is not bounded count as reached if finite.
    pub slips: Slips,
}

impl Reactions {
    /// Computes the reactions of the nodal vector `y` with the boundary values `outer`, which the law allows. The law
    /// must be able to balance the integral of f.
    ///
    /// The reaction is `A y - b` where that is inside the interval of the law even when lessened by y, otherwise the
    /// end of the interval. What f still needs is spread over the nodes inside the interval.
    pub(super) fn new(grid: Grid, law: Law, y: &[f64], outer: &[f64], f: &AllCells) -> Self {
        let (n, nodes) = (grid.cells(), outer.len());
        let mut values = Vec::with_capacity(nodes + 1);
        for (b, node) in grid.boundary().enumerate() {
            let [before, after] = [b + nodes - 1, b + 1].map(|b| outer[b % nodes]);
            let along = 0.5 * ((y[node] - before) + (y[node] - after));
            let inner = match b / n {
                _ if grid.is_corner(b) => node,
                0 => node + grid.side(),
                1 => node - 1,
                2 => node - grid.side(),
                _ => node + 1,
            };
            values.push(along + (y[node] - y[inner]) - f.boundary_masses[b]);
        }
        let of_nodes = PartLaw::new(law, grid.h());
        let (flow, slips);
        if law.is_bounded() {
            let largest = shift_reactions(law, outer, f.integral, &mut values, grid.h());
            // An end that plays no part may be far from all reactions.
            flow = nodes as f64 * largest.max(of_nodes.ends_in_use(outer));
            slips = Slips {
                up: values.iter().any(|value| *value <= of_nodes.least),
                down: values.iter().any(|value| *value >= of_nodes.most),
            };
        } else {
            scale_reactions(of_nodes, outer, f.integral, &mut values);
            (flow, slips) = (Grid::PERIMETER * finite_size(law), Slips::ALL.and(law));
        }
        values.push(values[0]);
        let [bottom, right, mut top, mut left] =
            [0, 1, 2, 3].map(|side| values[side * n..=(side + 1) * n].to_vec());
        top.reverse();
        left.reverse();
        Self { bottom, top, left, right, flow, slips }
    }
}

/// Limits the reactions to an interval that is bounded on one side, and scales what they exceed that end by, so that
/// they balance f.
fn scale_reactions(law: PartLaw, outer: &[f64], integral: f64, values: &mut [f64]) {
    let (end, sign) = if law.least.is_finite() { (law.least, 1.0) } else { (law.most, -1.0) };
    for (value, &y) in values.iter_mut().zip(outer) {
        let above = sign * (*value - end);
        *value = if above > 0.0 && above >= sign * y { above } else { 0.0 };
    }
    let needed = sign * (-integral - end * outer.len() as f64);
    if !(needed / values.iter().sum::<f64>()).is_finite() {
        // No reaction exceeds the end: equal ones where y is zero, or at all nodes if it is zero nowhere.
        let is_zero_somewhere = outer.contains(&0.0);
        for (value, &y) in values.iter_mut().zip(outer) {
            *value = f64::from(!is_zero_somewhere || y == 0.0);
        }
    }
    let balance = needed / values.iter().sum::<f64>();
    values.iter_mut().for_each(|value| *value = sign * (*value * balance) + end);
}

/// Limits the reactions to a bounded interval, and shifts them so that they balance f: scaled ones could leave the
/// interval. Returns the largest absolute value of a reaction before or after the shift.
fn shift_reactions(law: Law, outer: &[f64], integral: f64, values: &mut [f64], h: f64) -> f64 {
    let of_nodes = PartLaw::new(law, h);
    let mut parts = Vec::with_capacity(outer.len());
    for (&reaction, &y) in values.iter().zip(outer) {
        let flux = if y > 0.0 && y > reaction - of_nodes.least {
            of_nodes.least
        } else if y < 0.0 && y < reaction - of_nodes.most {
            of_nodes.most
        } else {
            of_nodes.clamp(reaction)
        };
        parts.push(BoundaryPart { flux, measure: h, law: of_nodes });
    }
    let before = largest_flux(&parts);
    shift_to_sum(&mut parts, -integral);
    values.iter_mut().zip(&parts).for_each(|(value, part)| *value = part.flux);
    before.max(largest_flux(&parts))
}

fn largest_flux(parts: &[BoundaryPart]) -> f64 {
    parts.iter().fold(0.0, |largest, part| part.flux.abs().max(largest))
}

/// Sum of the absolute values of the finite ends of the interval of a law.
fn finite_size(law: Law) -> f64 {
    [law.lo(), law.hi()].into_iter().filter(|end| end.is_finite()).map(f64::abs).sum()
}

/// Fluxes through the half edges around a node, counter-clockwise: `east` from the cell below to the cell above the
/// edge east of the node, and so on.
#[derive(Clone, Copy, Debug, Default)]
struct HalfEdgeFluxes {
    east: f64,
    north: f64,
    west: f64,
    south: f64,
}

/// Masses of f in the quarter of each of four cells around a node; `None` beyond the boundary.
#[derive(Clone, Copy)]
struct CellsAround {
    ne: Option<f64>,
    nw: Option<f64>,
    sw: Option<f64>,
    se: Option<f64>,
}

impl HalfEdgeFluxes {
    /// Fluxes of least norm that equalise the masses of the cells. No flux runs along a straight seam. Beyond the
    /// boundary f is reflected.
    fn balancing(CellsAround { ne, nw, sw, se }: CellsAround) -> Self {
        let [ne, nw, sw, se] = [ne.or(se), nw.or(sw), sw.or(nw), se.or(ne)];
        let all = [ne.or(nw), nw.or(ne), sw.or(se), se.or(sw)];
        let [ne, nw, sw, se] = all.map(|mass| mass.expect("a node has cells"));
        Self {
            east: half_edge_flux(ne - se, nw - sw),
            north: half_edge_flux(nw - ne, sw - se),
            west: half_edge_flux(sw - nw, se - ne),
            south: half_edge_flux(se - sw, ne - nw),
        }
    }
}

/// Flux through a half edge, from the jump of the mass across it and across the opposite half edge.
fn half_edge_flux(near: f64, far: f64) -> f64 {
    0.125 * (3.0 * near + far)
}

/// Fluxes around the nodes of one row; zero except at the seams of f.
#[derive(Clone, Debug)]
pub(super) struct NodeFluxes {
    pub seams: Vec<ColumnSpan>,
    fluxes: Vec<HalfEdgeFluxes>,
}

impl NodeFluxes {
    pub(super) fn zero(n: usize) -> Self {
        Self { seams: Vec::new(), fluxes: vec![HalfEdgeFluxes::default(); n + 1] }
    }

    /// Replaces the row of nodes by the one between two rows of cells; a missing row of cells is empty.
    pub(super) fn set(&mut self, below: &[MomentRun], above: &[MomentRun]) {
        for span in &self.seams {
            self.fluxes[span.first..=span.last].fill(HalfEdgeFluxes::default());
        }
        find_seams(below, above, &mut self.seams);
        let n = self.fluxes.len() - 1;
        let (mut below, mut above) = (Cursor(below), Cursor(above));
        for &ColumnSpan { first, last } in &self.seams {
            let west = first.checked_sub(1);
            let [mut sw, mut nw] =
                [&mut below, &mut above].map(|row| west.and_then(|cell| masses(row, cell)));
            for i in first..=last {
                let [se, ne] =
                    [&mut below, &mut above].map(|row| if i < n { masses(row, i) } else { None });
                self.fluxes[i] = HalfEdgeFluxes::balancing(CellsAround {
                    ne: ne.map(|masses| masses[0]),
                    nw: nw.map(|masses| masses[1]),
                    sw: sw.map(|masses| masses[3]),
                    se: se.map(|masses| masses[2]),
                });
                (sw, nw) = (se, ne);
            }
        }
    }
}

/// Integrals of f times the hat functions of the corners of a cell; `None` if the row is empty.
fn masses(row: &mut Cursor, cell: usize) -> Option<[f64; 4]> {
    (!row.0.is_empty()).then(|| row.at(cell).f.masses())
}

/// Fluxes through the edges of a cell, in the direction of x or y.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EdgeFluxes {
    pub left: f64,
    pub right: f64,
    pub bottom: f64,
    pub top: f64,
}

impl EdgeFluxes {
    /// Flux out of the cell less flux into it, along x and along y.
    #[inline(always)]
    pub(super) fn changes(self) -> [f64; 2] {
        [self.right - self.left, self.top - self.bottom]
    }
}

/// Fluxes through the edges of cell `i` between two rows of nodes.
#[inline(always)]
pub(super) fn through_edges(lower: &NodeFluxes, upper: &NodeFluxes, i: usize) -> EdgeFluxes {
    let (lower, upper) = (&lower.fluxes, &upper.fluxes);
    EdgeFluxes {
        left: upper[i].south - lower[i].north,
        right: upper[i + 1].south - lower[i + 1].north,
        bottom: lower[i].east - lower[i + 1].west,
        top: upper[i].east - upper[i + 1].west,
    }
}
