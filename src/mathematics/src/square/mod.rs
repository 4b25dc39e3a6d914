//! The square, faster: its loads, multigrid and bounds without a matrix in memory, on rows of nodes in vector
//! instructions.
//!
//! All of it could be deleted. The square would then be solved as any mesh is, by [`crate::multilevel`] with the bounds
//! of [`crate::bounds::triangulation`]: 16 to 48 times slower, and with a wider bracket of the energy.

pub mod bounds;
pub mod errors;
pub mod load;
pub mod multigrid;
