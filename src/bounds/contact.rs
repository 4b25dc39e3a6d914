//! The arcs of the boundary that carry reactions, their ends and forces.

use crate::discrete::contact::{ContactArc, reach};
use crate::discrete::grid::Grid;

/// The arcs of boundary nodes with reactions `a`, for the boundary values `v`, both in boundary order.
pub(super) fn arcs(grid: Grid, v: &[f64], a: &[f64]) -> Vec<ContactArc> {
    let nodes = a.len();
    let carries = |b: usize| a[if b < nodes { b } else { b - nodes }] > 0.0;
    if (0..nodes).all(carries) {
        let corner = point(grid, 0.0);
        return vec![ContactArc { from: corner, to: corner, force: a.iter().sum() }];
    }
    let arc = |start: usize| {
        let end = (start..).find(|&b| !carries(b)).expect("not all carry");
        let before = [nodes - 1, nodes - 2].map(|k| v[(start + k) % nodes]);
        let after = [0, 1].map(|k| v[(end + k) % nodes]);
        let mut beyond = [before, after].map(|values| reach(values).clamp(0.0, 1.0));
        if end - start == 1 && beyond == [0.0; 2] {
            // No ends can be told around this one node, and an arc without length would stand for all of the boundary.
            beyond = [0.5; 2];
        }
        ContactArc {
            from: point(grid, start as f64 - beyond[0]),
            to: point(grid, (end - 1) as f64 + beyond[1]),
            force: (start..end).map(|b| a[b % nodes]).sum(),
        }
    };
    (1..=nodes).filter(|&b| carries(b) && !carries(b - 1)).map(arc).collect()
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
