//! Sides of built-in domains and of a file.

use super::*;
use crate::mesh::{AnyMesh, PlaneMesh, boundary_curves, gmsh};
use crate::problem::law::Law;
use crate::spectral::plane::solve_on_mesh;

/// Numbers of sides, and lengths, of the closed curves of a mesh, and the area between them.
fn measured(mesh: &PlaneMesh) -> Result<(Vec<(usize, f64)>, f64), PlaneError> {
    let circles: Vec<_> = mesh.parts().iter().map(|part| part.curve).collect();
    let (mut curves, mut area) = (Vec::new(), 0.0);
    for curve in boundary_curves(mesh) {
        let sides = outline(&curve, &circles)?;
        curves.push((sides.len(), sides.iter().map(PlaneSide::length).sum()));
        for (k, side) in sides.iter().enumerate() {
            let [[x, y], [u, v]] = [0.0, side.length()].map(|s| side.at(s));
            let [z, w] = sides[(k + 1) % sides.len()].at(0.0);
            assert!((u - z).abs() + (v - w).abs() < 1e-14, "{u} {v} {z} {w}");
            let curvature = side.arc.curve.curvature * side.way();
            // The triangle to the origin, and what lies between chord and arc.
            let angle = curvature * side.length();
            area += 0.5 * (x * v - y * u);
            if curvature != 0.0 {
                area += 0.5 * (angle - libm::sin(angle)) / (curvature * curvature);
            }
        }
    }
    Ok((curves, area))
}

fn built_in(name: &str) -> PlaneMesh {
    AnyMesh::built_in(name).and_then(|mesh| mesh.plane().cloned()).expect("a domain in the plane")
}

#[test]
fn built_in_domains_have_their_sides_and_areas() {
    let full = TAU;
    for (name, curves, area) in [
        ("square", vec![(4, 4.0)], 1.0),
        ("lshape", vec![(6, 8.0)], 3.0),
        ("disc", vec![(1, full)], 0.5 * full),
        ("annulus", vec![(1, full), (1, 0.5 * full)], 0.375 * full),
    ] {
        let (found, size) = measured(&built_in(name)).unwrap();
        assert_eq!(found.len(), curves.len(), "{name}");
        for ((sides, length), (known, whole)) in found.into_iter().zip(curves) {
            assert_eq!(sides, known, "{name}");
            assert!((length - whole).abs() < 1e-14, "{name}: {length}");
        }
        assert!((size - area).abs() < 1e-14, "{name}: {size}");
        // The refined mesh has the same outline.
        let finer = AnyMesh::from(built_in(name)).refined(3).unwrap();
        let (_, again) = measured(finer.plane().unwrap()).unwrap();
        assert!((again - area).abs() < 1e-13, "{name}: {again}");
    }
}

/// Number of sides and length of the second curve of a boundary.
fn hole(mesh: &AnyMesh) -> (usize, f64) {
    let mesh = mesh.plane().unwrap();
    let circles: Vec<_> = mesh.parts().iter().map(|part| part.curve).collect();
    let sides = outline(&boundary_curves(mesh)[1], &circles).unwrap();
    (sides.len(), sides.iter().map(PlaneSide::length).sum())
}

#[test]
fn parts_on_circles_are_one_side_and_else_have_as_many_as_edges() {
    let file = include_bytes!("../../../../../../pipeline/meshes/gear.msh");
    let mut mesh = gmsh::read(&file[..]).unwrap();
    assert_eq!(hole(&mesh).0, 12);
    mesh.set_curve("hole", &[0.0, 0.0, 0.3]).unwrap();
    let (sides, length) = hole(&mesh);
    assert!(sides == 1 && (length - 0.3 * TAU).abs() < 1e-14);
    let mut round = AnyMesh::from(built_in("disc")).refined(5).unwrap().plane().unwrap().clone();
    round.parts_mut()[0].curve = None;
    let refused = measured(&round).unwrap_err().to_string();
    let hint = "192 sides, more than 60; a curved part is one side if `curve` puts it on a circle, as rim=0,0,1";
    assert!(refused.contains(hint), "{refused}");
}

/// File of the unit square with nodes on the lower side, each lowered, and triangles round the middle.
fn lowered(nodes: &[[f64; 2]]) -> AnyMesh {
    let lower = nodes.iter().map(|[x, by]| [*x, -by]);
    let corners = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let points: Vec<[f64; 2]> = [[0.0, 0.0]].into_iter().chain(lower).chain(corners).collect();
    let many = points.len();
    let mut file = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", many + 1);
    for (k, [x, y]) in points.iter().chain([&[0.5, 0.5]]).enumerate() {
        file += &format!("{} {x:?} {y:?} 0\n", k + 1);
    }
    file += &format!("$EndNodes\n$Elements\n{many}\n");
    for k in 0..many {
        file += &format!("{0} 2 2 1 1 {0} {1} {2}\n", k + 1, (k + 1) % many + 1, many + 1);
    }
    gmsh::read((file + "$EndElements\n").as_bytes()).unwrap()
}

#[test]
fn a_side_with_small_bends_is_the_path_of_its_nodes() {
    // The energy of the square, and its derivative when the middle of a side is lowered and with it all of the side,
    // linearly to both corners: minus half of the integral of the square of the flux times that, by its series.
    let (square, rate) = (-0.017_572_126_869_394, -0.022_826_656);
    for by in [0.0, 1e-12, 4e-10, 1e-9, 2e-9, 1e-8, 4e-7] {
        let mesh = lowered(&[[0.5, by]]);
        let found =
            solve_on_mesh(mesh.plane().unwrap(), &["else=-1".parse().unwrap()], Law::SIGNORINI);
        let [lower, upper] = found.unwrap().bracket().unwrap();
        let known: f64 = square + rate * by;
        let rounding = 1e-15 + 1e-8 * by;
        assert!(lower < known + rounding && known - rounding < upper, "{by}: {lower} {upper}");
        assert!(upper - lower < 2e-13, "{by}: {lower} {upper}");
    }
    // A path of many nodes has one side more for each, but no corner.
    let nodes: Vec<[f64; 2]> =
        (1..10).map(|k| [0.1 * f64::from(k), 3e-11 * f64::from(k * (10 - k))]).collect();
    let mesh = lowered(&nodes);
    let sides = outline(&boundary_curves(mesh.plane().unwrap())[0], &[]).unwrap();
    assert_eq!(sides.iter().map(|side| side.is_after_bend).filter(|own| *own).count(), 9);
    assert_eq!(sides.len(), 13);
}
