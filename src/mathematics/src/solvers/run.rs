//! One function per kind of solver that hands it a problem, on the square or on a mesh.

use super::{Refusal, SaddleSettings, Settings, Solver};
use crate::discrete::domain::DiscreteDomain;
use crate::discrete::end::{End, Outcome, Stop};
use crate::discrete::kkt::Judgement;
use crate::discrete::nested::DiscreteLevels;
use crate::discrete::network::Network;
use crate::levels::{Problem, ProblemError, read};
use crate::mesh::{BuiltIn, PlaneMesh};
use crate::multigrid::active_set::active_set as solve_by_states;
use crate::multigrid::{Goal, InputError, MultigridParams};
use crate::multilevel::solve_nested_networks;
use crate::problem::source::Source;
use crate::saddle::{Monitor, NestedRun, Pair, Params, solve_nested_together};
use crate::spectral::{PlaneError, TrueSolution, check_plane, true_solution_on};
use crate::square::multigrid::solve_square;
use std::borrow::Cow;

/// Run of a solver on levels.
pub struct Run {
    /// Solver that found the vector: multigrid leaves to the active set what its steps do not solve.
    pub solver: Solver,
    /// Nodal vector of the finest level.
    pub y: Vec<f64>,
    /// End on each level on which the solver stopped, coarsest first; the last may be `Diverged`.
    pub ends: Vec<Outcome>,
    /// Number of the level of the first end, of adapted meshes its position among them; the others follow.
    pub first_level: usize,
    /// Judgement of the vector.
    pub judgement: Judgement,
}

impl Run {
    /// Nodal vector with the multiplier that follows from it, not with one of the solver.
    pub fn pair(&self) -> Pair {
        Pair { y: self.y.clone(), a: self.judgement.multiplier(&self.y) }
    }

    /// End on the finest level.
    pub fn last(&self) -> &Outcome {
        &self.ends[self.ends.len() - 1]
    }
}

/// Solution as a solver found it.
#[expect(clippy::large_enum_variant, reason = "one value for each solve")]
pub enum FoundSolution {
    /// Nodal vector of the finest level.
    Vector(Run),
    /// The true solution, without a level.
    Truth(Box<TrueSolution>),
}

impl FoundSolution {
    /// Run whose vector is that on the finest level; of a true solution, its values at the nodes.
    pub(super) fn on_levels(self, problem: &Problem) -> Run {
        match self {
            Self::Vector(run) => run,
            Self::Truth(found) => {
                let (y, end) = (found.at_nodes(problem).y, End::converged(found.steps));
                judged(problem, Solver::Spectral, y, end)
            }
        }
    }
}

impl TrueSolution {
    /// v at the nodes of the finest level of a problem, and the multiplier at the boundary nodes where the law holds.
    ///
    /// # Panics
    /// If the problem is in space.
    pub fn at_nodes(&self, problem: &Problem) -> Pair {
        let level = problem.finest();
        let mesh = problem.levels().mesh(level);
        let mesh = mesh.plane().expect("true solutions are in the plane");
        let points = mesh.points();
        let (mut y, mut a) = (self.values(points), Vec::new());
        // Where functions are singular, at corners, the boundary alone has their values.
        let free = mesh.facets().iter().filter(|facet| mesh.law(facet).is_free());
        for node in free.flat_map(|facet| facet.nodes).map(|node| node as usize) {
            [y[node], _] = self.on_boundary(points[node]);
        }
        for contact in problem.domain(level).contact().iter() {
            let [value, flux] = self.on_boundary(points[contact.node]);
            // What violates the law is an error of the method, which must not be taken for penetration.
            let law = contact.law;
            y[contact.node] = if law.hi().is_infinite() { value.max(law.at()) } else { value };
            a.push(contact.law.project(flux));
        }
        let fixed = mesh.facets().iter().filter(|facet| mesh.law(facet).is_fixed());
        for facet in fixed {
            facet.nodes.iter().for_each(|&node| y[node as usize] = mesh.law_at(facet, node).at());
        }
        Pair { y, a }
    }
}

/// Judges a vector of the finest level.
fn judged(problem: &Problem, solver: Solver, y: Vec<f64>, end: End) -> Run {
    let (load, level) = (problem.load(), problem.finest());
    let judgement = problem.judge(&y);
    let cells = problem.domain(level).cells();
    let end = Outcome::new(end, &judgement, cells, load, problem.is_solvable());
    Run { solver, y, ends: vec![end], first_level: level, judgement }
}

/// Solves on the finest level by multigrid, until a goal is reached: on the square by that of optimal cost, on meshes
/// by the multilevel method.
pub(super) fn multigrid(
    problem: &Problem,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<FoundSolution, Refusal> {
    let params = MultigridParams { goal: settings.goal, ..MultigridParams::default() };
    let load = problem.load();
    let solved = match problem.levels().discrete() {
        DiscreteLevels::Grids(grids, law) => {
            solve_square(grids[problem.finest()].cells(), law, load, &params)
        }
        DiscreteLevels::Networks(networks) => solve_nested_networks(networks, load, &params),
    };
    let dimension = problem.levels().facts().dimension;
    match &solved {
        Ok((y, end)) if end.stop == Stop::IterationLimit && has_factors(dimension, y.len()) => {
            by_factors(problem, Some(y), monitor)
        }
        _ => on_finest(problem, Solver::Multigrid, solved),
    }
}

/// True if factors solve what steps have left at their limit, as they may on some stretched meshes: on so few nodes.
pub(super) fn has_factors(dimension: u8, nodes: usize) -> bool {
    Solver::ActiveSet.check_nodes(dimension, nodes as f64).is_ok()
}

/// Solves on the finest level by the primal-dual active set, until the contact set is at rest.
pub(super) fn active_set(
    problem: &Problem,
    _: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<FoundSolution, Refusal> {
    by_factors(problem, None, monitor)
}

/// Solves by the primal-dual active set, from the states of a vector near the solution, if there is one.
fn by_factors(
    problem: &Problem,
    start: Option<&[f64]>,
    monitor: &mut dyn Monitor,
) -> Result<FoundSolution, Refusal> {
    let load = problem.load();
    monitor.factors(load.len());
    let network = match problem.domain(problem.finest()) {
        DiscreteDomain::Grid(grid, law) => &Network::of_square(grid, law),
        DiscreteDomain::Network(network) => network,
    };
    on_finest(problem, Solver::ActiveSet, solve_by_states(network, load, start))
}

/// Judges what a solver returned on the finest level.
fn on_finest(
    problem: &Problem,
    solver: Solver,
    solved: Result<(Vec<f64>, End), InputError>,
) -> Result<FoundSolution, Refusal> {
    let (y, end) = solved.map_err(|e| Refusal::on_finest(problem, e))?;
    Ok(FoundSolution::Vector(judged(problem, solver, y, end)))
}

/// Runs a saddle-point method over all levels, until its stopping rule is met, or on each the KKT residual that is
/// asked for.
pub(super) fn saddle(
    problem: &Problem,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<FoundSolution, Refusal> {
    Ok(saddle_together(problem, &[*settings], &mut [monitor])?.swap_remove(0))
}

/// Runs saddle-point methods, as [`saddle`], each with its observer: on the square side by side.
pub(crate) fn saddle_together(
    problem: &Problem,
    settings: &[Settings],
    monitors: &mut [&mut dyn Monitor],
) -> Result<Vec<FoundSolution>, Refusal> {
    let loads = owned_loads(problem)?;
    let runs: Vec<_> = settings.iter().map(|of| nested_run(problem, of, &loads)).collect();
    let found = solve_nested_together(problem.levels().discrete(), &runs, monitors);
    let mut solutions = Vec::with_capacity(settings.len());
    for ((ends, Pair { y, .. }), Settings { solver, .. }) in found.into_iter().zip(settings) {
        let finest = problem.finest();
        // A method that diverged on a coarser level leaves no number on the finest.
        let y = if ends.len() > finest { y } else { vec![f64::NAN; loads[finest].len()] };
        let judgement = problem.judge_on(finest, &y, &loads[finest]);
        let run = Run { solver: *solver, y, ends, first_level: 0, judgement };
        solutions.push(FoundSolution::Vector(run));
    }
    Ok(solutions)
}

/// Load vectors of all levels.
fn owned_loads(problem: &Problem) -> Result<Vec<Vec<f64>>, Refusal> {
    Ok(problem.loads()?.into_iter().map(Cow::into_owned).collect())
}

/// Run with these load vectors.
fn nested_run<'a>(
    problem: &Problem,
    Settings { solver, saddle, goal }: &Settings,
    loads: &'a [Vec<f64>],
) -> NestedRun<'a> {
    let &SaddleSettings { prolongation, r, stop, max_iterations } = saddle;
    let usual = Params::default();
    let method = solver.entry().method.unwrap_or(usual.method);
    let kkt = match goal {
        Goal::Kkt(bound) => Some(bound / problem.unit()),
        _ => None,
    };
    let params = Params { method, r, rule: stop, kkt, max_iterations, prolongation, ..usual };
    NestedRun { loads, params }
}

impl Problem {
    /// Iterations of the paper's method on each level, for each r: with all else in these settings, and with load
    /// vectors whose entries `change` has changed, which is given the number of the run and each entry.
    ///
    /// # Errors
    /// [`Refusal::Problem`] if f is not finite at a point of a coarser level.
    pub fn counts(
        &self,
        saddle: SaddleSettings,
        r: &[f64],
        change: &mut dyn FnMut(usize, &mut f64),
    ) -> Result<Vec<Vec<usize>>, Refusal> {
        let mut loads = vec![owned_loads(self)?; r.len()];
        for (number, loads) in loads.iter_mut().enumerate() {
            loads.iter_mut().flatten().for_each(|entry| change(number, entry));
        }
        let mut runs = Vec::new();
        for (&r, loads) in r.iter().zip(&loads) {
            let saddle = SaddleSettings { r, ..saddle };
            let settings = Settings { saddle, ..Settings::of(Solver::ArrowHurwicz) };
            runs.push(nested_run(self, &settings, loads));
        }
        let mut unseen = vec![(); r.len()];
        let mut monitors: Vec<_> = unseen.iter_mut().map(|of| of as &mut dyn Monitor).collect();
        let levels = self.levels().discrete();
        let found = solve_nested_together(levels, &runs, &mut monitors);
        let counts = found.iter().map(|(ends, _)| ends.iter().map(|end| end.end.iterations));
        Ok(counts.map(Iterator::collect).collect())
    }
}

/// Coarsest mesh of a problem in the plane, and f on it, as the spectral solver takes them.
fn on_coarsest<T>(
    problem: &Problem,
    take: impl FnOnce(&PlaneMesh, &[Source]) -> Result<T, PlaneError>,
) -> Result<T, Refusal> {
    let mesh = problem.levels().mesh(0);
    let mesh = mesh.plane().ok_or(Refusal::NotInSpace(Solver::Spectral))?;
    let f = read(mesh, &problem.levels().facts().f).map_err(ProblemError::from)?;
    Ok(take(mesh, &f)?)
}

impl Problem {
    /// True if the spectral solver takes the domain and f, whether or not it then finds the solution.
    pub fn takes_spectral(&self) -> bool {
        on_coarsest(self, check_plane).is_ok()
    }

    /// True solution on a domain in the plane, without a level.
    ///
    /// # Errors
    /// [`Refusal::Spectral`], and [`Refusal::NotInSpace`].
    pub fn true_solution(&self) -> Result<TrueSolution, Refusal> {
        let Some(lattices) = self.lattices() else { return on_coarsest(self, true_solution_on) };
        let square = BuiltIn::Square.plane().expect("the square lies in the plane");
        let mesh = square.with_law(lattices.law());
        let mut found = true_solution_on(&mesh, std::slice::from_ref(lattices.source()))?;
        // The boundary of the square has no parts.
        found.contact.iter_mut().for_each(|arc| arc.part = None);
        found.forces.clear();
        Ok(found)
    }
}

/// Finds the true solution, as the table of solvers has it.
pub(super) fn truth(
    problem: &Problem,
    _: &Settings,
    _: &mut dyn Monitor,
) -> Result<FoundSolution, Refusal> {
    Ok(FoundSolution::Truth(problem.true_solution()?.into()))
}
