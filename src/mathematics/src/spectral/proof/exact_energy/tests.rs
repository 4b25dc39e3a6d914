//! Derivatives of the energy by what is computed at points, and what is left out next to splits.

use super::*;
use crate::spectral::fit::field::nodes_at;
use crate::spectral::geometry::panels::{Spot, gauss};
use crate::spectral::proof::bench::known::SolvedKnown;
use crate::spectral::proof::bench::spoilt::Spoiling;
use crate::spectral::proof::bench::{all_known, solved};
use crate::spectral::proof::samples::{Quantity, Test};
use crate::spectral::source::psi_sizes::PsiSizes;

/// Names of problems with all states, f of both kinds, and cells of both kinds.
const NAMES: [&str; 5] = [
    "ring that slips up",
    "bar that slips down",
    "crossings on a disc",
    "square",
    "ends of contact on a disc",
];

/// Values of laws that are tried: those of the problems, and one that v is far from.
const VALUES: [Option<f64>; 2] = [None, Some(-300.0)];

impl SolvedKnown {
    /// The problem with another value of all laws that have one, and the same v.
    fn with_values(mut self, value: Option<f64>) -> Self {
        for own in self.setup.domain.rings.iter_mut().flat_map(|ring| &mut ring.sides) {
            own.law = value.map_or(own.law, |at| own.law.with_at(at).unwrap());
        }
        self
    }
}

/// Energy of one cell with Green's term.
fn energy(own: &SolvedKnown, nodes: &[PlaneNode], harmonic: &[HarmonicNode]) -> f64 {
    let integrals = Integrals::on_boundary(&own.setup, &own.found.fit, nodes);
    integrals.energy() + nodes.iter().zip(harmonic).map(|(v, h)| h.term(v)).sum::<f64>()
}

#[test]
fn rounding_errors_count_by_the_derivatives_of_the_energy() {
    let size = 1e-6;
    for (name, value) in NAMES.into_iter().flat_map(|name| VALUES.map(|value| (name, value))) {
        let mut own = solved(name).with_values(value);
        let far = 1.0 + value.map_or(0.0, f64::abs);
        Spoiling::Power(3, Complex::new(0.1, 0.03)).spoil(&mut own.found.fit);
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let mut samples = proof.samples(&proof.cells().unwrap());
        let harmonic = HarmonicFit::new(proof.fit, &samples);
        let moduli = harmonic.moduli(&samples);
        let many = samples.len();
        for (sampled, h) in samples.iter_mut().zip(moduli).step_by(1 + many / 40) {
            let mut nodes = harmonic.on(sampled, h);
            nodes.iter_mut().for_each(|h| h.errors = [0.0; 2]);
            let before = energy(&own, &sampled.nodes, &nodes);
            for i in [0, 13, 27] {
                for which in 0..6 {
                    let (mut spoilt, mut harmonic) = (sampled.nodes.clone(), copies(&nodes));
                    sampled.rounding.fill([0.0; 2]);
                    sampled.psi.fill(PsiSizes::default());
                    match which {
                        0 => spoilt[i].value += size,
                        1 => spoilt[i].flux += size,
                        // psi is part of v.
                        2 => {
                            spoilt[i].psi += size;
                            spoilt[i].value += size;
                        }
                        3 => {
                            spoilt[i].psi_flux += size;
                            spoilt[i].flux += size;
                        }
                        4 => harmonic[i].value += size,
                        _ => harmonic[i].flux += size,
                    }
                    match which {
                        4 | 5 => harmonic[i].errors[which - 4] = size,
                        _ => sampled.rounding[i][which % 2] = size,
                    }
                    match which {
                        2 => sampled.psi[i].value = size,
                        3 => sampled.psi[i].slope = size,
                        _ => (),
                    }
                    let change = (energy(&own, &spoilt, &harmonic) - before).abs();
                    let mut sum = BoundedEnergy::default();
                    for (h, errors) in nodes.iter_mut().zip(&harmonic) {
                        h.errors = errors.errors;
                    }
                    sum.add_rounding(&proof, sampled, &nodes);
                    nodes.iter_mut().for_each(|h| h.errors = [0.0; 2]);
                    let mut none = BoundedEnergy::default();
                    sampled.rounding.fill([0.0; 2]);
                    sampled.psi.fill(PsiSizes::default());
                    none.add_rounding(&proof, sampled, &nodes);
                    let error = sum.error - none.error;
                    let weight = sampled.nodes[i].spot.weight;
                    // All but a square of the change.
                    let noise = 1e-14 * none.error + 1e-19 + 4.0 * f64::EPSILON * before.abs();
                    let least = change - 2.0 * size * size * weight - noise;
                    assert!(
                        error >= least,
                        "{name} {:?} {i} {which}: {error:e} {change:e}",
                        sampled.own
                    );
                    assert!(error < 120.0 * far * size * weight + noise, "{name}: {error:e}");
                    let given = sampled.nodes.iter().map(|node| {
                        let flux = if let State::Flux(q) = node.state { q } else { node.flux };
                        node.spot.weight * (node.at * flux).abs()
                    });
                    assert!(sum.terms > given.sum::<f64>(), "{name}");
                }
            }
        }
    }
}

fn copies(nodes: &[HarmonicNode]) -> Vec<HarmonicNode> {
    nodes.iter().map(|h| HarmonicNode { value: h.value, flux: h.flux, errors: [0.0; 2] }).collect()
}

#[test]
fn energies_of_cells_are_those_that_are_known_within_their_errors() {
    for known in all_known() {
        let own = known.solved();
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let samples = proof.samples(&proof.cells().unwrap());
        let exact = bounded_energy(&proof, &samples, &[]).unwrap();
        // The bench of the whole has what v misses too; here it is below rounding.
        let off = (exact.energy - own.energy).abs();
        // Without f, and with v fixed or no flux, the energy is half of the integral of |grad v|^2.
        if !own.setup.domain.has_values() || own.name == "bar between values" {
            assert!(
                (exact.size() - own.energy.abs()).abs() <= 1e-11 * exact.size(),
                "{}",
                own.name
            );
        }
        let unit = f64::EPSILON * own.energy.abs();
        assert!(off <= exact.error + 4.0 * unit, "{}: {off:e} {:e}", own.name, exact.error);
        assert!(exact.error > unit && exact.error < 1e5 * unit, "{}: {:e}", own.name, exact.error);
        // What is left next to splits counts in full, and by h times what v is there.
        let left = Leftover { interval: 0, variation: 0.1, integrals: 0.3, around: 0.2 };
        let more = bounded_energy(&proof, &samples, &[left]).unwrap();
        let harmonic = HarmonicFit::new(proof.fit, &samples);
        let bounds = harmonic.moduli(&samples);
        let nodes = harmonic.on(&samples[0], bounds[0]);
        let h = nodes.iter().fold(0.0f64, |most, h| most.max(h.value.abs() + h.flux.abs()));
        assert!(more.error - exact.error >= 0.3 + 0.2 * h - 1e-12, "{}", own.name);
        // Sums of n terms lose n / 2 units of them.
        assert!(
            exact.error >= 0.5 * samples.len() as f64 * f64::EPSILON * exact.terms,
            "{}",
            own.name
        );
    }
}

/// Half of the integral of |grad v|^2 is half of those of v l and f v.
#[test]
fn the_size_of_a_solution_that_misses_its_flux_has_an_error() {
    let mut own = solved("ring above a gap");
    Spoiling::OfHole(0, 0.1, Complex::default()).spoil(&mut own.found.fit);
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let samples = proof.samples(&proof.cells().unwrap());
    let exact = bounded_energy(&proof, &samples, &[]).unwrap();
    let (mut half, mut missed, mut largest) = (0.0, 0.0, 0.0f64);
    for own in &samples {
        let sums = Integrals::on_boundary(proof.setup, proof.fit, &own.nodes);
        half += 0.5 * (sums.flux_work + sums.work);
        for node in &own.nodes {
            largest = largest.max(node.above().abs());
            if let State::Flux(q) = node.state {
                missed += node.spot.weight * (node.flux - q).abs();
            }
        }
    }
    let off = (exact.size() - half).abs();
    assert!(off > 1e-2 && off <= exact.size_error(missed, largest), "{off} {missed} {largest}");
}

#[test]
fn what_is_left_next_to_splits_is_bounded() {
    for (name, value) in [
        ("bar with gaps", None),
        ("three quarters of a disc", None),
        ("crossings on a disc", None),
        ("ends of contact on a disc", None),
        ("ends of contact on a disc", Some(-300.0)),
        ("disc under two laws", Some(-300.0)),
    ] {
        let mut own = solved(name).with_values(value);
        Spoiling::Power(2, Complex::new(0.3, 0.1)).spoil(&mut own.found.fit);
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let samples = proof.samples(&proof.cells().unwrap());
        let mut seen = 0;
        for sampled in &samples {
            let cell = &sampled.own.cell;
            if !cell.is_log || cell.span[0] < 1e-5 {
                continue;
            }
            seen += 1;
            let left = Leftover::of(&proof, sampled);
            let walk = &own.found.fit.walk;
            let rule = gauss(20);
            let (interval, side) = (sampled.own.interval, sampled.own.side);
            let mut spots: Vec<Spot> = Vec::new();
            let mut to = cell.span[0];
            for _ in 0..60 {
                spots.extend(rule.iter().map(|node| {
                    walk.spot(interval, side, 0.5 * to * (1.0 + node.x), 0.5 * to * node.weight)
                }));
                to *= 0.5;
            }
            let nodes = nodes_at(&own.setup, &own.found.fit, &spots);
            let last = nodes[nodes.len() - 1].value;
            let (mut flux, mut around, mut most) = (0.0, 0.0, 0.0f64);
            for node in &nodes {
                let weight = node.spot.weight;
                flux += weight * node.flux.abs();
                let [g, rate] = HarmonicNode::of_g(node);
                around += weight * (g.abs() + rate.abs());
                most = most.max((node.value - last).abs());
            }
            let integrals = Integrals::on_boundary(&own.setup, &own.found.fit, &nodes);
            assert!(
                left.variation >= most && left.variation >= flux,
                "{name}: {left:?} {most} {flux}"
            );
            assert!(left.integrals >= integrals.energy().abs(), "{name}: {left:?} {integrals:?}");
            assert!(left.around >= around, "{name}: {left:?} {around}");
        }
        assert!(seen > 2, "{name}: {seen}");
    }
}

#[test]
fn integrands_are_bounded_on_the_ellipses() {
    for (name, value) in NAMES.into_iter().flat_map(|name| VALUES.map(|value| (name, value))) {
        let own = solved(name).with_values(value);
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let samples = proof.samples(&proof.cells().unwrap());
        let harmonic = HarmonicFit::new(proof.fit, &samples);
        for (sampled, h) in samples.iter().zip(harmonic.moduli(&samples)) {
            let bound = modulus(&proof, sampled, h);
            let nodes = harmonic.on(sampled, h);
            for (node, h) in sampled.nodes.iter().zip(&nodes) {
                let one = [*node];
                let own = energy(&own, &one, std::slice::from_ref(h)).abs() / node.spot.weight;
                let r = if sampled.own.cell.is_log { node.spot.offset } else { 1.0 };
                assert!(bound >= own * r, "{name}: {bound} {own}");
            }
            assert!(sampled.most(Test::of(Quantity::Value)).is_finite());
        }
    }
}
