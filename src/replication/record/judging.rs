//! Judgement of an answer: the failure, if it is no solution, and the warnings.

use super::Record;
use super::advice::{Remedy, Warning, remedies};
use crate::replication::fields::table::Voice;
use signorini_mathematics::bounds::{Accuracy, Bounds};
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::discrete::verdict::Verdict;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::text::{Written, percent, plain};
use signorini_mathematics::saddle::{StopRule, tolerance};
use signorini_mathematics::solvers::{Solved, Solver};
use signorini_mathematics::statement::{Fineness, Statement};

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

/// Judge of the answers to a statement: what is asked, and the words in which a user has asked it.
#[derive(Clone, Copy)]
pub(crate) struct Judge<'a> {
    pub(crate) statement: &'a Statement,
    /// Way in which fields are written in advice.
    pub(crate) voice: Voice,
    /// True for a scene of a published table, whose load is the paper's.
    pub(crate) is_papers: bool,
}

impl Judge<'_> {
    /// Decides whether an answer is a solution, and collects the warnings.
    pub(crate) fn record(self, solved: &Solved) -> Record {
        let notes = solved.problem.levels().facts().notes.iter().cloned().map(Warning::fact);
        let Some(last) = solved.ends().last() else {
            let of_truth = solved.truth().into_iter().flat_map(|found| found.notes.clone());
            let warnings =
                notes.chain(of_truth.map(Warning::fact)).chain(no_bound(solved)).collect();
            return Record { warnings, ..Record::default() };
        };
        let (mut warnings, mut failure) = self.verdict(solved, last);
        warnings.extend(notes);
        warnings.extend(solved.problem.note_on_curves().map(Warning::fact));
        warnings.extend(self.of_levels(solved, last));
        warnings.extend(self.of_tolerance(last));
        warnings.extend(self.of_rounding(&solved.problem, last));
        warnings.extend(self.of_load(&solved.problem, last));
        if let (Some(failure), Verdict::NotSolved(_)) = (&mut failure, self.judged(last)) {
            failure.remedies.extend(remedies(&warnings));
        }
        if failure.is_none() {
            warnings.extend(self.of_force(solved, last));
            warnings.extend(no_bound(solved));
        }
        let mut shortfall = None;
        match (solved.last_bounds(), self.statement.accuracy(), &failure) {
            (Some(bounds), None, None) => {
                warnings.extend(self.of_bounds(bounds, last.energy));
            }
            (_, Some(accuracy), None) => shortfall = self.voice.shortfall(accuracy, solved),
            _ => {}
        }
        Record { warnings, failure, shortfall }
    }

    fn judged(self, last: &Outcome) -> Verdict {
        last.judged(self.statement.accuracy().is_some())
    }

    /// Returns the warnings and the failure that follow from the verdict on the finest level.
    fn verdict(self, solved: &Solved, last: &Outcome) -> (Vec<Warning>, Option<Warning>) {
        let grid = solved.problem.name(solved.problem.finest());
        let failure = match self.judged(last) {
            Verdict::NoSolution => self.no_solution(solved),
            Verdict::CutOff(Stop::Diverged) => return (Vec::new(), self.diverged(solved)),
            Verdict::CutOff(stop) => {
                Warning::new(format!("stopped at the {stop} on {grid}"), self.after_limit(solved))
            }
            Verdict::NotSolved(violation) => Warning::new(
                format!("the solver stopped as asked on {grid}, but {violation}"),
                self.closer(solved),
            ),
            Verdict::Rough => {
                let relative = last.kkt.relative;
                let fact = format!("the KKT residual on {grid} is {relative:.2} of the load");
                return (vec![Warning::new(fact, self.closer(solved))], None);
            }
            Verdict::Solved => return (Vec::new(), None),
        };
        (Vec::new(), Some(failure))
    }

    /// Returns the message that values are not finite; none if they are.
    pub(crate) fn diverged(self, solved: &Solved) -> Option<Warning> {
        let last = solved.ends().last().filter(|last| last.end.has_diverged())?;
        let solver = self.statement.solver;
        if !solver.is_nested() {
            let remedy = Remedy::of_words("scale f down");
            return Some(Warning::new("the solver diverged".into(), remedy));
        }
        let first = solved.run().map_or(0, |run| run.first_level);
        let grid = solved.problem.name(first + solved.ends().len() - 1);
        let fact = format!("{solver} diverged on {grid} after {} iterations", last.end.iterations);
        Some(Warning::new(fact, Remedy::of_words("choose a smaller r or scale f down")))
    }

    /// Returns the message that the discrete problem on the finest level, or on all levels, has no solution.
    fn no_solution(self, solved: &Solved) -> Warning {
        let (ends, problem) = (solved.ends(), &solved.problem);
        let on_all = ends.iter().all(|end| end.verdict() == Verdict::NoSolution);
        let level = problem.name(problem.finest());
        let Warning { fact, remedies } = self.unbalanced(&level, ends[ends.len() - 1].sum_load);
        let fact = match ends.len() {
            2.. if on_all => fact.replacen(" on grid ", " (as on all coarser grids) on grid ", 1),
            _ => fact,
        };
        Warning { fact, remedies }
    }

    /// Returns the message that no nodal vector solves the discrete problem on the level with this name, for a load
    /// vector with this sum.
    pub(crate) fn unbalanced(self, level: &str, sum_load: f64) -> Warning {
        let sum_load = signed(sum_load, 4);
        let fact = format!(
            "the load vector sums to {sum_load} on {level}, where the discrete problem has no solution"
        );
        let is_papers_law = self.statement.law.is_none();
        if !self.statement.domain.is_square() {
            let remedy =
                if is_papers_law { "lower f somewhere" } else { "change f, or widen the law" };
            return Warning::new(fact, Remedy::of_words(remedy));
        }
        let other = if is_papers_law { "a lower f" } else { "a wider law" };
        let exact = self.takes_exact().then(|| format!("{}, ", self.exact()));
        let fineness = self.fineness();
        let comma = if exact.is_some() { "," } else { "" };
        let exact = exact.unwrap_or_default();
        let remedy = format!("use {exact}another {fineness}{comma} or {other}");
        Warning::new(fact, Remedy::of_words(remedy))
    }

    /// Name of the field by which grids of the square are chosen.
    fn fineness(self) -> String {
        match (self.voice, &self.statement.fineness) {
            (Voice::Keys, Fineness::Grids(_)) => self.voice.name("grids"),
            _ => self.voice.name("h"),
        }
    }

    /// True if the exact load may have another sum than that of the statement.
    fn takes_exact(self) -> bool {
        matches!(self.statement.load, Some(LoadRule::Nodal { .. }))
    }

    /// The field with the exact load.
    fn exact(self) -> String {
        self.voice.with_text("load", "exact")
    }

    /// Remedy for a load vector that misses some of f.
    fn exact_load(self) -> Remedy {
        match self.takes_exact() {
            true => Remedy::new(format!("use {}", self.exact()), self.exact()),
            false => Remedy::of_words("refine the grid"),
        }
    }

    /// Remedy by multigrid, behind these words.
    fn multigrid(self, words: &str) -> Remedy {
        let multigrid = self.voice.with_text("solver", Solver::Multigrid.entry().name);
        Remedy::new(format!("{words}{multigrid}"), multigrid)
    }

    /// Returns advice for a smaller residual; each option in it goes with those that are given, and none has been
    /// tried.
    fn closer(self, solved: &Solved) -> Remedy {
        let Statement { solver, saddle, tolerance, .. } = self.statement;
        let tried = solved.run().map(|run| run.solver);
        match (solver, saddle.map(|settings| settings.stop)) {
            (Solver::Multigrid, _) if self.statement.accuracy().is_some() => {
                Remedy::of_words("ask for a smaller accuracy")
            }
            (Solver::Multigrid, _) if tolerance.is_some() => {
                Remedy::of_words(format!("ask for a smaller {}", self.voice.name("tolerance")))
            }
            // Multigrid leaves to the active set what its steps do not solve.
            (Solver::Multigrid, _) if tried == Some(Solver::ActiveSet) => self.other_cells(),
            (Solver::Multigrid, _) => {
                let other = self.voice.with_text("solver", Solver::ActiveSet.entry().name);
                Remedy::new(format!("use {other}"), other)
            }
            (_, Some(StopRule::PrintedDual) | None) => self.multigrid("use "),
            (_, Some(_)) => {
                let rule = self.voice.with_text("stop", StopRule::PrintedDual.name());
                self.multigrid(&format!("use {rule}, or "))
            }
        }
    }

    /// Remedy for a discrete problem that no solver has solved.
    fn other_cells(self) -> Remedy {
        match self.statement.domain.is_square() {
            true => Remedy::of_words(format!("choose another {}", self.fineness())),
            false => Remedy::of_words(
                "its cells are stretched too much; mesh with smaller aspects, or with fewer cells",
            ),
        }
    }

    /// Returns advice after a limit on iterations.
    fn after_limit(self, solved: &Solved) -> Remedy {
        if self.statement.solver.is_nested() {
            let limit = self.voice.name("max_iterations");
            return self.multigrid(&format!("raise {limit}, or use "));
        }
        match self.statement.solver {
            Solver::Multigrid => self.other_cells(),
            _ => self.closer(solved),
        }
    }

    fn of_levels(self, solved: &Solved, last: &Outcome) -> Vec<Warning> {
        let (problem, ends, mut warnings) = (&solved.problem, solved.ends(), Vec::new());
        let (count, coarsest) = (problem.count(), ends[0].cells);
        if self.statement.solver.is_nested()
            && let Some(coarsest) = coarsest.filter(|&cells| cells > COARSE)
        {
            let what = if count == 1 { "has no coarser ones" } else { "begins the nested grids" };
            let fact = format!(
                "grid 1/{coarsest} {what}, and the tolerance is 10^-k on the k-th grid, here {} on the last",
                Written(tolerance(count))
            );
            warnings
                .push(Warning::new(fact, self.multigrid("choose 1/(2^k m), such as 1/64, or ")));
        }
        // Grids that were tried for an accuracy are no levels of the last one.
        let coarse = &ends[ends.len() - ends.len().min(count)..ends.len() - 1];
        let without = |end: &Outcome| end.verdict() == Verdict::NoSolution;
        if !without(last)
            && let Some(grids) = named(problem, coarse, without)
        {
            warnings.push(Warning::fact(format!(
                "the load vector sums to a non-negative number on {grids}, where the discrete problem has no solution"
            )));
        }
        if let Some(grids) = named(problem, coarse, |end| !end.end.has_converged()) {
            let fact = format!("the stopping rule was not met on {grids}");
            warnings.push(Warning::fact(fact));
        }
        warnings
    }

    /// Warns if the tolerance asked for was not reached.
    fn of_tolerance(self, last: &Outcome) -> Option<Warning> {
        let tolerance = self.statement.tolerance.filter(|_| !last.end.has_converged())?;
        let asked = self.voice.with_value("tolerance", &Written(tolerance).to_string());
        let residual = plain(last.kkt.relative, 3);
        let stop = last.end.stop;
        Some(Warning::fact(format!(
            "{asked} was not reached: the KKT residual is {residual} of the load at the {stop}"
        )))
    }

    /// Warns if rounding errors leave a large residual of a solution that is sought up to them.
    fn of_rounding(self, problem: &Problem, last: &Outcome) -> Option<Warning> {
        let Statement { solver, tolerance, .. } = self.statement;
        let is_exact =
            matches!(solver, Solver::Multigrid | Solver::ActiveSet) && tolerance.is_none();
        let is_solved = self.statement.accuracy().is_none() && self.judged(last) == Verdict::Solved;
        let relative = last.kkt.relative;
        (is_exact && is_solved && relative > ROUNDED).then(|| {
            let (grid, residual) = (problem.name(problem.finest()), plain(relative, 2));
            let fact =
                format!("rounding errors leave a KKT residual of {residual} of the load on {grid}");
            Warning::new(fact, self.other_cells())
        })
    }

    /// Warns if the load vector belongs to another f.
    fn of_load(self, problem: &Problem, last: &Outcome) -> Option<Warning> {
        let (levels, grid) = (problem.levels(), problem.name(problem.finest()));
        if load_misses(problem, last) {
            let facts = levels.facts();
            let [integral, sum_load] = [facts.integral, last.sum_load].map(|sum| signed(sum, 4));
            let (reason, remedy) = match facts.by_quadrature {
                true => ("its points miss some of f", self.quadrature()),
                false => ("values at the nodes miss where f jumps", self.exact_load()),
            };
            let fact = format!(
                "the load vector sums to {sum_load} on {grid}, the integral of f is {integral}: {reason}"
            );
            return Some(Warning::new(fact, remedy));
        }
        if let Some(missed) = levels.missed().filter(|&missed| missed > MISSED) {
            let missed = plain(missed, 2);
            let fact =
                format!("the quadrature of f on {grid} misses {missed} of the integral of |f|");
            return Some(Warning::new(fact, self.quadrature()));
        }
        let moved = problem.note_on_jumps().filter(|_| !self.is_papers)?;
        let bilinear = self.voice.with_text("load", "bilinear");
        Some(Warning::new(moved, Remedy::new(format!("use {bilinear}"), bilinear)))
    }

    /// Remedy for a quadrature that misses some of f.
    fn quadrature(self) -> Remedy {
        match self.statement.domain.is_square() {
            true => Remedy::of_words(format!("choose a smaller {}", self.voice.name("h"))),
            false => Remedy::of_words("write jumps of f as shapes, or refine the mesh"),
        }
    }

    /// Warns if the flux through the boundary does not balance the load: at the discrete solution their sum is zero up
    /// to rounding.
    ///
    /// A difference counts where it exceeds the error of the grid and the error that the user accepts.
    fn of_force(self, solved: &Solved, last: &Outcome) -> Option<Warning> {
        let problem = &solved.problem;
        let (force, load) = (solved.force(), 0.0 - last.sum_load);
        let size = problem.levels().facts().size.abs();
        let accepted = self.statement.accuracy().map_or(0.0, Accuracy::error) * size;
        let slack = slack(problem).max(accepted);
        // A fixed part of the boundary bears the rest.
        let balanced =
            problem.domain(problem.finest()).has_fixed_part() || (force - load).abs() <= slack;
        (!balanced).then(|| {
            Warning::new(unbalanced_force(problem.law(), force, load), self.closer(solved))
        })
    }

    /// Returns warnings if the bounds contradict the `energy` of an answer, or if its error may be large.
    fn of_bounds(self, bound: &Bounds, energy: f64) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let ([low, high], [_, most]) = (bound.energy, bound.error);
        // The energy of v is above the true one by half the square of the error.
        let explained = most * most;
        if !(low - explained <= energy && energy <= high + explained) {
            let fact = "the energy is further from the true one than the error explains: the load vector is not that \
                        of f";
            warnings.push(Warning::new(fact.into(), self.exact_load()));
        }
        let relative = bound.relative();
        if relative >= POOR {
            let error = match relative < 1.0 {
                true => format!("{} of the solution", percent(relative, 2)),
                false => "as large as the solution".into(),
            };
            let remedy = match self.statement.solver {
                Solver::Multigrid => Remedy::of_words("refine the grid"),
                _ => self.multigrid("refine the grid, or try "),
            };
            warnings.push(Warning::new(format!("the error may be {error}"), remedy));
        }
        warnings
    }
}

/// Warns if there is no bound of the error.
fn no_bound(solved: &Solved) -> Option<Warning> {
    let reason = solved.no_bound()?;
    Some(Warning::fact(format!("no bound of the error: {reason}")))
}

/// As [`plain`], with a plus before a positive number.
fn signed(number: f64, digits: usize) -> String {
    let sign = if number > 0.0 { "+" } else { "" };
    format!("{sign}{}", plain(number, digits))
}

/// Returns the message that the total flux does not balance the load.
fn unbalanced_force(law: Law, force: f64, load: f64) -> String {
    let (total, difference) = match law.is_signorini() {
        true => (CONTACT_FORCE, "contact set is not that"),
        false => (FLUX, "nodes that stick are not those"),
    };
    let [force, load] = [force, load].map(|sum| plain(sum, 5));
    format!(
        "the {total} {force} does not balance the load, {load}, so the {difference} of the solution"
    )
}

/// Integral of dv/dn over the boundary, in words, under the paper's law and under others.
pub(crate) const CONTACT_FORCE: &str = "contact force";
pub(crate) const FLUX: &str = "flux through the boundary";

/// True if the sum of the load vector misses the integral of f by more than the grid explains.
pub(crate) fn load_misses(problem: &Problem, last: &Outcome) -> bool {
    let difference = (last.sum_load - problem.levels().facts().integral).abs();
    load_slack(problem).is_some_and(|slack| difference > slack)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positive_numbers_have_a_plus() {
        assert_eq!(["+0.50", "-0.50", "0"], [0.5, -0.5, -0.0].map(|number| signed(number, 2)));
    }
}
