//! Contact on the boundary of a domain in the plane as arcs, with their forces, and where they end between nodes.

use super::boundary::{BoundaryLinks, NONE};
use super::{Names, PlaneMesh};
use crate::discrete::contact::{ContactArc, reach};
use crate::discrete::kkt::Judgement;
use crate::discrete::network::Network;

/// Walk along the boundary.
struct BoundaryWalk<'a> {
    mesh: &'a PlaneMesh,
    y: &'a [f64],
    links: BoundaryLinks,
    /// Position of the part of the edge that begins at a node, where the law holds on it.
    part_after: Vec<Option<u16>>,
}

/// Returns the arcs of boundary nodes [in contact](Judgement::in_contact), for a nodal vector and its judgement, each
/// in the direction that has the domain on the left. An arc that is a whole closed curve begins and ends at one node.
pub fn mesh_arcs(
    mesh: &PlaneMesh,
    network: &Network,
    y: &[f64],
    judgement: &Judgement,
) -> Vec<ContactArc> {
    let nodes = network.contact().iter().map(|contact| contact.node);
    let mut force = vec![None; y.len()];
    for ((node, touches), flux) in nodes.clone().zip(judgement.in_contact()).zip(&judgement.flux) {
        force[node] = touches.then_some(*flux);
    }
    let boundary = BoundaryWalk::new(mesh, y);
    let mut arcs = Vec::new();
    for start in nodes.clone() {
        let begins =
            boundary.links.before.get(start).is_some_and(|&p| p == NONE || force[p].is_none());
        if force[start].is_some() && begins {
            arcs.push(boundary.arc(start, &mut force));
        }
    }
    // What is left are closed curves.
    for start in nodes {
        if force[start].is_some() {
            arcs.push(boundary.arc(start, &mut force));
        }
    }
    arcs
}

impl<'a> BoundaryWalk<'a> {
    fn new(mesh: &'a PlaneMesh, y: &'a [f64]) -> Self {
        let mut part_after = vec![None; y.len()];
        for facet in mesh.facets_with_law() {
            part_after[facet.nodes[0] as usize] = Some(facet.part);
        }
        Self { mesh, y, links: BoundaryLinks::new(mesh), part_after }
    }

    /// Follows the arc from its first node, and removes its forces.
    fn arc(&self, start: usize, force: &mut [Option<f64>]) -> ContactArc {
        let (mut last, mut sum) = (start, 0.0);
        let (mut node, mut parts) = (start, Vec::new());
        while node != NONE
            && let Some(of_node) = force[node].take()
        {
            (last, sum) = (node, sum + of_node);
            parts.push(self.part_after[node]);
            node = self.links.after[node];
        }
        if node == start && last != start {
            let point = self.mesh.points[start];
            return ContactArc {
                part: Some(self.names(&parts)),
                ..ContactArc::new([point; 2], sum)
            };
        }
        // The edge after the last node is not in contact, unless it is all that there is.
        if start != last {
            parts.pop();
        } else if self.links.before[start] != NONE {
            parts.push(self.part_after[self.links.before[start]]);
        }
        let mut ends = [(start, &self.links.before), (last, &self.links.after)]
            .map(|(node, next)| self.beyond(node, next));
        if start == last && ends.iter().all(|(part, _)| *part == 0.0) {
            // No ends can be told around this one node, and an arc without length would stand for all of a curve.
            ends.iter_mut().for_each(|(part, _)| *part = 0.5);
        }
        let [from, to] = [(start, ends[0]), (last, ends[1])].map(|(node, (part, next))| {
            let [a, b] = [node, next].map(|node| self.mesh.points[node]);
            std::array::from_fn(|d| a[d] + part * (b[d] - a[d]))
        });
        ContactArc {
            part: Some(self.names(&parts)),
            closed: false,
            ..ContactArc::new([from, to], sum)
        }
    }

    /// Names of parts, by their positions.
    fn names(&self, parts: &[Option<u16>]) -> String {
        let parts = parts.iter().flatten().map(|&part| &self.mesh.parts[usize::from(part)].names);
        Names::all(parts)
    }

    /// Part of the edge beyond the last node of an arc that is in contact, and the node at its other end.
    fn beyond(&self, node: usize, next: &[usize]) -> (f64, usize) {
        let first = next[node];
        if first == NONE {
            return (0.0, node);
        }
        let second = next[first];
        let part = match second {
            NONE => 0.0,
            second => reach([self.y[first], self.y[second]]).clamp(0.0, 1.0),
        };
        (part, first)
    }
}
