//! f on meshes: exact integrals of constant pieces, sampled ones of formulas, and brackets that hold the true energy.

use crate::common::{Dice, Project, TABLE, mesh, mesh_path, number};
use serde_json::json;
use signorini_mathematics::discrete::cells::CutCube;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::mesh::{
    AnyMesh, ConstantPieces, Mesh, MeshData, OnCells, PlaneMesh, mesh_load, uniform_cube,
    uniform_square,
};
use signorini_mathematics::square::load::load;
use std::borrow::Cow;
use std::collections::BTreeSet;

use signorini_mathematics::levels::Problem;

use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::solvers::{Settings, Solver, solve};
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Shapes of all kinds, smaller and larger than the cells, some of them hidden or beside the domain.
fn random_shapes(dice: &mut Dice, count: usize) -> String {
    let mut text = String::new();
    for _ in 0..count {
        let [x, y] = [0.0; 2].map(|_| dice.between(-1.0, 1.0));
        let size = 10f64.powf(dice.between(-3.0, 0.0));
        let value = dice.between(-1.0, 1.0) * (3.0 + 0.02 / (size * size));
        text += &match (4.0 * dice.unit()) as usize {
            0 => format!("rect({x},{},{y},{})={value}; ", x + size, y + 0.3 * size),
            1 => format!("halfplane({x},{y},{})={}; ", 0.5 * size, dice.between(-3.0, 3.0)),
            _ => format!("disc({x},{y},{size})={value}; "),
        };
    }
    text
}

#[test]
fn loads_on_triangles_are_those_of_the_square() {
    let mut dice = Dice(31);
    let grid = Grid::new(8).unwrap();
    let mesh = uniform_square(grid);
    for case in 0..60 {
        let text = format!("{}else=-1", random_shapes(&mut dice, 1 + case % 6));
        let f: Source = text.parse().unwrap();
        let ours = mesh_load(&mesh, &f).unwrap();
        let exact = load(grid, &f, LoadRule::Exact { diagonal: Diagonal::Rising });
        let apart =
            ours.load.iter().zip(&exact).fold(0.0f64, |most, (p, q)| most.max((p - q).abs()));
        assert!(apart < 1e-13 * (1.0 + ours.size), "{text}: {apart:e}");
        let absolute = mesh_load(&mesh, &f.absolute()).unwrap().integral;
        assert!((ours.size - absolute).abs() < 1e-13 * absolute, "{text}");
        assert_eq!(ours.unsettled, None);
    }
}

#[test]
fn deviations_are_those_of_the_square_of_f() {
    // On each of two triangles f is 3 on a disc and -2 elsewhere.
    let data = MeshData {
        points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        cells: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    };
    let mesh: PlaneMesh = data.mesh().unwrap();
    let f: Source = "disc(0.7,0.3,0.01)=3; disc(0.3,0.7,0.0001)=3; else=-2".parse().unwrap();
    let made = mesh_load(&mesh, &f).unwrap();
    for (cell, radius) in [0.01f64, 0.0001].into_iter().enumerate() {
        let share = 2.0 * PI * radius * radius;
        let deviation = 5.0 * (0.5 * share * (1.0 - share)).sqrt();
        assert!((made.cells.mean[cell] - (5.0 * share - 2.0)).abs() < 1e-14);
        let found = made.cells.deviation.as_ref().unwrap()[cell];
        assert!((found - deviation).abs() < 1e-10 * deviation, "{found} {deviation}");
    }
}

#[test]
fn integrals_on_tetrahedra_are_those_of_slices() {
    let mut dice = Dice(7);
    let meshes = [1, 2, 3, 6].map(uniform_cube);
    let mut slices = CutCube::default();
    for case in 0..24 {
        let mut text = String::new();
        for _ in 0..1 + case % 4 {
            let [x, y, z, value] = [0.0; 4].map(|_| dice.between(-0.5, 0.5));
            let size = 10f64.powf(dice.between(-2.0, 0.0));
            text += &match (4.0 * dice.unit()) as usize {
                0 => format!("halfspace({x},{y},{z},{})={value}; ", 0.1 * size),
                1 => format!("box({x},{},{y},{},{z},{})={value}; ", x + size, y + 0.5, z + size),
                _ => format!("ball({x},{y},{z},{})={value}; ", 0.8 * size),
            };
        }
        let f: Source<3> = format!("{text}else=-0.3").parse().unwrap();
        let Source::Pieces { background, pieces } = &f else { panic!("{f}") };
        // Of the hat functions of the corners of the whole cube: with weights x, they sum to x.
        slices.set(*background, pieces.iter().rev().copied());
        let corners = slices.corners();
        let exact = [None, Some(0), Some(1), Some(2)].map(|axis| {
            let of_corner = |(corner, load): (usize, &f64)| match axis {
                Some(axis) if corner >> axis & 1 == 0 => -0.5 * load,
                Some(_) => 0.5 * load,
                None => *load,
            };
            corners.iter().enumerate().map(of_corner).sum::<f64>()
        });
        let Source::Pieces { background, pieces } = f.absolute() else { panic!("{f}") };
        slices.set(background, pieces.into_iter().rev());
        let absolute = slices.integral();
        for mesh in &meshes {
            let ours = mesh_load(mesh, &f).unwrap();
            let of_axis = |axis: usize| {
                let points = mesh.points().iter().zip(&ours.load);
                points.map(|(point, load)| point[axis] * load).sum::<f64>()
            };
            let moments = [ours.load.iter().sum(), of_axis(0), of_axis(1), of_axis(2)];
            let apart = moments.iter().zip(exact).fold(0.0, |most, (p, q)| (p - q).abs().max(most));
            assert!(apart < 1e-9, "{f}: {moments:?} {exact:?}");
            assert!((ours.size - absolute).abs() < 1e-9, "{f}: {} {absolute}", ours.size);
        }
    }
}

#[test]
fn integrals_have_no_scale() {
    let integral = |name: &str, scale: f64| {
        let f = match name {
            "lshape" => format!(
                "disc({},{},{})=5; rect({},{},0,{scale})=3; halfplane(1,2,{})=-7; else=1",
                0.3 * scale,
                0.4 * scale,
                0.01 * scale,
                -0.7 * scale,
                -0.2 * scale,
                -0.5 * scale
            ),
            _ => format!(
                "ball({},{},0,{})=5; box(0,{scale},{},0,0,{scale})=3; else=1",
                0.1 * scale,
                0.2 * scale,
                0.3 * scale,
                -0.4 * scale
            ),
        };
        let mesh = match mesh(name) {
            AnyMesh::Plane(mesh) => AnyMesh::Plane(scaled(&mesh, scale)),
            AnyMesh::Space(mesh) => AnyMesh::Space(scaled(&mesh, scale)),
        };
        let made =
            Problem::on_mesh(&mesh.clone().with_law(Law::friction(1e60).unwrap()), 1, &f).unwrap();
        made.levels().facts().integral / scale.powi(mesh.dimension().into())
    };
    for name in ["lshape", "ball"] {
        let one = integral(name, 1.0);
        for scale in [1e-40, 1e-6, 3e4, 1e40] {
            let other = integral(name, scale);
            assert!((other / one - 1.0).abs() < 1e-12, "{name} {scale:e}: {other} {one}");
        }
    }
}

/// A mesh with all coordinates multiplied by a number.
fn scaled<const D: usize, const V: usize>(mesh: &Mesh<D, V>, scale: f64) -> Mesh<D, V> {
    let points = mesh.points().iter().map(|point| point.map(|x| scale * x)).collect();
    let data = MeshData { points, cells: mesh.cells().to_vec(), ..MeshData::default() };
    data.mesh().unwrap()
}

/// Energy of the discrete solution, with the bracket of the true energy.
fn energies(problem: &Problem) -> (f64, [f64; 2]) {
    let run = solve(problem, &Settings::of(Solver::Multigrid)).unwrap();
    (run.judgement.energy, problem.bounds(&run.y).unwrap().energy)
}

#[test]
fn brackets_hold_the_energy_of_a_solution_three_refinements_finer() {
    let mut dice = Dice(500);
    let mut tried = 0;
    for case in 0..90 {
        let mesh = mesh(["lshape", "square", "gear"][case % 3]);
        let law = match case % 5 {
            0 | 1 => Law::SIGNORINI,
            2 | 3 => Law::friction(dice.between(1.0, 6.0)).unwrap(),
            _ => Law::new(-0.3, dice.between(2.0, 6.0)).unwrap(),
        };
        let f =
            format!("{}else=-{}", random_shapes(&mut dice, 1 + case % 4), dice.between(0.1, 5.0));
        let times = if mesh.nodes() < 20 { case % 2 } else { 0 };
        let Ok(problem) = Problem::on_mesh(&mesh.clone().with_law(law), times, &f) else {
            continue;
        };
        assert!(!problem.levels().facts().by_quadrature);
        let (_, [low, high]) = energies(&problem);
        let (fine, finer) =
            energies(&Problem::on_mesh(&mesh.clone().with_law(law), times + 3, &f).unwrap());
        let slack = 1e-10 * low.abs();
        assert!(low - slack <= fine && fine <= high + slack, "{f} {law}: {fine} {low} {high}");
        assert!(finer[1] - finer[0] < high - low, "{f} {law}: {finer:?} {low} {high}");
        tried += 1;
    }
    assert!(tried >= 36, "{tried}");
}

#[test]
fn answers_say_on_what_their_bounds_rest() {
    let project = Project::with(TABLE);
    let (pieces, formula) = ("--f 'disc(0.1,0.2,0.05)=-2; else=-1'", "--f 'formula(x*y - 2)'");
    let square = format!("--domain {} --refine 1 {pieces}", mesh_path("square"));
    let curved = format!("{square} --curve south=0.5,-10,10.012492197250394");
    let [exactly, quadrature] =
        ["guaranteed: true energy", "guaranteed, but for the quadrature of formulas:"];
    for (problem, f, reserve, words) in [
        ("--h 1/8", pieces, json!([]), exactly),
        ("--h 1/8", formula, json!(["quadrature"]), quadrature),
        ("--domain cube --refine 1", "--f 'ball(0,0,0,0.2)=-2; else=-1'", json!([]), exactly),
        ("--domain cube --refine 1", "--f 'formula(x - 2)'", json!(["quadrature"]), quadrature),
        ("--domain lshape --refine 1", pieces, json!([]), exactly),
        ("--domain lshape --refine 1", formula, json!(["quadrature"]), quadrature),
        ("--domain disc --refine 1", pieces, json!(["polygon"]), "guaranteed, on the polygon:"),
        (
            "--domain annulus --refine 1",
            formula,
            json!(["quadrature", "polygon"]),
            "guaranteed, on the polygon, but for the quadrature of formulas:",
        ),
        ("--domain ball --refine 1", "--f else=-1", json!(["polygon"]), "on the polyhedron:"),
        (&square, "", json!([]), exactly),
        (&curved, "", json!(["polygon"]), "guaranteed, on the polygon:"),
    ] {
        let line = format!("{problem} {f}");
        let said = project.line(&format!("solve {line}"));
        assert!(said.lines().iter().any(|line| line.contains(words)), "{line}: {said:?}");
        assert_eq!(project.answer(&line)["bound"]["reserve"], reserve, "{line}");
    }
}

#[test]
fn sources_between_the_points_of_a_quadrature_are_seen() {
    let project = Project::with(TABLE);
    for (line, integral) in [
        ("--refine 2 --f 'disc(-0.36,0.69,0.05)=-141; else=-0.991'", -4.0726),
        ("--refine 3 --f 'disc(0.53,0.43,0.02)=800; else=-1'", -1.9934),
        ("--refine 0 --f 'rect(0.1,0.1001,0.1,0.1001)=-1e8; else=-1'", -4.0),
    ] {
        let found = number(&project.answer(&format!("--domain lshape {line}"))["integral_f"]);
        assert!((found - integral).abs() < 1e-4, "{line}: {found}");
    }
}

#[test]
fn loads_on_a_mesh_do_not_depend_on_the_refinements_that_follow() {
    let f = "disc(-0.3,-0.3,0.4)=-6; else=0.6";
    let [short, long] = [2, 3].map(|times| {
        let problem = Problem::on_mesh(&mesh("disc"), times, f).unwrap();
        problem.loads().unwrap().into_iter().map(Cow::into_owned).collect::<Vec<_>>()
    });
    assert_eq!(short[..], long[..3]);
    let sums = [2, 3].map(|level: usize| long[level].iter().sum::<f64>());
    assert!((sums[0] - sums[1]).abs() > 1e-3, "{sums:?}");
}

/// f that counts how often it is asked for.
struct Counted(AtomicUsize);

impl<const D: usize> OnCells<D> for Counted {
    fn pieces(&self, _region: u16) -> Option<ConstantPieces<'_, D>> {
        None
    }

    fn at(&self, _region: u16, point: [f64; D]) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed);
        point[0] - 0.3
    }
}

/// Number of edges of a mesh.
fn edges<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> usize {
    let pairs = mesh.cells().iter().flat_map(|cell| {
        let to_others =
            |&one| cell.iter().filter(move |other| **other > one).map(move |&other| [one, other]);
        cell.iter().flat_map(to_others)
    });
    pairs.collect::<BTreeSet<_>>().len()
}

#[test]
fn f_is_taken_once_at_each_point() {
    // So many cells that none is divided at first, and f is settled then. One formula has the nodes and the midpoints
    // of the edges, and both have the centroid.
    let (square, cube) = (uniform_square(Grid::new(128).unwrap()), uniform_cube(18));
    let counted = Counted(AtomicUsize::new(0));
    mesh_load(&square, &counted).unwrap();
    assert_eq!(
        counted.0.into_inner(),
        7 * square.cells().len() + edges(&square) + square.points().len()
    );
    let counted = Counted(AtomicUsize::new(0));
    mesh_load(&cube, &counted).unwrap();
    assert_eq!(
        counted.0.into_inner(),
        15 * cube.cells().len() + edges(&cube) + cube.points().len()
    );
}
