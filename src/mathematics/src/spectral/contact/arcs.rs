//! The arcs of a solution that stick.

use super::search::PlaneFound;
use crate::spectral::fit::field::PlaneNode;
use crate::spectral::geometry::domain::{PlaneDomain, SidePlace};
use crate::spectral::problem::frame::Frame;
use crate::spectral::setup::Setup;

/// Arc of the boundary that sticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlaneArc {
    /// Number of its loop.
    pub ring: usize,
    /// Beginning and end in walking order.
    pub ends: [SidePlace; 2],
    /// These places as points.
    pub points: [[f64; 2]; 2],
    /// Distances along the boundary within which the true ends lie, as [`ends`](super::ends) estimates them.
    pub errors: [f64; 2],
    /// True if it is all of the loop.
    pub closed: bool,
    /// Integral of dv/dn.
    pub force: f64,
}

/// Arcs that stick, with forces.
pub(in crate::spectral) fn arcs(
    domain: &PlaneDomain,
    frame: Frame,
    setup: &Setup,
    found: &PlaneFound,
) -> Vec<PlaneArc> {
    let (mut arcs, errors) = (Vec::new(), found.end_errors(setup));
    for (r, ring) in setup.rings.iter().enumerate() {
        let (turn, own) = (ring.length(), &found.contact[r]);
        let lawful: Vec<&PlaneNode> =
            found.nodes.iter().filter(|node| node.ring == r && node.lawful).collect();
        let closed = own.arcs.is_empty() && own.gaps.is_empty() && !lawful.is_empty();
        let all = [0.0, turn];
        let errors = errors[r].iter().chain(closed.then_some(&[0.0; 2]));
        for (&[from, to], errors) in own.arcs.iter().chain(closed.then_some(&all)).zip(errors) {
            let inside = lawful.iter().filter(|node| (node.t - from).rem_euclid(turn) <= to - from);
            let force: f64 = inside.map(|node| node.spot.weight * node.flux).sum();
            let ends = [from, to].map(|t| {
                let SidePlace { side, s } = ring.place(t);
                SidePlace { side, s: frame.unit * s }
            });
            arcs.push(PlaneArc {
                ring: r,
                ends,
                points: ends.map(|place| domain.loops[r][place.side].at(place.s)),
                errors: errors.map(|error| frame.unit * error),
                closed,
                force: frame.unit * frame.unit * force,
            });
        }
    }
    arcs
}
