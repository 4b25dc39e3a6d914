//! Judgement of an answer: the failure, if it is no solution, and the warnings.

use super::adapting;
use super::advice::{Remedy, Warning, remedies};
use super::answer::Answer;
use super::bound::{self, BoundaryWords};
use super::request::{BILINEAR_LOAD, EXACT_LOAD, Request};
use crate::cli::output::moved_jumps;
use crate::cli::shown::signed;
use crate::replication::mesh_files::refusal_of_curves;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::end::{End, Outcome};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::discrete::verdict::Verdict;
use signorini_mathematics::levels::{AdaptedEnd, Problem};
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
        let (name, levels) = (&request.name, request.problem.levels());
        let grid = levels.name(request.problem.finest());
        let last = self.last();
        let (stop, relative, energy) = (last.end.stop, last.kkt.relative, last.energy);
        let mut unsolved = None;
        match last.verdict() {
            Verdict::NoSolution => self.failure = Some(self.without_solution(request)),
            _ if stop == Stop::IterationLimit => {
                let fact = format!("{name}: stopped at the {stop} on {grid}");
                self.failure = Some(Warning::new(fact, request.after_limit()));
            }
            // A guaranteed bound has been reached; residuals of single nodes do not contradict it.
            _ if request.accuracy().is_some() => (),
            Verdict::NotSolved(violation) => {
                let fact =
                    format!("{name}: the solver stopped as asked on {grid}, but {violation}");
                unsolved = Some(fact);
            }
            Verdict::Rough => self.warnings.push(Warning::new(
                format!("the KKT residual on {grid} is {relative:.2} of the load"),
                request.closer(),
            )),
            Verdict::Solved => (),
        }
        self.warnings.extend(levels.notes().into_iter().map(Warning::fact));
        self.warnings.extend(refusal_of_curves(&request.problem).map(Warning::fact));
        self.warn_of_levels(request);
        self.warn_of_tolerance(request);
        self.warn_of_load(request);
        if let Some(fact) = unsolved {
            let remedies = [vec![request.closer()], remedies(&self.warnings)].concat();
            self.failure = Some(Warning { fact, remedies });
        }
        if self.failure.is_none() {
            self.warn_of_force(request);
        }
        if let (Ok(bounds), None, None) = (&self.bounds, request.accuracy(), &self.failure) {
            self.warnings.extend(bound::warnings(bounds, energy, request));
        }
    }

    /// Decides whether the solution is as accurate as asked.
    pub(super) fn judge_end(&mut self, request: &Request, accuracy: Accuracy) {
        let Ok(bounds) = &self.bounds else { return };
        let (reason, remedy) = match request.adapted.map(|meshes| meshes.end) {
            None | Some(AdaptedEnd::Goal) => return,
            Some(AdaptedEnd::Nodes) => ("memory has no room for more nodes", "ask for less"),
            Some(AdaptedEnd::NoLongerFalls) => {
                ("the bound no longer falls", "ask for less, or write jumps of f as shapes")
            }
        };
        let (asked, nodes) = (request.voice.accuracy(accuracy), self.run.y.len());
        let reached = adapting::error(accuracy, accuracy.reached(bounds));
        let fact = format!(
            "{}: {asked} is not reached: {reached} with {nodes} nodes; {reason}",
            request.name
        );
        self.shortfall = Some(Warning::new(fact, Remedy::new(remedy, "")));
    }

    /// Returns the message that the discrete problem on the finest level, or on all levels, has no solution.
    fn without_solution(&self, request: &Request) -> Warning {
        let ends = &self.run.ends;
        let on_all = ends.iter().all(|end| end.verdict() == Verdict::NoSolution);
        let Warning { fact, remedies } = request.without_solution(self.last().sum_load);
        let fact = match ends.len() {
            2.. if on_all => fact.replacen(" on grid ", " (as on all coarser grids) on grid ", 1),
            _ => fact,
        };
        Warning { fact, remedies }
    }

    fn warn_of_levels(&mut self, request: &Request) {
        let (count, coarsest) = (request.problem.levels().count(), self.run.ends[0].cells);
        if request.solver().is_nested()
            && let Some(coarsest) = coarsest.filter(|&cells| cells > COARSE)
        {
            let what = if count == 1 { "has no coarser ones" } else { "begins the nested grids" };
            let fact = format!(
                "grid 1/{coarsest} {what}, and the tolerance is 10^-k on the k-th grid, here {} on the last",
                Written(tolerance(count))
            );
            self.warnings.push(Warning::new(fact, COARSER_GRIDS));
        }
        let coarse = &self.run.ends[..self.run.ends.len() - 1];
        let without = |end: &Outcome| end.verdict() == Verdict::NoSolution;
        if !without(self.last())
            && let Some(grids) = named(&request.problem, coarse, without)
        {
            self.warnings.push(Warning::fact(format!(
                "the load vector sums to a non-negative number on {grids}, where the discrete problem has no solution"
            )));
        }
        let cut_off = |end: &Outcome| end.end.stop != Stop::Converged;
        if let Some(grids) = named(&request.problem, coarse, cut_off) {
            let fact = format!("the stopping rule was not met on {grids}");
            self.warnings.push(Warning::fact(fact));
        }
    }

    /// Warns if the tolerance asked for was not reached.
    fn warn_of_tolerance(&mut self, request: &Request) {
        let Outcome { end: End { stop, .. }, kkt, .. } = *self.last();
        if let Some(tolerance) = request.statement.tolerance
            && stop != Stop::Converged
        {
            self.warnings.push(Warning::fact(format!(
                "--tolerance {} was not reached: the KKT residual is {} of the load at the {stop}",
                Written(tolerance),
                plain(kkt.relative, 3)
            )));
        }
    }

    /// True if the sum of the load vector misses the integral of f by more than the grid explains.
    pub(super) fn load_misses(&self, request: &Request) -> bool {
        let integral = request.problem.levels().integrals().of_f;
        let difference = (self.last().sum_load - integral).abs();
        load_slack(&request.problem).is_some_and(|slack| difference > slack)
    }

    /// Warns if the load vector belongs to another f.
    fn warn_of_load(&mut self, request: &Request) {
        let levels = request.problem.levels();
        let grid = levels.name(request.problem.finest());
        if self.load_misses(request) {
            let integrals = levels.integrals();
            let [integral, sum_load] =
                [integrals.of_f, self.last().sum_load].map(|sum| signed(sum, 4));
            let (reason, remedy) = if integrals.by_quadrature {
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
        } else if let Some(moved) = request.moved_jumps() {
            self.warnings.push(Warning::new(moved_jumps(moved), BILINEAR_LOAD));
        }
    }

    /// Warns if the flux through the boundary does not balance the load: at the discrete solution their sum is zero up
    /// to rounding.
    ///
    /// A difference counts where it exceeds the error of the grid and the error that the user accepts.
    fn warn_of_force(&mut self, request: &Request) {
        let problem = &request.problem;
        let (force, load) = (self.force, 0.0 - self.last().sum_load);
        let size = problem.levels().integrals().of_size.abs();
        let accepted = request.accuracy().map_or(0.0, Accuracy::error) * size;
        let slack = slack(problem).max(accepted);
        // A fixed part of the boundary bears the rest.
        let balanced = problem.levels().has_fixed_part() || (force - load).abs() <= slack;
        if !balanced {
            let words = BoundaryWords::of(problem.law());
            self.warnings.push(Warning::new(words.unbalanced(force, load), request.closer()));
        }
    }
}

/// Returns the difference of forces that the finest level explains: the square of h over the size of the domain, times
/// the integral of |f|.
fn slack(problem: &Problem) -> f64 {
    let levels = problem.levels();
    levels.integrals().of_size.abs() * (levels.width() / levels.extent()).powi(2)
}

/// Returns the difference between the sum of a load vector and the integral of f that the grid explains; none for known
/// solutions.
fn load_slack(problem: &Problem) -> Option<f64> {
    let integrals = problem.levels().integrals();
    // Values at the nodes of a smooth f are off by some multiple of h^2, the others by less.
    let slack = if integrals.by_quadrature {
        (4.0 * slack(problem)).max(RESOLVED * integrals.of_size)
    } else {
        slack(problem)
    };
    (!integrals.is_known).then_some(slack)
}

/// Returns the names of the levels of the ends with a property, if there are any; the first end is on the coarsest
/// level.
fn named(
    problem: &Problem,
    ends: &[Outcome],
    property: impl Fn(&Outcome) -> bool,
) -> Option<String> {
    let name = |(level, end): (usize, &Outcome)| match end.cells {
        Some(_) => end.label(),
        None => problem.levels().name(level),
    };
    let names: Vec<_> =
        ends.iter().enumerate().filter(|(_, end)| property(end)).map(name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}
