//! Fine, stretched and graded meshes of a user's own, which have no coarser one.

use crate::common::{Dice, gmsh_file};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, Facet, MeshData, Names, Part};
use signorini_mathematics::problem::law::{Law, LawNumber};
use signorini_mathematics::solvers::{Run, Settings, Solver, solve};
use signorini_mathematics::statement::{Boundary, Domain, Fineness, Statement};

/// A number from `least` on, below `most`.
pub(crate) fn count(random: &mut Dice, least: usize, most: usize) -> usize {
    least + random.below((most - least) as u64) as usize
}

/// Way in which the cells of a rectangle are stretched.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Stretch {
    /// All by the same factor.
    Everywhere,
    /// The more, the nearer to the sides in the west and east.
    Layers,
}

/// Rectangle of width 1 with cells of about this aspect, all nodes moved at random by a part of their distances.
pub(crate) struct Rectangle {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) stretch: Stretch,
    pub(crate) aspect: f64,
    pub(crate) moved: f64,
}

impl Rectangle {
    fn random(random: &mut Dice, most_aspect: f64) -> Self {
        let (columns, rows) = (count(random, 8, 45), count(random, 8, 45));
        let stretch = if random.unit() < 0.5 { Stretch::Everywhere } else { Stretch::Layers };
        let aspect = most_aspect.powf(random.unit());
        Self { columns, rows, stretch, aspect, moved: random.between(0.0, 0.25) }
    }

    fn height(&self) -> f64 {
        match self.stretch {
            Stretch::Everywhere => self.rows as f64 / self.columns as f64 / self.aspect,
            Stretch::Layers => 1.0,
        }
    }

    /// Coordinates of the columns: widths that grow by one factor to the middle and fall again.
    fn columns(&self) -> Vec<f64> {
        let growth = match self.stretch {
            Stretch::Everywhere => 1.0,
            Stretch::Layers => self.aspect.powf(2.0 / self.columns as f64),
        };
        let (mut places, mut width) = (vec![0.0], 1.0);
        for k in 0..self.columns {
            places.push(places[k] + width);
            width *= if k < self.columns / 2 { growth } else { 1.0 / growth };
        }
        let length = places[self.columns];
        places.iter().map(|place| place / length).collect()
    }

    /// Mesh; a side is free or fixed with the same probability, the one in the south never.
    pub(crate) fn mesh(&self, random: &mut Dice) -> AnyMesh {
        let xs = self.columns();
        let ys: Vec<f64> =
            (0..=self.rows).map(|j| self.height() * j as f64 / self.rows as f64).collect();
        let (mut points, mut cells, mut facets) = (Vec::new(), Vec::new(), Vec::new());
        for j in 0..=self.rows {
            for i in 0..=self.columns {
                let x = moved(&xs, i, self.moved * random.between(-1.0, 1.0));
                points.push([x, moved(&ys, j, self.moved * random.between(-1.0, 1.0))]);
            }
        }
        let node = |i: usize, j: usize| (j * (self.columns + 1) + i) as u32;
        for j in 0..self.rows {
            for i in 0..self.columns {
                let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
                match random.unit() < 0.5 {
                    true => cells.extend([[a, b, c], [a, c, d]]),
                    false => cells.extend([[a, b, d], [b, c, d]]),
                }
            }
        }
        for i in 0..self.columns {
            facets.push(Facet { nodes: [node(i, 0), node(i + 1, 0)], part: 0 });
            let nodes = [node(i, self.rows), node(i + 1, self.rows)];
            facets.push(Facet { nodes, part: 1 });
        }
        for j in 0..self.rows {
            facets.push(Facet { nodes: [node(0, j), node(0, j + 1)], part: 2 });
            let nodes = [node(self.columns, j), node(self.columns, j + 1)];
            facets.push(Facet { nodes, part: 3 });
        }
        let parts = ["south", "north", "west", "east"].into_iter().map(|name| {
            let law = match random.unit() {
                low if low < 0.15 && name != "south" => Law::FIXED,
                low if low < 0.3 && name != "south" => Law::FREE,
                _ => Law::SIGNORINI,
            };
            Part { names: Names::from(name), law, curve: None }
        });
        let parts = parts.collect();
        let data = MeshData { points, cells, facets, parts, ..MeshData::default() };
        data.mesh().expect("a mesh").into()
    }
}

/// Coordinate moved by a part of the smaller distance to its neighbours, unless it is an end.
fn moved(places: &[f64], k: usize, by: f64) -> f64 {
    if k == 0 || k + 1 == places.len() {
        return places[k];
    }
    places[k] + by * (places[k + 1] - places[k]).min(places[k] - places[k - 1])
}

/// Random problem on a random rectangle; none if the flux cannot balance f.
pub(crate) fn random_problem(random: &mut Dice, most_aspect: f64) -> Option<Problem> {
    let rectangle = Rectangle::random(random, most_aspect);
    random_problem_on(&rectangle, random, 0)
}

/// Random problem on a rectangle that is refined so often; none if the flux cannot balance f.
fn random_problem_on(rectangle: &Rectangle, random: &mut Dice, times: usize) -> Option<Problem> {
    let mesh = rectangle.mesh(random);
    let (x, y) = (random.between(0.2, 0.8), rectangle.height() * random.between(0.2, 0.8));
    let [within, beyond] = [random.between(-9.0, 9.0), random.between(-6.0, 0.0)];
    let f = format!("rect(-9,{x},-9,{y})={within}; else={beyond}");
    let flux = random.between(0.2, 4.0) * rectangle.height().min(1.0);
    let law = match count(random, 0, 3) {
        0 => Law::SIGNORINI,
        1 => Law::new(0.0, flux).unwrap(),
        _ => Law::new(-flux, flux).unwrap(),
    };
    Problem::on_mesh(&mesh.clone().with_law(law), times, &f).ok()
}

fn run(problem: &Problem, solver: Solver) -> Run {
    solve(problem, &Settings::of(solver)).expect("a run")
}

#[test]
fn stretched_meshes_are_solved_to_rounding_errors_under_any_law() {
    let mut random = Dice(0x9e37_79b9_7f4a_7c15);
    let (mut solved, mut most) = (0, 0);
    while solved < 120 {
        let Some(problem) = random_problem(&mut random, 30.0) else { continue };
        let run = run(&problem, Solver::Multigrid);
        let end = &run.last().end;
        assert!(matches!(end.stop, Stop::RoundingFloor | Stop::Converged), "{end:?}");
        assert!(run.judgement.kkt.relative < 1e-8, "{:?}", run.judgement.kkt);
        most = most.max(end.iterations);
        solved += 1;
    }
    assert!(most <= 200, "{most} steps");
}

#[test]
fn stretched_meshes_have_the_energy_of_the_active_set_method() {
    let mut random = Dice(0x2545_f491_4f6c_dd1d);
    let mut compared = 0;
    while compared < 25 {
        let Some(problem) = random_problem(&mut random, 300.0) else { continue };
        let [one, two] = [Solver::Multigrid, Solver::ActiveSet].map(|solver| run(&problem, solver));
        let [one, two] = [one, two].map(|run| run.judgement.energy);
        assert!((one - two).abs() <= 1e-9 * two.abs(), "{one} {two}");
        compared += 1;
    }
}

#[test]
fn an_unrefined_mesh_is_solved_in_few_steps() {
    let graded =
        Rectangle { columns: 120, rows: 90, stretch: Stretch::Layers, aspect: 1000.0, moved: 0.0 };
    let mesh = graded.mesh(&mut Dice(7));
    let f = "rect(-9,0.5,-9,0.5)=-6; else=1";
    let problem = Problem::on_mesh(&mesh, 0, f).unwrap();
    let run = run(&problem, Solver::Multigrid);
    assert_eq!(run.last().end.stop, Stop::RoundingFloor);
    assert!(run.last().end.iterations <= 25, "{} steps", run.last().end.iterations);
}

/// Runs multigrid, which must end with a solution by itself; returns its number of steps.
fn steps(problem: &Problem) -> usize {
    let run = run(problem, Solver::Multigrid);
    let end = &run.last().end;
    assert_eq!(run.solver, Solver::Multigrid, "{end:?}");
    assert!(matches!(end.stop, Stop::RoundingFloor | Stop::Converged), "{end:?}");
    end.iterations
}

#[test]
fn refined_stretched_meshes_are_solved_by_aggregates() {
    let mut random = Dice(0x853c_49e6_748f_ea9b);
    let mut solved = 0;
    while solved < 24 {
        let aspect = 1000f64.powf(random.unit());
        let [columns, rows] = [0; 2].map(|_| count(&mut random, 4, 12));
        let stretch = Stretch::Everywhere;
        let rectangle = Rectangle { columns, rows, stretch, aspect, moved: 0.0 };
        let Some(problem) = random_problem_on(&rectangle, &mut random, 3) else { continue };
        let most = if problem.is_signorini() { 60 } else { 150 };
        let steps = steps(&problem);
        assert!(steps <= most, "{steps} steps at aspect {aspect}");
        solved += 1;
    }
}

#[test]
fn refined_sheared_cells_are_solved_at_least_by_factors() {
    let mut random = Dice(0xd1b5_4a32_d192_ed03);
    let mut solved = 0;
    while solved < 24 {
        let aspect = 1000f64.powf(random.unit());
        let [columns, rows] = [0; 2].map(|_| count(&mut random, 4, 12));
        let (moved, stretch) = (random.between(0.0, 0.1), Stretch::Everywhere);
        let rectangle = Rectangle { columns, rows, stretch, aspect, moved };
        let Some(problem) = random_problem_on(&rectangle, &mut random, 3) else { continue };
        let run = run(&problem, Solver::Multigrid);
        let end = &run.last().end;
        assert!(matches!(end.stop, Stop::RoundingFloor | Stop::Converged), "{end:?}");
        assert!(run.judgement.kkt.relative < 1e-5, "{:?}", run.judgement.kkt);
        solved += 1;
    }
}

/// Corners of Kuhn's six tetrahedra of a cuboid, from its first corner to the last along the axes in each order, in the
/// order of nodes of the program's own cube, by which refinement divides cells.
pub(crate) fn tetrahedra(first: [usize; 3]) -> [[[usize; 3]; 4]; 6] {
    [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]].map(|axes| {
        let mut corners = [first; 4];
        for (k, axis) in axes.into_iter().enumerate() {
            corners[k + 1] = corners[k];
            corners[k + 1][axis] += 1;
        }
        if (axes[0] + 1) % 3 != axes[1] {
            corners.swap(1, 3);
        }
        corners
    })
}

/// All triples of numbers below these, the first the fastest.
pub(crate) fn positions([x, y, z]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..x * y * z).map(move |k| [k % x, k / x % y, k / x / y])
}

/// Mesh of a plate 1 x 1 x `height`, with so many cuboids along each side.
fn plate(along: usize, height: f64) -> AnyMesh {
    let side = along + 1;
    let scale = [1.0, 1.0, height].map(|size| size / along as f64);
    let point = |at: [usize; 3]| std::array::from_fn(|d| scale[d] * at[d] as f64);
    let node = |at: [usize; 3]| (at[0] + side * (at[1] + side * at[2])) as u32;
    let points = positions([side; 3]).map(point).collect();
    let cells = positions([along; 3]).flat_map(tetrahedra).map(|cell| cell.map(node)).collect();
    let data = MeshData { points, cells, ..MeshData::default() };
    data.mesh().expect("a mesh").into()
}

#[test]
fn refined_plates_are_solved_by_aggregates() {
    let friction = Law::new(-0.003, 0.003).unwrap();
    for height in [0.1, 0.01, 0.002] {
        for (law, most) in [(Law::SIGNORINI, 60), (friction, 150)] {
            let problem = Problem::on_mesh(&plate(4, height).with_law(law), 2, "formula(3*x-2)");
            let Ok(problem) = problem else { continue };
            let steps = steps(&problem);
            assert!(steps <= most, "{steps} steps at height {height}");
        }
    }
}

#[test]
fn an_accuracy_takes_no_more_nodes_than_uniform_refinement() {
    const WANTED: f64 = 0.1;
    let papers = (Boundary::default(), "halfplane(1,0,0.4)=3; else=-4");
    let friction = (Boundary::under(LawNumber::Friction, 4.0), "disc(0.7,0,0.2)=-6; else=1");
    for (height, (boundary, f)) in
        [(0.1, &papers), (0.01, &papers), (1e-4, &papers), (0.2, &friction), (0.02, &friction)]
    {
        let nodes = format!("1 0 0 0\n2 1 0 0\n3 1 {height} 0\n4 0 {height} 0");
        let file = gmsh_file(&nodes, "1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4");
        let solved = |fineness: Fineness| {
            let usual = Statement::usual(Domain::named("long.msh"), *f);
            let boundary = boundary.clone();
            let solved = Statement { boundary, fineness, ..usual }.solved(Some(file.as_bytes()));
            let solved = solved.expect("a solution");
            let bounds = solved.bounds().last().cloned().expect("bounds").expect("bounds");
            (solved.problem.lengths()[0], bounds.relative(), solved)
        };
        let (nodes, error, adapted) = solved(Fineness::Within(Accuracy::Error(WANTED)));
        assert!(error <= WANTED, "{error} at height {height}");
        assert!(adapted.ends().iter().all(|end| end.end.has_converged()), "{:?}", adapted.ends());
        assert!(adapted.ends().iter().all(|end| end.kkt.relative <= 0.02), "{:?}", adapted.ends());
        let uniform = (0..=8).map(|times| solved(Fineness::Refined(times)));
        let enough =
            uniform.map(|(nodes, error, _)| (nodes, error)).find(|found| found.1 <= WANTED);
        let most = enough.map_or(usize::MAX, |(nodes, _)| nodes);
        assert!(nodes <= most, "{nodes} nodes, uniformly {most}, at height {height}");
    }
}
