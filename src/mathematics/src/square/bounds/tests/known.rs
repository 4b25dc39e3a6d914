//! Brackets of known energies and of known distances, for solutions and for vectors far from them.

use super::{EXACT, noise};
use crate::bounds::Bounds;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::judge;
use crate::discrete::load::LoadRule;
use crate::multigrid::MultigridParams;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::square::bounds::bounds;
use crate::square::load::load;
use crate::square::multigrid::solve_square;

/// Half the energy of `-Laplacian u = 1` on the square with u = 0 on the boundary, by its Fourier series.
const TORSION: f64 = -0.017_572_126_917_158;

/// Problem with its true energy.
struct SquareProblem {
    f: &'static str,
    law: Law,
    energy: f64,
}

impl SquareProblem {
    fn new(f: &'static str, law: Law, energy: f64) -> Self {
        Self { f, law, energy }
    }
}

fn friction_of(g: f64) -> Law {
    Law::friction(g).unwrap()
}

fn known() -> Vec<SquareProblem> {
    let limit = Law::limited(0.7).unwrap();
    // The flux of the quadratic solution is at the end of the interval everywhere.
    let end = f64::next_up(0.25);
    vec![
        SquareProblem::new("else=1", friction_of(end), -1.0 / 48.0),
        SquareProblem::new("else=-1", friction_of(end), -1.0 / 48.0),
        SquareProblem::new("else=-1", Law::SIGNORINI, TORSION),
        SquareProblem::new("else=1", Law::SIGNORINI.reflected(), TORSION),
        SquareProblem::new("else=-2", limit, 4.0 * TORSION),
        SquareProblem::new("else=2", friction_of(0.68), 4.0 * TORSION),
        SquareProblem::new("else=-1", Law::new(-0.2, f64::INFINITY).unwrap(), TORSION),
        // By conformal maps in quadruple precision.
        SquareProblem::new("quadrant(ll)=3; else=-1.1", Law::SIGNORINI, -0.095_051_720_753_350_79),
        SquareProblem::new(
            "rect(0.25,0.5,0.25,0.5)=2; else=-1",
            Law::SIGNORINI,
            -0.016_602_302_753_503_897,
        ),
        SquareProblem::new(
            "halfplane(1,0,0)=8; else=-8",
            friction_of(1.0),
            -0.627_952_316_469_321_7,
        ),
    ]
}

fn solved(grid: Grid, f: &Source, law: Law) -> Vec<f64> {
    let load = load(grid, f, LoadRule::Bilinear {});
    solve_square(grid.cells(), law, &load, &MultigridParams::default()).unwrap().0
}

/// Vector with something added at each node, by its number, column and row.
fn with(grid: Grid, y: &[f64], add: impl Fn(usize, usize, usize) -> f64) -> Vec<f64> {
    let side = grid.side();
    (0..grid.nodes()).map(|node| y[node] + add(node, node % side, node / side)).collect()
}

/// 1 on the boundary, 0 inside.
fn on_boundary(grid: Grid, i: usize, j: usize) -> f64 {
    f64::from(u8::from([i, j].iter().any(|k| [0, grid.cells()].contains(k))))
}

/// 1 and -1 in turn in the middle of the square, 0 around it.
fn wave(grid: Grid, [i, j]: [usize; 2], k: usize) -> f64 {
    let (last, sign) = (grid.cells(), if k.is_multiple_of(2) { 1.0 } else { -1.0 });
    let is_inside = [i, j].iter().all(|&k| k > last / 5 && k < last - last / 5);
    if is_inside { sign } else { 0.0 }
}

/// Vectors far from the solution y, each in its own way.
fn spoilt(grid: Grid, y: &[f64]) -> Vec<Vec<f64>> {
    let last = grid.cells();
    let mut all: Vec<Vec<f64>> = vec![
        vec![0.0; grid.nodes()],
        with(grid, y, |_, _, _| 1.0),
        with(grid, y, |_, _, _| -1.0),
        with(grid, y, |_, i, _| 0.3 * libm::cos(3.0 * i as f64 / last as f64)),
        with(grid, y, |_, _, j| if j < last / 2 { 0.0 } else { 0.7 }),
        with(grid, y, |_, i, j| -on_boundary(grid, i, j)),
        with(grid, y, |_, i, j| 0.5 * on_boundary(grid, i, j)),
    ];
    // Waves that differ from node to node have residuals that differ inside cells.
    for size in [0.05, 1.0] {
        all.push(with(grid, y, |_, i, j| size * wave(grid, [i, j], i)));
        all.push(with(grid, y, |_, i, j| size * wave(grid, [i, j], j)));
        all.push(with(grid, y, |_, i, j| size * wave(grid, [i, j], i + j)));
    }
    for (k, size) in [1e-6, 1e-3, 0.03, 1.0].into_iter().enumerate() {
        all.push(with(grid, y, |node, _, _| noise(10_000 * k + node, size)));
        all.push(with(grid, y, |node, i, j| noise(node, size) * on_boundary(grid, i, j)));
    }
    all
}

/// Distance of two vectors in the energy norm.
pub(super) fn distance(grid: Grid, one: &[f64], other: &[f64]) -> f64 {
    let apart: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
    (2.0 * judge((grid, Law::SIGNORINI), &apart, &vec![0.0; apart.len()]).energy).max(0.0).sqrt()
}

#[test]
fn brackets_hold_known_energies_and_errors() {
    for SquareProblem { f: text, law, energy: known } in known() {
        let f: Source = text.parse().unwrap();
        for n in [8, 32] {
            let grid = Grid::new(n).unwrap();
            let y = solved(grid, &f, law);
            let best = bounds(grid, &f, law, &y).unwrap();
            let slack = 1e-15 * known.abs();
            for (k, v) in std::iter::once(y.clone()).chain(spoilt(grid, &y)).enumerate() {
                let found = bounds(grid, &f, law, &v).unwrap();
                let Bounds { energy: [low, high], error: [least, most], .. } = found;
                let holds = low <= known + slack && known - slack <= high;
                assert!(holds && high <= 0.0, "{text} {law} {n} {k}: {found:?} {known}");
                let apart = distance(grid, &v, &y);
                let (nearest, farthest) = (apart - best.error[1], apart + best.error[1]);
                assert!(least <= farthest && nearest <= most, "{text} {law} {n} {k}: {found:?}");
            }
        }
    }
}

#[test]
fn errors_of_solutions_are_known_where_the_boundary_sticks_and_bounds_are_near_them() {
    for (text, law) in [
        ("else=-1", Law::SIGNORINI),
        ("else=1", Law::SIGNORINI.reflected()),
        ("else=-1", Law::friction(0.34).unwrap()),
    ] {
        let f: Source = text.parse().unwrap();
        for n in [8, 16, 64] {
            let grid = Grid::new(n).unwrap();
            let y = solved(grid, &f, law);
            assert!(grid.boundary().all(|node| y[node] == 0.0), "{text} {law}");
            let of_v = judge((grid, Law::SIGNORINI), &y, &load(grid, &f, EXACT)).energy;
            let error = (2.0 * (of_v - TORSION)).sqrt();
            let found = bounds(grid, &f, law, &y).unwrap();
            let Bounds { energy: [low, high], error: [least, most], recovered, .. } = found;
            let near = if n == 8 { 0.05 } else { 0.01 };
            assert!(least <= error && error <= most, "{text} {n}: {found:?} {error}");
            assert!(
                most < (1.0 + near) * error && least > (1.0 - near) * error,
                "{found:?} {error}"
            );
            // The recovery has the upper end for its energy.
            let of_recovery = (2.0 * (high - TORSION)).sqrt();
            assert!(recovered.unwrap() > 0.999 * of_recovery, "{found:?}");
            assert!(high - low < 30.0 * (n as f64).powi(-3), "{found:?}");
        }
    }
}

/// Values with a second difference of 13 on the left half, and of -13 on the right one.
fn column(n: usize, i: usize) -> f64 {
    let (left, right) = (i.min(n / 2) as f64, i.saturating_sub(n / 2) as f64);
    6.5 * left * left + 13.0 * (n / 2) as f64 * right - 6.5 * right * right
}

#[test]
fn residuals_of_the_size_of_rounding_errors_count() {
    // Values of 2^40, with a residual that is 13 units in the last place of them on one half, and -13 on the other.
    let (n, size) = (64, 2f64.powi(40));
    let (grid, unit) = (Grid::new(n).unwrap(), size * f64::EPSILON);
    let f = Source::constant(2f64.powi(-10));
    let law = Law::friction(f64::next_up(2f64.powi(-12))).unwrap();
    let y: Vec<f64> =
        (0..grid.nodes()).map(|node| size + unit * column(n, node % (n + 1)).floor()).collect();
    let [low, _] = bounds(grid, &f, law, &y).unwrap().energy;
    let known = -(2f64.powi(-20)) / 48.0;
    assert!(low <= known, "{low} {known}");
}
