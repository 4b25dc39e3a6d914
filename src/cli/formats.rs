//! Solutions as files: VTK image data for ParaView, NPY for NumPy, SVG for the eye.

use crate::discrete::cube;
use crate::discrete::grid::Grid;
use crate::figures::{Caption, Surface, View, surfaces};
use crate::pipeline::error::{Error, Result};
use crate::saddle::Pair;
use std::path::Path;

/// Endings of the files that can be written.
pub const ENDINGS: [&str; 3] = ["vti", "npy", "svg"];

/// Checks that the ending of `path` names a format, before anything is computed.
///
/// # Errors
/// [`Error::Input`] with the known endings.
pub fn check_ending(path: &Path) -> Result<&str> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if ENDINGS.contains(&ending) {
        return Ok(ending);
    }
    Err(Error::input(format!(
        "--out {}: unknown ending; use one of .{}",
        path.display(),
        ENDINGS.join(", .")
    )))
}

/// The bytes of a file with the solution, in the format of the path's ending.
///
/// # Errors
/// [`Error::Input`] if the ending is unknown or the solution cannot be drawn.
pub fn write(path: &Path, grid: Grid, pair: &Pair, name: &str) -> Result<Vec<u8>> {
    Ok(match check_ending(path)? {
        "npy" => npy(grid, &pair.y),
        "vti" => vti(grid, &pair.y, name),
        _ => {
            let view = View::uphill(grid, &pair.y);
            let surface = Surface { title: name, grid, y: &pair.y, a: &pair.a, view, range: None };
            let caption = Caption { title: name, description: "Made by `signorini solve`." };
            let svg = surfaces(caption, 2, &[surface]);
            svg.map_err(|e| Error::input(e.to_string()))?.into_bytes()
        }
    })
}

/// The same for a solution on the cube, which has no picture.
///
/// # Errors
/// [`Error::Input`] if the ending is unknown or means a picture.
pub fn write_cube(path: &Path, grid: cube::Grid, y: &[f64], name: &str) -> Result<Vec<u8>> {
    let n = grid.cells();
    Ok(match check_cube_ending(path)? {
        "npy" => npy_array(&[n + 1; 3], y),
        _ => image([n, n, n], grid.h(), y, name),
    })
}

/// Checks that the ending of `path` names a format for solutions on the cube.
///
/// # Errors
/// [`Error::Input`] with what to use instead.
pub fn check_cube_ending(path: &Path) -> Result<&str> {
    match check_ending(path)? {
        "svg" => Err(Error::input(format!(
            "--out {}: a solution on the cube has no picture; use .vti and open it in ParaView, or .npy",
            path.display()
        ))),
        ending => Ok(ending),
    }
}

/// NPY version 1.0: an array of shape (n + 1, n + 1), first index y, second x, little-endian doubles.
pub fn npy(grid: Grid, y: &[f64]) -> Vec<u8> {
    npy_array(&[grid.side(); 2], y)
}

fn npy_array(shape: &[usize], y: &[f64]) -> Vec<u8> {
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
pub fn vti(grid: Grid, y: &[f64], name: &str) -> Vec<u8> {
    let n = grid.cells();
    image([n, n, 0], grid.h(), y, name)
}

/// Axes without cells are at 0, the others centred there.
fn image(cells: [usize; 3], h: f64, y: &[f64], name: &str) -> Vec<u8> {
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
        let grid = Grid::new(2).unwrap();
        let y: Vec<f64> = (0..9).map(f64::from).collect();
        let bytes = npy(grid, &y);
        let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!((header % 64, bytes[header - 1], bytes.len()), (0, b'\n', header + 72));
        assert_eq!(bytes[header + 8..header + 16], 1f64.to_le_bytes());
    }

    #[test]
    fn unknown_endings_are_refused() {
        assert!(check_ending(Path::new("v.vti")).is_ok());
        assert!(check_ending(Path::new("v.doc")).unwrap_err().to_string().contains(".npy"));
        assert!(check_ending(Path::new("v")).is_err());
    }
}
