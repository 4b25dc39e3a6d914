//! f on a mesh: its load vector, its integrals, and its means over the cells.
//!
//! On each cell by the [quadrature] of degree 5, exactly where f is constant on the cell.

use super::quadrature::{QuadraturePoint, quadrature};
use super::{Element, Mesh};
use crate::problem::shape::SourceError;

/// Value of f at a point of a cell, given by its number and the point.
pub trait OnCells<const D: usize> {
    /// Value at a point of a cell of this region.
    fn at(&self, region: u16, point: [f64; D]) -> f64;
}

/// Function on the cells of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct CellData {
    /// Mean over each cell.
    pub mean: Vec<f64>,
    /// L2 norm over each cell of the function less the mean; none if the function is constant on each cell.
    pub deviation: Option<Vec<f64>>,
}

/// f on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshLoad {
    /// Load vector (6): integrals of f times the hat functions.
    pub load: Vec<f64>,
    /// f on the cells.
    pub cells: CellData,
    /// Integral of f.
    pub integral: f64,
    /// Integral of |f|.
    pub size: f64,
}

/// Checks the values of f at the points of the quadrature.
///
/// # Errors
/// [`SourceError::NoValue`] with the first point where f is not finite.
pub fn check_values<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    f: &impl OnCells<D>,
) -> Result<(), SourceError> {
    let points = quadrature::<V>();
    for (cell, &region) in mesh.cells().iter().zip(mesh.regions()) {
        for point in &points {
            let point = point.within(mesh.vertices(cell));
            SourceError::check_value(f.at(region, point), &point)?;
        }
    }
    Ok(())
}

/// Integrates f over all cells.
pub fn mesh_load<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    f: &impl OnCells<D>,
) -> MeshLoad {
    let points = quadrature::<V>();
    let cells = mesh.cells().len();
    let mut made = MeshLoad {
        load: vec![0.0; mesh.points().len()],
        cells: CellData { mean: Vec::with_capacity(cells), deviation: None },
        integral: 0.0,
        size: 0.0,
    };
    let mut deviation = Vec::with_capacity(cells);
    let mut values = vec![0.0; points.len()];
    for (cell, &region) in mesh.cells().iter().zip(mesh.regions()) {
        let vertices = mesh.vertices(cell);
        let volume = Element::new(vertices).volume;
        for (value, point) in values.iter_mut().zip(&points) {
            *value = f.at(region, point.within(vertices));
        }
        let is_constant = values.iter().all(|value| *value == values[0]);
        let mean = if is_constant { values[0] } else { sum(&points, &values, |_, value| value) };
        for (vertex, &node) in cell.iter().enumerate() {
            let share = if is_constant {
                mean / V as f64
            } else {
                sum(&points, &values, |point, value| point.barycentric[vertex] * value)
            };
            made.load[node as usize] += volume * share;
        }
        let square = sum(&points, &values, |_, value| (value - mean) * (value - mean));
        made.cells.mean.push(mean);
        deviation.push(if is_constant { 0.0 } else { (volume * square).sqrt() });
        made.integral += volume * mean;
        made.size += volume * sum(&points, &values, |_, value| value.abs());
    }
    if deviation.iter().any(|deviation| *deviation > 0.0) {
        made.cells.deviation = Some(deviation);
    }
    made
}

/// Weighted sum over the points of a formula.
fn sum<const V: usize>(
    points: &[QuadraturePoint<V>],
    values: &[f64],
    term: impl Fn(&QuadraturePoint<V>, f64) -> f64,
) -> f64 {
    points.iter().zip(values).map(|(point, &value)| point.weight * term(point, value)).sum()
}
