//! Sides with bends that are too small for corners.

use crate::mesh::{AnyMesh, gmsh};
use crate::problem::source::Source;
use crate::spectral::problem::PlaneProblem;
use crate::spectral::true_solution_on;

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
        let found = true_solution_on(mesh.plane().unwrap(), &[Source::constant(-1.0)]);
        let [lower, upper] = found.unwrap().bracket.unwrap();
        let known: f64 = square + rate * by;
        let rounding = 1e-15 + 1e-8 * by;
        assert!(lower < known + rounding && known - rounding < upper, "{by}: {lower} {upper}");
        assert!(upper - lower < 2e-13, "{by}: {lower} {upper}");
    }
    // A path of many nodes has one side more for each, but no corner.
    let nodes: Vec<[f64; 2]> =
        (1..10).map(|k| [0.1 * f64::from(k), 3e-11 * f64::from(k * (10 - k))]).collect();
    let mesh = lowered(&nodes);
    let f = [Source::constant(-1.0)];
    let problem = PlaneProblem::on_mesh(mesh.plane().unwrap(), &f).unwrap();
    let sides = &problem.domain.rings[0].sides;
    assert_eq!(sides.iter().map(|side| side.is_after_bend).filter(|own| *own).count(), 9);
    assert_eq!(sides.len(), 13);
}
