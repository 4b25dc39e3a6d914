//! Text on an answer: guaranteed bounds of its error and of the true energy, and the contact found.

use crate::replication::record::{CONTACT_FORCE, FLUX};
use signorini_mathematics::discrete::contact::ContactArc;
use signorini_mathematics::levels::Reserve;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::text::{interval, plain, shared};
use signorini_mathematics::solvers::Solved;

/// Returns the bounds of the solution of a problem as text, with that of the recovered solution if it is `recovered`;
/// a warning says why there are none.
pub(super) fn text(solved: &Solved, recovered: bool) -> String {
    let problem = &solved.problem;
    let Some(bound) = solved.last_bounds() else { return String::new() };
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

/// Words for the boundary under a law.
pub(super) struct BoundaryWords {
    /// Verb or noun for boundary nodes at zero.
    holds: &'static str,
    /// Integral of dv/dn over the boundary.
    total: &'static str,
}

impl BoundaryWords {
    pub(super) fn of(law: Law) -> Self {
        if law.is_signorini() {
            Self { holds: "contact", total: CONTACT_FORCE }
        } else {
            Self { holds: "sticks", total: FLUX }
        }
    }

    /// Returns, as text, the total flux and minus the integral of f, which are equal at the solution.
    pub(super) fn force(&self, sums: [f64; 2], rounding: f64, digits: usize) -> String {
        let [force, minus_integral] = sums.map(|sum| balance(sum, rounding, digits));
        format!("{} {force}, minus the integral of f {minus_integral}\n", self.total)
    }

    /// Returns, as text, the place and the force of an arc at zero.
    pub(super) fn arc(&self, arc: &ContactArc, rounding: f64, digits: usize) -> String {
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
        format!("{} {place}, force {}\n", self.holds, balance(arc.force, rounding, digits))
    }
}

/// Returns a point with the digits that it has.
fn known_point([point, errors]: [[f64; 2]; 2]) -> String {
    let [x, y] =
        [0, 1].map(|axis| shared([point[axis] - errors[axis], point[axis] + errors[axis]]));
    format!("({x}, {y})")
}

/// Returns a term of the balance of the flux with f as text, a sum of rounding errors as zero.
fn balance(term: f64, rounding: f64, digits: usize) -> String {
    plain(if term.abs() <= rounding { 0.0 } else { term }, digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_rounding_errors_are_zero() {
        let rounding = 3e-12;
        let words = BoundaryWords::of(Law::SIGNORINI);
        for (force, shown) in [(-3.69843e-15, "force 0\n"), (2e-11, "force 2.00000e-11\n")] {
            let arc = ContactArc::new([[0.0, 0.0], [1.0, 0.0]], force, 1.0);
            let text = words.arc(&arc, rounding, 6);
            assert!(text.ends_with(shown), "{text}");
        }
        assert!(words.force([1e-16, 2.0], rounding, 6).starts_with("contact force 0, "));
    }
}
