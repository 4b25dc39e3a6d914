//! Problems as scenes and options state them: a domain, f, the law, and the grids or refinements.

use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::is_plain;
use crate::pipeline::names::found;
use crate::pipeline::{InputFile, InputFiles};
use crate::replication::accuracy::{Accuracy, Written};
use crate::replication::domain::{DomainSettings, nodes_after};
use crate::timing::machine;
use serde::{Deserialize, Deserializer, Serialize};
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::{LoadRule, moved_on};
use signorini_mathematics::levels::{
    AdaptedEnd, AdaptedMesh, AdaptedRun, Adaption, Problem, ProblemError, Watch,
};
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::problem::law::{Law, LawParameter};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::solvers::Solver;
use std::ops::ControlFlow;
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
/// Part of the integral of |f| by which the nodal load may move jumps of f.
const MOVED: f64 = 1e-3;
/// Number of nodes up to which f is checked on the mesh of a scene before its tasks run.
const CHECKED_NODES: f64 = super::domain::USUAL_NODES;
/// Most nodes of a mesh of a scene; the method of the paper takes days on it.
const MOST_NODES: f64 = 1e7;
/// Memory per node of the finest of adapted meshes, with all coarser ones: measured, rounded up.
const BYTES_PER_NODE: u64 = 900;
/// Folder of the project from which scenes name their meshes.
const FOLDER: &str = "pipeline";

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

    /// Refines a mesh where the error is large until it is as small as asked; `watch` is shown each mesh, and `ended`
    /// told each step.
    ///
    /// # Errors
    /// [`Error::Input`] in space, on the square, and if there is no problem or no bound; [`Error::Interrupted`] if
    /// `watch` does not let it go on.
    pub(crate) fn adapted(
        &self,
        coarsest: &AnyMesh,
        asked: (Accuracy, Written),
        watch: &mut dyn FnMut(&AdaptedMesh) -> ControlFlow<()>,
        ended: Watch<'_>,
    ) -> Result<AdaptedRun> {
        let run = self.adaption(coarsest, asked)?.run_while(watch, ended);
        let run = run.map_err(|e| match (e, &self.place) {
            (ProblemError::Mesh(e), Place::Mesh(place)) => {
                Error::input(format!("{}: {e}", place.domain.name))
            }
            (e, _) => Error::input(format!("{}: {e}", asked.1.text(asked.0))),
        })?;
        run.ok_or(Error::Interrupted)
    }

    /// Returns the problem to be solved on adapted meshes.
    fn adaption<'a>(
        &'a self,
        coarsest: &'a AnyMesh,
        (accuracy, written): (Accuracy, Written),
    ) -> Result<Adaption<'a>> {
        accuracy.check(written)?;
        let asked = written.text(accuracy);
        let (Place::Mesh(OnMesh { f, .. }), AnyMesh::Plane(coarsest)) = (&self.place, coarsest)
        else {
            return Err(Error::input(format!(
                "{asked}: meshes are adapted in the plane alone; in space, choose how fine by the number of refinements"
            )));
        };
        let memory = machine::available_memory().unwrap_or(u64::MAX);
        let most_nodes = usize::try_from(memory / BYTES_PER_NODE).unwrap_or(usize::MAX);
        let goal = accuracy.goal_on_meshes();
        let bisections = Adaption::BISECTIONS;
        Ok(Adaption { coarsest, f, law: self.law()?, goal, most_nodes, bisections })
    }

    /// As [`StatedProblem::adapted`], for a scene, whose mesh is read from these files. The end is that of the goal.
    ///
    /// # Errors
    /// [`Error::Input`] also if the accuracy is not reached; [`Error::Interrupted`] if `watch` does not let it go on.
    pub(crate) fn adapted_scene(
        &self,
        files: &InputFiles,
        accuracy: Accuracy,
        watch: &mut dyn FnMut(&AdaptedMesh) -> ControlFlow<()>,
    ) -> Result<AdaptedRun> {
        let Place::Mesh(place) = &self.place else {
            return Err(Error::input("the square has grids in place of meshes"));
        };
        let (coarsest, asked) = (place.coarsest(files)?, Written::Key.text(accuracy));
        let run = self.adapted(&coarsest, (accuracy, Written::Key), watch, &|_| ())?;
        match run.end {
            AdaptedEnd::Goal => Ok(run),
            _ if !accuracy.reached(&run.bounds).is_finite() => Err(Error::input(format!(
                "{asked}: the error is bounded on no mesh by less than the solution, as where v = 0; leave it out"
            ))),
            AdaptedEnd::Nodes | AdaptedEnd::NoLongerFalls => Err(Error::input(format!(
                "{asked}: {:.1e} is reached with {} nodes, and no more; ask for less",
                accuracy.reached(&run.bounds),
                run.y.len()
            ))),
        }
    }

    /// Returns the problem on the meshes of [`StatedProblem::adapted_scene`], from the cells that were marked there.
    pub(crate) fn on_bisected(&self, files: &InputFiles, marks: &[Vec<u32>]) -> Result<Problem> {
        let Place::Mesh(place) = &self.place else {
            return Err(Error::input("the square has grids in place of meshes"));
        };
        let AnyMesh::Plane(coarsest) = place.coarsest(files)? else {
            return Err(Error::input("meshes are adapted in the plane alone"));
        };
        let problem = Problem::on_bisected(&coarsest, marks, &place.f, self.law()?);
        problem.map_err(|e| Error::input(e.to_string()))
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
        moved_on(square.finest(), &square.f, square.load).filter(|&moved| moved > MOVED)
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

    /// Puts a problem on the square on one grid.
    pub(crate) fn set_grid(&mut self, grid: Grid) {
        if let Place::Square(square) = &mut self.place {
            square.grids = vec![grid];
        }
    }

    /// Cells along each side of the coarsest mesh of the cube, if that is the domain and they were given.
    pub(crate) fn cells_of_coarsest_cube(&self) -> Option<usize> {
        match &self.place {
            Place::Square(_) => None,
            Place::Mesh(place) => place.domain.cells,
        }
    }

    /// Returns how fine a mesh is after so many refinements; none on the square.
    pub(crate) fn refined(&self, times: usize) -> Option<String> {
        if let Some(coarsest) = self.cells_of_coarsest_cube() {
            return Some(format!("h 1/{}", coarsest << times));
        }
        self.square().is_none().then(|| match times {
            0 => "not refined".into(),
            1 => "refined once".into(),
            _ => format!("refined {times} times"),
        })
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
