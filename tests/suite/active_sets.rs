//! The active set method on stretched cells, whose matrices are no M-matrices: it ends by itself at the solution.

use crate::common::Dice;
use crate::stretched::{Rectangle, Stretch, count, positions, random_problem, tetrahedra};
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, Facet, MeshData, Names, Part};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::solvers::{Settings, Solver, solve};

/// Cuboids along each side of a block, of six tetrahedra each (Kuhn).
struct Block {
    counts: [usize; 3],
    height: f64,
    /// Part of their distances by which inner coordinates are moved at random.
    moved: f64,
}

impl Block {
    fn random(random: &mut Dice, most_aspect: f64) -> Self {
        let counts = [count(random, 1, 7), count(random, 1, 7), count(random, 1, 5)];
        let height = counts[2] as f64 / counts[0] as f64 / most_aspect.powf(random.unit());
        Self { counts, height, moved: random.between(0.0, 0.25) }
    }

    fn node(&self, at: [usize; 3]) -> u32 {
        (at[0] + (self.counts[0] + 1) * (at[1] + (self.counts[1] + 1) * at[2])) as u32
    }

    fn points(&self, random: &mut Dice) -> Vec<[f64; 3]> {
        let size = [1.0, 1.0, self.height];
        let mut points = Vec::new();
        let sides = self.counts.map(|count| count + 1);
        for at in positions(sides) {
            points.push(std::array::from_fn(|d| {
                let is_inner = at[d] > 0 && at[d] < self.counts[d];
                let by = if is_inner { self.moved * random.between(-1.0, 1.0) } else { 0.0 };
                size[d] * (at[d] as f64 + by) / self.counts[d] as f64
            }));
        }
        points
    }

    /// Mesh with a part for each side; a side is free or fixed at random, the one below never.
    fn mesh(&self, random: &mut Dice) -> AnyMesh {
        let points = self.points(random);
        let (mut cells, mut facets) = (Vec::new(), Vec::new());
        for first in positions(self.counts) {
            for corners in tetrahedra(first) {
                cells.push(corners.map(|at| self.node(at)));
                for (part, (d, place)) in
                    (0..3).flat_map(|d| [(d, 0), (d, self.counts[d])]).enumerate()
                {
                    let on_side = corners.iter().filter(|at| at[d] == place);
                    let nodes: Vec<u32> = on_side.map(|at| self.node(*at)).collect();
                    if let Ok(nodes) = nodes.try_into() {
                        facets.push(Facet { nodes, part: part as u16 });
                    }
                }
            }
        }
        let parts = ["west", "east", "south", "north", "below", "above"].map(|name| {
            let law = match random.unit() {
                low if low < 0.15 && name != "below" => Law::FIXED,
                low if low < 0.35 && name != "below" => Law::FREE,
                _ => Law::SIGNORINI,
            };
            Part { names: Names::from(name), law, curve: None }
        });
        let data = MeshData { points, cells, facets, parts: parts.into(), ..MeshData::default() };
        data.mesh().expect("a mesh").into()
    }
}

/// Random problem on a random block; none if the flux cannot balance f.
fn block_problem(random: &mut Dice, most_aspect: f64) -> Option<Problem> {
    let block = Block::random(random, most_aspect);
    let mesh = block.mesh(random);
    let f = format!("formula({}*x-{})", random.between(1.0, 6.0), random.between(0.0, 4.0));
    let flux = random.between(0.2, 4.0) * block.height.min(1.0);
    let law = match count(random, 0, 3) {
        0 => Law::SIGNORINI,
        1 => Law::new(0.0, flux).unwrap(),
        _ => Law::new(-flux, flux).unwrap(),
    };
    Problem::on_mesh(&mesh.clone().with_law(law), 0, &f).ok()
}

/// Checks that the active set method ends by itself with the energy of multigrid. Energies are convex: theirs differ by
/// no more than the larger residual times the sum of all differences of values, and the rounding errors of the energy:
/// each value times those of its row, whose entries are no larger than the largest one on the diagonal.
fn is_solved(problem: &Problem) {
    let [one, two] = [Solver::ActiveSet, Solver::Multigrid].map(|solver| {
        let run = solve(problem, &Settings::of(solver)).expect("a run");
        let stop = run.last().end.stop;
        assert!(matches!(stop, Stop::Converged | Stop::RoundingFloor), "{solver:?} {stop}");
        run
    });
    let between: f64 = one.y.iter().zip(&two.y).map(|(one, two)| (one - two).abs()).sum();
    let residual = one.judgement.kkt.natural.max(two.judgement.kkt.natural);
    let network = &problem.networks().expect("a mesh")[0].network;
    let entry = network.diagonal().iter().copied().fold(0.0, f64::max);
    let largest = two.y.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let all: f64 = two.y.iter().map(|value| value.abs()).sum();
    let rounding = f64::EPSILON * network.row_length().powi(2) * entry * largest * all;
    let [at_one, at_two] = [&one, &two].map(|run| run.judgement.energy);
    let bound = residual * between + rounding;
    assert!((at_one - at_two).abs() <= bound, "{at_one} {at_two} {bound}");
}

#[test]
fn strips_whose_contact_the_primal_dual_steps_move_by_a_node_each_are_solved() {
    for (columns, moved) in [(500, 0.0), (500, 0.2), (300, 0.1)] {
        let aspect = 1.0 / columns as f64;
        let strip = Rectangle { columns, rows: 1, stretch: Stretch::Everywhere, aspect, moved };
        for (law, f) in [
            (Law::SIGNORINI, "rect(0,0.3,-9,9)=3; else=-2"),
            (Law::new(0.0, 1.5).unwrap(), "rect(0.2,0.3,-9,9)=9; rect(0.7,0.75,-9,9)=13; else=-2"),
        ] {
            let mesh = strip.mesh(&mut Dice(3));
            is_solved(&Problem::on_mesh(&mesh.clone().with_law(law), 0, f).unwrap());
        }
    }
}

#[test]
fn cells_of_any_aspect_are_solved_in_the_plane_and_in_space() {
    let mut random = Dice(0xa076_1d64_78bd_642f);
    let mut solved = 0;
    while solved < 40 {
        let problem = match solved % 2 {
            0 => block_problem(&mut random, 1e6),
            _ => random_problem(&mut random, 1e6),
        };
        let Some(problem) = problem else { continue };
        is_solved(&problem);
        solved += 1;
    }
}
