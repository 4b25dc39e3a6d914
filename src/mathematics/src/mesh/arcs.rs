//! Contact on the boundary of a domain in the plane as arcs, with their forces, and where they end between nodes.

use super::{ClosedCurve, Condition, Names};
use crate::discrete::contact::{ContactArc, reach};
use crate::discrete::kkt::Judgement;
use crate::problem::law::ContactNode;

/// Returns the arcs of boundary nodes [in contact](Judgement::in_contact), for a nodal vector and its judgement, each
/// in the direction that has the domain on the left, in the order of the contact nodes. Arcs that are whole curves come
/// last; each begins and ends at one node.
pub fn arcs(curves: &[ClosedCurve], y: &[f64], judgement: &Judgement) -> Vec<ContactArc> {
    let touching = judgement.in_contact().into_iter().zip(&judgement.flux);
    let mut force: Vec<_> = touching.map(|(touches, flux)| touches.then_some(*flux)).collect();
    let curves = ContactCurve::all(curves, &judgement.contact);
    let mut places = vec![None; force.len()];
    for curve in &curves {
        // An arc from the first node, which is also the last, has the numbers of one that passes it.
        for k in 1..=curve.numbers.len() {
            let place = CurvePlace { curve, y, k };
            if let Some(number) = place.number(0) {
                places[number] = Some(place);
            }
        }
    }
    let mut arcs = Vec::new();
    for place in places.iter().flatten() {
        if place.touches(0, &force) && !place.touches(-1, &force) {
            arcs.push(place.arc(&mut force));
        }
    }
    // What is left are closed curves.
    for place in places.iter().flatten() {
        if place.touches(0, &force) {
            arcs.push(place.arc(&mut force));
        }
    }
    arcs
}

/// Curve with the numbers of its nodes among the contact nodes; none of others. A fine grid has room for no more than
/// that.
struct ContactCurve<'a> {
    curve: &'a ClosedCurve,
    numbers: Vec<Option<usize>>,
}

impl<'a> ContactCurve<'a> {
    fn all(curves: &'a [ClosedCurve], contact: &[ContactNode]) -> Vec<Self> {
        let mut by_node: Vec<_> = contact.iter().map(|contact| contact.node).zip(0..).collect();
        by_node.sort_unstable();
        let of_curve = curves.iter().map(|curve| {
            let places =
                curve.nodes.iter().map(|node| by_node.binary_search_by_key(node, |of| of.0));
            let numbers = places.map(|place| place.ok().map(|place| by_node[place].1)).collect();
            Self { curve, numbers }
        });
        of_curve.collect()
    }
}

/// Node of a curve.
#[derive(Clone, Copy)]
struct CurvePlace<'a> {
    curve: &'a ContactCurve<'a>,
    y: &'a [f64],
    /// Number of the node on the curve, from 1 on; the first node comes last.
    k: usize,
}

impl CurvePlace<'_> {
    /// Number on the curve of the node so many edges further.
    fn further(&self, edges: isize) -> usize {
        (self.k as isize + edges).rem_euclid(self.curve.numbers.len() as isize) as usize
    }

    /// Number of the node so many edges further among the contact nodes.
    fn number(&self, edges: isize) -> Option<usize> {
        self.curve.numbers[self.further(edges)]
    }

    /// True if the node so many edges further has a force.
    fn touches(&self, edges: isize, force: &[Option<f64>]) -> bool {
        self.number(edges).is_some_and(|number| force[number].is_some())
    }

    /// Follows the arc from its first node, and removes its forces.
    fn arc(&self, force: &mut [Option<f64>]) -> ContactArc {
        let (curve, mut count, mut sum) = (self.curve.curve, 0, 0.0);
        while let Some(of_node) = self.number(count).and_then(|number| force[number].take()) {
            (count, sum) = (count + 1, sum + of_node);
        }
        if count as usize == curve.nodes.len() {
            let point = curve.points[self.further(0)];
            let arc = ContactArc::new([point; 2], sum, curve.length);
            return ContactArc { part: self.names(0..count), ..arc };
        }
        let last = count - 1;
        let mut beyond = [[-1, -2], [last + 1, last + 2]].map(|next| {
            let values = next.map(|edges| self.y[curve.nodes[self.further(edges)]]);
            reach(values).clamp(0.0, 1.0)
        });
        if last == 0 && beyond == [0.0; 2] {
            // No ends can be told around this one node, and an arc without length would stand for all of a curve.
            beyond = [0.5; 2];
        }
        let places = [self.k as f64 - beyond[0], (self.k + last as usize) as f64 + beyond[1]];
        let ends = places.map(|place| curve.point(place));
        // The edge after the last node is not in contact, unless it is all that there is.
        let part = if last == 0 { self.names([0, -1]) } else { self.names(0..last) };
        let [from, to] = places.map(|place| curve.along(place));
        ContactArc { part, ..ContactArc::new(ends, sum, (to - from).min(curve.length)) }
    }

    /// Names of the parts, where the law holds, of the edges after the nodes so many edges further; none on the square.
    fn names(&self, edges: impl IntoIterator<Item = isize>) -> Option<String> {
        let ClosedCurve { conditions, parts, names, .. } = self.curve.curve;
        let edges = edges.into_iter().map(|edges| self.further(edges));
        let edges = edges.filter(|&edge| conditions[edge] == Condition::Contact);
        (!names.is_empty()).then(|| Names::all(edges.map(|edge| &names[usize::from(parts[edge])])))
    }
}
