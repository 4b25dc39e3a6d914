//! Judgement of the answer to a statement: the failure, if it is not what was asked for, and the warnings.
//!
//! Central is [`Statement::judged`], the one judge of answers.

use super::Statement;
use super::warning::{Failure, Warning};
use crate::bounds::{Accuracy, Bounds};
use crate::discrete::end::{Outcome, Stop, Verdict};
use crate::levels::Problem;
use crate::solvers::{ReachEnd, Solved};

/// Cells per side above which a coarsest grid is finer than those for which the stopping rule is made.
const COARSE: usize = 8;
/// Error of the sum of the load vector of a formula, over the integral of |f|, that gets no warning on any grid.
const RESOLVED: f64 = 1e-2;
/// Error over the integral of |f| of the quadrature from which on a warning is given.
const MISSED: f64 = 1e-3;
/// KKT residual over the load from which on digits of the energy that are shown may be rounding errors.
const ROUNDED: f64 = 1e-6;
/// Error over the solution from which on a warning is given.
const POOR: f64 = 0.5;

/// Judgement of an answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// Doubts, in the order in which they are told.
    pub warnings: Vec<Warning>,
    /// Reason why the answer is not what was asked for.
    pub failure: Option<Failure>,
}

impl Statement {
    /// Judges the answer to the statement.
    pub fn judged(&self, solved: &Solved) -> Judged {
        let problem = &solved.problem;
        let mut notes = problem.levels().facts().notes.clone();
        let Some(last) = solved.ends().last() else {
            notes.extend(solved.truth().into_iter().flat_map(|found| found.notes.clone()));
            let notes = notes.into_iter().map(Warning::Note);
            return Judged { warnings: notes.chain(no_bound(solved)).collect(), failure: None };
        };
        notes.extend(problem.note_on_curves());
        let failure = self.failure(solved, last);
        let mut warnings = Vec::new();
        let level = problem.name(problem.finest());
        let (verdict, relative) = (self.verdict(last), last.kkt.relative);
        if verdict == Verdict::Rough {
            warnings.push(Warning::Rough { level: level.clone(), relative });
        }
        warnings.extend(notes.into_iter().map(Warning::Note));
        warnings.extend(self.on_coarser(solved));
        if let Some(tolerance) = self.tolerance.filter(|_| !last.end.has_converged()) {
            warnings.push(Warning::Tolerance { tolerance, relative, stop: last.end.stop });
        }
        let is_exact =
            !self.solver.is_nested() && self.tolerance.is_none() && self.accuracy().is_none();
        if is_exact && verdict == Verdict::Solved && relative > ROUNDED {
            warnings.push(Warning::Rounding { level, relative });
        }
        warnings.extend(of_load(problem, last));
        if failure.as_ref().is_none_or(Failure::is_of_accuracy) {
            warnings.extend(self.of_force(solved, last));
            warnings.extend(no_bound(solved));
        }
        if let (Some(bounds), None, None) = (solved.last_bounds(), self.accuracy(), &failure) {
            warnings.extend(of_bounds(bounds, last.energy));
        }
        Judged { warnings, failure }
    }

    fn verdict(&self, last: &Outcome) -> Verdict {
        last.judged(self.accuracy().is_some())
    }

    /// Reason why the answer that ended so on the finest level is not what was asked for.
    fn failure(&self, solved: &Solved, last: &Outcome) -> Option<Failure> {
        let (problem, ends) = (&solved.problem, solved.ends());
        let mut level = problem.name(problem.finest());
        Some(match self.verdict(last) {
            Verdict::NoSolution => {
                if ends.len() > 1 && ends.iter().all(|end| end.verdict() == Verdict::NoSolution) {
                    level += ", as on all coarser levels";
                }
                Failure::NoSolution { level, sum_load: last.sum_load }
            }
            Verdict::CutOff(Stop::Diverged) => Failure::Diverged {
                solver: self.solver,
                level: problem.name(solved.run()?.first_level + ends.len() - 1),
                iterations: last.end.iterations,
            },
            Verdict::CutOff(stop) => Failure::CutOff { stop, level },
            Verdict::NotSolved(violation) => Failure::NotSolved { level, violation },
            Verdict::Rough | Verdict::Solved => return of_accuracy(solved, last),
        })
    }

    /// Warnings of the levels that are coarser than the finest.
    fn on_coarser(&self, solved: &Solved) -> Vec<Warning> {
        let (problem, ends, mut warnings) = (&solved.problem, solved.ends(), Vec::new());
        let grids = problem.count();
        if self.solver.is_nested()
            && self.tolerance.is_none()
            && let Some(cells) = ends[0].cells.filter(|&cells| cells > COARSE)
        {
            warnings.push(Warning::FineStart { cells, grids });
        }
        // Grids that were tried for an accuracy are no levels of the last one.
        let [coarse @ .., last] = &ends[ends.len() - ends.len().min(grids)..] else {
            return warnings;
        };
        let is_empty = |end: &Outcome| end.verdict() == Verdict::NoSolution;
        if !is_empty(last)
            && let Some(levels) = named(problem, coarse, is_empty)
        {
            warnings.push(Warning::NoCoarseSolution { levels });
        }
        if let Some(levels) = named(problem, coarse, |end| !end.end.has_converged()) {
            let goal = if self.tolerance.is_some() { "tolerance" } else { "stopping rule" };
            warnings.push(Warning::CutOff { goal, levels });
        }
        warnings
    }

    /// Warns if the total flux does not balance the load: a difference counts where it exceeds the error of the grid
    /// and the error that the user accepts.
    fn of_force(&self, solved: &Solved, last: &Outcome) -> Option<Warning> {
        let problem = &solved.problem;
        let (force, load) = (solved.force(), 0.0 - last.sum_load);
        let size = problem.levels().facts().size.abs();
        let accepted = self.accuracy().map_or(0.0, Accuracy::error) * size;
        // A fixed part of the boundary, or a reaction, bears the rest.
        let balanced = problem.domain(problem.finest()).bears_load()
            || (force - load).abs() <= slack(problem).max(accepted);
        (!balanced).then(|| Warning::Force { has_contact: problem.has_contact(), force, load })
    }
}

/// Warns if there is no bound of the error.
fn no_bound(solved: &Solved) -> Option<Warning> {
    solved.no_bound().copied().map(Warning::NoBound)
}

/// Reason why a solution is not as accurate as asked; none if it is, or no accuracy was asked for.
fn of_accuracy(solved: &Solved, last: &Outcome) -> Option<Failure> {
    let reached = solved.reached.as_ref()?;
    let (accuracy, problem) = (reached.accuracy, &solved.problem);
    Some(match reached.end {
        ReachEnd::Goal | ReachEnd::NoSolution => return None,
        ReachEnd::Finest { needed: Some(needed), best } => {
            Failure::TooFine { accuracy, needed, best }
        }
        end => Failure::Accuracy {
            accuracy,
            reached: accuracy.reached(solved.last_bounds()?),
            nodes: last.nodes,
            end,
            has_converged: last.end.has_converged(),
            by_quadrature: problem.levels().facts().by_quadrature,
            takes_spectral: problem.takes_spectral(),
        },
    })
}

/// Warns if the load vector belongs to another f.
fn of_load(problem: &Problem, last: &Outcome) -> Option<Warning> {
    let (facts, level) = (problem.levels().facts(), problem.name(problem.finest()));
    // Values at the nodes of a smooth f are off by some multiple of h^2, the others by less.
    let slack = match facts.by_quadrature {
        true => (4.0 * slack(problem)).max(RESOLVED * facts.size),
        false => slack(problem),
    };
    let (sum_load, integral) = (last.sum_load - facts.given_flux, facts.integral);
    if facts.known.is_none() && (sum_load - integral).abs() > slack {
        return Some(match facts.by_quadrature {
            true => Warning::Points { level, sum_load, integral },
            false => Warning::Load { level, sum_load, integral },
        });
    }
    if let Some(missed) = problem.levels().missed().filter(|&missed| missed > MISSED) {
        return Some(Warning::Quadrature { level, missed });
    }
    problem.note_on_jumps().map(Warning::Jumps)
}

/// Warns if the bounds contradict the `energy` of an answer, or if its error may be large.
fn of_bounds(bounds: &Bounds, energy: f64) -> impl Iterator<Item = Warning> {
    let ([low, high], [_, most]) = (bounds.energy, bounds.error);
    // The energy of v is above the true one by half the square of the error.
    let explained = most * most;
    let is_explained = low - explained <= energy && energy <= high + explained;
    let relative = bounds.relative();
    let contradicted = (!is_explained).then_some(Warning::Energy);
    contradicted.into_iter().chain((relative >= POOR).then_some(Warning::Error { relative }))
}

/// Difference of forces that the finest level explains: the square of h over the size of the domain, times the integral
/// of |f|, and no less than rounding errors.
fn slack(problem: &Problem) -> f64 {
    let facts = problem.levels().facts();
    (facts.size.abs() * (facts.width / facts.extent).powi(2)).max(facts.rounding())
}

/// Returns the names of the levels of the ends with a property, if there are any.
fn named(
    problem: &Problem,
    ends: &[Outcome],
    property: impl Fn(&Outcome) -> bool,
) -> Option<String> {
    let mut names = Vec::new();
    for end in ends.iter().filter(|end| property(end)) {
        // Adapted meshes are more than those on which a solution was sought.
        let level = (0..problem.count())
            .find(|&level| end.cells.is_none() && problem.domain(level).nodes() == end.nodes);
        names.push(level.map_or_else(|| end.label(), |level| problem.name(level)));
    }
    (!names.is_empty()).then(|| names.join(", "))
}
