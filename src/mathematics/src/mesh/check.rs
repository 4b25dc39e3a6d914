//! Checks of a triangulation that comes from outside, and the facets of its boundary.

use super::error::MeshError;
use super::geometry::{Element, size};
use super::hanging::{HangingNode, hanging_node};
use super::{Condition, Facet, Mesh, MeshData, Part, Tags};
use std::collections::HashMap;

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
    pub fn mesh(mut self) -> Result<Mesh<D, V>, MeshError> {
        if self.cells.is_empty() {
            let [cells, domain] =
                if D == 3 { ["tetrahedra", "volume"] } else { ["triangles", "area"] };
            return Err(MeshError::NoCells { cells, domain });
        }
        if self.points.len().max(self.cells.len()) > u32::MAX as usize / 16 {
            return Err(MeshError::TooManyNodes { cells: self.cells.len() });
        }
        self.check_points()?;
        self.check_cells()?;
        self.check_positions()?;
        let facets = self.boundary()?;
        self.check_names(&facets)?;
        self.check_hanging(&facets)?;
        if self.regions.is_empty() {
            self.region_names = vec!["domain".into()];
            self.regions = vec![0; self.cells.len()];
        }
        let mesh = Mesh {
            points: self.points,
            cells: self.cells,
            regions: self.regions,
            region_names: self.region_names,
            facets,
            parts: self.parts,
        };
        Ok(mesh)
    }

    fn check_points(&self) -> Result<(), MeshError> {
        match self.points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            Some(node) => Err(MeshError::Coordinate(self.tags.node(node))),
            None => Ok(()),
        }
    }

    fn check_cells(&self) -> Result<(), MeshError> {
        let mut used = vec![false; self.points.len()];
        let mut mirrored = Vec::with_capacity(self.cells.len());
        for (k, cell) in self.cells.iter().enumerate() {
            let tag = self.tags.cell(k);
            for &node in cell {
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
            mirrored.push(element.is_mirrored);
        }
        if let Some(node) = used.iter().position(|used| !used) {
            return Err(MeshError::Unused(self.tags.node(node)));
        }
        // A program may number all elements in the negative sense; one among others is a fault.
        let count = mirrored.iter().filter(|mirrored| **mirrored).count();
        let rare = 2 * count <= mirrored.len();
        match mirrored.iter().position(|&mirrored| mirrored == rare) {
            Some(k) => Err(MeshError::Inverted(self.tags.cell(k))),
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

    /// Facets of the boundary: sides that only one cell has, in the order of the cells.
    fn boundary(&mut self) -> Result<Vec<Facet<D>>, MeshError> {
        // Number of cells that have each side.
        let mut sides: HashMap<[u32; D], u32> = HashMap::with_capacity(2 * self.cells.len());
        for (k, cell) in self.cells.iter().enumerate() {
            for nodes in sides_of(cell) {
                let count = sides.entry(sorted(nodes)).or_default();
                *count += 1;
                if *count > 2 {
                    let (cell, nodes) = (self.tags.cell(k), self.tags.all(sorted(nodes)));
                    return Err(MeshError::Overlap { cell, nodes });
                }
            }
        }
        let mut parts: HashMap<[u32; D], u16> = HashMap::new();
        for facet in &self.facets {
            let name = |part: u16| self.parts[part as usize].name.clone();
            let key = sorted(facet.nodes);
            if sides.get(&key) != Some(&1) {
                let nodes = self.tags.all(facet.nodes);
                return Err(MeshError::Inside { part: name(facet.part), nodes });
            }
            if let Some(other) = parts.insert(key, facet.part).filter(|part| *part != facet.part) {
                let nodes = self.tags.all(facet.nodes);
                return Err(MeshError::TwoParts { one: name(other), two: name(facet.part), nodes });
            }
        }
        let mut facets = Vec::new();
        for cell in &self.cells {
            for nodes in sides_of(cell) {
                let key = sorted(nodes);
                if sides[&key] == 1 {
                    let part = parts.get(&key).copied();
                    let part = part.unwrap_or_else(|| default_part(&mut self.parts));
                    facets.push(Facet { nodes, part });
                }
            }
        }
        Ok(facets)
    }

    fn check_names(&self, facets: &[Facet<D>]) -> Result<(), MeshError> {
        let (mut parts, mut regions) =
            (vec![false; self.parts.len()], vec![false; self.region_names.len()]);
        facets.iter().for_each(|facet| parts[facet.part as usize] = true);
        self.regions.iter().for_each(|&region| regions[region as usize] = true);
        let empty = if let Some(k) = parts.iter().position(|used| !used) {
            &self.parts[k].name
        } else if let Some(k) = regions.iter().position(|used| !used) {
            &self.region_names[k]
        } else {
            return Ok(());
        };
        Err(MeshError::EmptyName(empty.clone()))
    }

    fn check_hanging(&self, facets: &[Facet<D>]) -> Result<(), MeshError> {
        let Some(HangingNode { node, facet }) = hanging_node(&self.points, facets) else {
            return Ok(());
        };
        let has_facet = |cell: &[u32; V]| facet.iter().all(|node| cell.contains(node));
        let cell = self.cells.iter().position(has_facet).expect("a facet is a side of a cell");
        Err(MeshError::Hanging { cell: self.tags.cell(cell), node: self.tags.node(node as usize) })
    }
}

/// Position of the part `boundary`, which is added if there is none.
fn default_part<const D: usize>(parts: &mut Vec<Part<D>>) -> u16 {
    const NAME: &str = "boundary";
    let position = parts.iter().rposition(|part| part.name == NAME).unwrap_or_else(|| {
        parts.push(Part { name: NAME.into(), condition: Condition::default(), curve: None });
        parts.len() - 1
    });
    position as u16
}

impl Tags {
    fn node(&self, node: usize) -> u64 {
        self.nodes.get(node).copied().unwrap_or(node as u64)
    }

    fn cell(&self, cell: usize) -> u64 {
        self.cells.get(cell).copied().unwrap_or(cell as u64)
    }

    fn all<const K: usize>(&self, nodes: [u32; K]) -> Vec<u64> {
        nodes.iter().map(|&node| self.node(node as usize)).collect()
    }
}

/// Returns the facets of a cell: the vertices without the first, without the second, and so on; those of a triangle in the
/// sense of the triangle.
pub(crate) fn sides_of<const D: usize, const V: usize>(cell: &[u32; V]) -> [[u32; D]; V] {
    std::array::from_fn(|without| std::array::from_fn(|k| cell[(without + 1 + k) % V]))
}

/// Returns numbers in increasing order.
pub(crate) fn sorted<const K: usize>(mut numbers: [u32; K]) -> [u32; K] {
    numbers.sort_unstable();
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

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
        Part { name: name.into(), condition: Condition::default(), curve: None }
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
        let names: Vec<_> = mesh.parts().iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["south", "boundary"]);
        let parts: Vec<_> = mesh.facets().iter().map(|facet| (facet.nodes, facet.part)).collect();
        // Each edge runs in the sense of its triangle, with the domain on the left.
        assert_eq!(parts, [([1, 2], 1), ([0, 1], 0), ([2, 3], 1), ([3, 0], 1)]);
        // A part that the data name `boundary` takes the unnamed edges.
        let mesh = MeshData { parts: vec![part("boundary")], ..square() }.mesh().unwrap();
        assert_eq!(mesh.parts().len(), 1);
        // All cells in the negative sense are as good.
        assert!(MeshData { cells: vec![[1, 0, 2], [2, 0, 3]], ..square() }.mesh().is_ok());
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
            "element 22 is flat: its vertices lie in a line or plane; mend or remove it"
        );
        assert_eq!(
            after(|data| data.cells[1] = [2, 0, 3]),
            "element 22 is inverted: its vertices are numbered in the other sense; mend the mesh"
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
            "node 15 hangs on a side of element 21: neighbours must share whole sides; mesh again"
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
            "node 4 hangs on a side of element 0: neighbours must share whole sides; mesh again"
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
            after(|data| data.facets[0].nodes = [0, 2]),
            "part `south` names the facet [11, 13], which is not on the boundary"
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
