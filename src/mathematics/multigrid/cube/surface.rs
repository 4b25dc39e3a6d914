//! Numbers for the boundary nodes of a grid of the cube, and sums over their neighbours on its faces.

use super::Cube;
use crate::multigrid::layout::{boundary_nodes, boundary_number, mirrored};

/// How many nodes lie on the boundary.
pub(super) fn nodes(n: usize) -> usize {
    boundary_nodes::<Cube>(n)
}

/// Number of a boundary node: boundary nodes are counted in natural order.
#[inline(always)]
pub(super) fn place(n: usize, node: [usize; 3]) -> usize {
    boundary_number::<Cube>(n, &node)
}

/// Sums of a field over a node itself, its nearest and its diagonal neighbours on the faces it lies on,
/// faces continued by reflection.
#[inline(always)]
pub(super) fn around(n: usize, field: &[f64], node: [usize; 3]) -> [f64; 3] {
    let here = place(n, node);
    let Some([a, b]) = steps(n, node) else { return around_edge(n, field, node) };
    let three = |middle: usize| (field[middle - a] + field[middle + a], field[middle]);
    let ((below, south), (sides, own), (above, north)) =
        (three(here - b), three(here), three(here + b));
    [own, sides + (south + north), below + above]
}

/// Distances to the neighbours of a node that is well inside a face.
#[inline(always)]
fn steps(n: usize, [i, j, k]: [usize; 3]) -> Option<[usize; 2]> {
    let inside = |i: usize| 0 < i && i < n;
    let well_inside = |i: usize| 1 < i && i + 1 < n;
    match (inside(i), inside(j), inside(k)) {
        (true, true, false) => Some([1, n + 1]),
        (true, false, true) if well_inside(k) => Some([1, 4 * n]),
        (false, true, true) if well_inside(j) && well_inside(k) => Some([2, 4 * n]),
        _ => None,
    }
}

/// The same at and near edges, where places are irregular.
fn around_edge(n: usize, field: &[f64], node: [usize; 3]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    let near = node.map(|i| {
        let [before, after] = mirrored(n, i);
        [(before, 1), (i, 0), (after, 1)]
    });
    for (k, dk) in near[2] {
        for (j, dj) in near[1] {
            for (i, di) in near[0] {
                let other = [i, j, k];
                let on_face =
                    |axis: usize| node[axis] == other[axis] && (node[axis] == 0 || node[axis] == n);
                if (0..3).any(on_face) {
                    sums[di + dj + dk] += field[place(n, other)];
                }
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multigrid::stencil::for_each_boundary_node;

    #[test]
    fn places_count_the_boundary() {
        for n in [2, 4, 6] {
            let mut count = 0;
            for_each_boundary_node::<Cube>(n, |p, node| {
                assert_eq!((p, place(n, node)), (count, count), "{node:?}");
                count += 1;
            });
            assert_eq!(count, nodes(n));
        }
    }

    #[test]
    fn fast_and_careful_sums_agree() {
        let n = 8;
        let field: Vec<_> = (0..nodes(n)).map(|p| ((p * p) % 31) as f64).collect();
        for_each_boundary_node::<Cube>(n, |_, node| {
            assert_eq!(around(n, &field, node), around_edge(n, &field, node), "{node:?}");
        });
        // A face has nine nodes around each of its own, an edge fifteen, a corner nineteen.
        let ones = vec![1.0; nodes(n)];
        let around = |node| around(n, &ones, node);
        assert_eq!(around([3, 0, 5]), [1.0, 4.0, 4.0]);
        assert_eq!(around([0, 0, 5]), [1.0, 6.0, 8.0]);
        assert_eq!(around([0, 8, 0]), [1.0, 6.0, 12.0]);
    }
}
