//! Text on an answer: guaranteed bounds of its error and of the true energy, and the contact found.

use crate::cli::output::paragraph;
use crate::replication::numbers::{Guarantee, Numbers};
use signorini_mathematics::problem::law::name_of_force;
use signorini_mathematics::problem::text::{known, plain};
use signorini_mathematics::solvers::Solved;

/// Returns the bounds of an answer as text; a warning says why there are none.
pub(super) fn text(numbers: &Numbers) -> String {
    let Some(Guarantee { but, parts }) = numbers.guarantee() else { return String::new() };
    let line = if but.is_empty() { "" } else { "\n " };
    format!("guaranteed{but}:{line} {}\n", parts.join(",\n  "))
}

/// Digits of numbers of a true solution without bounds, as many as the solver says that it has, and of others.
pub(super) const TEN: usize = 10;
const SIX: usize = 6;

/// Returns, as text, the arcs that stick, and the total flux beside minus the integral of f and of given fluxes, which
/// are equal at the solution unless a part is fixed.
pub(super) fn boundary(solved: &Solved) -> String {
    let (problem, has_contact) = (&solved.problem, solved.problem.has_contact());
    let rounding = problem.levels().facts().rounding();
    let error = solved.truth().map(|found| found.unbalanced.max(rounding));
    let digits = if error.is_some() { TEN } else { SIX };
    let (holds, total) =
        (if has_contact { "contact" } else { "sticks" }, name_of_force(has_contact));
    let arcs = solved.contact().unwrap_or_default();
    let has_parts = arcs.iter().any(|arc| arc.part.is_some())
        && problem.levels().mesh(0).part_names().nth(1).is_some();
    let mut text = String::new();
    for arc in &arcs {
        let ends = match arc.error {
            Some([before, after]) => {
                [[arc.from, [before; 2]], [arc.to, [after; 2]]].map(known_point)
            }
            None => [arc.from, arc.to].map(|[x, y]| format!("({x:.digits$}, {y:.digits$})")),
        };
        let on = arc.part.as_ref().filter(|_| has_parts);
        let on = on.map_or(String::new(), |part| format!(" on {part}"));
        let place = if arc.closed { format!("everywhere{on}") } else { between(ends, &on, digits) };
        let force = force(arc.force, error);
        text += &format!("{holds} {place}, force {force}\n");
    }
    let bears_load = problem.domain(problem.finest()).bears_load();
    let have_several = problem.law().is_none() && problem.levels().laws().len() > 1;
    let have_other = bears_load || have_several || problem.levels().facts().given != 0.0;
    let parts = if have_other { solved.on_parts() } else { Vec::new() };
    let given = parts.iter().filter(|part| part.law.is_free()).map(|part| part.force).sum::<f64>();
    let sums = [solved.force(), 0.0 - solved.integral() - given];
    let [force, balance] = sums.map(|sum| force(sum, error));
    let and = if given == 0.0 { "" } else { " and of given fluxes" };
    let reacted = solved.reacted().map_or(String::new(), |sum| {
        format!(", of which the reaction takes {}", self::force(0.0 - sum, error))
    });
    text += &format!("{total} {force}, minus the integral of f{and} {balance}{reacted}\n");
    let mut fluxes = Vec::new();
    for part in parts {
        fluxes.push(format!("{} {}", part.name, self::force(part.force, error)));
    }
    if !fluxes.is_empty() {
        text += &paragraph(&format!("flux through {}\n", fluxes.join(", ")));
    }
    text
}

/// Returns, as text, the place of an arc between its ends, whose numbers have so many digits, `on` a part.
fn between([from, to]: [String; 2], on: &str, digits: usize) -> String {
    match digits > SIX {
        // Long numbers take a line each.
        true => format!("from {from}\n  to {to}"),
        false => format!("from {from} to {to}{on}"),
    }
}

/// Returns a point with the digits that it has.
fn known_point([point, errors]: [[f64; 2]; 2]) -> String {
    let [x, y] = [0, 1].map(|axis| {
        let (place, error) = (point[axis], errors[axis]);
        known(place, Some([place - error, place + error]), 16)
    });
    format!("({x}, {y})")
}

/// Returns a force with the digits that it has; that of a true solution has an error, by the balance of all.
fn force(force: f64, error: Option<f64>) -> String {
    match error {
        Some(error) if force != 0.0 => known(force, Some([force - error, force + error]), TEN),
        _ => plain(force, SIX),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_has_the_digits_that_its_error_leaves() {
        assert_eq!(force(1.234_510_89, Some(3e-5)), "1.2345");
        assert_eq!(force(1.234_510_89, None), "1.23451");
        assert_eq!(force(0.0, Some(1e-12)), "0");
    }
}
