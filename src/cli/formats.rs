//! Solutions as files: VTK image data for ParaView, NPY for NumPy, SVG for the eye.

use crate::discrete::cube;
use crate::discrete::grid::Grid;
use crate::figures::{Caption, Surface, View, surfaces};
use crate::pipeline::error::{Error, Result};
use crate::saddle::Pair;
use clap::ValueEnum;
use std::path::Path;

/// A kind of file, by its ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// VTK XML image data.
    Vti,
    /// A NumPy array.
    Npy,
    /// A picture.
    Svg,
}

impl Format {
    /// The format that the ending of `path` names.
    ///
    /// # Errors
    /// [`Error::Input`] with the known endings.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        Self::from_str(ending, false).map_err(|_| {
            let path = path.display();
            Error::input(format!("--out {path}: unknown ending; use one of .vti, .npy, .svg"))
        })
    }

    /// The bytes of a file with a solution on the square.
    ///
    /// # Errors
    /// [`Error::Input`] if the solution cannot be drawn.
    pub fn square(self, grid: Grid, pair: &Pair, name: &str) -> Result<Vec<u8>> {
        Ok(match self {
            Self::Npy => npy(&[grid.side(); 2], &pair.y),
            Self::Vti => vti([grid.cells(), grid.cells(), 0], grid.h(), &pair.y, name),
            Self::Svg => {
                let view = View::uphill(grid, &pair.y);
                let surface =
                    Surface { title: name, grid, y: &pair.y, a: &pair.a, view, range: None };
                let caption = Caption { title: name, description: "Made by `signorini solve`." };
                let svg = surfaces(caption, 2, &[surface]);
                svg.map_err(|e| Error::input(e.to_string()))?.into_bytes()
            }
        })
    }

    /// The same for a solution on the cube, of which there is no picture.
    ///
    /// # Errors
    /// [`Error::Input`] for [`Format::Svg`].
    pub fn cube(self, grid: cube::Grid, y: &[f64], name: &str) -> Result<Vec<u8>> {
        let n = grid.cells();
        match self {
            Self::Npy => Ok(npy(&[n + 1; 3], y)),
            Self::Vti => Ok(vti([n; 3], grid.h(), y, name)),
            Self::Svg => Err(Self::no_picture()),
        }
    }

    /// Why a solution on the cube is not drawn.
    pub fn no_picture() -> Error {
        Error::input(
            "--out: a solution on the cube has no picture; use .vti and open it in ParaView, or .npy",
        )
    }
}

/// NPY version 1.0: an array of little-endian doubles, the last index along x.
fn npy(shape: &[usize], y: &[f64]) -> Vec<u8> {
    let shape: Vec<_> = shape.iter().map(usize::to_string).collect();
    let shape = shape.join(", ");
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
    // The data must begin at a multiple of 64 bytes; magic, version and length take ten.
    header += &" ".repeat(63 - (10 + header.len()) % 64);
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(y.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// VTK XML image data with point data `v`, appended raw little-endian doubles.
///
/// Axes without cells are at 0, the others centred there.
fn vti(cells: [usize; 3], h: f64, y: &[f64], name: &str) -> Vec<u8> {
    let along = |of_axis: &dyn Fn(usize) -> String| cells.map(of_axis).join(" ");
    let extent = along(&|n| format!("0 {n}"));
    let origin = along(&|n| if n > 0 { "-0.5".into() } else { "0".into() });
    let spacing = along(&|n| if n > 0 { h.to_string() } else { "1".into() });
    let mut bytes = format!(
        "<?xml version=\"1.0\"?>\n<!-- {name}, solution v of the scalar Signorini problem -->\n\
        <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
        <ImageData WholeExtent=\"{extent}\" Origin=\"{origin}\" Spacing=\"{spacing}\">\n\
        <Piece Extent=\"{extent}\"><PointData Scalars=\"v\">\n\
        <DataArray type=\"Float64\" Name=\"v\" format=\"appended\" offset=\"0\"/>\n\
        </PointData></Piece></ImageData>\n<AppendedData encoding=\"raw\">\n_"
    )
    .into_bytes();
    bytes.extend((8 * y.len() as u64).to_le_bytes());
    bytes.extend(y.iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn npy_header_is_aligned_and_data_follow() {
        let y: Vec<f64> = (0..9).map(f64::from).collect();
        let bytes = npy(&[3, 3], &y);
        let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!((header % 64, bytes[header - 1], bytes.len()), (0, b'\n', header + 72));
        assert_eq!(bytes[header + 8..header + 16], 1f64.to_le_bytes());
    }

    #[test]
    fn unknown_endings_are_refused() {
        assert_eq!(Format::of(Path::new("v.vti")).unwrap(), Format::Vti);
        assert!(Format::of(Path::new("v.doc")).unwrap_err().to_string().contains(".npy"));
        assert!(Format::of(Path::new("v")).is_err());
    }
}
