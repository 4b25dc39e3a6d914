//! Newest-vertex bisection: refinement of some triangles of a mesh in the plane.
//!
//! Each triangle is bisected at its *refinement edge*, which lies opposite to its last vertex: (a, b, c) with the
//! midpoint m of ab becomes (c, a, m) and (b, c, m). All edges of the marked triangles are marked; then, until nothing
//! changes, the refinement edge of each triangle with a marked edge. This only adds edges, so that it ends whatever the
//! refinement edges are. Each marked edge gets one node, and each triangle with marked edges becomes two, three or
//! four. Of each triangle of the first mesh there are at most four shapes, so that no angle falls further and further.
//!
//! # Stretched triangles
//! As long as the height of a triangle over its longest edge is less than [`FLAT`] of that edge, the refinement edges
//! of the triangle and of its pieces are the longest ones, and the short edge is left as it is: of two long edges
//! both are marked or none, and of a triangle with an angle near 180 degrees the longest edge alone. Let a needle
//! have the angles A and C at its short edge ca, and beta at b, where its long edges ab and bc meet; m and q are the
//! midpoints of these. Of its three pieces, (m, b, q) has the same angles, (c, a, m) has no greater one than A and C,
//! and (m, q, c) has the angle A + beta at q. From piece to piece beta doubles, until the triangle is stretched no
//! more: beta is less than 15 degrees while it is, and the sum of all of them less than 30 degrees.
//!
//! A new node lies between two nodes of the mesh before, as in uniform refinement, or on the curve of its part.

use super::error::MeshError;
use super::refine::{Refined, refine};
use super::sides::BoundarySide;
use super::{Facet, PlaneMesh, Sides, dot};

/// Mesh after bisections.
pub(crate) struct Bisected {
    /// Refined mesh; its first nodes are those of the mesh before.
    pub mesh: PlaneMesh,
    /// Sides of its cells.
    pub sides: Sides<3>,
    /// Nodes of the mesh before between which each new node lies, in the order of the new nodes.
    pub parents: Vec<[u32; 2]>,
    /// Number of the cell of the mesh before in which each cell lies, increasing: a number that is there once is that
    /// of a cell that is left as it was.
    pub origins: Vec<u32>,
}

/// Height over the longest edge, as a part of that edge, below which a triangle is stretched.
const FLAT: f64 = 0.25;
/// Length of an edge, as a part of the longest one, below which it is short.
const SHORT: f64 = 0.5;

/// Lets the refinement edge of each cell be its longest one; of equally long edges the one with the lowest numbers of
/// nodes.
pub(crate) fn label_longest_edges(mesh: &mut PlaneMesh) {
    for cell in &mut mesh.cells {
        let longest = longest_edge(&mesh.points, *cell);
        cell.rotate_left(longest);
    }
}

/// Place of the longest edge of a cell, which is that from the node at this place to the next; of equally long edges
/// the one with the lowest numbers of nodes.
fn longest_edge(points: &[[f64; 2]], cell: [u32; 3]) -> usize {
    let squares = squares(points, cell);
    let ends = |k: usize| {
        let ends = [cell[k], cell[(k + 1) % 3]];
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    };
    let mut longest = 0;
    for k in 1..3 {
        let (most, length) = (squares[longest], squares[k]);
        if length > most || (length == most && ends(k) < ends(longest)) {
            longest = k;
        }
    }
    longest
}

/// Squares of the lengths of the edges of a cell, each from a node to the next.
fn squares(points: &[[f64; 2]], cell: [u32; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let [p, q] = [cell[k], cell[(k + 1) % 3]].map(|node| points[node as usize]);
        let along = [p[0] - q[0], p[1] - q[1]];
        dot(along, along)
    })
}

/// True if a triangle is stretched, by twice its area and the square of its longest edge.
pub(crate) fn is_stretched(doubled: f64, longest: f64) -> bool {
    doubled < FLAT * longest
}

/// CellShape of a cell.
#[derive(Clone, Copy, PartialEq)]
enum CellShape {
    /// Not stretched.
    Plain,
    /// Stretched, with a short edge from the node at this place to the next.
    Needle(usize),
    /// Stretched, with an angle near 180 degrees.
    Flat,
}

impl CellShape {
    fn of(points: &[[f64; 2]], cell: [u32; 3]) -> Self {
        let [a, b, c] = cell.map(|node| points[node as usize]);
        let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let squares = squares(points, cell);
        let longest = squares.into_iter().fold(0.0, f64::max);
        if !is_stretched(doubled, longest) {
            return Self::Plain;
        }
        let short = squares.iter().position(|square| *square < SHORT * SHORT * longest);
        short.map_or(Self::Flat, Self::Needle)
    }

    /// Flags for the sides of a cell, each opposite to the node at its place: true if it is split where another side
    /// of the cell is.
    fn split_with_others(self) -> [bool; 3] {
        match self {
            Self::Needle(short) => [0, 1, 2].map(|side| side != (short + 2) % 3),
            Self::Plain | Self::Flat => [false, false, true],
        }
    }

    /// Flags for the sides of a cell that are split if it is marked.
    fn split_if_marked(self) -> [bool; 3] {
        if self == Self::Plain { [true; 3] } else { self.split_with_others() }
    }
}

/// Bisects the marked cells, given by their numbers, and as many others as leave no hanging nodes.
///
/// # Errors
/// [`MeshError::TooManyNodes`], and [`MeshError::Folded`] if a curve puts a node so far away that a cell turns inside
/// out.
pub(crate) fn bisect(
    mesh: &PlaneMesh,
    sides: &Sides<3>,
    marked: &[u32],
) -> Result<Bisected, MeshError> {
    let is_split = split_sides(mesh, sides, marked);
    let new_nodes = is_split.iter().filter(|split| **split).count();
    // At most two cells and three sides for each new node.
    if 4 * (mesh.cells.len() + 2 * new_nodes) > u32::MAX as usize {
        return Err(MeshError::TooManyNodes { cells: mesh.cells.len() + 2 * new_nodes });
    }
    let mut pieces = Pieces::new(mesh, is_split, new_nodes);
    for (number, (&cell, of_cell)) in (0..).zip(mesh.cells.iter().zip(&sides.of_cell)) {
        pieces.origin = number;
        pieces.is_stretched = CellShape::of(&mesh.points, cell) != CellShape::Plain;
        pieces.add(cell, of_cell.map(PieceEdge::Old));
    }
    pieces.finished(sides)
}

/// Divides all cells into four similar ones.
///
/// # Errors
/// As [`refine`].
pub(crate) fn quarter(mesh: &PlaneMesh) -> Result<Bisected, MeshError> {
    let Refined { mesh: mut finer, parents } = refine(mesh)?;
    label_longest_edges(&mut finer);
    let origins = (0..mesh.cells.len() as u32).flat_map(|cell| [cell; 4]).collect();
    Ok(Bisected { sides: Sides::new(&finer), mesh: finer, parents, origins })
}

/// Sides at whose midpoints there will be nodes: flags in the order of the sides.
fn split_sides(mesh: &PlaneMesh, sides: &Sides<3>, marked: &[u32]) -> Vec<bool> {
    let mut is_split = vec![false; sides.len()];
    let shape = |cell: u32| CellShape::of(&mesh.points, mesh.cells[cell as usize]);
    // Sides to be split, each with a cell that has it.
    let mut next: Vec<SplitSide> = Vec::new();
    for &cell in marked {
        next.extend(sides_of(sides, cell, shape(cell).split_if_marked()));
        while let Some(SplitSide { cell, side }) = next.pop() {
            if std::mem::replace(&mut is_split[side as usize], true) {
                continue;
            }
            // Beyond the side there is another cell, or a facet.
            let beyond = cell ^ sides.both_cells[side as usize];
            if (beyond as usize) < mesh.cells.len() {
                next.extend(sides_of(sides, beyond, shape(beyond).split_with_others()));
            }
        }
    }
    is_split
}

/// Side with a cell that has it, by their numbers.
struct SplitSide {
    cell: u32,
    side: u32,
}

/// Sides of a cell that have a flag.
fn sides_of(sides: &Sides<3>, cell: u32, flags: [bool; 3]) -> impl Iterator<Item = SplitSide> {
    let flagged = sides.of_cell[cell as usize].into_iter().zip(flags).filter(|(_, flag)| *flag);
    flagged.map(move |(side, _)| SplitSide { cell, side })
}

/// Side of a cell in the making.
#[derive(Clone, Copy)]
enum PieceEdge {
    /// Side of the mesh before.
    Old(u32),
    /// Side of the refined mesh.
    New(u32),
}

/// Number of what has none yet.
const NONE: u32 = u32::MAX;

/// Refined mesh in the making.
struct Pieces<'a> {
    coarse: &'a PlaneMesh,
    /// Flag for each side of the mesh before, true if it is split.
    is_split: Vec<bool>,
    /// Number of each side of the mesh before in the refined mesh, of its first half if it is split: the half at the
    /// end with the lower number. The other half has the next number.
    numbers: Vec<u32>,
    /// Number of the node at the midpoint of each side that is split.
    midpoints: Vec<u32>,
    parents: Vec<[u32; 2]>,
    points: Vec<[f64; 2]>,
    cells: Vec<[u32; 3]>,
    of_cell: Vec<[u32; 3]>,
    origins: Vec<u32>,
    /// Number of sides of the refined mesh so far.
    sides: u32,
    /// Number of the cell that is being divided.
    origin: u32,
    /// True if it is stretched.
    is_stretched: bool,
}

impl<'a> Pieces<'a> {
    fn new(coarse: &'a PlaneMesh, is_split: Vec<bool>, new_nodes: usize) -> Self {
        let cells = coarse.cells.len() + 2 * new_nodes;
        let mut points = Vec::with_capacity(coarse.points.len() + new_nodes);
        points.extend_from_slice(&coarse.points);
        Self {
            coarse,
            numbers: vec![NONE; is_split.len()],
            midpoints: vec![NONE; is_split.len()],
            is_split,
            parents: Vec::with_capacity(new_nodes),
            points,
            cells: Vec::with_capacity(cells),
            of_cell: Vec::with_capacity(cells),
            origins: Vec::with_capacity(cells),
            sides: 0,
            origin: 0,
            is_stretched: false,
        }
    }

    /// Adds a cell, or its pieces if its refinement edge is split.
    fn add(&mut self, cell: [u32; 3], edges: [PieceEdge; 3]) {
        let ([a, b, c], [bc, ca, ab]) = (cell, edges);
        match ab {
            PieceEdge::Old(side) if self.is_split[side as usize] => {
                let m = self.midpoint(side, [a, b]);
                let cm = PieceEdge::New(self.next_sides(1));
                let [am, mb] = halves(self.number(side), [a, b]);
                self.add([c, a, m], [PieceEdge::New(am), cm, ca]);
                self.add([b, c, m], [cm, PieceEdge::New(mb), bc]);
            }
            PieceEdge::Old(_) | PieceEdge::New(_) => {
                let sides = edges.map(|edge| match edge {
                    PieceEdge::Old(side) => self.number(side),
                    PieceEdge::New(number) => number,
                });
                let is_plain =
                    !self.is_stretched && CellShape::of(&self.points, cell) == CellShape::Plain;
                let turn = if is_plain { 0 } else { longest_edge(&self.points, cell) };
                let turned = |mut three: [u32; 3]| {
                    three.rotate_left(turn);
                    three
                };
                self.cells.push(turned(cell));
                self.of_cell.push(turned(sides));
                self.origins.push(self.origin);
            }
        }
    }

    /// Takes numbers for so many sides; returns the first.
    fn next_sides(&mut self, count: u32) -> u32 {
        self.sides += count;
        self.sides - count
    }

    /// Number of a side of the mesh before, or of its first half. Sides are numbered in the order of the cells, so that
    /// the sides of near cells are near in memory.
    fn number(&mut self, side: u32) -> u32 {
        let side = side as usize;
        if self.numbers[side] == NONE {
            self.numbers[side] = self.next_sides(1 + u32::from(self.is_split[side]));
        }
        self.numbers[side]
    }

    /// Number of the node at the midpoint of a side with these ends.
    fn midpoint(&mut self, side: u32, [a, b]: [u32; 2]) -> u32 {
        let node = &mut self.midpoints[side as usize];
        if *node == NONE {
            *node = self.points.len() as u32;
            self.parents.push([a.min(b), a.max(b)]);
            let [p, q] = [a, b].map(|node| self.points[node as usize]);
            self.points.push([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
        }
        *node
    }

    /// Puts the new nodes on the curves, and divides the facets.
    fn finished(mut self, coarse_sides: &Sides<3>) -> Result<Bisected, MeshError> {
        let coarse = self.coarse;
        let mut both_cells = vec![0u32; self.sides as usize];
        for (cell, sides) in (0..).zip(&self.of_cell) {
            sides.iter().for_each(|&side| both_cells[side as usize] ^= cell);
        }
        let count = self.cells.len() as u32;
        let (mut facets, mut of_facet): (Vec<Facet<2>>, Vec<_>) = (Vec::new(), Vec::new());
        let mut is_curved = false;
        for (facet, of_coarse) in coarse.facets.iter().zip(&coarse_sides.of_facet) {
            let side = of_coarse.side as usize;
            let (first, [a, b], part) = (self.numbers[side], facet.nodes, facet.part);
            let mut add = |nodes, side: u32| {
                let both = &mut both_cells[side as usize];
                of_facet.push(BoundarySide { side, cell: *both });
                *both ^= count + facets.len() as u32;
                facets.push(Facet { nodes, part });
            };
            if !self.is_split[side] {
                add([a, b], first);
                continue;
            }
            let m = self.midpoints[side];
            let [am, mb] = halves(first, [a, b]);
            add([a, m], am);
            add([m, b], mb);
            if let Some(curve) = coarse.parts[usize::from(part)].curve {
                let point = &mut self.points[m as usize];
                *point = curve.nearest(*point);
                is_curved = true;
            }
        }
        let of_file = if coarse.is_curved() { &coarse.elements[..] } else { &[] };
        let mesh = PlaneMesh {
            points: self.points,
            regions: self.origins.iter().map(|&cell| coarse.regions[cell as usize]).collect(),
            elements: self
                .origins
                .iter()
                .filter_map(|&cell| of_file.get(cell as usize).copied())
                .collect(),
            cells: self.cells,
            region_names: coarse.region_names.clone(),
            k: coarse.k.clone(),
            reaction: coarse.reaction,
            facets,
            parts: coarse.parts.clone(),
            values: coarse.values.clone(),
            inside: coarse.inside.clone(),
            touching: coarse.touching.clone(),
            moved: coarse.moved.clone(),
            origin: coarse.origin,
        };
        if is_curved {
            check_orientation(coarse, &mesh, &self.origins)?;
        }
        let sides = Sides { of_cell: self.of_cell, both_cells, of_facet, edges: None };
        Ok(Bisected { mesh, sides, parents: self.parents, origins: self.origins })
    }
}

/// Numbers of the halves of a split side, at its one and its other end, given the number of the first.
fn halves(first: u32, [a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [first, first + 1] } else { [first + 1, first] }
}

/// Checks that all cells have the positive orientation, and a volume.
fn check_orientation(
    coarse: &PlaneMesh,
    mesh: &PlaneMesh,
    origins: &[u32],
) -> Result<(), MeshError> {
    let mut cells = mesh.cells.iter().zip(origins);
    cells.try_for_each(|(cell, &origin)| {
        coarse.check_piece(origin as usize, mesh.vertices(cell), false)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AnyMesh, BuiltIn, Element, MeshData, Round, assemble, assemble_sides, gmsh};
    use crate::problem::law::Law;

    /// Numbers of some cells that look random.
    fn some(cells: usize, seed: usize) -> Vec<u32> {
        let is_marked = |k: &usize| (k * k + 7 * k + seed).is_multiple_of(5);
        (0..cells).filter(is_marked).map(|k| k as u32).collect()
    }

    fn gear() -> PlaneMesh {
        let file = include_bytes!("../../../../tests/meshes/gear.msh");
        let AnyMesh::Plane(mesh) = gmsh::read(file).unwrap() else { panic!("a mesh in the plane") };
        mesh
    }

    /// Unit square of four triangles with a slit from its centre to the right side.
    fn slit() -> PlaneMesh {
        let data = MeshData {
            points: vec![
                [0.0, 0.0],
                [1.0, 0.0],
                [1.0, 1.0],
                [-1.0, 1.0],
                [-1.0, -1.0],
                [1.0, -1.0],
                [1.0, 0.0],
            ],
            cells: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 6]],
            ..MeshData::default()
        };
        data.mesh().unwrap()
    }

    /// Bisects some cells again and again, with a check of each mesh.
    fn bisected(mut mesh: PlaneMesh, times: usize) -> PlaneMesh {
        label_longest_edges(&mut mesh);
        let mut sides = Sides::new(&mesh);
        for seed in 0..times {
            let marked = some(mesh.cells.len(), seed);
            let found = bisect(&mesh, &sides, &marked).unwrap();
            check(&mesh, &found, &marked);
            (mesh, sides) = (found.mesh, found.sides);
        }
        mesh
    }

    fn check(coarse: &PlaneMesh, found: &Bisected, marked: &[u32]) {
        let Bisected { mesh, sides, parents, origins } = found;
        assert_eq!(mesh.points[..coarse.points.len()], coarse.points);
        assert_eq!(parents.len(), mesh.points.len() - coarse.points.len());
        // Sides by search, whatever their numbers, are those of the bisection.
        let searched = Sides::new(mesh);
        assert_eq!(sides.len(), searched.len());
        for cell in 0..mesh.cells.len() as u32 {
            let [one, two] = [sides, &searched]
                .map(|sides| sides.numbers(cell).map(|side| sides.across(cell, side)));
            assert_eq!(one, two);
        }
        assert_eq!(assemble_sides(mesh, sides), assemble(mesh));
        let children = |cell: u32| origins.iter().filter(|&&origin| origin == cell).count();
        let least = |cell: u32| match CellShape::of(&coarse.points, coarse.cells[cell as usize]) {
            CellShape::Plain => 4,
            CellShape::Needle(_) => 3,
            CellShape::Flat => 2,
        };
        assert!(marked.iter().all(|&cell| (least(cell)..=4).contains(&children(cell))));
        assert!(origins.is_sorted() && origins.len() == mesh.cells.len());
        let mut volumes = vec![0.0; coarse.cells.len()];
        for (cell, &origin) in mesh.cells.iter().zip(origins) {
            let element = Element::<2, 3>::new(mesh.vertices(cell));
            assert!(!element.is_mirrored && element.volume > 0.0);
            volumes[origin as usize] += element.volume;
            assert_eq!(mesh.regions[0], coarse.regions[0]);
        }
        if coarse.parts.iter().all(|part| part.curve.is_none()) {
            for (cell, volume) in coarse.cells.iter().zip(volumes) {
                let whole = Element::<2, 3>::new(coarse.vertices(cell)).volume;
                assert!((volume / whole - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_lips_of_a_slit_may_be_refined_apart_and_read_again() {
        let PlaneMesh { points, cells, .. } = bisected(slit(), 6);
        let again = MeshData { points, cells, ..MeshData::default() }.mesh().unwrap();
        let said = again.touching().last().unwrap();
        assert!(said.contains("sides in contact are meshed apart"), "{said}");
    }

    /// Length of each part of the boundary.
    fn lengths(mesh: &PlaneMesh) -> Vec<f64> {
        let mut lengths = vec![0.0; mesh.parts.len()];
        for facet in &mesh.facets {
            let part = usize::from(facet.part);
            lengths[part] += crate::mesh::measure(mesh.corners(facet));
        }
        lengths
    }

    #[test]
    fn parts_and_regions_are_inherited_by_position() {
        let mut coarse = gear();
        coarse.parts[0].law = Law::FREE;
        let mesh = bisected(coarse.clone(), 4);
        assert_eq!(mesh.parts, coarse.parts);
        for (one, two) in lengths(&coarse).into_iter().zip(lengths(&mesh)) {
            assert!((one / two - 1.0).abs() < 1e-12, "{one} {two}");
        }
        let areas = |mesh: &PlaneMesh| {
            let mut areas = vec![0.0; mesh.region_names.len().max(1)];
            for (cell, &region) in mesh.cells.iter().zip(&mesh.regions) {
                areas[usize::from(region)] += Element::<2, 3>::new(mesh.vertices(cell)).volume;
            }
            areas
        };
        for (one, two) in areas(&coarse).into_iter().zip(areas(&mesh)) {
            assert!((one - two).abs() < 1e-12, "{one} {two}");
        }
    }

    #[test]
    fn new_nodes_of_a_circle_lie_on_it() {
        let mesh = bisected(BuiltIn::Annulus.plane().unwrap(), 5);
        for facet in &mesh.facets {
            let curve: Round<2> = mesh.parts[usize::from(facet.part)].curve.unwrap();
            assert!(mesh.corners(facet).iter().all(|&point| curve.distance(point) < 1e-14));
        }
    }

    #[test]
    fn both_sides_of_a_slit_stay_apart() {
        let mesh = bisected(slit(), 8);
        let on_slit = |facet: &&Facet<2>| {
            mesh.corners(facet).iter().all(|&[x, y]| y == 0.0 && (0.0..=1.0).contains(&x))
        };
        let length: f64 =
            mesh.facets.iter().filter(on_slit).map(|f| crate::mesh::measure(mesh.corners(f))).sum();
        assert!((length - 2.0).abs() < 1e-14, "{length}");
    }

    #[test]
    fn angles_do_not_fall_further_and_further() {
        let least = |mesh: &PlaneMesh| {
            let sines = mesh.cells.iter().map(|cell| {
                let vertices = mesh.vertices(cell);
                let longest = crate::mesh::size(vertices);
                Element::<2, 3>::new(vertices).volume / (longest * longest)
            });
            sines.fold(f64::INFINITY, f64::min)
        };
        let [few, many] =
            [3, 9].map(|times| least(&bisected(BuiltIn::LShape.plane().unwrap(), times)));
        assert_eq!(few, many);
    }

    /// Greatest angle of the cells, in degrees.
    fn greatest_angle(mesh: &PlaneMesh) -> f64 {
        let of_cell = |cell: &[u32; 3]| {
            let [a, b, c] = squares(&mesh.points, *cell);
            let longest = a.max(b).max(c);
            let others = a + b + c - longest;
            let product = a * b * c / longest;
            let cosine = (others - longest) / (2.0 * product.sqrt());
            cosine.clamp(-1.0, 1.0).acos().to_degrees()
        };
        mesh.cells.iter().map(of_cell).fold(0.0, f64::max)
    }

    /// Rectangle 1 x `height` of two triangles.
    fn rectangle(height: f64) -> PlaneMesh {
        let data = MeshData {
            points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, height], [0.0, height]],
            cells: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        };
        data.mesh().unwrap()
    }

    #[test]
    fn angles_of_stretched_cells_do_not_grow() {
        for height in [1.0, 0.3, 0.1, 0.01, 1e-3, 1e-4] {
            let mut mesh = rectangle(height);
            label_longest_edges(&mut mesh);
            for seed in 0..14 {
                let sides = Sides::new(&mesh);
                let marked = some(mesh.cells.len(), seed);
                let found = bisect(&mesh, &sides, &marked).unwrap();
                assert_eq!(assemble_sides(&found.mesh, &found.sides), assemble(&found.mesh));
                mesh = found.mesh;
                let angle = greatest_angle(&mesh);
                assert!(angle < 152.0, "{angle} degrees at height {height}");
            }
        }
    }

    #[test]
    fn the_longest_edge_is_the_refinement_edge_and_ties_go_to_low_numbers() {
        let mut mesh = BuiltIn::LShape.plane().unwrap();
        let before = mesh.clone();
        label_longest_edges(&mut mesh);
        for (cell, old) in mesh.cells.iter().zip(&before.cells) {
            let [a, b, c] = mesh.vertices(cell);
            let square = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
            assert!(square(a, b) >= square(b, c) && square(a, b) >= square(c, a));
            assert!((0..3).any(|k| {
                let mut old = *old;
                old.rotate_left(k);
                old == *cell
            }));
        }
        let data = MeshData {
            points: vec![[1.0, 0.0], [-1.0, 0.0], [0.0, 4.0]],
            cells: vec![[0, 2, 1]],
            ..MeshData::default()
        };
        let mut isosceles: PlaneMesh = data.mesh().unwrap();
        label_longest_edges(&mut isosceles);
        assert_eq!(isosceles.cells[0][2], 1);
    }
}
