//! The equilibrated flux: reactions on the boundary, and what has to flow where f is not constant.

use super::data::{AllCells, CellRow, seams};
use crate::discrete::grid::Grid;

/// Reactions on the four sides, without a sign: the normal flux is their linear interpolant over h.
pub(super) struct Reactions {
    /// In boundary order; all zero where the vector shows none, and those of the sides are made up.
    pub found: Vec<f64>,
    pub bottom: Vec<f64>,
    pub top: Vec<f64>,
    pub left: Vec<f64>,
    pub right: Vec<f64>,
}

impl Reactions {
    /// Those of the nodal vector `y`, not negative on the boundary: `A y - b` where it is at least y,
    /// scaled so that they balance f, whose integral is negative.
    pub(super) fn new(grid: Grid, y: &[f64], f: &AllCells) -> Self {
        let n = grid.cells();
        let at = |i: usize, j: usize| y[grid.index(i, j)];
        let mut found: Vec<f64> = (0..grid.boundary_nodes())
            .map(|b| {
                let (i, j) = grid.boundary_node(b);
                let (mut flux, mut load) = (0.0, 0.0);
                for (di, dj, corner) in [(0, 0, 3), (1, 0, 2), (0, 1, 1), (1, 1, 0)] {
                    // The cell for which this node is that corner.
                    if (i + di == 0) || (j + dj == 0) || i + di > n || j + dj > n {
                        continue;
                    }
                    load += f.mass([i + di - 1, j + dj - 1], corner);
                    let (across, along) =
                        (if di == 0 { i - 1 } else { i + 1 }, if dj == 0 { j - 1 } else { j + 1 });
                    flux += 0.5 * ((at(i, j) - at(across, j)) + (at(i, j) - at(i, along)));
                }
                let reaction = flux - load;
                if reaction > 0.0 && reaction >= at(i, j) { reaction } else { 0.0 }
            })
            .collect();
        let balanced = -f.integral / found.iter().sum::<f64>();
        let mut values = found.clone();
        if balanced.is_finite() {
            found.iter_mut().for_each(|value| *value *= balanced);
            values.copy_from_slice(&found);
        } else {
            values.fill(-f.integral / grid.boundary_nodes() as f64);
        }
        let side = |from: usize| (0..=n).map(move |k| (from + k) % (4 * n));
        let collect = |places: &mut dyn Iterator<Item = usize>| places.map(|b| values[b]).collect();
        Self {
            bottom: collect(&mut side(0)),
            right: collect(&mut side(n)),
            top: collect(&mut side(2 * n).rev()),
            left: collect(&mut side(3 * n).rev()),
            found,
        }
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

/// [`Around`] for one row of nodes; zero but at the seams of f.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeFluxes {
    pub seams: Vec<[usize; 2]>,
    pub around: Vec<Around>,
}

impl NodeFluxes {
    pub(super) fn zero(n: usize) -> Self {
        Self { seams: Vec::new(), around: vec![Around::default(); n + 1] }
    }

    /// Replaces this by the row between two rows of cells; one of them may be missing.
    pub(super) fn set(&mut self, below: Option<&CellRow>, above: Option<&CellRow>) {
        for &[from, to] in &self.seams {
            self.around[from..=to].fill(Around::default());
        }
        seams(below, above, &mut self.seams);
        let n = self.around.len() - 1;
        let mass = |row: Option<&CellRow>, cell: Option<usize>, corner: usize| {
            let cell = cell.filter(|&cell| cell < n)?;
            row.map(|row| row.mass(cell, corner))
        };
        for &[from, to] in &self.seams {
            for i in from..=to {
                let (west, east) = (i.checked_sub(1), Some(i));
                let cells = [
                    mass(above, east, 0),
                    mass(above, west, 1),
                    mass(below, west, 3),
                    mass(below, east, 2),
                ];
                self.around[i] = Around::balancing(cells);
            }
        }
    }
}

impl Around {
    /// The fluxes of least norm that move what the cells ne, nw, sw, se have too much of.
    fn balancing(masses: [Option<f64>; 4]) -> Self {
        let count = masses.iter().flatten().count();
        let mean = masses.iter().flatten().sum::<f64>() / count as f64;
        let zero = Self::default();
        match masses.map(|mass| mass.map(|mass| mass - mean)) {
            [Some(ne), Some(nw), Some(sw), Some(_)] => {
                let east = 0.25 * (3.0 * ne + 2.0 * nw + sw);
                let north = east - ne;
                let west = north - nw;
                Self { east, north, west, south: west - sw }
            }
            [Some(ne), None, None, Some(_)] => Self { east: ne, ..zero },
            [None, Some(nw), Some(_), None] => Self { west: -nw, ..zero },
            [Some(ne), Some(_), None, None] => Self { north: -ne, ..zero },
            [None, None, Some(sw), Some(_)] => Self { south: -sw, ..zero },
            _ => zero,
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
