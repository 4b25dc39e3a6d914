//! Sizes of grids and meshes that a solver can do with.

use super::Solver;
use crate::multigrid::{InputError, check_size};

/// Reason for which a solver does not run on a grid or mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SizeRefusal {
    /// Finer than the table of solvers allows.
    #[error("grid 1/{cells} is too fine for {solver}; 1/{most} is the finest")]
    TooFine {
        /// Solver.
        solver: Solver,
        /// Cells per side.
        cells: usize,
        /// Most cells per side.
        most: usize,
    },
    /// More nodes than the table of solvers allows.
    #[error("about {nodes:.0} nodes are too many for {solver}; {most} are the most")]
    TooManyNodes {
        /// Solver.
        solver: Solver,
        /// Number of nodes, about.
        nodes: f64,
        /// Most nodes.
        most: usize,
    },
    /// The domain does not have the solver.
    #[error("{0} is for the square alone")]
    NotOnMeshes(Solver),
    /// A number of cells that cannot be halved to a coarse grid.
    #[error(transparent)]
    Cells(#[from] InputError),
}

impl Solver {
    /// Refuses a grid of the square with so many cells per side that the solver cannot do with.
    ///
    /// # Errors
    /// [`SizeRefusal`].
    pub fn check_cells(self, cells: usize) -> Result<(), SizeRefusal> {
        if let Some(most) = self.entry().most_on_square.filter(|&most| cells > most) {
            return Err(SizeRefusal::TooFine { solver: self, cells, most });
        }
        if self == Self::Multigrid {
            check_size(cells)?;
        }
        Ok(())
    }

    /// Refuses a mesh in `dimension` dimensions with about so many nodes that the solver cannot do with.
    ///
    /// # Errors
    /// [`SizeRefusal`].
    pub fn check_nodes(self, dimension: u8, nodes: f64) -> Result<(), SizeRefusal> {
        let entry = self.entry();
        if !entry.on_meshes {
            return Err(SizeRefusal::NotOnMeshes(self));
        }
        match entry.most_nodes[usize::from(dimension - 2)].filter(|&most| nodes > most as f64) {
            Some(most) => Err(SizeRefusal::TooManyNodes { solver: self, nodes, most }),
            None => Ok(()),
        }
    }
}
