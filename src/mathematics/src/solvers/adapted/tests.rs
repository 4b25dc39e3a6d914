//! True energies that every bracket of every mesh must hold, and what the meshes gain.

use super::*;
use crate::bounds::{Bounds, NoBound};
use crate::levels::Problem;
use crate::mesh::AnyMesh;
use crate::mesh::{BuiltIn, Facet, MeshData, Names, Part, lattice_mesh};
use crate::problem::law::Law;
use crate::saddle::Monitor;
use crate::solvers::reach::{Refining, Tried};
use crate::solvers::solved::ReachEnd;
use crate::solvers::{Settings, Solver, solve};
use std::ops::ControlFlow;

/// Problem with its true energy.
struct KnownEnergy {
    name: &'static str,
    mesh: PlaneMesh,
    f: &'static str,
    energy: f64,
    /// Last digit of the energy.
    digit: f64,
}

/// Meshes of a run.
#[derive(Default)]
struct ShownMeshes(Vec<ShownMesh>);

/// Mesh of a run.
struct ShownMesh {
    nodes: usize,
    bounds: Result<Bounds, NoBound>,
}

impl Monitor for ShownMeshes {}

impl Watcher for ShownMeshes {
    fn tried(&mut self, Tried { nodes, bounds }: Tried<'_>) -> ControlFlow<()> {
        self.0.push(ShownMesh { nodes, bounds: bounds.clone() });
        ControlFlow::Continue(())
    }
}

/// Unit square of eight cells, with these conditions where a point of the boundary satisfies them.
fn square(law: impl Fn([f64; 2]) -> Law) -> PlaneMesh {
    let mut mesh = lattice_mesh(&[-0.5, 0.0, 0.5]);
    let part = |law| Part { names: Names::from("part"), law, curve: None };
    mesh.parts = [Law::SIGNORINI, Law::FREE, Law::FIXED].map(part).to_vec();
    let points = mesh.points.clone();
    for facet in &mut mesh.facets {
        let [a, b] = facet.nodes.map(|node| points[node as usize]);
        facet.part = match law([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]) {
            Law::FREE => 1,
            Law::FIXED => 2,
            _ => 0,
        };
    }
    mesh
}

/// Square (-1, 1)^2 without the line from its centre to its right side.
fn slit() -> PlaneMesh {
    let part = Part { names: Names::from("slit"), law: Law::SIGNORINI, curve: None };
    let data = MeshData {
        // The last node is that of the lower side of the slit.
        points: vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [-1.0, 1.0],
            [-1.0, 0.0],
            [-1.0, -1.0],
            [0.0, -1.0],
            [1.0, -1.0],
            [1.0, 0.0],
        ],
        cells: (1..9).map(|k| [0, k, k + 1]).collect(),
        facets: vec![Facet { nodes: [0, 1], part: 0 }, Facet { nodes: [0, 9], part: 0 }],
        parts: vec![part],
        ..MeshData::default()
    };
    data.mesh().unwrap()
}

fn known() -> Vec<KnownEnergy> {
    let lshape = BuiltIn::LShape.plane().unwrap();
    let contact = || square(|_| Law::SIGNORINI);
    let fixed_free = square(|[x, y]| match (y < -0.49, x < 0.0) {
        (false, _) => Law::SIGNORINI,
        (true, true) => Law::FIXED,
        (true, false) => Law::FREE,
    });
    let mixed = square(|[x, _]| match x.abs() > 0.49 {
        true if x < 0.0 => Law::FIXED,
        true => Law::FREE,
        false => Law::SIGNORINI,
    });
    let half_fixed = square(|[x, y]| match (x < -0.49, y < -0.49 && x > 0.0) {
        (true, _) => Law::FREE,
        (false, true) => Law::FIXED,
        (false, false) => Law::SIGNORINI,
    });
    let friction = |g| Law::friction(g).unwrap();
    let problem = |name, mesh, f, energy, digit| KnownEnergy { name, mesh, f, energy, digit };
    let lower_left = "rect(-9,0,-9,0)=3; else=-2";
    let tiny = "disc(0.13,0.21,0.01)=2228.169203286535; else=-1";
    // Those with digits above 1e-12 are by Aitken's extrapolation from two uniform refinements of an adapted mesh.
    vec![
        problem("L-shape", lshape.clone(), lower_left, -3.019_877_99, 2e-8),
        problem(
            "L-shape with friction",
            lshape.with_law(friction(0.6)),
            "rect(-9,0,-9,0)=6; else=-3.3",
            -5.378_190_1,
            2e-7,
        ),
        problem("fixed and free", fixed_free, "rect(-9,0,-9,0)=-4; else=2", -0.452_388_2, 2e-7),
        problem("slit", slit(), lower_left, -1.322_920_3, 2e-7),
        problem(
            "fixed, free and contact",
            mixed,
            "rect(-9,0,-9,0)=-4; rect(0,9,0,9)=3; else=-1",
            -0.114_191_5,
            2e-7,
        ),
        problem("half fixed", half_fixed, "rect(-9,0,-9,0)=5; else=-3", -0.217_639_3, 2e-7),
        problem("tiny source", contact(), tiny, -0.138_582_877_396_965_8, 1e-12),
        problem(
            "square",
            contact(),
            "rect(-9,0,-9,0)=3; else=-1.1",
            -0.095_051_720_753_350_8,
            1e-12,
        ),
        problem(
            "both signs",
            contact().with_law(friction(1.0)),
            "halfplane(1,0,0)=8; else=-8",
            -0.627_952_316_469_3,
            1e-12,
        ),
    ]
}

impl KnownEnergy {
    /// Runs to a goal; returns the meshes as well.
    fn run(&self, goal: Accuracy) -> (Solved, Vec<ShownMesh>) {
        let mut meshes = ShownMeshes::default();
        let solved = self.adaption(goal).run(&mut meshes, &|_| ()).unwrap();
        (solved, meshes.0)
    }

    fn adaption(&self, goal: Accuracy) -> Adaption<'_> {
        Adaption {
            coarsest: &self.mesh,
            f: self.f,
            goal,
            most_nodes: 1 << 20,
            bisections: Adaption::BISECTIONS,
        }
    }
}

#[test]
fn every_bracket_of_every_mesh_holds_the_true_energy() {
    for problem in known() {
        let (run, meshes) = problem.run(Accuracy::Error(0.03));
        let (name, energy) = (problem.name, problem.energy);
        let (reached, bounds) = (run.reached.as_ref().unwrap(), last(&run));
        assert_eq!(reached.end, ReachEnd::Goal, "{name}");
        assert!(bounds.relative() <= 0.03);
        assert_eq!([run.ends().len(), reached.tried], [meshes.len(); 2]);
        assert!(run.problem.count() > meshes.len());
        for mesh in &meshes {
            let nodes = mesh.nodes;
            let bounds = mesh.bounds.as_ref().map_err(|reason| format!("{name} {nodes}: {reason}"));
            let [low, high] = bounds.unwrap().energy;
            assert!(
                low <= energy + problem.digit && energy - problem.digit <= high,
                "{name} {nodes}: {low} {high}"
            );
            let error = root(2.0 * (high - energy));
            if nodes > 500 && nodes < 5000 {
                let effectivity = mesh.bounds.as_ref().unwrap().error[1] / error;
                assert!(effectivity > 1.0 && effectivity < 1.4, "{name} {nodes}: {effectivity}");
            }
        }
        let [least, most] = bounds.error;
        let error = root(2.0 * (bounds.energy[1] - energy));
        assert!(0.4 * most < least && least < error + 1e-9, "{name}: {least} {error} {most}");
        // The bounds of the problem on its levels are those of the run.
        assert_eq!(run.problem.bounds(&run.pair().y).unwrap().energy, bounds.energy);
    }
}

/// Bounds on the last mesh.
fn last(run: &Solved) -> &Bounds {
    run.bounds().last().unwrap().as_ref().unwrap()
}

fn root(square: f64) -> f64 {
    square.max(0.0).sqrt()
}

/// Slope of the line that fits points best.
fn slope(points: &[[f64; 2]]) -> f64 {
    let mean =
        [0, 1].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / points.len() as f64);
    let product = |point: &[f64; 2], k: usize| (point[0] - mean[0]) * (point[k] - mean[k]);
    let [square, mixed] = [0, 1].map(|k| points.iter().map(|point| product(point, k)).sum::<f64>());
    mixed / square
}

#[test]
fn errors_fall_like_the_inverse_root_of_the_number_of_nodes() {
    for problem in &known() {
        let (_, meshes) = problem.run(Accuracy::Error(0.01));
        let mut points: Vec<[f64; 2]> = Vec::new();
        for ShownMesh { nodes, bounds } in meshes {
            points.push([nodes as f64, bounds.unwrap().error[1]].map(libm::log));
        }
        let last = points[points.len() - 1][0];
        points.retain(|[nodes, _]| *nodes > last - libm::log(30.0));
        let order = -slope(&points);
        assert!(order > 0.49, "{}: {order}", problem.name);
    }
}

#[test]
fn meshes_grow_fast_until_the_bounds_tell_how_much_is_left() {
    let problem = known().into_iter().find(|problem| problem.name == "tiny source").unwrap();
    let (_, meshes) = problem.run(Accuracy::Error(0.2));
    // An error of several solutions; the first mesh knows the load, and of the solution next to nothing.
    let tells = |mesh: &ShownMesh| mesh.bounds.as_ref().unwrap().relative() < 5.0;
    assert!(!tells(&meshes[1]), "the source is too small for the first meshes");
    for pair in meshes.windows(2).filter(|pair| !tells(&pair[0])) {
        assert!(pair[1].nodes > 2 * pair[0].nodes, "{} {}", pair[0].nodes, pair[1].nodes);
    }
}

#[test]
fn parts_of_the_error_sum_up_to_the_bound() {
    let problem = &known()[1];
    let adaption = problem.adaption(Accuracy::Error(0.1));
    let mut meshes = super::meshes::Meshes::new(&adaption, &|_| ()).unwrap();
    for _ in 0..6 {
        meshes.solve(&mut ()).unwrap().unwrap();
        let found = meshes.found.as_ref().unwrap();
        let sum: f64 = found.squares.iter().sum();
        let whole = found.bounds.error[1] * found.bounds.error[1];
        assert!((sum / whole - 1.0).abs() < 1e-9, "{sum} {whole}");
        assert_eq!(meshes.refine().unwrap(), None);
    }
}

#[test]
fn meshes_that_miss_much_of_f_have_no_bound() {
    let f = "formula(2*sin(90001*x)*sin(70003*y)-1)";
    let problem = KnownEnergy { f, ..known().pop().unwrap() };
    let adaption = problem.adaption(Accuracy::Error(0.1));
    let mut meshes = super::meshes::Meshes::new(&adaption, &|_| ()).unwrap();
    let found = meshes.solve(&mut ()).unwrap();
    assert!(matches!(found, Err(NoBound::Missed { .. })), "{found:?}");
}

/// Mesh of the finest level.
fn finest(problem: &Problem) -> AnyMesh {
    problem.levels().mesh(problem.finest()).into_owned()
}

#[test]
fn threads_make_the_same_meshes_to_the_bit() {
    let problem = &known()[0];
    let found = [1, 16].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (run, _) = pool.install(|| problem.run(Accuracy::Error(0.015)));
        (finest(&run.problem), run.pair().y.iter().map(|y| y.to_bits()).collect::<Vec<_>>())
    });
    assert!(found[0] == found[1]);
}

#[test]
fn the_meshes_of_a_run_are_made_anew_from_its_marks() {
    for problem in [&known()[0], &known()[1]] {
        let (run, _) = problem.run(Accuracy::Error(0.05));
        let marks = run.reached.as_ref().and_then(|reached| reached.marks.as_ref()).unwrap();
        let anew = Problem::on_bisected(&problem.mesh, marks, problem.f).unwrap();
        assert!(marks.len() > 4 && anew.count() == run.problem.count());
        assert!(finest(&anew) == finest(&run.problem));
        assert_eq!([anew.load(), run.problem.load()].map(<[f64]>::len), [run.pair().y.len(); 2]);
        assert!(anew.load() == run.problem.load() && anew.lengths() == run.problem.lengths());
    }
}

#[test]
fn uniform_refinements_of_a_strip_are_the_way_where_they_meet_the_goal_with_fewer_nodes() {
    let part = |law| Part { names: Names::from("part"), law, curve: None };
    let data = MeshData {
        points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 2e-4], [0.0, 2e-4]],
        cells: vec![[0, 1, 2], [0, 2, 3]],
        facets: vec![Facet { nodes: [3, 0], part: 0 }],
        parts: vec![part(Law::FREE)],
        ..MeshData::default()
    };
    let mesh = data.mesh().unwrap();
    let goal = Accuracy::Error(0.1);
    let (most_nodes, bisections) = (1 << 20, Adaption::BISECTIONS);
    let adaption = Adaption { coarsest: &mesh, f: "else=-1", goal, most_nodes, bisections };
    let run = adaption.run(&mut (), &|_| ()).unwrap();
    let reached = run.reached.as_ref().unwrap();
    assert_eq!((reached.end, run.pair().y.len()), (ReachEnd::Goal, 65 * 65));
    assert_eq!((reached.kind(), reached.tried), ("uniform", run.ends().len()));
    let marks = reached.marks.as_ref().unwrap();
    assert!(marks.len() == 6 && marks.iter().all(Vec::is_empty));
    let anew = Problem::on_bisected(&mesh, marks, "else=-1").unwrap();
    assert!(finest(&anew) == finest(&run.problem));
    // The bounds are hardly wider than those of the solution to rounding.
    let uniform = Problem::on_mesh(&mesh.into(), 6, "else=-1").unwrap();
    let solved = solve(&uniform, &Settings::of(Solver::Multigrid)).unwrap();
    let ratio = last(&run).error[1] / uniform.bounds(&solved.y).unwrap().error[1];
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn a_run_ends_with_a_number_whatever_happens() {
    let problem = &known()[0];
    let few = Adaption { most_nodes: 300, ..problem.adaption(Accuracy::Error(1e-3)) };
    let run = few.run(&mut (), &|_| ()).unwrap();
    let nodes = run.pair().y.len();
    let end = ReachEnd::Finest { needed: None, best: last(&run).relative() };
    assert_eq!(run.reached.as_ref().unwrap().end, end);
    assert!(nodes <= 300 && last(&run).relative() < 0.3);
    // There are more levels than meshes that are shown.
    let name = run.problem.name(run.problem.finest());
    assert_eq!(name, format!("the mesh of {nodes} nodes"));
    let huge = Adaption { f: "else=-1e200", ..problem.adaption(Accuracy::Error(0.1)) };
    assert!(huge.run(&mut (), &|_| ()).is_err());
    let (energy, _) = problem.run(Accuracy::Energy(0.01));
    assert_eq!(energy.reached.as_ref().unwrap().end, ReachEnd::Goal);
    assert!(last(&energy).relative_energy() <= 0.01);
}

#[test]
fn circles_are_refined_for_what_the_bound_does_not_feel() {
    let mesh = BuiltIn::Disc.plane().unwrap();
    let adaption = Adaption {
        coarsest: &mesh,
        f: "else=-1",
        goal: Accuracy::Error(0.02),
        most_nodes: 1 << 20,
        bisections: Adaption::BISECTIONS,
    };
    let run = adaption.run(&mut (), &|_| ()).unwrap();
    // v = (|x|^2 - 1) / 4 is not allowed to be negative on the boundary: it is zero there.
    let energy = -std::f64::consts::PI / 16.0;
    let [low, high] = last(&run).energy;
    let beside = last(&run).curve.unwrap();
    assert!(beside > 0.0 && beside < 0.5 * (high - low), "{beside} {low} {high}");
    assert!(low - beside < energy && energy < high + beside, "{low} {high} {energy}");
}

#[test]
fn the_largest_squares_are_marked_and_ties_go_to_low_numbers() {
    let squares = [1.0, 4.0, f64::NAN, 0.0, 4.0, 1.0, 2.0];
    assert_eq!(largest_parts(&squares, 0.3), [1]);
    assert_eq!(largest_parts(&squares, 0.6), [1, 4]);
    assert_eq!(largest_parts(&squares, 0.9), [0, 1, 4, 6]);
    assert_eq!(largest_parts(&squares, 1.0), [0, 1, 4, 5, 6]);
    assert_eq!(largest_parts(&[0.0, 0.0], 0.5), [0; 0]);
}
