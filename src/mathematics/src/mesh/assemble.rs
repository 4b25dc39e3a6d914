//! The discrete problem of a triangulation: stiffness matrix (5) as couplings, load vector (6), parts of the boundary.

use super::geometry::measure;
use super::{Edges, Element, Facet, Mesh, MeshError, Sides};
use crate::discrete::network::{Coupling, Network};
use crate::discrete::quadrature::facet_points;
use crate::problem::law::{Conditions, ContactNode, Law, LawSum};
use crate::problem::text::Written;
use std::collections::BTreeMap;

/// Coupling over the least diagonal of its nodes below which it is the rounding error of a right angle.
const RIGHT_ANGLE: f64 = 1e-14;

/// Returns the discrete problem for linear elements. Contact nodes are in the order of their numbers; a node where
/// parts meet has the sum of their laws: it is fixed if one of them is, else in contact if one of them is. The flux of
/// free parts is part of the load.
///
/// # Panics
/// If there are more couplings than 32 bits number.
pub fn assemble<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> Network {
    assemble_edges(mesh, &Edges::new(mesh.points.len(), &mesh.cells))
}

/// As [`assemble`], for a mesh whose edges are known.
pub(super) fn assemble_edges<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    edges: &Edges,
) -> Network {
    assemble_with(
        mesh,
        edges.len(),
        |cell, ends| edges.of_cell::<V>(cell, ends),
        |cell| mesh.k(cell),
    )
    .with_reaction(mesh.reaction)
}

/// As [`assemble`], for a mesh whose sides are known.
pub(crate) fn assemble_sides<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    sides: &Sides<V>,
) -> Network {
    assemble_of_sides(mesh, sides, |cell| mesh.k(cell)).with_reaction(mesh.reaction)
}

/// As [`assemble_sides`] without a reaction, with 1/k in place of k: the products of circulations around the nodes of a
/// mesh in the plane.
pub(crate) fn assemble_inverse<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    sides: &Sides<V>,
) -> Network {
    assemble_of_sides(mesh, sides, |cell| 1.0 / mesh.k(cell))
}

fn assemble_of_sides<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    sides: &Sides<V>,
    factor: impl Fn(usize) -> f64,
) -> Network {
    assemble_with(mesh, sides.edges(), |cell, ends| sides.edge(cell as u32, ends), factor)
}

/// Returns the discrete problem with the couplings that are no rounding errors; `edge` is the number of the edge
/// between two vertices of a cell, the later one second, and `factor` that of its couplings.
fn assemble_with<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    edges: usize,
    edge: impl Fn(usize, [usize; 2]) -> usize,
    factor: impl Fn(usize) -> f64,
) -> Network {
    let mut masses = vec![0.0; mesh.points.len()];
    let (mut ends, mut weights) = (vec![[0; 2]; edges], vec![0.0f64; edges]);
    for (number, cell) in mesh.cells.iter().enumerate() {
        let (element, factor) = (Element::new(mesh.vertices(cell)), factor(number));
        for j in 0..V {
            masses[cell[j] as usize] += element.volume / V as f64;
            for i in 0..j {
                let edge = edge(number, [i, j]);
                ends[edge] = [cell[i].min(cell[j]), cell[i].max(cell[j])];
                weights[edge] -= factor * element.stiffness(i, j);
            }
        }
    }
    let mut diagonal = vec![0.0f64; masses.len()];
    for (nodes, weight) in ends.iter().zip(&weights) {
        nodes.iter().for_each(|&node| diagonal[node as usize] += weight.abs());
    }
    let mut couplings = Vec::with_capacity(ends.len());
    for (nodes, weight) in ends.into_iter().zip(weights) {
        let least = nodes.map(|node| diagonal[node as usize]).into_iter().fold(f64::MAX, f64::min);
        if weight.abs() > RIGHT_ANGLE * least {
            couplings.push(Coupling { nodes, weight });
        }
    }
    let nodes = boundary_nodes(mesh);
    let potential = potential_at(mesh, &nodes);
    Network::new(&couplings, nodes, masses).with_potential(potential)
}

/// Checks that formulas of laws have values of a size with which all solvers compute at the nodes of their facets and
/// at points between them.
///
/// # Errors
/// [`MeshError::Value`].
pub(crate) fn check_values<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
) -> Result<(), MeshError> {
    let between = facet_points::<D>();
    for (part, formula) in &mesh.values {
        let (law, mut largest) = (mesh.parts[usize::from(*part)].law, 0.0f64);
        let refused = |reason| {
            let part = mesh.parts[usize::from(*part)].names.to_string();
            Err(MeshError::Value { part, reason })
        };
        for facet in mesh.facets.iter().filter(|facet| facet.part == *part) {
            let corners = mesh.corners(facet);
            for point in corners.into_iter().chain(between.iter().map(|of| of.within(corners))) {
                let value = formula.at(&point);
                if !value.is_finite() {
                    let at = point.map(|x| Written(x).to_string()).join(", ");
                    return refused(format!(
                        "{formula} has no value at ({at}); write a formula that has one on the whole part"
                    ));
                }
                largest = largest.max(value.abs());
            }
        }
        let sized = if law.is_free() { Law::free(largest) } else { law.with_at(largest) };
        sized.map(drop).or_else(|error| refused(error.to_string()))?;
    }
    Ok(())
}

/// Checks that parts of the boundary which meet have laws that one function can have; see [`Law::meet`].
///
/// # Errors
/// [`MeshError::Meeting`], and as [`check_values`].
pub(crate) fn check_meetings<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
) -> Result<(), MeshError> {
    check_values(mesh)?;
    let mut parts: BTreeMap<u32, BTreeMap<u16, &Facet<D>>> = BTreeMap::new();
    let nodes = mesh.facets.iter().flat_map(|facet| facet.nodes.map(|node| (facet, node)));
    let largest =
        nodes.fold(0.0f64, |most, (facet, node)| most.max(mesh.law_at(facet, node).at().abs()));
    for facet in mesh.facets.iter().filter(|facet| !mesh.law(facet).is_free()) {
        for node in facet.nodes {
            let others = parts.entry(node).or_default();
            for other in others.values() {
                let mut pair = [*other, facet];
                pair.sort_by_key(|facet| facet.part);
                let laws = pair.map(|facet| mesh.law_at(facet, node));
                if laws[0].meet(laws[1], largest).is_none() {
                    let point = mesh.points[node as usize].map(|x| Written(x).to_string());
                    let [one, two] = [0, 1].map(|k| {
                        let names = &mesh.parts[usize::from(pair[k].part)].names;
                        format!("{names}, where {},", Conditions { law: laws[k], formula: None })
                    });
                    return Err(MeshError::Meeting { one, two, at: point.join(", ") });
                }
            }
            others.insert(facet.part, facet);
        }
    }
    Ok(())
}

/// Returns the nodes with a law, in the order of their numbers: each has the sum of the laws of its facets.
fn boundary_nodes<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> Vec<ContactNode> {
    const NONE: u32 = u32::MAX;
    let (mut places, mut sums) = (vec![NONE; mesh.points.len()], Vec::new());
    for facet in mesh.facets.iter().filter(|facet| !mesh.law(facet).is_free()) {
        let share = measure(mesh.corners(facet)) / D as f64;
        for node in facet.nodes {
            let place = &mut places[node as usize];
            if *place == NONE {
                *place = sums.len() as u32;
                sums.push((node, LawSum::default()));
            }
            sums[*place as usize].1.add(mesh.law_at(facet, node), share);
        }
    }
    sums.sort_unstable_by_key(|(node, _)| *node);
    sums.into_iter().map(|(node, laws)| laws.at_node(node as usize)).collect()
}

/// Returns the sum of j over the facets with a law, the nodes at their values: a facet whose value is not that of its
/// node has a potential there that the law of the node, which begins at its value, lacks.
fn potential_at<const D: usize, const V: usize>(mesh: &Mesh<D, V>, nodes: &[ContactNode]) -> f64 {
    let mut potential = 0.0;
    for facet in mesh.facets.iter().filter(|facet| !mesh.law(facet).is_free()) {
        let share = measure(mesh.corners(facet)) / D as f64;
        for node in facet.nodes {
            let law = mesh.law_at(facet, node);
            let place = nodes.binary_search_by_key(&(node as usize), |of| of.node);
            let at = nodes[place.expect("a node of a facet with a law")].law.at();
            if at != law.at() {
                potential += share * law.potential(at);
            }
        }
    }
    potential
}
