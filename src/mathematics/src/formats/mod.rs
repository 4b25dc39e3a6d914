//! Solutions as files for other programs: NPY and NPZ for NumPy, VTK XML for ParaView.

mod fields;
mod npy;
mod vtk;
mod zip;

use crate::levels::Problem;
use crate::saddle::Pair;
use fields::SolutionFields;

/// v of a pair of the finest level in NPY format.
pub fn npy(problem: &Problem, pair: &Pair) -> Vec<u8> {
    SolutionFields::values(problem, pair).npy()
}

/// Pair of the finest level in NPZ format, not compressed: `v` and `multiplier` at the nodes, `f` on the cells. On a
/// mesh also `points`, one row of coordinates a node; `cells`, one row of nodes a cell, in the positive sense; the
/// number of the `region` of each cell, from 0 on, and its `local_error` where it is known.
///
/// None if they do not fit into the four gigabytes that such an archive may have.
pub fn npz(problem: &Problem, pair: &Pair) -> Option<Vec<u8>> {
    SolutionFields::of(problem, pair).npz()
}

/// Pair of the finest level in VTK's XML format, with this name: points with `v` and `multiplier`, cells with `f`; raw
/// little-endian numbers. On the square it is image data, on a mesh an unstructured grid in the space of the mesh's
/// file, with the number of the `region` of each cell, from 0 on, to whose names the field data have numbers, and the
/// `local_error` where it is known.
pub fn vtk(problem: &Problem, pair: &Pair, name: &str) -> Vec<u8> {
    vtk::vtk(&SolutionFields::of(problem, pair), name)
}

/// Ending of the files of [`vtk`], `vti` or `vtu`.
pub fn vtk_ending(problem: &Problem) -> &'static str {
    if problem.lattices().is_some() { "vti" } else { "vtu" }
}
