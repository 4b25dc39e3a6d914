//! Flux of a patch in space: the part of the flux that belongs to the hat function of one node (Braess and Schöberl
//! 2008). In the plane it is that of a [ring](super::ring).

use super::SideOutflow;
use super::cells::Cells;
use super::few::FewNumbers;
use super::reaction::{OpenFacet, OpenNode};
use super::tetrahedra::Tetrahedron;
use crate::mesh::{Facet, Mesh, Neighbour, Sides, difference, measure};

/// Cell of a fan: the node and, in the order of the cell, three others a, b and c.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    /// Number of the cell.
    cell: u32,
    /// Nodes a, b and c.
    pub others: [u32; 3],
    /// Sides opposite to a, b and c.
    sides: [u32; 3],
    /// True for the sides through which fluxes are counted out of this cell.
    leaves: [bool; 3],
    /// Outflows through these sides; there is none through the side opposite to the node.
    pub outflows: [f64; 3],
    /// Sum that the outflows must have.
    wanted: f64,
    /// Shape.
    pub shape: Tetrahedron,
    /// Way to a cell nearer to the first one.
    parent: Parent,
}

/// Way from a cell of a fan to the cell from which the search came.
#[derive(Clone, Copy, Debug, Default)]
struct Parent {
    /// Position of that cell among the members.
    member: usize,
    /// Position of the common side among the sides of that cell.
    from: usize,
    /// Position of the common side among the sides of the cell.
    slot: usize,
}

/// Side of a fan on the boundary, at the node.
#[derive(Clone, Copy, Debug)]
struct FanOutlet {
    /// Position of its cell among the members.
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
    sides: &'a Sides<V>,
    cells: Cells<'a, D, V>,
    pub members: Vec<Member>,
    outlets: Vec<FanOutlet>,
    /// Node.
    node: u32,
    /// Cells found around the node, in the present fan and in others.
    pub found: Vec<u32>,
    /// Positions of these cells in the list.
    places: FewNumbers,
}

impl<'a, const D: usize, const V: usize> Fan<'a, D, V> {
    /// Empty fan.
    pub(super) fn new(cells: Cells<'a, D, V>, sides: &'a Sides<V>) -> Self {
        let (members, outlets) = (Vec::new(), Vec::new());
        let (found, places) = (Vec::new(), FewNumbers::default());
        Self { mesh: cells.mesh, sides, cells, members, outlets, node: u32::MAX, found, places }
    }

    /// Forgets all fans, and takes another node, with so many cells.
    pub(super) fn begin(&mut self, node: u32, cells: usize) {
        self.node = node;
        self.found.clear();
        self.places.clear(cells);
    }

    /// Replaces the fan by the one of a cell around the node.
    pub(super) fn find(&mut self, cell: u32) {
        self.members.clear();
        self.outlets.clear();
        self.places.number_or(cell, self.found.len() as u32);
        self.push(cell, u32::MAX, Parent::default());
        let mut place = 0;
        while let Some(&Member { cell, sides, parent, .. }) = self.members.get(place) {
            for (slot, side) in sides.into_iter().enumerate() {
                if place > 0 && slot == parent.slot {
                    continue;
                }
                match self.sides.across(cell, side) {
                    Neighbour::Facet(facet) => {
                        self.members[place].leaves[slot] = true;
                        self.outlets.push(FanOutlet { member: place, slot, facet });
                    }
                    Neighbour::Cell(next) => {
                        self.members[place].leaves[slot] = cell < next;
                        let new = self.found.len() as u32;
                        if self.places.number_or(next, new) == new {
                            self.push(next, side, Parent { member: place, from: slot, slot: 0 });
                        }
                    }
                }
            }
            place += 1;
        }
    }

    /// Adds a cell that was reached through a side.
    fn push(&mut self, cell: u32, side: u32, parent: Parent) {
        self.found.push(cell);
        let (nodes, numbers) = (&self.mesh.cells()[cell as usize], self.sides.numbers(cell));
        let vertex = nodes.iter().position(|&node| node == self.node);
        let vertex = vertex.expect("sides of a fan have the node");
        let (points, w) = (self.mesh.points(), self.cells.w);
        let (origin, value) = (points[self.node as usize], w[self.node as usize]);
        let (mut others, mut sides, mut slot) = ([0; 3], [0; 3], 0);
        let (mut edges, mut rises) = ([[0.0; 3]; 3], [0.0; 3]);
        for rank in 0..3 {
            let k = if rank < vertex { rank } else { rank + 1 };
            (others[rank], sides[rank]) = (nodes[k], numbers[k]);
            slot = if sides[rank] == side { rank } else { slot };
            let edge = difference(points[nodes[k] as usize], origin);
            edges[rank].iter_mut().zip(edge).for_each(|(place, x)| *place = x);
            rises[rank] = w[nodes[k] as usize] - value;
        }
        let shape = Tetrahedron::new(edges, rises);
        let load = self.cells.load(cell, vertex, shape.volume());
        let mut leaves = [false; 3];
        leaves[slot] = self.members.get(parent.member).is_some_and(|before| cell < before.cell);
        self.members.push(Member {
            cell,
            others,
            sides,
            leaves,
            outflows: [0.0; 3],
            wanted: -shape.work.iter().sum::<f64>() - load,
            shape,
            parent: Parent { slot, ..parent },
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
        let (mut reaction, mut stiffness, mut volume) = (0.0, 0.0, 0.0);
        for &Member { wanted, shape, .. } in &self.members {
            reaction += wanted;
            stiffness += shape.stiffness;
            volume += shape.volume();
        }
        let mut kept = 0.0;
        if !self.is_closed() {
            let mut facets = Vec::with_capacity(self.outlets.len());
            for outlet in &self.outlets {
                let facet = self.facet(*outlet);
                let (law, measure) = (self.mesh.law(facet), measure(self.mesh.corners(facet)));
                facets.push(OpenFacet { law, measure, outflow: 0.0 });
            }
            let w = self.cells.w[self.node as usize];
            kept = OpenNode::<D> { w, stiffness }.let_out(&mut facets, reaction);
            for (outlet, OpenFacet { outflow, .. }) in self.outlets.iter().zip(facets) {
                self.members[outlet.member].outflows[outlet.slot] = outflow;
            }
        }
        let density = (reaction - kept) / volume;
        for member in &mut self.members {
            member.wanted -= density * member.shape.volume();
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
            for k in 0..3 {
                // The other cell of the side has the opposite outflow.
                if member.leaves[k] {
                    let (side, outflow) = (member.sides[k], member.outflows[k]);
                    outflows.push(SideOutflow { side, outflow });
                }
            }
        }
    }
}
