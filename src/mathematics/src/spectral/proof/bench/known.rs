//! Problems whose energy is known in closed form, with fits of one contact set.

use crate::mesh::Round;
use crate::problem::law::{BoundaryState, Law};
use crate::spectral::contact::search::PlaneFound;
use crate::spectral::fit::Fit;
use crate::spectral::geometry::domain::PlaneDomain;
pub(crate) use crate::spectral::geometry::polygons::{circle, loop_of as polygon};
use crate::spectral::geometry::ring::RingContact;
use crate::spectral::geometry::side::PlaneSide;
use crate::spectral::problem::PlaneProblem;
use crate::spectral::setup::{Level, Setup};
use crate::spectral::source::{PlaneSource, Regions};
use std::f64::consts::{LN_2, PI};

/// Problem with a contact set and the energy of its solution.
pub(crate) struct BenchProblem {
    pub name: &'static str,
    pub problem: PlaneProblem,
    pub contact: Vec<RingContact>,
    pub energy: f64,
    /// True if its solution is no polynomial.
    pub is_hard: bool,
}

/// Data of a solved problem with its solution.
pub(crate) struct SolvedKnown {
    pub name: &'static str,
    pub setup: Setup,
    pub found: PlaneFound,
    pub energy: f64,
}

impl BenchProblem {
    /// All conditions on a level.
    pub(crate) fn solved(self) -> SolvedKnown {
        let level = if self.is_hard { &Level::FINE[1] } else { &Level::COARSE };
        let setup = Setup::new(&self.problem).unwrap();
        let fit = Fit::new(&setup, &self.contact, level);
        let found = PlaneFound::known(&setup, &self.contact, fit);
        SolvedKnown { name: self.name, setup, found, energy: self.energy }
    }
}

/// Loop on which all sticks.
pub(crate) fn sticks() -> RingContact {
    RingContact::default()
}

/// Loop on which nothing sticks.
pub(crate) fn slips(gap: BoundaryState) -> RingContact {
    RingContact { arcs: Vec::new(), gaps: vec![gap] }
}

/// f constant on pieces.
pub(crate) fn pieces(f: &str) -> PlaneSource {
    PlaneSource::Pieces(Regions::all(f.parse().unwrap()))
}

/// Sector of the unit disc, with free straight sides.
pub(super) fn sector(angle: f64, arc: Law) -> Vec<PlaneSide> {
    let end = [libm::cos(angle), libm::sin(angle)];
    let unit = Round::sphere([0.0; 2], 1.0);
    vec![
        PlaneSide::segment([[0.0; 2], [1.0, 0.0]], Law::FREE, 0),
        PlaneSide::arc(unit, [0.0, angle], arc, 1),
        PlaneSide::segment([end, [0.0; 2]], Law::FREE, 2),
    ]
}

/// Problem with the energy of its solution, and a law for all sides in contact.
pub(super) fn known(
    name: &'static str,
    loops: Vec<Vec<PlaneSide>>,
    (law, source): (Law, PlaneSource),
    contact: Vec<RingContact>,
    energy: f64,
) -> BenchProblem {
    let domain = PlaneDomain::new(loops).unwrap().with_law(law);
    let problem = PlaneProblem { domain, source };
    BenchProblem { name, problem, contact, energy, is_hard: false }
}

/// The solution `a + b log r - f r^2 / 4` on the ring between the radii 1/2 and 1.
pub(super) struct Radial {
    f: f64,
    a: f64,
    b: f64,
}

impl Radial {
    /// With these values on the inner and the outer circle.
    pub(super) fn between(f: f64, [inner, outer]: [f64; 2]) -> Self {
        let a = outer + 0.25 * f;
        Self { f, a, b: (a - f / 16.0 - inner) / LN_2 }
    }

    /// With a value on the inner circle, and a flux on the outer one.
    pub(super) fn rising(f: f64, value: f64, flux: f64) -> Self {
        let b = flux + 0.5 * f;
        Self { f, a: value + f / 16.0 + b * LN_2, b }
    }

    /// With a flux on the inner circle, and a value on the outer one.
    pub(super) fn falling(f: f64, flux: f64, value: f64) -> Self {
        Self { f, a: value + 0.25 * f, b: f / 8.0 - 0.5 * flux }
    }

    /// v and dv/dr at a radius.
    pub(super) fn at(&self, r: f64) -> [f64; 2] {
        let &Self { f, a, b } = self;
        [a + b * libm::log(r) - 0.25 * f * r * r, b / r - 0.5 * f * r]
    }

    /// Energy without the terms of the laws.
    pub(super) fn inner_energy(&self) -> f64 {
        let [[inner, rate], [outer, slope]] = [0.5, 1.0].map(|r| self.at(r));
        PI * (outer * slope - 0.5 * inner * rate) - PI * self.f * self.mean()
    }

    /// Integral of v over the area, over a turn.
    fn mean(&self) -> f64 {
        self.a * 0.375 + self.b * (LN_2 / 8.0 - 3.0 / 16.0) - self.f * 15.0 / 256.0
    }
}

/// `int u` for `-Lap u = 1` and u = 0 on the boundary of the half disc of radius 1, twice: St. Venant.
pub(super) const HALF_DISC: f64 = PI / 4.0 - 2.0 / PI;

/// Energy of the unit disc, all of whose boundary sticks, with f = b but for a disc of radius e at a distance p from
/// the middle, where it is larger by the weight w over its area: Newton's theorem and Green's function.
pub(super) fn with_disc(b: f64, [w, e, p]: [f64; 3]) -> f64 {
    let own = w * w / (2.0 * PI) * (libm::log((1.0 - p * p) / e) + 0.25);
    let both = 0.5 * w * b * (1.0 - p * p - 0.5 * e * e);
    -0.5 * (own + both + b * b * PI / 8.0)
}
