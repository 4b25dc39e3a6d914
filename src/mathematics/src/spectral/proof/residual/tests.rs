//! Distances of v and its flux from what they should be, against sums over many points.

use super::*;
use crate::problem::complex::Complex;
use crate::spectral::proof::bench::known::SolvedKnown;
use crate::spectral::proof::bench::solved;
use crate::spectral::proof::bench::spoilt::Spoiling;
use crate::spectral::proof::extension::Room;

fn sampled(own: &SolvedKnown) -> (Proof<'_>, Vec<Sampled>) {
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let samples = proof.samples(&proof.cells().unwrap());
    (proof, samples)
}

/// A problem spoilt by powers.
fn spoilt(name: &str, powers: &[(usize, f64)]) -> SolvedKnown {
    let mut own = solved(name);
    for &(n, size) in powers {
        Spoiling::Power(n, Complex::new(size, 0.4 * size)).spoil(&mut own.found.fit);
    }
    own
}

/// Samples in walking order with their numbers.
fn in_order(proof: &Proof, samples: &[Sampled], ring: usize) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..samples.len()).filter(|&p| samples[p].nodes[0].ring == ring).collect();
    order.sort_by(|&p, &q| {
        let [a, b] =
            [p, q].map(|p| (samples[p].own.interval, samples[p].own.along(&proof.fit.walk)[0]));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    order
}

#[test]
fn both_ends_of_the_law_are_asked() {
    let all_sizes = Sizes { flux: 1.0, value: 1.0, ..Sizes::default() };
    // The flux is -1/2 under friction up to 0.6, and 1/2 under a limit of 0.6.
    for (name, sizes) in [("disc under friction", [0.3, -0.3]), ("disc under a limit", [0.3, -0.3])]
    {
        for size in sizes {
            let own = spoilt(name, &[(1, size)]);
            let (proof, samples) = sampled(&own);
            let (mut most, mut integral) = (0.0f64, 0.0);
            for own in &samples {
                let law = own.nodes[0].law;
                let violation = violation(law, own);
                let mut dense = 0.0;
                for node in &own.nodes {
                    let off = (law.lo() - node.flux).max(node.flux - law.hi()).max(0.0);
                    assert!(
                        violation.most >= off && violation.scaled >= off,
                        "{name}: {violation:?} {off}"
                    );
                    let room = (node.flux - law.lo()).min(law.hi() - node.flux).max(0.0);
                    assert!(violation.room <= room + 1e-12, "{name}: {violation:?} {room}");
                    dense += node.spot.weight * off;
                    most = most.max(off);
                }
                assert!(violation.integral >= dense, "{name}: {violation:?} {dense}");
                assert!(violation.most < 2.0 * most + 0.7, "{name}: {violation:?}");
                integral += dense;
            }
            assert!(integral > 0.1, "{name}");
            assert!(samples.iter().any(|own| uncertain(&proof, own, all_sizes)), "{name}");
        }
    }
    let law = Law::limited(0.3).unwrap();
    assert!(sign(law, 0.3) < 0.0 && sign(law, 0.0) > 0.0);
}

#[test]
fn distances_are_the_largest_of_all_cells() {
    for (name, powers) in [
        ("disc in contact", &[(0, 1e-3), (3, 1e-4)][..]),
        ("gap round a fixed hole", &[(0, -0.3), (2, -0.4)]),
        ("bar that slips down", &[(0, 0.05), (1, 0.06)]),
        ("bar that slips up", &[(0, -0.05), (1, -0.06)]),
        ("sector of 60 degrees", &[(0, 1e-3), (3, 1e-4)]),
        ("half triangle", &[(2, 1e-3)]),
        ("ring above a gap", &[(0, -0.15), (2, -0.2)]),
        ("hole below a gap", &[(0, 0.1), (1, 0.1)]),
        ("disc under two laws", &[(0, 1e-3), (3, 1e-4)]),
    ] {
        let own = spoilt(name, powers);
        let (proof, samples) = sampled(&own);
        let left: Vec<Leftover> = Vec::new();
        let distances = Distances::new(&proof, &samples, &left);
        let mut most = 0.0f64;
        for own in &samples {
            for node in &own.nodes {
                most = most.max(match node.state {
                    State::Held => node.above().abs(),
                    State::Flux(_) if !node.law.may_move() => 0.0,
                    State::Flux(q) => -sign(node.law, q) * node.above(),
                });
            }
        }
        assert!(most > 1e-4, "{name}: {most}");
        assert!(
            (most..1.5 * most).contains(&distances.delta),
            "{name}: {} {most}",
            distances.delta
        );
        // W is v where v should be zero, v less a linear function where it may be anything, and zero where it has
        // its sign and is far from zero.
        let mut seen = 0.0f64;
        for (own, slope) in samples.iter().zip(&distances.slopes) {
            let interval = &proof.fit.walk.intervals[own.own.interval];
            for ((node, rate), r) in own
                .nodes
                .iter()
                .zip(&own.slopes)
                .zip(own.own.cell.nodes(crate::spectral::geometry::panels::gauss(28)))
            {
                let r = if own.own.cell.is_log { r[0] } else { 1.0 };
                let needed = match node.state {
                    State::Held => rate.abs(),
                    State::Flux(_) if !node.law.may_move() => 2.0 * most / interval.length,
                    State::Flux(q) if sign(node.law, q) * node.above() < distances.delta => {
                        rate.abs()
                    }
                    State::Flux(_) => 0.0,
                };
                assert!(
                    *slope >= r * needed * (1.0 - 1e-12),
                    "{name}: {:?} {slope} {needed}",
                    own.own
                );
                seen = seen.max(needed);
            }
        }
        assert!(seen > 1e-4, "{name}");
        // What varies closer to splits than all cells is added.
        let more = Leftover { interval: 0, variation: 0.7, ..Leftover::of(&proof, &samples[0]) };
        let other = Distances::new(&proof, &samples, &[more, Leftover { variation: 0.2, ..more }]);
        assert!((other.delta - distances.delta - 0.7).abs() < 1e-12, "{name}");
    }
}

#[test]
fn the_flux_is_balanced_and_all_that_is_missed_counts() {
    for (name, powers) in [
        ("disc under friction", &[(1, 0.0935)][..]),
        ("disc under a limit", &[(1, 0.0935)]),
        ("bar with gaps", &[(2, 1e-5), (1, 1e-5)]),
        ("bar that slips up", &[(2, 1e-5), (3, 1e-5)]),
        ("gap round a fixed hole", &[(0, 1e-3), (2, 1e-3)]),
        ("gap round a hole", &[(1, 1e-3)]),
        ("sector of 60 degrees", &[(2, 1e-5)]),
        ("ends of contact on a disc", &[(1, 1e-6)]),
        ("disc under two laws", &[(1, 0.0935)]),
        ("hole that slips down in a ring in contact", &[(1, 1e-3)]),
    ] {
        let own = spoilt(name, powers);
        let (mut proof, mut samples) = sampled(&own);
        if name == "gap round a hole" {
            // Cells so short that errors of all of them are more than one of them has.
            let mut cells: Vec<_> = samples.iter().map(|own| own.own).collect();
            for _ in 0..3 {
                cells = cells.iter().filter_map(|own| proof.halves(*own)).flatten().collect();
            }
            samples = proof.samples(&cells);
        }
        proof.logs = hole_logs(&proof, &samples);
        samples.iter_mut().for_each(|own| proof.add_logs(own));
        let large = if name == "gap round a hole" { 1e-2 } else { 1e-6 };
        for error in [0.0, large] {
            for own in &mut samples {
                own.rounding.iter_mut().for_each(|errors| errors[1] += error);
            }
            check_balance(name, &proof, &samples, error);
        }
    }
}

/// Checks all bounds by the fluxes at the points, each with an error of either sign.
fn check_balance(name: &str, proof: &Proof, samples: &[Sampled], error: f64) {
    let flux = 1.0;
    let found = match FluxBalance::new(proof, samples, &[], flux) {
        Ok(found) => found,
        Err(error) => panic!("{name}: {error}"),
    };
    let (mut moved, mut missed) = (0.0, 0.0);
    for ring in 0..proof.setup.domain.rings.len() {
        let order = in_order(proof, samples, ring);
        let is_held = order.iter().any(|&p| samples[p].nodes[0].state == State::Held);
        let has_fixed = order.iter().any(|&p| {
            samples[p].nodes[0].state == State::Held && !samples[p].nodes[0].law.may_move()
        });
        let (mut own_sum, mut open, mut size) = (0.0, 0.0, 0.0f64);
        for &p in &order {
            for node in &samples[p].nodes {
                let eta = match node.state {
                    State::Flux(q) => q - node.flux - error,
                    State::Held if node.law.may_move() => node.law.project(node.flux) - node.flux,
                    State::Held => 0.0,
                };
                own_sum += node.spot.weight * eta;
                match node.state {
                    State::Flux(_) => missed += node.spot.weight * eta.abs(),
                    State::Held => moved += node.spot.weight * eta.abs(),
                }
                let may_add = node.state == State::Held && (!has_fixed || !node.law.may_move());
                open += if may_add { node.spot.weight } else { 0.0 };
                size = size.max(eta.abs());
            }
        }
        // Where a loop is balanced by a logarithm there is nothing left but errors.
        let constant = if is_held { -own_sum / open } else { 0.0 };
        assert!(is_held || own_sum.abs() <= (1e-9 + error) * 10.0, "{name}: {own_sum}");
        let (mut sum, mut least, mut most) = (0.0f64, 0.0f64, 0.0f64);
        for &p in &order {
            let own = &samples[p];
            let cell = &own.own.cell;
            let mut nodes: Vec<_> = own.nodes.iter().collect();
            if own.own.side == 1 {
                nodes.reverse();
            }
            let radii = cell.nodes(crate::spectral::geometry::panels::gauss(28));
            for (k, node) in nodes.into_iter().enumerate() {
                let may_add = node.state == State::Held && (!has_fixed || !node.law.may_move());
                let eta = match node.state {
                    State::Flux(q) => q - node.flux - error,
                    State::Held if node.law.may_move() => node.law.project(node.flux) - node.flux,
                    State::Held => 0.0,
                };
                sum += node.spot.weight * (eta + if may_add { constant } else { 0.0 });
                (least, most) = (least.min(sum), most.max(sum));
                let k = if own.own.side == 1 { radii.len() - 1 - k } else { k };
                let r = if cell.is_log { radii[k][0] } else { 1.0 };
                assert!(
                    found.slopes[p] >= r * (eta.abs() - 1e-12),
                    "{name}: {:?} {} {eta}",
                    own.own,
                    found.slopes[p]
                );
                if may_add && !cell.is_log {
                    assert!(
                        found.slopes[p] >= (constant.abs() - 1e-9) * 0.99,
                        "{name}: {} {constant}",
                        found.slopes[p]
                    );
                }
            }
        }
        assert!(found.range >= most - least, "{name}: {} {least} {most}", found.range);
        moved += constant.abs() * open * 0.9;
    }
    assert!(
        found.missed >= missed * (1.0 - 1e-9) && found.missed < 3.0 * missed + 1e-4 + 200.0 * error,
        "{name}: {} {missed}",
        found.missed
    );
    assert!(
        found.moved >= moved * (1.0 - 1e-9) && found.moved < 8.0 * moved + 1e-4 + 200.0 * error,
        "{name}: {} {moved}",
        found.moved
    );
    // What lies closer to splits than all cells counts in all.
    let more = Leftover { interval: 0, variation: 1e-6, ..Leftover::of(proof, &samples[0]) };
    let other = FluxBalance::new(proof, samples, &[more], flux).unwrap();
    assert!(
        other.missed - found.missed >= 0.99e-6 && other.moved - found.moved >= 0.99e-6,
        "{name}"
    );
    // H has a constant of its own on each loop, so that its range is the largest of all.
    let has_more = other.range - found.range >= 1.99e-6;
    assert!(has_more || proof.setup.domain.rings.len() > 1, "{name}");
    // And the extension that it asks for is no less than that of a function with this range.
    let cells: Vec<_> = samples.iter().map(|own| own.own).collect();
    let room = Room::new(&proof.fit.walk, &proof.chords, &cells);
    assert!(
        room.integral(&cells, [found.range, 0.0], &found.slopes) > found.range * found.range,
        "{name}"
    );
}

#[test]
fn logarithms_balance_loops_on_which_nothing_is_held() {
    for name in ["gap round a hole", "free hole", "gap round a fixed hole", "ring that slips up"] {
        let mut own = solved(name);
        Spoiling::OfHole(0, 0.01, Complex::new(0.0, 0.003)).spoil(&mut own.found.fit);
        let (mut proof, mut samples) = sampled(&own);
        let rings: Vec<usize> = (0..2).filter(|&ring| excess(&samples, ring).is_some()).collect();
        assert_eq!(rings.len(), 1, "{name}");
        assert!(excess(&samples, rings[0]).unwrap().abs() > 0.05, "{name}");
        proof.logs = hole_logs(&proof, &samples);
        let before = samples[0].nodes[3].value;
        samples.iter_mut().for_each(|own| proof.add_logs(own));
        assert!(excess(&samples, rings[0]).unwrap().abs() < 1e-12, "{name}");
        let node = &samples[0].nodes[3];
        let log = libm::log(node.spot.z.norm()) * proof.logs[0];
        assert!((node.value - before - log).abs() < 1e-14, "{name}");
        assert_eq!(balanced(&samples, 2), [rings[0] == 0, rings[0] == 1], "{name}");
    }
    // Where nothing is held anywhere, nothing can balance the outer loop.
    let own = solved("gap round a fixed hole");
    let (_, mut samples) = sampled(&own);
    for node in samples.iter_mut().flat_map(|own| &mut own.nodes) {
        node.state = State::Flux(0.0);
    }
    assert_eq!(balanced(&samples, 2), [false, true]);
}
