//! Numbers of the boundary nodes of a grid of the cube, and sums over neighbours on the faces.

use super::Cube;
use crate::multigrid::layout::{boundary_nodes, boundary_number, is_inside, mirrored};

/// Number of nodes on the boundary.
pub(super) fn nodes(n: usize) -> usize {
    boundary_nodes::<Cube>(n)
}

/// Number of a boundary node: boundary nodes are counted in natural order.
#[inline(always)]
pub(super) fn place(n: usize, node: [usize; 3]) -> usize {
    boundary_number::<Cube>(n, &node)
}

/// Sums of a field over a node itself, over its nearest and over its diagonal neighbours on the faces to which it
/// belongs. Faces are continued by reflection.
#[inline(always)]
pub(super) fn neighbour_sums(n: usize, field: &[f64], node: [usize; 3]) -> [f64; 3] {
    let Some([a, b]) = steps(n, node) else { return neighbour_sums_at_edge(n, field, node) };
    let here = place(n, node);
    let below = field[here - b - a] + field[here - b + a];
    let sides = field[here - a] + field[here + a];
    let above = field[here + b - a] + field[here + b + a];
    [field[here], sides + (field[here - b] + field[here + b]), below + above]
}

/// Distances between the number of a node and those of its neighbours along both axes of the face; `None` within one
/// node of an edge, where the distances vary.
#[inline(always)]
fn steps(n: usize, [i, j, k]: [usize; 3]) -> Option<[usize; 2]> {
    match (is_inside(n, i), is_inside(n, j), is_inside(n, k)) {
        (true, true, false) => Some([1, n + 1]),
        (true, false, true) if is_well_inside(n, k) => Some([1, 4 * n]),
        (false, true, true) if is_well_inside(n, j) && is_well_inside(n, k) => Some([2, 4 * n]),
        _ => None,
    }
}

/// True if both neighbours of node `i` lie inside.
#[inline(always)]
fn is_well_inside(n: usize, i: usize) -> bool {
    1 < i && i + 1 < n
}

/// [`neighbour_sums`] for any node, from the numbers of all neighbours.
fn neighbour_sums_at_edge(n: usize, field: &[f64], node: [usize; 3]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    let near = node.map(|i| {
        let [before, after] = mirrored(n, i);
        [(before, 1), (i, 0), (after, 1)]
    });
    for (k, dk) in near[2] {
        for (j, dj) in near[1] {
            for (i, di) in near[0] {
                let other = [i, j, k];
                if (0..3).any(|axis| node[axis] == other[axis] && !is_inside(n, node[axis])) {
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
    fn sums_by_steps_equal_sums_by_numbers() {
        let n = 8;
        let field: Vec<_> = (0..nodes(n)).map(|p| ((p * p) % 31) as f64).collect();
        for_each_boundary_node::<Cube>(n, |_, node| {
            let expected = neighbour_sums_at_edge(n, &field, node);
            assert_eq!(neighbour_sums(n, &field, node), expected, "{node:?}");
        });
        // Nine nodes around a node of a face, fifteen around a node of an edge, nineteen around a corner.
        let ones = vec![1.0; nodes(n)];
        assert_eq!(neighbour_sums(n, &ones, [3, 0, 5]), [1.0, 4.0, 4.0]);
        assert_eq!(neighbour_sums(n, &ones, [0, 0, 5]), [1.0, 6.0, 8.0]);
        assert_eq!(neighbour_sums(n, &ones, [0, 8, 0]), [1.0, 6.0, 12.0]);
    }
}
