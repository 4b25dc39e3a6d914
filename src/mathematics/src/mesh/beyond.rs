//! Space between the facets of a mesh and the curves or surfaces on which their parts of the boundary lie.

use super::geometry::{centroid, difference, dot, measure, volume};
use super::load::OnCells;
use super::surface::{Course, CurvedEdge};
use super::{Facet, Mesh, Sides};

/// Halvings of a facet: in the plane 32 pieces, whose chords miss a thousandth of what the facet misses.
const HALVINGS: usize = 5;

/// Gain of the domain, by an estimate, if the curve of a facet takes its place. A loss is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurveGain {
    /// Position of the facet.
    pub facet: usize,
    /// Length or area of the boundary.
    pub measure: f64,
    /// Integral of f.
    pub integral: f64,
}

/// Returns the gains at all facets on curves. f is taken at one point of each piece between facet and curve.
pub(crate) fn curve_gains<const D: usize, const V: usize, F: OnCells<D> + ?Sized>(
    mesh: &Mesh<D, V>,
    sides: &Sides<V>,
    f: &F,
) -> Vec<CurveGain> {
    let edges = mesh.curved_edges();
    if edges.is_empty() {
        return Vec::new();
    }
    let mut gains = Vec::new();
    for (number, side) in sides.of_facets().iter().enumerate() {
        let facet = &mesh.facets()[number];
        let courses = courses(mesh, facet, &edges);
        if courses.iter().all(|course| *course == Course::Straight) {
            continue;
        }
        let inside = centroid(mesh.vertices(&mesh.cells()[side.cell as usize]));
        let region = mesh.regions()[side.cell as usize];
        let corners = mesh.corners(facet);
        let within = mesh.curve_of(facet).map_or(Course::Straight, Course::OnCurve);
        let (mut pieces, mut integral) = (vec![FacetPiece { corners, courses }], 0.0);
        for _ in 0..HALVINGS {
            let mut halves = Vec::with_capacity(2 * pieces.len());
            for piece in pieces {
                let ends = longest_edge(piece.corners);
                let (top, of_piece) = piece.halves(ends, within);
                let middle = centroid(ends.map(|end| piece.corners[end]));
                let between: [[f64; D]; V] =
                    std::array::from_fn(|k| if k < D { piece.corners[k] } else { top });
                let outward = dot(difference(top, middle), difference(middle, inside));
                let volume = volume(between);
                integral += volume.copysign(outward) * f.at(region, centroid(between));
                halves.extend(of_piece);
            }
            pieces = halves;
        }
        let of_pieces: f64 = pieces.into_iter().map(|piece| measure(piece.corners)).sum();
        gains.push(CurveGain { facet: number, measure: of_pieces - measure(corners), integral });
    }
    gains
}

/// Piece of a facet.
struct FacetPiece<const D: usize> {
    corners: [[f64; D]; D],
    /// Courses of the edge opposite to each corner; in the plane, of the one edge, twice.
    courses: [Course<D>; D],
}

impl<const D: usize> FacetPiece<D> {
    /// Node of the edge with these ends, and the two pieces that it makes; nodes between them lie `within`.
    fn halves(&self, ends: [usize; 2], within: Course<D>) -> ([f64; D], [Self; 2]) {
        let opposite = (0..D).find(|k| !ends.contains(k)).unwrap_or_default();
        let course = self.courses[opposite];
        let top = course.middle(ends.map(|end| self.corners[end]));
        let half = |end: usize| {
            let (mut corners, mut courses) = (self.corners, self.courses);
            corners[end] = top;
            if D > 2 {
                let other = ends[0] + ends[1] - end;
                courses[other] = within;
            }
            Self { corners, courses }
        };
        (top, ends.map(half))
    }
}

/// Courses of the edges opposite to the corners of a facet.
fn courses<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    facet: &Facet<D>,
    edges: &[CurvedEdge<D>],
) -> [Course<D>; D] {
    std::array::from_fn(|corner| {
        let mut ends = [u32::MAX, 0];
        for (k, &node) in facet.nodes.iter().enumerate() {
            if D == 2 || k != corner {
                ends = [ends[0].min(node), ends[1].max(node)];
            }
        }
        let found = edges.binary_search_by_key(&ends, |edge| edge.ends);
        let own = mesh.curve_of(facet);
        match found {
            Ok(place) => edges[place].course,
            Err(_) => own.map_or(Course::Straight, Course::OnCurve),
        }
    })
}

/// Positions of the ends of the longest edge.
fn longest_edge<const D: usize>(corners: [[f64; D]; D]) -> [usize; 2] {
    let (mut longest, mut ends) = (-1.0, [0, 1]);
    for j in 0..D {
        for i in 0..j {
            let edge = difference(corners[j], corners[i]);
            if dot(edge, edge) > longest {
                (longest, ends) = (dot(edge, edge), [i, j]);
            }
        }
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BuiltIn, assemble};
    use crate::problem::source::Source;
    use std::f64::consts::PI;

    #[test]
    fn polygons_and_polyhedra_with_their_gains_have_the_measures_of_discs_annuli_and_balls() {
        for (domain, area, length) in
            [(BuiltIn::Disc, PI, 2.0 * PI), (BuiltIn::Annulus, 0.75 * PI, 3.0 * PI)]
        {
            let mesh = domain.plane().unwrap();
            let gains = curve_gains(&mesh, &Sides::new(&mesh), &Source::<2>::constant(1.0));
            let [mut integral, mut boundary] = [mesh.volume(), assemble(&mesh).laws().measure];
            gains.iter().for_each(|gain| integral += gain.integral);
            gains.iter().for_each(|gain| boundary += gain.measure);
            assert!((integral / area - 1.0).abs() < 1e-3, "{domain:?} {integral} {area}");
            assert!((boundary / length - 1.0).abs() < 1e-3, "{domain:?} {boundary} {length}");
        }
        let mesh = BuiltIn::Ball.space().unwrap();
        let gains = curve_gains(&mesh, &Sides::new(&mesh), &Source::<3>::constant(1.0));
        let whole = mesh.volume() + gains.iter().map(|gain| gain.integral).sum::<f64>();
        assert!((whole / (4.0 / 3.0 * PI) - 1.0).abs() < 0.05, "{whole}");
    }
}
