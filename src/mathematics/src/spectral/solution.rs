//! True solution: solved and bounded on one connected domain of the plane, evaluated at points of all.

use super::contact::ends::arcs;
use super::contact::search::{self, PlaneFound};
use super::contact::start::PlaneStart;
use super::fit::Effort;
use super::fit::field::share;
use super::geometry::boundary::State;
use super::geometry::panels::Spot;
use super::geometry::side::PlaneSide;
use super::problem::PlaneProblem;
use super::proof;
use super::setup::Setup;
use crate::discrete::contact::ContactArc;
use crate::problem::complex::Complex;
use crate::problem::law::BoundaryState;
use crate::problem::text::{percent, plain};
use crate::spectral::error::PlaneError;
use std::collections::BTreeMap;
use std::fmt;

/// Distance of the bounds, over the energy, from which on they are wide.
const WIDE: f64 = 1e-6;
/// Distance from a corner, over the length of the side, at which derivatives are taken for it.
const BESIDE: f64 = 1e-6;

/// Conditions that must hold of a solution and were not used to find it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PlaneChecks {
    /// Largest distance of v from the value that it should have, between the rows, over the size of v and psi.
    pub residual: f64,
    /// Integral of dv/dn plus that of f, over the integral of |f|.
    pub balance: f64,
    /// Least room of the flux in the law where v sticks, over the mean of |dv/dn|.
    pub flux: f64,
    /// Least v less the value of the law, of the right sign, on the gaps, over the size of v and psi.
    pub sign: f64,
    /// Distance of the bounds over the energy; none without bounds.
    pub bracket: Option<f64>,
}

/// True solution.
pub struct TrueSolution {
    /// J(v).
    pub energy: f64,
    /// Guaranteed bounds of the energy, or the step of their proof that does not apply.
    pub bracket: Result<[f64; 2], &'static str>,
    /// Lower bound of the L2 norm of grad u; none without bounds, or where it follows from them since no law has a
    /// value.
    pub gradient: Option<f64>,
    /// Arcs in contact, each with the domain on the left.
    pub contact: Vec<ContactArc>,
    /// Integral of dv/dn over the boundary where v may stick and slip.
    pub force: f64,
    /// Integrals of dv/dn over the parts of the boundary, by their names.
    pub(crate) forces: BTreeMap<String, f64>,
    /// Integral of f over the domain.
    pub integral: f64,
    /// Size of the integral of dv/dn over the whole boundary plus that of f, which is zero but for errors.
    pub unbalanced: f64,
    /// Number of real unknowns of the sum of functions.
    pub unknowns: usize,
    /// Number of Newton steps.
    pub steps: usize,
    /// Checks.
    pub checks: PlaneChecks,
    /// Remarks on f, and on bounds that are wide.
    pub notes: Vec<String>,
    /// Solution on each connected component.
    pub(super) components: Vec<PlaneSolution>,
}

/// Solution on a connected domain, evaluated at points of the plane.
pub(super) struct PlaneSolution {
    setup: Setup,
    found: PlaneFound,
}

impl TrueSolution {
    /// Solution on the components of this one and those of another.
    pub(super) fn with(self, other: Self) -> Self {
        let both = self.bracket.and_then(|own| Ok((own, other.bracket?)));
        let gradient = match [&self, &other].map(|own| own.gradient) {
            [None, None] => None,
            _ => Some(libm::hypot(self.least_gradient(), other.least_gradient())),
        };
        let mut notes = [self.notes, other.notes].concat();
        notes.dedup();
        let mut forces = self.forces;
        for (part, force) in other.forces {
            *forces.entry(part).or_default() += force;
        }
        Self {
            energy: self.energy + other.energy,
            bracket: both.map(|([low, high], [lower, upper])| [low + lower, high + upper]),
            gradient,
            contact: [self.contact, other.contact].concat(),
            force: self.force + other.force,
            forces,
            integral: self.integral + other.integral,
            unbalanced: self.unbalanced + other.unbalanced,
            unknowns: self.unknowns + other.unknowns,
            steps: self.steps + other.steps,
            checks: self.checks.worst(other.checks),
            notes,
            components: self.components.into_iter().chain(other.components).collect(),
        }
    }

    /// Lower bound of the L2 norm of grad u, with or without values of laws.
    fn least_gradient(&self) -> f64 {
        let of_energy = self.bracket.map_or(0.0, |[_, high]| (-2.0 * high).max(0.0).sqrt());
        self.gradient.unwrap_or(of_energy)
    }

    /// Solution on the component that holds a point, or is nearest to it.
    fn nearest(&self, point: [f64; 2]) -> &PlaneSolution {
        let components = self.components.iter();
        let nearest = components.min_by(|a, b| a.distance(point).total_cmp(&b.distance(point)));
        nearest.expect("a mesh has a component")
    }

    /// v at points of the domain and its boundary.
    pub fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        match &self.components[..] {
            [own] => own.values(points),
            _ => points.iter().map(|&z| self.nearest(z).values(&[z])[0]).collect(),
        }
    }

    /// v and its gradient at a point; none outside of the domain. In a corner, where the gradient may be infinite, that
    /// a little beside it.
    pub fn at(&self, point: &[f64]) -> Option<(f64, [f64; 2])> {
        let &[x, y] = point else { return None };
        self.components.iter().find_map(|own| own.at([x, y]))
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn in a corner is that on one of its sides.
    pub fn on_boundary(&self, point: [f64; 2]) -> [f64; 2] {
        self.nearest(point).on_boundary(point)
    }
}

impl PlaneChecks {
    /// The worse of each of two checks.
    pub(super) fn worst(self, other: Self) -> Self {
        let is_less = self.balance.abs() < other.balance.abs();
        Self {
            residual: self.residual.max(other.residual),
            balance: if is_less { other.balance } else { self.balance },
            flux: self.flux.min(other.flux),
            sign: self.sign.min(other.sign),
            bracket: self.bracket.zip(other.bracket).map(|(own, other)| own.max(other)),
        }
    }
}

impl fmt::Display for PlaneChecks {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { residual, balance, flux, sign, bracket } = self;
        // Both are relative: what is as small is a rounding error.
        let [flux, sign] = [*flux, *sign]
            .map(|least| plain(if least.abs() < f64::EPSILON { 0.0 } else { least }, 2));
        write!(
            out,
            "v off its value where it sticks {residual:.1e}, balance {balance:.1e}, least room of the flux {flux}, \
             least v beyond it {sign}"
        )?;
        bracket.map_or(Ok(()), |bracket| write!(out, ", bounds apart by {bracket:.1e}"))
    }
}

/// Solves a problem from a contact set, with the effort that all starts share; on the finest level, if the bounds of
/// the energy are then nearer to each other and without it nine digits of it are not certain.
///
/// # Errors
/// [`PlaneError`], with a sentence for the user.
pub(super) fn solve(
    problem: &PlaneProblem,
    start: &PlaneStart,
    effort: &mut Effort,
) -> Result<TrueSolution, PlaneError> {
    /// Distance of bounds over the energy.
    const NINE_DIGITS: f64 = 1e-9;
    let setup = Setup::new(problem)?;
    let mut found = search::search(&setup, start, effort)?;
    let mut bracket = proof::bracket(&setup, &found);
    if let Ok(wide) = bracket
        && wide.relative() > NINE_DIGITS
        && let Some(refined) = found.refined(&setup)
        && let Ok(own) = proof::bracket(&setup, &refined)
        && own.upper - own.lower < wide.upper - wide.lower
    {
        (found, bracket) = (refined, Ok(own));
    }
    // f along its jumps against the flux, which the bracket has compared already.
    let energy = match bracket {
        Ok(own) => own.energy,
        Err(_) => {
            let [energy, balance] = proof::unproved(&setup, &found.fit, &found.nodes);
            found.check_balance(balance)?;
            energy
        }
    };
    let is_above = energy > 0.0 || bracket.is_ok_and(|own| own.lower > 0.0);
    if is_above && !setup.domain.has_values() {
        return Err(PlaneError::NotFound(
            "the energy came out above zero, that of v = 0: rounding errors exceed it".into(),
        ));
    }
    if bracket == Err(proof::ROUNDED) {
        return Err(PlaneError::NotFound(
            "rounding errors exceed a millionth of the energy, and no bracket of it is proved"
                .into(),
        ));
    }
    let PlaneFound { sizes, signs, fit, nodes, steps, .. } = &found;
    let size = sizes.force.abs().max(sizes.flux * setup.perimeter);
    let checks = PlaneChecks {
        residual: share(sizes.residual, sizes.value),
        balance: share(sizes.balance, size),
        flux: signs.flux,
        sign: signs.value,
        bracket: bracket.ok().map(|bracket| bracket.relative()),
    };
    let mut notes = Vec::new();
    if let Ok(own) = bracket
        && own.relative() > WIDE
        && own.size != 0.0
    {
        let (share, cause) = (percent(own.relative(), 2), own.cause);
        notes.push(format!("the bounds of the energy are {share} of it apart: mostly {cause}"));
    }
    let lawful = nodes.iter().filter(|node| node.law.may_move());
    let force: f64 = lawful.map(|node| node.spot.weight * node.flux).sum();
    let unit = setup.domain.frame.of_value();
    let mut forces: BTreeMap<String, f64> = BTreeMap::new();
    for node in nodes {
        let part = setup.domain.side(&fit.walk.intervals[node.spot.interval]).part;
        if let Some(names) = setup.domain.parts.get(part) {
            *forces.entry(names.to_string()).or_default() += unit * node.spot.weight * node.flux;
        }
    }
    Ok(TrueSolution {
        energy: unit * unit * energy,
        bracket: bracket.map(|own| own.ends().map(|end| unit * unit * end)),
        gradient: bracket.ok().and_then(|own| Some(unit * own.gradient?)),
        contact: arcs(&setup, &found),
        force: unit * force,
        forces,
        integral: unit * (sizes.balance - sizes.force),
        unbalanced: unit * sizes.balance.abs(),
        unknowns: fit.unknowns,
        steps: *steps,
        checks,
        notes,
        components: vec![PlaneSolution { setup, found }],
    })
}

impl PlaneSolution {
    fn seen(&self, point: [f64; 2]) -> Complex {
        self.setup.domain.frame.seen(point)
    }

    /// Distance of a point from the domain, in the coordinates of its frame.
    pub(super) fn distance(&self, point: [f64; 2]) -> f64 {
        let (domain, z) = (&self.setup.domain, self.seen(point));
        domain.frame.unit * if domain.holds(z) { 0.0 } else { domain.distance(z) }
    }

    /// v at points of the closed domain.
    pub(super) fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let spots: Vec<Spot> = points.iter().map(|&z| Spot::inside(self.seen(z))).collect();
        let [g, _] = self.found.fit.at(&spots, false);
        let (psi, unit) = (&self.setup.jumps.psi, self.setup.domain.frame.of_value());
        spots.iter().zip(g).map(|(spot, g)| unit * (psi.value(spot.z) + g.re)).collect()
    }

    /// Gradient at a point of the closed domain but a corner, in the coordinates of the frame.
    fn gradient(&self, z: Complex) -> Complex {
        let [_, slopes] = self.found.fit.at(&[Spot::inside(z)], true);
        self.setup.jumps.psi.gradients(&[z])[0] + slopes[0].conj()
    }

    /// v and its gradient at a point of the closed domain; in a corner, where the gradient may be infinite, that a
    /// little beside it; none outside of the domain.
    pub(super) fn at(&self, point: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let (domain, mut z) = (&self.setup.domain, self.seen(point));
        let size = libm::hypot(point[0], point[1]) / domain.frame.unit;
        // Coordinates of points of the boundary are rounded.
        let value = match domain.distance(z) {
            away if away <= 8.0 * f64::EPSILON * (domain.diameter() + size) => {
                let (ring, place) = domain.nearest(z);
                let side = &domain.rings[ring].sides[place.side];
                z = side.point(beside_corners(side, place.s));
                self.on_boundary(point)[0]
            }
            _ if domain.holds(z) => self.values(&[point])[0],
            _ => return None,
        };
        let gradient = self.gradient(z).scaled(domain.frame.of_flux());
        Some((value, gradient.coordinates()))
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn, which may be infinite in a corner, a little
    /// beside it.
    pub(super) fn on_boundary(&self, point: [f64; 2]) -> [f64; 2] {
        let domain = &self.setup.domain;
        let (ring, place) = domain.nearest(self.seen(point));
        let own = &domain.rings[ring];
        let value = self.values(&[point])[0] / domain.frame.of_value();
        let s = beside_corners(&own.sides[place.side], place.s);
        let outwards = -own.sides[place.side].tangent(s).turned();
        let flux = self.gradient(own.sides[place.side].point(s)).dot(outwards);
        // On one of both sides of each condition the number is known without error.
        let (side, contact) = (&own.sides[place.side], &self.found.contact[ring]);
        let (law, (at, _)) = (side.law, domain.value(side, side.point(place.s)));
        let slips = if value < at { BoundaryState::SlipsDown } else { BoundaryState::SlipsUp };
        let state = match contact.state(own.along(place), own.length()) {
            _ if law.is_free() => slips,
            BoundaryState::Sticks => BoundaryState::Sticks,
            _ if law.is_fixed() => BoundaryState::Sticks,
            _ => slips,
        };
        let [value, flux] = match State::under(law, state) {
            State::Held => [at, law.project(flux)],
            State::Flux(q) => [value, q],
        };
        [domain.frame.of_value() * value, domain.frame.of_flux() * flux]
    }
}

/// Distance along a side, no nearer to its ends than a small part of it.
fn beside_corners(side: &PlaneSide, s: f64) -> f64 {
    let length = side.length();
    s.clamp(BESIDE * length, (1.0 - BESIDE) * length)
}

#[cfg(test)]
pub(super) mod tests;
