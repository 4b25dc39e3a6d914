//! Cells around a node in space that are connected through sides with the node. In the plane they are a
//! [ring](super::ring).
//!
//! The other nodes are the vertices of a surface of triangles, one for each cell. On refined meshes most of these
//! surfaces are one of few. Each is a plan: a fan that follows one needs no search, and the fluxes of fans with the
//! same plan are found side by side.

use super::SideOutflow;
use super::cells::Cells;
use crate::mesh::{Neighbour, Sides, position};

/// Fans whose fluxes are found side by side.
pub(super) const LANES: usize = 8;
/// Number of plans that are kept.
const MOST_PLANS: usize = 256;
/// Number of lists of plans.
const LISTS: usize = 64;
/// Number of plans that a fan is compared with.
const MOST_COMPARED: usize = 12;
/// Number of the edges without a circulation.
const NONE: usize = 0;

/// Cell of a fan: the node and three others a, b and c, around which all members are in the same sense.
#[derive(Clone, Copy)]
pub(super) struct Member {
    /// Positions of a, b and c among the other nodes of the fan.
    pub others: [usize; 3],
    /// Numbers of the circulations around the edges to a, b and c.
    pub circulations: [usize; 3],
    /// Position of what lies beyond the sides opposite to a, b and c, among the members or the outlets.
    beyond: [Neighbour; 3],
    /// Member from which the search came through the side opposite to a, but to the first, and the position there.
    pub parent: [usize; 2],
}

/// Way in which the cells of a fan are connected, and fans that are connected so.
#[derive(Default)]
pub(super) struct FanPlan {
    /// Cells, in the order of the search.
    pub members: Vec<Member>,
    /// Number of other nodes, which are numbered as they are met.
    pub others: usize,
    /// Number of circulations: one around the edge to each node that is not on the boundary. Around a node inside one
    /// of them follows from the others.
    pub circulations: usize,
    /// Members and positions of the sides with the node on the boundary.
    pub outlets: Vec<[usize; 2]>,
    /// Nodes whose fluxes are not yet found, at most [`LANES`].
    pub nodes: Vec<u32>,
    /// Cells, with the positions of the nodes among their vertices, other nodes and facets of each, one row behind the
    /// other, with room for one more.
    pub cells: Vec<(u32, u32)>,
    pub other_nodes: Vec<u32>,
    pub facets: Vec<u32>,
    /// Positions of their first outflows in the list.
    starts: Vec<usize>,
}

/// Node of a mesh.
#[derive(Clone, Copy)]
struct FanNode<'a, const D: usize, const V: usize> {
    cells: Cells<'a, D, V>,
    sides: &'a Sides<V>,
    node: u32,
}

/// Fans of nodes, one after the other.
pub(super) struct Fans<'a, const D: usize, const V: usize> {
    at: FanNode<'a, D, V>,
    /// Cells found around the node, in the present fan and in others.
    pub found: Vec<u32>,
    plans: Vec<FanPlan>,
    /// Plans by the number of cells with the node.
    lists: [Vec<usize>; LISTS],
    /// Plan that is not kept.
    other: FanPlan,
}

impl<'a, const D: usize, const V: usize> Fans<'a, D, V> {
    /// No fans.
    pub(super) fn new(cells: Cells<'a, D, V>, sides: &'a Sides<V>) -> Self {
        let at = FanNode { cells, sides, node: u32::MAX };
        let lists = std::array::from_fn(|_| Vec::new());
        Self { at, found: Vec::new(), plans: Vec::new(), lists, other: FanPlan::default() }
    }

    /// Takes another node.
    pub(super) fn begin(&mut self, node: u32) {
        self.at.node = node;
        self.found.clear();
    }

    /// Takes the fan of a cell around the node, with so many cells; lists all sides with the node, with the signs of
    /// the outflows. Returns a plan with which no further fan can wait.
    pub(super) fn take(
        &mut self,
        cell: u32,
        count: usize,
        outflows: &mut Vec<SideOutflow>,
    ) -> Option<&mut FanPlan> {
        let Self { at, found, plans, lists, other } = self;
        let list = &mut lists[count % LISTS];
        for place in 0..list.len().min(MOST_COMPARED) {
            let number = list[place];
            if plans[number].follow(at, cell, found, outflows) {
                // The plans that are followed most come first.
                list.swap(place, place / 2);
                return Some(&mut plans[number]).filter(|plan| plan.nodes.len() == LANES);
            }
        }
        let mut plan = at.search(cell);
        let is_followed = plan.follow(at, cell, found, outflows);
        assert!(is_followed, "a fan follows its own plan");
        // A sphere or disc, by Euler's formula: no other surface is wrapped around it several times, and could follow
        // its plan.
        let is_simple = 2 * plan.others > plan.members.len() + plan.outlets.len();
        if is_simple && plans.len() < MOST_PLANS {
            list.push(plans.len());
            plans.push(plan);
            return None;
        }
        *other = plan;
        Some(other)
    }

    /// Plans that are kept.
    pub(super) fn plans(&mut self) -> &mut [FanPlan] {
        &mut self.plans
    }
}

impl<const D: usize, const V: usize> FanNode<'_, D, V> {
    /// Positions of the node and of a, b and c among the vertices of a cell, of which b and c may be known.
    #[inline(always)]
    fn order(&self, cell: u32, known: Option<[u32; 2]>) -> (usize, [usize; 3]) {
        let nodes = &self.cells.mesh.cells()[cell as usize];
        let vertex = position(nodes, self.node);
        match known {
            Some([b, c]) => {
                let [b, c] = [position(nodes, b), position(nodes, c)];
                // The four positions have the sum 6.
                (vertex, [6 - vertex - b - c, b, c])
            }
            None => (vertex, [0, 1, 2].map(|slot| if slot < vertex { slot } else { slot + 1 })),
        }
    }

    /// Finds the plan of the fan of a cell.
    fn search(&self, cell: u32) -> FanPlan {
        let (mut plan, mut nodes) = (FanPlan::default(), Vec::new());
        let (mut cells, mut parents) = (vec![cell], vec![[0; 2]]);
        let mut place = 0;
        while let Some(&cell) = cells.get(place) {
            let parent: [usize; 2] = parents[place];
            let known = plan.members.get(parent[0]).map(|before: &Member| {
                [2, 1].map(|step| nodes[before.others[(parent[1] + step) % 3]])
            });
            let (mut others, mut beyond) = ([0; 3], [Neighbour::Cell(0); 3]);
            for (slot, k) in self.order(cell, known).1.into_iter().enumerate() {
                others[slot] = place_of(self.cells.mesh.cells()[cell as usize][k], &mut nodes);
                beyond[slot] = match self.sides.across(cell, self.sides.numbers(cell)[k]) {
                    Neighbour::Facet(_) => {
                        plan.outlets.push([place, slot]);
                        Neighbour::Facet(plan.outlets.len() as u32 - 1)
                    }
                    Neighbour::Cell(next) => {
                        let next = place_of(next, &mut cells);
                        if next == parents.len() {
                            parents.push([place, slot]);
                        }
                        Neighbour::Cell(next as u32)
                    }
                };
            }
            plan.members.push(Member { others, circulations: [NONE; 3], beyond, parent });
            place += 1;
        }
        plan.others = nodes.len();
        plan.number();
        plan
    }
}

/// Place of a number in a list, at whose end it is put if it is new.
fn place_of(number: u32, list: &mut Vec<u32>) -> usize {
    let place = list.iter().position(|other| *other == number);
    place.unwrap_or_else(|| {
        list.push(number);
        list.len() - 1
    })
}

impl FanPlan {
    /// Numbers the circulations, and makes room for the fans.
    fn number(&mut self) {
        let mut is_inside = vec![true; self.others];
        for &[member, slot] in &self.outlets {
            for step in [1, 2] {
                is_inside[self.members[member].others[(slot + step) % 3]] = false;
            }
        }
        if self.outlets.is_empty() {
            is_inside[0] = false;
        }
        let mut numbers = vec![NONE; self.others];
        for (number, _) in numbers.iter_mut().zip(is_inside).filter(|(_, is_inside)| *is_inside) {
            self.circulations += 1;
            *number = self.circulations;
        }
        for member in &mut self.members {
            member.circulations = member.others.map(|other| numbers[other]);
        }
        self.cells = vec![(0, 0); LANES * self.members.len()];
        self.other_nodes = vec![0; LANES * self.others];
        self.facets = vec![0; LANES * self.outlets.len()];
    }

    /// Lets the fan of a cell wait with the others, if it is connected in this way; returns whether it is.
    fn follow<const D: usize, const V: usize>(
        &mut self,
        at: &FanNode<'_, D, V>,
        cell: u32,
        found: &mut Vec<u32>,
        outflows: &mut Vec<SideOutflow>,
    ) -> bool {
        let start = outflows.len();
        if !self.compare(at, cell, outflows) {
            outflows.truncate(start);
            return false;
        }
        let row = &self.cells[self.nodes.len() * self.members.len()..];
        found.extend(row[..self.members.len()].iter().map(|(cell, _)| *cell));
        self.nodes.push(at.node);
        self.starts.push(start);
        true
    }

    fn compare<const D: usize, const V: usize>(
        &mut self,
        at: &FanNode<'_, D, V>,
        cell: u32,
        outflows: &mut Vec<SideOutflow>,
    ) -> bool {
        let row = self.nodes.len();
        let cells = &mut self.cells[row * self.members.len()..][..self.members.len()];
        let facets = &mut self.facets[row * self.outlets.len()..][..self.outlets.len()];
        let others = &mut self.other_nodes[row * self.others..][..self.others];
        let (mut reached, mut met) = (1, 0);
        cells[0].0 = cell;
        for (place, member) in self.members.iter().enumerate() {
            let cell = cells[place].0;
            let [_, b, c] = member.others;
            let (vertex, slots) = at.order(cell, (place > 0).then(|| [others[b], others[c]]));
            cells[place].1 = vertex as u32;
            let (nodes, sides) = (&at.cells.mesh.cells()[cell as usize], at.sides.numbers(cell));
            // But for the first cell b and c are known, and beyond the side opposite to a is the parent.
            let first = usize::from(place > 0);
            for slot in 0..3 - 2 * first {
                let (other, node) = (member.others[slot], nodes[slots[slot]]);
                if other == met {
                    others[other] = node;
                    met += 1;
                } else if others[other] != node {
                    return false;
                }
            }
            for slot in first..3 {
                let (side, mut outflow) = (sides[slots[slot]], 1.0);
                match (member.beyond[slot], at.sides.across(cell, side)) {
                    (Neighbour::Facet(outlet), Neighbour::Facet(facet)) => {
                        facets[outlet as usize] = facet;
                    }
                    (Neighbour::Cell(next), Neighbour::Cell(beyond)) => {
                        let next = next as usize;
                        if next == reached {
                            cells[next].0 = beyond;
                            reached += 1;
                        } else if cells[next].0 != beyond {
                            return false;
                        }
                        if next < place {
                            continue;
                        }
                        outflow = if cell < beyond { 1.0 } else { -1.0 };
                    }
                    _ => return false,
                }
                outflows.push(SideOutflow { side, outflow });
            }
        }
        true
    }

    /// Puts outflows of the members through the sides opposite to a, b and c of the fans that wait into the list, which
    /// has their signs.
    pub(super) fn put<'f>(
        &mut self,
        fluxes: impl Fn(usize) -> &'f [[f64; LANES]; 3],
        outflows: &mut [SideOutflow],
    ) {
        for (lane, &start) in self.starts.iter().enumerate() {
            let mut place = outflows[start..].iter_mut();
            for (number, member) in self.members.iter().enumerate() {
                for (slot, flux) in fluxes(number).iter().enumerate() {
                    if !matches!(member.beyond[slot], Neighbour::Cell(other) if other as usize <= number)
                    {
                        place.next().expect("listed before").outflow *= flux[lane];
                    }
                }
            }
        }
        self.nodes.clear();
        self.starts.clear();
    }
}
