//! Solvers on the cube: accuracy, agreement, cost in work units, robustness.

use crate::common::Dice;
use crate::cube_loads::{exact_load, nodal_load, stress_loads};
use crate::solvers::{absurd_starts, assert_threads_do_not_matter, distance};
use proptest::prelude::*;
use signorini::discrete::cube::{Grid, errors, judge};
use signorini::discrete::norms::Errors;
use signorini::experiments::targets::{ALGEBRAIC, BYTES, HARD, TEXTBOOK, WORK_UNITS};
use signorini::multigrid::active_set::active_set;
use signorini::multigrid::cube::Cube;
use signorini::multigrid::{
    self, Goal, InputError, Multigrid, MultigridOutcome, MultigridParams, MultigridStop,
};
use signorini::problem::cube::Exact;

fn grid(n: usize) -> Grid {
    Grid::new(n).expect("fine enough")
}

fn run(n: usize, load: &[f64], goal: Goal) -> (Vec<f64>, MultigridOutcome) {
    let params = MultigridParams { goal, ..Default::default() };
    multigrid::solve_cube(n, load, None, &params).expect("valid load")
}

fn oracle(n: usize, load: &[f64]) -> Vec<f64> {
    active_set::<Cube>(n, load).expect("valid load").0
}

fn natural_residual(n: usize, y: &[f64], load: &[f64]) -> f64 {
    judge(grid(n), y, load).kkt.natural
}

/// What rounding errors alone leave of the optimality conditions, in units of the load.
fn rounding_level(n: usize, y: &[f64]) -> f64 {
    32.0 * f64::EPSILON * largest(y) / n as f64
}

fn largest(y: &[f64]) -> f64 {
    y.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

fn exact_loads(n: usize) -> Vec<(&'static str, Vec<f64>)> {
    Exact::ALL.map(|problem| (problem.name(), exact_load(problem, n))).into()
}

#[test]
fn errors_fall_at_the_optimal_rate() {
    for problem in Exact::ALL {
        let errors = [16, 32, 64].map(|n| {
            let load = exact_load(problem, n);
            errors(grid(n), problem, &run(n, &load, Goal::RoundingFloor).0)
        });
        for pair in errors.windows(2) {
            let rate = |norm: fn(&Errors) -> f64| (norm(&pair[0]) / norm(&pair[1])).log2();
            assert!((rate(|e| e.l2) - 2.0).abs() < 0.1, "{problem:?} L2 {}", rate(|e| e.l2));
            assert!((rate(|e| e.h1) - 1.0).abs() < 0.05, "{problem:?} H1 {}", rate(|e| e.h1));
            assert!((rate(|e| e.max) - 2.0).abs() < 0.15, "{problem:?} max {}", rate(|e| e.max));
        }
    }
}

#[test]
fn one_cycle_reaches_the_discretisation_error() {
    for problem in Exact::ALL {
        for n in [32, 64] {
            let load = exact_load(problem, n);
            let (exact_discrete, _) = run(n, &load, Goal::RoundingFloor);
            let (y, outcome) = run(n, &load, Goal::DiscretisationError);
            assert_eq!((outcome.stop, outcome.cycles), (MultigridStop::Converged, 1));
            assert!(outcome.work_units < TEXTBOOK, "{problem:?} {n} {outcome:?}");
            let grid = grid(n);
            let discretisation = errors(grid, problem, &exact_discrete);
            let algebraic: Vec<_> = y.iter().zip(&exact_discrete).map(|(a, b)| a - b).collect();
            let squares = algebraic.iter().zip(grid.indices()).map(|(e, i)| grid.share(i) * e * e);
            let l2 = (grid.h().powi(3) * squares.sum::<f64>()).sqrt();
            // For zero load, the energy is half the square of the H1 seminorm.
            let h1 = (2.0 * judge(grid, &algebraic, &vec![0.0; y.len()]).energy).sqrt();
            assert!(l2 < 0.25 * discretisation.l2, "{problem:?} {n} {}", l2 / discretisation.l2);
            assert!(
                h1 < ALGEBRAIC * discretisation.h1,
                "{problem:?} {n} {}",
                h1 / discretisation.h1
            );
        }
    }
}

#[test]
fn multigrid_and_active_set_agree_to_rounding() {
    for n in [2, 4, 6, 12, 16] {
        for (name, load) in exact_loads(n).into_iter().chain(stress_loads(n)) {
            let (y, outcome) = run(n, &load, Goal::RoundingFloor);
            assert_eq!(outcome.stop, MultigridStop::RoundingFloor, "{name} {n} {outcome:?}");
            let oracle = oracle(n, &load);
            // Twice what the solver asks for: the check adds in another order.
            let level = 2.0 * rounding_level(n, &oracle);
            // Values are determined up to the conditioning of the contact set.
            let rounding = 1e3 * f64::EPSILON * largest(&oracle) * n as f64;
            assert!(distance(&y, &oracle) <= rounding, "{name} {n} {}", distance(&y, &oracle));
            for y in [&y, &oracle] {
                let left = natural_residual(n, y, &load);
                assert!(left <= level, "{name} {n} {left:e} {level:e} {outcome:?}");
            }
        }
    }
}

#[test]
fn work_does_not_depend_on_the_grid() {
    for n in [64, 128] {
        let mut workspace = Multigrid::cube(n).expect("valid size");
        let loads = match n {
            64 => exact_loads(n).into_iter().chain(stress_loads(n)).collect(),
            _ => vec![("free-disc", exact_load(Exact::FreeDisc, n))],
        };
        for (name, load) in loads {
            // The loads of one problem are a million times larger.
            let tolerance = 1e-10 * if name == "jumps" { 1e6 } else { 1.0 };
            for (goal, limit) in [
                (Goal::DiscretisationError, HARD * WORK_UNITS[0]),
                (Goal::Kkt(tolerance), HARD * WORK_UNITS[1]),
                (Goal::RoundingFloor, HARD * WORK_UNITS[2]),
            ] {
                let params = MultigridParams { goal, ..Default::default() };
                let outcome = workspace.solve(&load, None, &params).expect("valid load");
                assert!(outcome.work_units < limit, "{name} {n} {goal:?} {outcome:?}");
                let floor = goal == Goal::RoundingFloor;
                let expected =
                    if floor { MultigridStop::RoundingFloor } else { MultigridStop::Converged };
                assert_eq!(outcome.stop, expected, "{name} {n} {goal:?}");
            }
        }
        let bytes = workspace.bytes() as f64 / (n + 1).pow(3) as f64;
        assert!(bytes < BYTES[1], "{n} {bytes}");
    }
}

#[test]
fn a_claimed_tolerance_holds() {
    let n = 32;
    for (name, load) in stress_loads(n) {
        for exponent in (4..20).step_by(3) {
            let tolerance = 10_f64.powi(-exponent);
            let (y, outcome) = run(n, &load, Goal::Kkt(tolerance));
            let measured = natural_residual(n, &y, &load);
            match outcome.stop {
                MultigridStop::Converged => {
                    let slack = 0.25 * rounding_level(n, &y);
                    assert!(measured <= tolerance + slack, "{name} {measured:e} {tolerance:e}");
                }
                MultigridStop::RoundingFloor => {
                    assert!(measured <= 2.0 * rounding_level(n, &y), "{name} {measured:e}");
                }
                stop => panic!("{name} {tolerance:e} {stop:?}"),
            }
        }
    }
}

#[test]
fn solutions_scale_with_the_load() {
    let n = 16;
    let load = exact_load(Exact::FreeDisc, n);
    let (y, plain) = run(n, &load, Goal::RoundingFloor);
    for exponent in [-500, -332, -40, 40, 332, 500] {
        let factor = 2_f64.powi(exponent);
        let scaled: Vec<_> = load.iter().map(|entry| entry * factor).collect();
        let (z, outcome) = run(n, &scaled, Goal::RoundingFloor);
        assert_eq!((outcome.stop, outcome.cycles), (plain.stop, plain.cycles));
        assert!(y.iter().zip(&z).all(|(y, z)| y * factor == *z), "2^{exponent}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let n = 64;
    let load = exact_load(Exact::FreeDisc, n);
    assert_threads_do_not_matter(|| run(n, &load, Goal::RoundingFloor).0);
}

#[test]
fn absurd_starts_lead_to_the_same_solution() {
    let n = 32;
    for problem in Exact::ALL {
        let load = exact_load(problem, n);
        let (y, _) = run(n, &load, Goal::RoundingFloor);
        for (k, start) in absurd_starts(&y).iter().enumerate() {
            let params = MultigridParams::default();
            let (z, outcome) =
                multigrid::solve_cube(n, &load, Some(start), &params).expect("valid");
            assert_eq!(outcome.stop, MultigridStop::RoundingFloor, "{problem:?} {k} {outcome:?}");
            let rounding = 1e3 * f64::EPSILON * largest(&y);
            assert!(distance(&y, &z) < rounding, "{problem:?} start {k} {}", distance(&y, &z));
        }
    }
}

#[test]
fn impossible_input_is_refused() {
    let n = 8;
    let good = vec![-1.0; 729];
    let params = MultigridParams::default();
    let solve = |n: usize, load: &[f64]| multigrid::solve_cube(n, load, None, &params).map(|_| ());
    let direct = |load: &[f64]| active_set::<Cube>(n, load).map(|_| ());
    for wrong in [0, 1, 9, 10, 14] {
        assert!(matches!(solve(wrong, &good), Err(InputError::GridSize(..))), "{wrong}");
    }
    assert!(matches!(solve(n, &good[1..]), Err(InputError::Length { found: 728, expected: 729 })));
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut bad = good.clone();
        bad[40] = value;
        assert_eq!(solve(n, &bad), Err(InputError::NotFinite("load")));
        assert_eq!(direct(&bad), Err(InputError::NotFinite("load")));
        let start = multigrid::solve_cube(n, &good, Some(&bad), &params).map(|_| ());
        assert_eq!(start, Err(InputError::NotFinite("start")));
    }
    let opposite: Vec<_> = good.iter().map(|entry| -entry).collect();
    for bad in [opposite, vec![0.0; 729]] {
        assert!(matches!(solve(n, &bad), Err(InputError::NotCoercive(_))));
        assert!(matches!(direct(&bad), Err(InputError::NotCoercive(_))));
    }
}

#[test]
fn the_workspace_can_be_used_again() {
    let n = 32;
    let mut workspace = Multigrid::cube(n).expect("valid size");
    let params = MultigridParams::default();
    let mut solve = |load: &[f64]| {
        workspace.solve(load, None, &params).expect("valid load");
        let mut y = vec![0.0; load.len()];
        workspace.write_solution(&mut y);
        y
    };
    let load = exact_load(Exact::FreeDisc, n);
    let first = solve(&load);
    solve(&exact_load(Exact::FullContact, n));
    assert!(first == solve(&load));
}

/// Waves of these amplitudes and noise, with a negative sum.
fn random_load(n: usize, amplitudes: &[f64], roughness: f64, deficit_exponent: f64) -> Vec<f64> {
    nodal_load(n, Some(10_f64.powf(deficit_exponent)), |[x, y, z]| {
        let wave = |(k, a): (usize, &f64)| {
            let (x, y) = ((k / 4 + 1) as f64 * 2.0 * x + k as f64, (k % 4) as f64 * 2.5 * y);
            a * x.sin() * (y + 0.3).cos() * (2.0 * z + k as f64).cos()
        };
        let smooth: f64 = amplitudes.iter().enumerate().map(wave).sum();
        smooth + roughness * ((x * 517.3 + y * 917.7 + z * 311.9).sin() * 4317.5).fract()
    })
}

/// Full corrections go round between two contact sets for six in ten thousand of these loads.
#[test]
fn no_two_contact_sets_take_turns() {
    let mut dice = Dice(7);
    for number in 0..20_000 {
        let amplitudes: Vec<f64> = (0..12).map(|_| 2.0 * dice.unit() - 1.0).collect();
        let load = random_load(4, &amplitudes, dice.unit(), -8.0 + 7.7 * dice.unit());
        let (_, outcome) = run(4, &load, Goal::RoundingFloor);
        assert_eq!(outcome.stop, MultigridStop::RoundingFloor, "{number}: {outcome:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Random loads, from smooth to rough, with any negative sum.
    #[test]
    fn random_problems_are_solved(
        n in prop::sample::select(vec![2_usize, 4, 6, 8, 12]),
        amplitudes in prop::collection::vec(-1.0..1.0_f64, 12),
        roughness in 0.0..1.0_f64,
        deficit_exponent in -8.0..-0.3_f64,
    ) {
        let load = random_load(n, &amplitudes, roughness, deficit_exponent);
        let (y, outcome) = run(n, &load, Goal::RoundingFloor);
        prop_assert_eq!(outcome.stop, MultigridStop::RoundingFloor);
        let oracle = oracle(n, &load);
        let level = 2.0 * rounding_level(n, &oracle);
        prop_assert!(natural_residual(n, &y, &load) <= level, "{outcome:?}");
        prop_assert!(natural_residual(n, &oracle, &load) <= level);
        prop_assert!(distance(&y, &oracle) <= 1e6 * level, "{}", distance(&y, &oracle) / level);
        for tolerance in [1e-5, 1e-9, 1e-13] {
            let (y, outcome) = run(n, &load, Goal::Kkt(tolerance));
            let measured = natural_residual(n, &y, &load);
            let claimed = outcome.stop == MultigridStop::Converged;
            prop_assert!(!claimed || measured <= tolerance + 0.25 * level, "{measured:e}");
        }
    }
}
