//! Closed curves of the boundary of a domain in the plane, and contact on them as arcs, with their forces and ends.

use super::{Names, PlaneMesh};
use crate::discrete::contact::{ContactArc, reach};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::Judgement;
use crate::problem::law::ContactNode;
use crate::problem::law::Law;

/// No node.
const NONE: usize = usize::MAX;

/// Closed curve of a boundary in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedCurve {
    /// Nodes in the direction that has the domain on the left, from the lowest one, of several the leftmost.
    pub nodes: Vec<usize>,
    /// Coordinates of these nodes.
    pub points: Vec<[f64; 2]>,
    /// Law on the edge from each node to the next one, the first after the last.
    pub laws: Vec<Law>,
    /// Position in `names` of the part of each of these edges; empty on the square.
    pub parts: Vec<u16>,
    /// Names of the parts of the boundary; none on the square, whose sides have no names.
    pub names: Vec<Names>,
    /// Arc lengths of the nodes, from 0 on.
    pub places: Vec<f64>,
    /// Length of the curve.
    pub length: f64,
}

impl ClosedCurve {
    /// Names of the parts on the curve; none on the square.
    pub fn label(&self) -> Option<String> {
        let mut parts = self.parts.clone();
        parts.sort_unstable();
        parts.dedup();
        let names = parts.iter().map(|&part| self.names[usize::from(part)].to_string());
        (!parts.is_empty()).then(|| names.collect::<Vec<_>>().join(", "))
    }

    /// Point of the curve so many edges after the first node.
    pub(super) fn point(&self, edges: f64) -> [f64; 2] {
        let count = self.points.len();
        let edges = edges.rem_euclid(count as f64);
        let [a, b] = [0, 1].map(|k| self.points[(edges as usize + k) % count]);
        std::array::from_fn(|d| a[d] + edges.fract() * (b[d] - a[d]))
    }

    /// Way along the curve from its first node to that point; it goes on growing behind a whole turn.
    pub(super) fn along(&self, edges: f64) -> f64 {
        let count = self.points.len();
        let turns = (edges / count as f64).floor();
        let edges = edges - turns * count as f64;
        let edge = (edges as usize).min(count - 1);
        let next = self.places.get(edge + 1).copied().unwrap_or(self.length);
        let way = self.places[edge] + (edges - edge as f64) * (next - self.places[edge]);
        turns * self.length + way
    }
}

/// Returns the boundary of the square under a law, from the lower left corner on.
pub fn square_boundary(grid: Grid, law: Law) -> ClosedCurve {
    let numbers = 0..grid.boundary_nodes();
    let point = |b: usize| {
        let (i, j) = grid.boundary_node(b);
        [grid.coordinate(i), grid.coordinate(j)]
    };
    ClosedCurve {
        nodes: grid.boundary().collect(),
        points: numbers.clone().map(point).collect(),
        laws: vec![law; numbers.len()],
        parts: Vec::new(),
        names: Vec::new(),
        places: numbers.map(|b| b as f64 * grid.h()).collect(),
        length: Grid::PERIMETER,
    }
}

/// Returns the closed curves of the boundary, from the one with the lowest node on.
pub(crate) fn boundary_curves(mesh: &PlaneMesh) -> Vec<ClosedCurve> {
    let nodes = mesh.points.len();
    let (mut after, mut edges) = (vec![NONE; nodes], vec![(Law::SIGNORINI, 0); nodes]);
    for facet in &mesh.facets {
        let [from, to] = facet.nodes.map(|node| node as usize);
        (after[from], edges[from]) = (to, (mesh.law(facet), facet.part));
    }
    let mut starts: Vec<usize> = (0..nodes).filter(|&node| after[node] != NONE).collect();
    starts.sort_by(|&a, &b| {
        let [[ax, ay], [bx, by]] = [mesh.points[a], mesh.points[b]];
        ay.total_cmp(&by).then(ax.total_cmp(&bx))
    });
    let mut curves = Vec::new();
    for start in starts {
        let (mut node, mut nodes) = (start, Vec::new());
        while after[node] != NONE {
            nodes.push(node);
            node = std::mem::replace(&mut after[node], NONE);
        }
        if nodes.is_empty() {
            continue;
        }
        let mut places = arc_lengths(mesh, &nodes);
        let (laws, parts) = nodes.iter().map(|&node| edges[node]).unzip();
        curves.push(ClosedCurve {
            points: nodes.iter().map(|&node| mesh.points[node]).collect(),
            laws,
            parts,
            names: mesh.parts.iter().map(|part| part.names.clone()).collect(),
            length: places.pop().unwrap_or_default(),
            places,
            nodes,
        });
    }
    curves
}

/// Arc lengths of the nodes of a closed curve from the first, which is also the last.
fn arc_lengths(mesh: &PlaneMesh, nodes: &[usize]) -> Vec<f64> {
    let (mut lengths, mut sum) = (vec![0.0], 0.0);
    for (k, &node) in nodes.iter().enumerate() {
        let next = nodes[(k + 1) % nodes.len()];
        let [[ax, ay], [bx, by]] = [node, next].map(|node| mesh.points()[node]);
        sum += ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
        lengths.push(sum);
    }
    lengths
}

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
        let ClosedCurve { laws, parts, names, .. } = self.curve.curve;
        let edges = edges.into_iter().map(|edges| self.further(edges));
        let edges = edges.filter(|&edge| laws[edge].may_move());
        (!names.is_empty()).then(|| Names::all(edges.map(|edge| &names[usize::from(parts[edge])])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BuiltIn, refine, uniform_square};

    #[test]
    fn the_curve_of_a_grid_is_that_of_its_mesh() {
        let grid = Grid::new(8).unwrap();
        let [of_mesh] = &boundary_curves(&uniform_square(grid))[..] else { panic!("one curve") };
        let of_grid = square_boundary(grid, Law::SIGNORINI);
        assert_eq!((&of_grid.nodes, &of_grid.points), (&of_mesh.nodes, &of_mesh.points));
        assert_eq!((&of_grid.places, of_grid.length), (&of_mesh.places, of_mesh.length));
        assert_eq!((of_grid.label(), of_mesh.label()), (None, Some("boundary".into())));
    }

    #[test]
    fn the_annulus_has_two_curves_that_run_with_the_domain_on_their_left() {
        let mesh = refine(&BuiltIn::Annulus.plane().unwrap()).unwrap().mesh;
        let curves = boundary_curves(&mesh);
        assert_eq!(curves.len(), 2);
        assert_eq!(curves.iter().map(|curve| curve.nodes.len()).sum::<usize>(), mesh.facets.len());
        for (curve, turns) in curves.iter().zip([1.0, -1.0]) {
            assert!(curve.parts.iter().all(|part| *part == curve.parts[0]));
            let place = |k: usize| mesh.points[curve.nodes[k % curve.nodes.len()]];
            assert_eq!(curve.places.len(), curve.nodes.len());
            let area: f64 = (0..curve.nodes.len())
                .map(|k| {
                    let ([ax, ay], [bx, by]) = (place(k), place(k + 1));
                    0.5 * (ax * by - ay * bx)
                })
                .sum();
            assert!(area * turns > 0.0, "{area}");
            assert!((0..curve.nodes.len()).all(|k| place(0)[1] <= place(k)[1]));
        }
    }
}
