//! The way from a start to a checked solution: Newton's method on the ends on a coarse level, signs, finer levels.

use super::newton::{remove, settle};
use super::signs::PlaneSigns;
use super::start::PlaneStart;
use crate::spectral::error::PlaneError;
use crate::spectral::fit::field::{PlaneNode, Sizes, boundary_nodes, share};
use crate::spectral::fit::{Effort, Fit};
use crate::spectral::geometry::ring::{PlaneRing, RingContact};
use crate::spectral::setup::{Level, Setup};

/// Solution of one level with what is known of it.
pub(crate) struct PlaneFound {
    pub contact: Vec<RingContact>,
    pub fit: Fit,
    pub nodes: Vec<PlaneNode>,
    pub sizes: Sizes,
    pub signs: PlaneSigns,
    pub steps: usize,
    /// Level on which it was found.
    level: Level,
}

/// Fits on a level after which no correction is tried.
const STEPS: usize = 30;
/// Corrections of the contact set on a level.
const CORRECTIONS: usize = 8;
/// Points of a panel for signs alone, and for integrals.
const POINTS: [usize; 2] = [8, 16];

impl PlaneFound {
    /// Finds the contact set on a level, with so many points of a panel for signs and integrals: a fit whose signs are
    /// all right.
    fn on(
        setup: &Setup,
        contact: &mut Vec<RingContact>,
        level: Level,
        effort: &mut Effort,
        points: usize,
    ) -> Result<Self, PlaneError> {
        let most = effort.steps + STEPS;
        let mut tried: Vec<Vec<RingContact>> = Vec::new();
        for _ in 0..CORRECTIONS {
            if effort.steps > most {
                break;
            }
            let fit = settle(setup, contact, &level, effort).ok_or_else(|| {
                let text = "the ends of the arcs that stick were not found: Newton's method did not settle";
                PlaneError::NotFound(text.into())
            })?;
            if tried.iter().any(|before| is_near(before, contact, setup.perimeter)) {
                break;
            }
            tried.push(contact.clone());
            let nodes = boundary_nodes(setup, &fit, &level, points);
            let sizes = Sizes::new(setup, &nodes);
            let signs =
                PlaneSigns::new(setup, contact, &nodes, sizes, 2.0 * level.noise * setup.perimeter);
            if let Some(mended) = signs.mended {
                *contact = mended;
                continue;
            }
            let (contact, steps) = (contact.clone(), effort.steps);
            return Ok(Self { contact, fit, nodes, sizes, signs, steps, level });
        }
        Err(PlaneError::NotFound("no contact set with all signs right was found".into()))
    }

    /// Solution of the finest level from this one's contact set, unless this is it; none if that is not found there.
    pub(crate) fn refined(&self, setup: &Setup) -> Option<Self> {
        let [.., finest] = Level::FINE;
        if self.level.degree == finest.degree {
            return None;
        }
        let mut contact = self.contact.clone();
        let found =
            Self::on(setup, &mut contact, finest, &mut Effort::default(), POINTS[1]).ok()?;
        let steps = self.steps + found.steps;
        (found.errors() < ACCEPTED).then_some(Self { steps, ..found })
    }

    /// Largest residual, over the size of v, and the flux that f does not balance, over all of it.
    fn errors(&self) -> f64 {
        let Sizes { residual, value, .. } = self.sizes;
        share(residual, value).max(0.1 * self.sizes.unbalanced(self.sizes.balance))
    }

    /// Refusal by a residual, or by the flux that f does not balance.
    fn refused(&self, balance: f64) -> PlaneError {
        PlaneError::NotFound(format!(
            "a check failed: v is off its value where it sticks by {:.1e} of v, and dv/dn balances f but for {:.1e} of \
             it",
            share(self.sizes.residual, self.sizes.value),
            self.sizes.unbalanced(balance)
        ))
    }

    /// Checks that dv/dn balances f, whose integral is by f itself.
    ///
    /// # Errors
    /// [`PlaneError`].
    pub(crate) fn check_balance(&self, balance: f64) -> Result<(), PlaneError> {
        let is_small = 0.1 * self.sizes.unbalanced(balance) < ACCEPTED;
        if is_small { Ok(()) } else { Err(self.refused(balance)) }
    }
}

/// True if all ends of two contact sets are next to each other.
fn is_near(one: &[RingContact], other: &[RingContact], perimeter: f64) -> bool {
    /// Distance, in perimeters.
    const NEAR: f64 = 1e-6;
    one.iter().zip(other).all(|(one, other)| {
        let ends = one.arcs.iter().flatten().zip(other.arcs.iter().flatten());
        one.gaps == other.gaps
            && one.arcs.len() == other.arcs.len()
            && ends.into_iter().all(|(a, b)| (a - b).abs() < NEAR * perimeter)
    })
}

/// Solves a problem from a contact set.
pub(crate) fn search(
    setup: &Setup,
    start: &PlaneStart,
    effort: &mut Effort,
) -> Result<PlaneFound, PlaneError> {
    let mut contact = started(setup, start);
    let first = contact.clone();
    if PlaneFound::on(setup, &mut contact, Level::COARSE, effort, POINTS[0]).is_err() {
        // What is not found on a coarse level may be on a fine one.
        contact = first;
    }
    let (mut best, mut refusal) = (None, None);
    for level in Level::FINE {
        match PlaneFound::on(setup, &mut contact, level, effort, POINTS[1]) {
            Ok(found) => {
                let better =
                    best.as_ref().is_none_or(|best: &PlaneFound| found.errors() < best.errors());
                if better {
                    best = Some(found);
                }
            }
            Err(error) => refusal = Some(error),
        }
        if best.as_ref().is_some_and(|best| best.errors() < level.enough) {
            break;
        }
    }
    match best {
        Some(best) if best.errors() < ACCEPTED => Ok(best),
        Some(best) => Err(best.refused(best.sizes.balance)),
        None => Err(refusal.expect("a level was tried")),
    }
}

/// Errors with which a solution is refused.
const ACCEPTED: f64 = 2e-8;

/// Contact set of a start, without arcs and gaps of one or two edges of its mesh.
fn started(setup: &Setup, start: &PlaneStart) -> Vec<RingContact> {
    let mut contact = start.contact.clone();
    for (own, ring) in contact.iter_mut().zip(&setup.domain.rings) {
        while let Some((number, is_gap)) = short(own, ring, 1.5 * start.spacing) {
            remove(own, number, is_gap, ring.length());
        }
    }
    contact
}

/// An arc that is too short and can be left out, or a gap; where elements see the flux least well, at a corner, gaps up
/// to three times as long.
fn short(ring: &RingContact, sides: &PlaneRing, least: f64) -> Option<(usize, bool)> {
    let (many, turn) = (ring.arcs.len(), sides.length());
    (0..many).find_map(|k| {
        let [from, to] = ring.arcs[k];
        let between = ring.gaps[(k + many - 1) % many] != ring.gaps[k];
        let gap = (ring.arcs[(k + 1) % many][0] - to).rem_euclid(turn);
        let mut corners = sides.starts[1..].iter();
        let has_corner = sides.sides.len() > 1 && corners.any(|t| (t - to).rem_euclid(turn) < gap);
        let least_gap = if has_corner { 3.0 * least } else { least };
        match () {
            () if to - from < least && !between && many > 1 => Some((k, false)),
            () if gap < least_gap && gap < to - from => Some((k, true)),
            () => None,
        }
    })
}

#[cfg(test)]
impl PlaneFound {
    /// Solution with a fit that is known.
    pub(crate) fn known(setup: &Setup, contact: &[RingContact], fit: Fit) -> Self {
        let level = Level::FINE[2];
        let nodes = boundary_nodes(setup, &fit, &level, POINTS[1]);
        let sizes = Sizes::new(setup, &nodes);
        let signs = PlaneSigns { flux: 0.0, value: 0.0, mended: None };
        Self { contact: contact.to_vec(), fit, nodes, sizes, signs, steps: 0, level }
    }
}
