//! Surfaces on which the facets of the boundary lie, and the points that several of them have in common.

use super::geometry::{difference, dot};
use super::{Facet, Mesh, Names, Round, size};

/// Surface on which a facet lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Surface<const D: usize> {
    /// Curve of its part.
    Round(Round<D>),
    /// Line or plane of the facet itself, through a point, with a normal of length one.
    Plane {
        /// Corner of the facet.
        point: [f64; D],
        /// Normal.
        normal: [f64; D],
    },
}

/// Steps of Newton's method to a common point at most: each doubles the number of digits.
const MOST_STEPS: usize = 30;
/// Square of the sine of an angle below which two surfaces are taken to touch each other.
const TANGENT: f64 = 1e-10;
/// Roundings of the largest number that a distance from a surface may have.
const ROUNDINGS: f64 = 64.0;
/// Distance from a surface that is left, over the first one, at which a point lies on it.
const LEFT: f64 = 1e-9;

impl<const D: usize> Surface<D> {
    /// Line or plane of a facet; none if its corners lie in a line.
    pub(super) fn plane(corners: [[f64; D]; D]) -> Option<Self> {
        let along: [[f64; D]; D] = std::array::from_fn(|k| difference(corners[k], corners[0]));
        let normal: [f64; D] = std::array::from_fn(|d| match D {
            2 => (if d == 0 { -1.0 } else { 1.0 }) * along[1][1 - d],
            _ => {
                let ([a, b], [p, q]) = ([along[1], along[2]], [(d + 1) % 3, (d + 2) % 3]);
                a[p] * b[q] - a[q] * b[p]
            }
        });
        let length = dot(normal, normal).sqrt();
        (length > 0.0)
            .then(|| Self::Plane { point: corners[0], normal: normal.map(|x| x / length) })
    }

    /// Distance of a point, with a sign, and the normal of length one there; none at a centre or on an axis.
    fn offset(&self, point: [f64; D]) -> Option<(f64, [f64; D])> {
        match self {
            Self::Plane { point: on, normal } => {
                Some((dot(difference(point, *on), *normal), *normal))
            }
            Self::Round(round) => {
                let (outward, length) = round.outward(point);
                (length > 0.0).then(|| (length - round.radius, outward.map(|x| x / length)))
            }
        }
    }

    /// Roundings that the distance of a point may have.
    fn rounding(&self, point: [f64; D]) -> f64 {
        let most = |x: [f64; D]| x.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let own = match self {
            Self::Plane { point, .. } => most(*point),
            Self::Round(round) => round.radius.max(most(round.centre)),
        };
        ROUNDINGS * f64::EPSILON * own.max(most(point))
    }

    /// True if a point lies on the surface, but for rounding errors and so much.
    pub(super) fn contains(&self, point: [f64; D], tolerance: f64) -> bool {
        let rounding = self.rounding(point);
        self.offset(point).is_some_and(|(distance, _)| distance.abs() <= rounding + tolerance)
    }
}

/// Point that all surfaces have in common, near `start`: each step is the shortest one to the common points of the
/// planes that touch them. None if there is no such point within `reach`.
pub(super) fn common_point<const D: usize>(
    surfaces: &[Surface<D>],
    start: [f64; D],
    reach: f64,
) -> Option<[f64; D]> {
    let distance = |point: [f64; D]| {
        let offsets = surfaces.iter().map(move |surface| surface.offset(point));
        offsets.map(|offset| offset.map_or(f64::INFINITY, |(distance, _)| distance.abs()))
    };
    let first = distance(start).fold(0.0, f64::max);
    let (mut point, mut nearest) = (start, first);
    for _ in 0..MOST_STEPS {
        let next = step(surfaces, point)?;
        let left = distance(next).fold(0.0, f64::max);
        if left >= nearest {
            break;
        }
        (point, nearest) = (next, left);
    }
    let moved = difference(point, start);
    let is_near = dot(moved, moved) <= reach * reach;
    let is_common = surfaces.iter().all(|surface| surface.contains(point, LEFT * first));
    (is_near && is_common).then_some(point)
}

/// Goes to the nearest common point of the planes that touch the surfaces near a point, which leaves out surfaces that
/// touch those before them.
fn step<const D: usize>(surfaces: &[Surface<D>], point: [f64; D]) -> Option<[f64; D]> {
    let mut directions: Vec<[f64; D]> = Vec::with_capacity(D);
    let mut way = [0.0; D];
    for surface in surfaces {
        let (distance, normal) = surface.offset(point)?;
        let mut rest = normal;
        for &direction in &directions {
            let along = dot(rest, direction);
            rest = std::array::from_fn(|d| rest[d] - along * direction[d]);
        }
        let square = dot(rest, rest);
        if square < TANGENT {
            continue;
        }
        let direction = rest.map(|x| x / square.sqrt());
        let length = (-distance - dot(normal, way)) / dot(normal, direction);
        way.iter_mut().zip(direction).for_each(|(sum, x)| *sum += length * x);
        directions.push(direction);
    }
    Some(std::array::from_fn(|d| point[d] + way[d]))
}

/// Edge of a curved part of the boundary.
pub(super) struct CurvedEdge<const D: usize> {
    /// Nodes at its ends, the lower one first.
    pub ends: [u32; 2],
    /// Course of the nodes between them.
    pub course: Course<D>,
}

/// Course of an edge: a line, or the surfaces on which its nodes lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course<const D: usize> {
    /// On the edge.
    Straight,
    /// On the curve of its part.
    OnCurve(Round<D>),
    /// On the surfaces of both facets at the edge, which belong to two parts.
    Between([Surface<D>; 2]),
}

/// Way of the node of an edge, over the length of the edge, up to which it goes to the surfaces of both facets: a
/// little more than that to the arc of a third of a circle.
const MOST_WAY: f64 = 0.3;
/// Distance of the ends of an edge from a surface, over the length of the edge, up to which they lie on it.
const ON_SURFACE: f64 = 1e-9;

impl<const D: usize> Course<D> {
    /// Place of the node between two others.
    pub(super) fn middle(&self, ends: [[f64; D]; 2]) -> [f64; D] {
        let [a, b] = ends;
        let middle = std::array::from_fn(|d| 0.5 * (a[d] + b[d]));
        match self {
            Self::Straight => middle,
            Self::OnCurve(curve) => curve.nearest(middle),
            Self::Between(surfaces) => {
                let length = size(ends);
                let is_on = |end| surfaces.iter().all(|of| of.contains(end, ON_SURFACE * length));
                let found = common_point(surfaces, middle, MOST_WAY * length);
                // An edge that has once stayed straight ends off a surface, and its halves stay straight as well.
                found.filter(|_| ends.into_iter().all(is_on)).unwrap_or(middle)
            }
        }
    }
}

/// Cosine of the angle between facets of a part from which on they meet in an edge of the domain.
const SHARP: f64 = 0.87;
/// Cosine of an angle of 0.001 up to which facets lie in one plane, but for the digits of a file.
const IN_ONE_PLANE: f64 = 1.0 - 5e-7;

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Edges of the curved parts of the boundary, with the curves of their nodes: that of their part or, where two
    /// parts meet, the intersection of both. A part without a curve is its own facets: where these lie in one plane
    /// around an edge, the nodes stay in it; where they do not, they stand for a curve that is not known, and the edge
    /// stays straight.
    pub(super) fn curved_edges(&self) -> Vec<CurvedEdge<D>> {
        if !self.is_curved() {
            return Vec::new();
        }
        let mut of_edges = Vec::with_capacity(self.facets.len() * D * (D - 1) / 2);
        for (number, facet) in self.facets.iter().enumerate() {
            for i in 0..D {
                for j in 0..i {
                    let [a, b] = [facet.nodes[i], facet.nodes[j]];
                    of_edges.push(([a.min(b), a.max(b)], number));
                }
            }
        }
        of_edges.sort_unstable();
        let mut at_nodes: Option<FacetsAtNodes> = None;
        let mut curved = Vec::new();
        for of_edge in of_edges.chunk_by(|a, b| a.0 == b.0) {
            let (mut curves, mut others) = (Vec::new(), Vec::new());
            for &(_, facet) in of_edge {
                match self.curve_of(&self.facets[facet]) {
                    Some(curve) if !curves.contains(&curve) => curves.push(curve),
                    Some(_) => {}
                    None => others.push(facet),
                }
            }
            let ends = of_edge[0].0;
            let course = match (&curves[..], &others[..]) {
                ([], _) => continue,
                (&[curve], []) => Course::OnCurve(curve),
                (&[one, other], []) => Course::Between([one, other].map(Surface::Round)),
                (&[curve], &[other]) => {
                    let at_nodes = at_nodes.get_or_insert_with(|| FacetsAtNodes::of(self));
                    let plane = at_nodes.plane(self, other, ends);
                    plane.map_or(Course::Straight, |plane| {
                        Course::Between([Surface::Round(curve), plane])
                    })
                }
                _ => Course::Straight,
            };
            curved.push(CurvedEdge { ends, course });
        }
        curved
    }

    /// Curve of the part of a facet.
    pub(super) fn curve_of(&self, facet: &Facet<D>) -> Option<Round<D>> {
        self.parts[usize::from(facet.part)].curve
    }

    /// Line to be told of edges of curved parts that stay straight; none if there are none.
    pub(super) fn straight_edges(&self) -> Option<String> {
        let stays = |edge: &&CurvedEdge<D>| match edge.course {
            Course::Straight => true,
            Course::OnCurve(_) => false,
            Course::Between(surfaces) => {
                let ends = edge.ends.map(|node| self.points[node as usize]);
                let middle = edge.course.middle(ends);
                !surfaces.iter().all(|of| of.contains(middle, ON_SURFACE * size(ends)))
            }
        };
        let edges = self.curved_edges();
        let straight: Vec<_> = edges.iter().filter(stays).map(|edge| edge.ends).collect();
        if straight.is_empty() {
            return None;
        }
        let mut is_end = vec![false; self.points.len()];
        straight.iter().flatten().for_each(|&node| is_end[node as usize] = true);
        let ends =
            |facet: &Facet<D>| facet.nodes.iter().filter(|&&node| is_end[node as usize]).count();
        let parts = self.facets.iter().filter(|facet| ends(facet) >= 2);
        let names = Names::all(parts.map(|facet| &self.parts[usize::from(facet.part)].names));
        Some(format!(
            "edges between the parts {names} stay straight when the mesh is refined, because these parts are neither \
             flat there nor do their curves meet near them; give each of the parts its curve"
        ))
    }
}

/// Numbers of the facets at each node.
pub(super) struct FacetsAtNodes(Vec<(u32, usize)>);

impl FacetsAtNodes {
    pub(super) fn of<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> Self {
        let mut at_nodes = Vec::with_capacity(D * mesh.facets.len());
        for (number, facet) in mesh.facets.iter().enumerate() {
            at_nodes.extend(facet.nodes.map(|node| (node, number)));
        }
        at_nodes.sort_unstable();
        Self(at_nodes)
    }

    /// Numbers of the facets at a node.
    pub(super) fn at(&self, node: u32) -> impl Iterator<Item = usize> {
        let first = self.0.partition_point(|entry| entry.0 < node);
        self.0[first..].iter().take_while(move |entry| entry.0 == node).map(|entry| entry.1)
    }

    /// Plane of a facet, if the facets of its part at these nodes lie in it or meet it in an edge of the domain.
    fn plane<const D: usize, const V: usize>(
        &self,
        mesh: &Mesh<D, V>,
        facet: usize,
        nodes: [u32; 2],
    ) -> Option<Surface<D>> {
        let plane_of = |facet: usize| Surface::plane(mesh.corners(&mesh.facets[facet]));
        let own @ Some(Surface::Plane { normal, .. }) = plane_of(facet) else { return None };
        let is_same_part = |other: &usize| mesh.facets[*other].part == mesh.facets[facet].part;
        let mut others = nodes.into_iter().flat_map(|node| self.at(node)).filter(is_same_part);
        let is_flat = others.all(|other| match plane_of(other) {
            Some(Surface::Plane { normal: other, .. }) => {
                let cosine = dot(normal, other).abs();
                !(SHARP..IN_ONE_PLANE).contains(&cosine)
            }
            _ => true,
        });
        own.filter(|_| is_flat)
    }
}
