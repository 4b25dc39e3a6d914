//! Statements: a domain with f, the laws on the parts of its boundary, how fine, and a solver with its settings.
//!
//! Central is [`Statement`], plain data: a scene is a statement with a title and outputs, the options of `solve` are
//! one, and so are the parameters of a task. [`Statement::problem`] makes the problem of it, [`Statement::solve`] the
//! answer, and [`Statement::judged`] the warnings and the failure of that.

mod boundary;
mod domain;
mod fineness;
mod judged;
mod warning;

pub use boundary::Boundary;
pub use domain::Domain;
pub use fineness::Fineness;
pub use judged::Judged;
pub use warning::{Failure, Warning};

use domain::as_in_mesh;
use fineness::{FIRST_CELLS, USUAL_NODES};

use crate::bounds::Accuracy;
use crate::discrete::grid::{Grid, nested};
use crate::discrete::load::{Diagonal, LoadRule};
use crate::levels::{Problem, ProblemError, Step, Watch};
use crate::mesh::AnyMesh;
use crate::multigrid::Goal;
use crate::problem::error::SourceError;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::text::Written;
use crate::saddle::Monitor;
use crate::solvers::{
    Adaption, Grids, Memory, ReachEnd, Reached, Refusal, SaddleSettings, Settings, Solved, Solver,
    Watcher, find, reach, saddle_together,
};
use serde::{Deserialize, Serialize};

/// Problem and solver as they are asked for: the same in a scene, in options, in experiments and in the parameters of a
/// task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statement {
    /// Domain.
    pub domain: Domain,
    /// Laws on the parts of its boundary.
    #[serde(default, skip_serializing_if = "Boundary::is_empty")]
    pub boundary: Boundary,
    /// f as text; on the square as [`Source`] writes it.
    pub f: String,
    /// Factor k of the flux `k grad v` on each region, as text; none where it is 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k: Option<String>,
    /// Factor c > 0 of the term c v of the equation; none without a reaction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reaction: Option<f64>,
    /// Quadrature of the load vector on grids of the square; none on meshes, which have one alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<LoadRule>,
    /// Grids or meshes.
    pub fineness: Fineness,
    /// Solver.
    pub solver: Solver,
    /// Settings of a saddle-point method; none for other solvers.
    #[serde(flatten)]
    pub saddle: Option<SaddleSettings>,
    /// KKT residual over the largest load at which multigrid or a saddle-point method stops; none for the rounding
    /// floor or the stopping rule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// True if the energy is compared with that of the true solution of the same problem.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub with_truth: bool,
}

/// Reason for which a statement states no problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StatementError {
    /// A field whose value is wrong: the name of the field, the value, and the reason.
    #[error("{field} {value}: {reason}")]
    Field {
        /// Name of the field.
        field: &'static str,
        /// Value, as text.
        value: String,
        /// Reason, with the remedy.
        reason: String,
    },
    /// There is no problem.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A solver refuses the problem.
    #[error(transparent)]
    Solver(#[from] Refusal),
}

impl StatementError {
    /// Error in a field.
    pub(crate) fn field(field: &'static str, value: impl ToString, reason: impl ToString) -> Self {
        Self::Field { field, value: value.to_string(), reason: reason.to_string() }
    }
}

impl Statement {
    /// Solver, unless another is named.
    pub const SOLVER: Solver = Solver::Multigrid;
    /// Quadrature of the load vector on the square, unless another is named.
    pub const LOAD: LoadRule = LoadRule::Bilinear {};

    /// Statement of f on a domain with all else as usual.
    pub fn usual(domain: Domain, f: impl Into<String>) -> Self {
        Self {
            load: domain.is_square().then_some(Self::LOAD),
            domain,
            f: f.into(),
            k: None,
            reaction: None,
            boundary: Boundary::default(),
            fineness: Fineness::Usual,
            solver: Self::SOLVER,
            saddle: None,
            tolerance: None,
            with_truth: false,
        }
    }

    /// Law on parts of the boundary that are named nowhere else.
    ///
    /// # Errors
    /// [`StatementError::Field`] if its numbers make none.
    pub fn law(&self) -> Result<Law, StatementError> {
        self.boundary.law("")
    }

    /// True if the problem is solved on grids in place of meshes: on the square, under one law whose value is 0, with
    /// k = 1 and without a reaction.
    pub fn has_grids(&self) -> bool {
        let is_one = self.boundary.names().next().is_none();
        let is_laplacian = self.k.is_none() && self.reaction.is_none();
        self.domain.is_square()
            && is_one
            && is_laplacian
            && self.law().is_ok_and(|law| law.at() == 0.0)
    }

    /// f on grids of the square; none on meshes, and if the text is no f.
    pub fn source(&self) -> Option<Source> {
        self.has_grids().then(|| self.f.parse().ok()).flatten()
    }

    /// Accuracy that is asked for; none where the fineness is stated otherwise.
    pub fn accuracy(&self) -> Option<Accuracy> {
        match self.fineness {
            Fineness::Within(accuracy) => Some(accuracy),
            _ => None,
        }
    }

    /// Nested grids of the square, coarsest first; where an accuracy is asked for, the first that is tried.
    ///
    /// # Errors
    /// [`StatementError::Field`] if they do not nest, or are too coarse.
    pub fn grids(&self) -> Result<Vec<Grid>, StatementError> {
        let sizes = self.fineness.cells();
        nested(&sizes).map_err(|e| StatementError::field(self.fineness.field(), &self.fineness, e))
    }

    /// Coarsest mesh with its conditions and curves, from the contents of the Gmsh file unless the domain is built in;
    /// none where there are grids.
    ///
    /// # Errors
    /// [`StatementError::Field`].
    pub fn mesh(&self, file: Option<&[u8]>) -> Result<Option<AnyMesh>, StatementError> {
        if self.has_grids() {
            return Ok(None);
        }
        let mut mesh = self.domain.mesh(file, self.fineness.coarsest(&self.domain)?)?;
        let names: Vec<_> = self.boundary.names().collect();
        let named: Vec<_> = names.iter().map(|part| as_in_mesh(&mesh, part)).collect();
        for (part, name) in names.into_iter().zip(&named) {
            let set = mesh.set_law(name, self.boundary.law(part)?);
            let set = set.and_then(|()| match self.boundary.formula(part) {
                Some(formula) => mesh.set_value(name, &formula.to_string()),
                None => Ok(()),
            });
            set.map_err(|e| self.in_law(part, e))?;
        }
        if let Some(k) = &self.k {
            let has_regions = self.domain.is_file() || !k.contains('=');
            let name = &self.domain.name;
            let set = match has_regions {
                true => mesh.set_k(k),
                false => Err(format!("the {name} has no regions; give a Gmsh file")),
            };
            set.map_err(|e| StatementError::field("k", "", e))?;
        }
        if let Some(c) = self.reaction {
            let set = mesh.set_reaction(c);
            set.map_err(|e| StatementError::field("reaction", Written(c), e))?;
        }
        let others = mesh.set_others(&named, self.law()?, self.boundary.formula(""));
        others.map_err(|e| self.in_law("", e))?;
        Ok(Some(mesh))
    }

    /// Error in what is said of the law on a part.
    fn in_law(&self, part: &str, reason: impl ToString) -> StatementError {
        let field = self.boundary.first(part).map_or("law", |(of, _)| of.name());
        StatementError::field(field, part, reason)
    }

    /// Number of refinements of the coarsest mesh; where an accuracy is asked for, those on which is seen whether there
    /// is a solution.
    ///
    /// # Errors
    /// [`StatementError::Field`] if the cube has no cells of this width.
    pub fn refinements(&self, mesh: &AnyMesh) -> Result<usize, StatementError> {
        self.fineness.refinements(&self.domain, mesh)
    }

    /// Problem on the square or on a mesh that [`Statement::mesh`] has made; where an accuracy is asked for, on the
    /// first grid or on a mesh that shows whether there is a solution. `watch` is told when meshes are made, and when f
    /// is integrated on them.
    ///
    /// # Errors
    /// [`StatementError`].
    pub fn problem(
        &self,
        mesh: Option<&AnyMesh>,
        watch: Watch<'_>,
    ) -> Result<Problem, StatementError> {
        let Some(mesh) = mesh else {
            let f = self.f.parse().map_err(|e: SourceError| StatementError::field("f", "", e))?;
            let rule = self.load.unwrap_or(Self::LOAD);
            return Ok(Problem::on_square(self.grids()?, f, rule, self.law()?)?);
        };
        let times = self.refinements(mesh)?;
        Ok(Problem::on_mesh_watched((mesh, times), &self.f, watch)?)
    }

    /// Checks that there is a problem to be solved, unless its meshes have more nodes than the usual ones. Returns what
    /// a user has to know, in a line each.
    ///
    /// # Errors
    /// [`StatementError`].
    pub fn checked(&self, mesh: Option<&AnyMesh>) -> Result<Vec<String>, StatementError> {
        let usual = self.on_usual_meshes();
        let mut notes = mesh.map_or_else(Vec::new, AnyMesh::notes);
        let times = mesh.map(|mesh| usual.refinements(mesh)).transpose()?;
        let nodes = mesh.zip(times).map_or(0.0, |(mesh, times)| mesh.nodes_after(times));
        if nodes <= USUAL_NODES {
            let problem = usual.problem(mesh, &|_| ())?;
            notes.extend(problem.note_on_jumps().or_else(|| problem.note_on_curves()));
        }
        Ok(notes)
    }

    /// Checks that the text is an f on this mesh, whatever its fineness, and has finite values there.
    ///
    /// # Errors
    /// [`StatementError::Problem`]. That f cannot be balanced is none.
    pub fn check_f(&self, coarsest: &AnyMesh) -> Result<(), StatementError> {
        match Problem::on_mesh_watched((coarsest, 0), &self.f, &|_| ()) {
            Err(e @ (ProblemError::Source(_) | ProblemError::NotFinite)) => Err(e.into()),
            _ => Ok(()),
        }
    }

    /// The statement on the usual grids or meshes, where an accuracy is asked for.
    pub fn on_usual_meshes(&self) -> Self {
        let fineness = match self.fineness {
            Fineness::Within(_) => Fineness::Usual,
            _ => self.fineness.clone(),
        };
        Self { fineness, ..self.clone() }
    }

    /// The statement with no refinement where nobody reads a node: the solver uses none, no file or picture is wanted,
    /// and the coarsest mesh, without curves, is all of the domain.
    pub fn without_nodes(&self, mesh: Option<&AnyMesh>) -> Self {
        let is_domain = mesh.is_some_and(|mesh| mesh.plane().is_some() && !mesh.is_curved());
        let fineness = match self.solver.entry().is_discrete || !is_domain {
            true => self.fineness.clone(),
            false => Fineness::Refined(0),
        };
        Self { fineness, ..self.clone() }
    }

    /// The problem on the finest grid of the square alone, by multigrid, with f integrated exactly.
    pub fn exactly(&self) -> Self {
        Self {
            load: Some(LoadRule::Exact { diagonal: Diagonal::default() }),
            fineness: Fineness::Grids(self.fineness.cells().last().copied().into_iter().collect()),
            solver: Solver::Multigrid,
            saddle: None,
            ..self.clone()
        }
    }

    /// Problem on the meshes of a way to the accuracy that is asked for, which began with this mesh and marked these
    /// cells for its bisections, one list for each.
    ///
    /// # Errors
    /// [`StatementError`], also in space.
    pub fn problem_on_bisected(
        &self,
        mesh: &AnyMesh,
        marks: &[Vec<u32>],
    ) -> Result<Problem, StatementError> {
        let mesh = mesh.plane().ok_or(Refusal::NotInPlane)?;
        Ok(Problem::on_bisected(mesh, marks, &self.f)?)
    }

    /// Solves what is stated, with all memory that it takes; the mesh is read from the contents of the Gmsh file unless
    /// the domain is built in.
    ///
    /// # Errors
    /// [`StatementError`].
    pub fn solved(&self, file: Option<&[u8]>) -> Result<Solved, StatementError> {
        let problem = self.problem(self.mesh(file)?.as_ref(), &|_| ())?;
        Ok(self.solve(problem, Memory::new(None), &mut (), &|_| ())?)
    }

    /// The statement of a saddle-point method on the square with the usual settings; none of another. Statements for
    /// which it is the same can be solved side by side.
    pub fn without_settings(&self) -> Option<Self> {
        let SaddleSettings { prolongation, .. } = self.saddle.filter(|_| self.has_grids())?;
        let saddle = Some(SaddleSettings { prolongation, ..SaddleSettings::default() });
        Some(Self { solver: Solver::ArrowHurwicz, saddle, tolerance: None, ..self.clone() })
    }

    /// Solves statements side by side whose [`Statement::without_settings`] is the same, each with its observer, as
    /// [`Statement::solve`] solves each, in less time; they have this problem.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn solve_together(
        statements: &[&Self],
        problem: &Problem,
        monitors: &mut [&mut dyn Monitor],
    ) -> Result<Vec<Solved>, Refusal> {
        let settings: Vec<_> = statements.iter().map(|of| of.settings(problem)).collect();
        let found = saddle_together(problem, &settings, monitors)?;
        Ok(found.into_iter().map(|found| Solved::new(problem.clone(), found)).collect())
    }

    /// Settings of the solver for a problem.
    pub fn settings(&self, problem: &Problem) -> Settings {
        let goal = match (self.accuracy(), self.tolerance) {
            (Some(Accuracy::Error(_)), _) => Goal::DiscretisationError,
            // The bracket of the energy is much narrower than the error.
            (Some(Accuracy::Energy(_)), _) | (None, None) => Goal::RoundingFloor,
            (None, Some(tolerance)) => Goal::Kkt(tolerance * problem.unit()),
        };
        Settings { solver: self.solver, saddle: self.saddle.unwrap_or_default(), goal }
    }

    /// Solves the problem that [`Statement::problem`] has made, where an accuracy is asked for on one grid or mesh
    /// after the other. `steps` is told each step.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn solve(
        &self,
        problem: Problem,
        memory: Memory,
        watcher: &mut dyn Watcher,
        steps: Watch<'_>,
    ) -> Result<Solved, Refusal> {
        let settings = self.settings(&problem);
        let Some(goal) = self.accuracy() else {
            // The load vector is made when it is first read.
            if self.solver.entry().is_discrete {
                problem.load();
                steps(Step::Load);
            }
            let found = find(&problem, &settings, watcher)?;
            steps(Step::Solver);
            return Ok(Solved::new(problem, found));
        };
        // Whatever the grids of the problem, the way begins with the first.
        if let Some(first) = problem.on_grid(FIRST_CELLS) {
            let first = first.map_err(Refusal::from)?;
            return reach(Grids::new(first, settings, goal, memory, steps), goal, watcher);
        }
        let f = &problem.levels().facts().f.clone();
        let coarsest = problem.levels().mesh(0).into_owned();
        let coarsest = coarsest.plane().ok_or(Refusal::NotInPlane)?;
        // The adapted meshes take its place.
        drop(problem);
        let (most_nodes, bisections) = (memory.adapted_nodes(), Adaption::BISECTIONS);
        let mut solved =
            Adaption { coarsest, f, goal, most_nodes, bisections }.run(watcher, steps)?;
        if let Some(Reached { end, .. }) = &mut solved.reached
            && let ReachEnd::Finest { best, .. } = *end
            && memory.is_limited()
        {
            *end = ReachEnd::MostNodes { best };
        }
        Ok(solved)
    }
}
