//! Values of a linear function on the cells of a mesh at points, and its gradients.

use super::geometry::{bounds, difference, dot};
use super::{AnyMesh, Element, Mesh};
use serde::Serialize;

/// Barycentric coordinate below zero down to which a point lies in a cell: rounding errors of points on its sides.
const ROUNDING: f64 = 1e-10;

/// v and its gradient at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointValue {
    /// Coordinates of the point.
    pub point: Vec<f64>,
    /// v; none outside the domain.
    pub v: Option<f64>,
    /// Gradient of v; none outside the domain.
    pub gradient: Option<Vec<f64>>,
}

impl PointValue {
    /// v and its gradient at a point, if they are found there.
    pub(crate) fn new<const D: usize>(point: &[f64], found: Option<(f64, [f64; D])>) -> Self {
        let (v, gradient) = found.map(|(v, gradient)| (v, gradient.to_vec())).unzip();
        Self { point: point.into(), v, gradient }
    }
}

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Value and gradient of a nodal vector at a point, in the first cell in which that lies; none outside.
    fn at(&self, point: &[f64], y: &[f64]) -> Option<(f64, [f64; D])> {
        let point: [f64; D] = point.try_into().ok()?;
        self.cells.iter().find_map(|cell| {
            let vertices = self.vertices(cell);
            // Most cells are far away.
            let is_near = bounds(&vertices).iter().zip(point).all(|(&[least, greatest], x)| {
                let margin = ROUNDING * (greatest - least);
                least - margin <= x && x <= greatest + margin
            });
            if !is_near {
                return None;
            }
            let element = Element::new(vertices);
            let mut value = 0.0;
            for ((slopes, vertex), &node) in element.gradients.iter().zip(vertices).zip(cell) {
                let share = 1.0 + dot(*slopes, difference(point, vertex));
                if share < -ROUNDING {
                    return None;
                }
                value += share * y[node as usize];
            }
            Some((value, element.gradient(cell.map(|node| y[node as usize]))))
        })
    }

    /// Gradients of a nodal vector on the cells, in the space of the mesh's file.
    fn gradients(&self, y: &[f64]) -> Vec<[f64; 3]> {
        let origin = self.in_space(&[0.0; D]);
        let mut gradients = Vec::with_capacity(self.cells.len());
        for cell in &self.cells {
            let element = Element::new(self.vertices(cell));
            let gradient = element.gradient(cell.map(|node| y[node as usize]));
            gradients.push(difference(self.in_space(&gradient), origin));
        }
        gradients
    }
}

impl AnyMesh {
    /// Value and gradient of a nodal vector at a point of as many coordinates as the mesh has dimensions.
    pub(crate) fn at(&self, point: &[f64], y: &[f64]) -> PointValue {
        match self {
            Self::Plane(mesh) => PointValue::new(point, mesh.at(point, y)),
            Self::Space(mesh) => PointValue::new(point, mesh.at(point, y)),
        }
    }

    /// Gradient of a nodal vector on each cell, in the space of the mesh's file.
    pub(crate) fn gradients(&self, y: &[f64]) -> Vec<[f64; 3]> {
        match self {
            Self::Plane(mesh) => mesh.gradients(y),
            Self::Space(mesh) => mesh.gradients(y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_function_has_its_values_and_its_gradient_at_points_of_the_domain_alone() {
        for (name, inside, outside) in [
            ("lshape", vec![0.5, 0.25], vec![0.5, -0.5]),
            ("lshape", vec![0.0, 0.0], vec![1.1, 0.0]),
            ("ball", vec![0.2, -0.3, 0.1], vec![0.9, 0.9, 0.9]),
        ] {
            let mesh = AnyMesh::built_in(name).unwrap().refined(1).unwrap();
            let slopes = [2.0, -3.0, 5.0];
            let linear = |point: &[f64]| point.iter().zip(slopes).map(|(x, s)| s * x).sum::<f64>();
            let y: Vec<f64> = mesh.coordinates().chunks(inside.len()).map(linear).collect();
            let found = mesh.at(&inside, &y);
            assert!((found.v.unwrap() - linear(&inside)).abs() < 1e-13, "{name} {found:?}");
            let off = found.gradient.unwrap().into_iter().zip(slopes).map(|(g, s)| (g - s).abs());
            assert!(off.fold(0.0, f64::max) < 1e-12, "{name}");
            assert_eq!(mesh.at(&outside, &y).v, None, "{name}");
            assert_eq!(mesh.at(&[0.0], &y).gradient, None);
            let gradients = mesh.gradients(&y);
            assert_eq!(gradients.len(), mesh.cells());
            assert!(
                gradients.iter().all(|[gx, gy, _]| (gx - 2.0).abs() + (gy + 3.0).abs() < 1e-11)
            );
        }
    }
}
