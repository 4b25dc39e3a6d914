//! Loads do not change when a half-plane is scaled, and turn with the cube; those of smooth f fit either diagonal.

use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::mesh::{mesh_load, uniform_cube};
use signorini_mathematics::problem::shape::Shape;
use signorini_mathematics::square::load::load;

use signorini_mathematics::problem::exact::Exact;
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

#[test]
fn smooth_loads_are_the_integrals_over_the_triangles_of_either_diagonal() {
    let (f, n, parts) = (Exact::FullContact, 24, 8);
    let grid = Grid::new(n).unwrap();
    for diagonal in [Diagonal::Rising, Diagonal::Falling] {
        let mut want = vec![0.0; grid.nodes()];
        for (i, j, upper) in (0..2 * n * n).map(|k| (k / 2 % n, k / 2 / n, k % 2 == 1)) {
            let corners = match (diagonal, upper) {
                (Diagonal::Rising, false) => [[0, 0], [1, 0], [1, 1]],
                (Diagonal::Rising, true) => [[0, 0], [1, 1], [0, 1]],
                (Diagonal::Falling, false) => [[0, 0], [1, 0], [0, 1]],
                (Diagonal::Falling, true) => [[1, 0], [1, 1], [0, 1]],
            };
            let nodes = corners.map(|[a, b]| [i + a, j + b]);
            // The rule of the midpoints of sides, exact for quadratics, on small triangles.
            let area = 0.5 * (grid.h() / parts as f64).powi(2);
            let small = |a: usize, b: usize| {
                let up = [[a, b], [a + 1, b], [a, b + 1]];
                let down = [[a + 1, b + 1], [a + 1, b], [a, b + 1]];
                [Some(up), (a + b + 2 <= parts).then_some(down)].into_iter().flatten()
            };
            for corner in (0..parts).flat_map(|a| (0..parts - a).flat_map(move |b| small(a, b))) {
                for side in 0..3 {
                    let [p, q] = [corner[side], corner[(side + 1) % 3]];
                    let [s, t] = [0, 1].map(|k| (p[k] + q[k]) as f64 / (2 * parts) as f64);
                    let hats = [1.0 - s - t, s, t];
                    let [x, y] = [0, 1].map(|k| {
                        let of = |node: &[usize; 2]| grid.coordinate(node[k]);
                        nodes.iter().zip(hats).map(|(node, hat)| hat * of(node)).sum::<f64>()
                    });
                    for (node, hat) in nodes.iter().zip(hats) {
                        want[grid.index(node[0], node[1])] += area / 3.0 * f.source(x, y) * hat;
                    }
                }
            }
        }
        let ours = load(grid, &Source::from(f), LoadRule::Exact { diagonal });
        for (ours, want) in ours.iter().zip(&want) {
            assert!((ours - want).abs() < 1e-8, "{diagonal:?}: {ours} {want}");
        }
    }
}
