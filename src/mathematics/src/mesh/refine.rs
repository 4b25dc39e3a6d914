//! Uniform refinement: each triangle into four, each tetrahedron into eight (Bey 1995).
//!
//! New nodes are numbered after the old ones in the order of the [edges](super::Edges) that they halve, and lie on the
//! curve of their boundary part or, between two parts, on the surfaces of both.

use super::error::MeshError;
use super::surface::CurvedEdge;
use super::{Edges, Element, Facet, Mesh};

/// Refined mesh, and the edges of the coarse one.
pub struct Refined<const D: usize, const V: usize> {
    /// Refined mesh; its first nodes are those of the coarse one.
    pub mesh: Mesh<D, V>,
    /// Nodes of the coarse mesh between which each new node lies, in the order of the new nodes.
    pub parents: Vec<[u32; 2]>,
}

/// Vertex of a child: that of the parent if both are the same, else the midpoint of the edge between them.
type Vertex = [usize; 2];

const TRIANGLES: [[Vertex; 3]; 4] = [
    [[0, 0], [0, 1], [0, 2]],
    [[0, 1], [1, 1], [1, 2]],
    [[0, 2], [1, 2], [2, 2]],
    [[0, 1], [1, 2], [0, 2]],
];

/// Children in the order of vertices that keeps all refinements within three shapes (J. Bey, Computing 55, 1995).
const TETRAHEDRA: [[Vertex; 4]; 8] = [
    [[0, 0], [0, 1], [0, 2], [0, 3]],
    [[0, 1], [1, 1], [1, 2], [1, 3]],
    [[0, 2], [1, 2], [2, 2], [2, 3]],
    [[0, 3], [1, 3], [2, 3], [3, 3]],
    [[0, 1], [0, 2], [0, 3], [1, 3]],
    [[0, 1], [0, 2], [1, 2], [1, 3]],
    [[0, 2], [0, 3], [1, 3], [2, 3]],
    [[0, 2], [1, 2], [1, 3], [2, 3]],
];

/// Children of an edge.
const EDGES: [[Vertex; 2]; 2] = [[[0, 0], [0, 1]], [[0, 1], [1, 1]]];

/// Adds the children of a simplex to `out`; `middle` is the midpoint of the edge between two vertices, the later one
/// second.
#[inline(always)]
fn split<const K: usize>(
    nodes: [u32; K],
    middle: impl Fn(Vertex) -> usize,
    out: &mut Vec<[u32; K]>,
) {
    let number = |[a, b]: Vertex| if a == b { nodes[a] } else { middle([a, b]) as u32 };
    match K {
        2 => out.extend(EDGES.iter().map(|child| std::array::from_fn(|k| number(child[k])))),
        3 => out.extend(TRIANGLES.iter().map(|child| std::array::from_fn(|k| number(child[k])))),
        _ => out.extend(TETRAHEDRA.iter().map(|child| std::array::from_fn(|k| number(child[k])))),
    }
}

/// Refines all cells.
///
/// # Errors
/// [`MeshError::TooManyNodes`], and [`MeshError::Folded`] if a curve puts a node so far away that an element turns
/// inside out.
pub fn refine<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
) -> Result<Refined<D, V>, MeshError> {
    refine_edges(mesh, &Edges::new(mesh.points.len(), &mesh.cells))
}

/// As [`refine`], for a mesh whose edges are known.
pub(super) fn refine_edges<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    edges: &Edges,
) -> Result<Refined<D, V>, MeshError> {
    let children = 1 << D;
    let entries = mesh.cells.len() * V * (V - 1) / 2;
    if mesh.points.len() + entries > u32::MAX as usize / 2 {
        return Err(MeshError::TooManyNodes { cells: children * mesh.cells.len() });
    }
    let (old, parents) = (mesh.points.len(), edges.ends());
    let mut points = Vec::with_capacity(old + parents.len());
    points.extend_from_slice(&mesh.points);
    points.extend(parents.iter().map(|&[a, b]| {
        let [a, b] = [mesh.points[a as usize], mesh.points[b as usize]];
        std::array::from_fn(|d| 0.5 * (a[d] + b[d]))
    }));
    mesh.put_on_curves(edges, &mut points);
    let count = children * mesh.cells.len();
    let (mut cells, mut regions) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for (number, (cell, &region)) in mesh.cells.iter().zip(&mesh.regions).enumerate() {
        split(*cell, |ends| old + edges.of_cell::<V>(number, ends), &mut cells);
        regions.resize(cells.len(), region);
    }
    let mut elements = Vec::new();
    if mesh.is_curved() {
        check_orientation(mesh, &points, &cells)?;
        elements.extend(
            mesh.elements.iter().flat_map(|&element| std::iter::repeat_n(element, children)),
        );
    }
    let mut facets = Vec::with_capacity((children / 2) * mesh.facets.len());
    let mut pieces = Vec::new();
    for facet in &mesh.facets {
        pieces.clear();
        let nodes = facet.nodes;
        split(nodes, |[a, b]| old + edges.between(nodes[a], nodes[b]), &mut pieces);
        facets.extend(pieces.iter().map(|&nodes| Facet { nodes, part: facet.part }));
    }
    let refined = Mesh {
        points,
        cells,
        elements,
        regions,
        region_names: mesh.region_names.clone(),
        k: mesh.k.clone(),
        reaction: mesh.reaction,
        facets,
        parts: mesh.parts.clone(),
        values: mesh.values.clone(),
        inside: mesh.inside.clone(),
        touching: mesh.touching.clone(),
        moved: mesh.moved.clone(),
        origin: mesh.origin,
    };
    Ok(Refined { mesh: refined, parents })
}

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Moves the midpoints of edges of curved parts onto the curves.
    fn put_on_curves(&self, edges: &Edges, points: &mut [[f64; D]]) {
        for CurvedEdge { ends, course } in self.curved_edges() {
            let edge = edges.between(ends[0], ends[1]);
            points[self.points.len() + edge] =
                course.middle(ends.map(|node| self.points[node as usize]));
        }
    }
}

/// Checks that each child has the orientation that it would have without curves, and a volume.
fn check_orientation<const D: usize, const V: usize>(
    coarse: &Mesh<D, V>,
    points: &[[f64; D]],
    cells: &[[u32; V]],
) -> Result<(), MeshError> {
    let children = 1 << D;
    for (k, (parent, children)) in coarse.cells.iter().zip(cells.chunks(children)).enumerate() {
        let vertices = coarse.vertices(parent);
        let parent = Element::new(vertices);
        for (child, nodes) in children.iter().enumerate() {
            let expected = parent.is_mirrored != is_mirrored_child(V, child);
            coarse.check_piece(k, nodes.map(|node| points[node as usize]), expected)?;
        }
    }
    Ok(())
}

/// True if the vertices of a child are numbered in the other sense than those of its parent.
fn is_mirrored_child(vertices: usize, child: usize) -> bool {
    vertices == 4 && [5, 7].contains(&child)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AnyMesh, BuiltIn, MeshData, Round, sorted};

    #[test]
    fn children_fill_their_parent_and_have_the_expected_orientation() {
        let coarse = Element::<3, 4>::new(TETRAHEDRON);
        for (k, child) in TETRAHEDRA.iter().enumerate() {
            let vertices = child.map(|[a, b]| {
                std::array::from_fn(|d| 0.5 * (TETRAHEDRON[a][d] + TETRAHEDRON[b][d]))
            });
            let child = Element::<3, 4>::new(vertices);
            assert!((child.volume - coarse.volume / 8.0).abs() < 1e-15);
            assert_eq!(child.is_mirrored, is_mirrored_child(4, k) != coarse.is_mirrored, "{k}");
        }
    }

    const TETRAHEDRON: [[f64; 3]; 4] =
        [[0.0, 0.1, 0.0], [1.0, 0.0, 0.2], [0.1, 1.0, 0.0], [0.0, 0.3, 1.0]];

    /// Checks that all positive cells of a mesh and its refinements have a positive volume, and fill the domain.
    fn cells_are_positive<const D: usize, const V: usize>(mut mesh: Mesh<D, V>) {
        mesh.parts.iter_mut().for_each(|part| part.curve = None);
        let volume = mesh.volume();
        for times in 0..4 {
            let mut sum = 0.0;
            for cell in mesh.positive_cells() {
                let element = Element::<D, V>::new(mesh.vertices(&cell));
                assert!(!element.is_mirrored && element.volume > 0.0);
                sum += element.volume;
            }
            assert!((sum / volume - 1.0).abs() < 1e-12, "{times}");
            if mesh.cells.len() < 5000 {
                mesh = refine(&mesh).unwrap().mesh;
            }
        }
    }

    #[test]
    fn other_programs_are_given_cells_of_positive_volume() {
        for (_, domain) in crate::mesh::BUILT_IN {
            domain.plane().into_iter().for_each(cells_are_positive);
            domain.space().into_iter().for_each(cells_are_positive);
        }
        for file in [
            &include_bytes!("../../../../tests/meshes/gear.msh")[..],
            include_bytes!("../../../../tests/meshes/notch.msh"),
            include_bytes!("../../../../tests/meshes/tetrahedron-22.msh"),
        ] {
            match crate::mesh::gmsh::read(file).unwrap() {
                AnyMesh::Plane(mesh) => cells_are_positive(mesh),
                AnyMesh::Space(mesh) => cells_are_positive(mesh),
            }
        }
    }

    #[test]
    fn a_tetrahedron_in_the_other_sense_has_the_same_refinements() {
        let data = |cell| MeshData::<3, 4> {
            points: TETRAHEDRON.to_vec(),
            cells: vec![cell],
            ..MeshData::default()
        };
        // All orders that leave the same two pairs of vertices opposite to each other.
        for cell in [[0, 1, 2, 3], [0, 3, 2, 1], [2, 1, 0, 3], [1, 2, 3, 0], [1, 0, 3, 2]] {
            let (mut one, mut two) =
                (data([0, 1, 2, 3]).mesh().unwrap(), data(cell).mesh().unwrap());
            for _ in 0..3 {
                one = refine(&one).unwrap().mesh;
                two = refine(&two).unwrap().mesh;
                let [a, b] = [&one, &two].map(|mesh| {
                    let mut cells: Vec<_> = mesh.cells.iter().copied().map(sorted).collect();
                    cells.sort_unstable();
                    (mesh.points.clone(), cells)
                });
                assert_eq!(a, b);
            }
        }
    }

    #[test]
    fn the_disc_and_the_ball_fill_up() {
        let mut disc = BuiltIn::Disc.plane().unwrap();
        let mut ball = BuiltIn::Ball.space().unwrap();
        for _ in 0..4 {
            disc = refine(&disc).unwrap().mesh;
            ball = refine(&ball).unwrap().mesh;
        }
        assert!((disc.volume() / std::f64::consts::PI - 1.0).abs() < 2e-3);
        assert!((ball.volume() / (4.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 6e-3);
    }

    #[test]
    fn a_curve_that_is_too_far_away_is_refused_with_the_element() {
        let mut disc = BuiltIn::Disc.plane().unwrap();
        disc.parts_mut()[0].curve = Some(Round::sphere([0.0; 2], 0.1));
        assert_eq!(
            refine(&disc).err().unwrap().to_string(),
            "element 0 turns inside out, or a piece of it, when the new nodes of part `rim` are put on its curve; \
             begin with a finer mesh there"
        );
        let refused = MeshError::TooManyNodes { cells: 1 << 40 }.to_string();
        assert_eq!(refused, "1099511627776 elements are more than 32 bits number; refine less");
    }
}
