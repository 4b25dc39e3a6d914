//! Square, cube and meshes under one interface: load vector, judgement, errors, files.

use super::format::{Format, ReportedAs};
use super::mesh::MeshDomain;
use super::reserve::Reserve;
use crate::figures::{Surface, surfaces, uphill};
use crate::pipeline::error::{Error, Result};
use crate::replication::scene::{BoundaryFlux, MAX_CELLS, solvable};
use signorini_mathematics::bounds::triangulation::{CubeBounds, bounds_on_cube};
use signorini_mathematics::bounds::{Bounds, bounds, recovery};
use signorini_mathematics::discrete::contact::{ContactArc, arcs};
use signorini_mathematics::discrete::cube;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::{Judgement, judge};
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::discrete::norms::{Errors, errors, multiplier_error};
use signorini_mathematics::discrete::transfer::prolong_boundary;
use signorini_mathematics::formats::Fields;
use signorini_mathematics::problem;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::solvers::{SOLVERS, Solver};
use signorini_mathematics::triangulated::MeshProblem;
use std::borrow::Cow;

/// Square, cube or mesh, with f and its quadrature.
///
/// The number of a grid is that of its cells per side, on a mesh that of its refinements.
pub(super) enum Domain {
    Square { f: Source, rule: LoadRule, integrals: [f64; 2] },
    Cube { f: problem::cube::Source, integrals: [f64; 2] },
    Mesh(Box<MeshDomain>),
}

/// Errors against a known solution.
pub(super) struct KnownErrors {
    pub values: Errors,
    /// Error of the multiplier in L2, on the square.
    pub multiplier_l2: Option<f64>,
}

/// Bounds of the error and the energy.
pub(super) struct Guarantee {
    pub bounds: Bounds,
    /// Approximations that the bounds leave out.
    pub reserve: Vec<Reserve>,
}

/// Error of the sum of the load vector of a formula, over the integral of |f|, that gets no warning on any grid.
const RESOLVED: f64 = 1e-2;
/// Cells per side of the finest grid of the cube with bounds: about a second.
const MOST_WITH_BOUNDS: usize = 32;

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
            Self::Mesh(mesh) if solver == Solver::Spectral => Err(Error::input(format!(
                "--solver {solver}: {} has every solver but this one",
                mesh.name
            ))),
            Self::Mesh(_) => Ok(usize::MAX),
        }
    }

    /// Returns the name of a grid in sentences.
    pub(super) fn grid(&self, n: usize) -> String {
        match self {
            Self::Square { .. } | Self::Cube { .. } => format!("grid 1/{n}"),
            Self::Mesh(_) if n == 0 => "the coarsest mesh".into(),
            Self::Mesh(_) => format!("refinement {n}"),
        }
    }

    /// Returns the name of a grid in a table.
    pub(super) fn row(&self, n: usize) -> String {
        match self {
            Self::Square { .. } | Self::Cube { .. } => format!("1/{n}"),
            Self::Mesh(mesh) => mesh.problem.levels[n].network.nodes().to_string(),
        }
    }

    /// Returns the width of a grid; of a mesh, the longest edge of the finest one.
    pub(super) fn h(&self, n: usize) -> f64 {
        match self {
            Self::Square { .. } | Self::Cube { .. } => 1.0 / n as f64,
            Self::Mesh(mesh) => mesh.width,
        }
    }

    pub(super) fn dimension(&self) -> u8 {
        match self {
            Self::Square { .. } => 2,
            Self::Cube { .. } => 3,
            Self::Mesh(mesh) => mesh.problem.mesh.dimension(),
        }
    }

    pub(super) fn f(&self) -> String {
        match self {
            Self::Square { f, .. } => f.to_string(),
            Self::Cube { f, .. } => f.to_string(),
            Self::Mesh(mesh) => mesh.problem.text.clone(),
        }
    }

    /// Returns the pieces of f outside the domain, which change nothing.
    pub(super) fn outside(&self) -> Vec<String> {
        match self {
            Self::Square { f, .. } => f.outside(),
            Self::Cube { f, .. } => f.outside(),
            Self::Mesh(_) => Vec::new(),
        }
    }

    /// Returns the integrals of f and of |f|.
    pub(super) fn integrals(&self) -> [f64; 2] {
        match self {
            Self::Square { integrals, .. } | Self::Cube { integrals, .. } => *integrals,
            Self::Mesh(mesh) => [mesh.problem.f.integral, mesh.problem.f.size],
        }
    }

    /// Returns the integral of f if the problem is solvable.
    pub(super) fn solvable(&self, law: Law) -> Result<f64> {
        match self {
            Self::Square { f, .. } => {
                solvable(f, self.integrals(), BoundaryFlux { law, perimeter: Grid::PERIMETER })
            }
            Self::Cube { f, .. } => solvable(
                f,
                self.integrals(),
                BoundaryFlux { law, perimeter: cube::Grid::PERIMETER },
            ),
            // Judged when the problem was made.
            Self::Mesh(mesh) => Ok(mesh.problem.f.integral),
        }
    }

    /// Returns the difference of forces that the grid explains: the square of h over the size of the domain, times the
    /// integral of |f|.
    pub(super) fn slack(&self, n: usize) -> f64 {
        let size = match self {
            Self::Square { .. } | Self::Cube { .. } => 1.0,
            Self::Mesh(mesh) => mesh.problem.mesh.extent(),
        };
        self.integrals()[1].abs() * (self.h(n) / size).powi(2)
    }

    /// Returns the difference between the sum of a load vector and the integral of f that the grid explains; `None` for
    /// known solutions, and on meshes, where the integral is the sum of the load vector.
    pub(super) fn load_slack(&self, n: usize) -> Option<f64> {
        let is_known = match self {
            Self::Square { f, .. } => f.exact().is_some(),
            Self::Cube { f, .. } => f.exact().is_some(),
            Self::Mesh(_) => return None,
        };
        // Values at the nodes of a smooth f are off by some multiple of h^2, the others by less.
        let slack = if self.is_smooth() {
            (4.0 * self.slack(n)).max(RESOLVED * self.integrals()[1])
        } else {
            self.slack(n)
        };
        (!is_known).then_some(slack)
    }

    /// Returns the load vector of a grid; of a mesh, that of the finest one.
    pub(super) fn load(&self, n: usize) -> Cow<'_, [f64]> {
        match self {
            Self::Square { f, rule, .. } => load(square(n), f, *rule).into(),
            Self::Cube { f, .. } => cube::exact_load(cube(n), f).into(),
            Self::Mesh(mesh) => Cow::from(&mesh.problem.f.load),
        }
    }

    /// Judges a nodal vector, apart from the solvers.
    pub(super) fn judge(&self, n: usize, law: Law, y: &[f64], load: &[f64]) -> Judgement {
        match self {
            Self::Square { .. } => judge(square(n), law, y, load),
            Self::Cube { .. } => cube::judge(cube(n), law, y, load),
            Self::Mesh(mesh) => judge(&mesh.problem.levels[n].network, law, y, load),
        }
    }

    /// True if the discrete problem with this sum of its load vector has a solution: a part of the boundary is fixed, or
    /// the flux through a boundary of this `perimeter` can balance the load.
    pub(super) fn has_solution(
        &self,
        sum_load: f64,
        BoundaryFlux { law, perimeter }: BoundaryFlux,
    ) -> bool {
        self.has_fixed_part() || law.check_solvable(sum_load, perimeter).is_ok()
    }

    /// True if v = 0 on a part of the boundary.
    pub(super) fn has_fixed_part(&self) -> bool {
        matches!(self, Self::Mesh(mesh) if !mesh.problem.network().fixed().is_empty())
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
            Self::Cube { f, .. } => {
                let values = cube::errors(cube(n), f.exact()?, y);
                Some(KnownErrors { values, multiplier_l2: None })
            }
            Self::Mesh(_) => None,
        }
    }

    /// Returns the arcs in contact, for a nodal vector and its judgement; `None` in space, where the contact set is part of
    /// a surface.
    pub(super) fn contact(
        &self,
        n: usize,
        y: &[f64],
        judged: &Judgement,
    ) -> Option<Vec<ContactArc>> {
        match self {
            Self::Square { .. } => Some(arcs(square(n), y, judged)),
            Self::Cube { .. } => None,
            Self::Mesh(mesh) => mesh.problem.arcs(y, judged),
        }
    }

    /// Returns guaranteed bounds, or the reason for their absence.
    pub(super) fn bounds(
        &self,
        n: usize,
        law: Law,
        y: &[f64],
    ) -> std::result::Result<Guarantee, String> {
        match self {
            Self::Square { f, .. } => {
                let bounds = bounds(square(n), f, law, y).map_err(|reason| reason.to_string())?;
                Ok(Guarantee { bounds, reserve: Reserve::list(f.is_smooth(), false) })
            }
            Self::Cube { .. } if n > MOST_WITH_BOUNDS => {
                Err(format!("on the cube there are bounds down to 1/{MOST_WITH_BOUNDS}"))
            }
            Self::Cube { f, .. } => {
                let CubeBounds { bounds, by_quadrature } =
                    bounds_on_cube(cube(n), f, law, y).map_err(|reason| reason.to_string())?;
                Ok(Guarantee { bounds, reserve: Reserve::list(by_quadrature, false) })
            }
            Self::Mesh(mesh) => {
                let MeshProblem { f, mesh: finest, .. } = &mesh.problem;
                let bounds = mesh.problem.bounds(y).map_err(|reason| reason.to_string())?;
                let reserve = Reserve::list(f.unsettled.is_some(), finest.is_curved());
                Ok(Guarantee { bounds, reserve })
            }
        }
    }

    /// Returns the recovered solution, on the grid of half the width.
    pub(super) fn recovered(&self, n: usize, law: Law, pair: &Pair) -> Result<Pair> {
        let Self::Square { f, .. } = self else {
            return Err(Error::input("--recover is for the square; leave it out"));
        };
        let (y, _) = recovery(square(n), f, law, &pair.y)
            .map_err(|reason| Error::input(format!("--recover: {reason}; leave it out")))?;
        Ok(Pair { y, a: prolong_boundary(&pair.a) })
    }

    /// Refuses a format in which the domain has no files.
    pub(super) fn check_format(&self, format: Format) -> Result<()> {
        let on_mesh = matches!(self, Self::Mesh(_));
        let problem = match format {
            Format::Svg if self.dimension() == 3 => {
                let ending = if on_mesh { ".vtu" } else { ".vti" };
                format!(
                    "a solution in space has no picture; use {ending} and open it in ParaView, or .npz"
                )
            }
            Format::Vti if on_mesh => {
                "a solution on a mesh is written as .vtu, .npz or .npy".into()
            }
            Format::Vtu if !on_mesh => {
                "a solution on a grid is written as .vti, .npz or .npy".into()
            }
            Format::Vti | Format::Vtu | Format::Npy | Format::Npz | Format::Svg => return Ok(()),
        };
        Err(Error::input(format!("--out: {problem}")))
    }

    /// Returns the bytes of a file with the solution; the caller refuses a picture of the cube.
    pub(super) fn file(
        &self,
        kind: Format,
        n: usize,
        pair: &Pair,
        ReportedAs { name, law }: ReportedAs<'_>,
    ) -> Result<Vec<u8>> {
        let fields = match self {
            Self::Square { f, .. } => Fields::square(square(n), f, pair),
            Self::Cube { f, .. } => Fields::new(3, n, |at| f.at(at), cube(n).boundary(), pair),
            Self::Mesh(mesh) => return mesh.file(kind, pair, ReportedAs { name, law }),
        };
        match kind {
            Format::Npy => Ok(fields.npy()),
            Format::Npz => fields.npz().ok_or_else(|| {
                Error::input("--out: an .npz file holds at most 4 GB; use .npy or .vti")
            }),
            Format::Vti | Format::Vtu => Ok(fields.vti(name)),
            Format::Svg => {
                let (grid, azimuth) = (square(n), uphill(square(n), &pair.y));
                let (y, in_contact) = (&pair.y, &pair.in_contact(grid, law));
                let surface = Surface { title: name, grid, y, in_contact, azimuth, range: None };
                let drawn = surfaces(2, &[surface]).svg(name, "Made by `signorini solve`.");
                drawn.map(String::into_bytes).map_err(Error::input)
            }
        }
    }
}

pub(super) fn square(n: usize) -> Grid {
    Grid::new(n).expect("validated with the hierarchy")
}

fn cube(n: usize) -> cube::Grid {
    cube::Grid::new(n).expect("validated with the hierarchy")
}
