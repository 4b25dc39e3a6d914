//! Figures of a scene on a domain other than the square.

use super::title_with_end;
use crate::figures::{
    ContactLine, ContactPanel, MeshSurface, Picture, contact, mesh_map, mesh_surfaces,
    uphill_on_mesh,
};
use crate::pipeline::Inputs;
use crate::pipeline::error::Failure;
use crate::replication::domain::{RefinedProblem, SceneDomain, drawn};
use crate::replication::scene::{Output, Scene};
use crate::replication::stages::solve::{self, on_mesh};
use signorini_mathematics::mesh::{AnyMesh, PlaneMesh, boundary_curves};
use signorini_mathematics::triangulated::means_on;

/// Draws one of the pictures that a domain in the plane has.
pub(super) fn draw(
    output: Output,
    scene: &Scene,
    domain: &SceneDomain,
    inputs: &Inputs,
) -> Result<Picture, Failure> {
    let refined = domain.problem(inputs.files)?;
    match output {
        Output::Surface => draw_surface(scene, &refined, inputs),
        Output::Contact => draw_contact(scene, &refined, inputs),
        _ => draw_map(scene, domain, &refined),
    }
}

fn plane(mesh: &AnyMesh) -> Result<&PlaneMesh, String> {
    match mesh {
        AnyMesh::Plane(mesh) => Ok(mesh),
        AnyMesh::Space(_) => Err("a solution in space has no picture".into()),
    }
}

/// Returns the mesh of the pictures, whose nodes are the first ones of the finest mesh.
fn mesh_to_draw(RefinedProblem { coarsest, problem }: &RefinedProblem) -> Result<AnyMesh, Failure> {
    Ok(drawn(coarsest, problem.levels.len() - 1)?)
}

fn draw_map(
    scene: &Scene,
    domain: &SceneDomain,
    refined: &RefinedProblem,
) -> Result<Picture, Failure> {
    let mesh = mesh_to_draw(refined)?;
    let f = means_on(&mesh, &domain.f).map_err(|e| e.to_string())?;
    Ok(mesh_map(&scene.title, plane(&mesh)?, &f))
}

fn draw_surface(
    scene: &Scene,
    refined: &RefinedProblem,
    inputs: &Inputs,
) -> Result<Picture, Failure> {
    let pair = on_mesh::pair(inputs, scene, scene.stop[0], refined)?;
    let in_contact = pair.in_contact_on(refined.problem.network(), scene.law());
    let mesh = mesh_to_draw(refined)?;
    let mesh = plane(&mesh)?;
    let nodes = mesh.points().len();
    let (y, in_contact) = (&pair.y[..nodes], &in_contact[..nodes]);
    let title = &title_with_end(inputs, scene)?;
    let azimuth = uphill_on_mesh(mesh, y);
    Ok(mesh_surfaces(2, &[MeshSurface { title, mesh, y, in_contact, azimuth, range: None }]))
}

/// Draws a panel for each closed curve of the boundary.
fn draw_contact(
    scene: &Scene,
    refined: &RefinedProblem,
    inputs: &Inputs,
) -> Result<Picture, Failure> {
    let network = refined.problem.network();
    let mut runs = Vec::new();
    for &stop in &scene.stop {
        let pair = on_mesh::pair(inputs, scene, stop, refined)?;
        let label = solve::label(inputs, scene, stop)?;
        runs.push((
            label,
            pair.multiplier_on(network),
            pair.in_contact_on(network, scene.law()),
            pair.y,
        ));
    }
    let mesh = plane(&refined.problem.mesh)?;
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
