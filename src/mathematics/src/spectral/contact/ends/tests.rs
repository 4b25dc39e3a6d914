//! Errors of ends against finer levels, and of ends next to a corner against those of data that hardly differ.

use super::*;
use crate::problem::law::BoundaryState;
use crate::spectral::contact::search;
use crate::spectral::contact::start::PlaneStart;
use crate::spectral::fit::Effort;
use crate::spectral::geometry::polygons::polygon;
use crate::spectral::geometry::ring::RingContact;
use crate::spectral::geometry::side::SidePlace;
use crate::spectral::problem::PlaneProblem;
use crate::spectral::source::{PlaneSource, Regions};

/// Solution on a polygon from one arc between places of its sides.
fn found(points: &[[f64; 2]], f: &str, arc: [(usize, f64); 2]) -> (Setup, PlaneFound) {
    let domain = polygon(points);
    let source = PlaneSource::Pieces(Regions::all(f.parse().unwrap()));
    let setup = Setup::new(&PlaneProblem { domain, source }).unwrap();
    let ring = &setup.domain.rings[0];
    let arc = arc
        .map(|(side, share)| ring.along(SidePlace { side, s: share * ring.sides[side].length() }));
    let contact = vec![RingContact { arcs: vec![arc], gaps: vec![BoundaryState::SlipsUp] }];
    let start = PlaneStart { contact, spacing: 1e-3 };
    let found = search::search(&setup, &start, &mut Effort::default()).unwrap();
    (setup, found)
}

const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.3, 0.1], [0.4, 1.1]];
const LSHAPE: [[f64; 2]; 6] =
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, -1.0]];

/// Solutions of ten problems, two of them with ends next to corners.
fn ten() -> Vec<(Setup, PlaneFound)> {
    let mut all = Vec::new();
    for (t, from, to) in [
        (0.1, (0, 0.851), 0.267),
        (0.15, (0, 0.911), 0.208),
        (0.2, (0, 0.974), 0.149),
        (0.22, (0, 0.9999), 0.1253),
        (0.220_026_6, (1, 0.0001), 0.1253),
        (0.25, (1, 0.53), 0.083),
    ] {
        let f = format!("halfplane(1,0.2,{t})=4; else=-7");
        all.push(found(&SQUARE, &f, [from, (2, to)]));
    }
    for (t, from, to) in [(0.3, 0.262, 0.644), (0.4, 0.381, 0.475), (0.5, 0.527, 0.281)] {
        let f = format!("halfplane(1,.3,{t})=4; else=-3");
        all.push(found(&TRIANGLE, &f, [(0, from), (2, to)]));
    }
    all.push(found(&LSHAPE, "rect(0,9,0,9)=5; else=-3", [(3, 0.666), (5, 0.332)]));
    all
}

#[test]
fn a_finer_level_finds_ends_within_their_errors() {
    let mut least = f64::INFINITY;
    for (setup, found) in ten() {
        let refined = found.refined(&setup).unwrap();
        let [errors, finer] = [&found, &refined].map(|own| own.end_errors(&setup)[0].clone());
        let pairs = found.contact[0]
            .arcs
            .iter()
            .zip(&refined.contact[0].arcs)
            .zip(errors.iter().zip(&finer));
        for ((coarse, fine), errors) in pairs {
            for which in [0, 1] {
                let moved = coarse[which] - fine[which];
                let error = errors.0[which] + errors.1[which];
                assert!(moved.abs() <= error, "{moved:e} {error:e}");
                least = least.min(error);
            }
        }
    }
    assert!(least < 1e-10, "{least:e}");
}

#[test]
fn ends_next_to_a_corner_agree_within_their_errors() {
    let mut all: Vec<[f64; 2]> = Vec::new();
    for k in 0..5 {
        let t = 0.220_026_633_4 + f64::from(k) * 1e-12;
        let f = format!("halfplane(1,0.2,{t})=4; else=-7");
        let (setup, found) = found(&SQUARE, &f, [(1, 0.001), (2, 0.126)]);
        let own = [found.contact[0].arcs[0][0], found.end_errors(&setup)[0][0][0]];
        for before in &all {
            assert!((own[0] - before[0]).abs() <= own[1] + before[1], "{own:?} {before:?}");
        }
        all.push(own);
    }
}
