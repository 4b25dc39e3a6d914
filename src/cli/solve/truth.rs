//! Parts of an answer that only a true solution has: its numbers, and the checks that they stand.

use super::bound::{self, TEN};
use super::clock::turning;
use crate::replication::numbers::Numbers;
use indicatif::ProgressBar;
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::solvers::Solved;

/// Returns a true solution in words; nothing of another.
pub(super) fn text(solved: &Solved, numbers: &Numbers) -> String {
    let Some(found) = solved.truth() else { return String::new() };
    let law = solved.problem.law();
    let mut text = String::new();
    if !law.is_signorini() {
        text += &format!("law {law}\n");
    }
    let digits = if found.bracket.is_ok() { 16 } else { TEN };
    let energy = numbers.shown_energy(digits);
    text += &format!("energy {energy}\n{}", bound::text(numbers, false));
    text + &bound::boundary(solved) + &checks(solved).unwrap_or_default()
}

/// Returns the checks of a true solution in words: the signs that hold, and the numbers that vanish.
fn checks(solved: &Solved) -> Option<String> {
    let checks = &solved.truth()?.checks;
    let [residual, balance] = [checks.residual, checks.balance];
    // Both are relative: what is as small is a rounding error.
    let [flux, sign] = [checks.flux, checks.sign]
        .map(|least| plain(if least.abs() < f64::EPSILON { 0.0 } else { least }, 2));
    Some(format!(
        "checks: least distance of the flux to the limits of the law {flux},\n  \
        least v of the right sign {sign}\n  \
        zero but for the error: v in contact {residual:.1e}, balance {balance:.1e}\n"
    ))
}

/// Evaluates a solution at so many nodes, under a bar.
pub(super) fn shown<T>([nodes, _]: [usize; 2], evaluate: impl FnOnce() -> T) -> T {
    let bar = turning(&format!("v at {nodes} nodes"));
    let values = evaluate();
    bar.inspect(ProgressBar::finish_and_clear);
    values
}
