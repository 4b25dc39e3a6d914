//! Meshes of pictures: those of solutions, or coarser ones whose triangles can be told apart.

use super::Surface;
use super::camera::uphill;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::levels::{Levels, Problem};
use signorini_mathematics::mesh::{AnyMesh, PlaneMesh, lattice_mesh};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::Pair;

/// Most triangles of a picture, beside which it would grow too large.
const MOST_TRIANGLES: usize = 2500;
/// Most cells per side of the square that are drawn where two panels are in a row; in smaller panels there are fewer.
const MOST_CELLS: usize = 32;

/// Mesh of a picture.
pub(crate) struct DrawnMesh {
    pub(crate) mesh: PlaneMesh,
    /// Position of each of its nodes in a nodal vector of the solution.
    nodes: Vec<usize>,
}

/// Solution on the mesh of a picture.
pub(crate) struct DrawnSolution {
    title: String,
    mesh: PlaneMesh,
    /// Heights at the nodes.
    pub(crate) y: Vec<f64>,
    /// Nodes in contact.
    in_contact: Vec<bool>,
}

/// Returns the finest of nested levels whose triangles can be told apart in a picture, or else the coarsest one.
pub(crate) fn drawn_level(levels: &dyn Levels) -> usize {
    let fits = |level: &usize| levels.mesh(*level).cells() <= MOST_TRIANGLES;
    (1..levels.count()).take_while(fits).last().unwrap_or(0)
}

impl DrawnMesh {
    /// Returns the mesh of a picture of solutions of a problem, in rows of `columns`.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub(crate) fn of(problem: &Problem, columns: usize) -> Result<Self, String> {
        if let Some(lattices) = problem.lattices() {
            return Ok(Self::of_grid(lattices.finest(), columns));
        }
        let levels = problem.levels();
        let AnyMesh::Plane(mesh) = levels.mesh(drawn_level(levels)) else {
            return Err("a solution in space has no picture".into());
        };
        // The first nodes of a refined mesh are those of the coarser ones.
        let nodes = (0..mesh.points().len()).collect();
        Ok(Self { mesh, nodes })
    }

    /// Returns the mesh of a picture of solutions on a grid of the square: its lines, or as many equally spaced ones as
    /// there is room for, and the last.
    fn of_grid(grid: Grid, columns: usize) -> Self {
        let lines = thinned(grid, MOST_CELLS * 2 / columns.max(2));
        let coordinates: Vec<_> = lines.iter().map(|&i| grid.coordinate(i)).collect();
        let nodes = lines.iter().flat_map(|&j| lines.iter().map(move |&i| grid.index(i, j)));
        Self { mesh: lattice_mesh(&coordinates), nodes: nodes.collect() }
    }

    /// Values of a nodal vector of the solution at the nodes of the picture.
    fn values<T: Copy>(&self, nodal: &[T]) -> Vec<T> {
        self.nodes.iter().map(|&node| nodal[node]).collect()
    }
}

/// Returns the grid lines that are drawn, equally spaced and at most `most`, and the last.
fn thinned(grid: Grid, most: usize) -> Vec<usize> {
    let n = grid.cells();
    let mut lines: Vec<usize> = (0..n).step_by(n.div_ceil(most)).collect();
    lines.push(n);
    lines
}

impl DrawnSolution {
    /// Solution of a problem, as a panel in rows of `columns`.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub(crate) fn of(
        title: String,
        problem: &Problem,
        pair: &Pair,
        columns: usize,
    ) -> Result<Self, String> {
        let in_contact = problem.levels().in_contact(problem.law(), pair);
        let in_contact = problem.at_nodes(&in_contact, false);
        Ok(Self::new(title, DrawnMesh::of(problem, columns)?, &pair.y, &in_contact))
    }

    /// Pair on a grid of the square under a law, as a panel in rows of `columns`.
    pub(crate) fn on_grid(
        title: String,
        (grid, law): (Grid, Law),
        pair: &Pair,
        columns: usize,
    ) -> Self {
        let mut in_contact = vec![false; pair.y.len()];
        for (node, touches) in grid.boundary().zip(pair.in_contact(grid, law)) {
            in_contact[node] = touches;
        }
        Self::new(title, DrawnMesh::of_grid(grid, columns), &pair.y, &in_contact)
    }

    /// Nodal vector of a solution, and its nodes in contact.
    fn new(title: String, drawn: DrawnMesh, y: &[f64], in_contact: &[bool]) -> Self {
        let (y, in_contact) = (drawn.values(y), drawn.values(in_contact));
        Self { title, mesh: drawn.mesh, y, in_contact }
    }

    /// This surface without marks of contact.
    pub(crate) fn without_contact(mut self) -> Self {
        self.in_contact.fill(false);
        self
    }

    /// Azimuth of the viewer from which the surface hides least.
    pub(crate) fn azimuth(&self) -> f64 {
        uphill(&self.mesh, &self.y)
    }

    /// Panel with a range of heights and colours, none for that of the data and zero.
    pub(crate) fn panel(&self, azimuth: f64, range: Option<(f64, f64)>) -> Surface<'_> {
        let Self { title, mesh, y, in_contact } = self;
        Surface { title, mesh, y, in_contact, azimuth, range }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_both_ends() {
        assert_eq!(lines(4), [0, 1, 2, 3, 4]);
        assert_eq!(lines(64).len(), 33);
        assert_eq!(lines(33).last(), Some(&33));
        assert!(lines(1000).len() <= MOST_CELLS + 1);
    }

    fn lines(cells: usize) -> Vec<usize> {
        thinned(Grid::new(cells).unwrap(), MOST_CELLS)
    }

    #[test]
    fn the_nodes_of_a_thinned_grid_have_their_values() {
        let grid = Grid::new(70).unwrap();
        let drawn = DrawnMesh::of_grid(grid, 3);
        let y: Vec<_> = (0..grid.nodes()).map(|k| k as f64).collect();
        for (value, &[px, py]) in drawn.values(&y).iter().zip(drawn.mesh.points()) {
            let (i, j) = (*value as usize % 71, *value as usize / 71);
            assert_eq!([px, py], [grid.coordinate(i), grid.coordinate(j)]);
        }
    }
}
