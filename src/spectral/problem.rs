//! What a right-hand side is to the solver, whatever the ends of contact are.

use super::border::Border;
use super::jumps::Jumps;
use super::panels::{Ends, Panel, Place, panels};
use super::potential::Potential;
use crate::discrete::load::integral;
use crate::problem::source::Source;

/// What does not change with the ends of contact.
#[derive(Clone)]
pub(super) struct Problem {
    pub jumps: Jumps,
    pub psi: Potential,
    pub border: Border,
    /// Integral of f over the square.
    pub integral: f64,
    /// Where jumps of f meet the border.
    crossings: Vec<Place>,
}

impl Problem {
    pub(super) fn new(f: &Source) -> Self {
        let jumps = Jumps::of(f);
        let psi = Potential::new(&jumps);
        let crossings: Vec<Place> = jumps.crossings.iter().map(|&z| Place::of(z)).collect();
        let border = Border::new(&psi, &jumps, &crossings);
        Self { jumps, psi, border, integral: integral(f), crossings }
    }

    pub(super) fn panels(&self, ends: &Ends) -> Vec<Panel> {
        panels(ends, &self.crossings, &self.jumps)
    }
}
