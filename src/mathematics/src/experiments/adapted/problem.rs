//! Problems on adapted and on uniform meshes, with guaranteed bounds.

use crate::bounds::{Accuracy, Bounds};
use crate::levels::Problem;
use crate::mesh::{
    AnyMesh, BuiltIn, Condition, Facet, MeshData, Names, Part, PlaneMesh, lattice_mesh,
};
use crate::problem::law::Law;
use crate::solvers::{Adaption, FoundSolution, Settings, Solver, find, solve};
use crate::spectral::TrueSolution;
use serde::{Deserialize, Serialize};

/// Power of the lattice's height above the lower side that is the height of a node of the layer.
const GRADING: f64 = 5.0;

/// Problem of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::experiments) enum AdaptedProblem {
    /// The L-shape with a load in its inner corner's square, all of its boundary in contact.
    LShape,
    /// The unit square, whose lower side is fixed on its left half, free on its right half; the other sides are in
    /// contact.
    FixedFree,
    /// Problem on a mesh with a boundary layer on the lower side, whose first cells are 256 times as long as high.
    Layer,
}

impl AdaptedProblem {
    pub(super) const ALL: [Self; 3] = [Self::LShape, Self::FixedFree, Self::Layer];

    /// Name in pictures and tables.
    pub(in crate::experiments) fn name(self) -> &'static str {
        match self {
            Self::LShape => "L-shape",
            Self::FixedFree => "square, fixed and free",
            Self::Layer => "boundary layer",
        }
    }

    /// f, as text.
    pub(super) fn f(self) -> &'static str {
        match self {
            Self::LShape => "rect(-9,0,-9,0)=3; else=-2",
            Self::FixedFree | Self::Layer => "rect(-9,0,-9,0)=-4; else=2",
        }
    }

    /// Number of times that the sides are halved in the first mesh.
    pub(super) fn halvings(self) -> usize {
        match self {
            Self::LShape | Self::FixedFree => 1,
            Self::Layer => 2,
        }
    }

    /// First mesh.
    ///
    /// # Errors
    /// A sentence if it fails the checks of meshes.
    fn mesh(self) -> Result<PlaneMesh, String> {
        match self {
            Self::LShape => {
                BuiltIn::LShape.plane().ok_or_else(|| "the L-shape lies in the plane".into())
            }
            Self::FixedFree => fixed_and_free(lattice_mesh(&[-0.5, 0.0, 0.5])),
            Self::Layer => {
                let mut square = lattice_mesh(&[-0.5, -0.25, 0.0, 0.25, 0.5]);
                let points = square.points.iter_mut();
                points.for_each(|[_, y]| *y = libm::pow(*y + 0.5, GRADING) - 0.5);
                fixed_and_free(square)
            }
        }
    }

    /// Solves on adapted meshes until the guaranteed error, over the norm of the solution, is at most `accuracy`, or a
    /// mesh would have more than `most_nodes`; returns with the run the bounds on each mesh.
    ///
    /// # Errors
    /// A sentence if there is no solution, or no bound on a mesh.
    pub(in crate::experiments) fn adapted(
        self,
        accuracy: f64,
        most_nodes: usize,
        bisections: usize,
    ) -> Result<BoundedRun, String> {
        let mesh = self.mesh()?;
        let goal = Accuracy::Error(accuracy);
        let adaption = Adaption {
            coarsest: &mesh,
            f: self.f(),
            law: Law::SIGNORINI,
            goal,
            most_nodes,
            bisections,
        };
        let solved = adaption.run(&mut (), &|_| ()).map_err(|e| e.to_string())?;
        let bounds: Result<Vec<_>, _> = solved.bounds().iter().cloned().collect();
        let bounds = bounds.map_err(|e| e.to_string())?;
        let y = solved.pair().y;
        Ok(BoundedRun { problem: solved.problem, y, bounds })
    }

    /// True solution.
    ///
    /// # Errors
    /// A sentence if it is not found.
    pub(in crate::experiments) fn truth(self) -> Result<TrueSolution, String> {
        let problem = Problem::on_mesh(&self.mesh()?.into(), 0, self.f(), Law::SIGNORINI);
        let problem = problem.map_err(|e| e.to_string())?;
        match find(&problem, &Settings::of(Solver::Spectral), &mut ()) {
            Ok(FoundSolution::Truth(found)) => Ok(*found),
            Ok(FoundSolution::Vector(_)) => Err("no true solution".into()),
            Err(e) => Err(e.to_string()),
        }
    }

    /// Solves on the mesh after so many uniform refinements, with bounds on this mesh alone.
    ///
    /// # Errors
    /// A sentence if there is no solution, or no bound.
    pub(in crate::experiments) fn uniform_finest(
        self,
        refinements: usize,
    ) -> Result<BoundedRun, String> {
        let mesh = AnyMesh::from(self.mesh()?);
        let problem = Problem::on_mesh(&mesh, refinements, self.f(), Law::SIGNORINI)
            .map_err(|e| e.to_string())?;
        let run = solve(&problem, &Settings::of(Solver::Multigrid)).map_err(|e| e.to_string())?;
        let bounds = problem.bounds(&run.y).map_err(|e| e.to_string())?;
        Ok(BoundedRun { problem, y: run.y, bounds: vec![bounds] })
    }

    /// Solves on the first mesh and on its uniform refinements, with bounds on each.
    ///
    /// # Errors
    /// A sentence if there is no solution, or no bound on a mesh.
    pub(super) fn uniform(self, refinements: usize) -> Result<BoundedRun, String> {
        let mut bounds = Vec::new();
        for times in 0..refinements {
            bounds.extend(self.uniform_finest(times)?.bounds);
        }
        let mut run = self.uniform_finest(refinements)?;
        bounds.append(&mut run.bounds);
        Ok(BoundedRun { bounds, ..run })
    }
}

/// Square whose lower side, of the first nodes of the mesh, is fixed on its left half and free on its right half.
///
/// # Errors
/// A sentence if it fails the checks of meshes.
fn fixed_and_free(square: PlaneMesh) -> Result<PlaneMesh, String> {
    let across = square.points.iter().take_while(|[_, y]| *y == square.points[0][1]).count() - 1;
    let facets = (0..across)
        .map(|k| Facet { nodes: [k as u32, k as u32 + 1], part: u16::from(2 * k >= across) });
    let parts = [("fixed", Condition::Fixed), ("free", Condition::Free)]
        .map(|(name, condition)| Part { names: Names::from(name), condition, curve: None });
    MeshData {
        facets: facets.collect(),
        points: square.points,
        cells: square.cells,
        parts: parts.into(),
        ..MeshData::default()
    }
    .mesh()
    .map_err(|e| e.to_string())
}

/// Problem on nested meshes, with guaranteed bounds.
pub(in crate::experiments) struct BoundedRun {
    /// Problem.
    pub(super) problem: Problem,
    /// Nodal vector on the finest mesh.
    pub(in crate::experiments) y: Vec<f64>,
    /// Bounds on each mesh, coarsest first, or on the finest alone.
    pub(in crate::experiments) bounds: Vec<Bounds>,
}

/// The last adapted mesh with at most so many nodes of each problem, with its name and number of nodes as a title.
///
/// # Errors
/// A sentence if a problem cannot be solved.
pub fn coarse_meshes(most_nodes: usize) -> Result<Vec<(String, AnyMesh)>, String> {
    let mut meshes = Vec::new();
    for problem in AdaptedProblem::ALL {
        // No mesh so coarse is so accurate: the number of nodes is what ends the run.
        let run = problem.adapted(f64::EPSILON, most_nodes, 1)?;
        let title = format!("{}, {} nodes", problem.name(), run.y.len());
        meshes.push((title, run.problem.levels().mesh(run.problem.finest()).into_owned()));
    }
    Ok(meshes)
}
