//! Directions in the picture of a surface.

use signorini_mathematics::mesh::{Element, PlaneMesh};

/// Azimuth of the viewer above the lower left corner, in degrees anticlockwise from the negative y axis.
const AZIMUTH: f64 = -37.5;
/// Degrees of the viewer above the horizon.
const ELEVATION: f64 = 30.0;
/// Part of the mean slope below which two sides of a surface are taken for equally high.
const EVEN: f64 = 1e-6;

/// Returns the azimuth above that of four corners from which a function on a mesh, linear on each triangle, rises most
/// on the whole: there it hides the smallest part of itself.
pub(crate) fn uphill(mesh: &PlaneMesh, y: &[f64]) -> f64 {
    let mut slope = [0.0; 2];
    let mut steepness = 0.0;
    for cell in mesh.cells() {
        let element = Element::new(mesh.vertices(cell));
        let [x, y] = element.gradient(cell.map(|node| y[node as usize]));
        slope = [slope[0] + element.volume * x, slope[1] + element.volume * y];
        steepness += element.volume * (x * x + y * y).sqrt();
    }
    let (mut azimuth, mut most) = (AZIMUTH, f64::NEG_INFINITY);
    for turn in [0.0, 90.0, 180.0, -90.0] {
        let [x, y, _] = Camera::new(AZIMUTH + turn).toward;
        let rise = -(slope[0] * x + slope[1] * y);
        // Rounding errors do not turn a symmetric surface.
        if rise > most + EVEN * steepness {
            (azimuth, most) = (AZIMUTH + turn, rise);
        }
    }
    azimuth
}

pub(super) type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the vector from one point to another.
pub(super) fn between(from: Vector, to: Vector) -> Vector {
    [0, 1, 2].map(|k| to[k] - from[k])
}

pub(super) fn cross(u: Vector, v: Vector) -> Vector {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// The axes of the picture, as unit vectors in space.
pub(super) struct Camera {
    /// To the right in the picture.
    pub(super) right: Vector,
    /// Upwards in the picture.
    pub(super) up: Vector,
    /// Towards the viewer.
    pub(super) toward: Vector,
    /// Signs of x and y at the corner of the square nearest to the viewer.
    pub(super) near: [f64; 2],
}

impl Camera {
    pub(super) fn new(azimuth: f64) -> Self {
        let [(sin_a, cos_a), (sin_e, cos_e)] = [azimuth, ELEVATION]
            .map(|degrees| libm::sincos(degrees * std::f64::consts::PI / 180.0));
        let toward = [sin_a * cos_e, -cos_a * cos_e, sin_e];
        Self {
            right: [cos_a, sin_a, 0.0],
            up: [-sin_a * sin_e, cos_a * sin_e, cos_e],
            toward,
            near: [toward[0], toward[1]].map(|t| if t < 0.0 { -1.0 } else { 1.0 }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_mathematics::mesh::BuiltIn;

    #[test]
    fn camera_is_orthonormal() {
        let camera = Camera::new(AZIMUTH);
        let axes = [camera.right, camera.up, camera.toward];
        for (i, &a) in axes.iter().enumerate() {
            for (j, &b) in axes.iter().enumerate() {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((dot(a, b) - expected).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn uphill_view_of_a_mesh_has_the_low_side_at_the_front() {
        let mesh = BuiltIn::Disc.plane().unwrap();
        for (slope, near) in [
            ([1.0, 2.0], [-1.0, -1.0]),
            ([-1.0, 2.0], [1.0, -1.0]),
            ([-2.0, -1.0], [1.0, 1.0]),
            ([1.0, -1.0], [-1.0, 1.0]),
        ] {
            let heights = mesh.points().iter().map(|[x, y]| slope[0] * x + slope[1] * y);
            let y: Vec<f64> = heights.collect();
            assert_eq!(Camera::new(uphill(&mesh, &y)).near, near);
        }
        let even: Vec<f64> = mesh.points().iter().map(|[x, y]| x * x + y * y).collect();
        assert_eq!(uphill(&mesh, &even), AZIMUTH);
    }
}
