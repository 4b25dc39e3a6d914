//! True solution on one connected domain of the plane: solved, bounded, and evaluated at points.

use super::contact::ends::{PlaneArc, arcs};
use super::contact::search::{self, PlaneFound};
use super::fit::Effort;
use super::fit::field::{self, share};
use super::geometry::domain::{PlaneError, SidePlace};
use super::geometry::panels::Spot;

use super::problem::{Frame, PlaneProblem, PlaneStart};
use super::proof::{self, PlaneBracket};
use super::setup::Setup;
use crate::problem::text::plain;
use std::fmt;

/// Conditions that must hold of a solution and were not used to find it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PlaneChecks {
    /// Largest |v| where v = 0, between the rows, over the size of v and psi.
    pub residual: f64,
    /// Integral of dv/dn plus that of f, over the integral of |f|.
    pub balance: f64,
    /// Least room of the flux in the law where it holds, over the mean of |dv/dn|.
    pub flux: f64,
    /// Least v of the right sign on the gaps, over the size of v and psi.
    pub sign: f64,
    /// Distance of the bounds over the energy; none without bounds.
    pub bracket: Option<f64>,
}

/// True solution.
pub(crate) struct PlaneSolution {
    /// J(v).
    pub energy: f64,
    /// Bounds of the energy, or the step of their proof that does not apply.
    pub bracket: Result<PlaneBracket, &'static str>,
    /// Arcs that stick, loop by loop in walking order.
    pub arcs: Vec<PlaneArc>,
    /// Integral of dv/dn over the parts where the law holds.
    pub force: f64,
    /// Integral of f over the domain.
    pub integral: f64,
    /// Size of the integral of dv/dn over the boundary plus that of f.
    pub unbalanced: f64,
    /// Checks.
    pub checks: PlaneChecks,
    /// Real unknowns of the last fit.
    pub unknowns: usize,
    /// Fits on all levels.
    pub steps: usize,
    frame: Frame,
    setup: Setup,
    found: PlaneFound,
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
            "v where it is zero {residual:.1e}, balance {balance:.1e}, least room of the flux {flux}, least v {sign}"
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
) -> Result<PlaneSolution, PlaneError> {
    /// Distance of bounds over the energy.
    const NINE_DIGITS: f64 = 1e-9;
    let frame = Frame::of(&problem.domain);
    let setup = Setup::new(&frame.problem(problem))?;
    let mut found = search::search(&setup, &frame.start(start), effort)?;
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
    if energy > 0.0 || bracket.is_ok_and(|own| own.lower > 0.0) {
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
    let PlaneFound { sizes, signs, fit, nodes, .. } = &found;
    let size = sizes.force.abs().max(sizes.flux * setup.perimeter);
    let checks = PlaneChecks {
        residual: share(sizes.residual, sizes.value),
        balance: share(sizes.balance, size),
        flux: signs.flux,
        sign: signs.value,
        bracket: bracket.ok().map(|bracket| bracket.relative()),
    };
    let square = frame.unit * frame.unit;
    let force: f64 =
        nodes.iter().filter(|node| node.lawful).map(|node| node.spot.weight * node.flux).sum();
    Ok(PlaneSolution {
        energy: square * square * energy,
        bracket: bracket.map(|own| own.scaled(square * square)),
        arcs: arcs(&problem.domain, frame, &setup, &found),
        force: square * force,
        integral: square * (sizes.balance - sizes.force),
        unbalanced: square * sizes.balance.abs(),
        checks,
        unknowns: fit.unknowns,
        steps: found.steps,
        frame,
        setup,
        found,
    })
}

impl PlaneSolution {
    /// Its numbers for another unit of f, of dv/dn and of v; values at points stay in that of the problem.
    pub(super) fn in_unit(self, height: f64) -> Self {
        Self {
            energy: height * height * self.energy,
            bracket: self.bracket.map(|own| own.scaled(height * height)),
            force: height * self.force,
            integral: height * self.integral,
            unbalanced: height * self.unbalanced,
            ..self
        }
    }

    /// v at a point of the closed domain.
    pub(crate) fn value(&self, point: [f64; 2]) -> f64 {
        self.values(&[point])[0]
    }

    /// v at many points.
    pub(crate) fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let spots: Vec<Spot> =
            points.iter().map(|&point| Spot::inside(self.frame.seen(point))).collect();
        let [g, _] = self.found.fit.at(&spots, false);
        let square = self.frame.unit * self.frame.unit;
        let psi = &self.setup.jumps.psi;
        spots.iter().zip(g).map(|(spot, g)| square * (psi.value(spot.z) + g.re)).collect()
    }

    /// Gradient of v at a point of the domain.
    pub(crate) fn gradient(&self, point: [f64; 2]) -> [f64; 2] {
        let spots = [Spot::inside(self.frame.seen(point))];
        let [_, slopes] = self.found.fit.at(&spots, true);
        let psi = self.setup.jumps.psi.gradients(&[spots[0].z])[0];
        (psi + slopes[0].conj()).scaled(self.frame.unit).coordinates()
    }

    /// v and dv/dn at a point of the boundary.
    pub(crate) fn on_boundary(&self, ring: usize, place: SidePlace) -> [f64; 2] {
        let (walk, place) = (&self.found.fit.walk, self.frame.place(place));
        let mut nearest = (f64::INFINITY, 0);
        for (k, own) in walk.intervals.iter().enumerate() {
            if own.ring == ring && own.side == place.side {
                let after = place.s - own.from;
                let beyond = (-after).max(after - own.length);
                if beyond < nearest.0 {
                    nearest = (beyond, k);
                }
            }
        }
        let own = &walk.intervals[nearest.1];
        let after = (place.s - own.from).clamp(0.0, own.length);
        let spot = match after < 0.5 * own.length {
            true => walk.spot(nearest.1, 0, after, 0.0),
            false => walk.spot(nearest.1, 1, own.length - after, 0.0),
        };
        let node = &field::nodes_at(&self.setup, &self.found.fit, &[spot])[0];
        [self.frame.unit * self.frame.unit * node.value, self.frame.unit * node.flux]
    }
}

#[cfg(test)]
pub(super) mod tests;
