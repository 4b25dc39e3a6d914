//! Flux of a patch in space: the part of the flux that belongs to the hat function of one node (Braess and Schöberl
//! 2008). In the plane it is that of a [ring](super::ring).

use super::SideOutflow;
use super::cells::{Cell, Cells};
use super::reaction::OpenNode;
use crate::mesh::{Condition, Element, Facet, Mesh, Neighbour, Sides, measure};

/// Cell of a fan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member<const V: usize> {
    /// Number of the cell.
    pub cell: u32,
    /// Cell.
    pub data: Cell<V>,
    /// Position of the node among the vertices.
    pub vertex: usize,
    /// Outflows through the sides; none through the side opposite to the node.
    pub outflows: [f64; V],
    /// In space, number of the circulation around the edge to each other vertex.
    pub numbers: [u32; V],
    /// Sum that the outflows must have.
    wanted: f64,
    /// Way to a cell nearer to the first one.
    parent: Parent,
}

/// Way from a cell of a fan to the cell from which the search came.
#[derive(Clone, Copy, Debug)]
struct Parent {
    /// Position of that cell among the members.
    member: usize,
    /// Position of the common side among the sides of the cell.
    slot: usize,
    /// Position of the common side among the sides of that cell.
    from: usize,
}

/// Side of a fan on the boundary, at the node.
#[derive(Clone, Copy, Debug)]
struct FanOutlet {
    /// Position of the cell among the members.
    member: usize,
    /// Position of the side among the sides of the cell.
    slot: usize,
    /// Position of the facet.
    facet: u32,
}

/// Cells around a node that are connected through sides with the node: all cells around the node, unless the domain
/// touches itself there.
pub(super) struct Fan<'a, const D: usize, const V: usize> {
    pub mesh: &'a Mesh<D, V>,
    pub sides: &'a Sides<V>,
    cells: Cells<'a, D, V>,
    pub members: Vec<Member<V>>,
    outlets: Vec<FanOutlet>,
    /// Node.
    node: u32,
    /// Cells found around the node, in the present fan and in others.
    pub found: Vec<u32>,
}

impl<'a, const D: usize, const V: usize> Fan<'a, D, V> {
    /// Empty fan.
    pub(super) fn new(cells: Cells<'a, D, V>, sides: &'a Sides<V>) -> Self {
        let (members, outlets, found) = (Vec::new(), Vec::new(), Vec::new());
        Self { mesh: cells.mesh, sides, cells, members, outlets, node: u32::MAX, found }
    }

    /// Forgets all fans, and takes another node.
    pub(super) fn begin(&mut self, node: u32) {
        self.node = node;
        self.found.clear();
    }

    /// Replaces the fan by the one of a cell around the node.
    pub(super) fn find(&mut self, cell: u32) {
        self.members.clear();
        self.outlets.clear();
        self.push(cell, Parent { member: 0, slot: 0, from: 0 });
        let mut place = 0;
        while let Some(&Member { cell, vertex, .. }) = self.members.get(place) {
            for (slot, side) in self.sides.numbers(cell).into_iter().enumerate() {
                if slot == vertex {
                    continue;
                }
                match self.sides.across(cell, side) {
                    Neighbour::Facet(facet) => {
                        self.outlets.push(FanOutlet { member: place, slot, facet });
                    }
                    Neighbour::Cell(next) if !self.found.contains(&next) => {
                        let back = self.sides.slot(next, side);
                        let parent = Parent { member: place, slot: back, from: slot };
                        self.push(next, parent);
                    }
                    Neighbour::Cell(_) => (),
                }
            }
            place += 1;
        }
    }

    fn push(&mut self, cell: u32, parent: Parent) {
        self.found.push(cell);
        let nodes = &self.mesh.cells()[cell as usize];
        let vertex = nodes.iter().position(|&node| node == self.node);
        let vertex = vertex.expect("sides of a fan have the node");
        let data = self.cells.cell(cell);
        let wanted = data.work[vertex] - data.load[vertex];
        self.members.push(Member {
            cell,
            data,
            vertex,
            outflows: [0.0; V],
            numbers: [0; V],
            wanted,
            parent,
        });
    }

    /// True if no side of the fan with the node is on the boundary.
    pub(super) fn is_closed(&self) -> bool {
        self.outlets.is_empty()
    }

    /// Nodes of the facets of the boundary at the node.
    pub(super) fn boundary_nodes(&self) -> impl Iterator<Item = u32> {
        let facets = self.outlets.iter().map(|outlet| self.facet(*outlet));
        facets.flat_map(|facet| facet.nodes)
    }

    fn facet(&self, outlet: FanOutlet) -> &Facet<D> {
        &self.mesh.facets()[outlet.facet as usize]
    }

    /// Lets the reaction at the node, as far as the law allows, out through the boundary, and takes the rest away
    /// from all cells in proportion to their volumes: then the outflows wanted from the cells and those through the
    /// boundary have the same sum.
    pub(super) fn prescribe(&mut self) {
        let reaction: f64 = self.members.iter().map(|member| member.wanted).sum();
        // Each of the D nodes of a facet has the same part of the facet.
        let part = self.measure(Condition::Contact) / D as f64;
        let (w, fixed) = (self.cells.w[self.node as usize], self.measure(Condition::Fixed));
        let node = OpenNode { w, stiffness: self.stiffness(), part, fixed };
        let [contact, through_fixed] = node.let_out(self.cells.law, reaction);
        self.let_out(Condition::Contact, contact);
        self.let_out(Condition::Fixed, through_fixed);
        let kept = contact + through_fixed;
        let volume: f64 = self.members.iter().map(|member| member.data.volume).sum();
        let density = (reaction - kept) / volume;
        for member in &mut self.members {
            member.wanted -= density * member.data.volume;
        }
    }

    /// Square of the norm of the gradient of the node's hat function.
    fn stiffness(&self) -> f64 {
        let members = self.members.iter().map(|&Member { cell, vertex, .. }| {
            let vertices = self.mesh.vertices(&self.mesh.cells()[cell as usize]);
            Element::<D, V>::new(vertices).stiffness(vertex, vertex)
        });
        members.sum()
    }

    /// Measure of the facets at the node with this condition.
    fn measure(&self, condition: Condition) -> f64 {
        let facets = self.outlets.iter().map(|outlet| self.facet(*outlet));
        let open = facets.filter(|facet| self.mesh.condition(facet) == condition);
        open.map(|facet| measure(self.mesh.corners(facet))).sum()
    }

    /// Spreads an outflow over the facets with this condition in proportion to their measures.
    fn let_out(&mut self, condition: Condition, outflow: f64) {
        let total = self.measure(condition);
        for place in 0..self.outlets.len() {
            let outlet = self.outlets[place];
            let facet = self.facet(outlet);
            if self.mesh.condition(facet) == condition {
                let share = measure(self.mesh.corners(facet)) / total;
                self.members[outlet.member].outflows[outlet.slot] = outflow * share;
            }
        }
    }

    /// Gives each cell the outflow wanted from it, through the sides by which the search came.
    pub(super) fn carry(&mut self) {
        for place in (1..self.members.len()).rev() {
            let Member { outflows, wanted, parent, .. } = self.members[place];
            let outflow = wanted - outflows.iter().sum::<f64>();
            self.members[place].outflows[parent.slot] = outflow;
            self.members[parent.member].outflows[parent.from] = -outflow;
        }
    }

    /// Lists the outflows through all sides.
    pub(super) fn add_to(&self, outflows: &mut Vec<SideOutflow>) {
        for member in &self.members {
            for (side, outflow) in self.sides.numbers(member.cell).into_iter().zip(member.outflows)
            {
                // The other cell of the side has the opposite outflow.
                if self.sides.leaves(member.cell, side) {
                    outflows.push(SideOutflow { side, outflow });
                }
            }
        }
    }
}
