//! Cells that overlap although they share no facet: surfaces or volumes that lie on top of each other.
//!
//! Found are facets of the boundary that cross, and points of cells at the boundary that lie in other cells. Cells that
//! touch, up to rounding errors of the nodes, do not overlap.

use super::facets::BoundaryFacets;
use super::geometry::{Element, bounds, difference, dot, size};
use super::{Facet, MeshData};

/// Distance of the ends of an edge from a facet that they cross, over the size of the larger one; and barycentric
/// coordinate of a point in a cell, from which on both are no rounding errors.
const CLEAR: f64 = 1e-6;

/// Barycentric coordinate of a point of a cell for the vertex off the boundary.
const DEPTH: f64 = 0.061;
/// Weights of the corners of the facet, from the nearest one on: uneven, so that no side of another cell runs through
/// the point by coincidence, as it does where nodes of both lie on one lattice.
const ALONG: [f64; 3] = [0.817, 0.121, 0.062];

/// Point of a cell.
struct Probe<const D: usize> {
    point: [f64; D],
    cell: u32,
}

impl<const D: usize, const V: usize> MeshData<D, V> {
    /// Returns the positions of two cells that overlap, if there are any.
    pub(super) fn overlap(&self, boundary: &BoundaryFacets<D>) -> Option<[u32; 2]> {
        self.crossing(boundary).or_else(|| self.probed(boundary))
    }

    /// Cells of facets that cross.
    fn crossing(&self, boundary: &BoundaryFacets<D>) -> Option<[u32; 2]> {
        for (one, facet) in boundary.facets.iter().enumerate() {
            let corners = self.corners(facet);
            let near = boundary.boxes.near_facet(corners).into_iter();
            for two in near.filter(|&two| two as usize > one) {
                let other = self.corners(&boundary.facets[two as usize]);
                if cross(corners, other) {
                    return Some([one, two as usize].map(|facet| boundary.cells[facet]));
                }
            }
        }
        None
    }

    fn corners(&self, facet: &Facet<D>) -> [[f64; D]; D] {
        facet.nodes.map(|node| self.points[node as usize])
    }

    /// A cell at the boundary, and another one in which a point of the first lies.
    fn probed(&self, boundary: &BoundaryFacets<D>) -> Option<[u32; 2]> {
        let mut probes = self.probes(boundary);
        arrange(&mut probes, 0);
        self.cells.iter().zip(0..).find_map(|(cell, k)| {
            let inside = Inside::of(cell.map(|node| self.points[node as usize]));
            let found =
                find(&probes, 0, inside.bounds, &|bounds| inside.reaches(bounds), &|probe| {
                    probe.cell != k && inside.holds(probe.point)
                })?;
            Some([found.cell, k])
        })
    }

    /// Points of the cells at the boundary, one next to each corner of each facet.
    fn probes(&self, boundary: &BoundaryFacets<D>) -> Vec<Probe<D>> {
        let mut probes = Vec::with_capacity(D * boundary.facets.len());
        let all: f64 = ALONG[..D].iter().sum();
        for (facet, &owner) in boundary.facets.iter().zip(&boundary.cells) {
            let cell = self.cells[owner as usize];
            let inner = cell.into_iter().find(|node| !facet.nodes.contains(node));
            let inner = self.points[inner.expect("a facet leaves one vertex out") as usize];
            for nearest in 0..D {
                let mut point = inner.map(|x| DEPTH * x);
                for (k, weight) in ALONG[..D].iter().enumerate() {
                    let weight = (1.0 - DEPTH) * weight / all;
                    let corner = self.points[facet.nodes[(nearest + k) % D] as usize];
                    point.iter_mut().zip(corner).for_each(|(sum, x)| *sum += weight * x);
                }
                probes.push(Probe { point, cell: owner });
            }
        }
        probes
    }
}

/// Arranges points as a tree: the middle one parts the others by a coordinate, those on either side by the next one.
fn arrange<const D: usize>(probes: &mut [Probe<D>], axis: usize) {
    let middle = probes.len() / 2;
    if middle == 0 {
        return;
    }
    probes.select_nth_unstable_by(middle, |a, b| a.point[axis].total_cmp(&b.point[axis]));
    let (below, above) = probes.split_at_mut(middle);
    arrange(below, (axis + 1) % D);
    arrange(&mut above[1..], (axis + 1) % D);
}

/// Returns a point of a tree that lies within these bounds and passes a test, if there is one. Parts of the tree are
/// left out whose bounds the points sought do not reach.
fn find<'a, const D: usize>(
    tree: &'a [Probe<D>],
    axis: usize,
    bounds: [[f64; 2]; D],
    reaches: &impl Fn([[f64; 2]; D]) -> bool,
    test: &impl Fn(&Probe<D>) -> bool,
) -> Option<&'a Probe<D>> {
    let middle = tree.len() / 2;
    let probe = tree.get(middle).filter(|_| reaches(bounds))?;
    if test(probe) {
        return Some(probe);
    }
    let ([mut below, mut above], at) = ([bounds; 2], probe.point[axis]);
    below[axis][1] = at.min(below[axis][1]);
    above[axis][0] = at.max(above[axis][0]);
    let next = (axis + 1) % D;
    find(&tree[..middle], next, below, reaches, test)
        .or_else(|| find(&tree[middle + 1..], next, above, reaches, test))
}

/// Points clearly inside a cell.
struct Inside<const D: usize, const V: usize> {
    first: [f64; D],
    /// Gradients of the barycentric coordinates.
    gradients: [[f64; D]; V],
    bounds: [[f64; 2]; D],
}

impl<const D: usize, const V: usize> Inside<D, V> {
    fn of(vertices: [[f64; D]; V]) -> Self {
        let gradients = Element::new(vertices).gradients;
        Self { first: vertices[0], gradients, bounds: bounds(&vertices) }
    }

    /// True if a point is inside.
    fn holds(&self, point: [f64; D]) -> bool {
        self.reaches(point.map(|x| [x, x]))
    }

    /// True if each barycentric coordinate is clear of zero at some point within these bounds; written so that NaN is
    /// outside.
    fn reaches(&self, bounds: [[f64; 2]; D]) -> bool {
        let at_first = std::iter::once(1.0).chain(std::iter::repeat(0.0));
        self.gradients.iter().zip(at_first).all(|(gradient, at_first)| {
            let greatest = (0..D).map(|d| {
                let [low, high] = bounds[d].map(|x| gradient[d] * (x - self.first[d]));
                low.max(high)
            });
            bounds.iter().all(|[low, high]| low <= high) && at_first + greatest.sum::<f64>() > CLEAR
        })
    }
}

/// True if two facets clearly cross.
fn cross<const D: usize>(one: [[f64; D]; D], two: [[f64; D]; D]) -> bool {
    // In units of the larger size, from a corner on.
    let (origin, size) = (one[0], size(one).max(size(two)));
    let [one, two] = [one, two].map(|corners| {
        corners
            .map(|corner| -> [f64; D] { std::array::from_fn(|d| (corner[d] - origin[d]) / size) })
    });
    edge_crosses(one, two) || edge_crosses(two, one)
}

/// True if an edge of the first facet crosses the inside of the second one.
fn edge_crosses<const D: usize>(one: [[f64; D]; D], two: [[f64; D]; D]) -> bool {
    let pairs = (0..D).flat_map(|k| (0..k).map(move |i| [i, k]));
    pairs.map(|[i, k]| [one[i], one[k]]).any(|edge| {
        let heights = edge.map(|end| height(two, end));
        let is_parted = heights[0].min(heights[1]) < -CLEAR && heights[0].max(heights[1]) > CLEAR;
        is_parted && runs_through(edge, heights, two)
    })
}

/// Distance of a point from the line or plane of a facet, with a sign.
fn height<const D: usize>(facet: [[f64; D]; D], point: [f64; D]) -> f64 {
    let normal = normal(facet);
    dot(normal, difference(point, facet[0])) / dot(normal, normal).sqrt()
}

/// Vector at a right angle to a facet.
fn normal<const D: usize>(facet: [[f64; D]; D]) -> [f64; D] {
    let first = difference(facet[1], facet[0]);
    match D {
        2 => std::array::from_fn(|d| if d == 0 { -first[1] } else { first[0] }),
        _ => vector_product(first, difference(facet[2], facet[0])),
    }
}

/// True if an edge with its ends at these heights above a facet meets the line or plane of the facet inside the facet.
fn runs_through<const D: usize>(
    edge: [[f64; D]; 2],
    heights: [f64; 2],
    facet: [[f64; D]; D],
) -> bool {
    let along = heights[0] / (heights[0] - heights[1]);
    let point: [f64; D] = std::array::from_fn(|d| edge[0][d] + along * (edge[1][d] - edge[0][d]));
    let normal = normal(facet);
    // Each side of the facet has the point on its inner hand.
    (0..D).all(|k| {
        let side = difference(facet[(k + 1) % D], facet[k]);
        let from = difference(point, facet[k]);
        match D {
            2 => dot(side, from) > CLEAR * dot(side, side),
            _ => dot(vector_product(side, from), normal) > CLEAR * dot(normal, normal),
        }
    })
}

/// Vector product, in space.
fn vector_product<const D: usize>(one: [f64; D], two: [f64; D]) -> [f64; D] {
    std::array::from_fn(|d| {
        let [next, last] = [(d + 1) % 3, (d + 2) % 3];
        one[next] * two[last] - one[last] * two[next]
    })
}

#[cfg(test)]
mod tests {
    use crate::discrete::grid::Grid;
    use crate::mesh::{Mesh, MeshData, MeshError, uniform_cube, uniform_square};

    /// Two copies of a mesh, the second one moved, in one set of data, in some units.
    fn copies<const D: usize, const V: usize>(
        mesh: &Mesh<D, V>,
        shift: [f64; D],
        unit: f64,
    ) -> MeshData<D, V> {
        let count = mesh.points.len() as u32;
        let mut data = MeshData { points: mesh.points.clone(), ..MeshData::default() };
        data.cells.clone_from(&mesh.cells);
        data.points.extend(
            mesh.points
                .iter()
                .map(|point| -> [f64; D] { std::array::from_fn(|d| point[d] + shift[d]) }),
        );
        data.cells.extend(mesh.cells.iter().map(|cell| cell.map(|node| node + count)));
        data.points.iter_mut().for_each(|point| *point = point.map(|x| unit * x));
        data
    }

    /// Checks that all copies with these shifts overlap, or that none does, in every unit.
    fn check<const D: usize, const V: usize>(
        mesh: &Mesh<D, V>,
        shifts: &[[f64; D]],
        overlap: bool,
    ) {
        for &shift in shifts {
            for unit in [1e-40, 1e-6, 1.0, 1e40] {
                let made = copies(mesh, shift, unit).mesh();
                match made {
                    Ok(_) => assert!(!overlap, "{shift:?} {unit:e}"),
                    Err(MeshError::Overlaid { .. }) => assert!(overlap, "{shift:?} {unit:e}"),
                    other => panic!("{shift:?} {unit:e} {other:?}"),
                }
            }
        }
    }

    #[test]
    fn surfaces_on_top_of_each_other_are_refused_and_those_that_touch_are_not() {
        let square = uniform_square(Grid::new(4).unwrap());
        let off = [[0.3, 0.4], [0.0, 0.0], [0.5, 0.5], [0.25, 0.0], [0.01, 0.013], [-0.7, 0.99]];
        check(&square, &off, true);
        let touching = [[1.0, 0.0], [1.0, 0.25], [1.0, 1.0], [0.0, -1.0], [1.3, 0.1], [0.1, 1.5]];
        check(&square, &touching, false);
        // A small square in a cell of a large one, and one that is larger by far.
        for (scale, shift) in [(0.01, 0.06), (300.0, 20.1)] {
            let mut data = copies(&square, [0.0; 2], 1.0);
            let count = data.points.len() / 2;
            data.points[count..].iter_mut().for_each(|point| {
                *point = point.map(|x| scale * x + shift);
            });
            assert!(matches!(data.mesh(), Err(MeshError::Overlaid { .. })), "{scale}");
        }
    }

    #[test]
    fn volumes_on_top_of_each_other_are_refused_and_those_that_touch_are_not() {
        let cube = uniform_cube(2);
        let off = [[0.3, 0.4, 0.2], [0.0; 3], [0.5; 3], [0.5, 0.0, 0.0], [0.5, 0.5, 0.1]];
        check(&cube, &off, true);
        let touching = [[1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0; 3], [0.0, 1.0, -1.0], [2.0; 3]];
        check(&cube, &touching, false);
    }

    #[test]
    fn elements_that_overlap_are_named_and_folds_with_their_facet() {
        let data = |points: Vec<[f64; 2]>, cells: Vec<[u32; 3]>| {
            let data = MeshData { points, cells, ..MeshData::default() };
            data.mesh().unwrap_err().to_string()
        };
        let two = vec![[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.5, 0.5], [3.0, 0.6], [0.6, 3.0]];
        assert_eq!(
            data(two, vec![[0, 1, 2], [3, 5, 4]]),
            "elements 0 and 1 overlap: fragment the surfaces, e.g. with `BooleanFragments` in Gmsh, and mesh again"
        );
        let fold = vec![[0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [0.5, 0.4]];
        assert_eq!(
            data(fold, vec![[0, 1, 2], [0, 1, 3]]),
            "elements 0 and 1 overlap: both lie on one side of their facet [0, 1]; remove what is there twice, and \
             mesh again"
        );
        let data = MeshData::<3, 4> {
            points: vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [0.2, 0.2, 0.5],
            ],
            cells: vec![[0, 1, 2, 3], [1, 0, 2, 4]],
            ..MeshData::default()
        };
        assert!(matches!(data.mesh(), Err(MeshError::Fold { cells: [0, 1], .. })));
    }
}
