//! Flux of a patch in the plane, as that of a [fan](super::fan) in space: the cells around a node in their order, where
//! the outflow of one is an inflow of the next.

use super::SideOutflow;
use super::cells::Cells;
use super::reaction::OpenNode;
use crate::mesh::{Condition, Facet, Neighbour, Sides, measure};

/// Cell of a ring: the node z and, in the positive sense, two others a and b.
#[derive(Clone, Copy, Debug)]
struct RingCell {
    /// Number of the cell.
    cell: u32,
    /// Side zb, beyond which the next cell lies.
    side: u32,
    /// One over twice the area.
    inverse: f64,
    /// Twice the area.
    area: f64,
    /// a - z and b - z.
    edges: [[f64; 2]; 2],
    /// Integrals of `grad w . grad phi`, phi the hat functions of a and b: minus the shares of the node in the outflows
    /// of `grad w` through zb and za.
    work: [f64; 2],
    /// Sum that the outflows must have.
    wanted: f64,
    /// Outflow through zb.
    outflow: f64,
}

/// Cells around a node that are connected through sides with the node: all cells around the node, unless the domain
/// touches itself there.
pub(super) struct Ring<'a, const D: usize, const V: usize> {
    cells: Cells<'a, D, V>,
    sides: &'a Sides<V>,
    members: Vec<RingCell>,
    /// Facets before the first cell and behind the last one; none where the ring is closed.
    ends: Option<[u32; 2]>,
    /// Outflow through the facet before the first cell.
    before: f64,
    /// Node.
    node: u32,
    /// Cells found around the node, in the present ring and in others.
    pub found: Vec<u32>,
}

impl<'a, const D: usize, const V: usize> Ring<'a, D, V> {
    /// Empty ring.
    pub(super) fn new(cells: Cells<'a, D, V>, sides: &'a Sides<V>) -> Self {
        let (members, found) = (Vec::new(), Vec::new());
        Self { cells, sides, members, ends: None, before: 0.0, node: u32::MAX, found }
    }

    /// Forgets all rings, and takes another node.
    pub(super) fn begin(&mut self, node: u32) {
        self.node = node;
        self.found.clear();
    }

    /// Replaces the ring by the one of a cell around the node.
    pub(super) fn find(&mut self, cell: u32) {
        self.ends = None;
        let before = self.found.len();
        if let Some(last) = self.follow(cell) {
            self.found.truncate(before);
            let mut first = cell;
            let begin = loop {
                let behind = self.sides.numbers(first)[(self.vertex(first) + 2) % 3];
                match self.sides.across(first, behind) {
                    Neighbour::Cell(cell) => first = cell,
                    Neighbour::Facet(facet) => break facet,
                }
            };
            self.follow(first);
            self.ends = Some([begin, last]);
        }
    }

    /// Position of the node among the vertices of a cell.
    #[inline(always)]
    fn vertex(&self, cell: u32) -> usize {
        let nodes = &self.cells.mesh.cells()[cell as usize];
        if nodes[0] == self.node {
            0
        } else if nodes[1] == self.node {
            1
        } else {
            2
        }
    }

    /// Takes the cells from this one on, in the positive sense; returns the facet at the end, if there is one.
    fn follow(&mut self, first: u32) -> Option<u32> {
        self.members.clear();
        let mut cell = first;
        loop {
            let vertex = self.vertex(cell);
            let side = self.sides.numbers(cell)[(vertex + 1) % 3];
            self.push(cell, side, vertex);
            match self.sides.across(cell, side) {
                Neighbour::Facet(facet) => return Some(facet),
                Neighbour::Cell(next) if next == first => return None,
                Neighbour::Cell(next) => cell = next,
            }
        }
    }

    #[inline(always)]
    fn push(&mut self, cell: u32, side: u32, vertex: usize) {
        let mesh = self.cells.mesh;
        let nodes = &mesh.cells()[cell as usize];
        let [z, a, b] = [vertex, (vertex + 1) % 3, (vertex + 2) % 3].map(|k| nodes[k] as usize);
        let [of_z, of_a, of_b] = [z, a, b].map(|node| {
            let point = &mesh.points()[node];
            [point[0], point[1]]
        });
        let (to_a, to_b) =
            ([of_a[0] - of_z[0], of_a[1] - of_z[1]], [of_b[0] - of_z[0], of_b[1] - of_z[1]]);
        let area = to_a[0] * to_b[1] - to_a[1] * to_b[0];
        let inverse = 1.0 / area;
        let along = [to_b[0] - to_a[0], to_b[1] - to_a[1]];
        // Gradients times twice the area: of the hat functions, and of w.
        let [phi_z, phi_a, phi_b] =
            [[-along[1], along[0]], [to_b[1], -to_b[0]], [-to_a[1], to_a[0]]];
        let w = self.cells.w;
        let (rise_a, rise_b) = (w[a] - w[z], w[b] - w[z]);
        let slope = [rise_a * phi_a[0] + rise_b * phi_b[0], rise_a * phi_a[1] + rise_b * phi_b[1]];
        let half = 0.5 * inverse;
        let [of_z, of_a, of_b] =
            [phi_z, phi_a, phi_b].map(|phi| half * (slope[0] * phi[0] + slope[1] * phi[1]));
        self.found.push(cell);
        self.members.push(RingCell {
            cell,
            side,
            inverse,
            area,
            edges: [to_a, to_b],
            work: [of_a, of_b],
            wanted: of_z - self.cells.load(cell, vertex, 0.5 * area),
            outflow: 0.0,
        });
    }

    /// Gives each cell the outflow wanted from it, so that the outflows are as near to the shares of `grad w` as can
    /// be.
    pub(super) fn equilibrate(&mut self) {
        let [before, behind] = self.prescribe();
        self.before = before;
        let mut inflow = -before;
        for member in &mut self.members {
            member.outflow = member.wanted + inflow;
            inflow = member.outflow;
        }
        match self.members.last_mut() {
            Some(last) if self.ends.is_some() => last.outflow = behind,
            _ => self.turn(),
        }
    }

    /// Lets the reaction at the node, as far as the law allows, out through the boundary, and takes the rest away
    /// from all cells in proportion to their areas: then the outflows wanted from the cells and those through the
    /// boundary have the same sum. Returns the outflows through the facets before and behind.
    fn prescribe(&mut self) -> [f64; 2] {
        let reaction: f64 = self.members.iter().map(|member| member.wanted).sum();
        let out = self.ends.map_or([0.0; 2], |ends| self.let_out(ends, reaction));
        let area: f64 = self.members.iter().map(|member| member.area).sum();
        let density = (reaction - out[0] - out[1]) / area;
        self.members.iter_mut().for_each(|member| member.wanted -= density * member.area);
        out
    }

    /// Outflows through two facets of the boundary for a reaction at the node; see [`OpenNode::let_out`].
    fn let_out(&self, ends: [u32; 2], reaction: f64) -> [f64; 2] {
        let mesh = self.cells.mesh;
        let facets: [&Facet<D>; 2] = ends.map(|facet| &mesh.facets()[facet as usize]);
        let lengths = facets.map(|facet| measure(mesh.corners(facet)));
        let conditions = facets.map(|facet| mesh.condition(facet));
        let measure_of = |condition| {
            let both = conditions.iter().zip(lengths).filter(|(of, _)| **of == condition);
            both.map(|(_, length)| length).sum::<f64>()
        };
        let [contact, fixed] = [Condition::Contact, Condition::Fixed].map(measure_of);
        let w = self.cells.w[self.node as usize];
        let node = OpenNode { w, stiffness: self.stiffness(), part: 0.5 * contact, fixed };
        let [of_contact, of_fixed] = node.let_out(self.cells.law, reaction);
        std::array::from_fn(|k| match conditions[k] {
            Condition::Contact => of_contact * (lengths[k] / contact),
            Condition::Fixed => of_fixed * (lengths[k] / fixed),
            Condition::Free => 0.0,
        })
    }

    /// Square of the norm of the gradient of the node's hat function, which is also that of the field that turns once
    /// around the node.
    fn stiffness(&self) -> f64 {
        let squares = self.members.iter().map(|member| {
            let [x, y] = member.along();
            0.5 * member.inverse * (x * x + y * y)
        });
        squares.sum()
    }

    /// Adds the circulation by which the distance from the shares of `grad w` becomes least.
    fn turn(&mut self) {
        let (mut product, mut inflow) = (0.0, -self.before);
        for member in &self.members {
            let [along, mean] = [member.along(), member.mean([member.outflow, -inflow])];
            product += 0.5 * member.inverse * (along[0] * mean[0] + along[1] * mean[1]);
            inflow = member.outflow;
        }
        let strength = -product / self.stiffness();
        // A ring of flat cells keeps its outflows.
        if strength.is_finite() {
            self.members.iter_mut().for_each(|member| member.outflow += strength);
        }
    }

    /// Lists the outflows through all sides at the node.
    pub(super) fn add_to(&self, outflows: &mut Vec<SideOutflow>) {
        if let Some([facet, _]) = self.ends {
            let side = self.sides.of_facets()[facet as usize].side;
            outflows.push(SideOutflow { side, outflow: self.before });
        }
        for &RingCell { cell, side, outflow, .. } in &self.members {
            let outflow = if self.sides.leaves(cell, side) { outflow } else { -outflow };
            outflows.push(SideOutflow { side, outflow });
        }
    }
}

impl RingCell {
    /// b - a: twice the area times the field that turns once around the node.
    fn along(&self) -> [f64; 2] {
        let [to_a, to_b] = self.edges;
        [to_b[0] - to_a[0], to_b[1] - to_a[1]]
    }

    /// Twice the area times the mean of the field with these outflows through zb and za less the shares of `grad w`.
    fn mean(&self, outflows: [f64; 2]) -> [f64; 2] {
        let ([to_a, to_b], [of_a, of_b]) = (self.edges, self.work);
        let [ahead, behind] = [(outflows[0] + of_a) / 3.0, (outflows[1] + of_b) / 3.0];
        std::array::from_fn(|d| {
            ahead * (to_b[d] - 2.0 * to_a[d]) + behind * (to_a[d] - 2.0 * to_b[d])
        })
    }
}
