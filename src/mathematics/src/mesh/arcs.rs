//! Contact on the boundary of a domain in the plane as arcs, with their forces, and where they end between nodes.

use super::{ClosedCurve, Condition, Names};
use crate::discrete::contact::{ContactArc, reach};
use crate::discrete::kkt::Judgement;

/// Returns the arcs of boundary nodes [in contact](Judgement::in_contact), for a nodal vector and its judgement, each
/// in the direction that has the domain on the left, in the order of the contact nodes. Arcs that are whole curves come
/// last; each begins and ends at one node.
pub fn arcs(curves: &[ClosedCurve], y: &[f64], judgement: &Judgement) -> Vec<ContactArc> {
    let nodes = judgement.contact.iter().map(|contact| contact.node);
    let mut force = vec![None; y.len()];
    for ((node, touches), flux) in nodes.clone().zip(judgement.in_contact()).zip(&judgement.flux) {
        force[node] = touches.then_some(*flux);
    }
    let mut places = vec![None; y.len()];
    for curve in curves {
        // An arc from the first node, which is also the last, has the numbers of one that passes it.
        for k in 1..=curve.nodes.len() {
            let place = CurvePlace { curve, y, k };
            places[place.node(0)] = Some(place);
        }
    }
    let mut arcs = Vec::new();
    for place in nodes.clone().filter_map(|node| places[node]) {
        if force[place.node(0)].is_some() && force[place.node(-1)].is_none() {
            arcs.push(place.arc(&mut force));
        }
    }
    // What is left are closed curves.
    for place in nodes.filter_map(|node| places[node]) {
        if force[place.node(0)].is_some() {
            arcs.push(place.arc(&mut force));
        }
    }
    arcs
}

/// Node of a curve.
#[derive(Clone, Copy)]
struct CurvePlace<'a> {
    curve: &'a ClosedCurve,
    y: &'a [f64],
    /// Number of the node on the curve, from 1 on; the first node comes last.
    k: usize,
}

impl CurvePlace<'_> {
    /// Number on the curve of the node so many edges further.
    fn further(&self, edges: isize) -> usize {
        (self.k as isize + edges).rem_euclid(self.curve.nodes.len() as isize) as usize
    }

    /// The node so many edges further.
    fn node(&self, edges: isize) -> usize {
        self.curve.nodes[self.further(edges)]
    }

    /// Follows the arc from its first node, and removes its forces.
    fn arc(&self, force: &mut [Option<f64>]) -> ContactArc {
        let (mut count, mut sum) = (0, 0.0);
        while let Some(of_node) = force[self.node(count)].take() {
            (count, sum) = (count + 1, sum + of_node);
        }
        if count as usize == self.curve.nodes.len() {
            let point = self.curve.points[self.further(0)];
            return ContactArc { part: self.names(0..count), ..ContactArc::new([point; 2], sum) };
        }
        let last = count - 1;
        let mut beyond = [[-1, -2], [last + 1, last + 2]].map(|next| {
            let values = next.map(|edges| self.y[self.node(edges)]);
            reach(values).clamp(0.0, 1.0)
        });
        if last == 0 && beyond == [0.0; 2] {
            // No ends can be told around this one node, and an arc without length would stand for all of a curve.
            beyond = [0.5; 2];
        }
        let places = [self.k as f64 - beyond[0], (self.k + last as usize) as f64 + beyond[1]];
        let ends = places.map(|place| self.curve.point(place));
        // The edge after the last node is not in contact, unless it is all that there is.
        let part = if last == 0 { self.names([0, -1]) } else { self.names(0..last) };
        ContactArc { part, ..ContactArc::new(ends, sum) }
    }

    /// Names of the parts, where the law holds, of the edges after the nodes so many edges further; none on the square.
    fn names(&self, edges: impl IntoIterator<Item = isize>) -> Option<String> {
        let ClosedCurve { conditions, parts, names, .. } = self.curve;
        let edges = edges.into_iter().map(|edges| self.further(edges));
        let edges = edges.filter(|&edge| conditions[edge] == Condition::Contact);
        (!names.is_empty()).then(|| Names::all(edges.map(|edge| &names[usize::from(parts[edge])])))
    }
}
