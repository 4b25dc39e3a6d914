//! Signs of v and of the flux on the boundary, and the contact set without those that are wrong.

use super::newton::NOWHERE;
use crate::problem::law::BoundaryState;
use crate::spectral::fit::field::{PlaneNode, Sizes};
use crate::spectral::geometry::boundary::{State, sign};
use crate::spectral::geometry::ring::{RingContact, StateChange};
use crate::spectral::setup::Setup;

/// Largest violations over what is tolerated, and the contact set with them mended, if any.
pub(crate) struct PlaneSigns {
    /// Least room of the flux in the law, over its size; violations next to a split count less.
    pub flux: f64,
    /// Least v less the value of the law, of the right sign where v slips, over its size.
    pub value: f64,
    pub mended: Option<Vec<RingContact>>,
}

/// State in which a node is found.
#[derive(Clone, Copy, PartialEq)]
enum PlaneVerdict {
    Right,
    /// Should have this state.
    Wrong(BoundaryState),
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

impl PlaneVerdict {
    fn is_wrong(self) -> bool {
        matches!(self, Self::Wrong(_))
    }

    /// Verdict on a node that sticks, and the room of its flux in the law.
    fn on_held(node: &PlaneNode, setup: &Setup, sizes: Sizes) -> (Self, f64) {
        let (law, distance) = (node.law, node.spot.offset);
        let share = (distance / (NEAR * setup.perimeter)).min(1.0);
        let [above_lo, below_hi] = law.room(node.flux);
        let room = above_lo.min(below_hi) * share;
        let tolerated = FLUX * sizes.flux + RESIDUALS * sizes.residual * share / distance;
        // No end is found nearer to where another law begins.
        let is_nowhere = node.by_joint && distance < NOWHERE * setup.perimeter;
        let verdict = if room < -tolerated && !is_nowhere {
            let is_up = above_lo < below_hi;
            Self::Wrong(if is_up { BoundaryState::SlipsUp } else { BoundaryState::SlipsDown })
        } else if share < 0.1 {
            Self::Unknown
        } else {
            Self::Right
        };
        (verdict, room)
    }

    /// Verdict on a node that slips with the flux q, and v less the value of its law, of the right sign.
    fn on_slipping(node: &PlaneNode, q: f64, setup: &Setup, sizes: Sizes) -> (Self, f64) {
        let right = sign(node.law, q) * node.above();
        // Beside an end that is a little off.
        let beside = if node.spot.offset < NEAR * setup.perimeter { 1e3 } else { 0.0 };
        let tolerated = VALUE * sizes.value * (1.0 + beside) + RESIDUALS * sizes.residual;
        let verdict = match right < -tolerated {
            true => Self::Wrong(BoundaryState::Sticks),
            false => Self::Right,
        };
        (verdict, right)
    }
}

impl PlaneSigns {
    /// Signs at all nodes; those within the distance `unsure` of an end of contact are right.
    pub(crate) fn new(
        setup: &Setup,
        contact: &[RingContact],
        nodes: &[PlaneNode],
        sizes: Sizes,
        unsure: f64,
    ) -> Self {
        let (mut flux, mut value) = (0.0f64, 0.0f64);
        let mut verdicts = Vec::with_capacity(nodes.len());
        for node in nodes {
            verdicts.push(match node.state {
                _ if !node.law.may_move() || node.by_end && node.spot.offset < unsure => {
                    PlaneVerdict::Right
                }
                State::Held => {
                    let (verdict, room) = PlaneVerdict::on_held(node, setup, sizes);
                    flux = flux.min(room / sizes.flux);
                    verdict
                }
                State::Flux(q) => {
                    let (verdict, right) = PlaneVerdict::on_slipping(node, q, setup, sizes);
                    value = value.min(right / sizes.value);
                    verdict
                }
            });
        }
        let mended = verdicts.iter().any(|verdict| verdict.is_wrong()).then(|| {
            let rings = setup.domain.rings.iter().zip(contact).enumerate();
            let mended = rings.map(|(ring, (line, contact))| {
                LoopVerdicts::new(ring, line.length(), nodes, &verdicts).mended(contact)
            });
            mended.collect()
        });
        Self { flux, value, mended }
    }
}

/// Nodes of a loop where v may slip and stick, in walking order, with the verdicts on them.
struct LoopVerdicts<'a> {
    /// Length of the loop.
    turn: f64,
    nodes: Vec<&'a PlaneNode>,
    verdicts: Vec<PlaneVerdict>,
}

impl<'a> LoopVerdicts<'a> {
    fn new(ring: usize, turn: f64, nodes: &'a [PlaneNode], verdicts: &[PlaneVerdict]) -> Self {
        let own = nodes.iter().zip(verdicts);
        let own = own.filter(|(node, _)| node.ring == ring && node.law.may_move());
        let (nodes, verdicts) = own.map(|(node, verdict)| (node, *verdict)).unzip();
        Self { turn, nodes, verdicts }
    }

    /// Contact set of the loop by the verdicts, where `contact` is the one that they judge.
    fn mended(mut self, contact: &RingContact) -> RingContact {
        self.settle_unknown();
        if !self.verdicts.iter().any(|verdict| verdict.is_wrong()) {
            return contact.clone();
        }
        RingContact::of_changes(self.turn, &self.changes(contact), self.state(0))
    }

    /// Position of the node before another one.
    fn before(&self, i: usize) -> usize {
        (i + self.nodes.len() - 1) % self.nodes.len()
    }

    /// Lets nodes that are too near to a corner slip with the node beside them.
    fn settle_unknown(&mut self) {
        let many = self.nodes.len();
        for i in (0..many).chain((0..many).rev()) {
            if self.verdicts[i] == PlaneVerdict::Unknown {
                for beside in [(i + 1) % many, self.before(i)] {
                    if let PlaneVerdict::Wrong(state) = self.verdicts[beside]
                        && state != BoundaryState::Sticks
                    {
                        self.verdicts[i] = PlaneVerdict::Wrong(state);
                    }
                }
            }
        }
    }

    /// State that a node is to have.
    fn state(&self, i: usize) -> BoundaryState {
        let node = self.nodes[i];
        match (self.verdicts[i], node.state) {
            (PlaneVerdict::Wrong(state), _) => state,
            (_, State::Held) => BoundaryState::Sticks,
            (_, State::Flux(q)) if sign(node.law, q) > 0.0 => BoundaryState::SlipsUp,
            (_, State::Flux(_)) => BoundaryState::SlipsDown,
        }
    }

    /// Places at which the state changes, in walking order.
    fn changes(&self, contact: &RingContact) -> Vec<StateChange> {
        let mut changes = Vec::new();
        for i in 0..self.nodes.len() {
            let (was, state) = (self.state(self.before(i)), self.state(i));
            if was == state {
                continue;
            }
            let at = self.change_before(i, contact);
            if ![was, state].contains(&BoundaryState::Sticks) {
                // v passes the value of the law, on a free part or where laws meet.
                changes.push(StateChange { at, state: BoundaryState::Sticks });
            }
            changes.push(StateChange { at, state });
        }
        changes
    }

    /// Place of the change between a node and the one before it: the end of contact that is there if both nodes are
    /// right, else the middle.
    fn change_before(&self, i: usize, contact: &RingContact) -> f64 {
        let before = self.before(i);
        let [a, b] = [before, i].map(|i| self.nodes[i].t);
        let between = (b - a).rem_euclid(self.turn);
        let mut ends = contact.arcs.iter().flatten().map(|t| (t - a).rem_euclid(self.turn));
        let kept = ends.find(|&after| after <= between);
        let are_right = ![before, i].iter().any(|&i| self.verdicts[i].is_wrong());
        let after = kept.filter(|_| are_right).unwrap_or(0.5 * between);
        (a + after).rem_euclid(self.turn)
    }
}
