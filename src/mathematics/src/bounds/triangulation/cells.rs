//! Cells with a linear function w and an f that is constant on each: what the flux must carry, and the field that has
//! given fluxes through the sides.

use crate::bounds::boundary::PartLaw;
use crate::machine::threads::{for_runs, items_per_task};
use crate::mesh::{
    CellData, Condition, Element, Facet, Mesh, Sides, centroid, dot, measure, volume,
};
use crate::problem::law::Law;

/// Numbers whose work takes as long as that on a cell.
pub(super) const COST: usize = 8;

/// Cell as far as the outflows wanted from it are concerned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell<const V: usize> {
    /// Area or volume.
    pub volume: f64,
    /// True if the vertices are numbered in the negative sense.
    pub is_mirrored: bool,
    /// Integrals of f times the hat functions of the vertices.
    pub load: [f64; V],
    /// Integrals of `grad w . grad phi` for the hat functions phi of the vertices. The flux of `grad w` out of the cell
    /// through the side opposite to a vertex is minus D times the integral of the vertex.
    pub work: [f64; V],
}

/// Cells of a mesh, computed where they are asked for: stored, they would take more memory than the mesh.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a, const D: usize, const V: usize> {
    pub mesh: &'a Mesh<D, V>,
    /// Nodal vector of the linear function.
    pub w: &'a [f64],
    /// f on the cells.
    pub f: &'a CellData,
    /// Law on the boundary in contact.
    pub law: Law,
}

impl<const D: usize, const V: usize> Cells<'_, D, V> {
    /// Interval of the flux through a facet of the boundary.
    pub(super) fn interval(&self, facet: &Facet<D>) -> PartLaw {
        match self.mesh.condition(facet) {
            Condition::Free => PartLaw { least: 0.0, most: 0.0 },
            Condition::Fixed => PartLaw { least: f64::NEG_INFINITY, most: f64::INFINITY },
            Condition::Contact => PartLaw::new(self.law, measure(self.mesh.corners(facet))),
        }
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

    /// Cell of this number.
    pub(super) fn cell(&self, number: u32) -> Cell<V> {
        let nodes = &self.mesh.cells()[number as usize];
        let element = Element::new(self.mesh.vertices(nodes));
        let gradient = gradient(&element, nodes.map(|node| self.w[node as usize]));
        Cell {
            volume: element.volume,
            is_mirrored: element.is_mirrored,
            load: std::array::from_fn(|k| self.load(number, k, element.volume)),
            work: element.gradients.map(|slopes| element.volume * dot(gradient, slopes)),
        }
    }

    /// Integrals of f over all cells.
    pub(super) fn masses(&self) -> Vec<f64> {
        let (nodes, mut masses) = (self.mesh.cells(), self.f.mean.clone());
        let run = items_per_task(masses.len(), COST);
        for_runs(&mut masses, run, &|number, masses| {
            for (nodes, mass) in nodes[number * run..].iter().zip(masses) {
                *mass *= volume(self.mesh.vertices(nodes));
            }
        });
        masses
    }

    /// Integral of f times the hat function of a vertex over a cell with this volume.
    #[inline(always)]
    pub(super) fn load(&self, number: u32, vertex: usize, volume: f64) -> f64 {
        match &self.f.shares {
            Some(shares) => shares[V * number as usize + vertex],
            None => self.f.mean[number as usize] * volume / V as f64,
        }
    }
}

/// Gradient of the linear function with these values at the vertices. Differences come first: a constant has no
/// gradient, not even by rounding.
pub(super) fn gradient<const D: usize, const V: usize>(
    element: &Element<D, V>,
    values: [f64; V],
) -> [f64; D] {
    element.gradient(values.map(|value| value - values[0]))
}

/// Fields of Raviart and Thomas of lowest order on a cell. The field with an outflow of 1 through
/// the side opposite to vertex a, and 0 through the others, is `(x - a) / (D volume)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct RaviartThomas<const D: usize, const V: usize> {
    /// Centroid less each vertex.
    to_centre: [[f64; D]; V],
    /// One over D times the volume.
    inverse: f64,
}

impl<const D: usize, const V: usize> RaviartThomas<D, V> {
    /// Fields on the cell with these vertices and this volume.
    pub(super) fn new(vertices: [[f64; D]; V], volume: f64) -> Self {
        let centre = centroid(vertices);
        let to_centre = vertices.map(|vertex| difference(centre, vertex));
        Self { to_centre, inverse: 1.0 / (D as f64 * volume) }
    }

    /// Mean of the field with these outflows through the sides.
    pub(super) fn mean(&self, outflows: [f64; V]) -> [f64; D] {
        let mut mean = [0.0; D];
        for (outflow, to_centre) in outflows.into_iter().zip(self.to_centre) {
            mean.iter_mut().zip(to_centre).for_each(|(sum, x)| *sum += outflow * x);
        }
        mean.map(|sum| sum * self.inverse)
    }
}

/// Difference of two points.
pub(super) fn difference<const D: usize>(to: [f64; D], from: [f64; D]) -> [f64; D] {
    std::array::from_fn(|d| to[d] - from[d])
}
