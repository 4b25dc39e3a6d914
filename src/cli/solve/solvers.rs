//! Calls of every solver, all with answers of one type.

use super::accuracy::{Accuracy, FIRST, TriedGrid};
use super::answer::{Answer, Level, Solved};
use super::domain::{Domain, square};
use super::mesh::MeshDomain;
use super::problem::Problem;
use crate::pipeline::error::{Error, Result};
use crate::replication::scene::BoundaryFlux;
use signorini_mathematics::discrete::kkt::Judgement;
use signorini_mathematics::discrete::norms::{largest, sum};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::discrete::verdict::Verdict;
use signorini_mathematics::multigrid::active_set::active_set_on;
use signorini_mathematics::multigrid::{Goal, InputError, MultigridParams};
use signorini_mathematics::multilevel::solve_nested_networks;
use signorini_mathematics::problem::law::LawError;
use signorini_mathematics::saddle::{NestedGrids, NestedLevels, Params, solve_nested};
use signorini_mathematics::solvers::{FinestRun, SolveOnGrid, Solver, SolverRun};
use std::borrow::Cow;
use std::time::Instant;

impl Problem {
    pub(super) fn solve(&self) -> Result<Answer> {
        let start = Instant::now();
        let run = self.solver.entry().run;
        let loads: Vec<_> = match (&self.domain, self.solver.is_nested()) {
            (_, false) => Vec::new(),
            (Domain::Mesh(mesh), true) => mesh.loads()?,
            _ => self.grids.iter().map(|&n| self.domain.load(n).into_owned()).collect(),
        };
        let finest = match loads.last() {
            Some(load) => Cow::from(load),
            None => self.domain.load(self.finest()),
        };
        let setup = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let solved = match (run, &self.domain) {
            (SolverRun::Finest { square, .. }, Domain::Square { .. }) => {
                self.on_finest_grid(square, &finest)?
            }
            (SolverRun::Finest { cube, .. }, Domain::Cube { .. }) => {
                self.on_finest_grid(cube, &finest)?
            }
            (SolverRun::Nested { .. }, Domain::Mesh(mesh)) => {
                self.on_nested(&mesh.problem.levels[..], &loads)?
            }
            (_, Domain::Mesh(mesh)) => self.on_finest_mesh(mesh, &finest)?,
            _ => {
                let grids: Vec<_> = self.grids.iter().map(|&n| square(n)).collect();
                let prolongation = self.prolongation;
                self.on_nested(&NestedGrids { grids: &grids, prolongation }, &loads)?
            }
        };
        let seconds = [setup, start.elapsed().as_secs_f64()];
        Ok(Answer::new(self, solved, &finest, seconds))
    }

    /// Solves on one grid after the other until the guaranteed bound is small enough. All coarser grids together cost
    /// less than the last one.
    pub(super) fn solve_to(&mut self, accuracy: Accuracy) -> Result<Answer> {
        accuracy.check()?;
        let (mut finest, mut tried, mut levels) = (FIRST, Vec::new(), Vec::new());
        loop {
            self.grids = vec![finest];
            self.check_memory()?;
            let mut answer = self.solve()?;
            levels.append(&mut answer.solved.levels);
            let bounds = answer.bounds.as_ref().map_err(|reason| {
                Error::input(format!("{accuracy}: no bound of the error: {reason}; scale f"))
            })?;
            let reached = accuracy.reached(&bounds.bounds);
            if reached <= accuracy.wanted() || answer.failure.is_some() {
                answer.solved.levels = levels;
                return Ok(answer);
            }
            tried.push(TriedGrid { cells: finest, reached });
            finest = accuracy.next(&tried)?;
        }
    }

    /// Runs a saddle-point method over nested grids or meshes.
    fn on_nested<L: NestedLevels + ?Sized>(
        &self,
        nested: &L,
        loads: &[Vec<f64>],
    ) -> Result<Solved> {
        let method = self.solver.method(0.0, false).expect("a saddle-point method");
        let params = Params { method, ..self.params };
        let (outcomes, pair) = solve_nested(nested, self.law.with_loads(loads), &params, &mut ());
        let mut levels = Vec::new();
        for (&number, outcome) in self.grids.iter().zip(&outcomes) {
            if outcome.stop == Stop::Diverged {
                return Err(self.diverged(number, outcome.iterations));
            }
            levels.push(Level::of_outcome(number, outcome));
        }
        let judgement =
            self.domain.judge(self.finest(), self.law, &pair.y, &loads[loads.len() - 1]);
        Ok(Solved::new(levels, pair.y, judgement, None))
    }

    /// Returns the message that a saddle-point method diverged.
    fn diverged(&self, n: usize, iterations: usize) -> Error {
        let (name, solver, grid) = (self.name(), self.solver, self.domain.grid(n));
        Error::Stage(vec![format!(
            "{name}: {solver} diverged on {grid} after {iterations} iterations; choose a smaller r or scale f down"
        )])
    }

    /// Runs a solver that works on the finest grid alone.
    fn on_finest_grid(&self, solve: SolveOnGrid, load: &[f64]) -> Result<Solved> {
        let run = solve(self.finest(), self.law.with_load(load), &self.multigrid_params(load));
        self.judged(run.map_err(|e| self.refused(&e))?, load)
    }

    /// Runs a solver that works on the finest mesh alone, and multigrid.
    fn on_finest_mesh(&self, mesh: &MeshDomain, load: &[f64]) -> Result<Solved> {
        let problem = &mesh.problem;
        let run = match self.solver {
            Solver::ActiveSet => {
                active_set_on(problem.network(), self.law, load).map(FinestRun::of_active_set)
            }
            _ => {
                let (levels, params) = (&problem.levels, self.multigrid_params(load));
                solve_nested_networks(levels, self.law.with_load(load), &params)
                    .map(FinestRun::of_multigrid)
            }
        };
        self.judged(run.map_err(|e| self.refused(&e))?, load)
    }

    /// Goal of a solver on the finest grid.
    fn multigrid_params(&self, load: &[f64]) -> MultigridParams {
        let goal = match (self.accuracy, self.tolerance) {
            (Some(Accuracy::Error(_)), _) => Goal::DiscretisationError,
            (None, Some(tolerance)) => Goal::Kkt(tolerance * largest(load)),
            // The bracket of the energy is much narrower than the error.
            _ => Goal::RoundingFloor,
        };
        MultigridParams { goal, ..MultigridParams::default() }
    }

    /// Judges a run on the finest grid.
    fn judged(&self, run: FinestRun, load: &[f64]) -> Result<Solved> {
        let n = self.finest();
        let FinestRun { y, iterations, stop, work_units } = run;
        if stop == Stop::Diverged {
            let name = self.name();
            return Err(Error::Stage(vec![format!("{name}: the solver diverged; scale f down")]));
        }
        let judgement = self.domain.judge(n, self.law, &y, load);
        let sum_load = sum(load);
        let level = Level {
            number: n,
            iterations,
            sweeps: None,
            stop,
            energy: judgement.energy,
            sum_load,
            kkt: judgement.kkt,
            verdict: self.verdict(&judgement, sum_load),
        };
        Ok(Solved::new(vec![level], y, judgement, work_units))
    }

    /// Judges whether a nodal vector solves the discrete problem, whose load vector has this sum.
    fn verdict(&self, judgement: &Judgement, sum_load: f64) -> Verdict {
        let flux = BoundaryFlux { law: self.law, perimeter: judgement.perimeter() };
        let has_solution = self.domain.has_solution(sum_load, flux);
        Verdict::new(has_solution, &judgement.kkt, judgement.energy, judgement.work)
    }

    /// Returns the message that no nodal vector solves the discrete problem for a load vector with this sum.
    pub(super) fn without_solution(&self, sum_load: f64) -> String {
        let is_square = matches!(self.domain, Domain::Square { .. });
        let remedy = match (is_square, self.law.is_signorini()) {
            (true, true) => "use --load exact, another --h, or a lower f",
            (true, false) => "use --load exact, another --h, or a wider law",
            (false, true) => "lower f somewhere",
            (false, false) => "change f, or widen the law",
        };
        let (name, grid) = (self.name(), self.domain.grid(self.finest()));
        let sum_load = sum_load + 0.0;
        format!(
            "{name}: the load vector sums to {sum_load:+.3e} on {grid}, where the discrete problem has no \
             solution; {remedy}"
        )
    }

    fn refused(&self, e: &InputError) -> Error {
        let option = if matches!(self.domain, Domain::Cube { .. }) { "--cube" } else { "--f" };
        let place = self.scene.as_deref().unwrap_or(option);
        match e {
            // The integral of f has been judged before.
            InputError::NotCoercive(sum)
            | InputError::Law(LawError::Unbalanced { integral: sum, .. }) => {
                Error::Stage(vec![self.without_solution(*sum)])
            }
            InputError::GridSize { .. } => Error::input(format!("--h: {e}")),
            _ => Error::input(format!("{place}: {e}; check f")),
        }
    }
}
