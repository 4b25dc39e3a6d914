//! Brackets of solutions whose energy is known, as they are and spoilt.

use crate::spectral::contact::search::PlaneFound;
use crate::spectral::proof::bench::spoilt::{added, check, spoilings};
use crate::spectral::proof::bench::{all_known, solved};
use crate::spectral::proof::bounds::proved;
use crate::spectral::proof::unproved;
use crate::spectral::source::changes::Changes;
use std::f64::consts::PI;

#[test]
fn brackets_hold_energies_that_are_known() {
    let mut many = 0;
    for known in all_known() {
        let own = known.solved();
        let bounds = proved(&own.setup, &own.found).unwrap().ends();
        check(own.name, bounds, own.energy);
        assert!(bounds[1] - bounds[0] < 3e-11 * own.energy.abs(), "{}: {bounds:?}", own.name);
        many += 1;
    }
    assert!(many >= 20, "{many} problems");
}

/// With a weight more, or less, of f on a small disc in the middle, where v is -1/4, the energy differs by the weight
/// times v but for the square of the weight.
#[test]
fn brackets_hold_energies_of_an_f_that_differs_by_its_changes() {
    let (weight, radius) = (1e-6, 1e-3f64);
    let mut changes = Changes::default();
    changes.add_disc(weight / (PI * radius * radius), radius);
    let mut own = solved("disc in contact");
    own.setup.jumps.changes = changes;
    let [lower, upper] = proved(&own.setup, &own.found).unwrap().ends();
    let moved = 0.25 * weight;
    assert!(lower < own.energy - moved && own.energy + moved < upper, "{lower} {upper}");
    assert!(own.energy - lower < 40.0 * moved && upper - lower < 1e-2, "{lower} {upper}");
}

#[test]
fn brackets_of_spoilt_solutions_hold_the_energy_and_are_as_wide_as_predicted() {
    /// Width over what is predicted: of a smooth boundary, and for each split, where functions change at all scales.
    const WIDTHS: [f64; 2] = [600.0, 1e5];
    let (mut many, mut refused, mut widest) = (0, 0, 0.0f64);
    for known in all_known() {
        let mut own = known.solved();
        for spoiling in spoilings(&own) {
            let name = format!("{} {spoiling:?}", own.name);
            let kept = own.found.fit.clone();
            spoiling.spoil(&mut own.found.fit);
            let fit = std::mem::replace(&mut own.found.fit, kept);
            let spoilt = PlaneFound::known(&own.setup, &own.found.contact, fit);
            let [change, need] = added(&own.setup, &own.found.fit, &spoilt);
            let [energy, _] = unproved(&own.setup, &spoilt.fit, &spoilt.nodes);
            let off = (energy - own.energy - change).abs();
            assert!(off < 1e-9 * need + 1e-12 * own.energy.abs(), "{name}: {off} {change}");
            many += 1;
            let Ok(bounds) = proved(&own.setup, &spoilt).map(|own| own.ends()) else {
                refused += 1;
                continue;
            };
            check(&name, bounds, own.energy);
            let graded = spoilt.fit.walk.splits.iter().filter(|split| split.depth() < 1.0).count();
            let most = (WIDTHS[0] + WIDTHS[1] * graded as f64) * need + 1e-9 * own.energy.abs();
            assert!(bounds[1] - bounds[0] < most, "{name}: {bounds:?} {most}");
            widest = widest.max((bounds[1] - bounds[0]) / most);
        }
    }
    assert!(many > 150 && refused < many / 10 && widest > 0.5, "{many} {refused} {widest}");
}
