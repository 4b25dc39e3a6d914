//! The steps of a sweep: moments of f, reactions, fluxes through edges, and the flux that carries a residual.

use super::{grids, laws, noise, sources, vector};
use crate::bounds::boundary::Slips;
use crate::discrete::grid::Grid;
use crate::discrete::load::{Diagonal, LoadRule};
use crate::problem::source::Source;
use crate::square::bounds::data::{AllCells, Cursor};
use crate::square::bounds::flux::{EdgeFluxes, NodeFluxes, Reactions, through_edges};
use crate::square::bounds::moments::CellMoments;
use crate::square::bounds::project;
use crate::square::bounds::residual::Pyramid;
use crate::square::bounds::strip::{Extended, FluxStrip};
use crate::square::load::load;
use std::array::from_fn;
use std::f64::consts::PI;

/// Integrals over the square of f times 1, x, y, x y, x^2, y^2, x^2 y and x y^2, and of the square of f, from the
/// moments over all cells.
fn integrals(grid: Grid, f: &Source) -> [f64; 9] {
    let (data, h) = (AllCells::new(grid, f), grid.h());
    let mut sums = [0.0; 9];
    for j in 0..grid.cells() {
        let (mut start, y) = (0, grid.coordinate(j) + 0.5 * h);
        for run in data.row(j).iter() {
            for i in start..run.end {
                let (x, m) = (grid.coordinate(i) + 0.5 * h, run.f);
                let xx = x * x * m.one + 2.0 * x * h * m.x + h * h * m.xx;
                let yy = y * y * m.one + 2.0 * y * h * m.y + h * h * m.yy;
                let xy = x * y * m.one + h * (x * m.y + y * m.x) + h * h * m.xy;
                let xx_around = x * x * m.y + 2.0 * x * h * m.xy + h * h * m.xxy;
                let yy_around = y * y * m.x + 2.0 * y * h * m.xy + h * h * m.xyy;
                let parts = [
                    m.one,
                    x * m.one + h * m.x,
                    y * m.one + h * m.y,
                    xy,
                    xx,
                    yy,
                    y * xx + h * xx_around,
                    x * yy + h * yy_around,
                    m.square / (h * h),
                ];
                sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            }
            start = run.end;
        }
    }
    sums
}

/// These integrals over a region with this area, centre and mean squares of the distances from the centre along x and
/// y, symmetric about its centre.
fn of_region(area: f64, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> [f64; 9] {
    let (xx, yy) = (x * x + u, y * y + v);
    [1.0, x, y, x * y, xx, yy, xx * y, x * yy, 1.0].map(|mean| area * mean)
}

#[test]
fn moments_are_those_of_rectangles_discs_and_powers() {
    let disc = of_region(PI * 0.09, [0.1, -0.15], [0.0225; 2]);
    let rect = of_region(0.45 * 0.31, [0.075, 0.235], [0.45 * 0.45 / 12.0, 0.31 * 0.31 / 12.0]);
    let square = of_region(1.0, [0.0; 2], [1.0 / 12.0; 2]);
    let mut both = [0.0; 9];
    for k in 0..8 {
        both[k] = 3.0 * disc[k] - 2.0 * (square[k] - disc[k]);
    }
    both[8] = 9.0 * disc[8] + 4.0 * (1.0 - disc[8]);
    // x^2 y, by its moments.
    let power = [0.0, 0.0, 1.0 / 144.0, 0.0, 0.0, 0.0, 1.0 / 960.0, 0.0, 1.0 / 960.0];
    for (f, expected) in [
        ("disc(0.1,-0.15,0.3)=1; else=0", disc),
        ("disc(0.1,-0.15,0.3)=3; else=-2", both),
        ("rect(-0.15,0.3,0.08,0.39)=1; else=0", rect),
        ("formula(x*x*y)", power),
    ] {
        let f: Source = f.parse().unwrap();
        for grid in grids() {
            let found = integrals(grid, &f);
            for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
                // The square of x^2 y has a degree above that of the rule.
                let digits = if k == 8 && grid.cells() < 20 { 1e-6 } else { 1e-9 };
                assert!((found - expected).abs() < digits, "{f} {k}: {found} {expected}");
            }
        }
    }
}

#[test]
fn loads_of_hats_are_those_of_load_vectors() {
    for (grid, f) in grids().into_iter().flat_map(|grid| sources().map(|f| (grid, f))) {
        let data = AllCells::new(grid, &f);
        let bilinear = load(grid, &f, LoadRule::Bilinear {});
        for (found, node) in data.boundary_masses.iter().zip(grid.boundary()) {
            assert!((found - bilinear[node]).abs() < 1e-13, "{f}: {found} {}", bilinear[node]);
        }
        // The load of the ridge, where the mixed second difference over a cell is 1 in one cell alone.
        let mut ridges = [0.0; 2];
        let diagonal = Diagonal::Rising;
        let exact = load(grid, &f, LoadRule::Exact { diagonal });
        for j in 0..grid.cells() {
            let mut start = 0;
            for run in data.row(j).iter() {
                for i in start..run.end {
                    let values = [0, 1, 2, 3].map(|k| {
                        let node = grid.index(i + k % 2, j + k / 2);
                        noise(node, 1.0)
                    });
                    let [ll, lr, ul, ur] = values;
                    ridges[0] += ((ll + ur) - (lr + ul)) * run.f.ridge;
                }
                start = run.end;
            }
        }
        for node in 0..grid.nodes() {
            ridges[1] += noise(node, 1.0) * (exact[node] - bilinear[node]);
        }
        assert!((ridges[0] - ridges[1]).abs() < 1e-12, "{f}: {ridges:?}");
    }
}

#[test]
fn reactions_are_in_the_interval_and_balance_f() {
    let mut balanced = 0;
    for (k, grid) in grids().into_iter().enumerate() {
        for (f, law) in sources().iter().flat_map(|f| laws().map(|law| (f, law))) {
            let (data, h) = (AllCells::new(grid, f), grid.h());
            let [least, most] = [-4.0 * law.hi(), -4.0 * law.lo()];
            if data.integral <= least || data.integral >= most {
                continue;
            }
            balanced += 1;
            for size in [0.0, 1e-3, 1.0, 100.0] {
                let y = vector(grid, k, size);
                let v = project(grid, Slips::ALL.and(law), &y).v.into_owned();
                let outer: Vec<f64> = grid.boundary().map(|node| v[node]).collect();
                let reactions = Reactions::new(grid, law, &v, &outer, &data);
                let Reactions { bottom, top, left, right, .. } = &reactions;
                let n = grid.cells();
                let mut sum = 0.0;
                for side in [bottom, top, left, right] {
                    assert_eq!(side.len(), n + 1);
                    for (place, &reaction) in side.iter().enumerate() {
                        let is_inside = h * law.lo() <= reaction && reaction <= h * law.hi();
                        assert!(is_inside, "{f} {law}: {reaction}");
                        sum += if [0, n].contains(&place) { 0.5 * reaction } else { reaction };
                    }
                }
                let far = (sum + data.integral).abs();
                assert!(far < 1e-13 * reactions.flow.max(1.0), "{f} {law} {size}: {far}");
                let corners = [
                    [bottom[0], left[0]],
                    [bottom[n], right[0]],
                    [top[0], left[n]],
                    [top[n], right[n]],
                ];
                assert!(corners.iter().all(|[a, b]| a == b), "{corners:?}");
            }
        }
    }
    assert!(balanced > 20, "{balanced}");
}

/// Reactions that are zero.
fn no_reactions(grid: Grid) -> Reactions {
    let [bottom, top, left, right] = from_fn(|_| vec![0.0; grid.side()]);
    Reactions { bottom, top, left, right, flow: 0.0, slips: Slips { up: true, down: true } }
}

/// Moments of f over a cell.
fn moments_of(data: &AllCells, [i, j]: [usize; 2]) -> CellMoments {
    Cursor(&data.row(j)).at(i).f
}

#[test]
fn edges_have_one_flux_none_is_on_the_boundary_and_where_there_are_some_cells_are_special() {
    for (grid, f) in grids().into_iter().flat_map(|grid| sources().map(|f| (grid, f))) {
        let (n, data) = (grid.cells(), AllCells::new(grid, &f));
        let row =
            |j: usize| if (1..=n).contains(&j) { data.row(j - 1).into_owned() } else { vec![] };
        let y = vec![0.0; grid.nodes()];
        let reactions = no_reactions(grid);
        let mut strip = FluxStrip::new(Extended::new(grid, &y, &reactions));
        strip.advance(&[], &row(1));
        strip.advance(&row(1), &row(2));
        let [mut lower, mut upper] = [(); 2].map(|()| NodeFluxes::zero(n));
        upper.set(&[], &row(1));
        let mut tops = vec![0.0; n];
        for j in 0..n {
            strip.advance(&row(j + 2), &row(j + 3));
            std::mem::swap(&mut lower, &mut upper);
            upper.set(&row(j + 1), &row(j + 2));
            let mut special = Vec::new();
            strip.find_special(j, &mut special);
            let mut right_before = 0.0;
            for (i, top_before) in tops.iter_mut().enumerate() {
                let EdgeFluxes { left, right, bottom, top } = through_edges(&lower, &upper, i);
                assert!(
                    (left - right_before).abs() < 1e-15 && (bottom - *top_before).abs() < 1e-15
                );
                (right_before, *top_before) = (right, top);
                let is_special = special.iter().any(|span| span.first <= i && i <= span.last);
                let on_boundary = strip.on_boundary(i, j).as_flattened().contains(&true);
                let has_flux = [left, right, bottom, top].iter().any(|flux| *flux != 0.0);
                assert!(is_special || !(on_boundary || has_flux), "{f} {i} {j}");
                // Without a vector the residual is what f leaves.
                let f_here = moments_of(&data, [i, j]);
                let (_, mean) = strip.cell([i, j], f_here);
                let divergence = (right - left) + (top - bottom);
                assert!((mean - f_here.one - divergence).abs() < 1e-14, "{f} {i} {j}");
                let has_bends = strip.bends(i, j).as_flattened().iter().any(|bend| *bend != 0.0);
                assert!(is_special || !has_bends, "{f} {i} {j}");
            }
            assert!(right_before.abs() < 1e-15, "{f} {j}: {right_before}");
        }
        assert!(tops.iter().all(|top| top.abs() < 1e-15), "{f}: {tops:?}");
    }
}

/// Bound of the flux for a residual on n by n cells.
fn carried(n: usize, residual: impl Fn(usize, usize) -> f64) -> f64 {
    let mut pyramid = Pyramid::new(n);
    for j in 0..n {
        let row: Vec<f64> = (0..n).map(|i| residual(i, j) / (n * n) as f64).collect();
        pyramid.push(if row.iter().all(|value| *value == 0.0) { &[] } else { &row });
    }
    pyramid.bound()
}

/// 1 for even numbers, -1 for others.
fn sign(k: usize) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Value of a cosine with its ends at those of the side in the middle of a cell.
fn cosine(k: usize, n: usize) -> f64 {
    libm::cos(PI * (k as f64 + 0.5) / n as f64)
}

#[test]
fn a_residual_is_carried_by_no_less_than_its_flux() {
    for n in [16, 48, 64, 80] {
        // Strips of equal width with both signs in turn: the flux rises and falls along each pair.
        let mut width = 1;
        while n % (2 * width) == 0 {
            let least = 2.0 * width as f64 / n as f64 / 12f64.sqrt();
            for bound in [carried(n, |i, _| sign(i / width)), carried(n, |_, j| sign(j / width))] {
                assert!(least <= bound && bound < 1.11 * least, "{n} {width}: {bound} {least}");
            }
            width *= 2;
        }
        let least = 0.999 / (PI * 2f64.sqrt());
        for bound in [carried(n, |i, _| cosine(i, n)), carried(n, |_, j| cosine(j, n))] {
            assert!(least <= bound && bound < 1.6 * least, "{n}: {bound} {least}");
        }
        // Two rows, and one, of which all others are zero.
        let least = 2.0 / n as f64 / 12f64.sqrt() * (2.0 / n as f64).sqrt();
        let bound = carried(n, |_, j| if j / 2 == 3 { sign(j) } else { 0.0 });
        assert!(least <= bound && bound < 1.11 * least, "{n}: {bound} {least}");
    }
    // The blocks of the last level are three by three: -1, 0 and 1 along one side.
    let least = (1.0f64 / 27.0 * (5.0 / 3.0)).sqrt();
    for bound in
        [carried(48, |i, _| (i / 16) as f64 - 1.0), carried(48, |_, j| (j / 16) as f64 - 1.0)]
    {
        assert!(least <= bound && bound < 1.1 * least, "{bound} {least}");
    }
}
