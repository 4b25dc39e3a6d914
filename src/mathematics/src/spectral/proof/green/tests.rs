//! h against the identity that it is for, and its errors against what it changes by.

use super::*;
use crate::spectral::geometry::panels::Spot;
use crate::spectral::proof::Proof;
use crate::spectral::proof::bench::solved;

#[test]
fn the_identity_is_zero_and_errors_are_those_of_positions_and_terms() {
    for name in
        ["disc beside the middle", "ring in contact", "bar with gaps", "three quarters of a disc"]
    {
        let own = solved(name);
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let samples = proof.samples(&proof.cells().unwrap());
        let harmonic = HarmonicFit::new(proof.fit, &samples);
        let (mut sum, mut size) = (0.0, 0.0);
        for (own, moduli) in samples.iter().zip(harmonic.moduli(&samples)) {
            let nodes = harmonic.on(own, moduli);
            let spots: Vec<Spot> = own.nodes.iter().map(|node| node.spot).collect();
            let sums = harmonic.functions.bounded_sums(&harmonic.coefficients, &spots);
            for ((h, v), own) in nodes.iter().zip(&own.nodes).zip(&sums) {
                let more = h.errors[0] - own.errors[0];
                let least = 1.9 * f64::EPSILON * own.slope.norm() - 1e-28;
                assert!(more >= least, "{name}: {more:e}");
                sum += h.term(v);
                size += h.term(v).abs();
                assert!(h.value.abs() <= moduli.value, "{name}");
                assert!(h.flux.abs() <= moduli.slope, "{name}");
                // Coordinates are off by two units, and sums by some of their terms.
                let units = 2.0 * f64::EPSILON;
                assert!(
                    h.errors[0] >= units * (h.flux.abs() + h.value.abs()),
                    "{name}: {:?}",
                    h.errors
                );
                assert!(h.errors[1] >= units * h.flux.abs(), "{name}: {:?}", h.errors);
                assert!(h.errors[0] < 1e-11 && h.errors[1] < 1e-9, "{name}: {:?}", h.errors);
            }
            // The slope changes between neighbours, and by as much where a point is off.
            for ((pair, at), sum) in nodes.windows(2).zip(own.nodes.windows(2)).zip(&sums) {
                let away = (at[1].spot.z - at[0].spot.z).norm();
                if away < 1e-5 {
                    continue;
                }
                let turn = proof.fit.walk.intervals[own.own.interval].curvature.abs() * away;
                let change = ((pair[1].flux - pair[0].flux).abs() - turn * moduli.slope) / away;
                // On top of what the sum has.
                let more = pair[0].errors[1] - sum.errors[1];
                assert!(more >= 1.9 * f64::EPSILON * change - 1e-28, "{name}: {change}");
            }
        }
        assert!(sum.abs() < 1e-6 * size + 1e-15, "{name}: {sum} {size}");
    }
}
