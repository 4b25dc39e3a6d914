//! Faults of a triangulation, each in one line.

/// Why data are no triangulation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No cells.
    #[error("the mesh has no {cells}; mesh the {domain} itself, not only its boundary")]
    NoCells {
        /// Kind of the cells.
        cells: &'static str,
        /// Domain that they fill.
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
    #[error(
        "element {0} is flat: its vertices lie in a line or plane; move one of them, or mesh again"
    )]
    Flat(u64),
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
    /// Two cells on one side of a facet.
    #[error(
        "elements {} and {} overlap: both lie on one side of their facet {nodes:?}; remove what is there twice, and \
         mesh again", .cells[0], .cells[1]
    )]
    Fold {
        /// Cells.
        cells: [u64; 2],
        /// Nodes of the facet.
        nodes: Vec<u64>,
    },
    /// Two cells that overlap and share no facet.
    #[error(
        "elements {one} and {two} overlap: fragment the {domains}, e.g. with `BooleanFragments` in Gmsh, and mesh again"
    )]
    Overlaid {
        /// Cell.
        one: u64,
        /// Other cell.
        two: u64,
        /// Kind of domain in Gmsh.
        domains: &'static str,
    },
    /// A node inside a facet.
    #[error(
        "node {node} hangs on a side of element {cell}: neighbours must share whole sides; fragment the {domains} in \
         Gmsh, and mesh again"
    )]
    Hanging {
        /// Cell on whose side the node lies.
        cell: u64,
        /// Hanging node.
        node: u64,
        /// Kind of domain in Gmsh.
        domains: &'static str,
    },
    /// A named facet that no cell has.
    #[error(
        "part `{part}` names the facet {nodes:?}, which is no side of an element; embed it in the mesh, or leave its \
         name out"
    )]
    NoSide {
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
    /// A facet of a part that does not exist.
    #[error(
        "the facet {nodes:?} names part {part} of {parts}, counted from 0; add the part or correct the number"
    )]
    MissingPart {
        /// Nodes of the facet.
        nodes: Vec<u64>,
        /// Position of the part.
        part: u16,
        /// Number of parts.
        parts: usize,
    },
    /// A cell of a region that does not exist.
    #[error(
        "element {cell} names region {region} of {regions}, counted from 0; add the region or correct the number"
    )]
    MissingRegion {
        /// Cell.
        cell: u64,
        /// Position of the region.
        region: u16,
        /// Number of regions.
        regions: usize,
    },
    /// Regions for some cells alone.
    #[error("{regions} regions are given for {cells} elements; give one for each, or none")]
    RegionCount {
        /// Number of regions given.
        regions: usize,
        /// Number of cells.
        cells: usize,
    },
    /// A part with the name of the facets without one.
    #[error(
        "a part has the name `{0}`, which facets in no part have too; put these into a part, or rename that one"
    )]
    NameOfDefault(&'static str),
    /// A part or region that names nothing.
    #[error("`{0}` names no facet and no element; remove the name, or mesh what it names")]
    EmptyName(String),
    /// Parts of the boundary that meet with laws that no function of finite energy has, or with two values at which v
    /// may stick.
    #[error(
        "{one} meets {two} at ({at}): v cannot stick at both values there; make them equal, or leave a \
         free part between the two"
    )]
    Meeting {
        /// One part, with its law.
        one: String,
        /// The other part, with its law.
        two: String,
        /// Coordinates of the point.
        at: String,
    },
    /// Values of a law by a formula with which no solver computes.
    #[error("the law on {part}: {reason}")]
    Value {
        /// Names of the part.
        part: String,
        /// What is wrong, with the remedy.
        reason: String,
    },
    /// Nodes that 32 bits do not number.
    #[error("{cells} elements are more than 32 bits number; refine less")]
    TooManyNodes {
        /// Number of cells.
        cells: usize,
    },
    /// A refinement on a curve that turns an element inside out.
    #[error(
        "element {element} turns inside out, or a piece of it, when the new nodes of part `{part}` are put on its \
         curve; begin with a finer mesh there"
    )]
    Folded {
        /// Number of the element of the file in which the cell lies that was refined.
        element: u64,
        /// Names of the part on the curve.
        part: String,
    },
}
