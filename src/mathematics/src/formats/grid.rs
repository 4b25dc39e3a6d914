//! Solutions on the square.

use super::npy::{DOUBLE, doubles, npy};
use super::vtk::Appended;
use super::zip;
use crate::discrete::grid::Grid;
use crate::problem::source::Source;
use crate::saddle::Pair;

/// A solution on the square, x running fastest in every array.
pub struct Fields<'a> {
    grid: Grid,
    f: &'a Source,
    pair: &'a Pair,
}

impl<'a> Fields<'a> {
    /// A solution on the square: v, and its multiplier at the boundary nodes.
    pub fn new(grid: Grid, f: &'a Source, pair: &'a Pair) -> Self {
        Self { grid, f, pair }
    }

    /// The multiplier dv/dn at the nodes, zero inside.
    fn multiplier(&self) -> Vec<f64> {
        let mut multiplier = vec![0.0; self.pair.y.len()];
        self.grid.boundary().zip(&self.pair.a).for_each(|(node, a)| multiplier[node] = *a);
        multiplier
    }

    /// f in the middle of each cell.
    fn f(&self) -> Vec<f64> {
        let (n, h) = (self.grid.cells(), self.grid.h());
        let middle = |k: usize| [k % n, k / n].map(|k| (k as f64 + 0.5) * h - 0.5);
        (0..n * n).map(|k| self.f.at(middle(k))).collect()
    }

    /// Lengths of an array with `more` entries than cells along each axis.
    fn shape(&self, more: usize) -> [usize; 2] {
        [self.grid.cells() + more; 2]
    }

    /// v alone, in NPY format.
    pub fn npy(&self) -> Vec<u8> {
        npy(DOUBLE, &self.shape(1), doubles(&self.pair.y))
    }

    /// `v`, `multiplier` and `f` in NPZ format: NPY files in an archive that is not compressed.
    ///
    /// None if they do not fit into the four gigabytes that such an archive may have.
    pub fn npz(&self) -> Option<Vec<u8>> {
        let numbers: usize = [1, 1, 0].map(|more| self.shape(more).iter().product()).iter().sum();
        zip::fits(numbers).then(|| {
            zip::zip(&[
                ("v.npy", self.npy()),
                ("multiplier.npy", npy(DOUBLE, &self.shape(1), doubles(&self.multiplier()))),
                ("f.npy", npy(DOUBLE, &self.shape(0), doubles(&self.f()))),
            ])
        })
    }

    /// VTK XML image data: points with `v` and `multiplier`, cells with `f`; raw little-endian doubles.
    pub fn vti(&self, name: &str) -> Vec<u8> {
        let (n, h) = (self.grid.cells(), self.grid.h());
        let extent = format!("0 {n} 0 {n} 0 0");
        let mut arrays = Appended::default();
        let v = arrays.array("type=\"Float64\" Name=\"v\"", doubles(&self.pair.y));
        let multiplier =
            arrays.array("type=\"Float64\" Name=\"multiplier\"", doubles(&self.multiplier()));
        let f = arrays.array("type=\"Float64\" Name=\"f\"", doubles(&self.f()));
        let body = format!(
            "<ImageData WholeExtent=\"{extent}\" Origin=\"-0.5 -0.5 0\" Spacing=\"{h} {h} 1\">\n\
            <Piece Extent=\"{extent}\"><PointData Scalars=\"v\">\n{v}{multiplier}\
            </PointData><CellData Scalars=\"f\">\n{f}\
            </CellData></Piece></ImageData>\n"
        );
        arrays.file("ImageData", name, &body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_multiplier_is_at_the_boundary_and_f_in_the_cells() {
        let grid = Grid::new(2).unwrap();
        let f: Source = "quadrant(ll)=3; else=-2".parse().unwrap();
        let pair = Pair { y: vec![1.0; 9], a: (1..=8).map(f64::from).collect() };
        let fields = Fields::new(grid, &f, &pair);
        assert_eq!(fields.f(), [3.0, -2.0, -2.0, -2.0]);
        // Row by row, where the boundary runs anticlockwise.
        assert_eq!(fields.multiplier(), [1.0, 2.0, 3.0, 8.0, 0.0, 4.0, 7.0, 6.0, 5.0]);
        let archive = fields.npz().unwrap();
        assert!(archive.starts_with(b"PK\x03\x04") && archive.len() > 25 * 8 + 3 * 128);
    }
}
