//! Parallel projection of a surface: places, light, and the order of the cells in depth.

use super::picture::Place;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::mesh::{Element, PlaneMesh};

/// Height of the box, its sides being 1.
const BOX_HEIGHT: f64 = 0.66;
/// Display pixels per unit of length, where two panels are in a row.
pub(super) const UNIT: f64 = 205.0;
/// Light that every side receives; the rest comes from the lamp.
const AMBIENT: f64 = 0.62;

/// Azimuth of the viewer above the lower left corner, in degrees anticlockwise from the negative y axis.
const AZIMUTH: f64 = -37.5;
/// Degrees of the viewer above the horizon.
const ELEVATION: f64 = 30.0;
/// Part of the mean slope below which two sides of a surface are taken for equally high.
const EVEN: f64 = 1e-6;

/// Returns the azimuth above that of the four corners from which the surface, a nodal vector, rises most to the opposite
/// corner: there it hides the smallest part of itself.
pub(crate) fn uphill(grid: Grid, y: &[f64]) -> f64 {
    let n = grid.cells();
    let (mut azimuth, mut most) = (AZIMUTH, f64::NEG_INFINITY);
    // Anticlockwise from the lower left corner.
    for (turn, (i, j)) in [(0, 0), (n, 0), (n, n), (0, n)].into_iter().enumerate() {
        let rise = y[grid.index(n - i, n - j)] - y[grid.index(i, j)];
        if rise > most {
            (azimuth, most) = (AZIMUTH + 90.0 * turn as f64, rise);
        }
    }
    if azimuth > 180.0 { azimuth - 360.0 } else { azimuth }
}

/// Returns the azimuth, of the four from which [`uphill`] chooses, from which a function on a mesh, linear on each
/// triangle, rises most on the whole.
pub(crate) fn uphill_on_mesh(mesh: &PlaneMesh, y: &[f64]) -> f64 {
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

    /// Cells (column, row) of a lattice with `n` per side, each after all cells that it may hide.
    ///
    /// Along a ray from the viewer, columns and rows only become farther, so the order from the far end to the near end
    /// in both is an exact order in depth without sorting.
    pub(super) fn far_to_near(&self, n: usize) -> impl Iterator<Item = (usize, usize)> {
        let [right, upper] = self.near.map(|sign| sign > 0.0);
        (0..n * n).map(move |k| {
            let (i, j) = (k % n, k / n);
            (if right { i } else { n - 1 - i }, if upper { j } else { n - 1 - j })
        })
    }
}

/// Map from space to a panel.
pub(super) struct View {
    pub(super) camera: Camera,
    /// Place of the middle of the box, in display pixels.
    pub(super) origin: Place,
    /// Display pixels per unit of length.
    pub(super) unit: f64,
    /// Half of each side of the floor.
    pub(super) half: [f64; 2],
    /// Values at the floor and the ceiling of the box.
    pub(super) heights: (f64, f64),
}

impl View {
    /// Returns the point of the box for (x, y, v): heights scaled, centre at the origin.
    pub(super) fn point(&self, [x, y, v]: Vector) -> Vector {
        let (low, high) = self.heights;
        [x, y, BOX_HEIGHT * ((v - low) / (high - low) - 0.5)]
    }

    /// Returns the place of (x, y, v) in the picture.
    pub(super) fn place(&self, xyv: Vector) -> Place {
        let point = self.point(xyv);
        (
            self.origin.0 + self.unit * dot(point, self.camera.right),
            self.origin.1 - self.unit * dot(point, self.camera.up),
        )
    }

    /// Returns the corner of the floor nearest to the viewer.
    pub(super) fn nearest_corner(&self) -> [f64; 2] {
        [0, 1].map(|d| self.camera.near[d] * self.half[d])
    }

    /// Returns the light reflected by a part of the surface with this upward normal.
    pub(super) fn brightness(&self, normal: Vector) -> f64 {
        // Over the viewer's left shoulder, so that slopes to either side differ.
        let camera = &self.camera;
        let lamp = [0, 1, 2].map(|d| camera.toward[d] + 0.9 * camera.up[d] - 0.8 * camera.right[d]);
        let cosine = dot(normal, lamp) / (dot(normal, normal) * dot(lamp, lamp)).sqrt();
        let facing = if dot(normal, camera.toward) < 0.0 { 0.8 } else { 1.0 };
        facing * (AMBIENT + (1.06 - AMBIENT) * cosine.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_mathematics::mesh::BuiltIn;

    #[test]
    fn a_cell_is_drawn_after_every_cell_it_may_hide() {
        let n = 5;
        for azimuth in [-170.0, -127.5, -90.0, -37.5, 0.0, 12.0, 52.5, 90.0, 142.5, 180.0] {
            let camera = Camera::new(azimuth);
            let mut turn = vec![None; n * n];
            for (k, (i, j)) in camera.far_to_near(n).enumerate() {
                turn[i + n * j] = Some(k);
            }
            assert!(turn.iter().all(Option::is_some));
            for cell in (0..n * n).map(|k| (k % n, k / n)) {
                // March towards the viewer from points of the cell: all cells met come later.
                for (u, v) in [(0.5, 0.5), (0.1, 0.9), (0.9, 0.1), (0.2, 0.3)] {
                    for step in 1..400 {
                        let t = 0.02 * f64::from(step);
                        let x = (cell.0 as f64 + u + t * camera.toward[0]).floor();
                        let y = (cell.1 as f64 + v + t * camera.toward[1]).floor();
                        if x < 0.0 || y < 0.0 || x >= n as f64 || y >= n as f64 {
                            break;
                        }
                        assert!(turn[x as usize + n * y as usize] >= turn[cell.0 + n * cell.1]);
                    }
                }
            }
        }
    }

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
            let height = |[x, y]: &[f64; 2]| slope[0] * x + slope[1] * y;
            let y: Vec<f64> = mesh.points().iter().map(height).collect();
            assert_eq!(Camera::new(uphill_on_mesh(&mesh, &y)).near, near);
        }
        let even: Vec<f64> = mesh.points().iter().map(|[x, y]| x * x + y * y).collect();
        assert_eq!(uphill_on_mesh(&mesh, &even), AZIMUTH);
    }

    #[test]
    fn uphill_view_has_the_high_corner_at_the_back() {
        let grid = Grid::new(2).unwrap();
        for (k, near) in [(0, [1.0, 1.0]), (2, [-1.0, 1.0]), (8, [-1.0, -1.0]), (6, [1.0, -1.0])] {
            let mut y = vec![0.0; 9];
            y[k] = 1.0;
            assert_eq!(Camera::new(uphill(grid, &y)).near, near);
        }
    }
}
