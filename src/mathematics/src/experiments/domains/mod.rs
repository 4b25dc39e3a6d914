//! The paper's method and multigrid on other domains than the square: convergence on the disc and the cube, counts of
//! iterations on nested meshes and for other numberings of the nodes, cost.

mod counts;
mod cube;
mod disc;

use crate::levels::{Problem, Reserve};
use crate::machine::threads::map;
use crate::mesh::AnyMesh;
use crate::multigrid::Goal;
use crate::problem::law::Law;
use crate::solvers::{Run, Settings, Solver, solve};
use serde::{Deserialize, Serialize};

pub use counts::{CountedDomain, CountsRow, CountsSummary, Numbering, NumberingCounts};
pub(super) use counts::{Nested, nested};
pub use cube::CubeLevel;
pub use disc::{DiscFindings, DiscLevel};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DomainsPlan {
    /// Domains with their f.
    pub domains: Vec<DomainPlan>,
    /// Values of the duality parameter.
    pub r: Vec<f64>,
    /// Values of the duality parameter for the numberings.
    pub numbered_r: Vec<f64>,
    /// Number of nested meshes for the counts.
    pub levels: usize,
    /// Limit on iterations.
    pub max_iterations: usize,
    /// Number of refinements of the disc.
    pub disc: usize,
    /// Number of refinements of the cube.
    pub cube: usize,
}

/// Domain of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DomainPlan {
    /// Built-in domain.
    pub name: String,
    /// f, as text.
    pub f: String,
    /// Number of refinements of the coarsest mesh on which the counts begin.
    pub first: usize,
    /// Number of refinements for the cost.
    pub refinements: usize,
}

impl Default for DomainsPlan {
    fn default() -> Self {
        let domain = |name: &str, f: &str, first, refinements| DomainPlan {
            name: name.into(),
            f: f.into(),
            first,
            refinements,
        };
        Self {
            domains: vec![
                domain("square", "rect(-1,0,-1,0)=-6; else=1.5", 1, 6),
                domain("lshape", "rect(-1,0,-1,0)=3; else=-2", 0, 6),
                domain("disc", "rect(-1,0,-1,0)=-6; else=1", 0, 7),
                domain("annulus", "rect(-1,0,-1,0)=-6; else=1", 0, 5),
                domain("cube", "box(-1,0,-1,0,-1,0)=-9; else=1", 0, 4),
                domain("ball", "box(-1,0,-1,0,-1,0)=-9; else=1", 0, 4),
            ],
            r: vec![0.1, 1.0, 10.0, 1e4],
            numbered_r: vec![1.0, 10.0, 1e4],
            levels: 5,
            max_iterations: 200_000,
            disc: 7,
            cube: 5,
        }
    }
}

/// Result of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DomainsFindings {
    /// Convergence on the disc.
    pub disc: Vec<DiscFindings>,
    /// Convergence on the cube.
    pub cube: Vec<KnownLevels<CubeLevel>>,
    /// Counts on nested meshes.
    pub counts: Vec<CountedDomain>,
    /// Counts for other numberings of the disc.
    pub numberings: Vec<NumberingCounts>,
    /// Comparisons of the counts.
    pub summary: CountsSummary,
    /// Cost of multigrid.
    pub cost: Vec<DomainCost>,
    /// Greatest work units to the discretisation error and to the rounding floor.
    pub most: [f64; 2],
    /// Greatest effectivity.
    pub effectivity: f64,
    /// Greatest algebraic error at the discretisation error over the bound.
    pub algebraic: f64,
}

/// A problem with known solution on all meshes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KnownLevels<L> {
    /// Name, as in `exact(name)`.
    pub name: String,
    /// Mesh by mesh.
    pub levels: Vec<L>,
}

/// Cost of multigrid on one domain.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DomainCost {
    /// Name of the domain.
    pub name: String,
    /// f, as text.
    pub f: String,
    /// Nodes of the finest mesh.
    pub nodes: usize,
    /// Work in sweeps of the finest mesh, to the discretisation error and to the rounding floor.
    pub work_units: [f64; 2],
    /// Steps on the finest mesh, to both goals.
    pub steps: [usize; 2],
    /// Algebraic error at the first goal over the guaranteed bound of the whole error, in the energy norm.
    pub algebraic: f64,
    /// KKT residual over the largest load, at the second goal.
    pub relative: f64,
    /// Guaranteed bound of the error over an estimate of the error, extrapolated from the energies on three meshes;
    /// none where the domain changes with the mesh.
    pub effectivity: Option<f64>,
}

/// Runs the experiment.
///
/// # Errors
/// A sentence if a problem cannot be solved.
pub fn domains(plan: &DomainsPlan) -> Result<DomainsFindings, String> {
    let cost: Result<Vec<_>, _> = map(&plan.domains, 1, cost).into_iter().collect();
    let cost = cost?;
    let counts: Result<Vec<_>, _> =
        map(&plan.domains, 1, |domain| counts::counted(domain, plan)).into_iter().collect();
    let mut most = [0.0f64; 2];
    for of in &cost {
        most = [0, 1].map(|goal| of.work_units[goal].max(most[goal]));
    }
    let (counts, numberings) = (counts?, counts::numberings(plan)?);
    Ok(DomainsFindings {
        disc: disc::convergence(plan.disc)?,
        cube: cube::convergence(plan.cube)?,
        summary: CountsSummary::of(&counts, &numberings),
        counts,
        numberings,
        effectivity: cost.iter().filter_map(|of| of.effectivity).fold(0.0, f64::max),
        algebraic: cost.iter().fold(0.0, |most, of| of.algebraic.max(most)),
        cost,
        most,
    })
}

/// Coarsest mesh of a domain.
fn coarsest(name: &str) -> Result<AnyMesh, String> {
    AnyMesh::built_in(name).ok_or_else(|| format!("no domain `{name}`"))
}

/// Problem on a domain with some refinements.
fn problem(domain: &DomainPlan, refinements: usize) -> Result<Problem, String> {
    Problem::on_mesh(&coarsest(&domain.name)?, refinements, &domain.f, Law::SIGNORINI)
        .map_err(|e| format!("{}: {e}", domain.name))
}

/// Solves by multigrid to a goal.
fn solved(problem: &Problem, goal: Goal) -> Result<Run, String> {
    let settings = Settings { goal, ..Settings::of(Solver::Multigrid) };
    solve(problem, &settings).map_err(|e| e.to_string())
}

fn cost(domain: &DomainPlan) -> Result<DomainCost, String> {
    let before = |less: usize| -> Result<f64, String> {
        let problem = problem(domain, domain.refinements - less)?;
        Ok(solved(&problem, Goal::RoundingFloor)?.last().energy)
    };
    let coarser = [before(2)?, before(1)?];
    let problem = problem(domain, domain.refinements)?;
    let [rough, exact] =
        [solved(&problem, Goal::DiscretisationError)?, solved(&problem, Goal::RoundingFloor)?];
    // Aitken's extrapolation: the errors of the energy are taken for a geometric sequence.
    let [first, second] = [coarser[0] - coarser[1], coarser[1] - exact.last().energy];
    let remaining = second * second / (first - second);
    let is_polygon = !problem.reserves().contains(&Reserve::Polygon);
    let bounds = problem.bounds(&exact.y).map_err(|e| format!("{}: {e}", domain.name))?;
    Ok(DomainCost {
        name: domain.name.clone(),
        f: domain.f.clone(),
        nodes: exact.y.len(),
        work_units: [&rough, &exact].map(|run| run.last().end.work_units),
        steps: [&rough, &exact].map(|run| run.last().end.iterations),
        algebraic: (2.0 * (rough.last().energy - exact.last().energy).max(0.0)).sqrt()
            / bounds.error[1],
        relative: exact.last().kkt.relative,
        effectivity: is_polygon.then(|| bounds.error[1] / (2.0 * remaining).sqrt()),
    })
}
