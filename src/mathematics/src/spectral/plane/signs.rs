//! PlaneSigns on the boundary, and the contact set without those that are wrong.

use super::boundary::{RingContact, State};
use super::field::{PlaneNode, Sizes};
use super::setup::Setup;

/// Largest violations over what is tolerated, and the contact set with them mended, if any.
pub(super) struct PlaneSigns {
    /// Least room of the flux in the law, over its size; violations next to a split count less.
    pub flux: f64,
    /// Least v of the right sign where it is not zero, over its size.
    pub value: f64,
    pub mended: Option<Vec<RingContact>>,
}

/// State in which a node is found.
#[derive(Clone, Copy, PartialEq)]
enum PlaneVerdict {
    Right,
    /// Should be free with this flux.
    Slips(f64),
    /// Should stick.
    Sticks,
    /// Too near to a corner to be judged.
    Unknown,
}

/// Violations of the flux, over its size, that are tolerated.
const FLUX: f64 = 1e-6;
/// Violations of v, over its size, that are tolerated.
const VALUE: f64 = 1e-10;
/// Residuals that a violation may have.
const RESIDUALS: f64 = 30.0;
/// Distance from a split, in perimeters, below which violations of the flux count less.
const NEAR: f64 = 1e-4;

impl PlaneSigns {
    pub(super) fn new(
        setup: &Setup,
        contact: &[RingContact],
        nodes: &[PlaneNode],
        sizes: Sizes,
        unsure: f64,
    ) -> Self {
        let (mut flux, mut value) = (0.0f64, 0.0f64);
        let mut verdicts = Vec::with_capacity(nodes.len());
        let law = setup.law;
        for node in nodes {
            let distance = node.spot.offset;
            let verdict = match node.state {
                _ if !node.lawful || node.by_end && distance < unsure => PlaneVerdict::Right,
                State::Held => {
                    let share = (distance / (NEAR * setup.perimeter)).min(1.0);
                    let [above_lo, below_hi] = law.room(node.flux);
                    let room = above_lo.min(below_hi) * share;
                    flux = flux.min(room / sizes.flux);
                    let tolerated =
                        FLUX * sizes.flux + RESIDUALS * sizes.residual * share / distance;
                    match room < -tolerated {
                        true => PlaneVerdict::Slips(if above_lo < below_hi {
                            law.lo()
                        } else {
                            law.hi()
                        }),
                        false if share < 0.1 => PlaneVerdict::Unknown,
                        false => PlaneVerdict::Right,
                    }
                }
                State::Flux(q) => {
                    let right = if q == law.hi() { -node.value } else { node.value };
                    value = value.min(right / sizes.value);
                    // An end that is a little off.
                    let near = if distance < NEAR * setup.perimeter { NEAR } else { 0.0 };
                    let wrong = right
                        < -(VALUE * sizes.value * (1.0 + 1e3 * near / NEAR)
                            + RESIDUALS * sizes.residual);
                    if wrong { PlaneVerdict::Sticks } else { PlaneVerdict::Right }
                }
            };
            verdicts.push(verdict);
        }
        let wrong =
            verdicts.iter().any(|v| matches!(v, PlaneVerdict::Slips(_) | PlaneVerdict::Sticks));
        let mended = wrong.then(|| {
            let rings = setup.rings.iter().enumerate();
            rings.map(|(r, ring)| mended(r, ring.length(), &contact[r], nodes, &verdicts)).collect()
        });
        Self { flux, value, mended }
    }
}

/// Contact set of a loop by the verdicts.
fn mended(
    ring: usize,
    turn: f64,
    contact: &RingContact,
    nodes: &[PlaneNode],
    verdicts: &[PlaneVerdict],
) -> RingContact {
    let own: Vec<usize> =
        (0..nodes.len()).filter(|&i| nodes[i].ring == ring && nodes[i].lawful).collect();
    let many = own.len();
    let mut verdicts: Vec<PlaneVerdict> = own.iter().map(|&i| verdicts[i]).collect();
    // What is not known goes with what is beside it.
    for i in (0..many).chain((0..many).rev()) {
        if verdicts[i] == PlaneVerdict::Unknown {
            for beside in [(i + 1) % many, (i + many - 1) % many] {
                if let slips @ PlaneVerdict::Slips(_) = verdicts[beside] {
                    verdicts[i] = slips;
                }
            }
        }
    }
    if !verdicts.iter().any(|v| matches!(v, PlaneVerdict::Slips(_) | PlaneVerdict::Sticks)) {
        return contact.clone();
    }
    // Flux where it slips, none where it sticks.
    let flux = |i: usize| match (verdicts[i], nodes[own[i]].state) {
        (PlaneVerdict::Slips(q), _) => Some(q),
        (PlaneVerdict::Sticks, _) | (_, State::Held) => None,
        (_, State::Flux(q)) => Some(q),
    };
    let mut changes: Vec<(f64, Option<f64>)> = Vec::new();
    for i in 0..many {
        let before = (i + many - 1) % many;
        let (was, is) = (flux(before), flux(i));
        if was.is_some() == is.is_some() {
            continue;
        }
        let [a, b] = [before, i].map(|i| &nodes[own[i]]);
        let between = (b.t - a.t).rem_euclid(turn);
        let kept = contact
            .arcs
            .iter()
            .flatten()
            .map(|t| (t - a.t).rem_euclid(turn))
            .find(|&after| after <= between);
        let both_right = [before, i]
            .iter()
            .all(|&i| !matches!(verdicts[i], PlaneVerdict::Slips(_) | PlaneVerdict::Sticks));
        let after = match kept {
            Some(after) if both_right => after,
            _ => 0.5 * between,
        };
        changes.push(((a.t + after).rem_euclid(turn), is));
    }
    if changes.is_empty() {
        return RingContact { arcs: Vec::new(), gaps: flux(0).into_iter().collect() };
    }
    let mut found = RingContact::default();
    for (k, &(from, is)) in changes.iter().enumerate() {
        let (to, slips) = changes[(k + 1) % changes.len()];
        if is.is_none() {
            found.arcs.push([from, from + (to - from).rem_euclid(turn)]);
            found.gaps.push(slips.expect("a gap follows"));
        }
    }
    found
}
