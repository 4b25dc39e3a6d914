//! Cost of multigrid on other domains than the square.

use super::{Findings, Rows};
use crate::levels::{Problem, Reserve};
use crate::machine::threads::try_map;
use crate::mesh::AnyMesh;
use crate::multigrid::Goal;
use crate::problem::law::Law;
use crate::solvers::{FoundSolution, Refusal, Run, Settings, Solver, find, solve};
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct DomainsPlan {
    /// Domains with their f.
    domains: Vec<DomainPlan>,
}

/// Domain of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct DomainPlan {
    /// Built-in domain.
    name: String,
    /// f, as text.
    f: String,
    /// Number of refinements for the cost.
    refinements: usize,
}

impl DomainPlan {
    fn new(name: &str, f: &str, refinements: usize) -> Self {
        Self { name: name.into(), f: f.into(), refinements }
    }
}

impl Default for DomainsPlan {
    fn default() -> Self {
        Self {
            domains: vec![
                DomainPlan::new("square", "rect(-1,0,-1,0)=-6; else=1.5", 6),
                DomainPlan::new("lshape", "rect(-1,0,-1,0)=3; else=-2", 6),
                DomainPlan::new("disc", "rect(-1,0,-1,0)=-6; else=1", 7),
                DomainPlan::new("annulus", "rect(-1,0,-1,0)=-6; else=1", 5),
                DomainPlan::new("cube", "box(-1,0,-1,0,-1,0)=-9; else=1", 4),
                DomainPlan::new("ball", "box(-1,0,-1,0,-1,0)=-9; else=1", 4),
            ],
        }
    }
}

/// Cost of multigrid on one domain.
#[derive(Serialize)]
struct DomainCost {
    /// Name of the domain.
    name: String,
    /// f, as text.
    f: String,
    /// Nodes of the finest mesh.
    nodes: usize,
    /// Work in sweeps of the finest mesh to the discretisation error.
    rough_work: f64,
    /// Steps on the finest mesh to the discretisation error.
    rough_steps: usize,
    /// Algebraic error there over the guaranteed bound of the whole error, in the energy norm.
    algebraic: f64,
    /// Work in sweeps of the finest mesh to the rounding floor.
    floor_work: f64,
    /// Steps on the finest mesh to the rounding floor.
    floor_steps: usize,
    /// KKT residual over the largest load at the rounding floor.
    relative: f64,
    /// Guaranteed bound of the error over the root of twice the difference of the energy from the true one, which is no
    /// less than the error; in space the true energy is extrapolated from three meshes. None where the domain changes
    /// with the mesh.
    effectivity: Option<f64>,
}

/// Runs the experiment: table `cost` of multigrid.
///
/// # Errors
/// A sentence if a problem cannot be solved.
pub(super) fn domains(plan: &DomainsPlan) -> Result<Findings, String> {
    Ok(Findings::from([("cost".into(), Rows::of(try_map(&plan.domains, cost)?))]))
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
    let problem = problem(domain, domain.refinements)?;
    let [rough, exact] =
        [solved(&problem, Goal::DiscretisationError)?, solved(&problem, Goal::RoundingFloor)?];
    let is_constant = !problem.reserves().contains(&Reserve::Polygon);
    let remaining = match is_constant {
        true => Some(exact.last().energy - true_energy(domain, &problem, exact.last().energy)?),
        false => None,
    };
    let bounds = problem.bounds(&exact.y).map_err(|e| format!("{}: {e}", domain.name))?;
    Ok(DomainCost {
        name: domain.name.clone(),
        f: domain.f.clone(),
        nodes: exact.y.len(),
        rough_work: rough.last().end.work_units,
        rough_steps: rough.last().end.iterations,
        algebraic: (2.0 * (rough.last().energy - exact.last().energy).max(0.0)).sqrt()
            / bounds.error[1],
        floor_work: exact.last().end.work_units,
        floor_steps: exact.last().end.iterations,
        relative: exact.last().kkt.relative,
        effectivity: remaining.map(|remaining| bounds.error[1] / (2.0 * remaining).sqrt()),
    })
}

/// True energy of a problem on a domain; in space, where only that of its finest mesh is known, by Aitken's
/// extrapolation: the errors of the energy are taken for a geometric sequence.
fn true_energy(domain: &DomainPlan, problem: &Problem, on_finest: f64) -> Result<f64, String> {
    match find(problem, &Settings::of(Solver::Spectral), &mut ()) {
        Ok(FoundSolution::Truth(found)) => return Ok(found.energy),
        Err(Refusal::NotInSpace(_)) | Ok(_) => (),
        Err(e) => return Err(format!("{}: {e}", domain.name)),
    }
    let mut coarser = Vec::new();
    for less in [2, 1] {
        let problem = self::problem(domain, domain.refinements - less)?;
        coarser.push(solved(&problem, Goal::RoundingFloor)?.last().energy);
    }
    let [first, second] = [coarser[0] - coarser[1], coarser[1] - on_finest];
    Ok(on_finest - second * second / (first - second))
}
