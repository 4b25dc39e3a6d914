//! Quadratic psi in the plane on stretched cells, where sweeps over nodes and sides are slow: the flux of least norm,
//! less the values of laws as in `stream.rs`, among all that differ by such a circulation, by multigrid.
//!
//! On a cell that is long and thin against the direction of the gradient, the flux of each patch leaves through the
//! wrong sides, over as many cells as there are across the domain. Aggregates along strong couplings reach them.

use super::cells::Cells;
use super::forest::CellForest;
use super::limits::FacetLimits;
use super::linear::{SideFlux, at_vertices, outflows, product};
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::{Coupling, Network};
use crate::mesh::{Element, Sides, volume};
use crate::multigrid::{Goal, MultigridParams};
use crate::multilevel::{Start, improve_on_nested_networks};
use crate::problem::law::{Law, LawSum};

/// Times that psi is found while the flux through some facets may change, at most.
const MOST_TIMES: usize = 3;
/// Most steps of multigrid.
const MOST_STEPS: usize = 60;
/// Change of a flux by rounding, over the largest flux, at most.
const ROUNDING: f64 = 1e-12;
/// Part of the square of the distance between the gradient and the flux that need not be gained.
const NEAR: f64 = 0.01;

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
/// allows the outflows through the boundary in contact: where the best psi exceeds a limit, the flux is put there and
/// stays, the flux through the rest of the boundary makes up for the difference, and psi is found again.
///
/// `distance` is the square of the distance between the gradient and the flux, which falls as that of the norm does.
pub(super) fn circulate_quadratic<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    distance: f64,
    flux: &mut Vec<SideFlux<D>>,
) {
    let (first, before) = (flux.clone(), square(cells, sides, flux));
    let mut limits = FacetLimits::new(cells, sides, flux);
    let (mut now, mut moved) = (before, 0.0);
    for time in 0..=MOST_TIMES {
        if time == MOST_TIMES {
            limits.hold_all();
        }
        let stream = QuadraticStream::new(cells, sides, &limits);
        let left = distance - (before - now);
        let Some(psi) = stream.best(forest, flux, left) else { break };
        stream.add(&psi, flux);
        let best = square(cells, sides, flux);
        let on_boundary = limits.exceeded_by(flux);
        on_boundary.iter().for_each(|psi| stream.add(psi, flux));
        moved += cells.clamp(sides, flux);
        now = square(cells, sides, flux);
        if on_boundary.is_none() || now - best <= NEAR * (distance - (before - now)) {
            break;
        }
    }
    // What puts a flux within the law may change no more than rounding does, which the bounds have room for.
    let largest = first.as_flattened().iter().fold(0.0f64, |largest, flux| flux.abs().max(largest));
    if now >= before || now.is_nan() || moved > ROUNDING * largest {
        *flux = first;
    }
}

/// Square of the norm of a flux, over k, less twice the integral of the values of laws times it over the boundary.
fn square<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &[SideFlux<D>],
) -> f64 {
    let mut square = 0.0;
    for (cell, nodes) in (0..).zip(cells.mesh.cells()) {
        let vertices = cells.mesh.vertices(nodes);
        let volume = volume(vertices);
        let field = at_vertices(&vertices, volume, &outflows(sides, cell, nodes, flux));
        square += product(volume, &field, &field) / cells.mesh.k(cell as usize);
    }
    for facet in cells.facets_with_values() {
        let at = &sides.of_facets()[facet];
        let (nodes, k) = (&cells.mesh.cells()[at.cell as usize], sides.slot(at.cell, at.side));
        let [mut one, mut two] = cells.values(sides, facet);
        if nodes[(k + 1) % V] > nodes[(k + 2) % V] {
            std::mem::swap(&mut one, &mut two);
        }
        let [q, p] = [0, 1].map(|k| flux[at.side as usize][k]);
        square -= (one * (2.0 * q + p) + two * (q + 2.0 * p)) / 3.0;
    }
    square
}

impl<'a, const D: usize, const V: usize> QuadraticStream<'a, D, V> {
    /// Unknowns, with the facets whose flux stays as it is.
    fn new(cells: &'a Cells<'a, D, V>, sides: &'a Sides<V>, limits: &FacetLimits) -> Self {
        let nodes = cells.w.len() as u32;
        let mut first: Vec<u32> = (0..nodes + sides.len() as u32).collect();
        for (side, ends) in limits.held() {
            for node in ends {
                let [one, other] = [nodes + side, node].map(|place| first_of(&mut first, place));
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

    /// psi of least norm with a flux, by its values, where this is the square of the distance of the flux from the
    /// gradient; none if the numbers are not finite.
    fn best(&self, forest: &CellForest, flux: &[SideFlux<D>], distance: f64) -> Option<Vec<f64>> {
        let load = self.load(flux);
        let goal = Goal::Gain(0.5 * distance);
        let params = MultigridParams { goal, max_cycles: MOST_STEPS, ..MultigridParams::default() };
        let networks = [NestedNetwork { network: self.network(forest), parents: Vec::new() }];
        let start = Start { y: None, is_slow: true };
        let found = improve_on_nested_networks(&networks, &load, start, &params).ok()?;
        Some(self.unknowns.iter().map(|&unknown| found.y[unknown as usize]).collect())
    }

    fn nodes(&self, cell: u32) -> [u32; V] {
        self.cells.mesh.cells()[cell as usize]
    }

    /// Place of the value at the midpoint of the side of a cell opposite to one of its vertices.
    fn midpoint(&self, cell: u32, opposite: usize) -> u32 {
        self.cells.w.len() as u32 + self.sides.numbers(cell)[opposite]
    }

    /// Minus the products, over k, of a flux with the fields of all values.
    fn load(&self, flux: &[SideFlux<D>]) -> Vec<f64> {
        let mut load = vec![0.0; self.count];
        for cell in 0..self.cells.mesh.cells().len() as u32 {
            let nodes = self.nodes(cell);
            let vertices = self.cells.mesh.vertices(&nodes);
            let element = Element::new(vertices);
            let outflows = outflows(self.sides, cell, &nodes, flux);
            let mut sigma = at_vertices(&vertices, element.volume, &outflows);
            let k = self.cells.mesh.k(cell as usize);
            sigma.as_flattened_mut().iter_mut().for_each(|x| *x /= k);
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
        // See `add`: what each value changes in the integral of the values of laws times the flux.
        for facet in self.cells.facets_with_values() {
            let at = &self.sides.of_facets()[facet];
            let (nodes, k) = (self.nodes(at.cell), self.sides.slot(at.cell, at.side));
            let [from, to] = self.cells.values(self.sides, facet);
            let changes = [
                (nodes[(k + 1) % V], -(5.0 * from + to) / 6.0),
                (nodes[(k + 2) % V], (from + 5.0 * to) / 6.0),
                (self.midpoint(at.cell, k), 2.0 * (from - to) / 3.0),
            ];
            for (place, change) in changes {
                load[self.unknown(place) as usize] += change;
            }
        }
        load
    }

    /// Products, over k, of the fields of all unknowns, one of which is kept at zero in each part of the domain: a
    /// constant has no field.
    fn network(&self, forest: &CellForest) -> Network {
        let mut of_sides = vec![([0; 2], 0.0); self.sides.len()];
        let mut couplings =
            Vec::with_capacity(3 * (self.cells.mesh.cells().len() + self.sides.len()));
        for cell in 0..self.cells.mesh.cells().len() as u32 {
            let nodes = self.nodes(cell);
            let element = Element::new(self.cells.mesh.vertices(&nodes));
            for k in 0..V {
                let [i, j] = [(k + 1) % V, (k + 2) % V];
                let stiffness = element.stiffness(i, j) / self.cells.mesh.k(cell as usize);
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
        let kept = (0..forest.trees())
            .map(|tree| LawSum::of(Law::FIXED, 1.0).at_node(first(tree) as usize));
        Network::new(&couplings, kept.collect(), vec![1.0; self.count])
    }

    fn unknown(&self, place: u32) -> u32 {
        self.unknowns[place as usize]
    }

    /// Adds the field of psi to a flux.
    fn add(&self, psi: &[f64], flux: &mut [SideFlux<D>]) {
        for cell in 0..self.cells.mesh.cells().len() as u32 {
            let nodes = self.nodes(cell);
            for (k, side) in self.sides.numbers(cell).into_iter().enumerate() {
                if self.sides.leaves(cell, side) {
                    let [from, to] = [1, 2].map(|step| nodes[(k + step) % V]);
                    let [a, b] = [from, to].map(|node| psi[node as usize]);
                    let middle = psi[self.midpoint(cell, k) as usize];
                    // Along a facet whose flux stays all values are equal, and the differences zero.
                    let [of_from, of_to] = [middle - a, b - middle].map(|step| step + step);
                    let flux = &mut flux[side as usize];
                    flux[usize::from(from > to)] += of_from + (of_from - of_to) / 2.0;
                    flux[usize::from(from < to)] += of_to + (of_to - of_from) / 2.0;
                }
            }
        }
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

/// Product of a field on a cell, given by its values at the vertices, and that of the bubble on the side opposite to a
/// vertex.
#[inline(always)]
fn of_bubble<const D: usize, const V: usize>(
    element: &Element<D, V>,
    sigma: &[[f64; D]; V],
    k: usize,
) -> f64 {
    let [i, j] = [(k + 1) % V, (k + 2) % V];
    let mut field = [[0.0; D]; V];
    field[i] = turned(element.gradients[j].map(|x| 4.0 * x));
    field[j] = turned(element.gradients[i].map(|x| 4.0 * x));
    product(element.volume, sigma, &field)
}

/// Field of a linear psi with this gradient.
fn turned<const D: usize>(gradient: [f64; D]) -> [f64; D] {
    let mut turned = [0.0; D];
    [turned[0], turned[1]] = [gradient[1], -gradient[0]];
    turned
}
