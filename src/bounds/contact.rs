//! The arcs of the boundary that carry reactions, their ends and forces.

use crate::discrete::contact::{ContactArc, reach};
use crate::discrete::grid::Grid;

/// The arcs of boundary nodes with reactions `a`, for the boundary values `v`, both in boundary order.
pub(super) fn arcs(grid: Grid, v: &[f64], a: &[f64]) -> Vec<ContactArc> {
    let nodes = a.len();
    let Some(free) = a.iter().position(|&a| a <= 0.0) else {
        let corner = point(grid, 0.0);
        return vec![ContactArc { from: corner, to: corner, force: a.iter().sum() }];
    };
    let at = |b: usize| b % nodes;
    let (mut arcs, mut first) = (Vec::new(), None);
    for b in free + 1..=free + nodes {
        match (a[at(b)] > 0.0, first) {
            (true, None) => first = Some(b),
            (false, Some(start)) => {
                let last = b - 1;
                let before = [at(start + nodes - 1), at(start + nodes - 2)].map(|b| v[b]);
                let after = [at(b), at(b + 1)].map(|b| v[b]);
                arcs.push(ContactArc {
                    from: point(grid, start as f64 - reach(before).clamp(0.0, 1.0)),
                    to: point(grid, last as f64 + reach(after).clamp(0.0, 1.0)),
                    force: (start..=last).map(|b| a[at(b)]).sum(),
                });
                first = None;
            }
            _ => {}
        }
    }
    arcs
}

/// The point of the boundary at the distance `p h` from the lower left corner, anticlockwise.
fn point(grid: Grid, p: f64) -> [f64; 2] {
    let n = grid.cells() as f64;
    let p = p.rem_euclid(4.0 * n) / n;
    let along = p.fract() - 0.5;
    match p as usize {
        0 => [along, -0.5],
        1 => [0.5, along],
        2 => [-along, 0.5],
        _ => [-0.5, -along],
    }
}
