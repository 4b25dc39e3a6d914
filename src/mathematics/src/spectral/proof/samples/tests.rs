//! Bounds between points against functions that are zero at the points, and against many more points.

use super::*;
use crate::problem::complex::Complex;
use crate::spectral::fit::field::nodes_at;
use crate::spectral::geometry::panels::{Spot, gauss};
use crate::spectral::proof::Proof;
use crate::spectral::proof::bench::known::SolvedKnown;
use crate::spectral::proof::bench::solved;
use crate::spectral::proof::bench::spoilt::Spoiling;
use std::f64::consts::TAU;

const QUANTITIES: [Quantity; 3] = [Quantity::Value, Quantity::Flux, Quantity::Slope];

/// Samples of a problem, and of the same spoilt by a power and a pole.
fn samples(own: &mut SolvedKnown) -> Vec<Sampled> {
    Spoiling::Power(5, Complex::new(3e-2, 1e-2)).spoil(&mut own.found.fit);
    Spoiling::Pole(0, 0.2, Complex::new(1e-2, 1e-3)).spoil(&mut own.found.fit);
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    proof.samples(&proof.cells().unwrap())
}

/// Cell of a disc on which all is zero at the points.
fn zero() -> Sampled {
    let own = solved("disc in contact");
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let mut sampled = proof.samples(&proof.cells().unwrap()[..1]).remove(0);
    for node in &mut sampled.nodes {
        (node.value, node.flux) = (0.0, 0.0);
    }
    sampled.slopes.fill(0.0);
    sampled.rounding.fill([0.0; 2]);
    sampled.moduli = CellModuli::default();
    sampled
}

/// Legendre polynomials of degrees up to 28 at a point.
fn legendre_at(x: Complex) -> Vec<Complex> {
    let mut all = vec![Complex::new(1.0, 0.0), x];
    for k in 1..POINTS {
        let order = k as f64;
        let next = (x * all[k]).scaled(2.0 * order + 1.0) - all[k - 1].scaled(order);
        all.push(next.scaled(1.0 / (order + 1.0)));
    }
    all
}

#[test]
fn what_vanishes_at_the_points_is_bounded_by_its_modulus_on_the_ellipse() {
    for quantity in QUANTITIES {
        let mut own = zero();
        let rho = own.own.cell.rho;
        // The polynomial whose zeros are the points, which is 1 at an end, and -0.4 between.
        let on_ellipse = (0..200).map(|k| {
            let way = Complex::unit(TAU * f64::from(k) / 200.0).scaled(rho);
            legendre_at((way + Complex::new(1.0, 0.0) / way).scaled(0.5))[POINTS].norm()
        });
        let modulus = on_ellipse.fold(0.0, f64::max);
        match quantity {
            Quantity::Value => own.moduli.value = vec![[0.0, 0.5 * modulus], [0.0, 0.5 * modulus]],
            _ => own.moduli.slope = vec![[1.0, 0.5 * modulus], [1.0, 0.5 * modulus]],
        }
        let [lower, upper] = own.bounds(Test::of(quantity), 0.0);
        assert!((1.0..100.0).contains(&upper), "{quantity:?}: {upper}");
        assert!((-100.0..-0.4).contains(&lower), "{quantity:?}: {lower}");
        let deficit = own.deficit(Test::of(quantity));
        let length = own.own.cell.length();
        assert!(deficit.most > 0.4 && deficit.scaled > 0.4 && deficit.room == 0.0, "{deficit:?}");
        // Half of the integral of the modulus of the polynomial, whose own integral is zero.
        assert!(deficit.integral > 0.08 * length, "{deficit:?}");
    }
}

#[test]
fn rounding_errors_at_the_points_are_bounded_between_them() {
    let error = 1e-3;
    let weights = legendre();
    // Moduli at an end of the polynomials that are 1 at one of the points.
    let sizes: Vec<f64> = weights.iter().map(|own| own.iter().sum::<f64>().abs()).collect();
    let most = sizes.iter().sum::<f64>();
    assert!(most > 5.0 && most < POINTS as f64, "{most}");
    for (which, quantity) in [(0, QUANTITIES[0]), (1, QUANTITIES[1]), (1, QUANTITIES[2])] {
        let mut own = zero();
        own.rounding.iter_mut().for_each(|errors| errors[which] = error);
        let [lower, upper] = own.bounds(Test::of(quantity), 0.0);
        assert!(upper >= most * error && lower <= -most * error, "{quantity:?}: {upper}");
        for (k, size) in sizes.iter().enumerate() {
            own.rounding.fill([0.0; 2]);
            own.rounding[k][which] = error;
            let [_, upper] = own.bounds(Test::of(quantity), 0.0);
            assert!(upper >= size.max(1.0) * error, "{quantity:?} {k}: {upper}");
            let noise = own.noise(quantity) / if which == 1 { own.own.cell.length() } else { 1.0 };
            assert!(noise >= error, "{quantity:?} {k}: {noise}");
        }
    }
}

/// Values at many points of a cell: distances from the end, weights, and v, its flux and its slope.
fn dense(own: &SolvedKnown, sampled: &Sampled) -> Vec<([f64; 2], [f64; 3])> {
    let (fit, cell) = (&own.found.fit, &sampled.own);
    let nodes = cell.cell.nodes(gauss(45));
    let spots: Vec<Spot> = nodes
        .iter()
        .map(|[r, weight]| fit.walk.spot(cell.interval, cell.side, *r, *weight))
        .collect();
    let values = nodes_at(&own.setup, fit, &spots);
    let [_, slopes] = fit.at(&spots, true);
    let points: Vec<Complex> = spots.iter().map(|spot| spot.z).collect();
    let gradients = own.setup.jumps.psi.gradients(&points);
    let all = nodes.into_iter().zip(values).zip(slopes.iter().zip(gradients));
    all.map(|((node, own), (slope, gradient))| {
        let along = (*slope * own.spot.tangent).re + gradient.dot(own.spot.tangent);
        (node, [own.value, own.flux, along])
    })
    .collect()
}

#[test]
fn bounds_of_cells_hold_at_many_points_and_are_near_to_the_largest() {
    for name in [
        "disc in contact",
        "bar that slips up",
        "three quarters of a disc",
        "crossings on a disc",
        "ring in contact",
    ] {
        let mut own = solved(name);
        let all = samples(&mut own);
        let (mut wide, mut narrow) = (0.0, 0.0);
        for sampled in &all {
            let dense = dense(&own, sampled);
            let is_log = sampled.own.cell.is_log;
            for (which, quantity) in QUANTITIES.into_iter().enumerate() {
                let largest =
                    dense.iter().fold(0.0f64, |most, (_, own)| most.max(own[which].abs()));
                let middle = dense[20].1[which];
                for (sign, constant) in [
                    (1.0, 0.0),
                    (-1.0, 0.0),
                    (1.0, middle),
                    (-1.0, middle),
                    (1.0, -2.0 * largest),
                    (1.0, 1e-3),
                ] {
                    let test = Test { quantity, sign, constant };
                    let tested = dense
                        .iter()
                        .map(|([r, weight], own)| (*r, *weight, sign * (own[which] - constant)));
                    let (mut least, mut most, mut integral, mut scaled, mut highest) =
                        (f64::INFINITY, 0.0f64, 0.0, 0.0f64, 0.0f64);
                    for (r, weight, value) in tested {
                        let scale = if is_log && which > 0 { r } else { 1.0 };
                        least = least.min(value);
                        most = most.max(scale * value.abs());
                        integral += weight * (-value).max(0.0);
                        scaled = scaled.max(if is_log { r } else { 1.0 } * -value);
                        highest = highest.max(-value);
                    }
                    let small = 1e-13 + 1e-9 * most;
                    let deficit = sampled.deficit(test);
                    let bound = sampled.most(test);
                    let facts = format!(
                        "{name} {:?} {test:?} {deficit:?} {least} {integral} {scaled}",
                        sampled.own
                    );
                    assert!(bound >= most * (1.0 - 1e-12), "{facts} {bound} {most}");
                    assert!(deficit.most >= highest - small, "{facts}");
                    assert!(
                        deficit.integral
                            >= integral * (1.0 - 1e-3) - small * sampled.own.cell.span[1],
                        "{facts}"
                    );
                    assert!(deficit.scaled >= scaled - small, "{facts}");
                    assert!(deficit.room <= least.max(0.0) + small, "{facts}");
                    if constant == 0.0 {
                        wide += bound;
                        narrow += most;
                    }
                    if constant == -2.0 * largest && largest > 1e-6 && !is_log {
                        assert!(deficit.room > 0.3 * largest, "{facts}");
                    }
                }
            }
        }
        assert!(wide < 4.0 * narrow, "{name}: {wide} {narrow}");
    }
}

#[test]
fn positions_that_are_off_count_by_the_slopes_of_what_is_computed() {
    // With a power, whose slopes are large, and without, where psi is.
    for c in [0.7, 0.0] {
        positions_count(9, c);
    }
}

/// Checks errors of positions on a disc to which `c Re z^n` is added.
fn positions_count(n: usize, c: f64) {
    let mut own = solved("disc in contact");
    Spoiling::Power(n, Complex::new(c, 0.0)).spoil(&mut own.found.fit);
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let unit = f64::EPSILON;
    for sampled in proof.samples(&proof.cells().unwrap()) {
        let spots: Vec<Spot> = sampled.nodes.iter().map(|node| node.spot).collect();
        let fit = &proof.fit;
        let sums = fit.functions.bounded_sums(&fit.all_coefficients(), &spots);
        for (i, node) in sampled.nodes.iter().enumerate() {
            let slope = node.flux.hypot(sampled.slopes[i]);
            // Second derivatives of the power, less those of psi and the rest.
            let bend = (n * (n - 1)) as f64 * c - 2.0;
            let [value, derivative] = sampled.rounding[i];
            assert!(
                value >= 2.0 * unit * slope && value < 300.0 * unit * slope.max(1.0),
                "{value} {slope}"
            );
            assert!(
                derivative >= 2.0 * unit * bend && derivative < 300.0 * unit * bend.max(1.0),
                "{derivative} {bend}"
            );
            let psi = sampled.psi[i];
            // On top of those of g and psi.
            let [of_value, of_derivative] = sums[i].errors;
            let [more, steeper] =
                [value - of_value - psi.value, derivative - of_derivative - psi.slope];
            assert!(more >= 1.9 * unit * slope, "{more:e} {slope}");
            assert!(steeper >= 1.9 * unit * bend, "{steeper:e} {bend}");
        }
        for test in [Test::of(Quantity::Flux), Test::of(Quantity::Slope)] {
            // Largest second derivative along the circle of radius 1.
            let bend = sampled.bend(test);
            let dense = (0..200).map(|k| {
                let half = 0.5 * (sampled.distances[0] - sampled.distances[POINTS - 1]);
                let middle = 0.5 * (sampled.distances[0] + sampled.distances[POINTS - 1]);
                let s = middle + half * (f64::from(k) / 100.0 - 1.0);
                let at = if sampled.own.side == 0 { s } else { TAU - s };
                (n * n) as f64
                    * c
                    * match test.quantity {
                        Quantity::Flux => libm::sin(n as f64 * at).abs(),
                        _ => libm::cos(n as f64 * at).abs(),
                    }
            });
            let most = dense.fold(0.0, f64::max);
            assert!(bend >= most - 0.1 && bend < 20.0 * (most + 1.0), "{bend} {most}");
        }
    }
}

#[test]
fn moduli_on_ellipses_are_those_at_both_ends() {
    let own = solved("bar with gaps");
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let mut all = proof.samples(&proof.cells().unwrap());
    let sampled =
        all.iter_mut().find(|own| own.own.cell.is_log && own.own.cell.span[0] > 1e-9).unwrap();
    let (to, [near, far]) = (sampled.own.cell.span[1], sampled.own.cell.distances);
    sampled.moduli =
        CellModuli { value: vec![[1.5, 2.0]], slope: vec![[0.5, 2.0]], ..CellModuli::default() };
    for power in [0.0, 1.0, 3.0] {
        let scale = |r: f64| libm::pow(r / to, power);
        for r in [near, (near * far).sqrt(), far] {
            // 2 r^1.5, and r times the slope 2 r^0.5.
            let value = 2.0 * libm::pow(r, 1.5) * scale(r);
            let slope = 2.0 * libm::pow(r, -0.5) * scale(r);
            let constant = 3.0 * scale(r);
            let least = 1.0 - 1e-12;
            assert!(sampled.modulus(Test::of(Quantity::Value), power) >= least * value);
            assert!(sampled.modulus(Test::of(Quantity::Flux), power) >= least * slope);
            let shifted = Test { constant: -3.0, ..Test::of(Quantity::Slope) };
            assert!(sampled.modulus(shifted, power) >= least * (slope + constant));
        }
    }
}

#[test]
fn moduli_of_functions_of_a_split_hold_at_the_points() {
    let mut own = solved("ends of contact on a disc");
    let walk = &own.found.fit.walk;
    let end = walk.splits.iter().position(|split| split.end.is_some()).unwrap();
    Spoiling::Root(end, 0.3, Complex::new(50.0, 20.0)).spoil(&mut own.found.fit);
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let mut seen = 0;
    for sampled in proof.samples(&proof.cells().unwrap()) {
        let at = own.found.fit.walk.intervals[sampled.own.interval].splits[sampled.own.side];
        if !sampled.own.cell.is_log || at != end {
            continue;
        }
        seen += 1;
        for ((node, slope), &r) in sampled.nodes.iter().zip(&sampled.slopes).zip(&sampled.distances)
        {
            let sum = |terms: &[[f64; 2]]| {
                terms.iter().map(|[power, m]| m * libm::pow(r, *power)).sum::<f64>()
            };
            let (value, rate) = (sum(&sampled.moduli.value), sum(&sampled.moduli.slope));
            assert!(value >= node.value.abs(), "{:?}: {value} {}", sampled.own, node.value);
            assert!(rate >= r * node.flux.hypot(*slope), "{:?}: {rate} {}", sampled.own, node.flux);
        }
    }
    assert!(seen > 4, "{seen}");
}
