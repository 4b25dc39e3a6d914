//! Figures of a scene on a domain other than the square.

use super::title_with_end;
use crate::figures::{
    ContactLine, ContactPanel, Picture, contact, drawn_level, mesh_map, mesh_solution,
};
use crate::pipeline::Inputs;
use crate::pipeline::error::Failure;
use crate::replication::scene::{Output, Scene};
use crate::replication::stages::solve;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, PlaneMesh, boundary_curves};

/// Draws one of the pictures that a domain in the plane has.
pub(super) fn draw(output: Output, scene: &Scene, inputs: &Inputs) -> Result<Picture, Failure> {
    let problem = scene.problem.problem(inputs.files)?;
    match output {
        Output::Surface => draw_surface(scene, &problem, inputs),
        Output::Contact => draw_contact(scene, &problem, inputs),
        _ => draw_map(scene, &problem),
    }
}

fn plane(mesh: &AnyMesh) -> Result<&PlaneMesh, String> {
    match mesh {
        AnyMesh::Plane(mesh) => Ok(mesh),
        AnyMesh::Space(_) => Err("a solution in space has no picture".into()),
    }
}

fn draw_map(scene: &Scene, problem: &Problem) -> Result<Picture, Failure> {
    let level = drawn_level(problem.levels());
    let f = problem.levels().means(level).map_err(|e| e.to_string())?;
    Ok(mesh_map(&scene.title, plane(&problem.levels().mesh(level))?, &f))
}

fn draw_surface(scene: &Scene, problem: &Problem, inputs: &Inputs) -> Result<Picture, Failure> {
    let pair = solve::pair(inputs, scene, scene.stop[0], problem)?;
    let title = title_with_end(inputs, scene)?;
    Ok(mesh_solution(2, &title, problem, &pair)?)
}

/// Draws a panel for each closed curve of the boundary.
fn draw_contact(scene: &Scene, problem: &Problem, inputs: &Inputs) -> Result<Picture, Failure> {
    let (levels, law) = (problem.levels(), scene.law());
    let mut runs = Vec::new();
    for &stop in &scene.stop {
        let pair = solve::pair(inputs, scene, stop, problem)?;
        let label = solve::label(inputs, scene, stop)?;
        let in_contact = levels.in_contact(law, &pair);
        let (a, in_contact) =
            (problem.at_nodes(&pair.a, 0.0), problem.at_nodes(&in_contact, false));
        runs.push((label, a, in_contact, pair.y));
    }
    let mesh = levels.mesh(problem.finest());
    let mesh = plane(&mesh)?;
    let curves = boundary_curves(mesh);
    let mut titles = Vec::new();
    for curve in &curves {
        let parts = curve.parts.iter().map(|&part| mesh.parts()[part].names.to_string());
        let parts: Vec<_> = parts.collect();
        titles.push(format!("{}: {}", scene.title, parts.join(", ")));
    }
    let mut panels = Vec::new();
    for (curve, title) in curves.iter().zip(&titles) {
        let lines = runs.iter().map(|(label, a, in_contact, y)| ContactLine {
            label: label.clone(),
            y: at(y, &curve.nodes),
            a: at(a, &curve.nodes),
            in_contact: at(in_contact, &curve.nodes),
        });
        let lines = lines.collect();
        let mut places = arc_lengths(mesh, &curve.nodes);
        let length = places.pop().unwrap_or_default();
        panels.push(ContactPanel {
            title,
            places,
            length,
            has_sides: false,
            law: scene.law(),
            lines,
        });
    }
    Ok(contact(&panels))
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
