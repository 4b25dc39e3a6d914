//! Solutions as files for other programs: NPY and NPZ for NumPy, VTK XML for ParaView; functions of [`Problem`].

mod vtk;
mod zip;

use crate::discrete::grid::Grid;
use crate::levels::Problem;
use crate::mesh::AnyMesh;
use crate::saddle::Pair;
use std::borrow::Cow;
use zip::{DOUBLE, INTEGER, SHORT, doubles, integers, npy};

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
}

/// Solution as arrays.
#[derive(Clone)]
pub(super) struct SolutionFields<'a> {
    pub(super) place: FieldPlace<'a>,
    /// v at the nodes.
    pub(super) v: &'a [f64],
    /// Multiplier of the law at the nodes, zero inside and on fixed and free parts.
    pub(super) multiplier: Vec<f64>,
    /// f in the middle of each square of a grid, or its mean over each cell of a mesh; empty if it is left out.
    pub(super) f: Cow<'a, [f64]>,
    /// Guaranteed error in each cell; empty if it is not known.
    pub(super) errors: Vec<f64>,
}

/// Grid or mesh to whose nodes and cells arrays belong.
#[derive(Clone)]
#[expect(clippy::large_enum_variant, reason = "one value for each file")]
pub(super) enum FieldPlace<'a> {
    /// The square: x runs fastest.
    Grid(Grid),
    /// A mesh.
    Mesh(Cow<'a, AnyMesh>),
}

impl<'a> SolutionFields<'a> {
    /// Arrays with v alone.
    pub(super) fn values(problem: &'a Problem, pair: &'a Pair) -> Self {
        let place = match problem.lattices() {
            Some(lattices) => FieldPlace::Grid(lattices.finest()),
            None => FieldPlace::Mesh(problem.levels().mesh(problem.finest())),
        };
        let (f, errors) = (Cow::default(), Vec::new());
        Self { place, v: &pair.y, multiplier: Vec::new(), f, errors }
    }

    pub(super) fn of(problem: &'a Problem, pair: &'a Pair) -> Self {
        let (levels, values) = (problem.levels(), Self::values(problem, pair));
        let f = match problem.lattices() {
            Some(lattices) => {
                let (n, h) = (lattices.finest().cells(), lattices.finest().h());
                let middle = |k: usize| [k % n, k / n].map(|k| (k as f64 + 0.5) * h - 0.5);
                (0..n * n).map(|k| lattices.source().at(middle(k))).collect()
            }
            None => levels.means(usize::MAX).expect("f is known on the finest mesh"),
        };
        let multiplier = problem.at_nodes(&pair.a, 0.0);
        let errors = levels.local_errors(&pair.y);
        Self { multiplier, f, errors, ..values }
    }

    /// Lengths of an array at the nodes, or on the cells, of which there are so many.
    fn shape(&self, at_nodes: bool, numbers: usize) -> Vec<usize> {
        match &self.place {
            FieldPlace::Grid(grid) => vec![grid.cells() + usize::from(at_nodes); 2],
            FieldPlace::Mesh(_) => vec![numbers],
        }
    }

    pub(super) fn npy(&self) -> Vec<u8> {
        npy(DOUBLE, &self.shape(true, self.v.len()), doubles(self.v))
    }

    pub(super) fn npz(&self) -> Option<Vec<u8>> {
        let Self { place, v, multiplier, f, errors } = self;
        let (nodes, cells) = (v.len(), f.len());
        let mesh = match place {
            FieldPlace::Grid(_) => None,
            FieldPlace::Mesh(mesh) => Some((&**mesh, usize::from(mesh.dimension()))),
        };
        let of_mesh = mesh.map_or(0, |(_, d)| d * nodes + (d + 3) * cells);
        if !zip::fits(2 * nodes + cells + of_mesh) {
            return None;
        }
        let mut arrays = Vec::new();
        if let Some((mesh, d)) = mesh {
            let vertices = integers(mesh.positive_cells());
            arrays.push(("points.npy", npy(DOUBLE, &[nodes, d], doubles(mesh.coordinates()))));
            arrays.push(("cells.npy", npy(INTEGER, &[cells, d + 1], vertices)));
        }
        let at_nodes = self.shape(true, nodes);
        arrays.push(("v.npy", self.npy()));
        arrays.push(("multiplier.npy", npy(DOUBLE, &at_nodes, doubles(multiplier))));
        arrays.push(("f.npy", npy(DOUBLE, &self.shape(false, cells), doubles(f))));
        if let Some((mesh, _)) = mesh {
            let regions = mesh.regions().iter().map(|region| region.to_le_bytes());
            arrays.push(("region.npy", npy(SHORT, &[cells], regions)));
        }
        if !errors.is_empty() {
            arrays.push(("local_error.npy", npy(DOUBLE, &[cells], doubles(errors))));
        }
        Some(zip::zip(&arrays))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::LoadRule;
    use crate::mesh::BuiltIn;
    use crate::problem::law::Law;

    /// Solution on a mesh that is v = multiplier = node, f = cell.
    pub(in crate::formats) fn counted(mesh: AnyMesh, v: &[f64]) -> SolutionFields<'_> {
        let f = (0..mesh.cells() as u32).map(f64::from).collect();
        let place = FieldPlace::Mesh(Cow::Owned(mesh));
        SolutionFields { place, v, multiplier: v.to_vec(), f, errors: Vec::new() }
    }

    #[test]
    fn the_multiplier_is_at_the_boundary_and_f_in_the_cells() {
        let (grid, f) = (Grid::new(2).unwrap(), "quadrant(ll)=3; else=-2".parse().unwrap());
        let problem =
            Problem::on_square(vec![grid], f, LoadRule::default(), Law::SIGNORINI).unwrap();
        let pair = Pair { y: vec![1.0; 9], a: (1..=8).map(f64::from).collect() };
        let fields = SolutionFields::of(&problem, &pair);
        assert_eq!(fields.f[..], [3.0, -2.0, -2.0, -2.0]);
        // Row by row, where the boundary runs anticlockwise.
        assert_eq!(fields.multiplier, [1.0, 2.0, 3.0, 8.0, 0.0, 4.0, 7.0, 6.0, 5.0]);
        let archive = fields.npz().unwrap();
        assert!(archive.starts_with(b"PK\x03\x04") && archive.len() > 25 * 8 + 3 * 128);
    }

    /// True if a file has these letters.
    fn has(archive: &[u8], text: &str) -> bool {
        archive.windows(text.len()).any(|part| part == text.as_bytes())
    }

    #[test]
    fn arrays_for_numpy_have_rows_of_coordinates_and_of_vertices() {
        let values: Vec<f64> = (0..8).map(f64::from).collect();
        let counted = counted(BuiltIn::LShape.plane().unwrap().into(), &values);
        let archive = counted.npz().unwrap();
        for header in ["(8, 2), }", "(6, 3), }", "(8,), }", "(6,), }"] {
            assert!(has(&archive, header), "{header}");
        }
        assert!(has(&archive, "region.npy") && has(&archive, "'<u2'"));
        assert!(!has(&archive, "local_error.npy"));
        let with_errors = SolutionFields { errors: counted.f.to_vec(), ..counted.clone() };
        assert!(has(&with_errors.npz().unwrap(), "local_error.npy"));
        assert_eq!(counted.npy().len(), 128 + 8 * 8);
    }
}
