//! Laws with values and fluxes: against closed forms, and against the problem of `z = v - G` with a polynomial G that
//! has the values, which is one of laws without.
//!
//! With G = at and dG/dn = 0 where v may stick, and dG/dn = h on free sides, z has the load `f + Lap G`, and
//! ```text
//! J(v) = J(z) + 1/2 int |grad G|^2 - int f G - int h G,     the last one over free sides.
//! ```

use super::super::super::problem::set_value;
use super::*;
use crate::mesh::{AnyMesh, BuiltIn};
use crate::problem::source::Source;
use crate::spectral::geometry::polygons::loop_of;
use crate::spectral::true_solution_on;
use std::f64::consts::LN_2;

/// Solution from one arc on each loop, between points near its ends, or none.
fn found(domain: PlaneDomain, source: PlaneSource, loops: &[&[[f64; 2]]]) -> TrueSolution {
    let start = start(&domain, loops);
    solve(&PlaneProblem { domain, source }, &start, &mut Effort::default()).unwrap()
}

/// Checks that the brackets of v and of z, moved by a number, hold each other and have ten digits.
fn check_lifted(of_v: &TrueSolution, of_z: &TrueSolution, moved: f64) {
    let (own, other) = (of_v.bracket.unwrap(), of_z.bracket.unwrap().map(|end| end + moved));
    let rounding = 1e-15 * (1.0 + moved.abs());
    let meet = own[0] <= other[1] + rounding && other[0] <= own[1] + rounding;
    assert!(meet, "{own:?} {other:?}");
    let width = (own[1] - own[0]).max(other[1] - other[0]);
    assert!(width < 1e-9 * (1.0 + moved.abs()), "{own:?} {other:?}");
    assert_eq!(of_v.contact.len(), of_z.contact.len());
    for (one, other) in of_v.contact.iter().zip(&of_z.contact) {
        let errors = [one, other].map(|arc| arc.error.unwrap());
        for (which, [a, b]) in [[one.from, other.from], [one.to, other.to]].into_iter().enumerate()
        {
            let apart = (a[0] - b[0]).hypot(a[1] - b[1]);
            assert!(apart <= errors[0][which] + errors[1][which], "{one:?} {other:?}");
        }
    }
}

#[test]
fn a_ring_above_a_gap_has_the_digits_of_the_closed_form() {
    let laws = [Law::above(0.25, 0.0), Law::fixed(1.0)].map(Result::unwrap);
    let loops = vec![circle(1.0, laws[0], true), circle(0.5, laws[1], false)];
    let domain = PlaneDomain::new(loops).unwrap();
    // From contact on all of both circles.
    let found = found(domain, pieces("else=-4"), &[&[], &[]]);
    assert!((found.energy - 7.193_968_447_583_92).abs() < 1e-14 * 7.0, "{}", found.energy);
    let [lower, upper] = found.bracket.unwrap();
    assert!(
        lower <= found.energy && found.energy <= upper && upper - lower < 1e-11,
        "{lower} {upper}"
    );
    let [value, flux] = found.on_boundary([0.6, 0.8]);
    assert!((value - 0.363_705_638_880_11).abs() < 1e-14 && flux == 0.0, "{value} {flux}");
    assert_eq!(found.on_boundary([0.0, 0.5])[0], 1.0);
    assert!(found.contact.is_empty());
    // dv/dr = 2 r - 2 / r.
    let size = 2.0 * PI * (4.0 * LN_2 - 33.0 / 16.0);
    let least = found.gradient.unwrap();
    assert!(least * least < size && size < (1.0 + 1e-4) * least * least, "{least} {size}");
}

#[test]
fn a_value_for_all_of_the_boundary_moves_v_alone() {
    let at = 0.3;
    for (law, f, ends, integral) in [
        (
            Law::SIGNORINI,
            "rect(0,9,0,9)=5; else=-3",
            &[[-1.0, -0.33266642], [0.0, -0.66849237]][..],
            -1.0,
        ),
        (
            Law::friction(0.3).unwrap(),
            "disc(-.3,.4,.4)=4; else=-.6",
            &[
                [-1.0, -0.0155635],
                [0.0, -0.3180937],
                [0.3947503, 0.0],
                [0.2811096, 1.0],
                [-0.8548659, 1.0],
                [-1.0, 0.8094307],
            ],
            4.6 * 0.16 * PI - 1.8,
        ),
    ] {
        let of_z = found(lshape().with_law(law), pieces(f), &[ends]);
        let of_v = found(lshape().with_law(law.with_at(at).unwrap()), pieces(f), &[ends]);
        check_lifted(&of_v, &of_z, -at * integral);
        let [v, z] = [&of_v, &of_z].map(|own| own.values(&[[0.3, 0.7]])[0]);
        assert!((v - z - at).abs() < 1e-10, "{v} {z}");
    }
}

/// The rectangle between 0 and 1, and 0 and 1/2, with these laws at the bottom, on the right, the top and the left.
fn rectangle(laws: [Law; 4]) -> PlaneDomain {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]];
    PlaneDomain::new(vec![loop_of(&corners, &laws)]).unwrap()
}

#[test]
fn a_flux_through_a_free_side_is_a_load() {
    // G = h y^2.
    let h = -1.5;
    let (top, free) = (Law::free(h).unwrap(), Law::FREE);
    let ends = [[0.0, 0.0], [0.5, 0.0]];
    let bottom = Law::SIGNORINI;
    let of_v = found(
        rectangle([bottom, free, top, free]),
        pieces("halfplane(1,0,0.5)=-1; else=4"),
        &[&ends],
    );
    let of_z = found(
        rectangle([bottom, free, free, free]),
        pieces("halfplane(1,0,0.5)=-4; else=1"),
        &[&ends],
    );
    assert!(!of_z.contact[0].closed && of_z.contact[0].length < 0.9, "{:?}", of_z.contact);
    // The means of y^2 and 4 y^2 over the rectangle are 1/12 and 1/3, and G = h / 4 at the top.
    let moved = 0.5 * h * h * 0.5 / 3.0 - h * 0.5 * 1.5 / 12.0 - h * h / 4.0;
    check_lifted(&of_v, &of_z, moved);
}

#[test]
fn a_fixed_value_beside_a_gap_with_a_flux_is_a_load() {
    // G = c (12 y^2 - 16 y^3) + g (1 - 12 y^2 + 16 y^3) is c at the top and g at the bottom, with a slope of 0 at both.
    let (c, gap, flux) = (0.5, 0.125, -0.25);
    let free = Law::FREE;
    let formula = |text: &str, domain: &PlaneDomain| {
        let f = Formula::read(text, 2).unwrap();
        PlaneSource::Smooth(SmoothSource::of_formula(&f, domain).unwrap())
    };
    let bottom = Law::above(gap, flux).unwrap();
    let own = rectangle([bottom, free, Law::fixed(c).unwrap(), free]);
    let lifted = rectangle([Law::above(0.0, flux).unwrap(), free, Law::FIXED, free]);
    let ends = [[0.0, 0.0], [0.5, 0.0]];
    let source = formula("16*x - 12", &own);
    let of_v = found(own, source, &[&ends]);
    // Lap G = (c - g) (24 - 96 y).
    let source = formula("16*x - 12 + 9 - 36*y", &lifted);
    let of_z = found(lifted, source, &[&ends]);
    assert!(of_z.contact.iter().any(|arc| arc.length < 0.9), "{:?}", of_z.contact);
    // The integral of |dG/dy|^2 is 24^2 (c - g)^2 times that of y^2 (1 - 2 y)^2, 1/240; the mean of G that of c and g.
    let moved = 0.5 * 576.0 * (c - gap) * (c - gap) / 240.0 - 0.5 * -4.0 * 0.5 * (c + gap);
    check_lifted(&of_v, &of_z, moved);
}

#[test]
fn a_disc_above_a_plane_has_the_digits_of_the_closed_form() {
    let mut mesh = AnyMesh::from(BuiltIn::Disc.plane().unwrap());
    mesh.set_value("rim", "x").unwrap();
    let found = true_solution_on(mesh.plane().unwrap(), &[Source::constant(-1.0)]).unwrap();
    let (known, [lower, upper]) = (1.222_749_345_068_3, found.bracket.unwrap());
    assert!((found.energy - known).abs() < 1e-13, "{}", found.energy);
    assert!(lower < known && known < upper && upper - lower < 1e-9, "{lower} {upper}");
    let [arc] = &found.contact[..] else { panic!("{:?}", found.contact) };
    for (end, y) in [(arc.from, -1.0), (arc.to, 1.0)] {
        assert!(end[0].abs() < 1e-9 && (end[1] - y).abs() < 1e-9, "{arc:?}");
    }
    assert!((found.force - PI).abs() < 1e-12, "{}", found.force);
    assert!((found.on_boundary([0.8, 0.6])[0] - 0.8).abs() < 1e-15);
}

/// Values on the sides of the square of side 1 round the origin, by a mesh.
fn on_square(law: Law, value: &str, f: &str) -> Result<TrueSolution, PlaneError> {
    let mut mesh = AnyMesh::from(BuiltIn::Square.plane().unwrap());
    mesh.set_law("boundary", law).unwrap();
    mesh.set_value("boundary", value).unwrap();
    true_solution_on(mesh.plane().unwrap(), &[f.parse().unwrap()])
}

#[test]
fn values_by_formulas_are_those_of_a_lift() {
    let gap = Law::above(0.5, 0.0).unwrap();
    let refused = on_square(gap, "0.1*abs(x)", "else=-1").err().unwrap().to_string();
    assert!(refused.contains("the value of v on boundary is no sum of"), "{refused}");
    // G = a x + b y + c is harmonic: J(v) = J(z) + 1/2 (a^2 + b^2) - int f G.
    let f = "quadrant(ll)=3; else=-1.1";
    let of_z = on_square(Law::FIXED, "0", f).unwrap();
    let of_v = on_square(Law::FIXED, "0.3*x - 0.2*y + 1", f).unwrap();
    // The integral of f is 3/4 - 1.1 * 3/4, and those of f x and f y are -4.1/16.
    let moved = 0.5 * 0.13 + 0.075 + 0.1 * 4.1 / 16.0;
    check_lifted(&of_v, &of_z, moved);
}

#[test]
fn a_gap_by_a_cosine_has_the_reference_digits() {
    let laws = [Law::SIGNORINI, Law::FREE, Law::fixed(1.0).unwrap(), Law::FREE];
    let mut domain = rectangle(laws);
    let gap = Formula::read("0.2 + 0.45*(1 - cos(pi*x))", 2).unwrap();
    set_value(&mut domain, 0, &gap).unwrap();
    let found = found(domain, pieces("else=-1"), &[&[[0.79, 0.0], [1.0, 0.0]]]);
    let [lower, upper] = found.bracket.unwrap();
    let known = 0.494_429_697_794_469;
    assert!(lower <= known && known <= upper && upper - lower < 1e-9, "{lower} {upper}");
    assert!((found.energy - known).abs() < 1e-13, "{}", found.energy);
    let end = found.contact[0].from[0];
    assert!((end - 0.789_526_093_591).abs() < 1e-10, "{end}");
}

#[test]
fn v_leaves_a_gap_next_to_a_larger_value() {
    let (gap, fixed) = (Law::above(0.25, 0.0).unwrap(), Law::fixed(1.0).unwrap());
    let free = Law::FREE;
    let own = rectangle([gap, fixed, free, free]);
    // The same where contact may be on the left half alone.
    let corners = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]];
    let laws = [gap, free, fixed, free, free];
    let halves = PlaneDomain::new(vec![loop_of(&corners, &laws)]).unwrap();
    let f = pieces("else=-2");
    let both = [own, halves].map(|own| found(own, f.clone(), &[&[[0.0, 0.0], [0.3, 0.0]]]));
    assert!((0.05..0.45).contains(&both[0].contact[0].length), "{:?}", both[0].contact);
    check_lifted(&both[0], &both[1], 0.0);
}

#[test]
fn a_constant_has_no_error() {
    let law = Law::fixed(-3.0).unwrap();
    let found = found(lshape().with_law(law), pieces("else=0"), &[&[]]);
    let [lower, upper] = found.bracket.unwrap();
    assert!(lower <= 0.0 && 0.0 <= upper && upper - lower < 1e-12, "{lower} {upper}");
    assert!((found.values(&[[0.5, 0.5]])[0] + 3.0).abs() < 1e-13);
}

#[test]
fn an_end_of_contact_stays_where_another_law_begins() {
    // A membrane pressed down: on the right half of the bottom a limit lets it slip.
    let unit = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let laws = [Law::SIGNORINI, Law::limited(0.05).unwrap(), Law::FREE, Law::FREE, Law::FREE];
    let domain = PlaneDomain::new(vec![loop_of(&unit, &laws)]).unwrap();
    let start = PlaneStart {
        contact: vec![RingContact { arcs: vec![[0.0, 0.5]], gaps: vec![BoundaryState::SlipsDown] }],
        spacing: 1e-3,
    };
    let problem = PlaneProblem { domain, source: pieces("else=-1") };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    let [lower, upper] = found.bracket.unwrap();
    assert!(upper - lower < -1e-9 * found.energy, "{lower} {upper}");
    let [arc] = &found.contact[..] else { panic!("{:?}", found.contact) };
    assert!((arc.to[0] - 0.5).abs() < 1e-15 && arc.to[1] == 0.0, "{arc:?}");
    assert!((arc.length - 0.5).abs() < 1e-15 && arc.error.unwrap()[1] < 1e-15, "{arc:?}");
    assert!(found.values(&[[0.75, 0.0]])[0] < -0.01);
}
