//! Brackets of known solutions, as they are and spoilt.
//!
//! With a harmonic h added to v, the energy that is printed changes by `1/2 int h h_n`, over where the flux is given,
//! less that over where v should be zero; all that bounds add is quadratic in h too.

use super::known::SolvedKnown;
use crate::problem::complex::Complex;
use crate::spectral::contact::search::PlaneFound;
use crate::spectral::fit::Fit;
use crate::spectral::fit::field::nodes_at;
use crate::spectral::functions::{Family, Power};
use crate::spectral::geometry::boundary::State;
use crate::spectral::geometry::panels::Spot;
use crate::spectral::setup::Setup;

/// Harmonic function that is added to v.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Spoiling {
    /// Re c z^n.
    Power(usize, Complex),
    /// A pole at this share of an interval's length behind its middle.
    Pole(usize, f64, Complex),
    /// The square root that belongs to an end of contact at a split, with a cut of this length.
    Root(usize, f64, Complex),
    /// A logarithm and the first power of a hole.
    OfHole(usize, f64, Complex),
}

impl Spoiling {
    /// Adds the function to a fit.
    pub(crate) fn spoil(self, fit: &mut Fit) {
        match self {
            Self::Power(n, c) => {
                let parts = coordinates(&fit.functions.arnoldi, n);
                for (own, part) in fit.polynomial_mut().iter_mut().zip(parts) {
                    *own = *own + part * c;
                }
            }
            Self::Pole(interval, depth, c) => {
                let own = fit.walk.intervals[interval];
                let spot = fit.walk.spot(interval, 0, 0.5 * own.length, 0.0);
                let lengths = vec![depth * own.length];
                let powers = vec![Power::plain(1.0)];
                let inwards = spot.tangent.turned();
                fit.add(Family { point: spot.z, split: None, inwards, lengths, powers }, c);
            }
            Self::Root(split, length, c) => {
                let own = &fit.walk.splits[split];
                let (point, inwards) = (own.z, own.inwards());
                let (lengths, powers) = (vec![length], vec![Power::plain(0.5)]);
                fit.add(Family { point, split: Some(split), inwards, lengths, powers }, c);
            }
            Self::OfHole(hole, log, c) => {
                fit.logs[hole] += log;
                let families = fit.functions.families.iter().map(Family::many);
                let first: usize = families.sum::<usize>()
                    + fit.functions.holes[..hole].iter().map(|own| own.powers).sum::<usize>();
                fit.coefficients[first] = fit.coefficients[first] + c;
            }
        }
    }
}

impl Fit {
    /// Coefficients of the polynomials.
    fn polynomial_mut(&mut self) -> &mut [Complex] {
        let first = self.coefficients.len() - self.functions.arnoldi.len() - 1;
        &mut self.coefficients[first..]
    }

    /// Adds one function of a family.
    fn add(&mut self, family: Family, c: Complex) {
        let families = &mut self.functions.families;
        let many = families.iter().map(Family::many).sum();
        families.push(family);
        self.coefficients.insert(many, c);
    }
}

/// z^n in the polynomials of Arnoldi's matrix.
fn coordinates(arnoldi: &[Vec<Complex>], n: usize) -> Vec<Complex> {
    let mut own = vec![Complex::default(); arnoldi.len() + 1];
    own[0] = Complex::new(1.0, 0.0);
    for _ in 0..n {
        let mut next = vec![Complex::default(); own.len()];
        for (c, column) in own.iter().zip(arnoldi) {
            for (sum, entry) in next.iter_mut().zip(column) {
                *sum = *sum + *c * *entry;
            }
        }
        own = next;
    }
    own
}

/// Integrals of what was added to v: that by which the energy changes, and one that bounds of the energy may need.
pub(crate) fn added(setup: &Setup, before: &Fit, after: &PlaneFound) -> [f64; 2] {
    let (mut change, mut most, mut flux) = (0.0, 0.0f64, 0.0);
    let spots: Vec<Spot> = after.nodes.iter().map(|node| node.spot).collect();
    for (old, new) in nodes_at(setup, before, &spots).iter().zip(&after.nodes) {
        let [h, rate] = [new.value - old.value, new.flux - old.flux];
        let sign = if old.state == State::Held { -0.5 } else { 0.5 };
        change += sign * old.spot.weight * h * rate;
        flux += old.spot.weight * rate * rate;
        most = most.max(h.abs());
    }
    [change, most * most + flux]
}

/// Spoilings of a solution: everywhere, next to each interval, at ends and in holes, in both directions.
pub(crate) fn spoilings(own: &SolvedKnown) -> Vec<Spoiling> {
    let walk = &own.found.fit.walk;
    let mut all = vec![Spoiling::Power(0, Complex::new(-1e-3, 0.0))];
    let has_ends = walk.splits.iter().any(|split| split.end.is_some());
    for interval in 0..walk.intervals.len() {
        let size = [1e-3, -1e-5][interval % 2];
        // Signs that are not certain take time.
        if size < 0.0 || !has_ends {
            all.push(Spoiling::Pole(interval, 0.1, Complex::new(size, 0.0)));
        }
    }
    if has_ends {
        return all;
    }
    for (n, c) in [
        (0, Complex::new(1e-2, 0.0)),
        (1, Complex::unit(1.0).scaled(1e-4)),
        (3, Complex::unit(2.0).scaled(-1e-2)),
        (6, Complex::unit(3.0).scaled(1e-7)),
    ] {
        all.push(Spoiling::Power(n, c));
    }
    for hole in 0..own.found.fit.functions.holes.len() {
        all.push(Spoiling::OfHole(hole, 1e-3, Complex::new(0.0, 1e-3)));
        all.push(Spoiling::OfHole(hole, -1e-5, Complex::new(1e-3, 0.0)));
    }
    all
}

/// Checks that bounds hold an energy that is known but for rounding, with a name for messages.
pub(crate) fn check(name: &str, [lower, upper]: [f64; 2], energy: f64) {
    let unit = 2.0 * f64::EPSILON * energy.abs();
    assert!(lower <= energy + unit && energy - unit <= upper, "{name}: {lower} {energy} {upper}");
}
