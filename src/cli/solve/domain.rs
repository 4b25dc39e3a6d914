//! Square and cube under one interface: load vector, judgement, errors, files.

use crate::figures::{Surface, surfaces, uphill};
use crate::pipeline::error::{Error, Result};
use crate::replication::scene::{MAX_CELLS, solvable};
use clap::ValueEnum;
use signorini_mathematics::bounds::{Bounds, bounds, recovery};
use signorini_mathematics::discrete::contact::{ContactArc, arcs};
use signorini_mathematics::discrete::cube;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::{Judgement, judge};
use signorini_mathematics::discrete::load::{self, LoadRule, load};
use signorini_mathematics::discrete::norms::{Errors, errors, multiplier_error};
use signorini_mathematics::discrete::transfer::prolong_boundary;
use signorini_mathematics::formats::Fields;
use signorini_mathematics::problem;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::solvers::{SOLVERS, Solver};
use std::path::Path;

/// Square or cube, with f and its quadrature.
pub(super) enum Domain {
    Square { f: Source, rule: LoadRule },
    Cube { f: problem::cube::Source },
}

/// Errors against a known solution.
pub(super) struct KnownErrors {
    pub values: Errors,
    /// Error of the multiplier in L2, on the square.
    pub multiplier_l2: Option<f64>,
}

impl Domain {
    /// Largest number of cells per side for which the vectors and factors of the solver take about 1 GB; refuses a
    /// solver that the domain does not have.
    pub(super) fn most_cells(&self, solver: Solver) -> Result<usize> {
        match self {
            Self::Square { .. } => Ok(solver.entry().most_on_square.unwrap_or(MAX_CELLS)),
            Self::Cube { .. } => solver.entry().most_on_cube.ok_or_else(|| {
                let on_cube = SOLVERS.iter().rev().filter(|entry| entry.most_on_cube.is_some());
                let names: Vec<_> = on_cube.map(|entry| entry.name).collect();
                Error::input(format!(
                    "--solver {solver}: the cube has only {}",
                    names.join(" and ")
                ))
            }),
        }
    }

    pub(super) fn dimension(&self) -> u8 {
        match self {
            Self::Square { .. } => 2,
            Self::Cube { .. } => 3,
        }
    }

    pub(super) fn f(&self) -> String {
        match self {
            Self::Square { f, .. } => f.to_string(),
            Self::Cube { f } => f.to_string(),
        }
    }

    /// Returns the pieces of f outside the domain, which change nothing.
    pub(super) fn outside(&self) -> Vec<String> {
        match self {
            Self::Square { f, .. } => f.outside(),
            Self::Cube { f } => f.outside(),
        }
    }

    /// Returns the integrals of f and of |f|.
    pub(super) fn integrals(&self) -> [f64; 2] {
        match self {
            Self::Square { f, .. } => [load::integral(f), load::integral(&f.absolute())],
            Self::Cube { f } => [cube::integral(f), cube::integral(&f.absolute())],
        }
    }

    /// Returns the integral of f if the problem is solvable.
    pub(super) fn solvable(&self) -> Result<f64> {
        match self {
            Self::Square { f, .. } => solvable(f, self.integrals()),
            Self::Cube { f } => solvable(f, self.integrals()),
        }
    }

    /// Returns the difference of forces that the grid explains: h^2 times the integral of |f|.
    pub(super) fn slack(&self, n: usize) -> f64 {
        self.integrals()[1].abs() / n as f64 / n as f64
    }

    /// Returns the difference between the sum of a load vector and the integral of f that the grid explains; `None` for
    /// smooth f, for which quadrature has an error of its own.
    pub(super) fn load_slack(&self, n: usize) -> Option<f64> {
        let smooth = match self {
            Self::Square { f, .. } => f.exact().is_some(),
            Self::Cube { f } => f.exact().is_some(),
        };
        (!smooth).then(|| self.slack(n))
    }

    pub(super) fn load(&self, n: usize) -> Vec<f64> {
        match self {
            Self::Square { f, rule } => load(square(n), f, *rule),
            Self::Cube { f } => cube::exact_load(cube(n), f),
        }
    }

    /// Judges a nodal vector, apart from the solvers.
    pub(super) fn judge(&self, n: usize, y: &[f64], load: &[f64]) -> Judgement {
        match self {
            Self::Square { .. } => judge(square(n), y, load),
            Self::Cube { .. } => cube::judge(cube(n), y, load),
        }
    }

    /// Returns the positions of the boundary nodes in a nodal vector; on the square in the order of a multiplier.
    pub(super) fn boundary(&self, n: usize) -> Vec<usize> {
        self.boundary_parts(n).into_iter().map(|(node, _)| node).collect()
    }

    /// Returns the [boundary](Self::boundary) nodes, each with the measure of its part of the boundary.
    pub(super) fn boundary_parts(&self, n: usize) -> Vec<(usize, f64)> {
        match self {
            Self::Square { .. } => square(n).boundary().map(|node| (node, square(n).h())).collect(),
            Self::Cube { .. } => cube(n).boundary_shares().collect(),
        }
    }

    /// Returns the errors, if the solution has a formula.
    pub(super) fn errors(&self, n: usize, y: &[f64], load: &[f64]) -> Option<KnownErrors> {
        match self {
            Self::Square { f, .. } => {
                let (grid, exact) = (square(n), f.exact()?);
                let multiplier_l2 = multiplier_error(grid, y, load, |point, normal| {
                    exact.multiplier(point, normal)
                });
                let values = errors(grid, exact, y);
                Some(KnownErrors { values, multiplier_l2: Some(multiplier_l2) })
            }
            Self::Cube { f } => {
                let values = cube::errors(cube(n), f.exact()?, y);
                Some(KnownErrors { values, multiplier_l2: None })
            }
        }
    }

    /// Returns the arcs in contact, for a nodal vector and its judgement; `None` on the cube, whose contact set consists
    /// of faces.
    pub(super) fn contact(
        &self,
        n: usize,
        y: &[f64],
        judged: &Judgement,
    ) -> Option<Vec<ContactArc>> {
        match self {
            Self::Square { .. } => Some(arcs(square(n), y, judged)),
            Self::Cube { .. } => None,
        }
    }

    pub(super) fn bounds(&self, n: usize, y: &[f64]) -> std::result::Result<Bounds, String> {
        match self {
            Self::Square { f, .. } => bounds(square(n), f, y).map_err(|reason| reason.to_string()),
            Self::Cube { .. } => Err("bounds are made for the square only".into()),
        }
    }

    /// Returns the recovered solution, on the grid of half the width.
    pub(super) fn recovered(&self, n: usize, pair: &Pair) -> Result<Pair> {
        let Self::Square { f, .. } = self else {
            return Err(Error::input("--recover is for the square; leave it out"));
        };
        let (y, _) = recovery(square(n), f, &pair.y)
            .map_err(|reason| Error::input(format!("--recover: {reason}; leave it out")))?;
        Ok(Pair { y, a: prolong_boundary(&pair.a) })
    }

    /// Returns the bytes of a file with the solution; the caller refuses a picture of the cube.
    pub(super) fn file(&self, kind: Format, n: usize, pair: &Pair, name: &str) -> Result<Vec<u8>> {
        let fields = match self {
            Self::Square { f, .. } => Fields::square(square(n), f, pair),
            Self::Cube { f } => Fields::new(3, n, |at| f.at(at), self.boundary(n), pair),
        };
        match kind {
            Format::Npy => Ok(fields.npy()),
            Format::Npz => fields.npz().ok_or_else(|| {
                Error::input("--out: an .npz file holds at most 4 GB; use .npy or .vti")
            }),
            Format::Vti => Ok(fields.vti(name)),
            Format::Svg => {
                let (grid, azimuth) = (square(n), uphill(square(n), &pair.y));
                let (y, in_contact) = (&pair.y, &pair.in_contact(grid));
                let surface = Surface { title: name, grid, y, in_contact, azimuth, range: None };
                let drawn = surfaces(2, &[surface]).svg(name, "Made by `signorini solve`.");
                drawn.map(String::into_bytes).map_err(Error::input)
            }
        }
    }
}

/// Format of a file, by its ending: VTK image data for ParaView, one NumPy array, several arrays, a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Vti,
    Npy,
    Npz,
    Svg,
}

impl Format {
    /// Returns the format that the ending of `path` names.
    pub(super) fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        Self::from_str(ending, false).map_err(|_| {
            let path = path.display();
            Error::input(format!("--out {path}: unknown ending; use one of .vti, .npy, .npz, .svg"))
        })
    }
}

pub(super) fn square(n: usize) -> Grid {
    Grid::new(n).expect("validated with the hierarchy")
}

fn cube(n: usize) -> cube::Grid {
    cube::Grid::new(n).expect("validated with the hierarchy")
}
