//! Solutions on the square and the cube.

use super::npy::{DOUBLE, doubles, npy};
use super::vtk::Appended;
use super::zip;
use crate::discrete::grid::Grid;
use crate::problem::source::Source;
use crate::saddle::Pair;

/// A solution on the square or the cube, x running fastest in every array.
pub struct Fields<'a> {
    /// Cells along x, y and z; none along an axis that is not there.
    cells: [usize; 3],
    f: Box<dyn Fn([f64; 3]) -> f64 + 'a>,
    boundary: Vec<usize>,
    pair: &'a Pair,
}

impl<'a> Fields<'a> {
    /// A solution on the square or, if `dimension` is 3, the cube with `n` cells per side: v, and its multiplier at
    /// the nodes `boundary`.
    pub fn new(
        dimension: u32,
        n: usize,
        f: impl Fn([f64; 3]) -> f64 + 'a,
        boundary: Vec<usize>,
        pair: &'a Pair,
    ) -> Self {
        let cells = [n, n, if dimension == 3 { n } else { 0 }];
        Self { cells, f: Box::new(f), boundary, pair }
    }

    /// A solution on the square, with its multiplier at the boundary nodes.
    pub fn square(grid: Grid, f: &'a Source, pair: &'a Pair) -> Self {
        let boundary = grid.boundary().collect();
        Self::new(2, grid.cells(), |[x, y, _]| f.at([x, y]), boundary, pair)
    }

    fn h(&self) -> f64 {
        1.0 / self.cells[0] as f64
    }

    /// The multiplier dv/dn at the nodes, zero inside.
    fn multiplier(&self) -> Vec<f64> {
        let mut multiplier = vec![0.0; self.pair.y.len()];
        self.boundary.iter().zip(&self.pair.a).for_each(|(&node, a)| multiplier[node] = *a);
        multiplier
    }

    /// f in the middle of each cell.
    fn f(&self) -> Vec<f64> {
        let (n, h) = (self.cells[0], self.h());
        let middle = |k: usize| [k % n, k / n % n, k / (n * n)].map(|k| (k as f64 + 0.5) * h - 0.5);
        let cells = self.shape(0).iter().product();
        (0..cells).map(|k| (self.f)(middle(k))).collect()
    }

    /// Lengths of an array with `more` entries than cells along each axis, the one along x last.
    fn shape(&self, more: usize) -> Vec<usize> {
        self.cells.iter().rev().filter(|n| **n > 0).map(|n| n + more).collect()
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
    ///
    /// Axes without cells are at 0, the others centred there.
    pub fn vti(&self, name: &str) -> Vec<u8> {
        let along = |of_axis: &dyn Fn(usize) -> String| self.cells.map(of_axis).join(" ");
        let extent = along(&|n| format!("0 {n}"));
        let origin = along(&|n| if n > 0 { "-0.5".into() } else { "0".into() });
        let spacing = along(&|n| if n > 0 { self.h().to_string() } else { "1".into() });
        let mut arrays = Appended::default();
        let v = arrays.array("type=\"Float64\" Name=\"v\"", doubles(&self.pair.y));
        let multiplier =
            arrays.array("type=\"Float64\" Name=\"multiplier\"", doubles(&self.multiplier()));
        let f = arrays.array("type=\"Float64\" Name=\"f\"", doubles(&self.f()));
        let body = format!(
            "<ImageData WholeExtent=\"{extent}\" Origin=\"{origin}\" Spacing=\"{spacing}\">\n\
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
        let fields = Fields::square(grid, &f, &pair);
        assert_eq!(fields.f(), [3.0, -2.0, -2.0, -2.0]);
        // Row by row, where the boundary runs anticlockwise.
        assert_eq!(fields.multiplier(), [1.0, 2.0, 3.0, 8.0, 0.0, 4.0, 7.0, 6.0, 5.0]);
        let archive = fields.npz().unwrap();
        assert!(archive.starts_with(b"PK\x03\x04") && archive.len() > 25 * 8 + 3 * 128);
    }
}
