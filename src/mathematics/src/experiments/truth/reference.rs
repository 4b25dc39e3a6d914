//! Values of a true solution, to as many digits as two resolutions agree on and rounding leaves.

use crate::problem::source::Source;
use crate::spectral::{Checks, Solution};
use serde::{Deserialize, Serialize};

/// A problem and its solution in numbers, as a reference for other programs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reference {
    /// Name of the problem.
    pub name: String,
    /// f in the notation of scenes.
    pub f: String,
    /// Solution.
    #[serde(flatten)]
    pub numbers: Numbers<ReferenceValue>,
    /// Total force plus the integral of f, over the latter: zero but for errors.
    pub green: f64,
    /// Energy by Rellich's identity less the energy, over the latter: zero but for errors.
    pub rellich: f64,
}

/// A true solution in numbers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Numbers<V> {
    /// J(v).
    pub energy: V,
    /// v(0, 0).
    pub centre: V,
    /// v in the corners: lower left, lower right, upper right, upper left.
    pub corners: [V; 4],
    /// Contact, anticlockwise, first the arc that ends first after the lower right corner.
    pub contact: Vec<ReferenceArc<V>>,
}

/// Arc of contact.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ReferenceArc<V> {
    /// Point at which the arc begins.
    pub from: [V; 2],
    /// Point at which the arc ends; equal to `from` if all of the boundary is in contact.
    pub to: [V; 2],
    /// Integral of the multiplier over the arc.
    pub force: V,
}

impl<V> Numbers<V> {
    /// Iterates over all numbers, in the order of the fields.
    pub fn each(&mut self) -> impl Iterator<Item = &mut V> {
        let Self { energy, centre, corners, contact } = self;
        let arcs = contact
            .iter_mut()
            .flat_map(|ReferenceArc { from, to, force }| from.iter_mut().chain(to).chain([force]));
        [energy, centre].into_iter().chain(corners).chain(arcs)
    }
}

/// Number of decimals that rounding errors do not reach: beyond, both resolutions may have the same error.
const DECIMALS: usize = 14;

/// Number at the finer of two resolutions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ReferenceValue {
    /// Number as a double.
    pub value: f64,
    /// Decimals on which both resolutions agree, at most 14, rounded; or those of a more accurate program.
    pub digits: String,
}

impl ReferenceValue {
    fn of([rough, fine]: [f64; 2]) -> Self {
        // Zero on contact, and halves on the sides of the square, hold by construction.
        if fine == rough && (2.0 * fine).fract() == 0.0 {
            return Self { value: fine, digits: format!("{}", fine + 0.0) };
        }
        let mut digits = String::new();
        for places in (0..=DECIMALS).rev() {
            let written = decimals(fine, places);
            if written == decimals(rough, places) {
                digits = written;
                break;
            }
        }
        Self { value: fine, digits }
    }
}

/// Writes `x` with this number of decimals; zero has no sign.
fn decimals(x: f64, places: usize) -> String {
    let text = format!("{x:.places$}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

impl Reference {
    /// Takes the solution of a problem at two resolutions.
    pub(super) fn of(name: &str, f: &Source, solutions: &Resolutions) -> Self {
        // The solver counts from the lower right corner.
        let corners = [3, 0, 1, 2].map(|k| solutions.value(|s| s.corners()[k]));
        let arcs = solutions.rough.contact.len().min(solutions.fine.contact.len());
        let numbers = Numbers {
            energy: solutions.value(|s| s.energy),
            centre: solutions.value(|s| s.value(0.0, 0.0)),
            corners,
            contact: (0..arcs).map(|k| solutions.arc(k)).collect(),
        };
        let Checks { green, rellich, .. } = solutions.fine.checks;
        Self { name: name.into(), f: f.to_string(), numbers, green, rellich }
    }
}

/// Solution of one problem at two resolutions.
pub(super) struct Resolutions {
    pub(super) rough: Solution,
    pub(super) fine: Solution,
}

impl Resolutions {
    fn value(&self, number: impl Fn(&Solution) -> f64) -> ReferenceValue {
        ReferenceValue::of([number(&self.rough), number(&self.fine)])
    }

    /// The k-th arc of contact.
    fn arc(&self, k: usize) -> ReferenceArc<ReferenceValue> {
        ReferenceArc {
            from: [0, 1].map(|axis| self.value(|s| s.contact[k].from[axis])),
            to: [0, 1].map(|axis| self.value(|s| s.contact[k].to[axis])),
            force: self.value(|s| s.contact[k].force),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digits(rough: f64, fine: f64) -> String {
        ReferenceValue::of([rough, fine]).digits
    }

    #[test]
    fn digits_are_those_of_both_resolutions() {
        // 0.12345679 and 0.12345678 with a decimal more.
        assert_eq!(digits(0.123456789, 0.123456781), "0.1234568");
        assert_eq!(digits(-0.5, -0.5), "-0.5");
        assert_eq!(digits(0.25, 0.25), "0.25000000000000");
        assert_eq!(digits(0.0, 0.0), "0");
        assert_eq!(digits(-1e-18, 1e-18), "0.00000000000000");
    }
}
