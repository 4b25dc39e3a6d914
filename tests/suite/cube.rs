//! The cube as a mesh: accuracy, agreement of unlike solvers, cost in work units, and the seven-point matrix.

use crate::common::Dice;
use crate::domains::{CubeMesh, Domain, rough, run};
use crate::laws::under;
use crate::solvers::{ALGEBRAIC, NETWORK_WORK_UNITS};
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::discrete::norms::Errors;
use signorini_mathematics::mesh::mesh_errors;
use signorini_mathematics::multigrid::active_set::active_set;
use signorini_mathematics::multigrid::{Goal, MultigridParams};
use signorini_mathematics::multilevel::solve_nested_networks;
use signorini_mathematics::problem::exact::CubeExact;
use signorini_mathematics::problem::law::Law;

fn errors(cube: &CubeMesh, problem: CubeExact, y: &[f64]) -> Errors {
    mesh_errors(&cube.mesh, |point| problem.at(point), y)
}

#[test]
fn a_few_cycles_reach_the_discretisation_error() {
    for cube in [3, 4].map(|times| CubeMesh::new(1, times)) {
        let n = cube.cells_per_side();
        for (problem, (_, load)) in CubeExact::ALL.into_iter().zip(cube.exact_loads()) {
            let (exact_discrete, _) = run(&cube, &load, Goal::RoundingFloor);
            let (y, outcome) = run(&cube, &load, Goal::DiscretisationError);
            assert_eq!(outcome.stop, Stop::Converged);
            assert!(outcome.iterations <= 2, "{problem:?} {n} {outcome:?}");
            assert!(outcome.work_units < NETWORK_WORK_UNITS[0], "{problem:?} {n} {outcome:?}");
            let discretisation = errors(&cube, problem, &exact_discrete);
            let algebraic: Vec<_> = y.iter().zip(&exact_discrete).map(|(a, b)| a - b).collect();
            let squares =
                algebraic.iter().zip(cube.network().masses()).map(|(e, mass)| mass * e * e);
            let l2 = squares.sum::<f64>().sqrt() / discretisation.l2;
            // For zero load, the energy is half the square of the H1 seminorm.
            let energy = cube.network().energy(&algebraic, &vec![0.0; y.len()]);
            let h1 = (2.0 * energy).sqrt() / discretisation.h1;
            assert!(l2 < 0.25, "{problem:?} {n} {l2}");
            assert!(h1 < ALGEBRAIC, "{problem:?} {n} {h1}");
        }
    }
}

#[test]
fn work_does_not_depend_on_the_mesh() {
    let goals = [Goal::DiscretisationError, Goal::Kkt(1e-10), Goal::RoundingFloor];
    for times in [3, 4, 5] {
        let cube = CubeMesh::new(1, times);
        let loads = cube.exact_loads().into_iter().chain(cube.stress_loads());
        // On the finest mesh some, which takes a few seconds.
        for (name, load) in loads.step_by(if times == 5 { 4 } else { 1 }) {
            for (goal, limit) in goals.into_iter().zip(NETWORK_WORK_UNITS) {
                let goal = match goal {
                    // The loads of one problem are a million times larger.
                    Goal::Kkt(tolerance) if name == "jumps" => Goal::Kkt(1e6 * tolerance),
                    goal => goal,
                };
                let (_, outcome) = run(&cube, &load, goal);
                println!("{name} {times} {goal:?} {:.0}", outcome.work_units);
                assert!(outcome.work_units < limit, "{name} {times} {goal:?} {outcome:?}");
                let floor = goal == Goal::RoundingFloor;
                let expected = if floor { Stop::RoundingFloor } else { Stop::Converged };
                assert_eq!(outcome.stop, expected, "{name} {times} {goal:?}");
            }
        }
    }
}

#[test]
fn no_two_contact_sets_take_turns() {
    let cube = CubeMesh::new(1, 2);
    let mut dice = Dice(7);
    for number in 0..5_000 {
        let amplitudes: Vec<f64> = (0..12).map(|_| 2.0 * dice.unit() - 1.0).collect();
        let (roughness, deficit) = (dice.unit(), 10_f64.powf(-8.0 + 7.7 * dice.unit()));
        let load = cube.nodal_load(Some(deficit), |point| rough(&amplitudes, roughness, point));
        let (_, outcome) = run(&cube, &load, Goal::RoundingFloor);
        assert_eq!(outcome.stop, Stop::RoundingFloor, "{number}: {outcome:?}");
    }
}

/// The seven-point matrix on the nodes of a cube with `n` cells per side, x fastest: neighbours are coupled by h
/// inside, by h / 2 on a face and, since two or one of the six tetrahedra of a cell have an edge of the cube, by h / 3
/// or h / 6 there.
struct SevenPoints {
    n: usize,
    /// Neighbours of each node, with their couplings.
    rows: Vec<Vec<(usize, f64)>>,
    /// Area of a third of the boundary triangles at each node.
    areas: Vec<f64>,
}

impl SevenPoints {
    fn new(n: usize) -> Self {
        let (side, h) = (n + 1, 1.0 / n as f64);
        let share = |one: usize, two: usize| match [one, two].map(|i| i % n == 0) {
            [false, false] => 1.0,
            [true, true] if one == two => 1.0 / 3.0,
            [true, true] => 1.0 / 6.0,
            _ => 0.5,
        };
        let steps = [1, side, side * side];
        let mut rows = vec![Vec::new(); side.pow(3)];
        let mut areas = vec![0.0; side.pow(3)];
        for node in 0..rows.len() {
            let at = steps.map(|step| node / step % side);
            for axis in 0..3 {
                let [one, two] = [(axis + 1) % 3, (axis + 2) % 3];
                if at[axis] < n {
                    let (other, weight) = (node + steps[axis], h * share(at[one], at[two]));
                    rows[node].push((other, weight));
                    rows[other].push((node, weight));
                }
                // Each square of the boundary is cut by the diagonal from its lowest to its highest corner.
                if at[axis] % n == 0 && at[one] < n && at[two] < n {
                    let ends = [node, node + steps[one] + steps[two]];
                    ends.into_iter().for_each(|end| areas[end] += h * h / 3.0);
                    let others = [node + steps[one], node + steps[two]];
                    others.into_iter().for_each(|other| areas[other] += h * h / 6.0);
                }
            }
        }
        Self { n, rows, areas }
    }

    /// Number of the node at a point.
    fn node(&self, point: [f64; 3]) -> usize {
        let [i, j, k] = point.map(|x| ((x + 0.5) * self.n as f64).round() as usize);
        i + (self.n + 1) * (j + (self.n + 1) * k)
    }

    /// Minimises the energy over one value after the other, with over-relaxation where the law does not act.
    fn solve(&self, load: &[f64], friction: Option<f64>) -> Vec<f64> {
        let factor = 2.0 / (1.0 + 3.0 / self.n as f64);
        let mut y = vec![0.0; load.len()];
        for _ in 0..5000 {
            let mut change = 0.0_f64;
            for (node, row) in self.rows.iter().enumerate() {
                let diagonal: f64 = row.iter().map(|(_, weight)| weight).sum();
                let sum =
                    load[node] + row.iter().map(|(other, weight)| weight * y[*other]).sum::<f64>();
                let value = match (self.areas[node] > 0.0, friction) {
                    (false, _) => y[node] + factor * (sum / diagonal - y[node]),
                    (true, None) => (sum / diagonal).max(0.0),
                    (true, Some(g)) => {
                        let most = g * self.areas[node];
                        (sum - sum.clamp(-most, most)) / diagonal
                    }
                };
                change = change.max((value - y[node]).abs());
                y[node] = value;
            }
            if change < 1e-17 {
                break;
            }
        }
        y
    }
}

#[test]
fn the_solution_is_that_of_the_seven_point_matrix() {
    for (coarsest, times) in [(1, 3), (3, 1), (5, 0)] {
        let cube = CubeMesh::new(coarsest, times);
        let plain = SevenPoints::new(cube.cells_per_side());
        let places: Vec<_> = cube.mesh.points().iter().map(|&point| plain.node(point)).collect();
        let area: f64 = plain.areas.iter().sum();
        assert!((area - 6.0).abs() < 1e-13, "{area}");
        for (f, friction) in [
            ("box(-0.5,0,-0.5,0,-0.5,0)=3; else=-1", None),
            ("ball(0.1,0.2,-0.1,0.3)=6; else=-1", None),
            ("box(-0.5,0,-0.5,0.5,-0.5,0.5)=3; else=-3.3", Some(0.2)),
            ("halfspace(1,2,1,0)=2; else=-1", Some(0.35)),
        ] {
            let law = friction.map_or(Law::SIGNORINI, |g| Law::friction(g).unwrap());
            let load = cube.load(&f.parse().unwrap());
            let mut plain_load = vec![0.0; load.len()];
            places.iter().zip(&load).for_each(|(&place, load)| plain_load[place] = *load);
            let expected = plain.solve(&plain_load, friction);
            let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let levels = under(&cube.levels, law);
            let params = MultigridParams::default();
            let (y, _) = solve_nested_networks(&levels, &load, &params).unwrap();
            let network = &levels[levels.len() - 1].network;
            let (direct, _) = active_set(network, &load, None).unwrap();
            for y in [y, direct] {
                let far = places.iter().zip(&y).map(|(&place, y)| (y - expected[place]).abs());
                let far = far.fold(0.0, f64::max) / largest;
                assert!(far < 1e-12, "{f} {law} 1/{}: {far:e}", plain.n);
            }
        }
    }
}
