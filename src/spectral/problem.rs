//! What a right-hand side is to the solver, whatever the ends of contact are.

use super::border::Border;
use super::curve::SAME;
use super::jumps::Jumps;
use super::panels::Panel;
use super::place::{Place, tangent};
use crate::discrete::load::integral;
use crate::problem::source::Source;
use std::f64::consts::FRAC_1_PI;

/// What does not change with the ends of contact.
#[derive(Clone)]
pub(super) struct Problem {
    pub jumps: Jumps,
    pub border: Border,
    /// Integral of f over the square.
    pub integral: f64,
}

impl Problem {
    pub(super) fn new(f: &Source) -> Self {
        let jumps = Jumps::of(f);
        Self { border: Border::new(&jumps), integral: integral(f), jumps }
    }

    /// f beside a panel of the border, read far from where jumps meet the side, since a circle may leave it slowly,
    /// and at no round fraction, where f may be one of its own.
    pub(super) fn beside(&self, panel: &Panel) -> f64 {
        let (side, middle) = panel.place(0.5 * (panel.from + panel.to)).on_side();
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for (of, t) in self.jumps.crossings.iter().map(|place| place.on_side()) {
            match of == side {
                true if t <= middle => low = low.max(t),
                true => high = high.min(t),
                false => {}
            }
        }
        let place = Place { corner: side, t: low + FRAC_1_PI * (high - low) };
        self.jumps.value(place.point() + tangent(side, 1.0).turned().scaled(SAME))
    }
}
