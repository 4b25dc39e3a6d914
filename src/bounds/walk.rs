//! The sweep over the cells: one pass over the vector, row by row, with arrays of the length of a row.

use super::cells::{Strip, Sums};
use super::data::{AllCells, CellRow};
use super::flux::{NodeFluxes, Reactions, through_edges};
use super::recovery::{EdgeRow, NodeRow, admissible, union};
use super::residual::Pyramid;
use super::{NoBound, contact};
use crate::discrete::contact::ContactArc;
use crate::discrete::grid::Grid;
use crate::discrete::simd::vectorised;
use crate::problem::source::Source;
use std::borrow::Cow;

/// The sums over all cells, and what the boundary adds.
pub(super) struct Total {
    pub sums: Sums,
    /// `<sigma.n, w>`, the work of the reactions on the recovery.
    pub work: f64,
    /// A bound of the flux that the residual takes.
    pub residual: f64,
    /// The largest |v|.
    pub largest: f64,
    /// Integral of |f|.
    pub mass: f64,
    pub contact: Vec<ContactArc>,
}

/// The sums for the nodal vector `v`, which is not negative on the boundary.
///
/// `recovered`, if given, receives the recovery on the grid of half the width.
pub(super) fn total(
    grid: Grid,
    f: &Source,
    v: &[f64],
    recovered: Option<&mut [f64]>,
) -> Result<Total, NoBound> {
    let data = AllCells::new(grid, f);
    if data.integral >= 0.0 {
        return Err(NoBound::NotCoercive);
    }
    let walk = Walk::new(grid, &data, v, recovered);
    Ok(vectorised(
        #[inline(always)]
        || walk.run(),
    ))
}

/// Rows of cells whose sums are added up before they join the others.
const BLOCK: usize = 64;

struct Walk<'a> {
    grid: Grid,
    data: &'a AllCells<'a>,
    v: &'a [f64],
    reactions: Reactions,
    /// Rows j to j + 2 of cells, where j is the row at which the walk stands.
    cells: [Cow<'a, CellRow>; 3],
    /// Fluxes around the nodes of rows j - 1 to j + 2.
    fluxes: [NodeFluxes; 4],
    /// Rows j and j + 1 of nodes.
    nodes: [NodeRow; 2],
    /// The vertical edges between them.
    edges: EdgeRow,
    /// Differences over the vertical edges above.
    above: Vec<f64>,
    pyramid: Pyramid,
    total: Total,
    /// The sums over the last rows, at most [`BLOCK`].
    block: Sums,
    /// Sum of the squares of residuals that are rounding errors, each times `h^2`.
    noise: f64,
    recovered: Option<&'a mut [f64]>,
}

impl<'a> Walk<'a> {
    fn new(
        grid: Grid,
        data: &'a AllCells<'a>,
        v: &'a [f64],
        recovered: Option<&'a mut [f64]>,
    ) -> Self {
        let n = grid.cells();
        let mass = |i, j| data.at(i, j).masses();
        let reactions = Reactions::new(grid, v, mass, data.integral);
        let outer: Vec<f64> = grid.boundary().map(|node| v[node]).collect();
        let contact = contact::arcs(grid, &outer, &reactions.found);
        let sums = Sums::default();
        Self {
            grid,
            data,
            v,
            reactions,
            cells: [0; 3].map(|_| Cow::Owned(CellRow::default())),
            fluxes: [0; 4].map(|_| NodeFluxes::zero(n)),
            nodes: [NodeRow::new(n), NodeRow::new(n)],
            edges: EdgeRow::new(n),
            above: vec![0.0; n + 1],
            pyramid: Pyramid::new(n),
            total: Total { sums, work: 0.0, residual: 0.0, largest: 0.0, mass: 0.0, contact },
            block: Sums::default(),
            noise: 0.0,
            recovered,
        }
    }

    #[inline(always)]
    fn run(mut self) -> Total {
        let n = self.grid.cells();
        [self.cells[1], self.cells[2]] = [self.data.row(0), self.data.row(1)];
        self.fluxes[2].set(None, Some(&self.cells[1]));
        self.fluxes[3].set(Some(&self.cells[1]), Some(&self.cells[2]));
        self.nodes_up_to(0);
        for j in 0..n {
            self.cells.rotate_left(1);
            if j + 2 < n {
                self.cells[2] = self.data.row(j + 2);
            }
            self.fluxes.rotate_left(1);
            let row = |k: usize| (j + k < n).then(|| &*self.cells[k]);
            self.fluxes[3].set(row(1), row(2));
            self.nodes_up_to(j + 1);
            self.edges_of(j);
            if let Some(recovered) = &mut self.recovered {
                evaluate(&self.nodes, &self.edges, j, recovered);
            }
            let residuals = self.sum(j);
            self.pyramid.push(residuals);
            if (j + 1).is_multiple_of(BLOCK) || j + 1 == n {
                self.total.sums.add(&std::mem::take(&mut self.block));
            }
        }
        let Self { total, pyramid, noise, .. } = &mut self;
        // Inside regular cells the residual is bilinear: what it differs from its mean by has at most a
        // twelfth of the squares at the corners, and Poincaré's constant h / pi.
        let inside = (total.sums.residual / 12.0).sqrt();
        total.residual =
            pyramid.bound() + (inside + n as f64 * noise.sqrt()) / std::f64::consts::PI;
        self.total
    }

    fn values(&self, j: usize) -> &'a [f64] {
        let side = self.grid.side();
        &self.v[j * side..(j + 1) * side]
    }

    /// Makes row `j` the upper one of the rows of nodes, with the fluxes around it in `fluxes[2]`.
    #[inline(always)]
    fn nodes_up_to(&mut self, j: usize) {
        let n = self.grid.cells();
        let v = self.values(j);
        self.nodes.swap(0, 1);
        std::mem::swap(&mut self.edges.along, &mut self.above);
        // Beyond the boundary: reflection, and twice the reaction.
        if j == 0 {
            let (inner, reactions) = (self.values(1), &self.reactions.bottom);
            for (i, below) in self.edges.along.iter_mut().enumerate() {
                *below = v[i] - inner[i] - 2.0 * reactions[i];
            }
        }
        if j == n {
            let (inner, reactions) = (self.values(n - 1), &self.reactions.top);
            for (i, above) in self.above.iter_mut().enumerate() {
                *above = inner[i] - v[i] + 2.0 * reactions[i];
            }
        } else {
            let next = self.values(j + 1);
            for (above, (next, here)) in self.above.iter_mut().zip(next.iter().zip(v)) {
                *above = next - here;
            }
        }
        let row = &mut self.nodes[1];
        let ends = [self.reactions.left[j], self.reactions.right[j]];
        row.set(v, &self.edges.along, &self.above, ends);
        self.total.largest = self.total.largest.max(row.largest());
        let [_, lower, here, upper] = &self.fluxes;
        row.follow_seams([lower, here, upper], [j == 0, j == n]);
        if j == 0 || j == n {
            let reactions = if j == 0 { &self.reactions.bottom } else { &self.reactions.top };
            for i in 0..n {
                row.bubble[i] = admissible(row.bubble[i], v[i], v[i + 1]);
                self.total.work += work(&v[i..], &reactions[i..], row.bubble[i]);
            }
        }
    }

    /// Completes the vertical edges of row `j` of cells.
    #[inline(always)]
    fn edges_of(&mut self, j: usize) {
        let [lower, upper] = &self.nodes;
        self.edges.set(&lower.across, &upper.across);
        self.edges.follow_seams(&self.fluxes[1], &self.fluxes[2]);
        let n = self.grid.cells();
        for (i, reactions) in [(0, &self.reactions.left), (n, &self.reactions.right)] {
            let (v, bubble) = ([lower.v[i], upper.v[i]], &mut self.edges.bubble[i]);
            *bubble = admissible(*bubble, v[0], v[1]);
            self.total.work += work(&v, &reactions[j..], *bubble);
        }
    }

    /// Adds row `j` of cells; returns the residuals in it times `h^2`, nothing if they are zero.
    #[inline(always)]
    fn sum(&mut self, j: usize) -> Vec<f64> {
        let n = self.grid.cells();
        let strip = Strip { lower: &self.nodes[0], upper: &self.nodes[1], edges: &self.edges };
        let cells = &self.cells[0];
        let Total { mass: whole, largest, .. } = &mut self.total;
        let sums = &mut self.block;
        // Where a residual can only be a rounding error.
        let floor = 16.0 * f64::EPSILON * *largest;
        let (mut residuals, mut start) = (Vec::new(), 0);
        for [from, to] in special(n, j, &self.fluxes).into_iter().chain([[n, n]]) {
            while start < from {
                let (end, mass) = cells.constant(start);
                let run = start..end.min(from);
                let part = strip.regular(run.clone(), mass);
                sums.add(&part);
                *whole += mass.abs() * run.len() as f64;
                if part.residual > 4.0 * run.len() as f64 * floor * floor {
                    residuals.resize(n, 0.0);
                    strip.residuals(run.clone(), mass, &mut residuals);
                } else {
                    self.noise += 0.25 * part.residual;
                }
                start = run.end;
            }
            for i in from..n.min(to + 1) {
                let flux = through_edges(&self.fluxes[1], &self.fluxes[2], i);
                let moments = cells.at(i);
                let outer = [i == 0, i == n - 1, j == 0, j == n - 1];
                let (part, residual) = strip.special(i, &moments, flux, outer);
                sums.add(&part);
                *whole += moments.square.sqrt();
                if residual.abs() > floor {
                    residuals.resize(n, 0.0);
                    residuals[i] = residual;
                } else {
                    self.noise += residual * residual;
                }
            }
            start = to + 1;
        }
        residuals
    }
}

/// The cells of row `j` that need more than the regular formulas, as inclusive ranges: those at the
/// boundary, and those within two cells of a seam of f.
fn special(n: usize, j: usize, fluxes: &[NodeFluxes; 4]) -> Vec<[usize; 2]> {
    if j == 0 || j == n - 1 {
        return vec![[0, n - 1]];
    }
    let seams = fluxes.iter().map(|row| &row.seams[..]);
    union(n, seams.chain([&[[0, 0], [n, n]][..]]), [2, 1])
}

/// Writes what the recovery is at the nodes, the middles of edges and the centres of row `j` of cells to its
/// rows of the grid of half the width.
fn evaluate([lower, upper]: &[NodeRow; 2], edges: &EdgeRow, j: usize, out: &mut [f64]) {
    let n = lower.bubble.len();
    let side = 2 * n + 1;
    let on_nodes = |row: &NodeRow, out: &mut [f64]| {
        for i in 0..n {
            out[2 * i] = row.v[i];
            out[2 * i + 1] = 0.5 * (row.v[i] + row.v[i + 1]) - 0.25 * row.bubble[i];
        }
        out[2 * n] = row.v[n];
    };
    let out = &mut out[2 * j * side..(2 * j + 3) * side];
    on_nodes(lower, &mut out[..side]);
    on_nodes(upper, &mut out[2 * side..]);
    let middle = &mut out[side..2 * side];
    for i in 0..=n {
        middle[2 * i] = 0.5 * (lower.v[i] + upper.v[i]) - 0.25 * edges.bubble[i];
    }
    for i in 0..n {
        let corners = (lower.v[i] + lower.v[i + 1]) + (upper.v[i] + upper.v[i + 1]);
        let bubbles = (lower.bubble[i] + upper.bubble[i]) + (edges.bubble[i] + edges.bubble[i + 1]);
        middle[2 * i + 1] = 0.25 * corners - 0.125 * bubbles;
    }
}

/// The work of the reactions `a` at the ends of an edge on the function there, with values `v`.
fn work(v: &[f64], a: &[f64], bubble: f64) -> f64 {
    let linear = a[0] * (2.0 * v[0] + v[1]) + a[1] * (v[0] + 2.0 * v[1]);
    linear / 6.0 - bubble * (a[0] + a[1]) / 12.0
}
