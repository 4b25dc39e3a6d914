//! Contact set with which Newton's method begins, of a finite element solution.

use crate::discrete::contact::reach;
use crate::discrete::kkt::judge;
use crate::mesh::{
    AnyMesh, ClosedCurve, NestedMeshes, PlaneMesh, boundary_curves, mesh_load, nested_meshes,
};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::complex::Complex;
use crate::problem::law::{BoundaryState, Law};
use crate::problem::source::Source;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::ring::{PlaneRing, RingContact, StateChange};
use crate::spectral::geometry::side::SidePlace;
use crate::spectral::problem::PlaneProblem;
use std::collections::HashMap;

/// Most refinements of the first mesh.
const MOST_TIMES: usize = 12;

/// Contact set with which Newton's method begins.
#[derive(Clone, Debug)]
pub(crate) struct PlaneStart {
    /// Arcs that stick, loop by loop. What they say of fixed and free sides is not read.
    pub contact: Vec<RingContact>,
    /// Length of the edges of the mesh that it is from: arcs and gaps of one or two are left out.
    pub spacing: f64,
}

impl PlaneStart {
    /// Contact set on the loops of a problem of the solution on the finest refinement of a mesh with no more nodes than
    /// this, about; none if there is no solution.
    pub(crate) fn on_mesh(
        PlaneProblem { domain, .. }: &PlaneProblem,
        coarsest: &PlaneMesh,
        f: &[Source],
        most_nodes: f64,
    ) -> Option<Self> {
        let of_either = AnyMesh::from(coarsest.clone());
        let fits = (1..=MOST_TIMES).take_while(|&times| of_either.nodes_after(times) <= most_nodes);
        let NestedMeshes { meshes, networks, .. } = nested_meshes(coarsest, fits.count()).ok()?;
        let (finest, network) = (meshes.last()?, &networks.last()?.network);
        let load = mesh_load(finest, f).ok()?.load;
        let params = MultigridParams::default();
        let (y, _) = solve_nested_networks(&networks, &load, &params).ok()?;
        let judgement = judge(network, &y, &load);
        let nodes = judgement.contact.iter().zip(&judgement.states);
        let states = nodes.map(|(own, &state)| (own.node, (state, own.law.at()))).collect();
        let mut curves = boundary_curves(finest);
        for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
            *point = domain.frame.seen(*point).coordinates();
        }
        let spacing = curves.iter().map(longest_edge).fold(0.0, f64::max);
        let mut contact = Vec::with_capacity(domain.rings.len());
        for ring in &domain.rings {
            let distances = curves.iter().map(|curve| ring.nearest(place_of(curve, 0)).1);
            let nearest = distances.enumerate().min_by(|one, other| one.1.total_cmp(&other.1));
            let (number, _) = nearest.expect("as many curves as loops");
            contact.push(NodesOfLoop::new(&curves[number], ring, &y, &states).contact(domain));
        }
        Some(Self { contact, spacing })
    }
}

/// Length of the longest edge of a curve.
fn longest_edge(curve: &ClosedCurve) -> f64 {
    let edges = (0..curve.points.len()).map(|k| place_of(curve, k + 1) - place_of(curve, k));
    edges.map(Complex::norm).fold(0.0, f64::max)
}

/// Point of a curve after so many edges.
fn place_of(curve: &ClosedCurve, node: usize) -> Complex {
    let [x, y] = curve.points[node % curve.points.len()];
    Complex::new(x, y)
}

/// Boundary nodes on a loop, in walking order.
struct NodesOfLoop<'a> {
    curve: &'a ClosedCurve,
    ring: &'a PlaneRing,
    /// v less the value of the law.
    values: Vec<f64>,
    /// States; a fixed node sticks, one of a free part slips by the sign of v.
    states: Vec<BoundaryState>,
}

impl<'a> NodesOfLoop<'a> {
    fn new(
        curve: &'a ClosedCurve,
        ring: &'a PlaneRing,
        y: &[f64],
        states: &HashMap<usize, (BoundaryState, f64)>,
    ) -> Self {
        let (mut values, mut own) = (Vec::new(), Vec::new());
        for (k, node) in curve.nodes.iter().enumerate() {
            let beside = [k, (k + curve.nodes.len() - 1) % curve.nodes.len()];
            let (state, at) = match states.get(node) {
                Some(own) => *own,
                None if beside.iter().any(|&edge| curve.laws[edge].is_fixed()) => {
                    (BoundaryState::Sticks, y[*node])
                }
                None if y[*node] == 0.0 => (BoundaryState::Sticks, 0.0),
                None if y[*node] > 0.0 => (BoundaryState::SlipsUp, 0.0),
                None => (BoundaryState::SlipsDown, 0.0),
            };
            values.push(y[*node] - at);
            own.push(state);
        }
        Self { curve, ring, values, states: own }
    }

    fn many(&self) -> usize {
        self.values.len()
    }

    fn state(&self, k: usize) -> BoundaryState {
        self.states[k % self.many()]
    }

    fn sticks(&self, k: usize) -> bool {
        self.state(k) == BoundaryState::Sticks
    }

    fn value(&self, k: usize) -> f64 {
        self.values[k % self.many()]
    }

    /// Law on the edge after a node.
    fn law(&self, k: usize) -> Law {
        self.curve.laws[k % self.many()]
    }

    /// Arcs that stick, and the states of the gaps; where v changes its sign a short arc. Where no law of the domain
    /// lets v leave its value in a direction, gaps have the other.
    fn contact(&self, domain: &PlaneDomain) -> RingContact {
        let laws: Vec<Law> =
            domain.sides().map(|own| own.law).filter(|law| law.may_move()).collect();
        let goes_up = laws.is_empty() || laws.iter().any(|law| law.lo().is_finite());
        let goes_down = laws.iter().any(|law| law.hi().is_finite());
        let slips = |k: usize| match self.state(k) {
            BoundaryState::SlipsDown if goes_down => BoundaryState::SlipsDown,
            _ if goes_up => BoundaryState::SlipsUp,
            _ => BoundaryState::SlipsDown,
        };
        let mut changes = Vec::new();
        for k in (0..self.many()).filter(|&k| self.state(k) != self.state(k + 1)) {
            let [begin, end] = match (self.sticks(k), self.sticks(k + 1)) {
                (false, true) => [Some(self.beginning(k + 1)), None],
                (true, _) => [None, Some(self.end(k))],
                (false, false) => self.arc_between(k).map(Some),
            };
            changes.extend(begin.map(|at| StateChange { at, state: BoundaryState::Sticks }));
            changes.extend(end.map(|at| StateChange { at, state: slips(k + 1) }));
        }
        let all = if self.sticks(0) { BoundaryState::Sticks } else { slips(0) };
        RingContact::of_changes(self.ring.length(), &changes, all)
    }

    /// True if a law that may move goes on from one edge to another.
    fn goes_on(&self, [before, after]: [usize; 2]) -> bool {
        self.law(before).may_move() && self.law(before) == self.law(after)
    }

    /// Beginning of an arc at its first node.
    fn beginning(&self, k: usize) -> f64 {
        let many = self.many();
        let before = k + many - 1;
        if !self.goes_on([before, k]) {
            return self.place(k, 0.0);
        }
        let beyond = reach([self.value(before), self.value(before + many - 1)]);
        self.place(before, 1.0 - beyond.clamp(0.05, 0.95))
    }

    /// End of an arc at its last node.
    fn end(&self, k: usize) -> f64 {
        let before = k + self.many() - 1;
        if !self.goes_on([before, k]) {
            return self.place(before, 1.0);
        }
        let beyond = reach([self.value(k + 1), self.value(k + 2)]);
        self.place(k, beyond.clamp(0.05, 0.95))
    }

    /// Ends of a short arc where v changes its sign after a node.
    fn arc_between(&self, k: usize) -> [f64; 2] {
        /// Half of its length, in edges: at a longer one a node would stick.
        const HALF: f64 = 0.1;
        let zero = self.value(k) / (self.value(k) - self.value(k + 1));
        let middle = if zero.is_finite() { zero.clamp(2.0 * HALF, 1.0 - 2.0 * HALF) } else { 0.5 };
        [-HALF, HALF].map(|part| self.place(k, middle + part))
    }

    /// Distance along the loop of a place on the edge after a node, by the part of the edge before it.
    fn place(&self, k: usize, part: f64) -> f64 {
        let [a, b] = [k, k + 1].map(|k| place_of(self.curve, k));
        let (side, _) = self.ring.nearest((a + b).scaled(0.5));
        let s = self.ring.sides[side].nearest(a + (b - a).scaled(part));
        self.ring.along(SidePlace { side, s })
    }
}
