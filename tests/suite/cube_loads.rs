//! Loads on the cube.

use signorini_mathematics::discrete::cube::{Grid, load};
use signorini_mathematics::experiments::problems::with_deficit;
use signorini_mathematics::problem::exact::CubeExact as Exact;

/// Nodal load of `f` with this deficit; without one as it is.
pub(crate) fn nodal_load(n: usize, deficit: Option<f64>, f: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let grid = Grid::new(n).expect("fine enough");
    match deficit {
        Some(deficit) => with_deficit(load(grid, f), &load(grid, |_| 1.0), deficit),
        None => load(grid, f),
    }
}

pub(crate) fn exact_load(problem: Exact, n: usize) -> Vec<f64> {
    nodal_load(n, None, |point| problem.at(point).f)
}

/// Contact all over, on one face, on a disc, around a free ball, and at ever fewer nodes: on faces, edges
/// and corners, at last at one corner.
pub(crate) fn stress_loads(n: usize) -> Vec<(&'static str, Vec<f64>)> {
    use std::f64::consts::TAU;
    let waves = |[x, y, z]: [f64; 3]| {
        (TAU * x).sin() + 0.7 * (3.0 * y + 1.0).cos() + 0.6 * (4.0 * z - 0.5).sin()
    };
    let chess = |[x, y, z]: [f64; 3]| (TAU * x).cos() * (TAU * y).cos() * (TAU * z).cos();
    let octant = |[x, y, z]: [f64; 3]| {
        if x <= 0.0 && y <= 0.0 && z <= 0.0 { 1.0 } else { -1.0 / 7.0 }
    };
    let slab = |[_, _, z]: [f64; 3]| if z <= 0.2 { -1.0 } else { 1.1 };
    let ball = |[x, y, z]: [f64; 3]| if x * x + y * y + z * z <= 0.09 { 5.0 } else { -1.0 };
    let spike = |[x, y, z]: [f64; 3]| {
        if (x * x + (y - 0.2).powi(2) + z * z).sqrt() < 1.5 / n as f64 { 1e4 } else { -1.0 }
    };
    let stripes = |[x, y, z]: [f64; 3]| (20.0 * (x + 0.7 * y)).sin() + 0.1 * z;
    let noise = |[x, y, z]: [f64; 3]| {
        ((x * 517.3 + y * 917.7 + z * 311.9).sin() * 4317.5).rem_euclid(1.0) - 0.5
    };
    let jumps = |[x, y, z]: [f64; 3]| match (x <= 0.0, y <= 0.0, z <= 0.0) {
        (true, true, _) => -1e6,
        (true, false, true) => 3e5,
        _ => 1.0,
    };
    vec![
        ("slab", nodal_load(n, None, slab)),
        ("ball", nodal_load(n, None, ball)),
        ("waves 1e-1", nodal_load(n, Some(1e-1), waves)),
        ("waves 1e-3", nodal_load(n, Some(1e-3), waves)),
        ("waves 1e-6", nodal_load(n, Some(1e-6), waves)),
        ("waves 1e-12", nodal_load(n, Some(1e-12), waves)),
        ("chess 1e-2", nodal_load(n, Some(1e-2), chess)),
        ("chess 1e-5", nodal_load(n, Some(1e-5), chess)),
        ("chess 1e-10", nodal_load(n, Some(1e-10), chess)),
        ("octant 1e-1", nodal_load(n, Some(1e-1), octant)),
        ("octant 1e-4", nodal_load(n, Some(1e-4), octant)),
        ("octant 1e-8", nodal_load(n, Some(1e-8), octant)),
        ("stripes 1e-2", nodal_load(n, Some(1e-2), stripes)),
        ("stripes 1e-4", nodal_load(n, Some(1e-4), stripes)),
        ("noise 1e-1", nodal_load(n, Some(1e-1), noise)),
        ("noise 1e-4", nodal_load(n, Some(1e-4), noise)),
        ("spike", nodal_load(n, Some(1e-2), spike)),
        ("jumps", nodal_load(n, None, jumps)),
    ]
}
