//! Direct solution on the coarsest grid of the cube.

use super::level::{Level, share};
use super::surface::place;
use crate::multigrid::active_set::{ActiveSetParams, on_network};
use crate::multigrid::banded::Banded;
use crate::multigrid::network::Network;

/// Order of the nodes: x fastest.
fn all_nodes(n: usize) -> impl Iterator<Item = [usize; 3]> {
    let planes = (0..=n).flat_map(move |k| (0..=n).map(move |j| (j, k)));
    planes.flat_map(move |(j, k)| (0..=n).map(move |i| [i, j, k]))
}

fn share_of(n: usize, node: [usize; 3]) -> f64 {
    node.iter().map(|&i| share(n, i)).product()
}

fn is_inside(n: usize, node: [usize; 3]) -> bool {
    node.iter().all(|&i| 0 < i && i < n)
}

/// Multiplications per visit of an unknown.
pub(super) const STENCIL: f64 = 7.0;

/// The Cholesky factor of the correction problem, made symmetric by the shares of the nodes.
pub(super) fn factor(level: &Level) -> Banded {
    let n = level.n;
    let steps = [1, n + 1, (n + 1) * (n + 1)];
    let mut matrix = Banded::zeros(level.nodes(), steps[2]);
    let diagonal = |node| match is_inside(n, node) {
        true => 6.0,
        false => 1.0 / level.inverse_diagonal[place(n, node)],
    };
    for (number, node) in all_nodes(n).enumerate() {
        *matrix.entry(number, number) = share_of(n, node) * diagonal(node);
        for axis in (0..3).filter(|&axis| node[axis] > 0) {
            let across = (0..3).filter(|&other| other != axis).map(|other| share(n, node[other]));
            *matrix.entry(number, number - steps[axis]) = -across.product::<f64>();
        }
    }
    for (number, node) in all_nodes(n).enumerate() {
        if diagonal(node).is_infinite() {
            matrix.fix(number);
        }
    }
    matrix.factor();
    matrix
}

/// Solves the correction problem.
pub(super) fn solve_linear(level: &mut Level, factor: &Banded) {
    let n = level.n;
    let right = |node| match is_inside(n, node) || level.inverse_diagonal[place(n, node)] > 0.0 {
        true => share_of(n, node) * level.load_at(node),
        false => 0.0,
    };
    let mut x: Vec<_> = all_nodes(n).map(right).collect();
    factor.solve(&mut x);
    all_nodes(n).zip(x).for_each(|(node, value)| level.set_value(node, value));
}

/// Solves the Signorini problem by the primal-dual active set method.
///
/// If rounding has made the sum of the load nonnegative, there is no solution, and zero must do. Returns
/// the work in visits of unknowns: a factorisation and two solutions for each step.
pub(super) fn solve_obstacle(level: &mut Level) -> f64 {
    let n = level.n;
    let h = 1.0 / n as f64;
    let load: Vec<_> =
        all_nodes(n).map(|node| h * share_of(n, node) * level.load_at(node)).collect();
    let params = ActiveSetParams::default();
    let solution = on_network(&Network::cube(n), &load, None, &params, |_| ());
    let (y, steps) =
        solution.map_or_else(|_| (vec![0.0; load.len()], 0), |(y, _, steps)| (y, steps));
    all_nodes(n).zip(y).for_each(|(node, value)| level.set_value(node, value));
    let matrix = Banded::zeros(level.nodes(), (n + 1) * (n + 1));
    steps as f64 * (matrix.factor_work() + 2.0 * matrix.solve_work()) / STENCIL
}
