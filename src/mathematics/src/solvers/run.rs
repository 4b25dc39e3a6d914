//! One function per kind of solver that hands it a problem, on the square or on a mesh.

use super::{Refusal, Run, Settings, Solver};
use crate::discrete::end::{End, Outcome};
use crate::discrete::stop::Stop;
use crate::levels::{Discrete, NodalVectors, Problem};
use crate::multigrid::active_set::{active_set as solve_lattice, active_set_on};
use crate::multigrid::{InputError, MultigridParams, solve_square};
use crate::multilevel::solve_nested_networks;
use crate::saddle::{Monitor, NestedGrids, Params, solve_nested};
use crate::spectral::{TrueSolution, true_solution};
use std::borrow::Cow;

/// What a solver found.
pub enum Found {
    /// Nodal vector of the finest level.
    Vector(Run),
    /// The true solution, without a level.
    Truth(TrueSolution),
}

impl Found {
    /// Run whose vector is that on the finest level; of a true solution, its values at the nodes.
    pub(super) fn run(self, problem: &Problem) -> Run {
        match (self, problem.lattices()) {
            (Self::Vector(run), _) => run,
            (Self::Truth(found), lattices) => {
                let lattices = lattices.expect("true solutions are on the square");
                let y = found.solution.on_grid(lattices.finest()).y;
                judged(problem, y, End::converged(found.steps))
            }
        }
    }
}

/// Judges a vector of the finest level.
fn judged(problem: &Problem, y: Vec<f64>, end: End) -> Run {
    let (levels, load, level) = (problem.levels(), problem.load(), problem.finest());
    let judgement = problem.judge(&y);
    let has_solution = levels.is_solvable(level, problem.law(), load);
    let end = Outcome::new(end, &judgement, levels.cells(level), load, has_solution);
    Run { y, ends: vec![end], first_level: level, judgement }
}

/// Solves on the finest level by multigrid, until a goal is reached: on the square by that of optimal cost, on meshes
/// by the multilevel method.
pub(super) fn multigrid(
    problem: &Problem,
    settings: &Settings,
    _: &mut dyn Monitor,
) -> Result<Found, Refusal> {
    let params = MultigridParams { goal: settings.goal, ..MultigridParams::default() };
    let (levels, loaded) = (problem.levels(), problem.law().with_load(problem.load()));
    let (y, end) = match levels.discrete() {
        Discrete::Lattices(lattices) => {
            solve_square(lattices.finest().cells(), loaded, None, &params)?
        }
        Discrete::Networks(networks) => solve_nested_networks(networks, loaded, &params)?,
    };
    // Some meshes are stretched too much: factors solve those that are small enough.
    let nodes = levels.nodes(problem.finest()) as f64;
    let can_factor = Solver::ActiveSet.check_nodes(levels.dimension(), nodes).is_ok();
    let (y, end) = match end.stop {
        Stop::IterationLimit if can_factor => contact_set(problem)?,
        _ => (y, end),
    };
    Ok(Found::Vector(judged(problem, y, end)))
}

/// Solves on the finest level by the primal-dual active set, until the contact set is at rest.
pub(super) fn active_set(
    problem: &Problem,
    _: &Settings,
    _: &mut dyn Monitor,
) -> Result<Found, Refusal> {
    let (y, end) = contact_set(problem)?;
    Ok(Found::Vector(judged(problem, y, end)))
}

fn contact_set(problem: &Problem) -> Result<(Vec<f64>, End), InputError> {
    let (law, load) = (problem.law(), problem.load());
    match problem.levels().discrete() {
        Discrete::Lattices(lattices) => solve_lattice(lattices.finest().cells(), law, load),
        Discrete::Networks(networks) => {
            active_set_on(&networks[problem.finest()].network, law, load)
        }
    }
}

/// Runs a saddle-point method over all levels, until its stopping rule is met.
pub(super) fn saddle(
    problem: &Problem,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Found, Refusal> {
    let loads: Vec<Vec<f64>> = problem.loads()?.into_iter().map(Cow::into_owned).collect();
    let loaded = problem.law().with_loads(&loads);
    let method = settings.solver.entry().method.expect("a saddle-point method");
    let params = &Params { method, ..settings.params };
    let (ends, pair) = match problem.levels().discrete() {
        Discrete::Lattices(lattices) => {
            let prolongation = settings.prolongation;
            let nested = NestedGrids { grids: lattices.grids(), prolongation };
            solve_nested(&nested, loaded, params, monitor)
        }
        Discrete::Networks(networks) => solve_nested(networks, loaded, params, monitor),
    };
    let (level, y) = (ends.len() - 1, pair.y);
    let judgement = problem.judge_on(level, NodalVectors { y: &y, load: &loads[level] });
    Ok(Found::Vector(Run { y, ends, first_level: 0, judgement }))
}

/// Finds the true solution on the square, without a level.
pub(super) fn truth(
    problem: &Problem,
    settings: &Settings,
    _: &mut dyn Monitor,
) -> Result<Found, Refusal> {
    let lattices = problem.lattices().ok_or(Refusal::NotOnMeshes(settings.solver))?;
    Ok(Found::Truth(true_solution(problem.law(), lattices.source())?))
}
