//! Errors of ends against finer levels, other numbers for the same data, and ends that were moved.

use super::*;
use crate::mesh::Condition;
use crate::problem::law::Law;
use crate::spectral::plane::fit::Effort;
use crate::spectral::plane::frame::Frame;
use crate::spectral::plane::{PlaneDomain, PlaneProblem, PlaneSide, PlaneSource, PlaneStart};
use crate::spectral::plane::{LoopStart, SidePlace, search};

/// Number of problems, whose ends a finer level finds again within their errors.
const KNOWN: usize = 10;

/// Solution on a polygon, whose side 0 is free if wanted, from one arc between places of its sides.
fn found(points: &[[f64; 2]], is_free: bool, f: &str, arc: [(usize, f64); 2]) -> (Setup, PlaneFound) {
    let many = points.len();
    let sides = (0..many).map(|k| {
        let condition = if is_free && k == 0 { Condition::Free } else { Condition::Contact };
        PlaneSide::segment([points[k], points[(k + 1) % many]], condition, k)
    });
    let domain = PlaneDomain::new(vec![sides.collect()]).unwrap();
    let arcs = vec![arc.map(|(side, share)| SidePlace { side, s: share * domain.loops()[0][side].length() })];
    let start = PlaneStart { loops: vec![LoopStart { arcs, gaps: vec![0.0] }], spacing: 1e-3 };
    let frame = Frame::of(&domain);
    let problem = PlaneProblem { domain, law: Law::SIGNORINI, source: PlaneSource::Pieces(f.parse().unwrap()) };
    let setup = Setup::new(&frame.problem(&problem)).unwrap();
    let found = search::search(&setup, &frame.start(&start), &mut Effort::default()).unwrap();
    (setup, found)
}

#[test]
fn probe() {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    for k in 0..6 {
        let t = 0.220_026_633_4 + f64::from(k) * 1e-12;
        let (setup, found) = found(&square, false, &format!("halfplane(1,0.2,{t})=4; else=-7"), [(1, 0.0001), (2, 0.126)]);
        println!("{:?} {:?}", found.contact[0].arcs, found.end_errors(&setup));
    }
}
