//! Judgement of an answer: the failure, if it is no solution, and the warnings.

use super::accuracy::Accuracy;
use super::answer::{Answer, Level};
use super::bound::{self, BoundaryWords};
use super::domain::{Domain, Guarantee};
use super::problem::Problem;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::discrete::verdict::Verdict;
use signorini_mathematics::saddle::tolerance;

/// Cells per side above which a coarsest grid is finer than those for which the stopping rule is made.
const COARSE: usize = 8;

impl Answer {
    /// Decides whether the answer is a solution, and collects the warnings.
    pub(super) fn judge(&mut self, problem: &Problem) {
        let (name, grid) = (problem.name(), problem.domain.grid(problem.finest()));
        let last = self.last();
        let (stop, relative, energy) = (last.stop, last.kkt.relative, last.energy);
        match last.verdict {
            Verdict::NoSolution => self.failure = Some(self.without_solution(problem)),
            _ if stop == Stop::IterationLimit => {
                let remedy = match problem.domain {
                    _ if problem.solver.is_nested() => {
                        "raise --max-iterations, or use --solver multigrid"
                    }
                    Domain::Mesh(_) => problem.closer(),
                    Domain::Square { .. } => "choose another --h",
                };
                self.failure = Some(format!("{name}: stopped at the {stop} on {grid}; {remedy}"));
            }
            // A guaranteed bound has been reached; residuals of single nodes do not contradict it.
            _ if problem.accuracy.is_some() => (),
            Verdict::NotSolved(violation) => {
                self.failure = Some(format!(
                    "{name}: the solver stopped as asked on {grid}, but {violation}; {}",
                    problem.closer()
                ));
            }
            Verdict::Rough => self.warnings.push(format!(
                "the KKT residual on {grid} is {relative:.2} of the load; {}",
                problem.closer()
            )),
            Verdict::Solved => (),
        }
        if let Domain::Mesh(mesh) = &problem.domain {
            self.warnings.extend(mesh.problem.mesh.touching().map(ToString::to_string));
        }
        self.warn_of_grids(problem);
        self.warn_of_tolerance(problem);
        self.warn_of_load(problem);
        if self.failure.is_none() {
            self.warn_of_force(problem);
        }
        if let (Ok(Guarantee { bounds, .. }), None, None) =
            (&self.bounds, problem.accuracy, &self.failure)
        {
            self.warnings.extend(bound::warnings(bounds, energy, problem));
        }
    }

    /// Returns the message that the discrete problem on the finest grid, or on all grids, has no solution.
    fn without_solution(&self, problem: &Problem) -> String {
        let levels = &self.solved.levels;
        let on_all = levels.iter().all(|level| level.verdict == Verdict::NoSolution);
        let message = problem.without_solution(self.last().sum_load);
        match levels.len() {
            2.. if on_all => {
                message.replacen(" on grid ", " (as on all coarser grids) on grid ", 1)
            }
            _ => message,
        }
    }

    fn warn_of_grids(&mut self, problem: &Problem) {
        let (coarsest, count) = (problem.grids[0], problem.grids.len());
        let on_mesh = matches!(problem.domain, Domain::Mesh(_));
        if problem.solver.is_nested() && coarsest > COARSE && !on_mesh {
            let what = if count == 1 { "has no coarser ones" } else { "begins the nested grids" };
            self.warnings.push(format!(
                "grid 1/{coarsest} {what}, and the tolerance is 10^-k on the k-th grid, here {:e} on the last; choose 1/(2^k m), such as 1/64, or --solver multigrid",
                tolerance(count)
            ));
        }
        let coarse = &self.solved.levels[..self.solved.levels.len() - 1];
        if self.last().verdict != Verdict::NoSolution
            && let Some(grids) =
                named(problem, coarse, |level| level.verdict == Verdict::NoSolution)
        {
            self.warnings.push(format!(
                "the load vector sums to a non-negative number on {grids}, where the discrete problem has no solution"
            ));
        }
        if let Some(grids) = named(problem, coarse, |level| level.stop != Stop::Converged) {
            self.warnings.push(format!("the stopping rule was not met on {grids}"));
        }
    }

    /// Warns if the tolerance asked for was not reached.
    fn warn_of_tolerance(&mut self, problem: &Problem) {
        let Level { stop, kkt, .. } = *self.last();
        if let Some(tolerance) = problem.tolerance
            && stop != Stop::Converged
        {
            self.warnings.push(format!(
                "--tolerance {tolerance:e} was not reached: the KKT residual is {:.2e} of the load at the {stop}",
                kkt.relative
            ));
        }
    }

    /// True if the sum of the load vector misses the integral of f by more than the grid explains.
    pub(super) fn load_misses(&self, problem: &Problem) -> bool {
        let difference = (self.last().sum_load - problem.integral).abs();
        problem.domain.load_slack(problem.finest()).is_some_and(|slack| difference > slack)
    }

    /// Warns if the load vector belongs to another f.
    fn warn_of_load(&mut self, problem: &Problem) {
        if self.load_misses(problem) {
            // The sum with zero is never the zero with a minus.
            let [integral, sum_load] =
                [problem.integral, self.last().sum_load].map(|sum| sum + 0.0);
            let grid = problem.domain.grid(problem.finest());
            let reason = if problem.domain.is_smooth() {
                "its points miss some of f; choose a smaller --h"
            } else {
                "values at the nodes miss where f jumps; --load exact does not"
            };
            self.warnings.push(format!(
                "the load vector sums to {sum_load:+.3e} on {grid}, the integral of f is {integral:+.3e}: {reason}"
            ));
        } else if let Some(warning) = problem.domain.quadrature_warning(problem.finest()) {
            self.warnings.push(warning);
        }
    }

    /// Warns if the flux through the boundary does not balance the load: at the discrete solution their sum is zero up to
    /// rounding.
    ///
    /// A difference counts where it exceeds the error of the grid and the error that the user accepts.
    fn warn_of_force(&mut self, problem: &Problem) {
        let (force, load) = (self.force, 0.0 - self.last().sum_load);
        let accepted =
            problem.accuracy.map_or(0.0, Accuracy::error) * problem.domain.integrals()[1].abs();
        let slack = problem.domain.slack(problem.finest()).max(accepted);
        // A fixed part of the boundary bears the rest.
        let balanced = problem.domain.has_fixed_part() || (force - load).abs() <= slack;
        if !balanced {
            let (words, remedy) = (BoundaryWords::of(problem.law), problem.closer());
            self.warnings.push(format!("{}; {remedy}", words.unbalanced(force, load)));
        }
    }
}

/// Returns the names of the grids of the levels with a property, if there are any.
fn named(problem: &Problem, levels: &[Level], property: impl Fn(&Level) -> bool) -> Option<String> {
    let grids: Vec<_> = levels
        .iter()
        .filter(|level| property(level))
        .map(|level| match problem.domain {
            Domain::Mesh(_) => problem.domain.grid(level.number),
            Domain::Square { .. } => problem.domain.row(level.number),
        })
        .collect();
    (!grids.is_empty()).then(|| grids.join(", "))
}
