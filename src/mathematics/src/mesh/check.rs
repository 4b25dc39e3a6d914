//! Checks of a triangulation that comes from outside.

use super::error::MeshError;
use super::facets::{BoundaryFacets, sorted};
use super::geometry::{Element, size};
use super::{Mesh, MeshData, MeshOrigin, Tags};

/// Volume of an element over the power of its longest edge, below which it is flat.
const FLAT: f64 = 1e-10;

/// True if an element has next to no volume, or one that is not finite.
pub(super) fn flat<const D: usize, const V: usize>(
    element: &Element<D, V>,
    vertices: [[f64; D]; V],
) -> bool {
    let scale = size(vertices).powi(D as i32);
    // Written so that NaN is flat.
    !(element.volume > FLAT * scale && element.volume.is_finite())
}

impl<const D: usize, const V: usize> MeshData<D, V> {
    /// Checks the data, and finds the boundary.
    ///
    /// # Errors
    /// The first fault found, as [`MeshError`].
    pub fn mesh(self) -> Result<Mesh<D, V>, MeshError> {
        self.checked(true)
    }

    /// Mesh whose cells are known to neither overlap nor hang on each other.
    pub(super) fn lattice(self) -> Mesh<D, V> {
        self.checked(false).expect("a uniform mesh passes the checks")
    }

    fn checked(mut self, may_overlap: bool) -> Result<Mesh<D, V>, MeshError> {
        if self.cells.is_empty() {
            let [cells, domain] =
                if D == 3 { ["tetrahedra", "volume"] } else { ["triangles", "area"] };
            return Err(MeshError::NoCells { cells, domain });
        }
        if self.points.len().max(self.cells.len()) > u32::MAX as usize / 16 {
            return Err(MeshError::TooManyNodes { cells: self.cells.len() });
        }
        self.check_points()?;
        self.turn_cells()?;
        self.check_positions()?;
        self.check_regions()?;
        let mut boundary = self.boundary()?;
        let mut meshed_apart = None;
        if may_overlap {
            self.check_overlap(&boundary)?;
            meshed_apart = self.check_hanging(&boundary)?;
        }
        self.part_pinched(&mut boundary);
        let touching = self.touching(&boundary).map(|touching| touching.to_string());
        if self.regions.is_empty() {
            self.region_names = vec!["domain".into()];
            self.regions = vec![0; self.cells.len()];
        }
        let mesh = Mesh {
            points: self.points,
            elements: (0..self.cells.len()).map(|cell| self.tags.cell(cell)).collect(),
            cells: self.cells,
            regions: self.regions,
            k: vec![1.0; self.region_names.len()],
            region_names: self.region_names,
            reaction: 0.0,
            facets: boundary.facets,
            parts: self.parts,
            values: Vec::new(),
            inside: boundary.inside,
            touching: touching.into_iter().chain(meshed_apart).collect(),
            moved: Vec::new(),
            origin: MeshOrigin::default(),
        };
        Ok(mesh)
    }

    fn check_points(&self) -> Result<(), MeshError> {
        match self.points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            Some(node) => Err(MeshError::Coordinate(self.tags.node(node))),
            None => Ok(()),
        }
    }

    /// Checks the cells, and turns those that are numbered in the negative sense.
    fn turn_cells(&mut self) -> Result<(), MeshError> {
        let mut used = vec![false; self.points.len()];
        for (k, cell) in self.cells.iter_mut().enumerate() {
            let tag = self.tags.cell(k);
            for &node in cell.iter() {
                let Some(used) = used.get_mut(node as usize) else {
                    return Err(MeshError::MissingNode { cell: tag, node: node.into() });
                };
                *used = true;
            }
            let vertices = cell.map(|node| self.points[node as usize]);
            let element = Element::new(vertices);
            if flat(&element, vertices) {
                return Err(MeshError::Flat(tag));
            }
            if element.is_mirrored {
                *cell = turned(*cell);
            }
        }
        match used.iter().position(|used| !used) {
            Some(node) => Err(MeshError::Unused(self.tags.node(node))),
            None => Ok(()),
        }
    }

    /// Checks the parts and regions that facets and cells refer to.
    fn check_positions(&self) -> Result<(), MeshError> {
        let (parts, names) = (self.parts.len(), self.region_names.len());
        if let Some(facet) = self.facets.iter().find(|facet| usize::from(facet.part) >= parts) {
            let nodes = self.tags.all(facet.nodes);
            return Err(MeshError::MissingPart { nodes, part: facet.part, parts });
        }
        let regions = self.regions.len();
        if ![0, self.cells.len()].contains(&regions) {
            return Err(MeshError::RegionCount { regions, cells: self.cells.len() });
        }
        match self.regions.iter().position(|&region| usize::from(region) >= names) {
            Some(k) => {
                let (cell, region) = (self.tags.cell(k), self.regions[k]);
                Err(MeshError::MissingRegion { cell, region, regions: names })
            }
            None => Ok(()),
        }
    }

    fn check_regions(&self) -> Result<(), MeshError> {
        let mut is_used = vec![false; self.region_names.len()];
        self.regions.iter().for_each(|&region| is_used[region as usize] = true);
        match is_used.iter().position(|used| !used) {
            Some(k) => Err(MeshError::EmptyName(self.region_names[k].to_string())),
            None => Ok(()),
        }
    }

    fn check_overlap(&self, boundary: &BoundaryFacets<D>) -> Result<(), MeshError> {
        let Some(cells) = self.overlap(boundary) else { return Ok(()) };
        let [one, two] = sorted(cells).map(|cell| self.tags.cell(cell as usize));
        Err(MeshError::Overlaid { one, two, domains: domains::<D>() })
    }
}

/// Word for the domains of which Gmsh meshes the cells.
pub(super) fn domains<const D: usize>() -> &'static str {
    if D == 3 { "volumes" } else { "surfaces" }
}

/// Returns a cell with its vertices in the other sense, from the same one on. Refinement cuts both into the same
/// children.
pub(super) fn turned<const V: usize>(mut cell: [u32; V]) -> [u32; V] {
    cell.swap(1, V - 1);
    cell
}

impl Tags {
    /// Number of a node.
    pub(super) fn node(&self, node: usize) -> u64 {
        self.nodes.get(node).copied().unwrap_or(node as u64)
    }

    /// Number of a cell.
    pub(super) fn cell(&self, cell: usize) -> u64 {
        self.cells.get(cell).copied().unwrap_or(cell as u64)
    }

    /// Numbers of some nodes.
    pub(super) fn all<const K: usize>(&self, nodes: [u32; K]) -> Vec<u64> {
        nodes.iter().map(|&node| self.node(node as usize)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Facet, Part};
    use crate::problem::law::Law;

    /// The unit square: two triangles, the lower edge named `south`; nodes from 11 on, cells from 21 on.
    fn square() -> MeshData<2, 3> {
        MeshData {
            points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            cells: vec![[0, 1, 2], [0, 2, 3]],
            facets: vec![Facet { nodes: [1, 0], part: 0 }],
            parts: vec![part("south")],
            tags: Tags { nodes: (11..).take(5).collect(), cells: (21..).take(4).collect() },
            ..MeshData::default()
        }
    }

    fn part<const D: usize>(name: &str) -> Part<D> {
        Part { names: name.into(), law: Law::SIGNORINI, curve: None }
    }

    fn message<const D: usize, const V: usize>(data: MeshData<D, V>) -> String {
        data.mesh().unwrap_err().to_string()
    }

    /// Message for the square after a change.
    fn after(change: impl FnOnce(&mut MeshData<2, 3>)) -> String {
        let mut data = square();
        change(&mut data);
        message(data)
    }

    #[test]
    fn the_square_passes_with_unnamed_edges_in_the_part_boundary() {
        let mesh = square().mesh().unwrap();
        let names: Vec<String> = mesh.parts().iter().map(|part| part.names.to_string()).collect();
        assert_eq!(names, ["south", "boundary"]);
        let parts: Vec<_> = mesh.facets().iter().map(|facet| (facet.nodes, facet.part)).collect();
        // Each edge runs in the sense of its triangle, with the domain on the left.
        assert_eq!(parts, [([1, 2], 1), ([0, 1], 0), ([2, 3], 1), ([3, 0], 1)]);
        // Whether a condition on `boundary` is one on a part of that name or on the unnamed edges could not be told.
        let named = MeshData { parts: vec![part("boundary")], ..square() }.mesh();
        assert_eq!(named, Err(MeshError::NameOfDefault("boundary")));
        // The sense in which a cell is numbered does not matter.
        for cells in [[[0, 2, 1], [0, 3, 2]], [[0, 2, 1], [0, 2, 3]], [[0, 1, 2], [0, 3, 2]]] {
            let mesh = MeshData { cells: cells.into(), ..square() }.mesh();
            assert_eq!(mesh, square().mesh());
        }
    }

    #[test]
    fn bad_elements_are_named() {
        assert_eq!(
            message(MeshData::<2, 3>::default()),
            "the mesh has no triangles; mesh the area itself, not only its boundary"
        );
        assert_eq!(
            message(MeshData::<3, 4>::default()),
            "the mesh has no tetrahedra; mesh the volume itself, not only its boundary"
        );
        assert_eq!(
            after(|data| data.points[3][1] = f64::NAN),
            "node 14 has a coordinate that is no finite number"
        );
        assert_eq!(
            after(|data| data.cells[1][1] = 7),
            "element 22 names node 7, which is not in the mesh"
        );
        assert_eq!(
            after(|data| data.points[3] = [0.5, 0.5]),
            "element 22 is flat: its vertices lie in a line or plane; move one of them, or mesh again"
        );
        assert_eq!(
            after(|data| data.points.push([2.0, 2.0])),
            "node 15 belongs to no element; save the mesh without unused nodes"
        );
    }

    #[test]
    fn cells_that_overlap_or_hang_on_another_are_named() {
        assert_eq!(
            after(|data| data.cells.push([0, 1, 2])),
            "elements 21 and 23 overlap: both lie on one side of their facet [12, 13]; remove what is there twice, \
             and mesh again"
        );
        let third = after(|data| {
            data.points.push([0.9, 0.2]);
            data.cells.push([0, 4, 2]);
        });
        assert_eq!(
            third,
            "element 23 overlaps others: more than two elements share its facet [11, 13]; mend the mesh"
        );
        // Two triangles below the square, whose common node halves the lower edge.
        let hanging = after(|data| {
            data.points.extend([[0.5, 0.0], [0.5, -1.0]]);
            data.cells.extend([[0, 5, 4], [4, 5, 1]]);
            data.facets.clear();
            data.parts.clear();
        });
        assert_eq!(
            hanging,
            "node 15 hangs on a side of element 21: neighbours must share whole sides; fragment the surfaces in \
             Gmsh, and mesh again"
        );
        // Two tetrahedra above the halves of the base of a third one.
        let data = MeshData::<3, 4> {
            points: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, -1.0],
                [0.5, 0.5, 0.0],
                [0.0, 0.0, 1.0],
            ],
            cells: vec![[0, 2, 1, 3], [0, 1, 4, 5], [0, 4, 2, 5]],
            ..MeshData::default()
        };
        assert_eq!(
            message(data),
            "node 4 hangs on a side of element 0: neighbours must share whole sides; fragment the volumes in Gmsh, \
             and mesh again"
        );
    }

    #[test]
    fn domains_may_touch_in_nodes_of_both() {
        // A second square above the first, with nodes of its own at the same places.
        let mut data = square();
        data.points.extend([[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
        data.cells.extend([[4, 5, 6], [4, 6, 7]]);
        assert_eq!(data.mesh().unwrap().facets().len(), 8);
    }

    /// The square, and a second body on its right, from the left side of which a node lies on the right side of the
    /// square; `same` of its corners there are those of the square.
    fn beside(same: usize) -> MeshData<2, 3> {
        let mut data = square();
        data.points.extend([[1.0, 0.5], [2.0, 0.5], [1.0, 0.0], [1.0, 1.0]]);
        let [lower, upper] = [[6, 1], [7, 2]];
        let [lower, upper] = [lower[usize::from(same > 0)], upper[usize::from(same > 1)]];
        data.cells.extend([[lower, 5, 4], [4, 5, upper]]);
        data.points.truncate(8 - same);
        if same == 1 {
            data.points[6] = [1.0, 1.0];
            data.cells[3][2] = 6;
        }
        data.tags = Tags::default();
        data
    }

    #[test]
    fn sides_in_contact_may_be_meshed_apart() {
        let note = "node 4 lies on a side of element 0 that does not have it: sides in contact are meshed apart, and v \
            has a value for each; to join them, fragment the surfaces in Gmsh, and mesh again";
        let own = beside(0).mesh().unwrap();
        assert_eq!((own.facets().len(), own.touching().last().unwrap().as_str()), (8, note));
        // A slit, whose tip both sides have.
        let slit = beside(1).mesh().unwrap();
        assert_eq!((slit.facets().len(), slit.touching().last().unwrap().as_str()), (8, note));
        let hanging = message(beside(2));
        assert!(hanging.starts_with("node 4 hangs on a side of element 0: "), "{hanging}");
        // The second body alone touches in a corner.
        let mut corner = square();
        corner.points.extend([[1.0, 0.5], [2.0, 0.25], [2.0, 0.75]]);
        corner.cells.push([4, 5, 6]);
        assert_eq!(corner.mesh().unwrap().touching().len(), 1);
    }

    /// A tetrahedron, and two on the halves of its base, with these nodes at the corners of the base.
    fn on_base([a, b, c]: [u32; 3]) -> MeshData<3, 4> {
        MeshData {
            points: vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, -1.0],
                [0.5, 0.5, 0.0],
                [0.0, 0.0, 1.0],
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
            ],
            cells: vec![[0, 2, 1, 3], [a, b, 4, 5], [a, 4, c, 5]],
            ..MeshData::default()
        }
    }

    #[test]
    fn sides_in_contact_may_be_meshed_apart_in_space() {
        let own = on_base([6, 7, 8]).mesh().unwrap();
        assert!(own.touching().last().unwrap().starts_with("node 4 lies on a side of element 0 "));
        let mut same = on_base([0, 1, 2]);
        same.points.truncate(6);
        assert!(message(same).starts_with("node 4 hangs on a side of element 0: "));
    }

    #[test]
    fn parts_and_regions_that_do_not_exist_are_named() {
        assert_eq!(
            after(|data| data.facets[0].part = 3),
            "the facet [12, 11] names part 3 of 1, counted from 0; add the part or correct the number"
        );
        let region = after(|data| {
            data.regions = vec![0, 2];
            data.region_names = vec!["iron".into()];
        });
        assert_eq!(
            region,
            "element 22 names region 2 of 1, counted from 0; add the region or correct the number"
        );
        let few = after(|data| {
            data.regions = vec![0];
            data.region_names = vec!["iron".into()];
        });
        assert_eq!(few, "1 regions are given for 2 elements; give one for each, or none");
    }

    #[test]
    fn bad_names_are_named() {
        assert_eq!(
            after(|data| data.facets[0].nodes = [1, 3]),
            "part `south` names the facet [12, 14], which is no side of an element; embed it in the mesh, or leave \
             its name out"
        );
        let two = after(|data| {
            data.facets.push(Facet { nodes: [0, 1], part: 1 });
            data.parts.push(part("floor"));
        });
        assert_eq!(
            two,
            "the facet [11, 12] belongs to the parts `south` and `floor`; name it once"
        );
        assert_eq!(
            after(|data| data.parts.push(part("roof"))),
            "`roof` names no facet and no element; remove the name, or mesh what it names"
        );
        let region = after(|data| {
            data.regions = vec![0, 0];
            data.region_names = vec!["iron".into(), "air".into()];
        });
        assert_eq!(
            region,
            "`air` names no facet and no element; remove the name, or mesh what it names"
        );
    }
}
