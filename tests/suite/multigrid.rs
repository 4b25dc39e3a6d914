//! Solvers of optimal cost: accuracy, agreement, cost in work units, robustness.

use crate::common::{Dice, paper_problems, random_source};
use crate::domains::{self, SquareGrid};
use crate::edits::number;
use crate::hard_loads::stress_loads;
use crate::solvers::{ALGEBRAIC, HARD_WORK_UNITS, TEXTBOOK, WORK_UNITS, distance_in_h1};
use rayon::prelude::*;
use signorini_mathematics::discrete::end::{End, Stop};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::discrete::norms::Errors;
use signorini_mathematics::multigrid::{Goal, InputError, MultigridParams};
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::{Source, Tie};
use signorini_mathematics::square::errors::{errors, multiplier_error};
use signorini_mathematics::square::load::load;
use signorini_mathematics::square::multigrid::{Multigrid, solve_square};

fn grid(n: usize) -> Grid {
    Grid::new(n).unwrap()
}

fn exact_load(problem: Exact, n: usize) -> Vec<f64> {
    load(grid(n), &Source::from(problem), LoadRule::Nodal { tie: Tie::LowerLeft, diagonal: None })
}

fn exact_values(problem: Exact, n: usize) -> Vec<f64> {
    let grid = grid(n);
    let at = |k: usize| problem.at(grid.coordinate(k % (n + 1)), grid.coordinate(k / (n + 1)));
    (0..grid.nodes()).map(|k| at(k).value).collect()
}

pub(crate) fn natural_residual(n: usize, y: &[f64], load: &[f64]) -> f64 {
    judge((grid(n), Law::SIGNORINI), y, load).kkt.natural
}

/// Loads of the problems with a formula for the solution, by name.
pub(crate) fn exact_loads(n: usize) -> Vec<(&'static str, Vec<f64>)> {
    Exact::ALL.map(|problem| (problem.name(), exact_load(problem, n))).into()
}

fn run(n: usize, load: &[f64], goal: Goal) -> (Vec<f64>, End) {
    domains::run(&SquareGrid(n), load, goal)
}

#[test]
fn errors_fall_at_the_optimal_rate() {
    for problem in Exact::ALL {
        let errors = [32, 64, 128, 256].map(|n| {
            let load = exact_load(problem, n);
            let (grid, y) = (grid(n), run(n, &load, Goal::RoundingFloor).0);
            let multiplier = |point, normal| problem.multiplier(point, normal);
            let Errors { l2, h1, .. } = errors(grid, problem, &y);
            [l2, h1, multiplier_error(grid, &y, &load, multiplier)]
        });
        for pair in errors.windows(2) {
            let [l2, h1, multiplier] = [0, 1, 2].map(|norm| (pair[0][norm] / pair[1][norm]).log2());
            assert!((l2 - 2.0).abs() < 0.1, "{problem:?} L2 {l2}");
            assert!((h1 - 1.0).abs() < 0.05, "{problem:?} H1 {h1}");
            assert!(multiplier > 1.0, "{problem:?} multiplier {multiplier}");
        }
    }
}

#[test]
fn one_cycle_reaches_the_discretisation_error() {
    for problem in Exact::ALL {
        for n in [32, 64, 256] {
            let load = exact_load(problem, n);
            let (exact_discrete, _) = run(n, &load, Goal::RoundingFloor);
            let (y, outcome) = run(n, &load, Goal::DiscretisationError);
            assert_eq!((outcome.stop, outcome.iterations), (Stop::Converged, 1));
            if n >= 64 {
                assert!(outcome.work_units < TEXTBOOK, "{problem:?} {n} {outcome:?}");
            }
            let values = exact_values(problem, n);
            let norm = |a: &[f64], b: &[f64]| -> f64 {
                a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            };
            let ratio = norm(&y, &exact_discrete) / norm(&exact_discrete, &values);
            assert!(ratio < 0.25, "{problem:?} {n} algebraic over discretisation error {ratio}");
            let algebraic = distance_in_h1(grid(n), &y, &exact_discrete);
            assert!(algebraic < ALGEBRAIC * errors(grid(n), problem, &y).h1, "{problem:?} {n} H1");
        }
    }
}

/// Algebraic over discretisation error in the energy norm where multigrid stops for the latter, on the grid with `n`
/// cells per side, and the cycles that it took.
fn at_the_discretisation_error(n: usize, f: &Source) -> (f64, usize) {
    let exactly = LoadRule::Exact { diagonal: Diagonal::default() };
    let solved = |n: usize, goal| {
        let load = load(grid(n), f, exactly);
        let (y, outcome) = run(n, &load, goal);
        let energy = judge((grid(n), Law::SIGNORINI), &y, &load).energy;
        (y, outcome, energy)
    };
    let (y, outcome, _) = solved(n, Goal::DiscretisationError);
    let (discrete, _, coarse) = solved(n, Goal::RoundingFloor);
    // Energies fall like the square of h: on a grid of a quarter of the width the excess is a sixteenth.
    let excess = 16.0 / 15.0 * (coarse - solved(4 * n, Goal::RoundingFloor).2);
    (distance_in_h1(grid(n), &y, &discrete) / (2.0 * excess).sqrt(), outcome.iterations)
}

/// The largest of these ratios over random problems, and the number of those that one cycle was enough for.
fn of_random_problems(n: usize, problems: usize) -> (f64, usize) {
    let mut dice = Dice(n as u64);
    let sources: Vec<Source> = (0..problems).map(|_| random_source(&mut dice)).collect();
    let trials: Vec<_> = sources.par_iter().map(|f| at_the_discretisation_error(n, f)).collect();
    let worst = trials.iter().map(|trial| trial.0).fold(0.0, f64::max);
    (worst, trials.iter().filter(|trial| trial.1 == 1).count())
}

/// One cycle leaves an eighth of the discretisation error and more, though the natural residual is below a
/// twentieth of the largest load.
#[test]
fn narrow_peaks_get_a_second_cycle() {
    for f in [
        "rect(0.042,0.317,-0.5,-0.41)=-22.022; else=0.4868",
        "disc(0.388,-0.572,0.144)=-65.4654; disc(0.159,-0.576,0.086)=3.9305; else=0.5098",
        "disc(0.201,0.427,0.12)=-9.3861; rect(-0.5,-0.133,0.14,0.166)=-3.8701; else=0.3489",
    ] {
        let (ratio, cycles) = at_the_discretisation_error(16, &f.parse().unwrap());
        assert!(ratio < ALGEBRAIC && cycles == 2, "{f}: {ratio} after {cycles}");
    }
}

/// `SIGNORINI_PROBLEMS` is the number of problems on each grid, 200 without it.
#[test]
fn the_residual_tells_whether_one_cycle_is_enough() {
    let problems = number("SIGNORINI_PROBLEMS", 200) as usize;
    for n in [8, 16, 32] {
        let (worst, at_once) = of_random_problems(n, problems);
        assert!(worst < ALGEBRAIC, "1/{n}: {worst}");
        // On coarse grids it tells both.
        let is_both = at_once < problems || n > 8;
        assert!(10 * at_once > 9 * problems && is_both, "1/{n}: {at_once}");
    }
}

#[test]
fn work_does_not_depend_on_the_grid() {
    let goals = [Goal::DiscretisationError, Goal::Kkt(1e-10), Goal::RoundingFloor];
    let problems = paper_problems();
    for n in [64, 128, 256, 512] {
        // With the load of the tables problem 1 has no solution.
        let rules = [LoadRule::Bilinear {}, LoadRule::default()];
        let paper = problems.iter().zip(rules);
        let paper =
            paper.map(|((name, f), rule)| (&name[..], load(grid(n), &f.parse().unwrap(), rule)));
        let usual = exact_loads(n).into_iter().chain(paper).map(|load| (load, WORK_UNITS));
        let hard = stress_loads(n).into_iter().map(|load| (load, HARD_WORK_UNITS));
        for ((name, load), limits) in usual.chain(hard) {
            for (goal, limit) in goals.into_iter().zip(limits) {
                let outcome = run(n, &load, goal).1;
                assert!(outcome.work_units < limit, "{name} {n} {goal:?} {outcome:?}");
                let stop = match goal {
                    Goal::RoundingFloor => Stop::RoundingFloor,
                    _ => Stop::Converged,
                };
                assert_eq!(outcome.stop, stop, "{name} {n} {goal:?}");
            }
        }
    }
}

#[test]
fn impossible_grids_are_refused() {
    for wrong in [0, 1, 9, 11] {
        let load = vec![-1.0; (wrong + 1_usize).pow(2)];
        let refusal = solve_square(wrong, Law::SIGNORINI, &load, &MultigridParams::default());
        let names_it = matches!(refusal, Err(InputError::GridSize { cells, .. }) if cells == wrong);
        assert!(names_it, "{wrong}");
    }
}

#[test]
fn the_workspace_can_be_used_again() {
    let n = 512;
    let mut workspace = Multigrid::square(n).expect("valid size");
    let mut solve = |problem: Exact| {
        let load = exact_load(problem, n);
        workspace.solve(Law::SIGNORINI, &load, &MultigridParams::default()).expect("valid load");
        let mut y = vec![0.0; load.len()];
        workspace.write_solution(&mut y);
        y
    };
    let first = solve(Exact::FreeCorner);
    solve(Exact::FullContact);
    assert!(first == solve(Exact::FreeCorner));
}

#[test]
#[should_panic(expected = "one number for each node")]
fn a_short_slice_does_not_hold_the_solution() {
    let mut workspace = Multigrid::square(16).expect("valid size");
    workspace.solve(Law::SIGNORINI, &[-1.0; 289], &MultigridParams::default()).expect("valid load");
    workspace.write_solution(&mut [0.0; 272]);
}
