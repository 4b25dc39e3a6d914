//! Solvers on the cube: accuracy, agreement, cost in work units, robustness.

use crate::common::Dice;
use crate::cube_loads::{exact_load, nodal_load, stress_loads};
use crate::domains::{self, rounding_level};
use crate::solvers::{ALGEBRAIC, BYTES, HARD_WORK_UNITS, TEXTBOOK, distance};
use proptest::prelude::*;
use signorini_mathematics::discrete::cube::{Grid, errors, judge};
use signorini_mathematics::discrete::norms::Errors;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::multigrid::active_set::active_set;
use signorini_mathematics::multigrid::cube::Cube;
use signorini_mathematics::multigrid::{Goal, Multigrid, MultigridOutcome, MultigridParams};
use signorini_mathematics::problem::exact::CubeExact as Exact;
use signorini_mathematics::problem::law::Law;

fn grid(n: usize) -> Grid {
    Grid::new(n).expect("fine enough")
}

fn run(n: usize, load: &[f64], goal: Goal) -> (Vec<f64>, MultigridOutcome) {
    domains::run::<Cube>(n, load, goal)
}

pub(crate) fn natural_residual(n: usize, y: &[f64], load: &[f64]) -> f64 {
    judge(grid(n), Law::SIGNORINI, y, load).kkt.natural
}

/// Loads of the problems with a formula for the solution, by name.
pub(crate) fn exact_loads(n: usize) -> Vec<(&'static str, Vec<f64>)> {
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
            assert_eq!((outcome.stop, outcome.cycles), (Stop::Converged, 1));
            assert!(outcome.work_units < TEXTBOOK, "{problem:?} {n} {outcome:?}");
            let grid = grid(n);
            let discretisation = errors(grid, problem, &exact_discrete);
            let algebraic: Vec<_> = y.iter().zip(&exact_discrete).map(|(a, b)| a - b).collect();
            let squares = algebraic.iter().zip(grid.indices()).map(|(e, i)| grid.share(i) * e * e);
            let l2 = (grid.h().powi(3) * squares.sum::<f64>()).sqrt();
            // For zero load, the energy is half the square of the H1 seminorm.
            let h1 =
                (2.0 * judge(grid, Law::SIGNORINI, &algebraic, &vec![0.0; y.len()]).energy).sqrt();
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
                (Goal::DiscretisationError, HARD_WORK_UNITS[0]),
                (Goal::Kkt(tolerance), HARD_WORK_UNITS[1]),
                (Goal::RoundingFloor, HARD_WORK_UNITS[2]),
            ] {
                let params = MultigridParams { goal, ..Default::default() };
                let outcome = workspace
                    .solve(Law::SIGNORINI.with_load(&load), None, &params)
                    .expect("valid load");
                assert!(outcome.work_units < limit, "{name} {n} {goal:?} {outcome:?}");
                let floor = goal == Goal::RoundingFloor;
                let expected = if floor { Stop::RoundingFloor } else { Stop::Converged };
                assert_eq!(outcome.stop, expected, "{name} {n} {goal:?}");
            }
        }
        let bytes = workspace.bytes() as f64 / (n + 1).pow(3) as f64;
        assert!(bytes < BYTES[1], "{n} {bytes}");
    }
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
        assert_eq!(outcome.stop, Stop::RoundingFloor, "{number}: {outcome:?}");
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
        prop_assert_eq!(outcome.stop, Stop::RoundingFloor);
        let (oracle, _) = active_set::<Cube>(n, Law::SIGNORINI, &load).expect("valid");
        let level = 2.0 * rounding_level::<Cube>(n, &oracle);
        prop_assert!(natural_residual(n, &y, &load) <= level, "{outcome:?}");
        prop_assert!(natural_residual(n, &oracle, &load) <= level);
        prop_assert!(distance(&y, &oracle) <= 1e6 * level, "{}", distance(&y, &oracle) / level);
        for tolerance in [1e-5, 1e-9, 1e-13] {
            let (y, outcome) = run(n, &load, Goal::Kkt(tolerance));
            let measured = natural_residual(n, &y, &load);
            let claimed = outcome.stop == Stop::Converged;
            prop_assert!(!claimed || measured <= tolerance + 0.25 * level, "{measured:e}");
        }
    }
}
