//! Files that `solve --out` writes.

use super::points;
use crate::cli::output::OutputFile;
use crate::figures::{DrawnSolution, Print, SolutionMap, map_of_f, surfaces};
use crate::pipeline::error::{Error, Result};
use clap::ValueEnum;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::PointValue;
use signorini_mathematics::saddle::Pair;
use std::path::Path;

/// Format of a file, by its ending: VTK image data or, on a mesh, an unstructured grid for ParaView, one NumPy array,
/// several arrays, a picture, values at points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Vti,
    Vtu,
    Npy,
    Npz,
    Svg,
    Csv,
}

/// Solution to be written.
pub(super) struct Solution<'a> {
    /// Problem on whose finest level this is the solution.
    pub problem: &'a Problem,
    /// Name of the problem, for files of data.
    pub name: &'a str,
    /// Title of a picture.
    pub title: &'a str,
    /// Kind of a picture.
    pub view: PictureKind,
    /// Form of a picture in print.
    pub print: &'a Print,
    /// Nodal values and multipliers.
    pub pair: &'a Pair,
    /// Values at the points that are asked for.
    pub values: &'a [PointValue],
}

/// Kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureKind {
    Map,
    Surface,
    Mesh,
}

/// Panels of a row for which a picture has room.
const COLUMNS: usize = 2;

impl Format {
    /// Returns the format that the ending of `path` names, in small letters or capitals.
    pub(super) fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        Self::from_str(ending, true).map_err(|_| {
            let path = path.display();
            let known = Self::value_variants().iter().map(|format| format!(".{}", format.ending()));
            let known = known.collect::<Vec<_>>().join(", ");
            Error::input(format!("--out {path}: unknown ending; use one of {known}"))
        })
    }

    /// Refuses a format in which a solution has no files.
    pub(super) fn check(self, problem: &Problem, has_points: bool) -> Result<()> {
        let vtk = problem.vtk_ending();
        let reason = match self {
            Self::Svg if problem.levels().facts().dimension == 3 => format!(
                "a solution in space has no picture; use .{vtk} and open it in ParaView, or .npz"
            ),
            Self::Vti | Self::Vtu if self.ending() != vtk => {
                format!("this solution is written as .{vtk}, .npz or .npy")
            }
            Self::Csv if !has_points => {
                "a .csv file has v at points; add --at or --line, or use .npz".into()
            }
            _ => return Ok(()),
        };
        Err(Error::input(format!("--out: {reason}")))
    }

    fn ending(self) -> &'static str {
        match self {
            Self::Vti => "vti",
            Self::Vtu => "vtu",
            Self::Npy => "npy",
            Self::Npz => "npz",
            Self::Svg => "svg",
            Self::Csv => "csv",
        }
    }
}

impl Solution<'_> {
    /// Writes a file.
    pub(super) fn write(&self, file: &OutputFile, format: Format) -> Result<()> {
        let Self { problem, name, title, view, print, pair, values } = *self;
        let drawn_title = if print.title { title } else { "" };
        let bytes = match format {
            Format::Npy => problem.npy(pair),
            Format::Npz => problem.npz(pair).ok_or_else(|| {
                let vtk = problem.vtk_ending();
                Error::input(format!("--out: an .npz file holds at most 4 GB; use .npy or .{vtk}"))
            })?,
            Format::Vti | Format::Vtu => problem.vtk(pair, name),
            Format::Csv => points::csv(values),
            Format::Svg => {
                let picture = match view {
                    PictureKind::Mesh => map_of_f(drawn_title, problem),
                    PictureKind::Map => {
                        SolutionMap::of(drawn_title.into(), problem, pair).map(|map| map.picture())
                    }
                    PictureKind::Surface => {
                        DrawnSolution::of(drawn_title.into(), problem, pair, COLUMNS)
                            .map(|drawn| surfaces(COLUMNS, &[drawn]))
                    }
                };
                let mut picture = picture.map_err(Error::input)?;
                picture.print.clone_from(&print.width);
                let svg = picture.svg(title, "Made by `signorini solve`.");
                svg.map_err(Error::input)?.into_bytes()
            }
        };
        file.write(&bytes)
    }
}
