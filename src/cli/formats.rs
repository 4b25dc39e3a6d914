//! Solutions as files: VTK image data for ParaView, NPY and NPZ for NumPy, SVG pictures.

use crate::discrete::grid::Grid;
use crate::figures::{Surface, surfaces, uphill};
use crate::pipeline::error::{Error, Result};
use crate::saddle::Pair;
use clap::ValueEnum;
use std::path::Path;

/// A kind of file, by its ending: VTK XML image data, one NumPy array, several, a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Vti,
    Npy,
    Npz,
    Svg,
}

impl Format {
    /// The format that the ending of `path` names.
    pub(super) fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        Self::from_str(ending, false).map_err(|_| {
            let path = path.display();
            Error::input(format!("--out {path}: unknown ending; use one of .vti, .npy, .npz, .svg"))
        })
    }
}

/// The picture of a solution on the square.
pub(super) fn picture(grid: Grid, pair: &Pair, name: &str) -> Result<Vec<u8>> {
    let azimuth = uphill(grid, &pair.y);
    let surface = Surface { title: name, grid, pair, azimuth, range: None };
    let drawn = surfaces(2, &[surface]).svg(name, "Made by `signorini solve`.");
    drawn.map(String::into_bytes).map_err(Error::input)
}
