//! Solutions as files for other programs: NPY and NPZ for NumPy, VTK XML for ParaView; functions of [`Problem`].

mod fields;
mod npy;
mod vtk;
mod zip;

use crate::levels::Problem;
use crate::saddle::Pair;
use fields::SolutionFields;
use std::collections::BTreeMap;

impl Problem {
    /// v of a pair of the finest level in NPY format.
    pub fn npy(&self, pair: &Pair) -> Vec<u8> {
        SolutionFields::values(self, pair).npy()
    }

    /// Pair of the finest level in NPZ format, not compressed: `v` and `multiplier` at the nodes, `f` on the cells. On
    /// a mesh also `points`, one row of coordinates a node; `cells`, one row of nodes a cell, in the positive sense;
    /// the number of the `region` of each cell, from 0 on, and its `local_error` where it is known.
    ///
    /// None if they do not fit into the four gigabytes that such an archive may have.
    pub fn npz(&self, pair: &Pair) -> Option<Vec<u8>> {
        SolutionFields::of(self, pair).npz()
    }

    /// Pair of the finest level in VTK's XML format, with this name: points with `v` and `multiplier`, cells with `f`;
    /// raw little-endian numbers. On the square it is image data, on a mesh an unstructured grid in the space of the
    /// mesh's file, with the `gradient` of v, the number of the `region` of each cell, from 0 on, to whose names the
    /// field data have numbers, and the `local_error` where it is known.
    pub fn vtk(&self, pair: &Pair, name: &str) -> Vec<u8> {
        vtk::vtk(&SolutionFields::of(self, pair), name)
    }

    /// Ending of the files of [`Problem::vtk`], `vti` or `vtu`.
    pub fn vtk_ending(&self) -> &'static str {
        if self.lattices().is_some() { "vti" } else { "vtu" }
    }

    /// Meshes of all levels for ParaView, as files by their names: `NAME.pvd`, which lists them, and `NAME-0.vtu` and
    /// so on, coarsest first, each as [`Problem::vtk`] has it, without `f` and `local_error`, with the pair of the
    /// finest level at the nodes of the mesh. None on the square.
    pub fn pvd(&self, pair: &Pair, name: &str) -> Option<BTreeMap<String, Vec<u8>>> {
        if self.lattices().is_some() {
            return None;
        }
        let mut names = Vec::new();
        let mut files = BTreeMap::new();
        for level in 0..self.count() {
            let file = format!("{name}-{level}.vtu");
            let fields = SolutionFields::on_mesh(self, pair, level);
            files.insert(file.clone(), vtk::vtk(&fields, name));
            names.push(file);
        }
        files.insert(format!("{name}.pvd"), vtk::collection(&names));
        Some(files)
    }
}
