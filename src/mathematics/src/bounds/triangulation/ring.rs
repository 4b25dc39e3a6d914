//! Flux of a patch in the plane, as that of a [fan](super::fan) in space: the cells around a node in their order, where
//! the outflow of one is an inflow of the next.

use super::SideOutflow;
use super::cells::Cells;
use super::reaction::{OpenFacet, OpenNode};
use super::triangles::Triangle;
use crate::mesh::{Facet, Neighbour, Sides, measure, position};

/// Cell of a ring: the node z and, in the positive sense, two others a and b.
#[derive(Clone, Copy, Debug)]
struct RingCell {
    /// Side zb, beyond which the next cell lies.
    side: u32,
    /// True if the flux through this side is counted out of the cell.
    leaves: bool,
    /// Sum that the outflows must have.
    wanted: f64,
    /// Area.
    area: f64,
    /// Three times the products, over k, of the field that turns once around the node with those of an outflow of 1
    /// through zb, an inflow of 1 through za, and the node's share of `k grad w` with the other sign.
    products: [f64; 3],
    /// Outflow through zb, but for the circulation around the node.
    outflow: f64,
}

/// Cells around a node that are connected through sides with the node: all cells around the node, unless the domain
/// touches itself there.
pub(super) struct Ring<'a, const D: usize, const V: usize> {
    cells: Cells<'a, D, V>,
    sides: &'a Sides<V>,
    triangles: &'a [Triangle],
    members: Vec<RingCell>,
    /// Facets before the first cell and behind the last one; none where the ring is closed.
    ends: Option<[u32; 2]>,
    /// Outflow through the facet before the first cell.
    before: f64,
    /// Square of the norm of the field that turns once around the node, over k.
    turning: f64,
    /// Square of the norm of the gradient of the node's hat function, times k.
    stiffness: f64,
    /// Sum of the outflows that are wanted, and of the areas.
    reaction: f64,
    area: f64,
    /// Strength of the circulation around the node.
    strength: f64,
    /// Node.
    node: u32,
    /// Cells found around the node, in the present ring and in others.
    pub found: Vec<u32>,
}

impl<'a, const D: usize, const V: usize> Ring<'a, D, V> {
    /// Empty ring.
    pub(super) fn new(
        cells: Cells<'a, D, V>,
        sides: &'a Sides<V>,
        triangles: &'a [Triangle],
    ) -> Self {
        Self {
            cells,
            sides,
            triangles,
            members: Vec::new(),
            ends: None,
            before: 0.0,
            turning: 0.0,
            stiffness: 0.0,
            reaction: 0.0,
            area: 0.0,
            strength: 0.0,
            node: u32::MAX,
            found: Vec::new(),
        }
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
        position(&self.cells.mesh.cells()[cell as usize], self.node)
    }

    /// Takes the cells from this one on, in the positive sense; returns the facet at the end, if there is one.
    fn follow(&mut self, first: u32) -> Option<u32> {
        self.members.clear();
        [self.turning, self.stiffness, self.reaction, self.area] = [0.0; 4];
        let w = self.cells.w;
        let of_z = w[self.node as usize];
        let mut cell = first;
        loop {
            let vertex = self.vertex(cell);
            let (a, b) = ((vertex + 1) % 3, (vertex + 2) % 3);
            let side = self.sides.numbers(cell)[a];
            let next = self.sides.across(cell, side);
            let nodes = &self.cells.mesh.cells()[cell as usize];
            let (of_a, of_b) = (w[nodes[a] as usize], w[nodes[b] as usize]);
            let Triangle { couplings, area } = self.triangles[cell as usize];
            let (ab, zb, za) = (couplings[vertex], couplings[a], couplings[b]);
            let k = self.cells.mesh.k(cell as usize);
            // The couplings are over k, and these are flows of `k grad w`.
            let factor = k * k;
            let [to_a, to_b] = [za * (of_a - of_z), zb * (of_b - of_z)].map(|flow| factor * flow);
            let across = factor * (ab * (of_b - of_a));
            // See `Triangle::turn`.
            let (ahead, behind) = (zb + zb + za, zb + za + za);
            let wanted = -(to_a + to_b) - self.cells.load(cell, vertex, area);
            self.turning += za + zb;
            self.stiffness += factor * (za + zb);
            self.reaction += wanted;
            self.area += area;
            self.found.push(cell);
            self.members.push(RingCell {
                side,
                leaves: !matches!(next, Neighbour::Cell(next) if next < cell),
                wanted,
                area,
                products: [ahead, behind, ahead * (to_a - across) - behind * (to_b + across)],
                outflow: 0.0,
            });
            match next {
                Neighbour::Facet(facet) => return Some(facet),
                Neighbour::Cell(next) if next == first => return None,
                Neighbour::Cell(next) => cell = next,
            }
        }
    }

    /// Gives each cell the outflow wanted from it, so that the outflows are as near to the shares of `k grad w` as can
    /// be.
    ///
    /// The reaction at the node leaves, as far as the law allows, through the boundary; the rest is taken away from all
    /// cells in proportion to their areas: then the outflows wanted from the cells and those through the boundary have
    /// the same sum.
    pub(super) fn equilibrate(&mut self) {
        let [before, behind] = self.ends.map_or([0.0; 2], |ends| self.let_out(ends));
        let density = (self.reaction - before - behind) / self.area;
        self.before = before;
        let (mut inflow, mut product) = (-before, 0.0);
        for member in &mut self.members {
            let [of_outflow, of_inflow, of_share] = member.products;
            member.outflow = member.wanted - density * member.area + inflow;
            product += of_outflow * member.outflow + of_inflow * inflow + of_share;
            inflow = member.outflow;
        }
        self.strength = 0.0;
        match self.members.last_mut() {
            Some(last) if self.ends.is_some() => last.outflow = behind,
            _ => {
                // The circulation by which the distance from the shares of `k grad w` becomes least.
                let strength = -product / (3.0 * self.turning);
                // A ring of flat cells keeps its outflows.
                self.strength = if strength.is_finite() { strength } else { 0.0 };
            }
        }
    }

    /// Outflows through two facets of the boundary for the reaction at the node; see [`OpenNode::let_out`].
    fn let_out(&self, ends: [u32; 2]) -> [f64; 2] {
        let mesh = self.cells.mesh;
        let mut facets = ends.map(|facet| {
            let facet: &Facet<D> = &mesh.facets()[facet as usize];
            let law = mesh.law_at(facet, self.node);
            OpenFacet { law, measure: measure(mesh.corners(facet)), outflow: 0.0 }
        });
        let (w, stiffness) = (self.cells.w[self.node as usize], self.stiffness);
        OpenNode::<D> { w, stiffness }.let_out(&mut facets, self.reaction);
        facets.map(|facet| facet.outflow)
    }

    /// Lists the outflows through all sides at the node.
    pub(super) fn add_to(&self, outflows: &mut Vec<SideOutflow>) {
        if let Some([facet, _]) = self.ends {
            let side = self.sides.of_facets()[facet as usize].side;
            outflows.push(SideOutflow { side, outflow: self.before });
        }
        for &RingCell { side, leaves, outflow, .. } in &self.members {
            let outflow = outflow + self.strength;
            outflows.push(SideOutflow { side, outflow: if leaves { outflow } else { -outflow } });
        }
    }
}
