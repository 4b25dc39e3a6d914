//! Every solver brought to the same shape of answer.

use super::Solver;
use super::accuracy::{Accuracy, FIRST};
use super::answer::{Answer, Level, Solved};
use super::domain::{Domain, square};
use super::problem::Problem;
use crate::discrete::kkt::Judgement;
use crate::discrete::norms::{largest, sum};
use crate::multigrid::active_set::{self, active_set};
use crate::multigrid::cube::Cube;
use crate::multigrid::square::Square;
use crate::multigrid::{self, Goal, InputError, MultigridOutcome, MultigridParams, MultigridStop};
use crate::pipeline::error::{Error, Result};
use crate::saddle::{self, Pair, Params, SaddleRun, StopReason, on_nested, tolerance};
use std::time::Instant;

impl Problem {
    pub(super) fn solve(&self) -> Result<Answer> {
        let start = Instant::now();
        let grids = if self.solver.is_nested() { &self.grids[..] } else { &[self.finest()] };
        let loads: Vec<_> = grids.iter().map(|&n| self.domain.load(n)).collect();
        let setup = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let solved = if self.solver.is_nested() {
            self.on_nested_grids(&loads)?
        } else {
            self.on_finest_grid(&loads[0])?
        };
        let seconds = [setup, start.elapsed().as_secs_f64()];
        Ok(Answer::new(self, solved, &loads[loads.len() - 1], seconds))
    }

    /// Solves on one grid after the other until what is guaranteed is enough. Coarser grids cost less than
    /// the last one together.
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
            let reached = accuracy.reached(bounds);
            if reached <= accuracy.wanted() || answer.failure.is_some() {
                answer.solved.levels = levels;
                return Ok(answer);
            }
            tried.push((finest, reached));
            finest = accuracy.next(&tried)?;
        }
    }

    /// Runs a saddle-point method over the nested grids of the square.
    fn on_nested_grids(&self, loads: &[Vec<f64>]) -> Result<Solved> {
        let grids: Vec<_> = self.grids.iter().map(|&n| square(n)).collect();
        let (outcomes, pair) =
            on_nested(&grids, loads, self.prolongation, |level, grid, load, pair| {
                let params = Params { tolerance: tolerance(level), ..self.params };
                let method = self.solver.method(params.tolerance);
                let run = saddle::solve(grid, load, method, &params, pair, None);
                (run, run.outcome.stop)
            });
        if let Some(SaddleRun { outcome: end, .. }) =
            outcomes.last().filter(|run| run.outcome.stop == StopReason::Diverged)
        {
            return Err(Error::Stage(vec![format!(
                "{}: {} diverged on grid 1/{} after {} iterations; choose a smaller r or scale f down",
                self.name(),
                self.solver,
                end.cells,
                end.iterations
            )]));
        }
        let level = |&SaddleRun { outcome: end, sweeps }: &SaddleRun| Level {
            cells: end.cells,
            iterations: end.iterations,
            sweeps: Some(sweeps),
            stop: end.stop.to_string(),
            energy: end.energy,
            sum_load: end.sum_load,
            kkt: end.kkt,
        };
        let levels = outcomes.iter().map(level).collect();
        let judgement = self.domain.judge(self.finest(), &pair.y, &loads[loads.len() - 1]);
        Ok(self.solved(levels, pair.y, judgement, None))
    }

    /// Runs a solver that works on the finest grid alone.
    fn on_finest_grid(&self, load: &[f64]) -> Result<Solved> {
        let n = self.finest();
        let goal = match (self.accuracy, self.tolerance) {
            (Some(Accuracy::Error(_)), _) => Goal::DiscretisationError,
            (None, Some(tolerance)) => Goal::Kkt(tolerance * largest(load)),
            // The bracket of the energy is far narrower than the error is large.
            _ => Goal::RoundingFloor,
        };
        let params = MultigridParams { goal, ..MultigridParams::default() };
        let by_cycles = |(y, o): (_, MultigridOutcome)| (y, o.cycles, o.stop, Some(o.work_units));
        let by_steps = |(y, o): (_, active_set::Outcome)| (y, o.steps, o.stop, None);
        let solved = match (&self.domain, self.solver) {
            (Domain::Square { .. }, Solver::Multigrid) => {
                multigrid::solve_square(n, load, None, &params).map(by_cycles)
            }
            (Domain::Cube { .. }, Solver::Multigrid) => {
                multigrid::solve_cube(n, load, None, &params).map(by_cycles)
            }
            (Domain::Square { .. }, _) => active_set::<Square>(n, load).map(by_steps),
            (Domain::Cube { .. }, _) => active_set::<Cube>(n, load).map(by_steps),
        };
        let (y, iterations, stop, work_units) = solved.map_err(|e| self.refused(&e))?;
        if stop == MultigridStop::Diverged {
            let name = self.name();
            return Err(Error::Stage(vec![format!("{name}: the solver diverged; scale f down")]));
        }
        let judgement = self.domain.judge(n, &y, load);
        let Judgement { kkt, energy, .. } = judgement;
        let level = Level {
            cells: n,
            iterations,
            sweeps: None,
            stop: stop.name().into(),
            energy,
            sum_load: sum(load),
            kkt,
        };
        Ok(self.solved(vec![level], y, judgement, work_units))
    }

    /// The solution with the multiplier that follows from it, whatever multiplier the solver carried along.
    fn solved(
        &self,
        levels: Vec<Level>,
        y: Vec<f64>,
        judgement: Judgement,
        work_units: Option<f64>,
    ) -> Solved {
        let n = self.finest();
        let measure = (n as f64).powi(1 - i32::from(self.domain.dimension()));
        let a = judgement.multiplier(self.domain.boundary(n), &y, measure);
        Solved { levels, pair: Pair { y, a }, flux: judgement.flux, work_units }
    }

    /// That no nodal vector solves the discrete problem for a load vector with this sum; whichever solver finds it,
    /// the answer is none.
    pub(super) fn without_solution(&self, sum_load: f64) -> String {
        let lower = match self.domain {
            Domain::Square { .. } => "use --load exact, another --h, or a lower f",
            Domain::Cube { .. } => "lower f somewhere",
        };
        let (name, n) = (self.name(), self.finest());
        format!(
            "{name}: the load vector sums to {sum_load:+.3e} on grid 1/{n}, where the discrete problem has no solution; {lower}"
        )
    }

    fn refused(&self, e: &InputError) -> Error {
        let option = if self.domain.dimension() == 2 { "--f" } else { "--cube" };
        let place = self.scene.as_deref().unwrap_or(option);
        match e {
            InputError::NotCoercive(sum) => Error::Stage(vec![self.without_solution(*sum)]),
            InputError::GridSize(..) => Error::input(format!("--h: {e}; choose another")),
            _ => Error::input(format!("{place}: {e}; check f")),
        }
    }
}
