//! Quadratic psi in the plane, where sweeps over nodes and sides are slow, as on stretched cells: the flux of least norm
//! among all that differ by such a circulation, by multigrid.
//!
//! On a cell that is long and thin against the direction of the gradient, the flux of each patch leaves through the
//! wrong sides, over as many cells as there are across the domain. Aggregates along strong couplings reach them.

use super::cells::Cells;
use super::forest::CellForest;
use super::linear::{SideFlux, at_vertices, outflows, product};
use super::vary::{of_bubble, turned};
use crate::bounds::boundary::PartLaw;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::{Coupling, Network};
use crate::discrete::norms::largest;
use crate::mesh::{BoundarySide, Condition, Element, Sides, measure};
use crate::multigrid::{Goal, MultigridParams};
use crate::multilevel::{Start, improve_on_nested_networks};
use crate::problem::law::Law;

/// Times that psi is found, at most.
const MOST_TIMES: usize = 4;
/// Part of psi that counts as all of it.
const WHOLE: f64 = 0.95;
/// Most steps of multigrid.
const MOST_STEPS: usize = 20;
/// Residual over the largest load that is small enough.
const TOLERANCE: f64 = 1e-3;
/// Distance of the flux through a facet in contact from the ends of the interval, over its part of the whole flux, up
/// to which the flux stays as it is.
const LEAST_ROOM: f64 = 0.05;

/// psi on each cell: values at all nodes, then at the midpoints of all sides.
struct QuadraticStream<'a, const D: usize, const V: usize> {
    cells: &'a Cells<'a, D, V>,
    sides: &'a Sides<V>,
    /// Flag for each value, true if it is kept at zero.
    is_kept: Vec<bool>,
}

/// Lowers the norm of a flux on a mesh in the plane by a quadratic psi. The outflow of each cell stays, and the law
/// allows the outflows through the boundary in contact: where a step meets a limit, psi is kept there, and found again.
pub(super) fn circulate_quadratic<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    flux: &mut [SideFlux<D>],
) {
    for _ in 0..MOST_TIMES {
        if step(cells, sides, forest, flux) > WHOLE {
            return;
        }
    }
}

/// Adds the best psi to a flux; returns the part of it that the law allows.
fn step<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    flux: &mut [SideFlux<D>],
) -> f64 {
    let is_kept = vec![false; cells.w.len() + sides.len()];
    let mut stream = QuadraticStream { cells, sides, is_kept };
    stream.keep_on_boundary(flux);
    stream.keep_in_each(forest);
    let load = stream.load(flux);
    let goal = Goal::Kkt(TOLERANCE * largest(&load));
    let params = MultigridParams { goal, max_cycles: MOST_STEPS, ..MultigridParams::default() };
    let networks = [NestedNetwork { network: stream.network(), parents: Vec::new() }];
    let start = Start { y: None, is_slow: true };
    let problem = Law::SIGNORINI.with_load(&load);
    match improve_on_nested_networks(&networks, problem, start, &params) {
        Ok(found) => stream.add_to(&found.y, flux),
        Err(_) => 1.0,
    }
}

impl<const D: usize, const V: usize> QuadraticStream<'_, D, V> {
    /// Keeps psi on the facets through which there is no flux, or hardly any that the law allows to be changed, and at
    /// nodes where the domain touches itself.
    fn keep_on_boundary(&mut self, flux: &[SideFlux<D>]) {
        let mesh = self.cells.mesh;
        let facets = || mesh.facets().iter().zip(self.sides.of_facets());
        let (mut whole, mut length) = (0.0, 0.0);
        let mut counts = vec![0u8; self.cells.w.len()];
        for (facet, at) in facets() {
            facet.nodes.iter().for_each(|&node| counts[node as usize] += 1);
            whole += flux[at.side as usize].iter().sum::<f64>().abs() / D as f64;
            length += measure(mesh.corners(facet));
        }
        for (facet, &BoundarySide { side, .. }) in facets() {
            let measure = measure(mesh.corners(facet));
            let law = PartLaw::new(self.cells.law, measure);
            let least = LEAST_ROOM * whole * (measure / length);
            let keeps = match mesh.condition(facet) {
                Condition::Free => true,
                Condition::Fixed => false,
                Condition::Contact => flux[side as usize].iter().any(|q| law.room(*q) <= least),
            };
            self.is_kept[counts.len() + side as usize] = keeps;
            for node in facet.nodes.map(|node| node as usize) {
                self.is_kept[node] |= keeps || counts[node] != 2;
            }
        }
    }

    /// Keeps a value in each part of the domain where all are open: a constant has no field.
    fn keep_in_each(&mut self, forest: &CellForest) {
        for tree in 0..forest.trees() {
            let mut nodes = forest.cells(tree).iter().flat_map(|&cell| self.nodes(cell));
            if !nodes.any(|node| self.is_kept[node as usize]) {
                let first = self.nodes(forest.root(tree))[0];
                self.is_kept[first as usize] = true;
            }
        }
    }

    fn nodes(&self, cell: u32) -> [u32; V] {
        self.cells.mesh.cells()[cell as usize]
    }

    /// Place of the value at the midpoint of the side of a cell opposite to one of its vertices.
    fn midpoint(&self, cell: u32, opposite: usize) -> u32 {
        self.cells.w.len() as u32 + self.sides.numbers(cell)[opposite]
    }

    /// Minus the products of a flux with the fields of all values.
    fn load(&self, flux: &[SideFlux<D>]) -> Vec<f64> {
        let mut load = vec![0.0; self.is_kept.len()];
        for cell in 0..self.cells.mesh.cells().len() as u32 {
            let nodes = self.nodes(cell);
            let vertices = self.cells.mesh.vertices(&nodes);
            let element = Element::new(vertices);
            let outflows = outflows(self.sides, cell, &nodes, flux);
            let sigma = at_vertices(&vertices, element.volume, &outflows);
            let turned = element.gradients.map(turned);
            for k in 0..V {
                let mut of_node = [turned[k].map(|x| -x); V];
                of_node[k] = turned[k].map(|x| 3.0 * x);
                load[nodes[k] as usize] -= product(element.volume, &sigma, &of_node);
                load[self.midpoint(cell, k) as usize] -= of_bubble(&element, &sigma, k);
            }
        }
        load
    }

    /// Products of the fields of all values.
    fn network(&self) -> Network {
        let mut of_sides = vec![([0; 2], 0.0); self.sides.len()];
        let mut couplings =
            Vec::with_capacity(3 * (self.cells.mesh.cells().len() + self.sides.len()));
        for cell in 0..self.cells.mesh.cells().len() as u32 {
            let nodes = self.nodes(cell);
            let element = Element::new(self.cells.mesh.vertices(&nodes));
            for k in 0..V {
                let [i, j] = [(k + 1) % V, (k + 2) % V];
                let stiffness = element.stiffness(i, j);
                let of_side = &mut of_sides[self.sides.numbers(cell)[k] as usize];
                *of_side = ([nodes[i], nodes[j]], of_side.1 + stiffness);
                let ends = [i, j].map(|opposite| self.midpoint(cell, opposite));
                couplings.push(Coupling { nodes: ends, weight: -8.0 / 3.0 * stiffness });
            }
        }
        for (midpoint, &([i, j], stiffness)) in (self.cells.w.len() as u32..).zip(&of_sides) {
            couplings.push(Coupling { nodes: [i, j], weight: stiffness / 3.0 });
            for node in [i, j] {
                let weight = -4.0 / 3.0 * stiffness;
                couplings.push(Coupling { nodes: [node, midpoint], weight });
            }
        }
        let kept = (0..).zip(&self.is_kept).filter(|(_, is_kept)| **is_kept);
        let kept = kept.map(|(place, _)| place).collect();
        Network::new(&couplings, Vec::new(), kept, vec![1.0; self.is_kept.len()])
    }

    /// Adds the field of psi to a flux, as far as the law allows; returns the part of it that is added.
    fn add_to(&self, psi: &[f64], flux: &mut [SideFlux<D>]) -> f64 {
        let mesh = self.cells.mesh;
        let mut steps = vec![[0.0; D]; flux.len()];
        for cell in 0..self.cells.mesh.cells().len() as u32 {
            let nodes = self.nodes(cell);
            for (k, side) in self.sides.numbers(cell).into_iter().enumerate() {
                if self.sides.leaves(cell, side) {
                    let [from, to] = [1, 2].map(|step| nodes[(k + step) % V]);
                    let [a, b] = [from, to].map(|node| psi[node as usize]);
                    let middle = psi[self.midpoint(cell, k) as usize];
                    let [out_from, out_to] =
                        [4.0 * middle - 3.0 * a - b, a + 3.0 * b - 4.0 * middle];
                    let step = &mut steps[side as usize];
                    step[usize::from(from > to)] = out_from;
                    step[usize::from(from < to)] = out_to;
                }
            }
        }
        let contact = || {
            let facets = mesh.facets().iter().zip(self.sides.of_facets());
            let contact = facets.filter(|(facet, _)| mesh.condition(facet) == Condition::Contact);
            contact.map(|(facet, at)| {
                (at.side as usize, PartLaw::new(self.cells.law, measure(mesh.corners(facet))))
            })
        };
        let mut part = 1.0f64;
        for (side, law) in contact() {
            for (flux, step) in flux[side].iter().zip(steps[side]) {
                part = part.min(law.part_of_step(*flux, step));
            }
        }
        for (flux, step) in flux.iter_mut().zip(&steps) {
            flux.iter_mut().zip(step).for_each(|(flux, step)| *flux += part * step);
        }
        // Where a limit is met, rounding decides the side.
        for (side, law) in contact() {
            flux[side] = flux[side].map(|flux| law.clamp(flux));
        }
        part
    }
}
