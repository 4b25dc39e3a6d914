//! Problems on triangulations: unlike solvers, and guaranteed brackets.

use crate::common::{Dice, mesh};
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{self, Pair, Params, StopRule};
use signorini_mathematics::solvers::{Run, Settings, Solver, solve};

fn solved(problem: &Problem, solver: Solver) -> Run {
    solve(problem, &Settings::of(solver)).unwrap()
}

/// f that is constant on the quarters or eighths of space, with a negative integral over each domain of the tests.
fn random_f(dice: &mut Dice, dimension: u8) -> String {
    let mut number = |size: f64| size * (2.0 * dice.unit() - 1.0);
    let [a, b, c] = [number(3.0), number(3.0), number(3.0)];
    let shift = number(1.0).abs() + 6.5;
    if dimension == 2 {
        format!("rect(-2,0,-2,0)={a}; rect(0,2,0,2)={b}; halfplane(1,0,-0.3)={c}; else=-{shift}")
    } else {
        format!("box(-2,0,-2,0,-2,0)={a}; box(0,2,0,2,-2,2)={b}; else=-{shift}")
    }
}

/// Laws of the parts by chance, but a boundary that is free everywhere.
fn random_laws(dice: &mut Dice, mesh: &mut AnyMesh) {
    let names: Vec<String> = match mesh {
        AnyMesh::Plane(mesh) => mesh.parts().iter().map(|part| part.names.to_string()).collect(),
        AnyMesh::Space(mesh) => mesh.parts().iter().map(|part| part.names.to_string()).collect(),
    };
    for (k, name) in names.iter().enumerate() {
        let law = match (dice.unit() * 6.0) as u8 {
            0 => Law::FIXED,
            1 if k > 0 => Law::FREE,
            2 => Law::friction(0.8).unwrap(),
            3 => Law::limited(3.0).unwrap(),
            _ => Law::SIGNORINI,
        };
        mesh.set_law(name, law).unwrap();
    }
}

const MESHES: [&str; 6] = ["disc", "lshape", "annulus", "gear", "ball", "notch"];

#[test]
fn two_unlike_solvers_agree_and_every_bracket_holds() {
    let mut dice = Dice(40);
    for case in 0..240 {
        let mut mesh = mesh(MESHES[case % MESHES.len()]);
        random_laws(&mut dice, &mut mesh);
        let f = random_f(&mut dice, mesh.dimension());
        let times = if mesh.nodes() < 100 { 2 } else { 1 };
        let Ok(problem) = Problem::on_mesh(&mesh, times, &f) else { continue };
        let run = solved(&problem, Solver::Multigrid);
        let name = format!("case {case}: {f}");
        assert_eq!(run.last().end.stop, Stop::RoundingFloor, "{name}");
        let (y, judged) = (run.y, run.judgement);
        assert!(judged.kkt.relative < 1e-9, "{name}: {:?}", judged.kkt);
        if case % 4 == 0 {
            let direct = solved(&problem, Solver::ActiveSet).y;
            let largest = y.iter().fold(1.0f64, |most, y| most.max(y.abs()));
            let apart = y.iter().zip(&direct).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(apart < 1e-9 * largest, "{name}: {apart:e}");
        }
        // The energy of the problem on the polygon lies in the brackets of a solution and of any other vector.
        let of_solution = problem.bounds(&y).unwrap().energy;
        let wrong: Vec<f64> = y.iter().map(|y| y + 0.1 * (dice.unit() - 0.5)).collect();
        let of_other = problem.bounds(&wrong).unwrap().energy;
        // Where v changes its sign along a facet, the friction of its nodes is more than that of the facet.
        let has_signs = problem.levels().laws().iter().any(|(_, law)| law.is_bounded());
        assert!(of_solution[0] <= judged.energy, "{name}");
        assert!(judged.energy <= of_solution[1] || has_signs, "{name}");
        assert!(of_other[0] <= of_solution[1] && of_solution[0] <= of_other[1], "{name}");
    }
}

#[test]
fn the_papers_method_on_the_cube_ends_at_the_solution() {
    let f = "box(-0.5,0,-0.5,0,-0.5,0)=3; else=-1";
    let problem = Problem::on_mesh(&mesh("cube"), 3, f).unwrap();
    let y = solved(&problem, Solver::Multigrid).y;
    let network = &problem.networks().unwrap()[problem.finest()].network;
    let params =
        Params { r: 10.0, tolerance: 1e-12, rule: StopRule::PrintedDual, ..Params::default() };
    let mut pair = Pair::zero(network);
    let run = saddle::solve(network, problem.load(), &params, &mut pair);
    assert_eq!(run.end.stop, Stop::Converged);
    let apart = y.iter().zip(&pair.y).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(apart < 1e-8, "{apart:e}");
}
