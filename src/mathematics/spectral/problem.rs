//! What a right-hand side is to the solver, whatever the ends of contact are.

use super::border::Border;
use super::curve::SAME;
use super::jumps::{APART, Jumps};
use super::panels::Panel;
use super::place::{Place, tangent};
use crate::discrete::cells::Cut;
use crate::discrete::load::integral;
use crate::problem::shape::Convex;
use crate::problem::source::{Region, Source};
use std::f64::consts::FRAC_1_PI;

/// What does not change with the ends of contact.
#[derive(Clone)]
pub(super) struct Problem {
    pub jumps: Jumps,
    pub border: Border,
    /// Integral of f over the square.
    pub integral: f64,
    /// Integral of |f|.
    pub mass: f64,
    /// Integrals of f times 1, x, y, xy and x^2 - y^2, in closed form.
    pub moments: [f64; 5],
}

impl Problem {
    pub(super) fn new(f: &Source) -> Self {
        let jumps = Jumps::of(f);
        let [one, x, y, xy, xx, yy, ..] = moments(f);
        let [mass, ..] = moments(&f.absolute());
        let moments = [one, x, y, xy, xx - yy];
        Self { border: Border::new(&jumps), integral: integral(f), mass, moments, jumps }
    }

    /// f beside a panel of the border, read far from where jumps meet the side, since a circle may leave it slowly,
    /// and at no round fraction, where f may be one of its own.
    pub(super) fn beside(&self, panel: &Panel) -> f64 {
        let (side, middle) = panel.place(0.5 * (panel.from + panel.to)).on_side();
        let crossings = || self.jumps.crossings_on(side);
        let low = crossings().filter(|&t| t <= middle).fold(0.0, f64::max);
        let high = crossings().filter(|&t| t > middle).fold(1.0, f64::min);
        let along =
            [low, low + FRAC_1_PI * (high - low), high].map(|t| Place { corner: side, t }.point());
        let step = self.jumps.room(along, SAME, APART);
        self.jumps.value(along[1] + tangent(side, 1.0).turned().scaled(step))
    }
}

/// Integrals of a piecewise constant f times 1, x, y, xy, x^2, y^2, x^2 y and x y^2: the square is one cell.
fn moments(f: &Source) -> [f64; 8] {
    let mut square = Cut::default();
    if let Source::Pieces { background, pieces } = f {
        let seen = |&(region, value): &(Region, f64)| (region.seen_from(0.0, [0.0], 1.0), value);
        square.set(*background, pieces.iter().rev().map(seen));
    }
    square.moments().f
}
