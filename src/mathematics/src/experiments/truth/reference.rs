//! Values of a true solution, to as many digits as two resolutions agree on and rounding leaves.

use crate::discrete::contact::ContactArc;
use crate::problem::source::Source;
use crate::spectral::{Checks, Solution};
use serde::{Deserialize, Serialize};

/// A problem and its solution in numbers for others to compare with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reference {
    /// Name.
    pub name: String,
    /// f in the notation of scenes.
    pub f: String,
    /// The solution.
    #[serde(flatten)]
    pub numbers: Numbers<ReferenceValue>,
    /// The total force plus the integral of f, over the latter: zero but for errors.
    pub green: f64,
    /// The energy by Rellich's identity less the energy, over the latter: zero but for errors.
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

/// An arc of contact.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ReferenceArc<V> {
    /// First point.
    pub from: [V; 2],
    /// Last point; the same point as `from` if all of the boundary is in contact.
    pub to: [V; 2],
    /// Integral of the multiplier over it.
    pub force: V,
}

impl<V> Numbers<V> {
    /// All of them, in the order of the fields.
    pub fn each(&mut self) -> impl Iterator<Item = &mut V> {
        let Self { energy, centre, corners, contact } = self;
        let arcs = contact
            .iter_mut()
            .flat_map(|ReferenceArc { from, to, force }| from.iter_mut().chain(to).chain([force]));
        [energy, centre].into_iter().chain(corners).chain(arcs)
    }
}

/// Decimals that rounding leaves: beyond, both resolutions may make the same error.
const DECIMALS: usize = 14;

/// A number at the finer of two resolutions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ReferenceValue {
    /// As a double.
    pub value: f64,
    /// The decimals on which both resolutions agree, at most 14, rounded; or those of a better program.
    pub digits: String,
}

impl ReferenceValue {
    fn of([rough, fine]: [f64; 2]) -> Self {
        let written = |x: f64, places: usize| {
            let text = format!("{x:.places$}");
            // Zero has no sign.
            if text.trim_start_matches(['-', '0', '.']).is_empty() {
                text.trim_start_matches('-').to_owned()
            } else {
                text
            }
        };
        // Zero where contact is, and halves on the sides of the square, hold by construction.
        if fine == rough && (2.0 * fine).fract() == 0.0 {
            return Self { value: fine, digits: format!("{}", fine + 0.0) };
        }
        let digits = (0..=DECIMALS)
            .rev()
            .map(|places| (written(rough, places), written(fine, places)))
            .find(|(rough, fine)| rough == fine)
            .map_or_else(String::new, |(_, fine)| fine);
        Self { value: fine, digits }
    }
}

impl Reference {
    /// The solution at two resolutions, the finer one last.
    pub(super) fn of(name: &str, f: &Source, rough: &Solution, fine: &Solution) -> Self {
        let value = |of: &dyn Fn(&Solution) -> f64| ReferenceValue::of([of(rough), of(fine)]);
        // The solver counts from the lower right corner.
        let corners = [3, 0, 1, 2].map(|k| value(&|s| s.corners()[k]));
        let arc = |k: usize| {
            let of = |of: &dyn Fn(&ContactArc) -> f64| value(&|s| of(&s.contact[k]));
            ReferenceArc {
                from: [0, 1].map(|d| of(&|arc| arc.from[d])),
                to: [0, 1].map(|d| of(&|arc| arc.to[d])),
                force: of(&|arc| arc.force),
            }
        };
        let arcs = rough.contact.len().min(fine.contact.len());
        let numbers = Numbers {
            energy: value(&|s| s.energy),
            centre: value(&|s| s.value(0.0, 0.0)),
            corners,
            contact: (0..arcs).map(arc).collect(),
        };
        let Checks { green, rellich, .. } = fine.checks;
        Self { name: name.into(), f: f.to_string(), numbers, green, rellich }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_of_both_resolutions() {
        let digits = |rough, fine| ReferenceValue::of([rough, fine]).digits;
        // 0.12345679 and 0.12345678 with a decimal more.
        assert_eq!(digits(0.123456789, 0.123456781), "0.1234568");
        assert_eq!(digits(-0.5, -0.5), "-0.5");
        assert_eq!(digits(0.25, 0.25), "0.25000000000000");
        assert_eq!(digits(0.0, 0.0), "0");
        assert_eq!(digits(-1e-18, 1e-18), "0.00000000000000");
    }
}
