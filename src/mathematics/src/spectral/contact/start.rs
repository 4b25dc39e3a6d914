//! Contact set with which Newton's method begins, of a finite element solution.

use crate::discrete::contact::reach;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::load::LoadRule;
use crate::mesh::{
    AnyMesh, ClosedCurve, NestedMeshes, PlaneMesh, boundary_curves, mesh_load, nested_meshes,
    square_boundary,
};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::complex::Complex;
use crate::problem::law::{BoundaryState, Law};
use crate::problem::source::Source;
use crate::spectral::geometry::ring::{PlaneRing, RingContact, StateChange};
use crate::spectral::geometry::side::SidePlace;
use crate::spectral::problem::PlaneProblem;
use crate::square::load::load;
use crate::square::multigrid::solve_square;
use std::collections::HashMap;

/// Most refinements of the first mesh.
const MOST_TIMES: usize = 12;

/// Contact set with which Newton's method begins.
#[derive(Clone, Debug)]
pub(in crate::spectral) struct PlaneStart {
    /// Arcs that stick, loop by loop. What they say of fixed and free sides is not read.
    pub contact: Vec<RingContact>,
    /// Length of the edges of the mesh that it is from: arcs and gaps of one or two are left out.
    pub spacing: f64,
}

/// Finite element solution on the boundary.
pub(in crate::spectral) struct DiscreteStart {
    /// v at all nodes.
    y: Vec<f64>,
    /// States of the nodes where the law holds.
    states: HashMap<usize, BoundaryState>,
    curves: Vec<ClosedCurve>,
}

impl DiscreteStart {
    /// Solution on the finest refinement of a mesh with no more nodes than this, about; none if there is no solution.
    pub(in crate::spectral) fn on_mesh(
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
        Some(Self::new(judge(network, &y, &load), y, boundary_curves(finest)))
    }

    /// Solution on the grid of the square with so many cells per side; none if there is no solution.
    pub(in crate::spectral) fn on_square(cells: usize, f: &Source, law: Law) -> Option<Self> {
        let grid = Grid::new(cells).ok()?;
        let load = load(grid, f, LoadRule::Bilinear {});
        let params = MultigridParams::default();
        let (y, _) = solve_square(cells, law, &load, &params).ok()?;
        Some(Self::new(judge((grid, law), &y, &load), y, vec![square_boundary(grid, law)]))
    }

    fn new(judgement: Judgement, y: Vec<f64>, curves: Vec<ClosedCurve>) -> Self {
        let nodes = judgement.contact.iter().map(|contact| contact.node);
        let states = nodes.zip(judgement.states.iter().copied()).collect();
        Self { y, states, curves }
    }

    /// Contact set on the loops of a problem, with the fluxes of its law.
    pub(in crate::spectral) fn seen(
        &self,
        PlaneProblem { domain, law, .. }: &PlaneProblem,
    ) -> PlaneStart {
        let mut curves = self.curves.clone();
        for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
            *point = domain.frame.seen(*point).coordinates();
        }
        let spacing = curves.iter().map(longest_edge).fold(0.0, f64::max);
        let mut contact = Vec::with_capacity(domain.rings.len());
        for ring in &domain.rings {
            let distances = curves.iter().map(|curve| ring.nearest(place_of(curve, 0)).1);
            let nearest = distances.enumerate().min_by(|one, other| one.1.total_cmp(&other.1));
            let (number, _) = nearest.expect("as many curves as loops");
            let nodes = NodesOfLoop::new(&curves[number], ring, &self.y, &self.states);
            contact.push(nodes.contact(*law));
        }
        PlaneStart { contact, spacing }
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
    /// v.
    values: Vec<f64>,
    /// States; a fixed node sticks, one of a free part slips by the sign of v.
    states: Vec<BoundaryState>,
}

impl<'a> NodesOfLoop<'a> {
    fn new(
        curve: &'a ClosedCurve,
        ring: &'a PlaneRing,
        y: &[f64],
        states: &HashMap<usize, BoundaryState>,
    ) -> Self {
        let values: Vec<f64> = curve.nodes.iter().map(|&node| y[node]).collect();
        let mut own = Vec::new();
        for (k, node) in curve.nodes.iter().enumerate() {
            own.push(match states.get(node) {
                Some(state) => *state,
                None if values[k] == 0.0 => BoundaryState::Sticks,
                None if values[k] > 0.0 => BoundaryState::SlipsUp,
                None => BoundaryState::SlipsDown,
            });
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

    /// Arcs that stick, and the flux on the gaps; where v changes its sign a short arc.
    fn contact(&self, law: Law) -> RingContact {
        let mut changes = Vec::new();
        for k in (0..self.many()).filter(|&k| self.state(k) != self.state(k + 1)) {
            let [begin, end] = match (self.sticks(k), self.sticks(k + 1)) {
                (false, true) => [Some(self.beginning(k + 1)), None],
                (true, _) => [None, Some(self.end(k))],
                (false, false) => self.arc_between(k).map(Some),
            };
            let flux = Some(flux(self.state(k + 1), law));
            changes.extend(begin.map(|at| StateChange { at, flux: None }));
            changes.extend(end.map(|at| StateChange { at, flux }));
        }
        let all = (!self.sticks(0)).then(|| flux(self.state(0), law));
        RingContact::of_changes(self.ring.length(), &changes, all)
    }

    /// Beginning of an arc at its first node.
    fn beginning(&self, k: usize) -> f64 {
        let many = self.many();
        let before = k + many - 1;
        if ![before, k].iter().all(|&k| self.law(k).may_move()) {
            return self.place(k, 0.0);
        }
        let beyond = reach([self.value(before), self.value(before + many - 1)]);
        self.place(before, 1.0 - beyond.clamp(0.05, 0.95))
    }

    /// End of an arc at its last node.
    fn end(&self, k: usize) -> f64 {
        let before = k + self.many() - 1;
        if ![before, k].iter().all(|&k| self.law(k).may_move()) {
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

/// Flux on a gap where v has a sign.
fn flux(state: BoundaryState, law: Law) -> f64 {
    let is_down = state == BoundaryState::SlipsDown && law.hi().is_finite();
    if is_down || law.lo().is_infinite() { law.hi() } else { law.lo() }
}
