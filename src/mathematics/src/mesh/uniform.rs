//! Uniform triangulations of the square and the cube, with the nodes in natural order: x runs fastest.

use super::{MeshData, PlaneMesh, SpaceMesh};
use crate::discrete::grid::Grid;

/// The paper's triangulation of the square: each cell is cut by its rising diagonal.
pub fn uniform_square(grid: Grid) -> PlaneMesh {
    let n = grid.cells();
    // The quotient is rounded once, so that lines shared by nested grids coincide to the bit.
    let lines: Vec<_> = (0..=n).map(|i| i as f64 / n as f64 - 0.5).collect();
    lattice_mesh(&lines)
}

/// Triangulation of the square between these lines, the same along both axes, ascending; each cell is cut by its rising
/// diagonal.
///
/// # Panics
/// If there are less than two lines, or they do not ascend.
pub fn lattice_mesh(lines: &[f64]) -> PlaneMesh {
    let (n, side) = (lines.len() - 1, lines.len());
    let points = lines.iter().flat_map(|&y| lines.iter().map(move |&x| [x, y])).collect();
    let mut cells = Vec::with_capacity(2 * n * n);
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let [ll, lr, ul, ur] =
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| (j * side + i) as u32);
        cells.extend([[ll, lr, ur], [ll, ur, ul]]);
    }
    let data = MeshData { points, cells, ..MeshData::default() };
    data.mesh().expect("a uniform mesh passes the checks")
}

/// Kuhn's triangulation of the unit cube with `n` cells per side: six tetrahedra in each cell, along the paths from its
/// lowest to its highest corner (H. W. Kuhn, IBM J. Res. Dev. 4, 1960). Its stiffness matrix is that of the seven-point
/// stencil times 1 / n, but along the edges of the cube, where neighbours are coupled by a third or a sixth of 1 / n,
/// not by a quarter.
///
/// # Panics
/// If `n` is zero.
pub fn uniform_cube(n: usize) -> SpaceMesh {
    const AXES: [[usize; 3]; 6] =
        [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let side = n + 1;
    let place = |node: usize| [node % side, node / side % side, node / (side * side)];
    let points =
        (0..side.pow(3)).map(|node| place(node).map(|i| i as f64 / n as f64 - 0.5)).collect();
    let mut cells = Vec::with_capacity(6 * n.pow(3));
    for node in (0..side.pow(3)).filter(|&node| place(node).iter().all(|&i| i < n)) {
        for axes in AXES {
            // In the order of the path, from which refinement makes cells of the same kind; the checks turn every other
            // one.
            let mut cell = [node as u32; 4];
            for (step, &axis) in axes.iter().enumerate() {
                cell[step + 1] = cell[step] + side.pow(axis as u32) as u32;
            }
            cells.push(cell);
        }
    }
    let data = MeshData { points, cells, ..MeshData::default() };
    data.mesh().expect("a uniform mesh passes the checks")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::network::Network;
    use crate::mesh::{assemble, refined};

    #[test]
    fn the_square_has_the_rows_of_the_five_point_matrix() {
        let grid = Grid::new(8).unwrap();
        let (general, special) = (assemble(&uniform_square(grid)), Network::of_square(grid));
        for node in 0..grid.nodes() {
            let [a, b] = [general.row(node), special.row(node)];
            assert_eq!((a.others, a.weights), (b.others, b.weights));
        }
        let measures = general.contact().iter().map(|contact| contact.measure);
        assert!(measures.zip(0..).all(|(measure, _)| measure == grid.h()));
        // The diagonals end at two corners, which have two triangles each.
        assert!((general.masses()[0] * 64.0 * 3.0 - 1.0).abs() < 1e-15);
        assert!((general.masses()[8] * 64.0 * 6.0 - 1.0).abs() < 1e-15);
    }

    /// Number of nodes in the order of a coordinate, of the lattice with n cells per side.
    fn lattice_number(point: [f64; 3], n: usize) -> usize {
        let [i, j, k] = point.map(|x| ((x + 0.5) * n as f64).round() as usize);
        i + (n + 1) * (j + (n + 1) * k)
    }

    /// Part of the coupling inside that neighbours along an axis have, by their places along the other two.
    fn share(one: usize, two: usize, n: usize) -> f64 {
        match [one, two].map(|i| i == 0 || i == n) {
            [false, false] => 1.0,
            // An edge of the cube, which two paths of a cell follow, or one.
            [true, true] if one == two => 1.0 / 3.0,
            [true, true] => 1.0 / 6.0,
            _ => 0.5,
        }
    }

    #[test]
    fn refinements_of_the_cube_have_the_rows_of_the_seven_point_matrix() {
        for (coarsest, times) in [(1, 2), (2, 1), (3, 1), (4, 0), (5, 0)] {
            let n = coarsest << times;
            let (levels, mesh) = refined(&uniform_cube(coarsest), times).unwrap();
            let network = &levels[times].network;
            let numbers: Vec<_> = mesh.points().iter().map(|&p| lattice_number(p, n)).collect();
            let h = 1.0 / n as f64;
            for node in 0..network.nodes() {
                let at = |number: usize| {
                    [number % (n + 1), number / (n + 1) % (n + 1), number / (n + 1).pow(2)]
                };
                let here = at(numbers[node]);
                let row = network.row(node);
                let mut expected = 0;
                for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, n)]) {
                    expected += usize::from(here[axis] != side);
                }
                assert_eq!(row.others.len(), expected, "{here:?}");
                for (&other, weight) in row.others.iter().zip(row.weights) {
                    let there = at(numbers[other as usize]);
                    let axis = (0..3).find(|&d| here[d] != there[d]).unwrap();
                    let [one, two] = [here[(axis + 1) % 3], here[(axis + 2) % 3]];
                    let across = share(one, two, n);
                    assert!((weight - h * across).abs() < 1e-15, "{here:?} {there:?}");
                }
            }
            assert_eq!(network.contact().len(), (n + 1).pow(3) - (n - 1).pow(3));
            assert!((network.masses().iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!((network.perimeter() - 6.0).abs() < 1e-13);
        }
    }
}
