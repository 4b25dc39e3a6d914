//! Variation of the flux along the sides in the plane, by which the norm of sigma becomes smaller: whatever it is, the
//! outflow of each cell stays.
//!
//! As in `stream.rs`, the field `(d psi/dy, -d psi/dx)` has no divergence. Here psi is a sum of bubbles `4 p q` on the
//! sides, p and q the hat functions of the ends: the flux through a side becomes linear along it, as sigma on the cells
//! can be any linear field then.

use super::cells::Cells;
use super::linear::SideFlux;
use super::triangles::Triangle;
use crate::mesh::{BoundarySide, Neighbour, Sides};

/// Sum of bubbles. Products of fields are 3/8 of what they are.
struct Bubbles<'a, const V: usize> {
    sides: &'a Sides<V>,
    triangles: &'a [Triangle],
    /// Factor of the bubble of each side.
    psi: Vec<f64>,
    /// Minus the products, over k, of the flux with the fields of the bubbles.
    load: Vec<f64>,
    /// Greatest factor of the bubble of each facet that the law allows.
    limits: Vec<f64>,
}

/// Gives the flux through each side, constant along it, the variation of the least norm, less twice the integral of the
/// values of laws times the flux, within the law, in one sweep over all sides forth and one back.
pub(super) fn vary<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    triangles: Vec<Triangle>,
    flux: Vec<f64>,
) -> Vec<SideFlux<D>> {
    let mut bubbles = Bubbles::new(cells, sides, &triangles, &flux);
    let count = triangles.len() as u32;
    (0..count).for_each(|cell| bubbles.relax(cell, [0, 1, 2]));
    (0..count).rev().for_each(|cell| bubbles.relax(cell, [2, 1, 0]));
    let psi = bubbles.psi;
    // The memory is that of the mesh several times.
    drop((bubbles.load, triangles));
    let mut flux: Vec<_> = flux.into_iter().map(|flux| [flux; D]).collect();
    add(&psi, cells, sides, &mut flux);
    flux
}

impl<'a, const V: usize> Bubbles<'a, V> {
    /// No bubbles, with what the best ones depend on.
    fn new<const D: usize>(
        cells: &Cells<'_, D, V>,
        sides: &'a Sides<V>,
        triangles: &'a [Triangle],
        flux: &[f64],
    ) -> Self {
        let mut load = vec![0.0; sides.len()];
        for (number, &Triangle { couplings: c, .. }) in (0..).zip(triangles) {
            let (numbers, q) = (sides.numbers(number), sides.outflows(number, flux));
            for k in 0..3 {
                let [i, j] = [(k + 1) % 3, (k + 2) % 3];
                // A bubble does as much work along its side as two thirds of the flux in the middle.
                let of_others = (q[i] - q[j]) * (c[i] + c[j]);
                load[numbers[k] as usize] += 0.25 * (q[k] * (c[j] - c[i]) + of_others);
            }
        }
        for facet in cells.facets_with_values() {
            // See `add`: the flux at the first end grows by four times the bubble.
            let [from, to] = cells.values(sides, facet);
            load[sides.of_facets()[facet].side as usize] += 0.25 * (from - to);
        }
        let facets = cells.mesh.facets().iter().zip(sides.of_facets());
        let limits = facets.map(|(facet, &BoundarySide { side, .. })| {
            0.25 * cells.interval(facet).room(flux[side as usize]).max(0.0)
        });
        let limits = limits.collect();
        Self { sides, triangles, psi: vec![0.0; sides.len()], load, limits }
    }

    /// Gives the bubbles on the sides of a cell, in this order, the factors of the least norm, each if the flux is
    /// counted out of this cell.
    #[inline(always)]
    fn relax(&mut self, cell: u32, order: [usize; 3]) {
        let (numbers, couplings) =
            (self.sides.numbers(cell), self.triangles[cell as usize].couplings);
        for k in order {
            let side = numbers[k];
            let (mut of_next, mut limit) = ([0.0; 2], f64::INFINITY);
            match self.sides.across(cell, side) {
                Neighbour::Cell(next) if next < cell => continue,
                Neighbour::Cell(next) => {
                    let couplings = self.triangles[next as usize].couplings;
                    of_next =
                        self.row(&self.sides.numbers(next), couplings, self.sides.slot(next, side));
                }
                Neighbour::Facet(facet) => limit = self.limits[facet as usize],
            }
            let [sum, square] = self.row(&numbers, couplings, k);
            let best = (self.load[side as usize] + sum + of_next[0]) / (square + of_next[1]);
            // Flat cells keep their flux.
            if best.is_finite() {
                self.psi[side as usize] = best.clamp(-limit, limit);
            }
        }
    }

    /// Minus the sum of the products of other bubbles on a cell with that of a side, and its product with itself.
    #[inline(always)]
    fn row(&self, numbers: &[u32; V], couplings: [f64; 3], k: usize) -> [f64; 2] {
        let [i, j] = [[1, 2], [2, 0], [0, 1]][k];
        let [of_i, of_j] = [i, j].map(|k| self.psi[numbers[k] as usize]);
        let sum = couplings[j] * of_i + couplings[i] * of_j;
        [sum, couplings.iter().sum()]
    }
}

/// Adds the field of bubbles with these factors to a flux.
fn add<const D: usize, const V: usize>(
    psi: &[f64],
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &mut [SideFlux<D>],
) {
    for (number, nodes) in (0..).zip(cells.mesh.cells()) {
        for (k, side) in sides.numbers(number).into_iter().enumerate() {
            if sides.leaves(number, side) {
                let [from, to] = [1, 2].map(|step| nodes[(k + step) % V]);
                let slope = if from < to { 4.0 } else { -4.0 } * psi[side as usize];
                flux[side as usize][0] += slope;
                flux[side as usize][1] -= slope;
            }
        }
    }
    cells.clamp(sides, flux);
}
