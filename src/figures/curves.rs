//! Solutions along the closed curves of a boundary in the plane.

use super::{ContactLine, ContactPanel};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, PlaneMesh, boundary_curves};
use signorini_mathematics::saddle::Pair;

/// Closed curve of a boundary.
struct ClosedCurve {
    /// Names of the parts of the boundary; none on the square, whose sides have names.
    parts: Option<String>,
    /// Nodes in their order along the curve.
    nodes: Vec<usize>,
    /// Arc lengths of the nodes, from 0 on.
    places: Vec<f64>,
    length: f64,
}

impl ContactPanel {
    /// Panels of the solutions of a problem, each with its label: one for each closed curve of the boundary.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub(crate) fn of(
        title: &str,
        problem: &Problem,
        solutions: &[(String, Pair)],
    ) -> Result<Vec<Self>, String> {
        let mut panels = Vec::new();
        for ClosedCurve { parts, nodes, places, length } in curves(problem)? {
            let lines = solutions.iter().map(|(label, pair)| {
                let in_contact = problem.levels().in_contact(problem.law(), pair);
                ContactLine {
                    label: label.clone(),
                    y: at(&pair.y, &nodes),
                    a: at(&problem.at_nodes(&pair.a, 0.0), &nodes),
                    in_contact: at(&problem.at_nodes(&in_contact, false), &nodes),
                }
            });
            let lines = lines.collect();
            let has_sides = parts.is_none();
            let title = parts.map_or(title.to_owned(), |parts| format!("{title}: {parts}"));
            panels.push(Self { title, places, length, has_sides, law: problem.law(), lines });
        }
        Ok(panels)
    }
}

/// Returns the closed curves of the boundary: on the square anticlockwise from the lower left corner on.
fn curves(problem: &Problem) -> Result<Vec<ClosedCurve>, String> {
    if let Some(lattices) = problem.lattices() {
        let grid = lattices.finest();
        let places = (0..grid.boundary_nodes()).map(|b| b as f64 * grid.h()).collect();
        let nodes = grid.boundary().collect();
        return Ok(vec![ClosedCurve { parts: None, nodes, places, length: 4.0 }]);
    }
    let AnyMesh::Plane(mesh) = problem.levels().mesh(problem.finest()) else {
        return Err("a solution in space has no picture".into());
    };
    let mut curves = Vec::new();
    for curve in boundary_curves(&mesh) {
        let parts = curve.parts.iter().map(|&part| mesh.parts()[part].names.to_string());
        let parts = Some(parts.collect::<Vec<_>>().join(", "));
        let mut places = arc_lengths(&mesh, &curve.nodes);
        let length = places.pop().unwrap_or_default();
        curves.push(ClosedCurve { parts, nodes: curve.nodes, places, length });
    }
    Ok(curves)
}

/// Values at some nodes.
fn at<T: Copy>(values: &[T], nodes: &[usize]) -> Vec<T> {
    nodes.iter().map(|&node| values[node]).collect()
}

/// Arc lengths of the nodes of a closed curve from the first, which is also the last.
fn arc_lengths(mesh: &PlaneMesh, nodes: &[usize]) -> Vec<f64> {
    let (mut lengths, mut sum) = (vec![0.0], 0.0);
    for (k, &node) in nodes.iter().enumerate() {
        let next = nodes[(k + 1) % nodes.len()];
        let [[ax, ay], [bx, by]] = [node, next].map(|node| mesh.points()[node]);
        sum += ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
        lengths.push(sum);
    }
    lengths
}
