//! Judgement of an answer: the failure, if it is no solution, and the warnings.

use super::advice::{Remedy, Warning, remedies};
use super::answer::Answer;
use super::bound::{self, BoundaryWords};
use super::request::{BILINEAR_LOAD, EXACT_LOAD, Request};
use crate::cli::shown::signed;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::verdict::Verdict;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::text::{Written, plain};
use signorini_mathematics::saddle::tolerance;

/// Cells per side above which a coarsest grid is finer than those for which the stopping rule is made.
const COARSE: usize = 8;
/// Remedy for nested grids that begin with a fine one.
const COARSER_GRIDS: Remedy =
    Remedy::new("choose 1/(2^k m), such as 1/64, or --solver multigrid", "--solver multigrid");
/// Error of the sum of the load vector of a formula, over the integral of |f|, that gets no warning on any grid.
const RESOLVED: f64 = 1e-2;
/// Error over the integral of |f| of the quadrature from which on a warning is given.
const MISSED: f64 = 1e-3;

impl Answer {
    /// Decides whether the answer is a solution, and collects the warnings.
    pub(super) fn judge(&mut self, request: &Request) {
        let (name, problem) = (&request.name, &self.solved.problem);
        let accuracy = request.statement.accuracy();
        let grid = problem.name(problem.finest());
        let Some(&last) = self.solved.ends().last() else { return };
        let (relative, mut unsolved) = (last.kkt.relative, None);
        let mut warnings = Vec::new();
        match last.judged(accuracy.is_some()) {
            Verdict::NoSolution => self.failure = Some(self.without_solution(request)),
            Verdict::CutOff(stop) => {
                let fact = format!("{name}: stopped at the {stop} on {grid}");
                self.failure = Some(Warning::new(fact, request.after_limit()));
            }
            Verdict::NotSolved(violation) => {
                let fact =
                    format!("{name}: the solver stopped as asked on {grid}, but {violation}");
                unsolved = Some(fact);
            }
            Verdict::Rough => warnings.push(Warning::new(
                format!("the KKT residual on {grid} is {relative:.2} of the load"),
                request.closer(),
            )),
            Verdict::Solved => (),
        }
        warnings.extend(problem.levels().facts().notes.iter().cloned().map(Warning::fact));
        warnings.extend(problem.note_on_curves().map(Warning::fact));
        self.warnings = warnings;
        self.warn_of_levels(request, &last);
        self.warn_of_tolerance(request, &last);
        self.warn_of_load(request, &last);
        if let Some(fact) = unsolved {
            let remedies = [vec![request.closer()], remedies(&self.warnings)].concat();
            self.failure = Some(Warning { fact, remedies });
        }
        if self.failure.is_none() {
            self.warn_of_force(request, &last);
        }
        match (self.bounds(), accuracy, &self.failure) {
            (Some(bounds), None, None) => {
                self.warnings.extend(bound::warnings(bounds, last.energy, request));
            }
            (_, Some(accuracy), None) => {
                let shortfall = request.voice.shortfall(accuracy, &self.solved);
                self.shortfall = shortfall.map(|of| {
                    Warning::new(format!("{name}: {}", of.fact), Remedy::new(of.remedy, ""))
                });
            }
            _ => {}
        }
    }

    /// Returns the message that the discrete problem on the finest level, or on all levels, has no solution.
    fn without_solution(&self, request: &Request) -> Warning {
        let (ends, problem) = (self.solved.ends(), &self.solved.problem);
        let on_all = ends.iter().all(|end| end.verdict() == Verdict::NoSolution);
        let level = problem.name(problem.finest());
        let Warning { fact, remedies } =
            request.without_solution(&level, ends[ends.len() - 1].sum_load);
        let fact = match ends.len() {
            2.. if on_all => fact.replacen(" on grid ", " (as on all coarser grids) on grid ", 1),
            _ => fact,
        };
        Warning { fact, remedies }
    }

    fn warn_of_levels(&mut self, request: &Request, last: &Outcome) {
        let (problem, ends) = (&self.solved.problem, self.solved.ends());
        let (count, coarsest) = (problem.count(), ends[0].cells);
        if request.statement.solver.is_nested()
            && let Some(coarsest) = coarsest.filter(|&cells| cells > COARSE)
        {
            let what = if count == 1 { "has no coarser ones" } else { "begins the nested grids" };
            let fact = format!(
                "grid 1/{coarsest} {what}, and the tolerance is 10^-k on the k-th grid, here {} on the last",
                Written(tolerance(count))
            );
            self.warnings.push(Warning::new(fact, COARSER_GRIDS));
        }
        // Grids that were tried for an accuracy are no levels of the last one.
        let coarse = &ends[ends.len() - ends.len().min(count)..ends.len() - 1];
        let without = |end: &Outcome| end.verdict() == Verdict::NoSolution;
        if !without(last)
            && let Some(grids) = named(problem, coarse, without)
        {
            self.warnings.push(Warning::fact(format!(
                "the load vector sums to a non-negative number on {grids}, where the discrete problem has no solution"
            )));
        }
        let cut_off = |end: &Outcome| !end.end.has_converged();
        if let Some(grids) = named(problem, coarse, cut_off) {
            let fact = format!("the stopping rule was not met on {grids}");
            self.warnings.push(Warning::fact(fact));
        }
    }

    /// Warns if the tolerance asked for was not reached.
    fn warn_of_tolerance(&mut self, request: &Request, last: &Outcome) {
        let stop = last.end.stop;
        if let Some(tolerance) = request.statement.tolerance
            && !last.end.has_converged()
        {
            self.warnings.push(Warning::fact(format!(
                "--tolerance {} was not reached: the KKT residual is {} of the load at the {stop}",
                Written(tolerance),
                plain(last.kkt.relative, 3)
            )));
        }
    }

    /// True if the sum of the load vector misses the integral of f by more than the grid explains.
    pub(super) fn load_misses(&self, last: &Outcome) -> bool {
        let problem = &self.solved.problem;
        let difference = (last.sum_load - problem.levels().facts().integral).abs();
        load_slack(problem).is_some_and(|slack| difference > slack)
    }

    /// Warns if the load vector belongs to another f.
    fn warn_of_load(&mut self, request: &Request, last: &Outcome) {
        let (problem, levels) = (&self.solved.problem, self.solved.problem.levels());
        let grid = problem.name(problem.finest());
        if self.load_misses(last) {
            let facts = levels.facts();
            let [integral, sum_load] = [facts.integral, last.sum_load].map(|sum| signed(sum, 4));
            let (reason, remedy) = if facts.by_quadrature {
                ("its points miss some of f", Remedy::new("choose a smaller --h", ""))
            } else {
                ("values at the nodes miss where f jumps", EXACT_LOAD)
            };
            let fact = format!(
                "the load vector sums to {sum_load} on {grid}, the integral of f is {integral}: {reason}"
            );
            self.warnings.push(Warning::new(fact, remedy));
        } else if let Some(missed) = levels.missed().filter(|&missed| missed > MISSED) {
            let missed = plain(missed, 2);
            self.warnings.push(Warning::new(
                format!("the quadrature of f on {grid} misses {missed} of the integral of |f|"),
                request.remedies.quadrature,
            ));
        } else if let Some(moved) = request.note_on_jumps(problem) {
            self.warnings.push(Warning::new(moved, BILINEAR_LOAD));
        }
    }

    /// Warns if the flux through the boundary does not balance the load: at the discrete solution their sum is zero up
    /// to rounding.
    ///
    /// A difference counts where it exceeds the error of the grid and the error that the user accepts.
    fn warn_of_force(&mut self, request: &Request, last: &Outcome) {
        let problem = &self.solved.problem;
        let (force, load) = (self.force, 0.0 - last.sum_load);
        let size = problem.levels().facts().size.abs();
        let accepted = request.statement.accuracy().map_or(0.0, Accuracy::error) * size;
        let slack = slack(problem).max(accepted);
        // A fixed part of the boundary bears the rest.
        let balanced =
            problem.domain(problem.finest()).has_fixed_part() || (force - load).abs() <= slack;
        if !balanced {
            let words = BoundaryWords::of(problem.law());
            self.warnings.push(Warning::new(words.unbalanced(force, load), request.closer()));
        }
    }
}

/// Returns the difference of forces that the finest level explains: the square of h over the size of the domain, times
/// the integral of |f|.
fn slack(problem: &Problem) -> f64 {
    let facts = problem.levels().facts();
    facts.size.abs() * (facts.width / facts.extent).powi(2)
}

/// Returns the difference between the sum of a load vector and the integral of f that the grid explains; none for known
/// solutions.
fn load_slack(problem: &Problem) -> Option<f64> {
    let facts = problem.levels().facts();
    // Values at the nodes of a smooth f are off by some multiple of h^2, the others by less.
    let slack = if facts.by_quadrature {
        (4.0 * slack(problem)).max(RESOLVED * facts.size)
    } else {
        slack(problem)
    };
    facts.known.is_none().then_some(slack)
}

/// Returns the names of the levels of the ends with a property, if there are any; the first end is on the coarsest
/// level.
fn named(
    problem: &Problem,
    ends: &[Outcome],
    property: impl Fn(&Outcome) -> bool,
) -> Option<String> {
    // Adapted meshes are more than those on which a solution was sought.
    let level = |end: &Outcome| {
        (0..problem.count()).find(|&level| problem.domain(level).nodes() == end.nodes)
    };
    let name = |end: &Outcome| match end.cells {
        Some(_) => end.label(),
        None => level(end).map_or_else(|| end.label(), |level| problem.name(level)),
    };
    let names: Vec<_> = ends.iter().filter(|end| property(end)).map(name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}
