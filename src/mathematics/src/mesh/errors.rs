//! Integrals over a mesh of functions of a discrete solution, and its errors against a known one.

use super::{AnyMesh, Element, Mesh};
use crate::discrete::norms::{Errors, worst};
use crate::discrete::quadrature::quadrature;
use crate::machine::threads::map;
use crate::problem::exact::Known;
use crate::problem::field::Sample;

/// Discrete solution at a point of the mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshPlace<const D: usize> {
    /// Point.
    pub point: [f64; D],
    /// Value of the function that is linear on the cells.
    pub value: f64,
    /// Gradient of this function.
    pub gradient: [f64; D],
}

/// Cells between which sums are added, in order, whatever thread made them.
const RUN: usize = 1 << 12;

/// Returns the integrals over a mesh of some functions of the nodal vector `y`, which is linear on the cells: by a
/// formula of degree 5.
///
/// # Panics
/// If `y` has not one value for each node.
pub(crate) fn integrals<const D: usize, const V: usize, const K: usize>(
    mesh: &Mesh<D, V>,
    y: &[f64],
    functions: impl Fn(MeshPlace<D>) -> [f64; K] + Sync,
) -> [f64; K] {
    assert_eq!(y.len(), mesh.points().len());
    let points = quadrature::<V>();
    let runs: Vec<_> = mesh.cells().chunks(RUN).collect();
    let of_run = |cells: &&[[u32; V]]| {
        let mut sums = [0.0; K];
        for cell in *cells {
            let vertices = mesh.vertices(cell);
            let element = Element::new(vertices);
            let values = cell.map(|node| y[node as usize]);
            let gradient = element.gradient(values);
            for point in &points {
                let value = point.barycentric.iter().zip(values).map(|(share, v)| share * v).sum();
                let place = MeshPlace { point: point.within(vertices), value, gradient };
                let weight = element.volume * point.weight;
                for (sum, function) in sums.iter_mut().zip(functions(place)) {
                    *sum += weight * function;
                }
            }
        }
        sums
    };
    let mut integrals = [0.0; K];
    for sums in map(&runs, 1, of_run) {
        integrals.iter_mut().zip(sums).for_each(|(integral, sum)| *integral += sum);
    }
    integrals
}

/// Returns the errors of the nodal vector `y` against a known solution.
///
/// # Panics
/// If `y` has not one value for each node.
pub fn mesh_errors<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    known: impl Fn([f64; D]) -> Sample<D> + Sync,
    y: &[f64],
) -> Errors {
    let [l2, h1] = integrals(mesh, y, |MeshPlace { point, value, gradient }| {
        let exact = known(point);
        let error = exact.value - value;
        [error * error, distance_squared(exact.gradient, gradient)]
    });
    let at_nodes = mesh.points().iter().zip(y).map(|(&point, value)| known(point).value - value);
    Errors { l2: l2.sqrt(), h1: h1.sqrt(), max: worst(at_nodes), multiplier_l2: None }
}

impl AnyMesh {
    /// Errors of the nodal vector `y` against a known solution; none if the mesh is not of its domain.
    pub(crate) fn errors(&self, known: Known, y: &[f64]) -> Option<Errors> {
        match self {
            Self::Plane(mesh) => {
                mesh.is_unit_box().then(|| mesh_errors(mesh, |point| known.sample(point), y))
            }
            Self::Space(mesh) => {
                mesh.is_unit_box().then(|| mesh_errors(mesh, |point| known.sample(point), y))
            }
        }
    }
}

/// Returns the square of the distance of two vectors.
pub(crate) fn distance_squared<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::uniform_cube;
    use crate::problem::exact::CubeExact;
    use std::f64::consts::PI;

    #[test]
    fn the_errors_of_zero_are_the_norms_of_the_solution() {
        let mesh = uniform_cube(8);
        let zero = vec![0.0; mesh.points().len()];
        let Errors { l2, h1, max, .. } =
            mesh_errors(&mesh, |at| CubeExact::FullContact.at(at), &zero);
        // Integrals of cos^2 cos^2 cos^2 and 3 pi^2 sin^2 cos^2 cos^2 over the cube.
        assert!((l2 - 0.125f64.sqrt()).abs() < 1e-5, "{l2}");
        assert!((h1 - PI * 0.375f64.sqrt()).abs() < 1e-4, "{h1}");
        assert_eq!(max, 1.0);
    }
}
