//! Problems whose energy is known in closed form, with fits of one contact set.

use crate::mesh::Condition;
use crate::problem::law::Law;
use crate::spectral::domain::{PlaneCircle, PlaneDomain, PlaneSide};
use crate::spectral::plane::boundary::RingContact;
use crate::spectral::plane::fit::Fit;
use crate::spectral::plane::polynomial::Polynomial;
use crate::spectral::plane::problem::{PlaneProblem, PlaneSource};
use crate::spectral::plane::search::PlaneFound;
use crate::spectral::plane::setup::{Level, Setup};
use std::f64::consts::{LN_2, PI};

/// Problem with a contact set and the energy of its solution.
pub(in crate::spectral::plane::proof) struct KnownEnergy {
    pub name: &'static str,
    pub problem: PlaneProblem,
    pub contact: Vec<RingContact>,
    pub energy: f64,
    /// True if its solution is no polynomial.
    pub is_hard: bool,
}

/// Data of a solved problem with its solution.
pub(in crate::spectral::plane::proof) struct SolvedKnown {
    pub name: &'static str,
    pub setup: Setup,
    pub found: PlaneFound,
    pub energy: f64,
}

impl KnownEnergy {
    /// All conditions on a level.
    pub(in crate::spectral::plane::proof) fn solved(self) -> SolvedKnown {
        let level = if self.is_hard { &Level::FINE[0] } else { &Level::COARSE };
        let setup = Setup::new(&self.problem).unwrap();
        let fit = Fit::new(&setup, &self.contact, level);
        let found = PlaneFound::known(&setup, &self.contact, fit);
        SolvedKnown { name: self.name, setup, found, energy: self.energy }
    }
}

/// Loop on which all sticks.
pub(in crate::spectral::plane::proof) fn sticks() -> RingContact {
    RingContact::default()
}

/// Loop on which nothing sticks, with a flux.
pub(in crate::spectral::plane::proof) fn slips(flux: f64) -> RingContact {
    RingContact { arcs: Vec::new(), gaps: vec![flux] }
}

/// f constant on pieces.
pub(in crate::spectral::plane::proof) fn pieces(f: &str) -> PlaneSource {
    PlaneSource::Pieces(f.parse().unwrap())
}

/// Full circle round the origin.
pub(in crate::spectral::plane::proof) fn circle(
    radius: f64,
    condition: Condition,
    is_outer: bool,
) -> Vec<PlaneSide> {
    let angles = if is_outer { [0.0, 2.0 * PI] } else { [2.0 * PI, 0.0] };
    let own = PlaneCircle { centre: [0.0; 2], radius };
    vec![PlaneSide::arc(own, angles, condition, usize::from(!is_outer))]
}

/// Polygon with a condition for each side.
pub(in crate::spectral::plane::proof) fn polygon(
    points: &[[f64; 2]],
    conditions: &[Condition],
) -> Vec<PlaneSide> {
    let ends = |k: usize| [points[k], points[(k + 1) % points.len()]];
    let sides = conditions.iter().enumerate();
    sides.map(|(k, &condition)| PlaneSide::segment(ends(k), condition, k)).collect()
}

/// Sector of the unit disc, with free straight sides.
fn sector(angle: f64, arc: Condition) -> Vec<PlaneSide> {
    let end = [libm::cos(angle), libm::sin(angle)];
    let unit = PlaneCircle { centre: [0.0; 2], radius: 1.0 };
    vec![
        PlaneSide::segment([[0.0; 2], [1.0, 0.0]], Condition::Free, 0),
        PlaneSide::arc(unit, [0.0, angle], arc, 1),
        PlaneSide::segment([end, [0.0; 2]], Condition::Free, 2),
    ]
}

fn known(
    name: &'static str,
    loops: Vec<Vec<PlaneSide>>,
    (law, source): (Law, PlaneSource),
    contact: Vec<RingContact>,
    energy: f64,
) -> KnownEnergy {
    let domain = PlaneDomain::new(loops).unwrap();
    KnownEnergy {
        name,
        problem: PlaneProblem { domain, law, source },
        contact,
        energy,
        is_hard: false,
    }
}

/// The solution `a + b log r - f r^2 / 4` on the ring between the radii 1/2 and 1.
struct Radial {
    f: f64,
    a: f64,
    b: f64,
}

impl Radial {
    /// With v = 0 on the inner circle, and a flux on the outer one.
    fn slipping(f: f64, flux: f64) -> Self {
        let b = flux + 0.5 * f;
        Self { f, a: f / 16.0 + b * LN_2, b }
    }

    /// With v = 0 on the outer circle, and no flux on the inner one.
    fn insulated(f: f64) -> Self {
        Self { f, a: 0.25 * f, b: f / 8.0 }
    }

    /// With v = 0 on both.
    fn held(f: f64) -> Self {
        Self { f, a: 0.25 * f, b: 3.0 * f / (16.0 * LN_2) }
    }

    fn outer(&self) -> f64 {
        self.a - 0.25 * self.f
    }

    /// Energy, with a flux on the outer circle where v is not zero there.
    fn energy(&self, flux: f64) -> f64 {
        let sum = self.a * 0.375 + self.b * (LN_2 / 8.0 - 3.0 / 16.0) - self.f * 15.0 / 256.0;
        -PI * self.f * sum - PI * flux * self.outer()
    }
}

/// `int u` for `-Lap u = 1` and u = 0 on the boundary of the half disc of radius 1, twice: St. Venant.
const HALF_DISC: f64 = PI / 4.0 - 2.0 / PI;

/// Energy of the unit disc, all of whose boundary sticks, with f = b but for a disc of radius e at a distance p from
/// the middle, where it is larger by the weight w over its area: Newton's theorem and Green's function.
fn with_disc(b: f64, [w, e, p]: [f64; 3]) -> f64 {
    let own = w * w / (2.0 * PI) * (libm::log((1.0 - p * p) / e) + 0.25);
    let both = 0.5 * w * b * (1.0 - p * p - 0.5 * e * e);
    -0.5 * (own + both + b * b * PI / 8.0)
}

/// Problems that one fit solves: nothing moves.
pub(in crate::spectral::plane::proof) fn all_known() -> Vec<KnownEnergy> {
    use Condition::{Contact, Fixed, Free};
    let (papers, friction) = (Law::SIGNORINI, |g| Law::friction(g).unwrap());
    let limit = |hi| Law::limited(hi).unwrap();
    let disc = |condition| vec![circle(1.0, condition, true)];
    let ring = |outer, inner| vec![circle(1.0, outer, true), circle(0.5, inner, false)];
    let one = |f: &str| (papers, pieces(f));
    let mut all = vec![
        known("disc in contact", disc(Contact), one("else=-1"), vec![sticks()], -PI / 16.0),
        known("fixed disc", disc(Fixed), one("else=2"), vec![sticks()], -PI / 4.0),
        known(
            "disc under friction",
            disc(Contact),
            (friction(0.6), pieces("else=1")),
            vec![sticks()],
            -PI / 16.0,
        ),
        known(
            "disc under a limit",
            disc(Contact),
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
        let own =
            known(name, disc(Contact), one(place), vec![sticks()], with_disc(-1.0, [w, e, p]));
        all.push(KnownEnergy { is_hard: p > 0.0, ..own });
    }
    // Flux 1 of a law that ends there: a part may as well slip.
    let unit = PlaneCircle { centre: [0.0; 2], radius: 1.0 };
    let parts = vec![
        PlaneSide::arc(unit, [0.0, PI], Fixed, 0),
        PlaneSide::arc(unit, [PI, 2.0 * PI], Contact, 1),
    ];
    let arcs = RingContact { arcs: vec![[4.0, 5.5]], gaps: vec![1.0] };
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
        disc(Contact),
        odd,
        vec![sticks()],
        -PI / 4.0 - 0.5 * HALF_DISC,
    );
    all.push(KnownEnergy { is_hard: true, ..own });
    let slipping = Radial::slipping(1.0, 0.0).energy(0.0);
    all.push(known(
        "gap round a fixed hole",
        ring(Contact, Fixed),
        one("else=1"),
        vec![slips(0.0), sticks()],
        slipping,
    ));
    let slipping = Radial::slipping(3.0, -0.4).energy(-0.4);
    let rubbing = (friction(0.4), pieces("else=3"));
    all.push(known(
        "ring that slips up",
        ring(Contact, Fixed),
        rubbing,
        vec![slips(-0.4), sticks()],
        slipping,
    ));
    let slipping = Radial::slipping(-3.0, 0.3).energy(0.3);
    let limited = (limit(0.3), pieces("else=-3"));
    all.push(known(
        "ring that slips down",
        ring(Contact, Fixed),
        limited,
        vec![slips(0.3), sticks()],
        slipping,
    ));
    let free = Radial::insulated(-2.0).energy(0.0);
    all.push(known(
        "free hole",
        ring(Contact, Free),
        one("else=-2"),
        vec![sticks(), sticks()],
        free,
    ));
    all.push(known(
        "gap round a hole",
        ring(Fixed, Contact),
        one("else=2"),
        vec![sticks(), slips(0.0)],
        free,
    ));
    let held = Radial::held(-2.0).energy(0.0);
    all.push(known(
        "ring in contact",
        ring(Contact, Contact),
        one("else=-2"),
        vec![sticks(), sticks()],
        held,
    ));
    for (name, angle, condition) in
        [("sector of 60 degrees", PI / 3.0, Contact), ("three quarters of a disc", 1.5 * PI, Fixed)]
    {
        let energy = -angle / 32.0;
        all.push(known(
            name,
            vec![sector(angle, condition)],
            one("else=-1"),
            vec![sticks()],
            energy,
        ));
    }
    let half = vec![sector(PI, Contact)];
    let half: Vec<Vec<PlaneSide>> = half
        .into_iter()
        .map(|sides| {
            sides.into_iter().map(|side| PlaneSide { condition: Contact, ..side }).collect()
        })
        .collect();
    let own = known("half disc", half, one("else=-2"), vec![sticks()], -HALF_DISC);
    all.push(KnownEnergy { is_hard: true, ..own });
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.75_f64.sqrt()]];
    let torsion = -3f64.sqrt() / 640.0;
    all.push(known(
        "triangle",
        vec![polygon(&triangle, &[Contact; 3])],
        one("else=-1"),
        vec![sticks()],
        torsion,
    ));
    let half = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.75_f64.sqrt()]];
    let half = vec![polygon(&half, &[Contact, Free, Contact])];
    all.push(known("half triangle", half, one("else=-1"), vec![sticks()], 0.5 * torsion));
    // v = -(1 - x^2) (1 - y^2).
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let square = vec![polygon(&square, &[Contact; 4])];
    let f = |[x, y]: [f64; 2]| -2.0 * (2.0 - x * x - y * y);
    let polynomial = Polynomial::fitted(f, &PlaneDomain::new(square.clone()).unwrap());
    let source = (papers, PlaneSource::Polynomial(polynomial));
    all.push(known("square", square, source, vec![sticks()], -128.0 / 45.0));
    let bar = [[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [0.0, 1.0]];
    let open = vec![polygon(&bar, &[Fixed, Contact, Contact, Contact])];
    all.push(known("bar with gaps", open, one("else=1"), vec![slips(0.0)], -0.25));
    let rubbing = vec![polygon(&bar, &[Fixed, Free, Contact, Free])];
    // v = 3/4 y - y^2 / 2, 1/4 at the top.
    let energy = 1.5 * (-0.5 * (0.375 - 1.0 / 6.0) + 0.125 * 0.25);
    all.push(known(
        "bar that slips up",
        rubbing.clone(),
        (friction(0.25), pieces("else=1")),
        vec![slips(-0.25)],
        energy,
    ));
    all.push(known(
        "bar that slips down",
        rubbing,
        (limit(0.25), pieces("else=-1")),
        vec![slips(0.25)],
        energy,
    ));
    all
}

/// One of them, solved.
pub(in crate::spectral::plane::proof) fn solved(name: &str) -> SolvedKnown {
    all_known().into_iter().find(|own| own.name == name).expect("its name is known").solved()
}
