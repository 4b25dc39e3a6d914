//! Variation of the flux along the sides in the plane, by which the norm of sigma becomes smaller: whatever it is, the
//! outflow of each cell stays.
//!
//! As in `stream.rs`, the field `(d psi/dy, -d psi/dx)` has no divergence. Here psi is a sum of bubbles `4 p q` on the
//! sides, p and q the hat functions of the ends: the flux through a side becomes linear along it, as sigma on the cells
//! can be any linear field then.

use super::cells::Cells;
use super::linear::{SideFlux, at_vertices, outflows, product};
use crate::machine::threads::{items_per_task, map_range};
use crate::mesh::{BoundarySide, Element, Neighbour, Sides};

/// Numbers whose work takes as long as that on a cell.
const COST: usize = 32;
/// Number of cells between which their parts are added to the sides.
const RUN: usize = 1 << 14;

/// Sum of bubbles.
struct Bubbles<'a, const D: usize, const V: usize> {
    sides: &'a Sides<V>,
    /// Factor of the bubble of each side.
    psi: Vec<f64>,
    /// Minus the products of the flux with the fields of the bubbles.
    load: Vec<f64>,
    /// Minus the products of the gradients of the hat functions at both ends of each side, for each cell.
    couplings: Vec<[f64; V]>,
    /// Greatest factor of the bubble of each facet that the law allows.
    limits: Vec<f64>,
}

/// Gives the flux through each side the variation of the least norm within the law, in one sweep over all sides forth
/// and one back. In space there is none.
pub(super) fn vary<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &mut [SideFlux<D>],
) {
    if D != 2 {
        return;
    }
    let mut bubbles = Bubbles::<D, V>::new(cells, sides, flux);
    let count = (V * cells.mesh.cells().len()) as u32;
    let mut relaxed = |place: u32| bubbles.relax(place / V as u32, place as usize % V);
    (0..count).for_each(&mut relaxed);
    (0..count).rev().for_each(relaxed);
    bubbles.add_to(cells, flux);
}

impl<'a, const D: usize, const V: usize> Bubbles<'a, D, V> {
    /// No bubbles, with what the best ones depend on.
    fn new(cells: &Cells<'_, D, V>, sides: &'a Sides<V>, flux: &[SideFlux<D>]) -> Self {
        let mesh = cells.mesh;
        let count = mesh.cells().len();
        let of_cell = |cell: usize| {
            let nodes = &mesh.cells()[cell];
            let vertices = mesh.vertices(nodes);
            let element = Element::new(vertices);
            let outflows = outflows(sides, cell as u32, nodes, flux);
            let sigma = at_vertices(&vertices, element.volume, &outflows);
            let coupling = |k: usize| -element.stiffness((k + 1) % V, (k + 2) % V);
            let loads: [f64; V] = std::array::from_fn(|k| -of_bubble(&element, &sigma, k));
            (std::array::from_fn(coupling), loads)
        };
        let (mut load, mut couplings) = (vec![0.0; sides.len()], Vec::with_capacity(count));
        for start in (0..count).step_by(RUN) {
            let run = start..count.min(start + RUN);
            let each = items_per_task(run.len(), COST);
            for (cell, (coupling, loads)) in (start..).zip(map_range(run, each, of_cell)) {
                couplings.push(coupling);
                for (side, of_cell) in sides.numbers(cell as u32).into_iter().zip(loads) {
                    load[side as usize] += of_cell;
                }
            }
        }
        let facets = mesh.facets().iter().zip(sides.of_facets());
        let limits = facets.map(|(facet, &BoundarySide { side, .. })| {
            let room = flux[side as usize].map(|flux| cells.interval(facet).room(flux));
            0.25 * room.into_iter().fold(f64::INFINITY, f64::min).max(0.0)
        });
        let limits = limits.collect();
        Self { sides, psi: vec![0.0; sides.len()], load, couplings, limits }
    }

    /// Gives the bubble on the side of a cell opposite to one of its vertices the factor of the least norm, if the flux
    /// is counted out of this cell.
    #[inline(always)]
    fn relax(&mut self, cell: u32, k: usize) {
        let side = self.sides.numbers(cell)[k];
        if !self.sides.leaves(cell, side) {
            return;
        }
        let [mut sum, mut diagonal] = self.row(cell, k);
        let mut limit = f64::INFINITY;
        match self.sides.across(cell, side) {
            Neighbour::Cell(next) => {
                let [of_next, own] = self.row(next, self.sides.slot(next, side));
                sum += of_next;
                diagonal += own;
            }
            Neighbour::Facet(facet) => limit = self.limits[facet as usize],
        }
        let psi = &mut self.psi[side as usize];
        let best = (self.load[side as usize] + sum) / diagonal;
        // Flat cells keep their flux.
        if best.is_finite() {
            *psi = best.clamp(-limit, limit);
        }
    }

    /// Sum of the products of other bubbles on a cell with that of a side, and minus its product with itself.
    #[inline(always)]
    fn row(&self, cell: u32, k: usize) -> [f64; 2] {
        let (numbers, couplings) = (self.sides.numbers(cell), &self.couplings[cell as usize]);
        let [i, j] = [(k + 1) % V, (k + 2) % V];
        let [of_i, of_j] = [i, j].map(|place| self.psi[numbers[place] as usize]);
        let sum = couplings[j] * of_i + couplings[i] * of_j;
        [sum, couplings.iter().sum()].map(|x| 8.0 / 3.0 * x)
    }

    /// Adds the field of the bubbles to a flux.
    fn add_to(&self, cells: &Cells<'_, D, V>, flux: &mut [SideFlux<D>]) {
        for (number, nodes) in (0..).zip(cells.mesh.cells()) {
            for (k, side) in self.sides.numbers(number).into_iter().enumerate() {
                if self.sides.leaves(number, side) {
                    let [from, to] = [1, 2].map(|step| nodes[(k + step) % V]);
                    let slope = if from < to { 4.0 } else { -4.0 } * self.psi[side as usize];
                    flux[side as usize][0] += slope;
                    flux[side as usize][1] -= slope;
                }
            }
        }
        cells.clamp(self.sides, flux);
    }
}

/// Product of a field on a cell, given by its values at the vertices, and that of the bubble on the side opposite to a
/// vertex.
#[inline(always)]
pub(super) fn of_bubble<const D: usize, const V: usize>(
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
pub(super) fn turned<const D: usize>(gradient: [f64; D]) -> [f64; D] {
    let mut turned = [0.0; D];
    [turned[0], turned[1]] = [gradient[1], -gradient[0]];
    turned
}
