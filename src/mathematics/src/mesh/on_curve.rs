//! Nodes of a file that lie beside the curve of their part: they are moved onto it, since the curve is the domain.

use super::surface::{FacetsAtNodes, Surface, common_point};
use super::{Element, Mesh, Round, geometry};
use crate::problem::text::plain;

/// Distance of a node from the curve of its part, over the radius, that is taken for the digits of a file.
const DIGITS: f64 = 1e-4;
/// Way of a node onto the surfaces of all facets around it, over the distance that is allowed.
const MOST_WAY: f64 = 3.0;
/// Such distance that is not told.
const UNTOLD: f64 = 1e-9;

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Puts the facets of this name on a curve, and their nodes as well. A node that belongs to other parts, too, goes
    /// to the curves of all, along the facets of those without one.
    ///
    /// # Errors
    /// A sentence if no facets have this name, some are on another curve already, a node is farther off the curve than
    /// the digits of a file explain, or an element turns inside out.
    pub(super) fn set_curve(&mut self, name: &str, curve: Round<D>) -> Result<(), String> {
        let inside = "borders of regions are straight edges; write a disc or ball in f in place of a round region";
        let parts = self.parts_named(name, inside)?;
        let mut nodes = Vec::new();
        for facet in self.facets.iter().filter(|facet| parts.contains(&usize::from(facet.part))) {
            nodes.extend(facet.nodes);
        }
        nodes.sort_unstable();
        nodes.dedup();
        let distances = nodes.iter().map(|&node| curve.distance(self.points[node as usize]));
        let farthest = distances.fold(0.0, f64::max);
        // A NaN is refused as well.
        if !nodes
            .iter()
            .all(|&node| curve.distance(self.points[node as usize]) <= DIGITS * curve.radius)
        {
            let distance = plain(farthest, 3);
            return Err(format!(
                "part `{name}` is off its curve by {distance}; give the curve on which its nodes lie"
            ));
        }
        for part in parts {
            let part = &mut self.parts[part];
            if part.curve.is_some_and(|other| other != curve) {
                let names = &part.names;
                return Err(format!(
                    "facets named {names} lie on another curve already; leave one of the two out"
                ));
            }
            part.curve = Some(curve);
        }
        let longest = self.move_onto_curves(name, &nodes, curve.radius)?;
        if longest > UNTOLD * curve.radius {
            let way = plain(longest, 2);
            self.moved.push(format!(
                "the nodes of part `{name}` are moved onto its curve, by up to {way}"
            ));
        }
        Ok(())
    }

    /// Moves nodes onto the curves of their parts; returns the longest way.
    fn move_onto_curves(&mut self, name: &str, nodes: &[u32], radius: f64) -> Result<f64, String> {
        let at_nodes = FacetsAtNodes::of(self);
        let (mut points, mut longest) = (self.points.clone(), 0.0f64);
        for &node in nodes {
            let point = &mut points[node as usize];
            let (curves, planes) = self.surfaces_at(&at_nodes, node);
            if curves.iter().all(|curve| curve.contains(*point, 0.0)) {
                continue;
            }
            let all = [&curves[..], &planes[..]].concat();
            let reach = MOST_WAY * DIGITS * radius;
            let found =
                common_point(&all, *point, reach).or_else(|| common_point(&curves, *point, reach));
            let found = found.ok_or_else(|| {
                format!("the curves of the parts that meet `{name}` do not meet where its nodes lie; give these curves")
            })?;
            let way = geometry::difference(found, *point);
            longest = longest.max(geometry::dot(way, way).sqrt());
            *point = found;
        }
        if longest > 0.0 {
            self.check_moved(name, &points, longest)?;
            self.points = points;
        }
        Ok(longest)
    }

    /// Curves of the facets at a node, each once, and the planes of those without one.
    fn surfaces_at(
        &self,
        at_nodes: &FacetsAtNodes,
        node: u32,
    ) -> (Vec<Surface<D>>, Vec<Surface<D>>) {
        let (mut curves, mut planes) = (Vec::new(), Vec::new());
        for facet in at_nodes.at(node).map(|number| &self.facets[number]) {
            match self.curve_of(facet).map(Surface::Round) {
                Some(curve) if !curves.contains(&curve) => curves.push(curve),
                Some(_) => {}
                None => planes.extend(Surface::plane(self.corners(facet))),
            }
        }
        (curves, planes)
    }

    /// Checks that no cell turns inside out when the nodes are moved to these points.
    fn check_moved(&self, name: &str, points: &[[f64; D]], way: f64) -> Result<(), String> {
        for (number, cell) in self.cells.iter().enumerate() {
            let is_mirrored = Element::new(self.vertices(cell)).is_mirrored;
            let moved = cell.map(|node| points[node as usize]);
            self.check_piece(number, moved, is_mirrored).map_err(|_| {
                let (element, way) = (self.elements[number], plain(way, 2));
                format!(
                    "the nodes of part `{name}` lie off its curve by up to {way}, and element {element} turns inside \
                     out when they are moved onto it; give the curve on which they lie"
                )
            })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
