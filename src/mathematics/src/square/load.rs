//! Load vectors (6): F_i, the integral of f times the i-th hat function, by one of several rules.

mod exact;

use crate::discrete::cells::Cells;
use crate::discrete::grid::{Grid, MIN_CELLS};
use crate::discrete::load::{Diagonal, LoadRule};
use crate::machine::threads::{TASK, for_runs, items_per_task};
use crate::mesh::{lattice_mesh, mesh_load, uniform_square};
use crate::problem::side::TiedRow;
use crate::problem::source::{Source, Tie};
use exact::exact;

/// The load vector of `f` on `grid`, a nodal vector, the same whatever the number of threads.
pub fn load(grid: Grid, f: &Source, rule: LoadRule) -> Vec<f64> {
    match rule {
        LoadRule::Nodal { tie, diagonal } => nodal(grid, f, tie, diagonal),
        LoadRule::Exact { diagonal } => exact(grid, f, Some(diagonal)),
        LoadRule::Bilinear {} => exact(grid, f, None),
    }
}

/// The integral of f over the square: exact for constant pieces, sampled for smooth f.
pub fn integral(f: &Source) -> f64 {
    let grid = |cells| Grid::new(cells).expect("not below the least");
    match f {
        // Any grid will do, best one with few pieces in each cell.
        Source::Pieces { background, pieces } => {
            let grid = grid(pieces.len().clamp(MIN_CELLS, 256).next_power_of_two());
            let (mut cells, mut row) =
                (Cells::new(grid, *background, pieces), vec![0.0; grid.cells()]);
            let rows = (0..grid.cells()).map(|j| {
                let mut cut = Vec::new();
                cells.row(j, &mut row, |i, cell| cut.push((i, cell.moments().f[0])));
                cut.iter().for_each(|&(i, mean)| row[i] = mean);
                // Each mean is scaled before the sum, which huge values would overflow.
                row.iter().map(|mean| mean * (grid.h() * grid.h())).sum::<f64>()
            });
            rows.sum()
        }
        Source::Exact(_) | Source::Formula(_) => integrals(f)[0],
    }
}

/// The integrals over the square of f and of |f|; no numbers if a smooth f is not finite at some point.
pub fn integrals(f: &Source) -> [f64; 2] {
    if !f.is_smooth() {
        return [integral(f), integral(&f.absolute())];
    }
    let found = mesh_load(&lattice_mesh(&[-0.5, 0.5]), f);
    found.map_or([f64::NAN; 2], |of| [of.integral, of.size])
}

/// Returns the part of the integral of |f|, f smooth, that the formula of degree 5 misses on a grid; none if f is not
/// finite at some point.
pub fn missed_on(grid: Grid, f: &Source) -> Option<f64> {
    let found = mesh_load(&uniform_square(grid), f).ok()?;
    Some(found.moved.max(found.unsettled?) / found.size)
}

/// Returns the part of the integral of |f| by which the nodal rule moves the jumps of f on this grid, half a cell where
/// nodes lie on them; none for other rules, which move none, and for a smooth f.
fn moved_on(grid: Grid, f: &Source, rule: LoadRule) -> Option<f64> {
    let LoadRule::Nodal { diagonal, .. } = rule else { return None };
    if f.is_smooth() {
        return None;
    }
    // A node on a jump takes f from one side under one rule, and from the other under the other.
    let [lower, upper] = [Tie::LowerLeft, Tie::UpperRight].map(|tie| nodal(grid, f, tie, diagonal));
    let moved: f64 = lower.iter().zip(&upper).map(|(a, b)| (a - b).abs()).sum();
    Some(0.5 * moved / integral(&f.absolute()))
}

/// Part of the integral of |f| by which the nodal load may move jumps of f.
const MOVED: f64 = 1e-3;

/// Part of the integral of |f| by which the nodal rule moves the jumps of f; none also if it is too small to matter.
pub fn moved_jumps(grid: Grid, f: &Source, rule: LoadRule) -> Option<f64> {
    moved_on(grid, f, rule).filter(|&moved| moved > MOVED)
}

/// Fills a nodal vector in blocks of rows, which are worked on in parallel; `fill` gets the number of the
/// first row and the block.
fn by_rows(grid: Grid, fill: impl Fn(usize, &mut [f64]) + Sync) -> Vec<f64> {
    let mut vector = vec![0.0; grid.nodes()];
    let rows = (TASK / grid.side()).max(8);
    let run = rows * grid.side();
    let blocks = items_per_task(vector.len().div_ceil(run), run);
    for_runs(&mut vector, blocks * run, &|task, values| {
        for (block, values) in (task * blocks..).zip(values.chunks_mut(run)) {
            fill(block * rows, values);
        }
    });
    vector
}

fn weight(grid: Grid, diagonal: Option<Diagonal>, i: usize, j: usize) -> f64 {
    let on_border = |i: usize| i == 0 || i == grid.cells();
    match (on_border(i), on_border(j)) {
        (false, false) => 1.0,
        (true, true) => match diagonal {
            None => 0.25,
            // A diagonal gives the corners it ends in two triangles, the others one.
            Some(cut) if (cut == Diagonal::Rising) == (i == j) => 1.0 / 3.0,
            Some(_) => 1.0 / 6.0,
        },
        _ => 0.5,
    }
}

/// Multiplies the values of f at, or around, the nodes of row j by the integrals of the hats.
fn weigh(grid: Grid, diagonal: Option<Diagonal>, j: usize, row: &mut [f64]) {
    let (n, h) = (grid.cells(), grid.h());
    let inner = weight(grid, diagonal, 1, j) * h * h;
    let ends = [0, n].map(|i| weight(grid, diagonal, i, j) * h * h * row[i]);
    row.iter_mut().for_each(|f| *f *= inner);
    (row[0], row[n]) = (ends[0], ends[1]);
}

fn nodal(grid: Grid, f: &Source, tie: Tie, diagonal: Option<Diagonal>) -> Vec<f64> {
    let side = grid.side();
    let moved =
        |axis: usize| (0..side).map(|i| tie.step_off(grid.coordinate(i), axis)).collect::<Vec<_>>();
    let (xs, ys) = (moved(0), moved(1));
    let at: Vec<f64> = (0..side).map(|i| grid.coordinate(i)).collect();
    by_rows(grid, |first, block| {
        for (j, row) in (first..).zip(block.chunks_exact_mut(side)) {
            match f {
                Source::Pieces { background, pieces } => {
                    row.fill(*background);
                    let nodes = TiedRow { xs: &at, y: at[j], moved_xs: &xs, moved_y: ys[j], tie };
                    for (shape, value) in pieces {
                        nodes.paint(shape, *value, row);
                    }
                }
                Source::Exact(_) | Source::Formula(_) => {
                    let y = grid.coordinate(j);
                    for (i, value) in row.iter_mut().enumerate() {
                        *value = f.at([grid.coordinate(i), y]);
                    }
                }
            }
            weigh(grid, diagonal, j, row);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(load: &[f64]) -> f64 {
        load.iter().sum()
    }

    #[test]
    fn every_rule_integrates_a_constant_to_one_weight_per_node() {
        let grid = Grid::new(4).unwrap();
        let one = Source::constant(1.0);
        let tie = Tie::LowerLeft;
        let nodal = load(grid, &one, LoadRule::Nodal { tie, diagonal: None });
        assert_eq!((nodal[6], nodal[1], nodal[0]), (1.0 / 16.0, 0.5 / 16.0, 0.25 / 16.0));
        assert_eq!(load(grid, &one, LoadRule::Bilinear {}), nodal);
        // With a constant f, the nodal rule on triangles is the exact one.
        for diagonal in [Diagonal::Rising, Diagonal::Falling] {
            let nodal = load(grid, &one, LoadRule::Nodal { tie, diagonal: Some(diagonal) });
            let exact = load(grid, &one, LoadRule::Exact { diagonal });
            assert!(nodal.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-15));
        }
        let exact = load(grid, &one, LoadRule::Exact { diagonal: Diagonal::Rising });
        // A corner belongs to one or two triangles, depending on the diagonal.
        assert!((exact[0] - 2.0 / 6.0 / 16.0).abs() < 1e-16);
        assert!((exact[4] - 1.0 / 6.0 / 16.0).abs() < 1e-16);
        assert!((sum(&exact) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn bilinear_hats_take_the_twist_of_f() {
        // The hats sum with weights x_i y_i to x y, which those on triangles do not.
        let f: Source = "rect(-0.3,0.21,-0.11,0.4)=3; else=-2".parse().unwrap();
        let moment = |f: &Source, n: usize| -> f64 {
            let grid = Grid::new(n).unwrap();
            let load = load(grid, f, LoadRule::Bilinear {});
            let at = |k: usize| grid.coordinate(k % grid.side()) * grid.coordinate(k / grid.side());
            (0..grid.nodes()).map(|k| load[k] * at(k)).sum()
        };
        let half = |[a, b]: [f64; 2]| 0.5 * (b * b - a * a);
        let want = 5.0 * half([-0.3, 0.21]) * half([-0.11, 0.4]);
        for n in [3, 16] {
            assert!((moment(&f, n) - want).abs() < 1e-14);
        }
        // By quadrature: -2 pi^2 cos(pi x) cos(pi y) times a product of hats.
        let smooth: Source = "exact(full-contact)".parse().unwrap();
        let grid = Grid::new(32).unwrap();
        let (h, pi) = (grid.h(), std::f64::consts::PI);
        let hat = |i| 2.0 * (1.0 - (pi * h).cos()) / (pi * h) * (pi * grid.coordinate(i)).cos();
        let load = load(grid, &smooth, LoadRule::Bilinear {});
        let error = load[grid.index(7, 20)] + 2.0 * hat(7) * hat(20);
        assert!(error.abs() < 1e-8 * h * h, "{error:e}");
    }

    #[test]
    fn discs_that_touch_grid_lines_have_their_area() {
        // Grid lines are touched from within, but for rounding errors.
        for (x, y) in [(0.28, 0.08), (-0.12, -0.42), (-0.1, 0.42), (-0.16, -0.08)] {
            let f: Source = format!("disc({x},{y},0.08)=1; else=0").parse().unwrap();
            for n in [2, 4, 16] {
                let area = sum(&load(Grid::new(n).unwrap(), &f, LoadRule::Bilinear {}));
                assert!((area - std::f64::consts::PI * 0.0064).abs() < 1e-15, "{x}, {y}, {n}");
            }
        }
    }

    #[test]
    fn smooth_sources_are_integrated_to_high_order() {
        let f: Source = "exact(full-contact)".parse().unwrap();
        // The integral of -2 pi^2 cos cos is -8.
        assert!((integral(&f) + 8.0).abs() < 1e-9);
        let nodal = load(Grid::new(64).unwrap(), &f, LoadRule::default());
        assert!((sum(&nodal) + 8.0).abs() < 1e-2);
    }

    /// Values of f at the nodes, by the nodal rule.
    fn nodal_values(n: usize, f: &str, tie: Tie) -> Vec<f64> {
        let grid = Grid::new(n).unwrap();
        let rule = LoadRule::Nodal { tie, diagonal: None };
        let ones = load(grid, &Source::constant(1.0), rule);
        let values = load(grid, &f.parse().unwrap(), rule);
        values.iter().zip(ones).map(|(value, one)| value / one).collect()
    }

    #[test]
    fn all_nodes_on_a_line_take_f_from_one_side() {
        let ties = [Tie::LowerLeft, Tie::LowerRight, Tie::UpperLeft, Tie::UpperRight];
        // Normal a, b with a x + b y = c on the line; lines through corners have one side in the square at the corner.
        for (a, b) in [(1, -1), (-1, 1), (1, 1), (-1, -1), (1, 2), (2, -1), (-1, 2)] {
            for (tie, n) in ties.into_iter().flat_map(|tie| [8, 10, 16, 40].map(|n| (tie, n))) {
                for shift in [1, 3] {
                    let c = f64::from(shift) / n as f64;
                    let values = nodal_values(n, &format!("halfplane({a},{b},{c})=7; else=5"), tie);
                    let grid = Grid::new(n).unwrap();
                    let mut on_line = Vec::new();
                    for j in 0..=n {
                        for i in 0..=n {
                            // In units of 1 / (2 n), so that nothing is rounded.
                            let [x, y] = [i, j].map(|k| 2 * k as i64 - n as i64);
                            if i64::from(a) * x + i64::from(b) * y == 2 * i64::from(shift) {
                                on_line.push(values[grid.index(i, j)]);
                            }
                        }
                    }
                    assert!(on_line.len() > 1, "{a} {b} {c} 1/{n}");
                    assert!(on_line.iter().all(|v| *v == on_line[0]), "{tie:?} {a} {b} {c} 1/{n}");
                }
            }
        }
    }

    #[test]
    fn a_line_along_the_step_is_taken_from_its_horizontal_side() {
        let at_centre = |f: &str, tie| nodal_values(4, f, tie)[Grid::new(4).unwrap().index(2, 2)];
        // To the left of a rising line is above it.
        assert_eq!(at_centre("halfplane(1,-1,0)=1; else=2", Tie::LowerLeft), 1.0);
        assert_eq!(at_centre("halfplane(1,-1,0)=1; else=2", Tie::UpperRight), 2.0);
        assert_eq!(at_centre("halfplane(1,1,0)=1; else=2", Tie::UpperLeft), 1.0);
        assert_eq!(at_centre("halfplane(1,1,0)=1; else=2", Tie::LowerRight), 2.0);
        assert_eq!(at_centre("halfplane(1,1,0)=1; else=2", Tie::LowerLeft), 1.0);
        assert_eq!(at_centre("halfplane(1,0,0)=4; else=0", Tie::LowerLeft), 4.0);
        assert_eq!(at_centre("halfplane(1,0,0)=4; else=0", Tie::UpperRight), 0.0);
        // A line through a corner alone, and a side: f has one side there.
        for tie in [Tie::LowerLeft, Tie::UpperRight] {
            let corner = |f: &str| nodal_values(4, f, tie)[0];
            assert_eq!(corner("halfplane(1,1,-1)=1; else=2"), 2.0);
            assert_eq!(corner("halfplane(-1,-1,1)=1; else=2"), 1.0);
            assert_eq!(corner("halfplane(1,0,-0.5)=1; else=2"), 2.0);
        }
    }

    #[test]
    fn jumps_on_grid_lines_alone_are_moved() {
        let moved = |f: &str, n, rule| moved_on(Grid::new(n).unwrap(), &f.parse().unwrap(), rule);
        let plate = "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5";
        // A border of length 2, a jump of 5.5 and half a cell, over the integral of |f|.
        let found = moved(plate, 64, LoadRule::default()).unwrap();
        assert!((found - 2.0 * 5.5 / 128.0 / 2.125).abs() < 1e-3, "{found}");
        let beside = "rect(-0.26,0.24,-0.26,0.24)=4; else=-1.5";
        assert_eq!(moved(beside, 64, LoadRule::default()), Some(0.0));
        assert_eq!(moved(plate, 64, LoadRule::Bilinear {}), None);
        assert_eq!(moved("formula(x - 1)", 64, LoadRule::default()), None);
    }
}
