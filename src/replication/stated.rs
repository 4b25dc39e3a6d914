//! Problems as scenes and options state them: a domain, f, the law, and the grids or refinements.

use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::is_plain;
use crate::pipeline::names::found;
use crate::pipeline::{InputFile, InputFiles};
use crate::replication::domain::{DomainSettings, nodes_after};
use serde::{Deserialize, Deserializer, Serialize};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::{LoadRule, moved_jumps};
use signorini_mathematics::levels::{Problem, Watch};
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::problem::law::{Law, LawParameter};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::statement::{Domain, Fineness, SaddleSettings, Statement};
use std::path::Path;

/// Problem as a scene or the options of `solve` state it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StatedProblem {
    /// Domain with f.
    #[serde(flatten)]
    pub place: Place,
    /// Law on the boundary; none for the paper's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<LawParameter>,
}

/// Domain with f, and its levels.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Place {
    /// The paper's square, with its grids.
    Square(OnSquare),
    /// A mesh with its refinements.
    Mesh(OnMesh),
}

/// f on nested grids of the square.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OnSquare {
    /// Right-hand side.
    pub f: Source,
    /// Quadrature of the load vector.
    pub load: LoadRule,
    /// Nested grids, coarsest first.
    #[serde(serialize_with = "cells", deserialize_with = "grids")]
    pub grids: Vec<Grid>,
}

/// f on a mesh and its refinements.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OnMesh {
    /// Domain and its refinements.
    pub domain: DomainSettings,
    /// f, as text.
    pub f: String,
    /// Files on which the domain depends, by path: the mesh, if it is one of the project.
    #[serde(skip)]
    pub files: InputFiles,
}

/// Findings of the check of a mesh.
pub(crate) struct CheckedMesh {
    /// Number of dimensions.
    pub dimension: u8,
    /// Number of nodes of the finest level, about.
    pub nodes: f64,
    /// Facts on the mesh that a user has to know, in a line each.
    pub notes: Vec<String>,
}

/// Grids as their numbers of cells per side.
fn cells<S: serde::Serializer>(
    grids: &[Grid],
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_seq(grids.iter().map(|grid| grid.cells()))
}

/// Grids of these numbers of cells per side.
pub(super) fn grids<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Vec<Grid>, D::Error> {
    nested(&Vec::<usize>::deserialize(deserializer)?).map_err(serde::de::Error::custom)
}

/// Cells per side of the grids of `solve` and of a scene, unless others are named: those of the paper.
const USUAL_CELLS: [usize; 5] = [4, 8, 16, 32, 64];
/// Number of nodes up to which f is checked on the mesh of a scene before its tasks run.
const CHECKED_NODES: f64 = super::domain::USUAL_NODES;
/// Most nodes of a mesh of a scene; the method of the paper takes days on it.
const MOST_NODES: f64 = 1e7;
/// Folder of the project from which scenes name their meshes.
pub(crate) const FOLDER: &str = "pipeline";

impl StatedProblem {
    /// Solver of `solve` and of a scene without a published table, unless another is named.
    pub(crate) const SOLVER: Solver = Solver::Multigrid;

    /// Problem on the square.
    pub(crate) fn on_square(square: OnSquare, law: Option<LawParameter>) -> Self {
        Self { place: Place::Square(square), law }
    }

    /// Problem on a domain with f as text; its mesh has not been looked for.
    pub(crate) fn on_mesh(domain: DomainSettings, f: String, law: Option<LawParameter>) -> Self {
        Self { place: Place::Mesh(OnMesh { domain, f, files: InputFiles::new() }), law }
    }

    /// Returns the law on the boundary.
    ///
    /// # Errors
    /// [`Error::Input`] if its parameter makes no law.
    pub(crate) fn law(&self) -> Result<Law> {
        LawParameter::law_or_papers(self.law).map_err(|e| Error::input(format!("law: {e}")))
    }

    /// Returns the problem; its mesh is read from these files.
    pub(crate) fn problem(&self, files: &InputFiles) -> Result<Problem> {
        match &self.place {
            Place::Square(OnSquare { f, load, grids }) => {
                let made = Problem::on_square(grids.clone(), f.clone(), *load, self.law()?);
                made.map_err(|e| Error::input(e.to_string()))
            }
            Place::Mesh(place) => self.on_coarsest(place, &place.coarsest(files)?, &|_| ()),
        }
    }

    /// Returns the problem on a mesh that has been read; `watch` is told when it is refined, and when f is integrated.
    pub(crate) fn on_coarsest(
        &self,
        place: &OnMesh,
        coarsest: &AnyMesh,
        watch: Watch<'_>,
    ) -> Result<Problem> {
        let times = place.domain.refinements(coarsest);
        Problem::on_mesh_watched((coarsest, times), &place.f, self.law()?, watch)
            .map_err(|e| Error::input(e.to_string()))
    }

    /// Returns the statement of this problem, solved by this solver with these settings of a saddle-point method, if it
    /// is one; an accuracy takes the place of the levels.
    pub(crate) fn statement(
        &self,
        solver: Solver,
        accuracy: Option<Accuracy>,
        saddle: Option<SaddleSettings>,
    ) -> Statement {
        let (domain, load, fineness) = match &self.place {
            Place::Square(square) => {
                let cells = square.grids.iter().map(|grid| grid.cells()).collect();
                (Domain::square(), Some(square.load), Fineness::Grids(cells))
            }
            Place::Mesh(OnMesh { domain: settings, .. }) => {
                let DomainSettings { name, free, fixed, curve, .. } = settings.clone();
                let fineness = match (settings.cells, settings.refine) {
                    (Some(coarsest), Some(times)) => Fineness::Width(coarsest << times),
                    (_, Some(times)) => Fineness::Refined(times),
                    (_, None) => Fineness::Usual,
                };
                (Domain { name, free, fixed, curve }, None, fineness)
            }
        };
        let fineness = accuracy.map_or(fineness, Fineness::Within);
        let (f, law) = (self.f(), self.law);
        Statement { domain, f, law, load, fineness, solver, saddle, tolerance: None }
    }

    /// Checks f on the square, and elsewhere the mesh, its parts and, on meshes of the usual size, f. Takes time.
    pub(crate) fn check(&self) -> Result<Option<CheckedMesh>> {
        let place = match &self.place {
            Place::Square(square) => {
                // A known solution is proof enough.
                if square.f.exact().is_none() || self.law.is_some() {
                    self.problem(&InputFiles::new())?;
                }
                return Ok(None);
            }
            Place::Mesh(place) => place,
        };
        let coarsest = place.coarsest(&place.files)?;
        let times = place.domain.refinements(&coarsest);
        let nodes = nodes_after(&coarsest, times);
        if nodes > MOST_NODES {
            return Err(Error::input(format!(
                "refine = {times} makes about {nodes:.0e} nodes, more than is sensible; {MOST_NODES:.0e} are the most"
            )));
        }
        let (dimension, mut notes) = (coarsest.dimension(), coarsest.notes());
        if nodes <= CHECKED_NODES {
            notes.extend(refusal_of_curves(&self.on_coarsest(place, &coarsest, &|_| ())?));
        }
        Ok(Some(CheckedMesh { dimension, nodes, notes }))
    }

    /// Part of the integral of |f| by which a nodal load moves jumps of f, half a cell where grid lines lie on them;
    /// none if it is too small to matter.
    pub(crate) fn moved_jumps(&self) -> Option<f64> {
        let square = self.square()?;
        moved_jumps(square.finest(), &square.f, square.load)
    }

    /// Known solution of a problem on the square.
    pub(crate) fn known_solution(&self) -> Option<Exact> {
        self.square()?.f.exact()
    }

    /// f and the finest grid of a problem on the square.
    ///
    /// # Errors
    /// [`Error::Input`] on a mesh, for a solver that only the square has.
    pub(crate) fn on_finest(&self) -> Result<(&Source, Grid)> {
        let square = self.square().ok_or_else(|| Error::input("this solver is for the square"))?;
        Ok((&square.f, square.finest()))
    }

    /// Finds the mesh in the project in `root`, as [`OnMesh::find_mesh`] does.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        match &mut self.place {
            Place::Square(_) => Ok(()),
            Place::Mesh(place) => place.find_mesh(root, known),
        }
    }

    /// Pieces of f that are certain to lie outside the domain, as far as that is known without the mesh.
    pub(crate) fn outside(&self) -> Vec<String> {
        self.square().map(|square| square.f.outside()).unwrap_or_default()
    }

    /// f and grids on the square; none on a mesh.
    pub(crate) fn square(&self) -> Option<&OnSquare> {
        match &self.place {
            Place::Square(square) => Some(square),
            Place::Mesh(_) => None,
        }
    }

    /// Name of the domain, or the file with its mesh.
    pub(crate) fn domain(&self) -> &str {
        match &self.place {
            Place::Square(_) => "square",
            Place::Mesh(place) => &place.domain.name,
        }
    }

    /// f as text.
    pub(crate) fn f(&self) -> String {
        match &self.place {
            Place::Square(square) => square.f.to_string(),
            Place::Mesh(place) => place.f.clone(),
        }
    }

    /// Name of the file with the mesh, without folders, if there is one.
    pub(crate) fn file_name(&self) -> Option<&str> {
        let Place::Mesh(OnMesh { domain, .. }) = &self.place else { return None };
        domain.is_file().then(|| Path::new(&domain.name).file_name()?.to_str()).flatten()
    }

    /// Files on which the problem depends, by path.
    pub(crate) fn files(&self) -> InputFiles {
        match &self.place {
            Place::Square(_) => InputFiles::new(),
            Place::Mesh(place) => place.files.clone(),
        }
    }
}

/// Returns a line that the domain has no solution although the polygon or polyhedron of its mesh, which is solved, has
/// one.
pub(crate) fn refusal_of_curves(problem: &Problem) -> Option<String> {
    let polygon = if problem.levels().dimension() == 2 { "polygon" } else { "polyhedron" };
    let reason = problem.refusal_of_curves()?;
    Some(format!(
        "the {polygon} of the mesh has a solution, the domain with its curves has none: {reason}"
    ))
}

impl OnSquare {
    /// Quadrature of `solve` and of a scene without a published table, unless another is named.
    pub(crate) const LOAD: LoadRule = LoadRule::Bilinear {};

    /// Grids of `solve` and of a scene, unless others are named.
    pub(crate) fn usual_grids() -> Vec<Grid> {
        nested(&USUAL_CELLS).expect("each halves the one before")
    }

    /// Finest grid.
    pub(crate) fn finest(&self) -> Grid {
        *self.grids.last().expect("validated: at least one grid")
    }
}

impl OnMesh {
    /// Returns the path of the mesh in the project.
    fn path(&self) -> Option<String> {
        self.domain.is_file().then(|| format!("{FOLDER}/{}", self.domain.name))
    }

    /// Finds the mesh in the project in `root`, among the `known` files or else on the disk, and does not read it:
    /// other scenes with this mesh share what is read.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        let Some(path) = self.path() else { return Ok(()) };
        if !is_plain(&path) {
            return Err(Error::input(format!(
                "{path}: name a file below {FOLDER}/ by its shortest path, as domain = \"meshes/gear.msh\""
            )));
        }
        let file = match known.get(&path) {
            Some(file) => file.clone(),
            None => InputFile::if_there(&found(&root.join(&path)))?.ok_or_else(|| {
                let names = AnyMesh::built_in_names().join(", ");
                Error::input(format!(
                    "there is no {path}; put the mesh there, or name one of the domains {names}"
                ))
            })?,
        };
        known.insert(path.clone(), file.clone());
        self.files.insert(path, file);
        Ok(())
    }

    /// Returns the coarsest mesh, read from these files.
    pub(crate) fn coarsest(&self, files: &InputFiles) -> Result<AnyMesh> {
        let file = self.path().and_then(|path| files.get(&path));
        self.domain.coarsest(file.map(InputFile::bytes).transpose()?, "")
    }
}
