//! Variation of the flux along the sides, by which the norm of sigma becomes smaller: whatever it is, the outflow of
//! each cell stays.
//!
//! The part of the flux through a side that varies along it, and has no sum, is supported on the two cells of the side
//! and has no divergence: in the plane it is the field of a quadratic bubble as psi in `stream.rs`. With it the flux of
//! a smooth solution is of second order, not of first.

use super::cells::{Cells, difference};
use super::linear::{SideFlux, at_vertices, outflows, rank, total};
use crate::bounds::boundary::PartLaw;
use crate::mesh::{Condition, Neighbour, Sides, dot, measure, volume};

/// First and second derivatives of the square of the norm by the fluxes at the nodes of a side.
struct SideSquare<const D: usize> {
    first: [f64; D],
    second: [[f64; D]; D],
}

/// Gives the flux through each side the variation of the least norm within the law, in one sweep over all sides forth
/// and one back; returns by how much the last one has lowered the square of the norm.
pub(super) fn vary<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &mut [SideFlux<D>],
) -> f64 {
    let of_cells = cells.f.len() as u32 * V as u32;
    let mut relaxed = |place: u32| relax(cells, sides, flux, [place / V as u32, place % V as u32]);
    (0..of_cells).map(&mut relaxed).for_each(drop);
    (0..of_cells).rev().map(relaxed).sum()
}

/// Relaxes the variation along the side of a cell opposite to one of its vertices, if the flux is counted out of this
/// cell; returns by how much that lowers the square of the norm.
#[inline(always)]
fn relax<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &mut [SideFlux<D>],
    [cell, k]: [u32; 2],
) -> f64 {
    let side = sides.numbers(cell)[k as usize];
    if !sides.leaves(cell, side) {
        return 0.0;
    }
    let mut square = SideSquare { first: [0.0; D], second: [[0.0; D]; D] };
    square.add(cells, sides, flux, [cell, k]);
    let mut law = None;
    match sides.across(cell, side) {
        Neighbour::Cell(next) => {
            let back = sides.slot(next, side) as u32;
            square.add(cells, sides, flux, [next, back]);
        }
        Neighbour::Facet(facet) => {
            let facet = &cells.mesh.facets()[facet as usize];
            match cells.mesh.condition(facet) {
                Condition::Free => return 0.0,
                Condition::Fixed => {}
                Condition::Contact => {
                    law = Some(PartLaw::new(cells.law, measure(cells.mesh.corners(facet))));
                }
            }
        }
    }
    let variation = square.least();
    let of_side = &mut flux[side as usize];
    let mut part = 1.0f64;
    for (flux, step) in of_side.iter().zip(variation) {
        part = law.map_or(1.0, |law| law.part_of_step(*flux, step)).min(part);
    }
    for (flux, step) in of_side.iter_mut().zip(variation) {
        *flux += part * step;
        *flux = law.map_or(*flux, |law| law.clamp(*flux));
    }
    square.gain(variation, part)
}

impl<const D: usize> SideSquare<D> {
    /// Adds the derivatives of the norm on a cell by the outflows through the side opposite to one of its vertices.
    #[inline(always)]
    fn add<const V: usize>(
        &mut self,
        cells: &Cells<'_, D, V>,
        sides: &Sides<V>,
        flux: &[SideFlux<D>],
        [cell, k]: [u32; 2],
    ) {
        let (nodes, k) = (&cells.mesh.cells()[cell as usize], k as usize);
        let vertices = cells.mesh.vertices(nodes);
        let volume = volume(vertices);
        let values = at_vertices(&vertices, volume, &outflows(sides, cell, nodes, flux));
        let sum = total(&values);
        let side = sides.numbers(cell)[k];
        let sign = if sides.leaves(cell, side) { 1.0 } else { -1.0 };
        let scale = 2.0 / (V * (V + 1) * D) as f64;
        let inverse = scale / (D as f64 * volume);
        let mut edges = [[0.0; D]; D];
        for vertex in (0..V).filter(|vertex| *vertex != k) {
            let place = rank(nodes, k, vertex);
            let edge = difference(vertices[vertex], vertices[k]);
            self.first[place] += sign * scale * (dot(values[vertex], edge) + dot(sum, edge));
            edges[place] = edge;
        }
        for i in 0..D {
            for j in 0..=i {
                let hats = if i == j { 2.0 } else { 1.0 };
                self.second[i][j] += inverse * hats * dot(edges[i], edges[j]);
            }
        }
    }

    /// Variation without a sum by which the square becomes least; none where rounding leaves no system to solve.
    fn least(&self) -> [f64; D] {
        let last = D - 1;
        let second = |i: usize, j: usize| self.second[i.max(j)][i.min(j)];
        let first = |i: usize| self.first[last] - self.first[i];
        let reduced = |i: usize, j: usize| {
            second(i, j) - second(i, last) - second(last, j) + second(last, last)
        };
        let mut variation = [0.0; D];
        if D == 2 {
            variation[0] = first(0) / reduced(0, 0);
        } else {
            let determinant = reduced(0, 0) * reduced(1, 1) - reduced(0, 1) * reduced(0, 1);
            variation[0] = (first(0) * reduced(1, 1) - first(1) * reduced(0, 1)) / determinant;
            variation[1] = (first(1) * reduced(0, 0) - first(0) * reduced(0, 1)) / determinant;
        }
        variation[last] = -variation[..last].iter().sum::<f64>();
        if variation.iter().all(|step| step.is_finite()) { variation } else { [0.0; D] }
    }

    /// Difference of the squares before and after a part of the way along a variation that makes it least.
    fn gain(&self, variation: [f64; D], part: f64) -> f64 {
        -part * (1.0 - 0.5 * part) * dot(self.first, variation)
    }
}
