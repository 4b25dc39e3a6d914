//! Load vectors of growing difficulty.

use std::f64::consts::TAU;

/// Subtracts from `load` the multiple of `ones`, the load of f = 1, after which the sum of the load is `-deficit` times
/// the sum of the absolute values of the original load.
pub(crate) fn with_deficit(mut load: Vec<f64>, ones: &[f64], deficit: f64) -> Vec<f64> {
    let sum: f64 = load.iter().sum();
    let size: f64 = load.iter().map(|entry| entry.abs()).sum();
    let excess = sum + deficit * size;
    for (entry, one) in load.iter_mut().zip(ones) {
        *entry -= one * excess;
    }
    load
}

/// Nodal load of `f` on `n` by `n` cells, row by row, `(n + 1)^2` numbers: with this deficit, or unchanged without one.
pub(crate) fn nodal_load(n: usize, deficit: Option<f64>, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let h = 1.0 / n as f64;
    let (mut ones, mut load) = (Vec::new(), Vec::new());
    for j in 0..=n {
        for i in 0..=n {
            let one = share(i, n) * share(j, n) * h * h;
            ones.push(one);
            load.push(one * f(i as f64 * h - 0.5, j as f64 * h - 0.5));
        }
    }
    match deficit {
        Some(deficit) => with_deficit(load, &ones, deficit),
        None => load,
    }
}

/// Part of the width h that the i-th of the nodes 0 to `n` on a line stands for.
fn share(i: usize, n: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

/// Semicoercive problems of growing difficulty: contact at few nodes, at one, at both sides of a corner.
///
/// The number in a name is minus the sum of the load over the sum of absolute values.
pub(crate) fn stress_loads(n: usize) -> Vec<(&'static str, Vec<f64>)> {
    let spike = nodal_load(n, Some(1e-2), |x, y| {
        if libm::hypot(x, y - 0.2) < 1.5 / n as f64 { 1e4 } else { -1.0 }
    });
    vec![
        ("waves 1e-1", nodal_load(n, Some(1e-1), waves)),
        ("waves 1e-3", nodal_load(n, Some(1e-3), waves)),
        ("waves 1e-6", nodal_load(n, Some(1e-6), waves)),
        ("waves 1e-12", nodal_load(n, Some(1e-12), waves)),
        ("chess 1e-2", nodal_load(n, Some(1e-2), chess)),
        ("chess 1e-5", nodal_load(n, Some(1e-5), chess)),
        ("chess 1e-10", nodal_load(n, Some(1e-10), chess)),
        ("quadrant 1e-2", nodal_load(n, Some(1e-2), quadrant)),
        ("quadrant 1e-4", nodal_load(n, Some(1e-4), quadrant)),
        ("quadrant 1e-8", nodal_load(n, Some(1e-8), quadrant)),
        ("spike", spike),
        ("jumps", nodal_load(n, None, jumps)),
    ]
}

fn waves(x: f64, y: f64) -> f64 {
    libm::sin(TAU * x) + 0.7 * libm::cos(3.0 * y + 1.0)
}

fn chess(x: f64, y: f64) -> f64 {
    libm::cos(TAU * x) * libm::cos(TAU * y)
}

fn quadrant(x: f64, y: f64) -> f64 {
    if x <= 0.0 && y <= 0.0 { 1.0 } else { -1.0 / 3.0 }
}

fn jumps(x: f64, y: f64) -> f64 {
    match (x <= 0.0, y <= 0.0) {
        (true, true) => -1e6,
        (true, false) => 3e5,
        (false, _) => 1.0,
    }
}
