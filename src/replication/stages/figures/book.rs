//! Figures that only the book shows: other domains, and the paper's problems where the first rule stops.

use super::{Draw, Drawing, drawing, shown, surface};
use crate::figures::{
    DrawnSolution, GradientPanel, Picture, gradients as draw_gradients, mesh_picture, surfaces,
    table_of_surfaces,
};
use crate::pipeline::error::Failure;
use crate::pipeline::{Inputs, Task};
use crate::replication::scene::{Output, Scene};
use crate::replication::stages::solve;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::saddle::{Pair, tolerance};
use signorini_mathematics::statement::{Domain, Fineness, Statement};

/// Returns the drawing of scenes, each as its surface shows it.
fn of_surfaces(title: &str, scenes: &[&Scene]) -> Drawing {
    let scenes = scenes.iter().map(|scene| shown(Output::Surface, scene)).collect();
    Drawing { title: title.into(), scenes }
}

/// The task that draws, in a row per problem, the surface where the paper stopped, the solution, and the difference.
pub(super) fn stops(scenes: &[&Scene]) -> Task {
    let needs = scenes.iter().map(|scene| surface(scene)).collect();
    let title = "Where the paper stopped, where the solution is, and the difference";
    drawing("stops", &of_surfaces(title, scenes), needs, |it, inputs| {
        let mut panels = Vec::new();
        for scene in &it.scenes {
            panels.extend(row_of_stops(inputs, scene)?);
        }
        it.made(inputs, surfaces(3, &panels))
    })
}

/// Surfaces of one problem: where the paper stopped, the solution, and the difference.
fn row_of_stops(inputs: &Inputs, scene: &Scene) -> Result<Vec<DrawnSolution>, Failure> {
    let grid = scene.finest();
    let stop = solve::pair_on_grid(inputs, scene)?;
    let solution = solve::solution(scene)?;
    let difference = Pair {
        y: solution.y.iter().zip(&stop.y).map(|(v, y)| v - y).collect(),
        a: vec![0.0; stop.a.len()],
    };
    let pairs =
        [("where it stopped", &stop), ("the solution", &solution), ("the difference", &difference)];
    let [stop, solution, difference] = pairs.map(|(name, pair)| {
        DrawnSolution::on_grid(format!("{}: {name}", scene.title), grid, pair, 3)
    });
    let azimuth = solution.azimuth;
    Ok(DrawnSolution::seen(vec![stop, solution, difference.without_contact()], azimuth))
}

/// The task that draws the surfaces where the paper stopped on each grid, and the solution.
pub(super) fn iterates(scene: &Scene) -> Task {
    let title = format!("{}: where the paper stopped on each grid, and the solution", scene.title);
    // The method runs again, with all its settings.
    let mut scene = Scene { outputs: Vec::new(), ..scene.clone() };
    scene.study.members.retain(|member| member.statement == scene.statement);
    let scenes = vec![scene];
    drawing("iterates", &Drawing { title, scenes }, Vec::new(), |it, inputs| {
        let scene = &it.scenes[0];
        let mut states = solve::stops(scene)?;
        states.push((scene.finest(), solve::solution(scene)?));
        let mut drawn = Vec::new();
        for (k, (grid, pair)) in states.iter().enumerate() {
            let title = match k + 1 == states.len() {
                true => "the solution".into(),
                false => format!("h = 1/{}", grid.cells()),
            };
            drawn.push(DrawnSolution::on_grid(title, *grid, pair, 3));
        }
        let azimuth = drawn[drawn.len() - 1].azimuth;
        it.made(inputs, surfaces(3, &DrawnSolution::seen(drawn, azimuth)))
    })
}

/// The tasks that draw meshes of other domains and solutions on them; they read nothing.
pub(super) fn drawings() -> [Task; 3] {
    let all: [(&str, &str, Draw); 3] = [
        ("domains", "Solutions on the L-shape, the disc and the annulus", |it, inputs| {
            it.made(inputs, on_domains()?)
        }),
        ("meshes", "Meshes of three domains, refined once", |it, inputs| {
            it.made(inputs, meshes()?)
        }),
        ("adapted-mesh", "Adapted meshes of three domains", |it, inputs| {
            it.made(inputs, adapted_meshes()?)
        }),
    ];
    all.map(|(name, title, draw)| drawing(name, &Drawing::new(title), Vec::new(), draw))
}

/// Domains that are drawn: name, f, and number of refinements.
const DRAWN: [(&str, &str, u8); 3] = [
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

/// Draws the meshes of the domains on which the guaranteed error is a tenth of the solution.
fn adapted_meshes() -> Result<Picture, String> {
    let mut adapted = Vec::new();
    for (name, f, _) in DRAWN {
        let fineness = Fineness::Within(Accuracy::Error(0.1));
        let statement = Statement { fineness, ..Statement::usual(Domain::named(name), f) };
        let problem = statement.solved(None).map_err(|e| format!("{name}: {e}"))?.problem;
        let mesh = problem.levels().mesh(problem.finest()).into_owned();
        adapted.push((format!("{name}, {} nodes", mesh.nodes()), mesh));
    }
    beside(&adapted)
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

/// Draws solutions on domains in the plane.
fn on_domains() -> Result<Picture, String> {
    let mut drawn = Vec::new();
    for (name, f, refinements) in DRAWN {
        let (domain, fineness) = (Domain::named(name), Fineness::Refined(refinements));
        let statement = Statement { fineness, ..Statement::usual(domain, f) };
        let solved = statement.solved(None).map_err(|e| format!("{name}: {e}"))?;
        drawn.push(DrawnSolution::of(name.into(), &solved.problem, &solved.pair(), 3)?);
    }
    let mut picture = surfaces(3, &drawn);
    // No page offers these solutions as files.
    picture.table = Some(table_of_surfaces(&drawn));
    Ok(picture)
}

/// The task that draws the gradient where the paper stopped, a map per problem.
pub(super) fn gradients(scenes: &[&Scene]) -> Task {
    let needs = scenes.iter().map(|scene| surface(scene)).collect();
    let title = "Components of the gradient where the paper stopped, over the tolerance";
    drawing("gradient", &of_surfaces(title, scenes), needs, |it, inputs| {
        let mut panels = Vec::new();
        for scene in &it.scenes {
            panels.push(GradientPanel {
                title: &scene.title,
                grid: scene.finest(),
                tolerance: tolerance(scene.grids().len()),
                gradient: solve::gradient(inputs, scene)?,
            });
        }
        it.made(inputs, draw_gradients(&panels))
    })
}
