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
use crate::spectral::source::smooth::SmoothSource;
use known::{
    BenchProblem, HALF_DISC, Radial, SolvedKnown, circle, known, pieces, polygon, sector, slips,
    sticks, with_disc,
};
use std::f64::consts::PI;

/// Problems that one fit solves: nothing moves.
pub(crate) fn all_known() -> Vec<BenchProblem> {
    let without_values = [discs(), split_discs(), sectors(), polygons(), bars()];
    without_values.into_iter().chain([values()]).flatten().collect()
}

/// One of them, solved.
pub(crate) fn solved(name: &str) -> SolvedKnown {
    all_known().into_iter().find(|own| own.name == name).expect("its name is known").solved()
}

fn disc(law: Law) -> Vec<Vec<PlaneSide>> {
    vec![circle(1.0, law, true)]
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

fn sectors() -> Vec<BenchProblem> {
    let mut all = Vec::new();
    for (name, angle, law) in [
        ("sector of 60 degrees", PI / 3.0, Law::SIGNORINI),
        ("three quarters of a disc", 1.5 * PI, Law::FIXED),
    ] {
        let energy = -angle / 32.0;
        all.push(known(name, vec![sector(angle, law)], one("else=-1"), vec![sticks()], energy));
    }
    let mut half = sector(PI, Law::SIGNORINI);
    half.iter_mut().for_each(|side| side.law = Law::SIGNORINI);
    let own = known("half disc", vec![half], one("else=-2"), vec![sticks()], -HALF_DISC);
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
    let smooth = SmoothSource::of_formula(&f, &domain).unwrap();
    let source = (Law::SIGNORINI, PlaneSource::Smooth(smooth));
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
    let (fixed, contact, free) = (Law::FIXED, Law::SIGNORINI, Law::FREE);
    let [held, above, lifted] =
        [Law::fixed(1.0), Law::above(0.25, 0.0), Law::above(-0.5, -0.25)].map(Result::unwrap);
    let half = Law::above(0.5, 0.0).unwrap();
    let (below, low) = (Law::below(0.3, 0.4).unwrap(), Law::fixed(-0.2).unwrap());
    let [given, down] = [Law::free(-1.5), Law::fixed(-0.75)].map(Result::unwrap);
    let [up, falls] = [SlipsUp, SlipsDown].map(Some);
    // Laws and states on the hole and outside; a state is none where v has the value of the law, or takes any.
    for (name, laws, f, states, radial) in [
        (
            "gap round a fixed hole",
            [fixed, contact],
            1.0,
            [None, up],
            Radial::rising(1.0, 0.0, 0.0),
        ),
        (
            "ring that slips up",
            [fixed, friction(0.4)],
            3.0,
            [None, up],
            Radial::rising(3.0, 0.0, -0.4),
        ),
        (
            "ring that slips down",
            [fixed, limit(0.3)],
            -3.0,
            [None, falls],
            Radial::rising(-3.0, 0.0, 0.3),
        ),
        ("free hole", [free, contact], -2.0, [None; 2], Radial::falling(-2.0, 0.0, 0.0)),
        ("gap round a hole", [contact, fixed], 2.0, [up, None], Radial::falling(2.0, 0.0, 0.0)),
        ("ring in contact", [contact; 2], -2.0, [None; 2], Radial::between(-2.0, [0.0; 2])),
        ("ring above a gap", [held, above], -4.0, [None, up], Radial::rising(-4.0, 1.0, 0.0)),
        ("ring on its gap", [held, half], -4.0, [None; 2], Radial::between(-4.0, [1.0, 0.5])),
        (
            "ring above a gap with a flux",
            [held, lifted],
            -4.0,
            [None, up],
            Radial::rising(-4.0, 1.0, -0.25),
        ),
        ("ring with a given flux", [down, given], 2.0, [None; 2], Radial::rising(2.0, -0.75, -1.5)),
        ("hole below a gap", [below, low], 3.0, [falls, None], Radial::falling(3.0, 0.4, -0.2)),
        (
            "hole that slips down in a ring in contact",
            [friction(0.4), contact],
            -2.0,
            [falls, None],
            Radial::falling(-2.0, 0.4, 0.0),
        ),
        (
            "hole that slips up from a value",
            [rubs(0.25, 0.125), rubs(2.0, -0.125)],
            4.0,
            [up, None],
            Radial::falling(4.0, -0.25, -0.125),
        ),
    ] {
        let mut energy = radial.inner_energy();
        for (k, r) in [0.5, 1.0].into_iter().enumerate() {
            let (own, v) = (laws[k], radial.at(r)[0]);
            let flux = match states[k] {
                Some(SlipsDown) => own.hi(),
                None if !own.is_free() => continue,
                _ => own.lo(),
            };
            energy -= 2.0 * PI * r * flux * (v - own.at());
        }
        let [inner, outer] = states.map(|state| state.map_or(sticks(), slips));
        let source = pieces(&format!("else={f}"));
        let loops = vec![circle(1.0, laws[1], true), circle(0.5, laws[0], false)];
        all.push(known(name, loops, (contact, source), vec![outer, inner], energy));
    }
    // v = r^2 / 4 + 3/10 - 1/4, with a flux of 1/2 that both laws allow.
    let unit = Round::sphere([0.0; 2], 1.0);
    let halves = vec![
        PlaneSide::arc(unit, [0.0, PI], Law::above(0.3, 0.0).unwrap(), 0),
        PlaneSide::arc(unit, [PI, 2.0 * PI], rubs(0.6, 0.3), 1),
    ];
    let energy = 0.3 * PI - PI / 16.0;
    all.push(known("disc under two laws", vec![halves], one("else=-1"), vec![sticks()], energy));
    let bar = [[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [0.0, 1.0]];
    let laws = [Law::fixed(-0.5).unwrap(), free, Law::fixed(1.0).unwrap(), free];
    let open = vec![polygon(&bar, &laws)];
    all.push(known("bar between values", open, one("else=0"), vec![sticks()], 0.75 * 2.25));
    // v leaves the gap next to the values.
    let gap = Law::above(-2.0, 0.0).unwrap();
    let laws = [Law::fixed(-0.5).unwrap(), gap, Law::fixed(1.0).unwrap(), gap];
    let open = vec![polygon(&bar, &laws)];
    let states = vec![slips(SlipsUp)];
    all.push(known("bar beside gaps", open, one("else=0"), states, 0.75 * 2.25));
    let laws = [Law::fixed(2.0).unwrap(), free, Law::free(0.3).unwrap(), free];
    let open = vec![polygon(&bar, &laws)];
    let energy = 1.5 * (0.045 - 0.3 * 2.3);
    all.push(known("bar with a given flux", open, one("else=0"), vec![sticks()], energy));
    all
}
