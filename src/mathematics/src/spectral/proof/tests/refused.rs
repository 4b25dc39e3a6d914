//! Setups for which the argument does not hold, each with the part that is not proved.

use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::spectral::contact::search::PlaneFound;
use crate::spectral::functions::{Family, Power};
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::proof::Proof;
use crate::spectral::proof::bench::known::{BenchProblem, SolvedKnown, circle};
use crate::spectral::proof::bench::spoilt::Spoiling;
use crate::spectral::proof::bench::{all_known, solved};
use crate::spectral::proof::bounds::proved;
use std::f64::consts::PI;

/// Cuts that begin at a point, in a problem that is proved without them.
fn with_family(name: &str, family: Family) -> Option<&'static str> {
    let mut own = solved(name);
    assert!(Proof::new(&own.setup, &own.found.fit).is_ok(), "{name}");
    own.found.fit.functions.families.push(family);
    Proof::new(&own.setup, &own.found.fit).err()
}

fn family(point: [f64; 2], inwards: Complex, length: f64, power: f64) -> Family {
    let [x, y] = point;
    let powers = vec![Power::plain(power)];
    Family { point: Complex::new(x, y), split: None, inwards, lengths: vec![length], powers }
}

#[test]
fn cuts_in_the_domain_are_refused() {
    let (right, up) = (Complex::new(1.0, 0.0), Complex::new(0.0, 1.0));
    let refused = Some("cuts beside the domain");
    // Outside of the unit disc, away from it.
    assert_eq!(with_family("disc in contact", family([1.2, 0.0], -right, 0.5, 0.5)), None);
    assert_eq!(with_family("disc in contact", family([1.0, 0.0], -right, 0.5, 1.0)), None);
    // A tip inside; a point inside; a cut through the disc; one that ends next to it, or begins there.
    assert_eq!(with_family("disc in contact", family([1.2, 0.0], right, 0.5, 0.5)), refused);
    assert_eq!(with_family("disc in contact", family([1.0, 0.0], right, 0.5, 1.0)), refused);
    assert_eq!(with_family("disc in contact", family([0.5, 0.0], -right, 1.0, 0.5)), refused);
    assert_eq!(with_family("disc in contact", family([1.5, 0.0], right, 3.0, 0.5)), refused);
    assert_eq!(
        with_family("disc in contact", family([1.5, 0.0], right, 0.5 - 1e-10, 0.5)),
        refused
    );
    assert_eq!(
        with_family("disc in contact", family([1.0 + 1e-11, 0.0], -right, 0.5, 0.5)),
        refused
    );
    // From the hole of a ring through the ring outwards, and within the hole up to nearly the ring.
    assert_eq!(with_family("ring in contact", family([0.2, 0.0], -right, 1.0, 0.5)), refused);
    assert_eq!(with_family("ring in contact", family([0.2, 0.0], -right, 0.25, 0.5)), None);
    assert_eq!(with_family("ring in contact", family([0.2, 0.0], -right, 0.29, 0.5)), refused);
    // From the re-entrant corner of three quarters of a disc.
    let mut own = solved("three quarters of a disc");
    let corner = own.found.fit.walk.splits.iter().position(|split| split.z.norm() < 1e-9).unwrap();
    let k =
        own.found.fit.functions.families.iter().position(|own| own.split == Some(corner)).unwrap();
    own.found.fit.functions.families[k].inwards = up;
    assert_eq!(Proof::new(&own.setup, &own.found.fit).err(), refused);
    // Nearly a slit: a cut has no room.
    let mut own = solved("three quarters of a disc");
    own.found.fit.walk.splits[corner].angle = 2.0 * PI - 1e-4;
    assert_eq!(Proof::new(&own.setup, &own.found.fit).err(), refused);
}

#[test]
fn jumps_with_other_values_are_refused() {
    for name in ["disc in a disc", "crossings on a disc"] {
        for (side, by) in [(0, 1e-3), (1, -1e-3)] {
            let mut own = solved(name);
            assert!(Proof::new(&own.setup, &own.found.fit).is_ok(), "{name}");
            let last = own.setup.jumps.groups.last_mut().and_then(|group| group.edges.last_mut());
            last.unwrap().edge.values[side] += by;
            assert_eq!(Proof::new(&own.setup, &own.found.fit).err(), Some("f"), "{name}");
        }
    }
}

#[test]
fn middles_of_holes_in_the_domain_or_on_its_boundary_are_refused() {
    for x in [0.7, 0.5, 0.5 - 1e-10, 1.0] {
        let mut own = solved("ring in contact");
        own.found.fit.functions.holes[0].middle = Complex::new(x, 0.0);
        let error = Proof::new(&own.setup, &own.found.fit).err();
        assert_eq!(error, Some("middles of holes"), "{x}");
    }
}

#[test]
fn what_is_singular_is_known() {
    for known in all_known() {
        let own = known.solved();
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let has =
            |z: Complex| proof.singular.points.iter().any(|(own, _)| (*own - z).norm() < 1e-12);
        for split in own
            .found
            .fit
            .walk
            .splits
            .iter()
            .filter(|split| split.corner || split.crossing || split.end.is_some())
        {
            assert!(has(split.z), "{}: {:?}", own.name, split.z);
        }
        for hole in &own.found.fit.functions.holes {
            assert!(has(hole.middle), "{}", own.name);
        }
        for family in &own.found.fit.functions.families {
            assert!(
                family.lengths.iter().all(|&d| has(family.point - family.inwards.scaled(d))),
                "{}",
                own.name
            );
            assert!(
                has(family.point) || family.powers.iter().all(|own| own.power == 1.0 && !own.log),
                "{}",
                own.name
            );
        }
    }
}

#[test]
fn a_flux_without_room_in_the_law_is_refused() {
    // All of the flux is at the limit: nothing can balance what a gap misses.
    let own = solved("ends of contact on a disc");
    assert!(proved(&own.setup, &own.found).is_ok());
    let known =
        all_known().into_iter().find(|own| own.name == "ends of contact on a disc").unwrap();
    let mut contact = known.contact.clone();
    contact[0].arcs[0] = [1.0, 5.5];
    let mut problem = known.problem.clone();
    let limit = Law::limited(1.0).unwrap();
    problem.domain = PlaneDomain::new(vec![circle(1.0, limit, true)]).unwrap();
    let mut own = BenchProblem { problem, contact, ..known }.solved();
    Spoiling::Power(2, Complex::new(1e-5, 0.0)).spoil(&mut own.found.fit);
    assert_eq!(proved(&own.setup, &own.found), Err("room of the flux in the law"));
    // With room, but for what would be added.
    let mut own = solved("sector of 60 degrees");
    Spoiling::Power(2, Complex::new(0.2, 0.0)).spoil(&mut own.found.fit);
    assert_eq!(proved(&own.setup, &own.found), Err("room of the flux in the law"));
}

#[test]
fn f_that_the_flux_does_not_balance_is_refused() {
    for (name, by) in
        [("disc in contact", 1e-3), ("ring in contact", -1e-3), ("bar with gaps", 1e-3)]
    {
        let SolvedKnown { setup, mut found, .. } = solved(name);
        // f beside one interval is not that of psi.
        found.fit.walk.intervals[0].f += by;
        let other = PlaneFound::known(&setup, &found.contact, found.fit);
        assert!(proved(&setup, &other).is_err(), "{name}");
    }
}
