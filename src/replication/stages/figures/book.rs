//! Figures that only the book shows: the problem, the grid, and the paper's problems where the first rule stops.

use super::{drawing, surface};
use crate::figures::{
    DrawnSolution, GradientPanel, Picture, gradients as draw_gradients, grid, membrane,
    mesh_picture, range_with_zero, surfaces, table_of_surfaces,
};
use crate::pipeline::error::Failure;
use crate::pipeline::{Inputs, Task, parameters};
use crate::replication::scene::Scene;
use crate::replication::stages::solve;
use serde_json::json;
use signorini_mathematics::experiments::adapted::AdaptedProblem;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{Pair, tolerance};
use signorini_mathematics::solvers::{self, Run, Settings, Solver};
use std::collections::BTreeMap;

/// The task that draws, in a row per problem, the surface where the paper stopped, the solution, and the difference.
pub(super) fn stops(scenes: &[&Scene]) -> Task {
    let scenes: Vec<Scene> = scenes.iter().copied().cloned().collect();
    let mut hashed = BTreeMap::new();
    for scene in &scenes {
        let Scene { name, title, .. } = scene;
        hashed.insert(format!("{name}.title"), title.clone());
        hashed.insert(format!("{name}.f"), scene.on_grids().f.to_string());
    }
    let needs = scenes.iter().map(surface).collect();
    let title = "Where the paper stopped, where the solution is, and the difference";
    let task = drawing("stops", title.into(), needs, move |inputs| {
        let mut rows = Vec::new();
        for scene in &scenes {
            rows.push(row_of_stops(inputs, scene)?);
        }
        let mut panels = Vec::new();
        for row in &rows {
            let heights = row.iter().flat_map(|one| one.y.iter().copied());
            let (azimuth, range) = (row[1].azimuth(), Some(range_with_zero(heights)));
            panels.extend(row.iter().map(|one| one.panel(azimuth, range)));
        }
        Ok(surfaces(3, &panels))
    });
    Task { parameters: hashed, ..task }
}

/// Surfaces of one problem: where the paper stopped, the solution, and the difference.
fn row_of_stops(inputs: &Inputs, scene: &Scene) -> Result<[DrawnSolution; 3], Failure> {
    let on = (scene.finest(), Law::SIGNORINI);
    let stop = solve::pair_on_grid(inputs, scene)?;
    let solution = solve::solution(scene)?;
    let difference = Pair {
        y: solution.y.iter().zip(&stop.y).map(|(v, y)| v - y).collect(),
        a: vec![0.0; stop.a.len()],
    };
    let title = |name: &str| format!("{}: {name}", scene.title);
    let [stop, solution] = [("where it stopped", &stop), ("the solution", &solution)]
        .map(|(name, pair)| DrawnSolution::on_grid(title(name), on, pair, 3));
    let difference = DrawnSolution::on_grid(title("the difference"), on, &difference, 3);
    Ok([stop, solution, difference.without_contact()])
}

/// The task that draws the surfaces where the paper stopped on each grid, and the solution.
pub(super) fn iterates(scene: &Scene) -> Task {
    let scene = scene.clone();
    let title = format!("{}: where the paper stopped on each grid, and the solution", scene.title);
    let hashed = parameters(&json!({ "title": scene.title, "cell": solve::drawn(&scene) }));
    let task = drawing("iterates", title, Vec::new(), move |_| {
        let mut states = solve::stops(&scene)?;
        states.push((scene.finest(), solve::solution(&scene)?));
        let mut drawn = Vec::new();
        for (k, (grid, pair)) in states.iter().enumerate() {
            let title = match k + 1 == states.len() {
                true => "the solution".into(),
                false => format!("h = 1/{}", grid.cells()),
            };
            drawn.push(DrawnSolution::on_grid(title, (*grid, Law::SIGNORINI), pair, 3));
        }
        let heights = drawn.iter().flat_map(|one| one.y.iter().copied());
        let range = Some(range_with_zero(heights));
        let azimuth = drawn[drawn.len() - 1].azimuth();
        let panels: Vec<_> = drawn.iter().map(|one| one.panel(azimuth, range)).collect();
        Ok(surfaces(3, &panels))
    });
    Task { parameters: hashed, ..task }
}

/// The tasks that draw the problem, the grid, and solutions on other domains; they read nothing.
pub(super) fn drawings() -> [Task; 5] {
    let domains = "Solutions on the L-shape, the disc and the annulus";
    [
        drawing("domains", domains.into(), Vec::new(), |_| Ok(on_domains()?)),
        drawing("meshes", "Meshes of three domains, refined once".into(), Vec::new(), |_| {
            Ok(meshes()?)
        }),
        drawing("adapted-mesh", "Adapted meshes of two domains".into(), Vec::new(), |_| {
            Ok(adapted_meshes()?)
        }),
        drawing("membrane", "The square and its membrane".into(), Vec::new(), |_| Ok(membrane())),
        drawing("grid", "The coarsest grid, in the order of the sweep".into(), Vec::new(), |_| {
            Ok(grid())
        }),
    ]
}

/// Domains that are drawn: name, f, and number of refinements.
const DRAWN: [(&str, &str, usize); 3] = [
    ("lshape", "rect(-1,0,-1,0)=3; else=-2", 3),
    ("disc", "rect(-1,0,-1,0)=-6; else=1", 3),
    ("annulus", "rect(-1,0,-1,0)=-6; else=1", 2),
];

/// Draws the meshes of the domains, refined once.
fn meshes() -> Result<Picture, String> {
    let mut refined = Vec::new();
    for (name, ..) in DRAWN {
        let coarsest = AnyMesh::built_in(name).ok_or_else(|| format!("no domain {name}"))?;
        refined.push((name.to_owned(), coarsest.refined(1).map_err(|e| e.to_string())?));
    }
    beside(&refined)
}

/// Draws meshes in the plane with their titles beside each other.
fn beside(meshes: &[(String, AnyMesh)]) -> Result<Picture, String> {
    let mut panels = Vec::new();
    for (title, mesh) in meshes {
        let AnyMesh::Plane(mesh) = mesh else { return Err(format!("{title} is no plane domain")) };
        panels.push((&title[..], mesh));
    }
    Ok(mesh_picture(&panels))
}

/// Draws the last mesh with few nodes of each problem with adapted meshes.
fn adapted_meshes() -> Result<Picture, String> {
    /// Most nodes of a mesh.
    const FEW: usize = 600;
    let mut adapted = Vec::new();
    for problem in [AdaptedProblem::lshape(), AdaptedProblem::fixed_free()] {
        // No mesh so coarse is so accurate: the number of nodes is what ends the run.
        let run = problem.adapted(f64::EPSILON, FEW, 1)?;
        let title = format!("{}, {} nodes", problem.domain.name(), run.y.len());
        adapted.push((title, run.problem.levels().mesh()));
    }
    beside(&adapted)
}

/// Draws solutions on domains in the plane.
fn on_domains() -> Result<Picture, String> {
    let mut drawn = Vec::new();
    for (name, f, refinements) in DRAWN {
        let coarsest = AnyMesh::built_in(name).ok_or_else(|| format!("no domain {name}"))?;
        let problem = Problem::on_mesh(&coarsest, refinements, f, Law::SIGNORINI)
            .map_err(|e| format!("{name}: {e}"))?;
        let Run { y, judgement, .. } = solvers::solve(&problem, &Settings::of(Solver::Multigrid))
            .map_err(|e| format!("{name}: {e}"))?;
        let pair = Pair { a: judgement.multiplier(&y), y };
        drawn.push(DrawnSolution::of(name.into(), &problem, &pair, 3)?);
    }
    let panels: Vec<_> = drawn.iter().map(|one| one.panel(one.azimuth(), None)).collect();
    let mut picture = surfaces(3, &panels);
    // No page offers these solutions as files.
    picture.table = Some(table_of_surfaces(&panels));
    Ok(picture)
}

/// The task that draws the gradient where the paper stopped, a map per problem.
pub(super) fn gradients(scenes: &[&Scene]) -> Task {
    let scenes: Vec<Scene> = scenes.iter().copied().cloned().collect();
    let mut hashed = BTreeMap::new();
    for scene in &scenes {
        let read = json!({
            "title": scene.title, "f": scene.on_grids().f.to_string(),
            "load": scene.on_grids().load, "grids": scene.on_grids().grids.len(), "r": scene.saddle().draw_r,
        });
        hashed.insert(scene.name.clone(), read.to_string());
    }
    let needs = scenes.iter().map(surface).collect();
    let title = "Components of the gradient where the paper stopped, over the tolerance";
    let task = drawing("gradient", title.into(), needs, move |inputs| {
        let mut panels = Vec::new();
        for scene in &scenes {
            panels.push(GradientPanel {
                title: &scene.title,
                grid: scene.finest(),
                tolerance: tolerance(scene.on_grids().grids.len()),
                gradient: solve::gradient(inputs, scene)?,
            });
        }
        Ok(draw_gradients(&panels))
    });
    Task { parameters: hashed, ..task }
}
