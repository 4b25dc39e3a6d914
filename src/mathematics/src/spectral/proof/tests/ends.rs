//! Brackets of a solution with ends of contact, whose energy is that of the square's closed form.

use crate::problem::complex::Complex;
use crate::problem::law::{BoundaryState, Law};
use crate::spectral::contact::search::{PlaneFound, search};
use crate::spectral::contact::start::PlaneStart;
use crate::spectral::fit::Effort;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::ring::RingContact;
use crate::spectral::geometry::side::{PlaneSide, SidePlace};
use crate::spectral::problem::PlaneProblem;
use crate::spectral::proof::bench::known::{polygon, slips};
use crate::spectral::proof::bench::spoilt::{Spoiling, check};
use crate::spectral::proof::bounds::proved;
use crate::spectral::setup::Setup;
use crate::spectral::source::{PlaneSource, Regions};

/// Solution with arcs that stick, by side and place of both ends.
fn found(loops: Vec<PlaneSide>, f: &str, arcs: &[[(usize, f64); 2]]) -> (Setup, PlaneFound) {
    let domain = PlaneDomain::new(vec![loops]).unwrap();
    let source = PlaneSource::Pieces(Regions::all(f.parse().unwrap()));
    let setup = Setup::new(&PlaneProblem { domain, source }).unwrap();
    let along = |(side, s)| setup.domain.rings[0].along(SidePlace { side, s });
    let arcs: Vec<[f64; 2]> = arcs.iter().map(|ends| ends.map(along)).collect();
    let gaps = slips(BoundaryState::SlipsUp).gaps.repeat(arcs.len());
    let start = PlaneStart { contact: vec![RingContact { arcs, gaps }], spacing: 1e-3 };
    let found = search(&setup, &start, &mut Effort::default()).unwrap();
    (setup, found)
}

#[test]
fn brackets_with_ends_of_contact_hold_the_energy_of_the_closed_form() {
    let q = 0.094_404_156_233_095_12;
    // Exact to its last digits: its own two formulas of the energy agree to 1e-15.
    let energy: f64 = -0.09505172075335079;
    let square = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let loops = polygon(&square, &[Law::SIGNORINI; 4]);
    let arcs = [[(1, 0.5 + q), (2, 0.5 - q)]];
    let (setup, mut found) = found(loops, "quadrant(ll)=3; else=-1.1", &arcs);
    let splits = found.fit.walk.splits.iter().enumerate();
    let ends: Vec<usize> = splits.filter(|(_, own)| own.end.is_some()).map(|(k, _)| k).collect();
    assert_eq!(ends.len(), 2);
    let [lower, upper] = proved(&setup, &found).unwrap().ends();
    let unit = 1e-14 * energy.abs();
    assert!(lower <= energy + unit && energy - unit <= upper, "{lower} {upper}");
    assert!(upper - lower < 1e-10 * energy.abs(), "{lower} {upper}");
    for (split, c) in ends.iter().zip([2e-7, -2e-8]) {
        for turn in [-0.7, 0.7] {
            let spoiling = Spoiling::Root(*split, 0.2, Complex::unit(turn).scaled(c));
            let kept = found.fit.clone();
            spoiling.spoil(&mut found.fit);
            let fit = std::mem::replace(&mut found.fit, kept);
            let spoilt = PlaneFound::known(&setup, &found.contact, fit);
            let bounds = proved(&setup, &spoilt).unwrap().ends();
            check(&format!("{spoiling:?}"), bounds, energy);
            let width = (bounds[1] - bounds[0]) / (c * c);
            assert!((0.1..1e7).contains(&width), "{spoiling:?}: {width}");
        }
    }
}
