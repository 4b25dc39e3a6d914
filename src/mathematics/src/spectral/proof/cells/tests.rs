//! Errors of polynomials and Gauss rules against functions that are known, and ellipses against singular points.

use super::*;
use crate::spectral::proof::Proof;
use crate::spectral::proof::bench::known::SolvedKnown;
use crate::spectral::proof::bench::solved;
use std::f64::consts::TAU;

/// Cell of the unit interval (-1, 1) with an ellipse of a given sum of half axes.
fn cell(rho: f64) -> EllipseCell {
    let disc = Disc { centre: Complex::default(), radius: rho, inner: 0.0 };
    EllipseCell { span: [-1.0, 1.0], is_log: false, rho, disc, distances: [-rho, rho] }
}

/// Chebyshev polynomial of a degree on (-1, 1).
fn chebyshev(degree: usize, x: f64) -> f64 {
    let (mut before, mut own) = (1.0, x);
    for _ in 1..degree {
        (before, own) = (own, 2.0 * x * own - before);
    }
    own
}

/// Largest modulus of that on an ellipse.
fn modulus(degree: usize, rho: f64) -> f64 {
    let size = libm::pow(rho, degree as f64);
    0.5 * (size + 1.0 / size)
}

#[test]
fn errors_of_gauss_rules_are_bounded_within_a_constant() {
    // The rule of 28 points integrates degrees up to 55.
    for degree in [56, 58] {
        let exact = -2.0 / ((degree * degree) as f64 - 1.0);
        for rho in [3.5, 6.0] {
            let cell = cell(rho);
            let nodes = cell.nodes(gauss(POINTS));
            let sum: f64 = nodes.iter().map(|[x, weight]| weight * chebyshev(degree, *x)).sum();
            let (error, bound) = ((sum - exact).abs(), cell.gauss_error(modulus(degree, rho)));
            assert!(error > 0.1 && error < bound, "{degree} {rho}: {error} {bound}");
            let most = 4.0 * libm::pow(rho, degree as f64 - 54.0);
            assert!(bound < most, "{degree} {rho}: {bound} {most}");
        }
    }
}

#[test]
fn errors_of_interpolation_are_bounded_within_a_constant() {
    let weights = legendre();
    for (degree, rho) in [(28, 3.5), (29, 3.5), (28, 6.0), (30, 6.0)] {
        let cell = cell(rho);
        let mut coefficients = [0.0; POINTS];
        for (node, weights) in gauss(POINTS).iter().zip(&weights) {
            let value = chebyshev(degree, 2.0 * node.x - 1.0);
            coefficients.iter_mut().zip(weights).for_each(|(c, weight)| *c += value * weight);
        }
        // All Legendre polynomials are 1 at the end.
        let error = (coefficients.iter().sum::<f64>() - 1.0).abs();
        let bound = cell.tail(modulus(degree, rho));
        assert!(error > 1.0 && error < bound, "{degree} {rho}: {error} {bound}");
        let best = 2.0 * modulus(degree, rho) * libm::pow(rho, -27.0) / (rho - 1.0);
        assert!((bound / best - 29.0).abs() < 1e-9, "{degree} {rho}: {bound} {best}");
    }
}

/// Places on the ellipse of a cell, in its variable seen from its middle.
fn on_ellipse(cell: &EllipseCell) -> Vec<Complex> {
    let half = 0.5 * cell.length();
    let places = (0..64).map(|k| {
        let way = Complex::unit(TAU * f64::from(k) / 64.0);
        (way.scaled(cell.rho) + way.conj().scaled(1.0 / cell.rho)).scaled(0.5 * half)
    });
    places.collect()
}

/// Position on a curve at a complex distance, seen from where that is zero and in the direction there.
fn position(curvature: f64, s: Complex) -> Complex {
    // Where the chord is the arc but for rounding.
    if curvature * s.norm() < 1e-8 {
        return s;
    }
    let turned = s.turned().scaled(curvature);
    let size = libm::exp(turned.re);
    (Complex::unit(turned.im).scaled(size) - Complex::new(1.0, 0.0)).scaled(1.0 / curvature)
}

fn all_cells(own: &SolvedKnown) -> (Proof<'_>, Vec<ProofCell>) {
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let mut cells = proof.cells().unwrap();
    // Halves, as where signs are not certain.
    let halves: Vec<ProofCell> =
        cells.iter().step_by(3).filter_map(|own| proof.halves(*own)).flatten().collect();
    cells.extend(halves);
    (proof, cells)
}

#[test]
fn ellipses_lie_in_discs_that_hold_no_singular_point() {
    for name in [
        "crossings on a disc",
        "three quarters of a disc",
        "bar with gaps",
        "disc beside the middle",
        "ends of contact on a disc",
        "ring in contact",
        "half triangle",
    ] {
        let own = solved(name);
        let (proof, cells) = all_cells(&own);
        assert!(cells.iter().any(|own| !own.cell.is_log), "{name}");
        let psi = own.setup.jumps.singular.iter().map(|&z| (z, None));
        let singular: Vec<_> = proof.singular.points.iter().copied().chain(psi).collect();
        for own in &cells {
            let (cell, interval) = (&own.cell, &proof.fit.walk.intervals[own.interval]);
            let curvature = interval.curvature.abs();
            let split = cell.is_log.then_some(interval.splits[own.side]);
            for (z, number) in &singular {
                let away = (*z - cell.disc.centre).norm();
                let is_own = split.is_some() && (*number == split || away < 1e-9);
                assert!(is_own || away > cell.disc.radius, "{name}: {own:?} {z:?}");
            }
            let middle = match cell.is_log {
                true => 0.5 * libm::log(cell.span[0] * cell.span[1]),
                false => 0.5 * (cell.span[0] + cell.span[1]),
            };
            let mut reached = 0.0f64;
            for place in on_ellipse(cell) {
                let from_end = match cell.is_log {
                    true => Complex::unit(place.im).scaled(libm::exp(middle + place.re)),
                    false => place.shifted(middle),
                };
                let seen = if cell.is_log { from_end } else { place };
                let along = if cell.is_log { from_end.norm() } else { from_end.re };
                let [least, most] = cell.distances;
                let unit = 1e-9 * most;
                let is_between = least - unit <= along && along <= most + unit;
                assert!(is_between, "{name}: {own:?} {along}");
                for s in [seen, seen.conj()] {
                    let away = position(curvature, s).norm();
                    let radius = cell.disc.radius * (1.0 + 1e-12);
                    assert!(cell.disc.inner <= away && away <= radius, "{name}: {own:?} {away}");
                    reached = reached.max(away);
                }
            }
            assert!(cell.is_log || reached > 0.7 * cell.disc.radius, "{name}: {own:?} {reached}");
            // Bounds fall by 3 with each of 28 points at least.
            assert!(cell.rho > 3.0 || cell.is_log && cell.rho > 1.5, "{name}: {own:?}");
        }
    }
}
