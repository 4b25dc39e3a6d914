//! Solutions of plane problems against digits of other methods, and against each other.

use super::super::geometry::domain::PlaneDomain;
use super::super::geometry::polygons::{circle, polygon, square};
use super::super::geometry::side::PlaneSide;
use super::super::source::smooth::SmoothSource;
use super::*;
use crate::problem::formula::Formula;
use crate::problem::law::{BoundaryState, Law};
use crate::spectral::geometry::frame::Frame;
use crate::spectral::geometry::ring::RingContact;
use crate::spectral::source::{PlaneSource, RegionBorder, Regions};
use std::f64::consts::PI;

mod bends;
mod changes;
mod narrow;
mod small;
mod values;

const LSHAPE: [[f64; 2]; 6] =
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, -1.0]];

fn lshape() -> PlaneDomain {
    polygon(&LSHAPE)
}

/// The same in coordinates in which it has half of its size.
fn seen_lshape() -> PlaneDomain {
    let halves = LSHAPE.map(|point| point.map(|x| 0.5 * x));
    PlaneDomain { frame: Frame { unit: 2.0, ..Frame::default() }, ..polygon(&halves) }
}

fn triangle() -> PlaneDomain {
    polygon(&[[0.0, 0.0], [1.3, 0.1], [0.4, 1.1]])
}

/// Start from points near the ends of arcs, loop by loop, with gaps on which v slips up.
fn start(domain: &PlaneDomain, loops: &[&[[f64; 2]]]) -> PlaneStart {
    let near = |[x, y]: [f64; 2]| {
        let (ring, place) = domain.nearest(Complex::new(x, y));
        domain.rings[ring].along(place)
    };
    let mut contact = Vec::new();
    for (ends, ring) in loops.iter().zip(&domain.rings) {
        let arcs = ends.chunks(2).map(|pair| {
            let [from, to] = [near(pair[0]), near(pair[1])];
            [from, if to <= from { to + ring.length() } else { to }]
        });
        contact.push(RingContact {
            arcs: arcs.collect(),
            gaps: vec![BoundaryState::SlipsUp; ends.len() / 2],
        });
    }
    PlaneStart { contact, spacing: 1e-3 }
}

fn pieces(f: &str) -> PlaneSource {
    PlaneSource::Pieces(Regions::all(f.parse().unwrap()))
}

/// Solves a problem with one loop under the paper's law; checks the bracket and the ends.
fn solved(domain: PlaneDomain, source: PlaneSource, ends: &[[f64; 2]]) -> TrueSolution {
    let start = start(&domain, &[ends]);
    let problem = PlaneProblem { domain, source };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    let [lower, upper] = found.bracket.unwrap();
    assert!(lower <= found.energy && found.energy <= upper, "{lower} {} {upper}", found.energy);
    assert!(upper - lower < 1e-9 * found.energy.abs(), "{:?} {}", found.bracket, found.energy);
    for arc in &found.contact {
        let is_known = |end: [f64; 2]| {
            ends.iter().any(|known| (known[0] - end[0]).hypot(known[1] - end[1]) < 1e-6)
        };
        assert!(arc.closed || is_known(arc.from) && is_known(arc.to), "{arc:?}");
    }
    found
}

#[test]
fn the_square_has_the_digits_of_the_closed_form() {
    let p = 0.194_250_479_506_949_33;
    let q = 0.094_404_156_233_095_12;
    for (f, ends, energy, centre) in [
        (
            "rect(0.25,0.5,0.25,0.5)=2; else=-1",
            vec![[p, 0.5], [0.5, p]],
            -0.016602302753503898,
            -0.06875592531156056,
        ),
        (
            "quadrant(ll)=3; else=-1.1",
            vec![[0.5, q], [q, 0.5]],
            -0.09505172075335079,
            0.11992802573847225,
        ),
        ("disc(0,0,0.25)=2; else=-1", vec![], -0.00691181240291777, 0.045288829446766786),
    ] {
        let found = solved(square(), pieces(f), &ends);
        assert!((found.energy / energy - 1.0).abs() < 1e-12, "{f}: {}", found.energy);
        for arc in found.contact.iter().filter(|arc| !arc.closed) {
            for (point, error) in [arc.from, arc.to].iter().zip(arc.error.unwrap()) {
                let apart = ends.iter().map(|end| (end[0] - point[0]).hypot(end[1] - point[1]));
                let apart = apart.fold(f64::INFINITY, f64::min);
                assert!(apart <= error && error < 1e-9, "{f}: {apart:e} {error:e}");
            }
        }
        assert!(
            (found.values(&[[0.0; 2]])[0] - centre).abs() < 1e-10,
            "{f}: {}",
            found.values(&[[0.0; 2]])[0]
        );
    }
}

#[test]
fn polygons_and_discs_have_the_digits_of_two_levels() {
    let found = solved(lshape(), pieces("else=-1"), &[]);
    assert!((found.energy + 0.1070379013).abs() < 1e-10, "{}", found.energy);
    let ends = [[-1.0, -0.33266642], [0.0, -0.66849237]];
    let found = solved(lshape(), pieces("rect(0,9,0,9)=5; else=-3"), &ends);
    assert!((found.energy + 8.730893498).abs() < 1e-9, "{}", found.energy);
    let ends = [[0.4959209, 0.0381478], [0.2100324, 0.5775890]];
    let found = solved(triangle(), pieces("halfplane(1,.3,.4)=4; else=-3"), &ends);
    assert!((found.energy + 0.066541739).abs() < 1e-9, "{}", found.energy);
    let disc = PlaneDomain::new(vec![circle(1.0, Law::SIGNORINI, true)]).unwrap();
    let ends = [[0.3312903, -0.9435289], [-0.2427919, 0.9700784]];
    let found = solved(disc.clone(), pieces("halfplane(1,.3,-.1)=4; else=-7"), &ends);
    assert!((found.energy + 4.500172948).abs() < 1e-9, "{}", found.energy);
    let f = Formula::read("7*(x^2 - y^2) - 1.5", 2).unwrap();
    let f = SmoothSource::of_formula(&f, &disc).unwrap();
    let (y, x) = libm::sincos(0.64052232);
    let found = solved(disc, PlaneSource::Smooth(f), &[[x, y], [-x, y], [-x, -y], [x, -y]]);
    assert!((found.energy + 0.744911466).abs() < 1e-9, "{}", found.energy);
}

#[test]
fn a_formula_of_degree_sixteen_has_a_bracket_that_holds_the_known_energy() {
    // v = -(1 - x^16)(1 - y^2) is zero on the boundary, and dv/dn is not negative.
    let domain = polygon(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
    let f = Formula::read("-240*x^14*(1 - y^2) - 2*(1 - x^16)", 2).unwrap();
    let source = PlaneSource::Smooth(SmoothSource::of_formula(&f, &domain).unwrap());
    let along = 256.0 * 2.0 / 31.0 * 16.0 / 15.0;
    let across = 8.0 / 3.0 * 2.0 * (1.0 - 2.0 / 17.0 + 1.0 / 33.0);
    let known: f64 = -0.5 * (along + across);
    let start = start(&domain, &[&[]]);
    let problem = PlaneProblem { domain, source };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    let [lower, upper] = found.bracket.unwrap();
    // Sums of the moduli of terms, by which rounding is bounded, are far above the values.
    assert!(upper - lower < -1e-6 * known, "{lower} {upper}");
    let place = 4.0 * f64::EPSILON * known.abs();
    assert!(lower <= known + place && known - place <= upper, "{lower} {known} {upper}");
    assert!((found.values(&[[0.0; 2]])[0] + 1.0).abs() < 1e-12);
}

#[test]
fn waves_have_a_bracket_that_holds_the_known_energy() {
    // v = -cos(pi x / 2) cos(pi y / 2) is zero on the boundary, and dv/dn is not negative.
    let domain = polygon(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
    let f = Formula::read("-pi^2/2*cos(pi*x/2)*cos(pi*y/2)", 2).unwrap();
    let source = PlaneSource::Smooth(SmoothSource::of_formula(&f, &domain).unwrap());
    let found = solved(domain, source, &[]);
    let known = -0.25 * PI * PI;
    assert!((found.energy / known - 1.0).abs() < 1e-14, "{}", found.energy);
    let [lower, upper] = found.bracket.unwrap();
    assert!(lower <= known && known <= upper, "{lower} {known} {upper}");
    assert!((found.values(&[[0.0; 2]])[0] + 1.0).abs() < 1e-12);
}

#[test]
fn without_f_nothing_moves_under_friction() {
    let domain = lshape().with_law(Law::friction(2.0).unwrap());
    let start = start(&domain, &[&[]]);
    let problem = PlaneProblem { domain, source: pieces("else=0") };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    let [lower, upper] = found.bracket.unwrap();
    assert_eq!([found.energy, upper, found.values(&[[0.5, 0.5]])[0]], [0.0; 3]);
    // The proof counts the least numbers as errors of rounding.
    assert!((-1e-15..=0.0).contains(&lower), "{lower}");
}

#[test]
fn holes_and_friction_have_the_digits_of_two_levels() {
    let outer = [[-0.5510441, 0.8344761], [0.8789100, 0.4769876]];
    for (law, energy) in [(Law::FIXED, -0.693480313), (Law::FREE, -1.042053659)] {
        let loops = vec![circle(1.0, Law::SIGNORINI, true), circle(0.5, law, false)];
        let domain = PlaneDomain::new(loops).unwrap();
        let start = start(&domain, &[&outer, &[]]);
        let source = pieces("disc(.2,.8,.15)=30; else=-2");
        let found =
            solve(&PlaneProblem { domain, source }, &start, &mut Effort::default()).unwrap();
        assert!((found.energy - energy).abs() < 1e-9, "{law:?}: {}", found.energy);
    }
    let ends = [
        [-1.0, -0.0155635],
        [0.0, -0.3180937],
        [0.3947503, 0.0],
        [0.2811096, 1.0],
        [-0.8548659, 1.0],
        [-1.0, 0.8094307],
    ];
    let domain = lshape().with_law(Law::friction(0.3).unwrap());
    let start = start(&domain, &[&ends]);
    let source = pieces("disc(-.3,.4,.4)=4; else=-.6");
    let found = solve(&PlaneProblem { domain, source }, &start, &mut Effort::default()).unwrap();
    assert!((found.energy + 0.232159340).abs() < 1e-9, "{}", found.energy);
}

/// f = 3 on a region of the square, in its lower left quadrant up to a height, and `others` on the rest.
fn on_two_regions(top: f64, others: &str) -> PlaneSource {
    let points = [
        [-0.5, -0.5],
        [0.0, -0.5],
        [0.5, -0.5],
        [0.5, 0.5],
        [-0.5, 0.5],
        [-0.5, top],
        [-0.5, -0.5],
        [0.0, -0.5],
        [0.0, top],
        [-0.5, top],
    ];
    let beside = [[0, 9], [1, 9], [1, 9], [1, 9], [1, 9], [0, 9], [9, 9], [0, 1], [0, 1]];
    let mut borders = Vec::new();
    for (k, regions) in beside.into_iter().enumerate().filter(|(_, regions)| *regions != [9, 9]) {
        let side = PlaneSide::segment([points[k], points[k + 1]], Law::FREE, 0);
        borders.push(RegionBorder { side, regions: regions.map(|k| (k < 9).then_some(k)) });
    }
    let pieces = ["else=3", others].map(|f| f.parse().unwrap()).to_vec();
    PlaneSource::Pieces(Regions { borders, pieces })
}

#[test]
fn short_arcs_between_both_signs_of_v_move_to_their_place() {
    let law = Law::new(0.0, 0.188).unwrap();
    let domain = PlaneDomain::new(vec![circle(1.0, law, true)]).unwrap();
    let arcs = vec![[4.8089278, 4.8243186], [1.9340425, 1.9405874]];
    let gaps = vec![BoundaryState::SlipsUp, BoundaryState::SlipsDown];
    let contact = vec![RingContact { arcs, gaps }];
    let source = pieces(
        "halfplane(-0.13,0.67,-0.904)=0.801; rect(-0.5,0.46,-0.9,0.3)=-0.689; \
         disc(0.445724024,0.826,0.665)=-2.277; rect(0.32,0.8,-0.092,0.8)=8.604; else=-1.925",
    );
    let problem = PlaneProblem { domain, source };
    let start = PlaneStart { contact, spacing: 0.0327 };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    // Finite elements with four times as many nodes along the boundary.
    let [lower, upper] = [-1.58479621, -1.58470703];
    assert!(lower < found.energy && found.energy < upper, "{}", found.energy);
    assert!(found.bracket.is_ok() && found.contact.len() == 2, "{:?}", found.bracket);
}

#[test]
fn regions_are_as_pieces_and_v_solves_the_equation_in_any_coordinates() {
    let q = 0.094_404_156_233_095_12;
    // The quadrant is a region, or the upper half of it is and a shape of the other region the lower one.
    for (top, others) in [(0.0, "else=-1.1"), (-0.25, "rect(-0.5,0,-0.4,0)=3; else=-1.1")] {
        let found = solved(square(), on_two_regions(top, others), &[[0.5, q], [q, 0.5]]);
        assert!((found.energy / -0.09505172075335079 - 1.0).abs() < 1e-12, "{}", found.energy);
    }
    // The triangle in other coordinates and units.
    let ends = [[0.4959209, 0.0381478], [0.2100324, 0.5775890]];
    let f = pieces("halfplane(1,.3,.4)=4; else=-3");
    let small = solved(triangle(), f.clone(), &ends);
    let frame = Frame { origin: [512.0, -256.0], unit: 64.0, height: 0.5 };
    let domain = PlaneDomain { frame, ..triangle() };
    let start = start(&domain, &[&ends]);
    let problem = PlaneProblem { domain, source: f };
    let large = solve(&problem, &start, &mut Effort::default()).unwrap();
    assert_eq!(large.energy, 2048.0 * 2048.0 * small.energy);
    assert_eq!(large.bracket, small.bracket.map(|ends| ends.map(|end| 2048.0 * 2048.0 * end)));
    assert_eq!([large.force, large.integral], [small.force, small.integral].map(|f| 2048.0 * f));
    let point = [0.5, 0.375];
    let far = |[x, y]: [f64; 2]| frame.outside(Complex::new(x, y));
    let ((v, slope), (height, gradient)) =
        (large.at(&far(point)).unwrap(), small.at(&point).unwrap());
    assert_eq!((v, slope), (2048.0 * height, gradient.map(|x| 32.0 * x)));
    for (one, other) in large.contact.iter().zip(&small.contact) {
        assert_eq!([one.from, one.to], [other.from, other.to].map(far));
        assert_eq!((one.force, one.length), (2048.0 * other.force, 64.0 * other.length));
    }
    let step = 1e-3;
    let [centre, right, left, above, below] =
        [[0.0, 0.0], [step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]]
            .map(|[x, y]| small.values(&[[point[0] + x, point[1] + y]])[0]);
    let laplacian = (right + left + above + below - 4.0 * centre) / (step * step);
    assert!((laplacian - 3.0).abs() < 1e-3, "{laplacian}");
    assert!((gradient[0] - (right - left) / (2.0 * step)).abs() < 1e-5, "{gradient:?}");
    assert!((gradient[1] - (above - below) / (2.0 * step)).abs() < 1e-5, "{gradient:?}");
    // In contact v is zero, and outside of it the flux.
    let own = &small.components[0];
    let (frame, side) = (own.setup.domain.frame, &own.setup.domain.rings[0].sides[0]);
    let value = own.values(&[frame.outside(side.point(0.9))])[0] / frame.of_value();
    let flux = own.gradient(side.point(0.2)).dot(-side.tangent(0.2).turned());
    assert!(value.abs() < 1e-12 && flux.abs() < 1e-9, "{value} {flux}");
}

#[test]
fn brackets_of_spoilt_solutions_hold_and_what_is_not_proved_has_none() {
    /// Energy of the L-shape with f = -1, and a unit in the last place.
    const KNOWN: f64 = -0.1070379013;
    const PLACE: f64 = 1e-10;
    let domain = lshape();
    let start = start(&domain, &[&[]]);
    let setup = Setup::new(&PlaneProblem { domain, source: pieces("else=-1") }).unwrap();
    let mut found = search::search(&setup, &start, &mut Effort::default()).unwrap();
    let whole = proof::bracket(&setup, &found).unwrap();
    assert!(whole.relative() < 1e-10, "{whole:?}");
    assert!(whole.lower < KNOWN + PLACE && whole.upper > KNOWN - PLACE, "{whole:?}");
    let spoilt: Vec<_> = (0..found.fit.coefficients.len()).step_by(17).collect();
    for (by, least) in [(1e-6, 3e-10), (1e-4, 3e-7)] {
        let kept = found.fit.coefficients.clone();
        spoilt.iter().for_each(|&k| found.fit.coefficients[k].re += by);
        let bracket = proof::bracket(&setup, &found).unwrap();
        assert!(bracket.lower < KNOWN + PLACE && KNOWN - PLACE < bracket.upper, "{bracket:?}");
        assert!(bracket.relative() > least, "{bracket:?}");
        found.fit.coefficients = kept;
    }
    let family = &mut found.fit.functions.families[0];
    family.inwards = -family.inwards;
    assert!(proof::bracket(&setup, &found).is_err());
}

/// Bounds of the energy of a problem all in contact, which are proved.
fn proved(domain: PlaneDomain, f: &str) -> [f64; 2] {
    let start = start(&domain, &[&[]]);
    let source = PlaneSource::Pieces(Regions::all(domain.frame.pieces(&f.parse().unwrap())));
    let problem = PlaneProblem { domain, source };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    found.bracket.unwrap_or_else(|step| panic!("{f}: {step}"))
}

#[test]
fn jumps_of_f_that_cross_the_boundary_next_to_a_corner_count_where_they_are() {
    // Without the corner that is cut off, whose area is below 1e-19; 9 times the torsion of a square of side 2, by its
    // series.
    let [of_l, of_square]: [f64; 2] = [-0.963_341_112_089_39, -2.530_386_269_192_8];
    let square = || polygon(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
    let upside_down =
        || polygon(&[[0.0, 0.0], [-1.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, 1.0]]);
    for (domain, f, known) in [
        (seen_lshape(), "halfplane(1,0.3,-1.2999999999)=4; else=-3", of_l),
        (seen_lshape(), "halfplane(1,0.3,-1.29999999995)=400; else=-3", of_l),
        (upside_down(), "halfplane(-1,-0.3,-1.2999999998)=-60; else=-3", of_l),
        (square(), "disc(0,0,1.414213562)=-3; else=4", of_square),
        (square(), "disc(0,0,1.414213562)=-3; else=-70", of_square),
    ] {
        let [lower, upper] = proved(domain, f);
        let rounding = -1e-14 * known;
        assert!(lower < known + rounding && known - rounding < upper, "{f}: {lower} {upper}");
        assert!(upper - lower < -1e-7 * known, "{f}: {lower} {upper}");
    }
}

#[test]
fn pieces_of_f_that_would_vanish_are_refused() {
    for (f, reason) in [
        ("disc(-.41,.37,1e-12)=5.4e23; else=-3", "f has a part that is too narrow"),
        ("rect(-3e-14,0,-1,0)=1e14; else=-3", "f has a part that is too narrow"),
        ("halfplane(0,1,-0.9999999999999)=4; else=-3", ""),
        ("disc(-9,.37,1e-12)=5.4e23; else=-3", ""),
        ("halfplane(0,1,-1)=4; else=-3", ""),
    ] {
        let problem = PlaneProblem { domain: lshape(), source: pieces(f) };
        let refused = Setup::new(&problem).err().map_or(String::new(), |e| e.to_string());
        assert_eq!(refused.is_empty(), reason.is_empty(), "{f}: {refused}");
        assert!(refused.starts_with(reason), "{f}: {refused}");
    }
}
