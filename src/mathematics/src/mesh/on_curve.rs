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
        let parts = self.parts_named(name)?;
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
mod tests {
    use crate::mesh::{AnyMesh, Condition, Facet, MeshData, Names, Part, SpaceMesh};
    use std::f64::consts::{FRAC_PI_6, PI, TAU};

    /// Radius of the rim of the caps of height 1/2 of the unit ball.
    const RIM: f64 = 0.8660254037844386;

    /// Rim nodes at this height, behind a node of the axis.
    fn ring(radius: f64, z: f64) -> Vec<[f64; 3]> {
        let rim = (0..6).map(|k| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(k) / 6.0);
            [radius * cosine, radius * sine, z]
        });
        std::iter::once([0.0, 0.0, z]).chain(rim).collect()
    }

    fn named(name: &str) -> Part<3> {
        Part { names: Names::from(name), condition: Condition::Contact, curve: None }
    }

    /// Facets between a pole and the rim, whose nodes are 1 to 6.
    fn fan(pole: u32, part: u16) -> impl Iterator<Item = Facet<3>> {
        (0..6).map(move |k| Facet { nodes: [pole, 1 + k, 1 + (k + 1) % 6], part })
    }

    /// Cells between two poles and the rim.
    fn cells(poles: [u32; 2]) -> impl Iterator<Item = [u32; 4]> {
        (0..6).map(move |k| [poles[0], poles[1], 1 + k, 1 + (k + 1) % 6])
    }

    /// Cap of the unit ball on a plane or, if a second pole is given, on another surface.
    fn on_rim(radius: f64, z: f64, top: f64, bottom: Option<f64>) -> SpaceMesh {
        let mut points = ring(radius, z);
        points.push([0.0, 0.0, top]);
        let mut all: Vec<_> = cells([0, 7]).collect();
        if let Some(bottom) = bottom {
            points.push([0.0, 0.0, bottom]);
            all.extend(cells([8, 0]));
        }
        let facets = fan(7, 0).chain(fan(if bottom.is_some() { 8 } else { 0 }, 1)).collect();
        let parts = vec![named("top"), named("bottom")];
        MeshData { points, cells: all, facets, parts, ..MeshData::default() }.mesh().unwrap()
    }

    /// Checks that the volume of refinements goes to this one, by a quarter of the error each time.
    fn fills(mut mesh: SpaceMesh, volume: f64) {
        let mut errors = Vec::new();
        for _ in 0..4 {
            mesh = crate::mesh::refine(&mesh).unwrap().mesh;
            errors.push((mesh.volume() - volume).abs());
        }
        assert!(errors[3] < 0.01 * volume && errors[3] < 0.3 * errors[2], "{errors:?} {volume}");
    }

    fn curved(mesh: SpaceMesh, curves: &[(&str, &[f64])]) -> SpaceMesh {
        let mut mesh = AnyMesh::from(mesh);
        curves.iter().for_each(|(part, curve)| mesh.set_curve(part, curve).unwrap());
        assert_eq!(mesh.notes(), [""; 0]);
        let AnyMesh::Space(mesh) = mesh else { panic!("a mesh in space") };
        mesh
    }

    const CAP: f64 = PI * 0.25 * 2.5 / 3.0;

    #[test]
    fn the_rim_of_a_cap_stays_in_the_plane_of_its_base() {
        let cap = curved(on_rim(RIM, 0.5, 1.0, None), &[("top", &[0.0, 0.0, 0.0, 1.0])]);
        let fine = crate::mesh::refine(&crate::mesh::refine(&cap).unwrap().mesh).unwrap().mesh;
        assert!(fine.points().iter().all(|point| point[2] > 0.5 - 1e-12));
        fills(cap, CAP);
    }

    #[test]
    fn the_rim_between_two_spheres_lies_on_both() {
        let lens = on_rim(RIM, 0.0, 0.5, Some(-0.5));
        let curves: [(&str, &[f64]); 2] =
            [("top", &[0.0, 0.0, -0.5, 1.0]), ("bottom", &[0.0, 0.0, 0.5, 1.0])];
        fills(curved(lens, &curves), 2.0 * CAP);
    }

    #[test]
    fn a_hemisphere_on_a_cylinder_keeps_the_circle_between_them() {
        let mut points = ring(1.0, 0.0);
        points.push([0.0, 0.0, 1.0]);
        points.extend(ring(1.0, -1.0));
        let mut all: Vec<_> = cells([0, 7]).collect();
        let mut facets: Vec<_> = fan(7, 0).collect();
        for k in 0..6 {
            let mut base = [0, 1 + k, 1 + (k + 1) % 6];
            base.sort_unstable();
            let ([i, j, l], below) = (base, base.map(|node| node + 8));
            all.extend([
                [i, j, l, below[2]],
                [i, j, below[1], below[2]],
                [i, below[0], below[1], below[2]],
            ]);
            facets.extend([
                Facet { nodes: [j, l, below[2]], part: 1 },
                Facet { nodes: [j, below[1], below[2]], part: 1 },
            ]);
        }
        let parts = vec![named("top"), named("side")];
        let mesh = MeshData { points, cells: all, facets, parts, ..MeshData::default() };
        let side: &[f64] = &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0];
        let curves: [(&str, &[f64]); 2] = [("top", &[0.0, 0.0, 0.0, 1.0]), ("side", side)];
        fills(curved(mesh.mesh().unwrap(), &curves), 4.0 * FRAC_PI_6 + PI);
    }

    #[test]
    fn what_lies_beyond_a_cap_is_added_in_the_plane_of_its_base() {
        use crate::mesh::{curve_gains, refine};
        use crate::problem::source::Source;
        let cap = curved(on_rim(RIM, 0.5, 1.0, None), &[("top", &[0.0, 0.0, 0.0, 1.0])]);
        let mesh = refine(&refine(&cap).unwrap().mesh).unwrap().mesh;
        let gains = curve_gains(&mesh, &Source::<3>::constant(1.0));
        let volume = mesh.volume() + gains.iter().map(|gain| gain.integral).sum::<f64>();
        assert!((volume / CAP - 1.0).abs() < 5e-3, "{volume} {CAP}");
        let base: f64 = mesh
            .facets()
            .iter()
            .filter(|facet| facet.part == 1)
            .map(|facet| crate::mesh::measure(mesh.corners(facet)))
            .sum();
        let at_base = gains.iter().filter(|gain| mesh.facets()[gain.facet].part == 1);
        let with_gains = base + at_base.map(|gain| gain.measure).sum::<f64>();
        // What the pieces between the halvings miss is a small part of what the base misses.
        assert!((with_gains - 0.75 * PI).abs() < 0.1 * (0.75 * PI - base), "{base} {with_gains}");
    }

    #[test]
    fn an_edge_beside_facets_of_an_unknown_curve_stays_straight_and_is_told() {
        let mut mesh = AnyMesh::from(on_rim(RIM, 0.0, 0.5, Some(-0.2)));
        mesh.set_curve("top", &[0.0, 0.0, -0.5, 1.0]).unwrap();
        let notes = mesh.notes();
        assert!(notes.len() == 1 && notes[0].contains("top, bottom stay straight"), "{notes:?}");
    }

    #[test]
    fn nodes_beside_their_curve_are_moved_onto_it_and_told() {
        // The digits of the file end at the fourth place.
        let mut mesh = AnyMesh::from(on_rim(0.8660, 0.5, 1.0, None));
        mesh.set_curve("top", &[0.0, 0.0, 0.0, 1.0]).unwrap();
        let notes = mesh.notes();
        assert!(
            notes.len() == 1 && notes[0].contains("`top` are moved onto its curve"),
            "{notes:?}"
        );
        let AnyMesh::Space(mesh) = mesh else { panic!("a mesh in space") };
        for rim in &mesh.points()[1..7] {
            let radius = (rim[0] * rim[0] + rim[1] * rim[1]).sqrt();
            assert!((radius - RIM).abs() < 1e-12 && (rim[2] - 0.5).abs() < 1e-12, "{rim:?}");
        }
        let mut far = AnyMesh::from(on_rim(0.865, 0.5, 1.0, None));
        let said = far.set_curve("top", &[0.0, 0.0, 0.0, 1.0]).unwrap_err();
        assert!(said.contains("is off its curve by"), "{said}");
    }
}
