//! Sides of built-in domains and of a file.

use super::*;
use crate::mesh::{AnyMesh, PlaneMesh, boundary_curves, gmsh};

/// Numbers of sides, and lengths, of the closed curves of a mesh, and the area between them.
fn measured(mesh: &PlaneMesh) -> Result<(Vec<(usize, f64)>, f64), PlaneError> {
    let circles: Vec<_> = mesh.parts().iter().map(|part| part.curve).collect();
    let (mut curves, mut area) = (Vec::new(), 0.0);
    for curve in boundary_curves(mesh) {
        let sides = outline(&curve, &circles, Frame::default())?;
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
    let sides = outline(&boundary_curves(mesh)[1], &circles, Frame::default()).unwrap();
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
