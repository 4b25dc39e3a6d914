//! Quadratic psi in the plane, where sweeps over nodes and sides are slow, as on stretched cells: the flux of least
//! norm among all that differ by such a circulation, by multigrid.
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
use crate::mesh::{Condition, Element, Sides, measure};
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
    /// Number of the unknown that is each value: along a facet whose flux stays as it is, all values are one unknown.
    unknowns: Vec<u32>,
    /// Number of unknowns.
    count: usize,
}

/// Lowers the norm of a flux on a mesh in the plane by a quadratic psi. The outflow of each cell stays, and the law
/// allows the outflows through the boundary in contact: where a step exceeds a limit, the flux stays, and psi is found
/// again.
pub(super) fn circulate_quadratic<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    flux: &mut [SideFlux<D>],
) {
    let mut stays = without_room(cells, sides, flux);
    for _ in 0..MOST_TIMES {
        let stream = QuadraticStream::new(cells, sides, &stays);
        let Some(psi) = stream.best(forest, flux) else { return };
        let steps = stream.steps(&psi);
        let mut part = 1.0f64;
        for ((at, stays), law) in sides.of_facets().iter().zip(&mut stays).zip(laws(cells)) {
            let (flux, steps) = (flux[at.side as usize], steps[at.side as usize]);
            let allowed = law.map_or(1.0, |law| {
                let parts =
                    flux.iter().zip(steps).map(|(flux, step)| law.part_of_step(*flux, step));
                parts.fold(1.0, f64::min)
            });
            *stays |= allowed < WHOLE;
            part = part.min(allowed);
        }
        for (flux, steps) in flux.iter_mut().zip(&steps) {
            flux.iter_mut().zip(steps).for_each(|(flux, step)| *flux += part * step);
        }
        // Where a limit is met, rounding decides the side.
        for (at, law) in sides.of_facets().iter().zip(laws(cells)) {
            let flux = &mut flux[at.side as usize];
            *flux = flux.map(|flux| law.map_or(flux, |law| law.clamp(flux)));
        }
        if part >= WHOLE {
            return;
        }
    }
}

/// Law on each facet; none where the boundary is fixed or free.
fn laws<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
) -> impl Iterator<Item = Option<PartLaw>> {
    let mesh = cells.mesh;
    mesh.facets().iter().map(move |facet| {
        let is_in_contact = mesh.condition(facet) == Condition::Contact;
        is_in_contact.then(|| PartLaw::new(cells.law, measure(mesh.corners(facet))))
    })
}

/// Facets through which there is no flux, or that the law leaves hardly any room, in the order of the facets.
fn without_room<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &[SideFlux<D>],
) -> Vec<bool> {
    let mesh = cells.mesh;
    let (mut whole, mut length) = (0.0, 0.0);
    for (facet, at) in mesh.facets().iter().zip(sides.of_facets()) {
        whole += flux[at.side as usize].iter().sum::<f64>().abs() / D as f64;
        length += measure(mesh.corners(facet));
    }
    let facets = mesh.facets().iter().zip(sides.of_facets()).zip(laws(cells));
    let stays = facets.map(|((facet, at), law)| match law {
        None => mesh.condition(facet) == Condition::Free,
        Some(law) => {
            let least = LEAST_ROOM * whole * (measure(mesh.corners(facet)) / length);
            flux[at.side as usize].iter().any(|flux| law.room(*flux) <= least)
        }
    });
    stays.collect()
}

impl<'a, const D: usize, const V: usize> QuadraticStream<'a, D, V> {
    /// Unknowns, with the facets whose flux stays as it is.
    fn new(cells: &'a Cells<'a, D, V>, sides: &'a Sides<V>, stays: &[bool]) -> Self {
        let nodes = cells.w.len() as u32;
        let mut first: Vec<u32> = (0..nodes + sides.len() as u32).collect();
        let facets = cells.mesh.facets().iter().zip(sides.of_facets()).zip(stays);
        for ((facet, at), _) in facets.filter(|(_, stays)| **stays) {
            for node in facet.nodes {
                let [one, other] = [nodes + at.side, node].map(|place| first_of(&mut first, place));
                first[one.max(other) as usize] = one.min(other);
            }
        }
        // Each value points to one before it: to one that has its number already.
        let (mut unknowns, mut count): (Vec<u32>, u32) = (Vec::with_capacity(first.len()), 0);
        for (place, &before) in (0..).zip(&first) {
            let is_new = before == place;
            unknowns.push(if is_new { count } else { unknowns[before as usize] });
            count += u32::from(is_new);
        }
        Self { cells, sides, unknowns, count: count as usize }
    }

    /// psi of least norm with a flux, by its values; none if the numbers are not finite.
    fn best(&self, forest: &CellForest, flux: &[SideFlux<D>]) -> Option<Vec<f64>> {
        let load = self.load(flux);
        let goal = Goal::Kkt(TOLERANCE * largest(&load));
        let params = MultigridParams { goal, max_cycles: MOST_STEPS, ..MultigridParams::default() };
        let networks = [NestedNetwork { network: self.network(forest), parents: Vec::new() }];
        let start = Start { y: None, is_slow: true };
        let problem = Law::SIGNORINI.with_load(&load);
        let found = improve_on_nested_networks(&networks, problem, start, &params).ok()?;
        Some(self.unknowns.iter().map(|&unknown| found.y[unknown as usize]).collect())
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
        let mut load = vec![0.0; self.count];
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
                let [node, midpoint] =
                    [nodes[k], self.midpoint(cell, k)].map(|place| self.unknown(place));
                load[node as usize] -= product(element.volume, &sigma, &of_node);
                load[midpoint as usize] -= of_bubble(&element, &sigma, k);
            }
        }
        load
    }

    /// Products of the fields of all unknowns, one of which is kept at zero in each part of the domain: a constant has
    /// no field.
    fn network(&self, forest: &CellForest) -> Network {
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
        for coupling in &mut couplings {
            coupling.nodes = coupling.nodes.map(|place| self.unknown(place));
        }
        couplings.retain(|coupling| coupling.nodes[0] != coupling.nodes[1]);
        let first = |tree| self.unknown(self.nodes(forest.root(tree))[0]);
        let kept = (0..forest.trees()).map(first).collect();
        Network::new(&couplings, Vec::new(), kept, vec![1.0; self.count])
    }

    fn unknown(&self, place: u32) -> u32 {
        self.unknowns[place as usize]
    }

    /// Fluxes of the field of psi through all sides.
    fn steps(&self, psi: &[f64]) -> Vec<SideFlux<D>> {
        let mut steps = vec![[0.0; D]; self.sides.len()];
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
        steps
    }
}

/// First value of the unknown that is the one at this place, with shorter ways from now on.
fn first_of(first: &mut [u32], mut place: u32) -> u32 {
    while first[place as usize] != place {
        let before = first[place as usize];
        first[place as usize] = first[before as usize];
        place = before;
    }
    place
}
