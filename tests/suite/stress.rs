//! Extreme parameters, data, tolerances and starts: no solver may hang, claim what is wrong, or return nonsense.

use crate::solvers::on_threads;
use proptest::prelude::*;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::kkt;
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::experiments::Range;
use signorini_mathematics::experiments::problems::TableProblem;
use signorini_mathematics::experiments::stress::{self, Stress, stress};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{Pair, Params, StopRule, arrow_hurwicz};
use signorini_mathematics::statement::{Domain, Fineness, Statement};
use std::sync::OnceLock;

fn tables(grids: &[usize]) -> Vec<TableProblem> {
    ["quadrant(ll)=3; else=-1.002", "quadrant(ll)=-6; else=1.998"]
        .iter()
        .zip(1..)
        .map(|(f, number)| TableProblem {
            number,
            r: vec![1e6, 10.0, 5.0, 1.0, 0.5],
            statement: Statement {
                load: Some(LoadRule::default()),
                fineness: Fineness::Grids(grids.into()),
                ..Statement::usual(Domain::square(), *f)
            },
        })
        .collect()
}

/// The experiments of the book, with fewer nodes, iterations and random problems.
fn found() -> &'static Stress {
    static ONCE: OnceLock<Stress> = OnceLock::new();
    ONCE.get_or_init(|| {
        let full = stress::StressPlan::new(tables(&[4, 8, 16]));
        stress(&stress::StressPlan { coarse: 8, fine: 32, cap: 4000, random: 200, ..full }).unwrap()
    })
}

#[test]
fn no_claim_of_a_solver_is_wrong_and_every_failure_is_reported() {
    for trial in found().trials() {
        assert!(trial.holds != Some(false), "{trial:?}");
        assert!(trial.says_that_it_failed() || trial.kkt.is_some(), "{trial:?}");
    }
}

#[test]
fn the_signed_rule_is_met_far_from_the_solution_for_every_r() {
    assert_eq!(found().duality.len(), 3);
    for (problem, cases) in found().duality.iter().enumerate() {
        for case in cases {
            // In the third the cap may come first, where r is small.
            assert!(case["signed"].converged() || problem == 2 && case.x < 1e-5, "{case:?}");
            assert!(case["signed"].kkt > Some(0.05), "{case:?}");
        }
    }
}

#[test]
fn one_iteration_meets_the_signed_rule_for_every_tolerance_of_the_plateau() {
    let found = found();
    let plateau = found.summary.plateau.clone().expect("tolerances met at the same iteration");
    let Range { least, greatest } = plateau.tolerances;
    assert!(least <= 1e-14 && greatest >= 1e-6 && plateau.kkt > 0.05, "{plateau:?}");
    let problem = found.plan.names().iter().position(|name| *name == plateau.problem).unwrap();
    let (grid, f) =
        (Grid::new(found.plan.coarse).unwrap(), &found.plan.problems[problem].statement.f);
    let load = load(grid, &f.parse().unwrap(), LoadRule::LumpedAverage {});
    let largest = load.iter().fold(0.0f64, |largest, entry| entry.abs().max(largest));
    let [before, after] = [plateau.steps - 1, plateau.steps].map(|max_iterations| {
        let (rule, tolerance) = (StopRule::Signed, f64::MIN_POSITIVE);
        let params = Params { r: 10.0, tolerance, rule, max_iterations, ..Params::default() };
        let mut pair = Pair::zero(grid);
        let outcome = arrow_hurwicz(grid, Law::SIGNORINI.with_load(&load), &params, &mut pair);
        outcome.gradient_signed.unwrap() / largest
    });
    assert!(before > greatest && after <= least, "{before:e} {after:e} {plateau:?}");
}

#[test]
fn large_r_breaks_nothing_and_the_strict_rule_bounds_the_residual() {
    let strict = found().plan.strict;
    for case in found().duality.iter().flatten() {
        if case.x >= 1.0 {
            assert_eq!(case["strict"].stop, Some(Stop::Converged), "{case:?}");
        }
        if case["strict"].converged() {
            // A change of a below the tolerance bounds y only by the tolerance over r.
            assert!(
                case["strict"].kkt <= Some(1.001 * strict * (1.0 / case.x).max(1.0)),
                "{case:?}"
            );
        }
    }
}

#[test]
fn the_unit_of_f_changes_nothing_but_an_absolute_tolerance() {
    let plain = found().scaling.iter().find(|case| case.x == 0).unwrap();
    for case in &found().scaling {
        // 10^k f is rounded anew, and the last cycle only finds that nothing improves any more.
        let cycles = case["multigrid"].steps.abs_diff(plain["multigrid"].steps);
        assert!(cycles <= 1, "1e{}", case.x);
        assert_eq!(case["multigrid"].stop, Some(Stop::RoundingFloor));
        assert_eq!(case["scaled"].steps, plain["scaled"].steps, "1e{}", case.x);
        let (kkt, want) = (case["scaled"].kkt.unwrap(), plain["scaled"].kkt.unwrap());
        assert!((kkt / want - 1.0).abs() < 1e-9, "1e{}", case.x);
        if case.x < 0 {
            assert_eq!(case["fixed"].steps, 1, "1e{}", case.x);
        }
    }
}

#[test]
fn multigrid_stands_a_vanishing_integral_jumps_and_spikes() {
    for case in found().deficits.iter().flatten().filter(|case| case.x >= 1e-12) {
        assert_eq!(case["multigrid"].stop, Some(Stop::RoundingFloor), "{case:?}");
        assert!(case["multigrid"].work < 70.0, "{case:?}");
    }
    for case in found().jumps.iter().chain(&found().spikes) {
        assert_eq!(case["multigrid"].stop, Some(Stop::RoundingFloor), "{case:?}");
        assert!(case["multigrid"].work < 70.0, "{case:?}");
    }
}

#[test]
fn multigrid_solves_random_problems() {
    let random = &found().random;
    assert_eq!((random.unsolved, random.wrong), (0, 0), "{random:?}");
    assert!(random.most <= 30, "{random:?}");
}

#[test]
fn what_is_not_a_number_is_never_a_result() {
    for case in found().starts.iter().filter(|case| case.x.contains("in one node")) {
        assert_eq!(case["multigrid"].stop, None);
        assert_eq!(case["strict"].stop, Some(Stop::Diverged));
    }
    let grid = Grid::new(8).unwrap();
    let good = load(grid, &"else=-1".parse().unwrap(), LoadRule::default());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for rule in StopRule::ALL {
            let params = Params { rule, max_iterations: 1000, ..Params::default() };
            let mut poisoned = good.clone();
            poisoned[40] = bad;
            let outcome = arrow_hurwicz(
                grid,
                Law::SIGNORINI.with_load(&poisoned),
                &params,
                &mut Pair::zero(grid),
            );
            assert_eq!(outcome.end.stop, Stop::Diverged, "load {bad} {rule}");
            let mut pair = Pair::zero(grid);
            pair.a[3] = bad;
            let outcome = arrow_hurwicz(grid, Law::SIGNORINI.with_load(&good), &params, &mut pair);
            let finite = pair.y.iter().chain(&pair.a).all(|v| v.is_finite());
            assert!(finite || outcome.end.stop == Stop::Diverged, "a {bad} {rule}");
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let plan =
        stress::StressPlan { cap: 500, random: 8, ..stress::StressPlan::new(tables(&[4, 8])) };
    let found = || stress(&plan).unwrap();
    assert!(on_threads(1, found) == on_threads(3, found));
}

#[test]
fn counts_survive_small_errors_of_the_load_but_not_all() {
    let plan =
        stress::StressPlan { cap: 10, random: 0, ..stress::StressPlan::new(tables(&[4, 8, 16])) };
    let noise = stress(&plan).unwrap().load_noise;
    assert_eq!(noise.least, 1e-15);
    let change = noise.first_change.expect("errors of one per cent are tried");
    assert!((1e-12..=1e-2).contains(&change), "{change:e}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever r, scale and start: the printed and the dual rule together bound the natural residual.
    #[test]
    fn the_strict_rule_is_a_claim_that_holds(
        r_exponent in -12.0..12.0f64,
        f_exponent in -100.0..100.0f64,
        relative_exponent in -9.0..-1.0f64,
        start in -1e3..1e3f64,
        jump in 0.0..5.0f64,
    ) {
        let grid = Grid::new(8).unwrap();
        let f = format!("quadrant(ll)={jump}; else=-2");
        let scale = 10f64.powf(f_exponent);
        let load: Vec<f64> =
            load(grid, &f.parse().unwrap(), LoadRule::LumpedAverage {}).iter().map(|f| f * scale).collect();
        let largest = load.iter().fold(0.0f64, |largest, f| f.abs().max(largest));
        let r = 10f64.powf(r_exponent);
        let tolerance = 10f64.powf(relative_exponent) * largest;
        let params = Params { r, tolerance, rule: StopRule::PrintedDual, max_iterations: 3000, ..Params::default() };
        let mut pair = Pair { y: vec![start * largest; grid.nodes()], ..Pair::zero(grid) };
        let outcome = arrow_hurwicz(grid, Law::SIGNORINI.with_load(&load), &params, &mut pair);
        let natural = kkt(grid, Law::SIGNORINI, &pair.y, &load).natural;
        prop_assert!(natural.is_finite());
        if outcome.end.stop == Stop::Converged {
            let bound = tolerance * (1.0 / r).max(1.0);
            prop_assert!(natural <= bound * (1.0 + 1e-9), "{natural:e} {bound:e} {outcome:?}");
        }
    }
}
