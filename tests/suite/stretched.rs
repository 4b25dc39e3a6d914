//! Fine, stretched and graded meshes of a user's own, which have no coarser one.

use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, Condition, Facet, MeshData, Names, Part};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::solvers::{Run, Settings, Solver, solve};

/// Pseudo-random numbers in [0, 1), the same ones on every machine (G. Marsaglia, J. Stat. Software 8 (2003) 14).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }

    fn count(&mut self, least: usize, most: usize) -> usize {
        least + (self.next() * (most - least) as f64) as usize
    }
}

/// Way in which the cells of a rectangle are stretched.
#[derive(Clone, Copy, PartialEq)]
enum Stretch {
    /// All by the same factor.
    Everywhere,
    /// The more, the nearer to the sides in the west and east.
    Layers,
}

/// Rectangle of width 1 with cells of about this aspect, all nodes moved at random by a part of their distances.
struct Rectangle {
    columns: usize,
    rows: usize,
    stretch: Stretch,
    aspect: f64,
    moved: f64,
}

impl Rectangle {
    fn random(random: &mut Random, most_aspect: f64) -> Self {
        let (columns, rows) = (random.count(8, 45), random.count(8, 45));
        let stretch = if random.next() < 0.5 { Stretch::Everywhere } else { Stretch::Layers };
        let aspect = most_aspect.powf(random.next());
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
    fn mesh(&self, random: &mut Random) -> AnyMesh {
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
                match random.next() < 0.5 {
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
            let condition = match random.next() {
                low if low < 0.15 && name != "south" => Condition::Fixed,
                low if low < 0.3 && name != "south" => Condition::Free,
                _ => Condition::Contact,
            };
            Part { names: Names::from(name), condition, curve: None }
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
fn random_problem(random: &mut Random, most_aspect: f64) -> Option<Problem> {
    let rectangle = Rectangle::random(random, most_aspect);
    let mesh = rectangle.mesh(random);
    let (x, y) = (random.between(0.2, 0.8), rectangle.height() * random.between(0.2, 0.8));
    let [within, beyond] = [random.between(-9.0, 9.0), random.between(-6.0, 0.0)];
    let f = format!("rect(-9,{x},-9,{y})={within}; else={beyond}");
    let flux = random.between(0.2, 4.0) * rectangle.height().min(1.0);
    let law = match random.count(0, 3) {
        0 => Law::SIGNORINI,
        1 => Law::new(0.0, flux).unwrap(),
        _ => Law::new(-flux, flux).unwrap(),
    };
    Problem::on_mesh(&mesh, 0, &f, law).ok()
}

fn run(problem: &Problem, solver: Solver) -> Run {
    solve(problem, &Settings::of(solver)).expect("a run")
}

#[test]
fn stretched_meshes_are_solved_to_rounding_errors_under_any_law() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
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
    let mut random = Random(0x2545_f491_4f6c_dd1d);
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
    let mesh = graded.mesh(&mut Random(7));
    let f = "rect(-9,0.5,-9,0.5)=-6; else=1";
    let problem = Problem::on_mesh(&mesh, 0, f, Law::SIGNORINI).unwrap();
    let run = run(&problem, Solver::Multigrid);
    assert_eq!(run.last().end.stop, Stop::RoundingFloor);
    assert!(run.last().end.iterations <= 25, "{} steps", run.last().end.iterations);
}
