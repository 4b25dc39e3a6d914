//! Bounds on stretched cells, and of images of a problem.

use super::noise;
use crate::bounds::root;
use crate::bounds::triangulation::{Bounds, bounds_on_mesh};
use crate::discrete::nested::NestedNetwork;
use crate::mesh::{MeshData, PlaneMesh, mesh_load, refined};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Bounds of the solution on the last of nested networks, which is that of a mesh.
fn solved(levels: &[NestedNetwork], mesh: &PlaneMesh, f: &Source, law: Law) -> Bounds {
    let load = mesh_load(mesh, f).unwrap();
    let problem = law.with_load(&load.load);
    let (y, _) = solve_nested_networks(levels, problem, &MultigridParams::default()).unwrap();
    bounds_on_mesh(mesh, &levels[levels.len() - 1].network, &load, law, &y).unwrap()
}

/// Rectangle 1 x `height` of two triangles.
fn strip(height: f64) -> PlaneMesh {
    let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, height], [0.0, height]];
    MeshData { points, cells: vec![[0, 1, 2], [0, 2, 3]], ..MeshData::default() }.mesh().unwrap()
}

#[test]
fn bounds_of_strips_do_not_grow_with_the_aspect() {
    for height in [1.0, 0.1, 0.01, 0.001] {
        let f = "else=-1".parse().unwrap();
        let [coarse, fine] = [4, 6].map(|times| {
            let (levels, mesh) = refined(&strip(height), times).unwrap();
            solved(&levels, &mesh, &f, Law::SIGNORINI)
        });
        let error = root(2.0 * (coarse.energy[1] - fine.energy[1]));
        let ratio = coarse.error[1] / error;
        assert!((1.0..1.5).contains(&ratio), "{height}: {ratio}");
    }
}

/// Mesh with its nodes moved, seen in a mirror or not, with its nodes and cells in one order or the other.
fn seen(mesh: &PlaneMesh, moves: &[f64], is_mirrored: bool) -> PlaneMesh {
    let count = mesh.points().len();
    let is_inner = |node: usize| mesh.facets().iter().all(|at| !at.nodes.contains(&(node as u32)));
    let moved = |node: usize| {
        let [x, y] = mesh.points()[node];
        let [dx, dy] = if is_inner(node) { [moves[node], moves[count + node]] } else { [0.0; 2] };
        [x + 0.02 * dx, y + 0.02 * dy]
    };
    let mut points: Vec<_> = (0..count).map(moved).collect();
    let mut cells = mesh.cells().to_vec();
    if is_mirrored {
        points.reverse();
        points.iter_mut().for_each(|[x, _]| *x = -*x);
        cells.reverse();
        cells.iter_mut().for_each(|cell| {
            *cell = cell.map(|node| count as u32 - 1 - node);
            cell.reverse();
        });
    }
    MeshData { points, cells, ..MeshData::default() }.mesh().unwrap()
}

#[test]
fn bounds_of_mirror_images_agree() {
    let (_, mesh) = refined(&strip(1.0), 3).unwrap();
    let moves = noise(2 * mesh.points().len(), 12.9898);
    for law in [Law::SIGNORINI, Law::friction(0.4).unwrap(), Law::limited(0.5).unwrap()] {
        let [one, two] = [false, true].map(|is_mirrored| {
            let mesh = seen(&mesh, &moves, is_mirrored);
            let centre = if is_mirrored { -0.3 } else { 0.3 };
            let f = format!("disc({centre},0.35,0.2)=2.5; else=-1.3").parse().unwrap();
            let (levels, mesh) = refined(&mesh, 1).unwrap();
            solved(&levels, &mesh, &f, law).error[1]
        });
        assert!((one / two - 1.0).abs() < 0.01, "{law:?}: {one} {two}");
    }
}
