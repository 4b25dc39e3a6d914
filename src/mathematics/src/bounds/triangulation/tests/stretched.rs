//! Bounds on stretched cells, and of images of a problem.

use super::bounds_on_mesh;
use super::noise;
use crate::bounds::Bounds;
use crate::bounds::root;
use crate::discrete::nested::NestedNetwork;
use crate::mesh::{Facet, MeshData, Part, PlaneMesh, lattice_mesh, mesh_load, refined};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Bounds of the solution on the last of nested networks, which is that of a mesh.
fn solved(levels: &[NestedNetwork], mesh: &PlaneMesh, f: &Source) -> Bounds {
    let load = mesh_load(mesh, f).unwrap();
    let (y, _) = solve_nested_networks(levels, &load.load, &MultigridParams::default()).unwrap();
    bounds_on_mesh(mesh, &levels[levels.len() - 1].network, &load, &y).unwrap()
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
            solved(&levels, &mesh, &f)
        });
        let error = root(2.0 * (coarse.energy[1] - fine.energy[1]));
        let ratio = coarse.error[1] / error;
        assert!((1.0..1.5).contains(&ratio), "{height}: {ratio}");
    }
}

/// Square whose lower side is fixed on its left half and free on its right half, with cells of graded heights: the
/// first are 256 times as long as high.
fn layer() -> PlaneMesh {
    let mut data = lattice_mesh(&[-0.5, -0.25, 0.0, 0.25, 0.5]);
    data.points.iter_mut().for_each(|[_, y]| *y = libm::pow(*y + 0.5, 5.0) - 0.5);
    let part = |law| Part { names: "".into(), law, curve: None };
    let facet = |k: u32| Facet { nodes: [k, k + 1], part: u16::from(k >= 2) };
    let facets = (0..4).map(facet).collect();
    let parts = vec![part(Law::FIXED), part(Law::FREE)];
    MeshData { points: data.points, cells: data.cells, facets, parts, ..MeshData::default() }
        .mesh()
        .unwrap()
}

#[test]
fn bounds_of_a_boundary_layer_do_not_grow_with_its_refinements() {
    let f = "rect(-9,0,-9,0)=-4; else=2".parse().unwrap();
    let found = [1, 2, 3, 5].map(|times| {
        let (levels, mesh) = refined(&layer(), times).unwrap();
        solved(&levels, &mesh, &f)
    });
    for bounds in &found[..3] {
        let error = root(2.0 * (bounds.energy[1] - found[3].energy[1]));
        let ratio = bounds.error[1] / error;
        assert!((1.0..1.8).contains(&ratio), "{ratio}");
    }
}

/// Mesh of the square with its nodes moved, pressed to a height, seen in a mirror or not, with its nodes and cells in
/// one order or the other.
fn seen(mesh: &PlaneMesh, moves: &[f64], height: f64, is_mirrored: bool) -> PlaneMesh {
    let count = mesh.points().len();
    let is_inner = |node: usize| mesh.facets().iter().all(|at| !at.nodes.contains(&(node as u32)));
    let moved = |node: usize| {
        let [x, y] = mesh.points()[node];
        let [dx, dy] = if is_inner(node) { [moves[node], moves[count + node]] } else { [0.0; 2] };
        [x + 0.02 * dx, height * (y + 0.02 * dy)]
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
    for (height, slip, limit) in [(1.0, 0.4, 0.5), (0.1, 0.08, 0.09)] {
        for law in [Law::SIGNORINI, Law::friction(slip).unwrap(), Law::limited(limit).unwrap()] {
            let [one, two] = [false, true].map(|is_mirrored| {
                let mesh = seen(&mesh, &moves, height, is_mirrored).with_law(law);
                let centre = if is_mirrored { -0.3 } else { 0.3 };
                let [y, radius] = [0.35, 0.2].map(|part| part * height);
                let f = format!("disc({centre},{y},{radius})=2.5; else=-1.3").parse().unwrap();
                let (levels, mesh) = refined(&mesh, 1).unwrap();
                solved(&levels, &mesh, &f).error[1]
            });
            assert!((one / two - 1.0).abs() < 0.01, "{height} {law:?}: {one} {two}");
        }
    }
}
