//! Files that `solve --out` writes.

use crate::figures::{DrawnSolution, surfaces};
use crate::pipeline::error::{Error, Result};
use clap::ValueEnum;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::formats::{Fields, MeshFields};
use signorini_mathematics::levels::{Lattices, Problem};
use signorini_mathematics::saddle::Pair;
use std::path::Path;

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

/// Solution to be written.
pub(super) struct Solution<'a> {
    /// Problem that it solves.
    pub problem: &'a Problem,
    /// Name of the problem.
    pub name: &'a str,
    /// Nodal values and multipliers.
    pub pair: &'a Pair,
    /// Grid of the pair on the square, if that is not the finest one of the problem.
    pub grid: Option<Grid>,
}

/// Panels of a row for which a picture has room.
const COLUMNS: usize = 2;

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

    /// Refuses a format in which the domain of a problem has no files.
    pub(super) fn check(self, problem: &Problem) -> Result<()> {
        let on_grid = problem.lattices().is_some();
        let reason = match self {
            Self::Svg if problem.levels().dimension() == 3 => {
                "a solution in space has no picture; use .vtu and open it in ParaView, or .npz"
            }
            Self::Vti if !on_grid => "a solution on a mesh is written as .vtu, .npz or .npy",
            Self::Vtu if on_grid => "a solution on a grid is written as .vti, .npz or .npy",
            Self::Vti | Self::Vtu | Self::Npy | Self::Npz | Self::Svg => return Ok(()),
        };
        Err(Error::input(format!("--out: {reason}")))
    }
}

impl Solution<'_> {
    /// Returns the bytes of a file.
    pub(super) fn file(&self, format: Format) -> Result<Vec<u8>> {
        let bytes = match self.problem.lattices() {
            Some(lattices) => self.on_grid(lattices, format)?,
            None => self.on_mesh(format)?,
        };
        bytes.ok_or_else(|| {
            let other = if self.problem.lattices().is_some() { ".vti" } else { ".vtu" };
            Error::input(format!("--out: an .npz file holds at most 4 GB; use .npy or {other}"))
        })
    }

    fn on_grid(&self, lattices: &Lattices, format: Format) -> Result<Option<Vec<u8>>> {
        let grid = self.grid.unwrap_or(lattices.finest());
        let fields = Fields::new(grid, lattices.source(), self.pair);
        Ok(match format {
            Format::Npy => Some(fields.npy()),
            Format::Npz => fields.npz(),
            Format::Vti | Format::Vtu => Some(fields.vti(self.name)),
            Format::Svg => {
                let (title, law) = (self.name.to_owned(), self.problem.law());
                let drawn = DrawnSolution::on_grid(title, (grid, law), self.pair, COLUMNS);
                Some(self.svg(&surfaces(COLUMNS, &[drawn.panel(drawn.azimuth(), None)]))?)
            }
        })
    }

    fn on_mesh(&self, format: Format) -> Result<Option<Vec<u8>>> {
        let Self { problem, name, pair, .. } = self;
        if format == Format::Svg {
            let drawn = DrawnSolution::of((*name).to_owned(), problem, pair, COLUMNS);
            let drawn = drawn.map_err(Error::input)?;
            let picture = surfaces(COLUMNS, &[drawn.panel(drawn.azimuth(), None)]);
            return Ok(Some(self.svg(&picture)?));
        }
        let level = problem.finest();
        let (mesh, multiplier) = (problem.levels().mesh(level), problem.at_nodes(&pair.a, 0.0));
        let f = problem.levels().means(level).map_err(|e| Error::input(e.to_string()))?;
        let fields = MeshFields { mesh: &mesh, v: &pair.y, multiplier: &multiplier, f: &f };
        Ok(match format {
            Format::Npy => Some(fields.npy()),
            Format::Npz => fields.npz(),
            _ => Some(fields.vtu(name)),
        })
    }

    fn svg(&self, picture: &crate::figures::Picture) -> Result<Vec<u8>> {
        let drawn = picture.svg(self.name, "Made by `signorini solve`.");
        drawn.map(String::into_bytes).map_err(Error::input)
    }
}
