//! Fluxes of free parts by formulas: what is missing from a flux that is constant on a facet.
//!
//! Let h be the flux that is given on the facet F of the cell T, in D dimensions, h0 its mean, and d the diameter of T.
//! The field of least norm on T without divergence whose flux is h - h0 through F, and zero through the other sides, is
//! the gradient of a function phi with mean 0, and its norm is at most `C |h - h0|`, the norm over F, since
//!
//! ```text
//! |grad phi|^2 = <(h - h0) phi>,    <v^2> = |F| / |T| (|v|^2 + 2 / D integral of v (x - P) . grad v),
//! |v| <= d / pi |grad v|,           C^2 = |F| d^2 / |T| (1 / pi^2 + 2 / (D pi)),
//! ```
//!
//! for the vertex P opposite to F: (x - P) . n is D |T| / |F| on F and 0 on the other sides.

use crate::discrete::quadrature::facet_points;
use crate::mesh::{BoundarySide, Mesh, Sides, measure, size, volume};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Upper bounds of the norms of these fields, over the root of k, for each cell with such facets.
pub(super) fn missing<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    sides: &Sides<V>,
) -> BTreeMap<u32, f64> {
    let mut norms = BTreeMap::new();
    for (facet, &BoundarySide { cell, .. }) in mesh.facets().iter().zip(sides.of_facets()) {
        let (law, corners) = (mesh.law(facet), mesh.corners(facet));
        let Some(flux) = mesh.value(facet.part).filter(|_| law.is_free()) else { continue };
        let mut variance = 0.0;
        for point in facet_points::<D>() {
            let off = flux.at(&point.within(corners)) - law.lo();
            variance += point.weight * off * off;
        }
        let vertices = mesh.vertices(&mesh.cells()[cell as usize]);
        let measure = measure(corners);
        let constant = measure / volume(vertices) * (1.0 / (PI * PI) + 2.0 / (D as f64 * PI));
        let square = constant * measure * variance / mesh.k(cell as usize);
        *norms.entry(cell).or_default() += size(vertices) * square.sqrt();
    }
    norms
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AnyMesh, Facet, MeshData, Names, Part};
    use crate::problem::law::Law;

    #[test]
    fn the_bound_is_above_the_norm_of_a_harmonic_function() {
        // phi = cos(k pi x) cosh(k pi y) + cosh(k pi x) cos(k pi y) on the triangle of (0, 0), (1, 0), (0, 1) has no
        // flux through the legs. The norm of its gradient is that of its flux times phi on the long side.
        for k in [1.0, 2.0] {
            let part = Part { names: Names::from("long"), law: Law::FREE, curve: None };
            let data = MeshData {
                points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
                cells: vec![[0, 1, 2]],
                facets: vec![Facet { nodes: [1, 2], part: 0 }],
                parts: vec![part],
                ..MeshData::default()
            };
            let mut mesh = AnyMesh::Plane(data.mesh().unwrap());
            let slopes = format!(
                "{k}*pi*sqrt(0.5)*(cos({k}*pi*x)*(exp({k}*pi*y) - exp(-{k}*pi*y))/2 \
                 - sin({k}*pi*x)*(exp({k}*pi*y) + exp(-{k}*pi*y))/2 \
                 + cos({k}*pi*y)*(exp({k}*pi*x) - exp(-{k}*pi*x))/2 \
                 - sin({k}*pi*y)*(exp({k}*pi*x) + exp(-{k}*pi*x))/2)"
            );
            mesh.set_law("long", Law::FREE).unwrap();
            mesh.set_value("long", &slopes).unwrap();
            let mesh = mesh.plane().unwrap();
            let found = missing(mesh, &Sides::new(mesh))[&0];
            let flux = mesh.value(0).unwrap();
            let (mut square, mut mean) = (0.0, 0.0);
            const POINTS: usize = 2000;
            for point in 0..POINTS {
                let x = (point as f64 + 0.5) / POINTS as f64;
                let [a, b] = [x, 1.0 - x].map(|x| k * PI * x);
                let phi = libm::cos(a) * libm::cosh(b) + libm::cosh(a) * libm::cos(b);
                let weight = 2f64.sqrt() / POINTS as f64;
                square += weight * flux.at(&[x, 1.0 - x]) * phi;
                mean += weight * flux.at(&[x, 1.0 - x]);
            }
            assert!(mean.abs() < 1e-6 * square, "{mean} {square}");
            let norm = square.sqrt();
            assert!(norm < found && found < 4.0 * norm, "{k}: {norm} {found}");
        }
    }
}
