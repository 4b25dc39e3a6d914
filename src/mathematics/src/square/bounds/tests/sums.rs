//! Sums over all cells and over the boundary against integrals of the vector and of its recovery.

use super::{EXACT, grids, laws, sources, vector};
use crate::bounds::boundary::Slips;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::judge;
use crate::problem::law::Law;
use crate::square::bounds::cells::SpecialCell;
use crate::square::bounds::data::AllCells;
use crate::square::bounds::flux::Reactions;
use crate::square::bounds::moments::CellMoments;
use crate::square::bounds::project;
use crate::square::bounds::strip::{Extended, FluxStrip};
use crate::square::bounds::walk::{Total, total};
use crate::square::load::{integrals, load};
use std::borrow::Cow;

/// Values of the recovery of v on the grid of half the width.
fn recovery(data: &AllCells, law: Law, v: &[f64]) -> Vec<f64> {
    let grid = data.grid();
    let (n, side) = (grid.cells(), 2 * grid.cells() + 1);
    let outer: Vec<f64> = grid.boundary().map(|node| v[node]).collect();
    let reactions = Reactions::new(grid, law, v, &outer, data);
    let mut strip = FluxStrip::new(Extended::new(grid, v, &reactions));
    let row = |j: usize| if j < n { data.row(j) } else { Cow::default() };
    strip.advance(&[], &row(0));
    strip.advance(&row(0), &row(1));
    let mut recovered = vec![0.0; side * side];
    for j in 0..n {
        strip.advance(&row(j + 1), &row(j + 2));
        for i in 0..n {
            let (cell, _) = strip.cell([i, j], CellMoments::default());
            for (k, values) in values(&cell).iter().enumerate() {
                let start = (2 * j + k) * side + 2 * i;
                recovered[start..start + 3].copy_from_slice(values);
            }
        }
    }
    recovered
}

/// Values of the recovery at the corners, the midpoints of edges and the centre of a cell, row by row.
fn values(cell: &SpecialCell) -> [[f64; 3]; 3] {
    let ([ll, lr, ul, ur], [[bottom, top], [left, right]]) = (cell.corners(), cell.bubbles);
    let centre = 0.25 * ((ll + lr) + (ul + ur)) - 0.125 * ((bottom + top) + (left + right));
    [
        [ll, at_midpoint(ll, lr, bottom), lr],
        [at_midpoint(ll, ul, left), centre, at_midpoint(lr, ur, right)],
        [ul, at_midpoint(ul, ur, top), ur],
    ]
}

/// Value of the recovery at the midpoint of an edge with values p and q at its ends.
fn at_midpoint(p: f64, q: f64, bubble: f64) -> f64 {
    0.5 * (p + q) - 0.25 * bubble
}

/// Integral over the boundary of a function of the place on it and of the values at the ends and the middle of an
/// edge, which are on the boundary of the grid of half the width.
fn around(grid: Grid, recovered: &[f64], of: impl Fn(usize, f64, f64) -> f64) -> f64 {
    const POINTS: usize = 400;
    let n = grid.cells();
    let half = Grid::new(2 * n).unwrap();
    let at: Vec<usize> = half.boundary().collect();
    let mut sum = 0.0;
    for edge in 0..4 * n {
        let [p, middle, q] = [0, 1, 2].map(|k| recovered[at[(2 * edge + k) % at.len()]]);
        let bubble = 2.0 * (p + q) - 4.0 * middle;
        for k in 0..POINTS {
            let t = (k as f64 + 0.5) / POINTS as f64;
            sum += of(edge, t, p + t * (q - p) - bubble * t * (1.0 - t));
        }
    }
    sum * grid.h() / POINTS as f64
}

/// Cells of the recovery with these values on the grid of half the width, with or without bubbles on the boundary.
fn cells_of(
    grid: Grid,
    recovered: &[f64],
    data: &AllCells,
    with_boundary: bool,
) -> Vec<SpecialCell> {
    let (n, side) = (grid.cells(), 2 * grid.cells() + 1);
    let mut cells = Vec::new();
    for j in 0..n {
        for run in data.row(j).iter() {
            while cells.len() < j * n + run.end {
                let i = cells.len() - j * n;
                let at = |x: usize, y: usize| recovered[(2 * j + y) * side + 2 * i + x];
                let line =
                    |p: [usize; 2], q: [usize; 2]| [0.0, at(p[0], p[1]), at(q[0], q[1]), 0.0];
                let bubble = |p: [usize; 2], q: [usize; 2]| {
                    let [x, y] = [p[0] + q[0], p[1] + q[1]].map(|k| k / 2);
                    let (row, column) = (2 * j + y, 2 * i + x);
                    let on_boundary = [row, column].iter().any(|k| [0, 2 * n].contains(k));
                    let counts = with_boundary || !on_boundary;
                    let ends = at(p[0], p[1]) + at(q[0], q[1]);
                    if counts { 2.0 * ends - 4.0 * at(x, y) } else { 0.0 }
                };
                let ends =
                    [[([0, 0], [2, 0]), ([0, 2], [2, 2])], [([0, 0], [0, 2]), ([2, 0], [2, 2])]];
                cells.push(SpecialCell {
                    lines: ends.map(|edges| edges.map(|(p, q)| line(p, q))),
                    bubbles: ends.map(|edges| edges.map(|(p, q)| bubble(p, q))),
                    f: run.f,
                    ..SpecialCell::default()
                });
            }
        }
    }
    cells
}

/// Half the integral of the square of the gradient, less that of f, over all cells.
fn inside(cells: &[SpecialCell]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for cell in cells {
        let of_cell = cell.sums();
        sums[0] += of_cell.recovered;
        sums[1] += of_cell.recovered_load;
    }
    sums
}

fn close(found: f64, expected: f64, digits: f64) -> bool {
    (found - expected).abs() < digits * expected.abs().max(1.0)
}

#[test]
fn a_sweep_has_the_integrals_of_the_vector_and_of_its_recovery() {
    for (k, grid) in grids().into_iter().enumerate() {
        let n = grid.cells();
        for (f, law) in sources().iter().flat_map(|f| laws().map(|law| (f, law))) {
            let data = AllCells::new(grid, f);
            let [least, most] = [-4.0 * law.hi(), -4.0 * law.lo()];
            if data.integral <= least || data.integral >= most {
                continue;
            }
            let mut y = vector(grid, k, 0.5);
            y.iter_mut()
                .enumerate()
                .for_each(|(node, value)| *value += libm::sin(0.3 * (node % (n + 1)) as f64) - 0.2);
            let v = project(grid, Slips::ALL.and(law), &y).v.into_owned();
            let recovered = recovery(&data, law, &v);
            let (found, _) = total(&data, law, &v);
            let cells = cells_of(grid, &recovered, &data, true);
            let [square, load_of_w] = inside(&cells);
            let what = format!("{f} {law} {n}");
            assert!(close(found.sums.recovered, square, 1e-11), "{what}: {square}");
            assert!(close(found.sums.recovered_load, load_of_w, 1e-11), "{what}: {load_of_w}");
            let [without, load_without] = inside(&cells_of(grid, &recovered, &data, false));
            let gain = 0.5 * (without - square) - (load_without - load_of_w);
            assert!(close(found.boundary_bubble_gain, gain, 1e-11), "{what}: {gain}");
            let linear = 2.0 * judge((grid, Law::SIGNORINI), &v, &vec![0.0; v.len()]).energy;
            assert!(close(found.sums.linear, linear, 1e-11), "{what}: {linear}");
            let exact = load(grid, f, EXACT);
            let linear_load: f64 = v.iter().zip(exact).map(|(v, load)| v * load).sum();
            assert!(close(found.sums.linear_load, linear_load, 1e-11), "{what}: {linear_load}");
            check_boundary(law, &v, &recovered, (&data, &found));
            let largest = v.iter().fold(0.0f64, |largest, v| v.abs().max(largest));
            assert!(found.largest == largest, "{what}");
            let [_, size] = integrals(f);
            assert!(found.mass >= size - 1e-12, "{what}: {} {size}", found.mass);
        }
    }
}

/// True if a value on the boundary has a term of the energy that is finite.
fn allows(law: Law, v: f64) -> bool {
    if v > 0.0 { law.lo().is_finite() } else { v == 0.0 || law.hi().is_finite() }
}

/// The law's term at a value that it allows, up to rounding.
fn potential(law: Law, w: f64) -> f64 {
    assert!(allows(law, w) || w.abs() < 1e-14, "{law}: {w}");
    law.potential(w)
}

/// Integrals over the boundary, and the sign of the recovery there.
fn check_boundary(law: Law, v: &[f64], recovered: &[f64], (data, found): (&AllCells, &Total)) {
    let grid = data.grid();
    let outer: Vec<f64> = grid.boundary().map(|node| v[node]).collect();
    let reactions = Reactions::new(grid, law, v, &outer, data);
    let Reactions { bottom, top, left, right, .. } = &reactions;
    let (n, h) = (grid.cells(), grid.h());
    let mut sides = [bottom, right, top, left].map(Clone::clone);
    sides[2..].iter_mut().for_each(|side| side.reverse());
    let flux = |edge: usize, t: f64| {
        let side = &sides[edge / n];
        ((1.0 - t) * side[edge % n] + t * side[edge % n + 1]) / h
    };
    let of_w = around(grid, recovered, |_, _, w| potential(law, w));
    let work = around(grid, recovered, |edge, t, w| potential(law, w) + flux(edge, t) * w);
    assert!(
        close(found.recovered_potential, of_w, 1e-4),
        "{law}: {} {of_w}",
        found.recovered_potential
    );
    assert!(close(found.work, work, 1e-4), "{law}: {} {work}", found.work);
    let mut linear = 0.0;
    for b in 0..outer.len() {
        let (p, q) = (outer[b], outer[(b + 1) % outer.len()]);
        linear += (0..400)
            .map(|k| potential(law, p + (f64::from(k) + 0.5) / 400.0 * (q - p)))
            .sum::<f64>();
    }
    linear *= h / 400.0;
    assert!(
        close(found.linear_potential, linear, 1e-4),
        "{law}: {} {linear}",
        found.linear_potential
    );
    assert!(linear.abs() <= found.flow * found.largest, "{law}: {linear} {}", found.flow);
    // The normal flux of the spline is that of the reactions.
    let extended = Extended::new(grid, v, &reactions);
    for k in 0..n {
        let [[below, _], _] = [extended.around(k, 0)[1], extended.around(k, n - 1)[1]];
        let above = extended.around(k, n - 1)[1][0];
        let (west, east) = (extended.around(0, k)[0][0], extended.around(n - 1, k)[0][0]);
        for (out, reaction) in [
            (0.5 * (below[0] - below[2]), bottom[k]),
            (0.5 * (above[3] - above[1]), top[k]),
            (0.5 * (west[0] - west[2]), left[k]),
            (0.5 * (east[3] - east[1]), right[k]),
        ] {
            assert!((out - reaction).abs() < 1e-14, "{law}: {out} {reaction}");
        }
    }
}

#[test]
fn values_that_the_law_forbids_become_zero_and_count_with_their_distance() {
    for (k, grid) in grids().into_iter().enumerate() {
        let y = vector(grid, k, 1.0);
        for law in laws() {
            let moved = project(grid, Slips::ALL.and(law), &y);
            for (node, (&value, &found)) in y.iter().zip(&*moved.v).enumerate() {
                let is_kept = !grid.boundary().any(|b| b == node) || allows(law, value);
                assert_eq!(found, if is_kept { value } else { 0.0 });
            }
            assert!(
                close(moved.distance, super::known::distance(grid, &y, &moved.v), 1e-13),
                "{law}"
            );
        }
    }
}
