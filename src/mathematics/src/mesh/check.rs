//! Checks of a triangulation that comes from outside, and the facets of its boundary.

use super::geometry::{Element, size};
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

/// Why data are no triangulation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No cells.
    #[error("the mesh has no {cells}; mesh the {domain} itself, not only its boundary")]
    NoCells {
        /// Kind of the cells.
        cells: &'static str,
        /// What they fill.
        domain: &'static str,
    },
    /// NaN or an infinity.
    #[error("node {0} has a coordinate that is no finite number")]
    Coordinate(u64),
    /// A cell of a node that does not exist.
    #[error("element {cell} names node {node}, which is not in the mesh")]
    MissingNode {
        /// Cell.
        cell: u64,
        /// Number of the node.
        node: u64,
    },
    /// A cell without volume.
    #[error("element {0} is flat: its vertices lie in a line or plane; mend or remove it")]
    Flat(u64),
    /// A cell that is numbered in another sense than the rest.
    #[error("element {0} is inverted: its vertices are numbered in the other sense; mend the mesh")]
    Inverted(u64),
    /// A node without a cell.
    #[error("node {0} belongs to no element; save the mesh without unused nodes")]
    Unused(u64),
    /// More than two cells at one facet.
    #[error(
        "element {cell} overlaps others: more than two elements share its facet {nodes:?}; mend the mesh"
    )]
    Overlap {
        /// Third cell of the facet.
        cell: u64,
        /// Nodes of the facet.
        nodes: Vec<u64>,
    },
    /// A node inside a facet.
    #[error(
        "node {node} hangs on a side of element {cell}: neighbours must share whole sides; mesh again"
    )]
    Hanging {
        /// Cell on whose side the node lies.
        cell: u64,
        /// Hanging node.
        node: u64,
    },
    /// A named facet that does not lie on the boundary.
    #[error("part `{part}` names the facet {nodes:?}, which is not on the boundary")]
    Inside {
        /// Name of the part.
        part: String,
        /// Nodes of the facet.
        nodes: Vec<u64>,
    },
    /// A facet that belongs to two parts.
    #[error("the facet {nodes:?} belongs to the parts `{one}` and `{two}`; name it once")]
    TwoParts {
        /// One part.
        one: String,
        /// Other part.
        two: String,
        /// Nodes of the facet.
        nodes: Vec<u64>,
    },
    /// A part or region that names nothing.
    #[error("`{0}` names no facet and no element; remove the name, or mesh what it names")]
    EmptyName(String),
    /// Nodes that 32 bits do not number.
    #[error("{cells} elements are more than 32 bits number; refine less")]
    TooManyNodes {
        /// Number of cells.
        cells: usize,
    },
    /// A refinement on a curve that turns an element inside out.
    #[error(
        "element {cell} turns inside out when its new nodes are put on the curve; begin with a finer mesh"
    )]
    Folded {
        /// Position of the cell that was refined.
        cell: usize,
    },
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
        let facets = self.boundary()?;
        self.check_names(&facets)?;
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

    /// Facets of the boundary: sides that only one cell has, in the order of the cells.
    fn boundary(&mut self) -> Result<Vec<Facet<D>>, MeshError> {
        // Number of cells that have each side.
        let mut sides: HashMap<[u32; D], u32> = HashMap::with_capacity(2 * self.cells.len());
        for (k, cell) in self.cells.iter().enumerate() {
            for nodes in sides_of(cell) {
                let count = sides.entry(sorted(nodes)).or_default();
                *count += 1;
                if *count > 2 {
                    let (cell, nodes) = (self.tags.cell(k), self.tags.all(nodes));
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
        let mut unnamed = None;
        let mut facets = Vec::new();
        for cell in &self.cells {
            for nodes in sides_of(cell) {
                let key = sorted(nodes);
                if sides[&key] > 1 {
                    continue;
                }
                let part = *parts.entry(key).or_insert_with(|| {
                    *unnamed.get_or_insert_with(|| {
                        self.parts.push(Part {
                            name: "boundary".into(),
                            condition: Condition::default(),
                            curve: None,
                        });
                        (self.parts.len() - 1) as u16
                    })
                });
                facets.push(Facet { nodes, part });
            }
        }
        Ok(facets)
    }

    fn check_names(&self, facets: &[Facet<D>]) -> Result<(), MeshError> {
        for (k, part) in self.parts.iter().enumerate() {
            if !facets.iter().any(|facet| facet.part as usize == k) {
                return Err(MeshError::EmptyName(part.name.clone()));
            }
        }
        for (k, name) in self.region_names.iter().enumerate() {
            if !self.regions.iter().any(|region| *region as usize == k) {
                return Err(MeshError::EmptyName(name.clone()));
            }
        }
        Ok(())
    }
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

/// Returns the facets of a cell: the vertices without the first, without the second, and so on.
pub(crate) fn sides_of<const D: usize, const V: usize>(cell: &[u32; V]) -> [[u32; D]; V] {
    std::array::from_fn(|without| {
        std::array::from_fn(|k| cell[if k < without { k } else { k + 1 }])
    })
}

/// Returns numbers in increasing order.
pub(crate) fn sorted<const K: usize>(mut numbers: [u32; K]) -> [u32; K] {
    numbers.sort_unstable();
    numbers
}
