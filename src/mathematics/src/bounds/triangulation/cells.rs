//! Cells with a linear function w and an f that is constant on each: what the flux must carry, and the field that has
//! given fluxes through the sides.

use crate::bounds::boundary::PartLaw;
use crate::machine::threads::{for_runs, items_per_task};
use crate::mesh::{CellData, Element, Facet, Mesh, Sides, measure, volume};

/// Numbers whose work takes as long as that on a cell.
pub(super) const COST: usize = 8;

/// Cells of a mesh with a function in K and f.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a, const D: usize, const V: usize> {
    pub mesh: &'a Mesh<D, V>,
    /// Nodal vector of the linear function.
    pub w: &'a [f64],
    /// f on the cells.
    pub f: &'a CellData,
}

impl<const D: usize, const V: usize> Cells<'_, D, V> {
    /// Interval of the flux through a facet of the boundary.
    pub(super) fn interval(&self, facet: &Facet<D>) -> PartLaw {
        interval(self.mesh, facet)
    }

    /// Puts a flux through the facets that exceeds a limit of the law within it: where a limit is met, rounding decides
    /// the side. Returns the largest change.
    pub(super) fn clamp<const N: usize>(&self, sides: &Sides<V>, flux: &mut [[f64; N]]) -> f64 {
        let mut largest = 0.0f64;
        for (facet, at) in self.mesh.facets().iter().zip(sides.of_facets()) {
            let interval = self.interval(facet);
            for flux in &mut flux[at.side as usize] {
                let before = std::mem::replace(flux, interval.clamp(*flux));
                largest = largest.max((*flux - before).abs());
            }
        }
        largest
    }

    /// Values of laws at the ends of a facet of the boundary of a domain in the plane, in the order of a cell.
    pub(super) fn values(&self, sides: &Sides<V>, facet: usize) -> [f64; 2] {
        let (facet, at) = (&self.mesh.facets()[facet], &sides.of_facets()[facet]);
        let (nodes, k) = (&self.mesh.cells()[at.cell as usize], sides.slot(at.cell, at.side));
        [1, 2].map(|step| self.mesh.law_at(facet, nodes[(k + step) % V]).at())
    }

    /// Facets whose laws have values that are not 0.
    pub(super) fn facets_with_values(&self) -> impl Iterator<Item = usize> {
        let parts = self.mesh.parts().iter();
        let of_parts: Vec<bool> = parts.map(|part| part.law.at() != 0.0).collect();
        let facets = self.mesh.facets().iter().enumerate();
        facets.filter(move |(_, facet)| of_parts[usize::from(facet.part)]).map(|(k, _)| k)
    }

    /// Integrals of f less the reaction over all cells.
    pub(super) fn masses(&self) -> Vec<f64> {
        let (nodes, mut masses) = (self.mesh.cells(), self.f.mean.clone());
        let run = items_per_task(masses.len(), COST);
        for_runs(&mut masses, run, &|number, masses| {
            for (nodes, mass) in nodes[number * run..].iter().zip(masses) {
                if self.mesh.reaction > 0.0 {
                    let mean = at_nodes(nodes, self.w).iter().sum::<f64>() / V as f64;
                    *mass -= self.mesh.reaction * mean;
                }
                *mass *= volume(self.mesh.vertices(nodes));
            }
        });
        masses
    }

    /// Integral of f times the hat function of a vertex over a cell with this volume, less the reaction, lumped.
    #[inline(always)]
    pub(super) fn load(&self, number: u32, vertex: usize, volume: f64) -> f64 {
        let of_f = match &self.f.shares {
            Some(shares) => shares[V * number as usize + vertex],
            None => self.f.mean[number as usize] * volume / V as f64,
        };
        if self.mesh.reaction == 0.0 {
            return of_f;
        }
        let w = self.w[self.mesh.cells()[number as usize][vertex] as usize];
        of_f - self.mesh.reaction * w * volume / V as f64
    }
}

/// Interval of the flux through a facet of the boundary.
pub(super) fn interval<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    facet: &Facet<D>,
) -> PartLaw {
    PartLaw::new(mesh.law(facet), measure(mesh.corners(facet)))
}

/// Gradient of the linear function with these values at the vertices. Differences come first: a constant has no
/// gradient, not even by rounding.
#[inline(always)]
pub(super) fn gradient<const D: usize, const V: usize>(
    element: &Element<D, V>,
    mut values: [f64; V],
) -> [f64; D] {
    let first = values[0];
    values.iter_mut().for_each(|value| *value -= first);
    element.gradient(values)
}

/// Values of a nodal vector at the vertices of a cell.
#[inline(always)]
pub(super) fn at_nodes<const V: usize>(nodes: &[u32; V], vector: &[f64]) -> [f64; V] {
    let mut values = [0.0; V];
    for (value, &node) in values.iter_mut().zip(nodes) {
        *value = vector[node as usize];
    }
    values
}
