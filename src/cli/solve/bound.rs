//! Text on an answer: guaranteed bounds of its error and of the true energy, and the contact found.

use crate::replication::record::{CONTACT_FORCE, FLUX};
use signorini_mathematics::discrete::contact::ContactArc;
use signorini_mathematics::levels::Reserve;
use signorini_mathematics::problem::text::{interval, known, plain};
use signorini_mathematics::solvers::Solved;

/// Returns the bounds of the solution of a problem as text, with that of the recovered solution if it is `recovered`;
/// a warning says why there are none.
pub(super) fn text(solved: &Solved, recovered: bool) -> String {
    let problem = &solved.problem;
    let Some(Ok(bound)) = solved.bounds().last() else { return String::new() };
    let domain = if problem.levels().facts().dimension == 2 { "polygon" } else { "polyhedron" };
    let guaranteed = match &solved.reserves()[..] {
        [] => "guaranteed:".to_owned(),
        [Reserve::Quadrature] => "guaranteed, but for the quadrature of f:\n ".to_owned(),
        [Reserve::Polygon] => format!("guaranteed, on the {domain}:\n "),
        _ => format!("guaranteed, on the {domain}, but for the quadrature of f:\n "),
    };
    let [least, most] = bound.error.map(|error| plain(error, 4));
    let range =
        if bound.error[0] > 0.0 { format!("{least} to {most}") } else { format!("at most {most}") };
    let mut text = format!(
        "{guaranteed} true energy in {},\n  error in the energy norm {range}",
        interval(bound.energy)
    );
    let size = bound.error[1] / bound.relative();
    let share = |error: f64| match error / size {
        share if share < 1.0 => format!(", at most {} % of the solution", plain(100.0 * share, 3)),
        _ => String::new(),
    };
    text += &share(bound.error[1]);
    if let Some(curve) = bound.curve {
        let curve = plain(curve, 2);
        text += &format!(",\n  energy beside the {domain}, which no bound holds, about {curve}");
    }
    if let Some(most) = bound.recovered.filter(|_| recovered) {
        let shown = plain(most, 4);
        text += &format!(",\n  of the recovered solution at most {shown}{}", share(most));
    }
    text + "\n"
}

/// Digits of numbers of a true solution without bounds, as many as the solver says that it has.
pub(super) const TEN: usize = 10;

/// Words for the boundary under a law.
pub(super) struct BoundaryWords {
    /// Verb or noun for boundary nodes at zero.
    holds: &'static str,
    /// Integral of dv/dn over the boundary.
    total: &'static str,
    /// Most digits of places and forces.
    digits: usize,
    /// Size below which a sum of forces is one of rounding errors.
    rounding: f64,
    /// Error of forces, by the balance of those of a true solution; none of another.
    error: Option<f64>,
}

impl BoundaryWords {
    pub(super) fn of(solved: &Solved) -> Self {
        let is_signorini = solved.problem.law().is_signorini();
        let (holds, total) =
            if is_signorini { ("contact", CONTACT_FORCE) } else { ("sticks", FLUX) };
        let rounding = solved.problem.levels().facts().rounding();
        let error = solved.truth().map(|found| found.unbalanced.max(rounding));
        let digits = if error.is_some() { TEN } else { 6 };
        Self { holds, total, digits, rounding, error }
    }

    /// Returns, as text, the total flux and minus the integral of f, which are equal at the solution.
    pub(super) fn force(&self, sums: [f64; 2]) -> String {
        let [force, minus_integral] = sums.map(|sum| self.balance(sum));
        format!("{} {force}, minus the integral of f {minus_integral}\n", self.total)
    }

    /// Returns, as text, the place and the force of an arc at zero.
    pub(super) fn arc(&self, arc: &ContactArc) -> String {
        let digits = self.digits;
        let [from, to] = match arc.error {
            Some([before, after]) => {
                [[arc.from, [before; 2]], [arc.to, [after; 2]]].map(known_point)
            }
            None => [arc.from, arc.to].map(|[x, y]| format!("({x:.digits$}, {y:.digits$})")),
        };
        let on = arc.part.as_ref().map_or(String::new(), |part| format!(" on {part}"));
        let place = match arc.closed {
            true => format!("everywhere{on}"),
            // Long numbers take a line each.
            false if digits > 6 => format!("from {from}\n  to {to}"),
            false => format!("from {from} to {to}{on}"),
        };
        format!("{} {place}, force {}\n", self.holds, self.balance(arc.force))
    }

    /// Returns a term of the balance of the flux with f as text, a sum of rounding errors as zero.
    fn balance(&self, term: f64) -> String {
        if term.abs() <= self.rounding {
            return "0".into();
        }
        known(term, self.error.map(|error| [term - error, term + error]), self.digits)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_rounding_errors_are_zero() {
        let rounding = 3e-12;
        let (holds, total) = ("contact", CONTACT_FORCE);
        let words = BoundaryWords { holds, total, digits: 6, rounding, error: None };
        for (force, shown) in [(-3.69843e-15, "force 0\n"), (2e-11, "force 2.00000e-11\n")] {
            let arc = ContactArc::new([[0.0, 0.0], [1.0, 0.0]], force, 1.0);
            let text = words.arc(&arc);
            assert!(text.ends_with(shown), "{text}");
        }
        assert!(words.force([1e-16, 2.0]).starts_with("contact force 0, "));
        let known = BoundaryWords { error: Some(3e-5), digits: 10, ..words };
        let text = known.force([1.234_510_89, 0.0]);
        assert!(text.starts_with("contact force 1.2345, "), "{text}");
    }
}
