//! The problems.

pub(super) mod known;
pub(super) mod spoilt;

use crate::mesh::Round;
use crate::problem::formula::Formula;
use crate::problem::law::BoundaryState::{SlipsDown, SlipsUp};
use crate::problem::law::Law;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::ring::RingContact;
use crate::spectral::geometry::side::PlaneSide;
use crate::spectral::source::PlaneSource;
use crate::spectral::source::polynomial::Polynomial;
use known::{
    BenchProblem, HALF_DISC, Radial, SolvedKnown, circle, known, pieces, polygon, sector, slips,
    sticks, with_disc,
};
use std::f64::consts::PI;

/// Problems that one fit solves: nothing moves.
pub(in crate::spectral::proof) fn all_known() -> Vec<BenchProblem> {
    let without_values = [discs(), split_discs(), rings(), sectors(), polygons(), bars()];
    without_values.into_iter().chain([values()]).flatten().collect()
}

/// One of them, solved.
pub(in crate::spectral::proof) fn solved(name: &str) -> SolvedKnown {
    all_known().into_iter().find(|own| own.name == name).expect("its name is known").solved()
}

fn disc(law: Law) -> Vec<Vec<PlaneSide>> {
    vec![circle(1.0, law, true)]
}

fn ring(outer: Law, inner: Law) -> Vec<Vec<PlaneSide>> {
    vec![circle(1.0, outer, true), circle(0.5, inner, false)]
}

/// The paper's law with an f.
fn one(f: &str) -> (Law, PlaneSource) {
    (Law::SIGNORINI, pieces(f))
}

fn friction(g: f64) -> Law {
    Law::friction(g).unwrap()
}

fn limit(hi: f64) -> Law {
    Law::limited(hi).unwrap()
}

fn discs() -> Vec<BenchProblem> {
    let mut all = vec![
        known("disc in contact", disc(Law::SIGNORINI), one("else=-1"), vec![sticks()], -PI / 16.0),
        known("fixed disc", disc(Law::FIXED), one("else=2"), vec![sticks()], -PI / 4.0),
        known(
            "disc under friction",
            disc(Law::SIGNORINI),
            (friction(0.6), pieces("else=1")),
            vec![sticks()],
            -PI / 16.0,
        ),
        known(
            "disc under a limit",
            disc(Law::SIGNORINI),
            (limit(0.6), pieces("else=-1")),
            vec![sticks()],
            -PI / 16.0,
        ),
    ];
    for (name, place, [w, e, p]) in [
        ("disc in a disc", "disc(0,0,0.25)=-40; else=-1", [-39.0 * PI / 16.0, 0.25, 0.0]),
        (
            "disc beside the middle",
            "disc(0.3,0,0.125)=-40; else=-1",
            [-39.0 * PI / 64.0, 0.125, 0.3],
        ),
        (
            "small disc",
            "disc(0.1,0,0.0078125)=-4000; else=-1",
            [-3999.0 * PI / 16384.0, 0.0078125, 0.1],
        ),
    ] {
        let own = known(
            name,
            disc(Law::SIGNORINI),
            one(place),
            vec![sticks()],
            with_disc(-1.0, [w, e, p]),
        );
        all.push(BenchProblem { is_hard: p > 0.0, ..own });
    }
    all
}

/// Discs with splits on the boundary.
fn split_discs() -> Vec<BenchProblem> {
    let mut all = Vec::new();
    // Flux 1 of a law that ends there: a part may as well slip.
    let unit = Round::sphere([0.0; 2], 1.0);
    let parts = vec![
        PlaneSide::arc(unit, [0.0, PI], Law::FIXED, 0),
        PlaneSide::arc(unit, [PI, 2.0 * PI], Law::SIGNORINI, 1),
    ];
    let arcs = RingContact { arcs: vec![[4.0, 5.5]], gaps: vec![SlipsDown] };
    all.push(known(
        "ends of contact on a disc",
        vec![parts],
        (limit(1.0), pieces("else=-2")),
        vec![arcs],
        -PI / 4.0,
    ));
    let odd = one("halfplane(1,0,0)=-3; else=-1");
    let own = known(
        "crossings on a disc",
        disc(Law::SIGNORINI),
        odd,
        vec![sticks()],
        -PI / 4.0 - 0.5 * HALF_DISC,
    );
    all.push(BenchProblem { is_hard: true, ..own });
    all
}

fn rings() -> Vec<BenchProblem> {
    let mut all = Vec::new();
    let slipping = Radial::slipping(1.0, 0.0).energy(0.0);
    all.push(known(
        "gap round a fixed hole",
        ring(Law::SIGNORINI, Law::FIXED),
        one("else=1"),
        vec![slips(SlipsUp), sticks()],
        slipping,
    ));
    let slipping = Radial::slipping(3.0, -0.4).energy(-0.4);
    let rubbing = (friction(0.4), pieces("else=3"));
    all.push(known(
        "ring that slips up",
        ring(Law::SIGNORINI, Law::FIXED),
        rubbing,
        vec![slips(SlipsUp), sticks()],
        slipping,
    ));
    let slipping = Radial::slipping(-3.0, 0.3).energy(0.3);
    let limited = (limit(0.3), pieces("else=-3"));
    all.push(known(
        "ring that slips down",
        ring(Law::SIGNORINI, Law::FIXED),
        limited,
        vec![slips(SlipsDown), sticks()],
        slipping,
    ));
    let free = Radial::insulated(-2.0).energy(0.0);
    all.push(known(
        "free hole",
        ring(Law::SIGNORINI, Law::FREE),
        one("else=-2"),
        vec![sticks(), sticks()],
        free,
    ));
    all.push(known(
        "gap round a hole",
        ring(Law::FIXED, Law::SIGNORINI),
        one("else=2"),
        vec![sticks(), slips(SlipsUp)],
        free,
    ));
    let held = Radial::held(-2.0).energy(0.0);
    all.push(known(
        "ring in contact",
        ring(Law::SIGNORINI, Law::SIGNORINI),
        one("else=-2"),
        vec![sticks(), sticks()],
        held,
    ));
    all
}

fn sectors() -> Vec<BenchProblem> {
    let mut all = Vec::new();
    for (name, angle, law) in [
        ("sector of 60 degrees", PI / 3.0, Law::SIGNORINI),
        ("three quarters of a disc", 1.5 * PI, Law::FIXED),
    ] {
        let energy = -angle / 32.0;
        all.push(known(name, vec![sector(angle, law)], one("else=-1"), vec![sticks()], energy));
    }
    let half = vec![sector(PI, Law::SIGNORINI)];
    let half: Vec<Vec<PlaneSide>> = half
        .into_iter()
        .map(|sides| {
            sides.into_iter().map(|side| PlaneSide { law: Law::SIGNORINI, ..side }).collect()
        })
        .collect();
    let own = known("half disc", half, one("else=-2"), vec![sticks()], -HALF_DISC);
    all.push(BenchProblem { is_hard: true, ..own });
    all
}

fn polygons() -> Vec<BenchProblem> {
    let mut all = Vec::new();
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.75_f64.sqrt()]];
    let torsion = -3f64.sqrt() / 640.0;
    all.push(known(
        "triangle",
        vec![polygon(&triangle, &[Law::SIGNORINI; 3])],
        one("else=-1"),
        vec![sticks()],
        torsion,
    ));
    let half = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.75_f64.sqrt()]];
    let half = vec![polygon(&half, &[Law::SIGNORINI, Law::FREE, Law::SIGNORINI])];
    all.push(known("half triangle", half, one("else=-1"), vec![sticks()], 0.5 * torsion));
    // v = -(1 - x^2) (1 - y^2).
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let square = vec![polygon(&square, &[Law::SIGNORINI; 4])];
    let f = Formula::read("-2*(2 - x^2 - y^2)", 2).unwrap();
    let domain = PlaneDomain::new(square.clone()).unwrap();
    let polynomial = Polynomial::of_formula(&f, &domain).unwrap();
    let source = (Law::SIGNORINI, PlaneSource::Polynomial(polynomial));
    all.push(known("square", square, source, vec![sticks()], -128.0 / 45.0));
    all
}

fn bars() -> Vec<BenchProblem> {
    let mut all = Vec::new();
    let bar = [[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [0.0, 1.0]];
    let open = vec![polygon(&bar, &[Law::FIXED, Law::SIGNORINI, Law::SIGNORINI, Law::SIGNORINI])];
    let thin = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.5], [0.0, 0.5]];
    let thin = vec![polygon(&thin, &[Law::FIXED, Law::SIGNORINI, Law::SIGNORINI, Law::SIGNORINI])];
    all.push(known("thin bar", thin, one("else=1"), vec![slips(SlipsUp)], -1.0 / 12.0));
    all.push(known("bar with gaps", open, one("else=1"), vec![slips(SlipsUp)], -0.25));
    let rubbing = vec![polygon(&bar, &[Law::FIXED, Law::FREE, Law::SIGNORINI, Law::FREE])];
    // v = 3/4 y - y^2 / 2, 1/4 at the top.
    let energy = 1.5 * (-0.5 * (0.375 - 1.0 / 6.0) + 0.125 * 0.25);
    all.push(known(
        "bar that slips up",
        rubbing.clone(),
        (friction(0.25), pieces("else=1")),
        vec![slips(SlipsUp)],
        energy,
    ));
    all.push(known(
        "bar that slips down",
        rubbing,
        (limit(0.25), pieces("else=-1")),
        vec![slips(SlipsDown)],
        energy,
    ));
    all
}

/// Friction with a value.
fn rubs(g: f64, at: f64) -> Law {
    friction(g).with_at(at).unwrap()
}

/// Problems of laws with values and given fluxes, and of several laws on one component.
fn values() -> Vec<BenchProblem> {
    let mut all = Vec::new();
    let turn = 2.0 * PI;
    let lifted = Radial::rising(-4.0, 1.0, 0.0);
    for (name, laws, f, states, radial, slipped) in [
        (
            "ring above a gap",
            [Law::fixed(1.0).unwrap(), Law::above(0.25, 0.0).unwrap()],
            "else=-4",
            [sticks(), slips(SlipsUp)],
            lifted,
            0.0,
        ),
        (
            "ring on its gap",
            [Law::fixed(1.0).unwrap(), Law::above(0.5, 0.0).unwrap()],
            "else=-4",
            [sticks(), sticks()],
            Radial::between(-4.0, [1.0, 0.5]),
            0.0,
        ),
        (
            "ring above a gap with a flux",
            [Law::fixed(1.0).unwrap(), Law::above(-0.5, -0.25).unwrap()],
            "else=-4",
            [sticks(), slips(SlipsUp)],
            Radial::rising(-4.0, 1.0, -0.25),
            -0.25 * turn * (Radial::rising(-4.0, 1.0, -0.25).at(1.0)[0] + 0.5),
        ),
        (
            "ring with a given flux",
            [Law::fixed(-0.75).unwrap(), Law::free(-1.5).unwrap()],
            "else=2",
            [sticks(), sticks()],
            Radial::rising(2.0, -0.75, -1.5),
            -1.5 * turn * Radial::rising(2.0, -0.75, -1.5).at(1.0)[0],
        ),
        (
            "hole below a gap",
            [Law::below(0.3, 0.4).unwrap(), Law::fixed(-0.2).unwrap()],
            "else=3",
            [slips(SlipsDown), sticks()],
            Radial::falling(3.0, 0.4, -0.2),
            0.4 * 0.5 * turn * (Radial::falling(3.0, 0.4, -0.2).at(0.5)[0] - 0.3),
        ),
        (
            "hole that slips down in a ring in contact",
            [friction(0.4), Law::SIGNORINI],
            "else=-2",
            [slips(SlipsDown), sticks()],
            Radial::falling(-2.0, 0.4, 0.0),
            0.4 * 0.5 * turn * Radial::falling(-2.0, 0.4, 0.0).at(0.5)[0],
        ),
        (
            "hole that slips up from a value",
            [rubs(0.25, 0.125), rubs(2.0, -0.125)],
            "else=4",
            [slips(SlipsUp), sticks()],
            Radial::falling(4.0, -0.25, -0.125),
            -0.25 * 0.5 * turn * (Radial::falling(4.0, -0.25, -0.125).at(0.5)[0] - 0.125),
        ),
    ] {
        let energy = radial.inner_energy() - slipped;
        let [inner, outer] = states;
        let [of_hole, own] = laws;
        all.push(known(name, ring(own, of_hole), one(f), vec![outer, inner], energy));
    }
    // v = r^2 / 4 + 3/10 - 1/4, with a flux of 1/2 that both laws allow.
    let unit = Round::sphere([0.0; 2], 1.0);
    let halves = vec![
        PlaneSide::arc(unit, [0.0, PI], Law::above(0.3, 0.0).unwrap(), 0),
        PlaneSide::arc(unit, [PI, turn], rubs(0.6, 0.3), 1),
    ];
    let energy = 0.3 * PI - PI / 16.0;
    all.push(known("disc under two laws", vec![halves], one("else=-1"), vec![sticks()], energy));
    let bar = [[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [0.0, 1.0]];
    let free = Law::FREE;
    let laws = [Law::fixed(-0.5).unwrap(), free, Law::fixed(1.0).unwrap(), free];
    let open = vec![polygon(&bar, &laws)];
    all.push(known("bar between values", open, one("else=0"), vec![sticks()], 0.75 * 2.25));
    let laws = [Law::fixed(2.0).unwrap(), free, Law::free(0.3).unwrap(), free];
    let open = vec![polygon(&bar, &laws)];
    let energy = 1.5 * (0.045 - 0.3 * 2.3);
    all.push(known("bar with a given flux", open, one("else=0"), vec![sticks()], energy));
    all
}
