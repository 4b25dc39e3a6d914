//! The exact rule: integrals of f times the hat functions, in closed form for constant pieces.

use super::by_rows;
use crate::discrete::cells::{Cells, Moments, bilinear};
use crate::discrete::grid::Grid;
use crate::discrete::load::Diagonal;
use crate::discrete::quadrature::{QuadraturePoint, quadrature};
use crate::problem::source::Source;

/// Contribution of a row of cells to the load: the value of f on each cell, and for those where it is not
/// constant 0, and apart from that the integrals of f times the hats of the corners, over h^2.
#[derive(Clone, Default)]
struct HatRow {
    values: Vec<f64>,
    cut: Vec<(usize, Corners)>,
}

/// One number for the lower left, lower right, upper left and upper right corner of a cell.
type Corners = [f64; 4];

/// The load vector of `f`: for hats that are linear on triangles cut by a diagonal, or bilinear on squares.
pub(super) fn exact(grid: Grid, f: &Source, diagonal: Option<Diagonal>) -> Vec<f64> {
    let (n, side, h) = (grid.cells(), grid.side(), grid.h());
    let points = quadrature();
    by_rows(grid, |first, block| {
        let mut cells = match f {
            Source::Pieces { background, pieces } => Some(Cells::new(grid, *background, pieces)),
            Source::Exact(_) | Source::Formula(_) => None,
        };
        let mut read = |j: usize, row: &mut HatRow| {
            row.values.resize(n, 0.0);
            row.cut.clear();
            match &mut cells {
                None => {
                    let corners = |i| (i, smooth_corners(grid, f, diagonal, &points, [i, j]));
                    row.cut.extend((0..n).map(corners));
                }
                Some(cells) => {
                    let HatRow { values, cut } = row;
                    cells.row(j, values, |i, cell| {
                        let corners = match diagonal {
                            None => bilinear(cell.moments().first()),
                            Some(cut) => corners(cell.triangles(cut == Diagonal::Rising), cut),
                        };
                        cut.push((i, corners));
                    });
                }
            }
        };
        let (mut below, mut above) = (HatRow::default(), HatRow::default());
        if first > 0 {
            read(first - 1, &mut above);
        }
        for (j, row) in (first..).zip(block.chunks_exact_mut(side)) {
            std::mem::swap(&mut below, &mut above);
            if j < n {
                read(j, &mut above);
            }
            let rows = [(j > 0).then_some(&below), (j < n).then_some(&above)];
            add_constant(rows.map(|row| row.map(|row| &row.values[..])), diagonal, row);
            for (row_of_cells, at) in rows.iter().zip([[2, 3], [0, 1]]) {
                for &(i, corners) in row_of_cells.iter().flat_map(|row| &row.cut) {
                    row[i] += corners[at[0]];
                    row[i + 1] += corners[at[1]];
                }
            }
            row.iter_mut().for_each(|value| *value *= h * h);
        }
    })
}

/// Writes to a row of nodes what cells below and above it with constant f give them, over h^2.
fn add_constant(rows: [Option<&[f64]>; 2], diagonal: Option<Diagonal>, out: &mut [f64]) {
    // Integrals of the hats of a cell's lower left and upper right corner, and of the other two.
    let (ending, other) = match diagonal {
        None => (0.25, 0.25),
        Some(Diagonal::Rising) => (1.0 / 3.0, 1.0 / 6.0),
        Some(Diagonal::Falling) => (1.0 / 6.0, 1.0 / 3.0),
    };
    let n = out.len() - 1;
    // Differences, so that a constant f gives the value of f itself times the weight.
    match rows {
        [Some(s), Some(north)] => {
            for i in 1..n {
                let (sw, se, nw, ne) = (s[i - 1], s[i], north[i - 1], north[i]);
                out[i] = ne + ending * (sw - ne) + other * ((nw - ne) + (se - ne));
            }
            out[0] = 0.5 * north[0] + other * (s[0] - north[0]);
            out[n] = 0.5 * s[n - 1] + other * (north[n - 1] - s[n - 1]);
        }
        [None, Some(north)] => {
            for i in 1..n {
                out[i] = 0.5 * north[i] + other * (north[i - 1] - north[i]);
            }
            (out[0], out[n]) = (ending * north[0], other * north[n - 1]);
        }
        [Some(s), None] => {
            for i in 1..n {
                out[i] = 0.5 * s[i] + ending * (s[i - 1] - s[i]);
            }
            (out[0], out[n]) = (other * s[0], ending * s[n - 1]);
        }
        [None, None] => unreachable!("every row of nodes has cells beside it"),
    }
}

/// The corners' shares of f on the triangles below and above a diagonal.
fn corners([below, above]: [Moments; 2], diagonal: Diagonal) -> Corners {
    let ([bf, bx, by, ..], [af, ax, ay, ..]) = (below.f, above.f);
    match diagonal {
        Diagonal::Rising => {
            [0.5 * bf - bx + (0.5 * af - ay), bx - by, ay - ax, 0.5 * bf + by + (0.5 * af + ax)]
        }
        Diagonal::Falling => {
            [-bx - by, 0.5 * bf + bx + (0.5 * af - ay), 0.5 * bf + by + (0.5 * af - ax), ax + ay]
        }
    }
}

/// The corners' shares of a smooth f on a cell, by quadrature.
fn smooth_corners(
    grid: Grid,
    f: &Source,
    diagonal: Option<Diagonal>,
    points: &[QuadraturePoint<3>],
    [i, j]: [usize; 2],
) -> Corners {
    let at = |k: usize| [grid.coordinate(i + (k & 1)), grid.coordinate(j + (k >> 1))];
    let triangles = match diagonal {
        None | Some(Diagonal::Rising) => [[0, 1, 3], [0, 3, 2]],
        Some(Diagonal::Falling) => [[0, 1, 2], [1, 3, 2]],
    };
    let mut corners = [0.0; 4];
    for triangle in triangles {
        let vertices = triangle.map(at);
        for point in points {
            let hats = point.barycentric;
            let mass = 0.5 * point.weight * f.at(point.within(vertices));
            let mut add = |k: usize, hat: f64| corners[k] += mass * hat;
            match diagonal {
                Some(_) => triangle.into_iter().zip(hats).for_each(|(k, hat)| add(k, hat)),
                None => {
                    // What a corner to the right, or above, adds to the place in the cell.
                    let place = |bit: usize| -> f64 {
                        let there = triangle.into_iter().zip(hats).filter(|(k, _)| k & bit != 0);
                        there.map(|(_, hat)| hat).sum()
                    };
                    let (x, y) = (place(1), place(2));
                    let hats = [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y];
                    hats.into_iter().enumerate().for_each(|(k, hat)| add(k, hat));
                }
            }
        }
    }
    corners
}
