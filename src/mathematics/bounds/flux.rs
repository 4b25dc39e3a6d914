//! The equilibrated flux: reactions on the boundary, and what has to flow where f is not constant.

use super::data::{AllCells, Cursor, Run, seams};
use crate::discrete::grid::Grid;

/// Reactions on the four sides, without a sign: the normal flux is their linear interpolant over h.
pub(super) struct Reactions {
    pub bottom: Vec<f64>,
    pub top: Vec<f64>,
    pub left: Vec<f64>,
    pub right: Vec<f64>,
}

impl Reactions {
    /// Those of the nodal vector `y`, with the values `outer` on the boundary, none of them negative: `A y - b`
    /// where it is at least y, scaled so that they balance f, whose integral is negative.
    pub(super) fn new(grid: Grid, y: &[f64], outer: &[f64], f: &AllCells) -> Self {
        let (n, nodes) = (grid.cells(), outer.len());
        let mut values: Vec<f64> = grid
            .boundary()
            .enumerate()
            .map(|(b, node)| {
                let [before, after] = [b + nodes - 1, b + 1].map(|b| outer[b % nodes]);
                let along = 0.5 * ((y[node] - before) + (y[node] - after));
                let inner = match b / n {
                    _ if grid.is_corner(b) => node,
                    0 => node + grid.side(),
                    1 => node - 1,
                    2 => node - grid.side(),
                    _ => node + 1,
                };
                let reaction = along + (y[node] - y[inner]) - f.outer[b];
                if reaction > 0.0 && reaction >= y[node] { reaction } else { 0.0 }
            })
            .collect();
        let balance = |values: &[f64]| -f.integral / values.iter().sum::<f64>();
        if !balance(&values).is_finite() {
            // The vector shows none: alike where it rests, or else everywhere.
            let rests = outer.contains(&0.0);
            values = outer.iter().map(|&y| f64::from(!rests || y == 0.0)).collect();
        }
        let balanced = balance(&values);
        values.iter_mut().for_each(|value| *value *= balanced);
        values.push(values[0]);
        let side = |k: usize| values[k * n..=(k + 1) * n].to_vec();
        let [bottom, right, mut top, mut left] = [0, 1, 2, 3].map(side);
        top.reverse();
        left.reverse();
        Self { bottom, top, left, right }
    }
}

/// Fluxes through the half edges around a node, counter-clockwise: from the cell below to the one above
/// the edge east, and so on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Around {
    pub east: f64,
    pub north: f64,
    pub west: f64,
    pub south: f64,
}

impl Around {
    /// The fluxes of least norm that move what the cells ne, nw, sw, se have too much of; none flows along a straight
    /// seam. Beyond the boundary f is reflected.
    fn balancing([ne, nw, sw, se]: [Option<f64>; 4]) -> Self {
        let [ne, nw, sw, se] = [ne.or(se), nw.or(sw), sw.or(nw), se.or(ne)];
        let all = [ne.or(nw), nw.or(ne), sw.or(se), se.or(sw)];
        let [ne, nw, sw, se] = all.map(|mass| mass.expect("a node has cells"));
        let flow = |near: f64, far: f64| 0.125 * (3.0 * near + far);
        Self {
            east: flow(ne - se, nw - sw),
            north: flow(nw - ne, sw - se),
            west: flow(sw - nw, se - ne),
            south: flow(se - sw, ne - nw),
        }
    }
}

/// [`Around`] for one row of nodes; zero but at the seams of f.
#[derive(Clone, Debug)]
pub(super) struct NodeFluxes {
    pub seams: Vec<[usize; 2]>,
    around: Vec<Around>,
}

impl NodeFluxes {
    pub(super) fn zero(n: usize) -> Self {
        Self { seams: Vec::new(), around: vec![Around::default(); n + 1] }
    }

    /// Replaces this by the row between two rows of cells; one that is missing is empty.
    pub(super) fn set(&mut self, below: &[Run], above: &[Run]) {
        for &[from, to] in &self.seams {
            self.around[from..=to].fill(Around::default());
        }
        seams(below, above, &mut self.seams);
        let n = self.around.len() - 1;
        let mut rows = [below, above].map(Cursor);
        let mut column = |cell: Option<usize>| {
            let cell = cell.filter(|&cell| cell < n);
            rows.each_mut()
                .map(|row| cell.filter(|_| !row.0.is_empty()).map(|cell| row.at(cell).f.masses()))
        };
        for &[from, to] in &self.seams {
            let mut west = column(from.checked_sub(1));
            for i in from..=to {
                let east = column(Some(i));
                let [[sw, se], [nw, ne]] = [0, 1].map(|row| [west[row], east[row]]);
                let at = |masses: Option<[f64; 4]>, corner: usize| masses.map(|m| m[corner]);
                self.around[i] = Around::balancing([at(ne, 0), at(nw, 1), at(sw, 3), at(se, 2)]);
                west = east;
            }
        }
    }
}

/// The fluxes through the edges of cell `i` between two rows of nodes: left, right, bottom, top.
#[inline(always)]
pub(super) fn through_edges(lower: &NodeFluxes, upper: &NodeFluxes, i: usize) -> [f64; 4] {
    let (lower, upper) = (&lower.around, &upper.around);
    [
        upper[i].south - lower[i].north,
        upper[i + 1].south - lower[i + 1].north,
        lower[i].east - lower[i + 1].west,
        upper[i].east - upper[i + 1].west,
    ]
}
