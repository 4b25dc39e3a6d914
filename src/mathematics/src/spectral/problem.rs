//! Data of the right-hand side that do not depend on the ends of contact.

use super::boundary::BoundaryPotential;
use super::curve::SAME;
use super::domain::PlaneDomain;
use super::jumps::{APART, Jumps};
use super::panels::Panel;
use super::place::{BoundaryPlace, on_side, tangent};
use crate::discrete::cells::SweepCut;
use crate::discrete::load::integral;
use crate::problem::law::Law;
use crate::problem::source::Source;
use std::f64::consts::FRAC_1_PI;

/// Data of the right-hand side that do not depend on the ends of contact.
#[derive(Clone)]
pub(super) struct SpectralProblem {
    pub law: Law,
    pub f: Source,
    pub jumps: Jumps,
    pub boundary_psi: BoundaryPotential,
    /// Integral of f over the square.
    pub integral: f64,
    /// Integral of |f|.
    pub mass: f64,
    /// Integrals of f times 1, x, y, xy and x^2 - y^2, in closed form.
    pub moments: [f64; 5],
}

impl SpectralProblem {
    /// Data for the paper's law.
    pub(super) fn new(f: &Source) -> Self {
        let jumps = Jumps::of_pieces(&PlaneDomain::square(), f);
        let mut jumps = jumps.expect("a square has no bays");
        jumps.psi.complete(|z| f.at(z.coordinates()));
        let [one, x, y, xy, xx, yy, ..] = moments(f);
        let [mass, ..] = moments(&f.absolute());
        let moments = [one, x, y, xy, xx - yy];
        Self {
            law: Law::SIGNORINI,
            f: f.clone(),
            boundary_psi: BoundaryPotential::new(&jumps),
            integral: integral(f),
            mass,
            moments,
            jumps,
        }
    }

    /// f beside a panel of the boundary, read far from the points at which jumps meet the side, since a circle may
    /// leave it slowly, and at no round fraction, since f may have another value there.
    pub(super) fn beside(&self, panel: &Panel) -> f64 {
        let (side, middle) = panel.place(0.5 * (panel.from + panel.to)).on_side();
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for t in on_side(&self.jumps.crossings, side) {
            if t <= middle {
                low = low.max(t);
            } else {
                high = high.min(t);
            }
        }
        let along = [low, low + FRAC_1_PI * (high - low), high]
            .map(|t| BoundaryPlace { corner: side, t }.point());
        let step = self.jumps.room(along, SAME, APART);
        let beside = along[1] + tangent(side, 1.0).turned().scaled(step);
        self.f.at(beside.coordinates())
    }
}

/// Integrals of a piecewise constant f times 1, x, y, xy, x^2, y^2, x^2 y and x y^2: the square is one cell.
fn moments(f: &Source) -> [f64; 8] {
    let mut square = SweepCut::default();
    if let Source::Pieces { background, pieces } = f {
        let seen = pieces.iter().rev().map(|(shape, f)| (shape.seen_from([0.0; 2], 1.0), *f));
        square.set(*background, seen);
    }
    square.moments().f
}
