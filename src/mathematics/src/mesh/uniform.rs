//! Uniform triangulations of the square and the cube, with the nodes in the order of their grids.

use super::{MeshData, PlaneMesh, SpaceMesh};
use crate::discrete::cube;
use crate::discrete::grid::Grid;

/// The paper's triangulation of the square: each cell is cut by its rising diagonal.
pub fn uniform_square(grid: Grid) -> PlaneMesh {
    let (n, side) = (grid.cells(), grid.side());
    let nodes = (0..side).flat_map(|j| (0..side).map(move |i| [i, j]));
    let points = nodes.map(|at| at.map(|i| i as f64 / n as f64 - 0.5)).collect();
    let mut cells = Vec::with_capacity(2 * n * n);
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let [ll, lr, ul, ur] =
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| grid.index(i, j) as u32);
        cells.extend([[ll, lr, ur], [ll, ur, ul]]);
    }
    let data = MeshData { points, cells, ..MeshData::default() };
    data.mesh().expect("a uniform mesh passes the checks")
}

/// Kuhn's triangulation of the cube: six tetrahedra in each cell, along the paths from its lowest to its highest corner.
pub fn uniform_cube(grid: cube::Grid) -> SpaceMesh {
    const AXES: [[usize; 3]; 6] =
        [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let (n, side) = (grid.cells(), grid.cells() + 1);
    let points = grid.indices().map(|at| at.map(|i| grid.coordinate(i))).collect();
    let mut cells = Vec::with_capacity(6 * n.pow(3));
    for (node, _) in grid.indices().enumerate().filter(|(_, at)| at.iter().all(|&i| i < n)) {
        for (k, axes) in AXES.iter().enumerate() {
            let mut cell = [node as u32; 4];
            for (step, &axis) in axes.iter().enumerate() {
                cell[step + 1] = cell[step] + side.pow(axis as u32) as u32;
            }
            // Every other path turns the other way.
            if k >= 3 {
                cell.swap(2, 3);
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
    use crate::mesh::assemble;

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

    #[test]
    fn the_cube_is_coupled_along_its_axes_alone() {
        let grid = cube::Grid::new(4).unwrap();
        let (general, special) = (assemble(&uniform_cube(grid)), Network::of_cube(grid));
        assert_eq!(general.couplings(), special.couplings());
        let inner = 2 * 25 + 2 * 5 + 2;
        let [a, b] = [general.row(inner), special.row(inner)];
        assert_eq!(a.others, b.others);
        assert!(a.weights.iter().all(|weight| (weight - 0.25).abs() < 1e-15));
        assert!((general.masses().iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}
