//! The plane in which the triangles of a file lie.

use super::error::GmshError;
use super::nodes::FileNodes;
use crate::mesh::PlaneInSpace;

/// Distance from a plane over the size of the domain that is a rounding error of the file: one or two units in the last
/// of six digits, which many programs write.
const ROUNDING: f64 = 1e-5;

/// Points of cells, measured from the first.
struct PlanePoints<'a> {
    nodes: &'a FileNodes,
    /// Positions of the nodes.
    used: Vec<usize>,
    start: [f64; 3],
    /// Largest difference from the first point, along the axes.
    size: f64,
}

/// Returns the plane in which all nodes of cells lie.
pub(super) fn plane_of(nodes: &FileNodes, has_cell: &[bool]) -> Result<PlaneInSpace, GmshError> {
    let used: Vec<usize> = (0..has_cell.len()).filter(|&node| has_cell[node]).collect();
    let Some(&first) = used.first() else { return Ok(PlaneInSpace::default()) };
    let mut points = PlanePoints { nodes, used, start: nodes.points[first], size: 0.0 };
    let [x, y, z] = [0, 1, 2].map(|d| points.farthest(|step| step[d].abs()).1);
    points.size = x.max(y).max(z);
    let [x0, y0, z0] = points.start;
    let [along_x, along_y, along_z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Axes that are exact keep the coordinates of the file. A strip may be as narrow as rounding errors.
    let least = x.min(y).min(z);
    if least > ROUNDING * points.size {
        points.tilted()
    } else if z <= least {
        Ok(PlaneInSpace::Horizontal(z0))
    } else if y <= least {
        Ok(PlaneInSpace::Other { foot: [0.0, y0, 0.0], axes: [along_x, along_z] })
    } else {
        Ok(PlaneInSpace::Other { foot: [x0, 0.0, 0.0], axes: [along_y, along_z] })
    }
}

impl PlanePoints<'_> {
    /// Node for which a function of the step from the first point is largest, and its value.
    fn farthest(&self, of: impl Fn([f64; 3]) -> f64) -> (usize, f64) {
        let mut most = (self.used[0], 0.0);
        for &node in &self.used {
            let value = of(self.step(node));
            if value > most.1 {
                most = (node, value);
            }
        }
        most
    }

    fn step(&self, node: usize) -> [f64; 3] {
        std::array::from_fn(|d| self.nodes.points[node][d] - self.start[d])
    }

    /// Returns a plane that is perpendicular to no axis: its first coordinate is horizontal.
    fn tilted(&self) -> Result<PlaneInSpace, GmshError> {
        let (far, _) = self.farthest(|step| dot(step, step));
        let along = unit(self.step(far));
        let (beside, _) = self.farthest(|step| length(cross(along, step)));
        let normal = unit(cross(along, self.step(beside)));
        // Points on one line leave it open: the triangles are flat, which is said later.
        if !dot(normal, normal).is_normal() {
            return Ok(PlaneInSpace::default());
        }
        let (off, height) = self.farthest(|step| dot(normal, step).abs());
        if height > ROUNDING * self.size {
            let tags = [self.used[0], far, beside, off].map(|node| self.nodes.tags[node]);
            return Err(GmshError::NotPlane { plane: [tags[0], tags[1], tags[2]], off: tags[3] });
        }
        let mut across = unit(cross([0.0, 0.0, 1.0], normal));
        // Of both directions the one along x or, if it has no x, along y.
        if across[0] < 0.0 || (across[0] == 0.0 && across[1] < 0.0) {
            across = across.map(|x| 0.0 - x);
        }
        let mut up = cross(normal, across);
        if up[2] < 0.0 {
            up = up.map(|x| 0.0 - x);
        }
        let distance = dot(normal, self.start);
        Ok(PlaneInSpace::Other { foot: normal.map(|n| distance * n), axes: [across, up] })
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Returns a vector of length one in the same direction.
fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = length(a);
    a.map(|x| x / length)
}
