//! Formats of the files that `solve --out` writes.

use crate::pipeline::error::{Error, Result};
use clap::ValueEnum;
use signorini_mathematics::problem::law::Law;
use std::path::Path;

/// Name and law of a problem, in files.
#[derive(Clone, Copy)]
pub(super) struct ReportedAs<'a> {
    pub name: &'a str,
    pub law: Law,
}

/// Format of a file, by its ending: VTK image data or, on a mesh, an unstructured grid for ParaView, one NumPy array,
/// several arrays, a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Vti,
    Vtu,
    Npy,
    Npz,
    Svg,
}

impl Format {
    /// Returns the format that the ending of `path` names, in small letters or capitals.
    pub(super) fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        Self::from_str(ending, true).map_err(|_| {
            let path = path.display();
            Error::input(format!(
                "--out {path}: unknown ending; use one of .vti, .vtu, .npy, .npz, .svg"
            ))
        })
    }
}
