//! Sizes of grids and meshes: what a solver can do with, and the memory that it takes.

use super::Solver;
use crate::mesh::AnyMesh;
use crate::multigrid::{InputError, check_size};
use std::error::Error;
use std::fmt;

/// Largest number of cells per side of the square; two nodal vectors of that grid take about 1 GB.
pub const MOST_CELLS: usize = 8192;
/// Bytes per node of the finest of adapted meshes, with all coarser ones: measured, rounded up.
const ADAPTED: u64 = 900;

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
    /// More memory than is left.
    #[error("takes about {megabytes:.0} MB of memory, where {left:.0} MB are left")]
    Memory {
        /// Memory that it takes, in MB.
        megabytes: f64,
        /// Memory that is left, in MB.
        left: f64,
    },
    /// The domain does not have the solver.
    #[error("{0} is for domains in the plane")]
    NotInSpace(Solver),
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
        if dimension == 3 && !entry.in_space {
            return Err(SizeRefusal::NotInSpace(self));
        }
        match entry.most_nodes[usize::from(dimension - 2)].filter(|&most| nodes > most as f64) {
            Some(most) => Err(SizeRefusal::TooManyNodes { solver: self, nodes, most }),
            None => Ok(()),
        }
    }
}

/// Memory that is left, and the files for which some of it is needed.
#[derive(Clone, Copy, Debug)]
pub struct Memory {
    /// Bytes that are left.
    left: u64,
    /// True if files with the solution are written besides.
    has_files: bool,
    /// Most nodes of an adapted mesh, whatever is left.
    most_nodes: usize,
}

/// Grid or mesh that is too large, with what would fit; in words, what follows its name.
#[derive(Clone, Debug, PartialEq)]
pub struct TooLarge {
    /// Cells per side of the grid, or number of refinements of the mesh.
    pub finest: usize,
    /// Reason.
    reason: SizeRefusal,
    /// Cells per side or number of refinements that would fit; none if the coarsest mesh is too large, or the reason
    /// has it.
    pub fits: Option<usize>,
}

impl Error for TooLarge {}

impl fmt::Display for TooLarge {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.reason {
            SizeRefusal::TooFine { most, solver, .. } => {
                write!(out, "needs too much memory; 1/{most} is the finest for {solver}")
            }
            SizeRefusal::TooManyNodes { nodes, most, solver } => {
                write!(out, "makes about {nodes:.0} nodes, where {solver} can do with {most}")
            }
            reason => write!(out, "{reason}"),
        }
    }
}

impl TooLarge {
    /// True if it is the memory that is too small, and not the solver that can do with less.
    pub fn is_of_memory(&self) -> bool {
        matches!(self.reason, SizeRefusal::Memory { .. })
    }

    /// Sentence on a grid of the square, as the user asked for it.
    pub fn on_grid(&self, asked: &str) -> String {
        let remedy = self.fits.map(|cells| format!("; 1/{cells} would fit"));
        format!("{asked} {self}{}", remedy.unwrap_or_default())
    }
}

impl Memory {
    /// So many bytes, or as many as it takes; no file is written.
    pub fn new(left: Option<u64>) -> Self {
        Self { left: left.unwrap_or(u64::MAX), has_files: false, most_nodes: usize::MAX }
    }

    /// Memory for files with the solution.
    pub fn with_files(self) -> Self {
        Self { has_files: true, ..self }
    }

    /// Refuses a grid of the square with so many cells per side that is too large for a solver, or for the memory.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub fn check_grid(self, solver: Solver, cells: usize) -> Result<(), TooLarge> {
        let most = solver.entry().most_on_square.unwrap_or(MOST_CELLS);
        let bytes = |cells: usize| self.of_grid(solver, cells);
        let mut fits = cells / 2;
        while fits >= 4 && bytes(fits) > self.left {
            fits /= 2;
        }
        let reason = match cells {
            _ if cells > most => {
                let reason = SizeRefusal::TooFine { solver, cells, most };
                return Err(TooLarge { finest: cells, reason, fits: None });
            }
            _ if bytes(cells) > self.left => {
                let [megabytes, left] =
                    [bytes(cells), self.left].map(|all| (all / 1_000_000) as f64);
                SizeRefusal::Memory { megabytes, left }
            }
            _ => return Ok(()),
        };
        Err(TooLarge { finest: cells, reason, fits: Some(fits) })
    }

    /// Refuses a mesh that is refined so often that it is too large for a solver, or for the memory.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub fn check_mesh(self, solver: Solver, mesh: &AnyMesh, times: usize) -> Result<(), TooLarge> {
        let check = |times: usize| {
            solver.check_nodes(mesh.dimension(), mesh.nodes_after(times))?;
            let [megabytes, left] =
                [self.of_mesh(mesh, times), self.left as f64].map(|all| all / 1e6);
            if megabytes <= left { Ok(()) } else { Err(SizeRefusal::Memory { megabytes, left }) }
        };
        let fits = || (0..times).rev().find(|&times| check(times).is_ok());
        check(times).map_err(|reason| TooLarge { finest: times, reason, fits: fits() })
    }

    /// Memory of which adapted meshes use no more than for so many nodes.
    pub fn with_most_nodes(self, most_nodes: usize) -> Self {
        Self { most_nodes, ..self }
    }

    /// Most nodes of an adapted mesh.
    pub(crate) fn adapted_nodes(self) -> usize {
        self.nodes_that_fit().min(self.most_nodes)
    }

    /// True if the number of nodes that was asked for is less than what fits.
    pub(crate) fn is_limited(self) -> bool {
        self.most_nodes < self.nodes_that_fit()
    }

    fn nodes_that_fit(self) -> usize {
        usize::try_from(self.left / ADAPTED).unwrap_or(usize::MAX)
    }

    /// Bytes for solving on a grid, and for the files.
    fn of_grid(self, solver: Solver, cells: usize) -> u64 {
        let n = cells as u64;
        let files = if self.has_files { 24 } else { 0 };
        (n + 1).pow(2) * ((solver.entry().bytes_per_node)(n) + files)
    }

    /// Bytes for mesh, networks, solver, bounds and files on a mesh that is refined so often: measured, rounded up.
    fn of_mesh(self, mesh: &AnyMesh, times: usize) -> f64 {
        // Below the coarsest mesh there are levels of aggregates.
        let [finest, coarsest, files] = match mesh.dimension() {
            2 => [480.0, 320.0, 340.0],
            _ => [950.0, 1000.0, 810.0],
        };
        let files = if self.has_files { files } else { 0.0 };
        (finest + files) * mesh.nodes_after(times) + coarsest * mesh.nodes() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_take_memory_too() {
        let solver = Solver::Multigrid;
        let memory = Memory::new(Some(Memory::new(None).of_grid(solver, 256)));
        assert!(memory.check_grid(solver, 256).is_ok());
        assert!(memory.with_files().check_grid(solver, 256).is_err());
    }
}
