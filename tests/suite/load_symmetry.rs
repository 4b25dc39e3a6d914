//! Loads do not change when a half-plane is scaled, and turn with the cube.

use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::mesh::{mesh_load, uniform_cube};
use signorini_mathematics::problem::shape::Shape;
use signorini_mathematics::square::load::load;

use signorini_mathematics::problem::source::Source;

#[test]
fn a_load_does_not_depend_on_the_scale_of_a_half_plane() {
    for (one, same) in [
        ("halfplane(1,0.01,0.1)=2; else=-1", "halfplane(1e-8,1e-10,1e-9)=2; else=-1"),
        ("halfplane(0.01,1,0.1)=2; else=-1", "halfplane(1e9,1e11,1e10)=2; else=-1"),
    ] {
        let exact = |f: &str| {
            let rule = LoadRule::Exact { diagonal: Diagonal::Rising };
            load(Grid::new(12).unwrap(), &f.parse().unwrap(), rule)
        };
        for (a, b) in exact(one).into_iter().zip(exact(same)) {
            assert!((a - b).abs() < 1e-14, "{same}: {a} {b}");
        }
    }
}

#[test]
fn turning_the_cube_turns_the_load() {
    let bodies = [
        Shape::Box([[-0.4, 0.11], [-0.23, 0.31], [0.02, 0.45]]),
        Shape::Ball { centre: [0.2, -0.1, 0.3], radius: 0.27 },
        // With one or two axes along the plane.
        Shape::HalfSpace { normal: [0.0, 0.7, -0.2], d: 0.05 },
        Shape::HalfSpace { normal: [0.0, 0.0, 1.0], d: 0.13 },
        Shape::HalfSpace { normal: [0.3, -0.5, 0.9], d: -0.1 },
    ];
    let turned = |body: Shape<3>, axes: [usize; 3]| match body {
        Shape::Box(sides) => Shape::Box(axes.map(|axis| sides[axis])),
        Shape::Ball { centre, radius } => {
            Shape::Ball { centre: axes.map(|axis| centre[axis]), radius }
        }
        Shape::HalfSpace { normal, d } => {
            Shape::HalfSpace { normal: axes.map(|axis| normal[axis]), d }
        }
    };
    let mesh = uniform_cube(7);
    let place = |node: usize| [node % 8, node / 8 % 8, node / 64];
    for body in bodies {
        let load = |axes| {
            let pieces = vec![(turned(body, axes), 3.0)];
            mesh_load(&mesh, &Source::Pieces { background: -1.0, pieces }).unwrap().load
        };
        let straight = load([0, 1, 2]);
        for axes in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let turned = load(axes);
            for (node, want) in straight.iter().enumerate() {
                let [i, j, k] = axes.map(|axis| place(node)[axis]);
                let ours = turned[i + 8 * j + 64 * k];
                assert!((ours - want).abs() < 1e-14, "{body} {axes:?} {node}: {ours} {want}");
            }
        }
    }
}
