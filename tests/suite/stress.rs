//! Extreme parameters, data, tolerances and starts: no solver may hang, claim what is wrong, or return nonsense.

use crate::common::{found, number, table_problems};
use crate::solvers::on_threads;
use proptest::prelude::*;
use serde_json::{Value, json};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::kkt;
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::experiments::{Findings, Rows};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{Pair, Params, StopRule, arrow_hurwicz};
use std::sync::OnceLock;

/// Findings of the book's plan with these fields for the paper's problems on these grids.
fn with(grids: &[usize], fields: &Value) -> Findings {
    let mut problems = json!(table_problems());
    for problem in problems.as_array_mut().unwrap() {
        problem["statement"]["fineness"] = json!({ "grids": grids });
    }
    let mut fields = fields.clone();
    fields["problems"] = problems;
    found("stress", &fields).unwrap()
}

/// Strict tolerance of the plan, relative to the largest load.
const STRICT: f64 = 1e-8;

/// Findings with fewer nodes, iterations and random problems than in the book.
fn findings() -> &'static Findings {
    static ONCE: OnceLock<Findings> = OnceLock::new();
    ONCE.get_or_init(|| {
        let fields = json!({ "coarse": 8, "fine": 32, "cap": 4000, "random": 200 });
        with(&[4, 8, 16], &fields)
    })
}

/// Runs of a series by a method.
fn runs(series: &str, method: &str) -> Rows {
    let runs = findings()["runs"].wherever("series", series).unwrap();
    runs.wherever("method", method).unwrap()
}

#[test]
fn no_claim_of_a_solver_is_wrong_and_every_failure_is_reported() {
    let runs = &findings()["runs"];
    assert_eq!(*runs.wherever("holds", false).unwrap(), []);
    assert_eq!(*runs.wherever("is_silent", true).unwrap(), []);
}

#[test]
fn the_signed_rule_is_met_far_from_the_solution_for_every_r() {
    let signed = runs("duality", "signed");
    assert_eq!(signed.texts("problem").unwrap().len(), 3);
    for run in signed.iter() {
        // In the third the cap may come first, where r is small.
        let may_end = run["problem"] == "strong-contact" && number(&run["x"]) < 1e-5;
        assert!(run["stop"] == "converged" || may_end, "{run:?}");
        assert!(number(&run["kkt"]) > 0.05, "{run:?}");
    }
}

#[test]
fn one_iteration_meets_the_signed_rule_for_every_tolerance_of_the_plateau() {
    let plateau = &findings()["plateau"];
    let [least, greatest, kkt] =
        ["least", "greatest", "kkt"].map(|name| plateau.numbers(name).unwrap()[0]);
    assert!(least <= 1e-14 && greatest >= 1e-6 && kkt > 0.05, "{plateau:?}");
    let (name, steps) = (plateau.texts("problem").unwrap()[0], plateau[0]["steps"].as_u64());
    let problem = table_problems().into_iter().find(|problem| problem.name() == name).unwrap();
    let (grid, f) = (Grid::new(8).unwrap(), problem.statement.source().unwrap());
    let load = load(grid, &f, LoadRule::Bilinear {});
    let largest = load.iter().fold(0.0f64, |largest, entry| entry.abs().max(largest));
    let steps = steps.unwrap() as usize;
    let [before, after] = [steps - 1, steps].map(|max_iterations| {
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
    let strict = runs("duality", "strict");
    for run in strict.iter().filter(|run| number(&run["x"]) >= 1.0) {
        assert_eq!(run["stop"], "converged", "{run:?}");
    }
    for (r, kkt) in strict.wherever("stop", "converged").unwrap().points("x", "kkt").unwrap() {
        // A change of a below the tolerance bounds y only by the tolerance over r.
        assert!(kkt <= 1.001 * STRICT * (1.0 / r).max(1.0), "{r:e} {kkt:e}");
    }
}

#[test]
fn the_unit_of_f_changes_nothing_but_an_absolute_tolerance() {
    let [multigrid, scaled] = ["multigrid", "scaled"].map(|method| {
        let runs = runs("scaling", method);
        let plain = runs.wherever("x", 0.0).unwrap();
        (runs, plain)
    });
    let cycles = multigrid.1.numbers("steps").unwrap()[0];
    for run in multigrid.0.iter() {
        // 10^k f is rounded anew, and the last cycle only finds that nothing improves any more.
        assert!((run["steps"].as_f64().unwrap() - cycles).abs() <= 1.0, "{run:?}");
        assert_eq!(run["stop"], "rounding-floor");
    }
    let want = scaled.1.numbers("kkt").unwrap()[0];
    for run in scaled.0.iter() {
        assert_eq!(run["steps"], scaled.1[0]["steps"], "{run:?}");
        assert!((run["kkt"].as_f64().unwrap() / want - 1.0).abs() < 1e-9, "{run:?}");
    }
    for (x, steps) in runs("scaling", "fixed").points("x", "steps").unwrap() {
        assert!(x >= 0.0 || steps == 1.0, "1e{x}");
    }
}

#[test]
fn multigrid_stands_a_vanishing_integral_jumps_and_spikes() {
    let deficits = runs("deficits", "multigrid");
    let hard = deficits.iter().filter(|run| number(&run["x"]) >= 1e-12);
    let (jumps, spikes) = (runs("jumps", "multigrid"), runs("spikes", "multigrid"));
    for run in hard.chain(jumps.iter()).chain(spikes.iter()) {
        assert_eq!(run["stop"], "rounding-floor", "{run:?}");
        assert!(number(&run["work"]) < 70.0, "{run:?}");
    }
}

#[test]
fn multigrid_solves_random_problems() {
    let random = &findings()["random"];
    for (name, most) in [("unsolved", 0.0), ("wrong", 0.0), ("most", 30.0)] {
        assert!(random.numbers(name).unwrap()[0] <= most, "{random:?}");
    }
}

#[test]
fn what_is_not_a_number_is_never_a_result() {
    for start in ["infinite in one node", "NaN in one node"] {
        let strict = runs("starts", "strict").wherever("start", start).unwrap();
        assert_eq!(strict[0]["stop"], "diverged");
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
    let found = || with(&[4, 8], &json!({ "cap": 500, "random": 8 }));
    assert!(on_threads(1, found) == on_threads(3, found));
}

#[test]
fn counts_survive_small_errors_of_the_load_but_not_all() {
    let noise = &with(&[4, 8, 16], &json!({ "cap": 10, "random": 0 }))["noise"];
    assert_eq!(noise.numbers("least").unwrap(), [1e-15]);
    let change = noise.numbers("first_change").unwrap();
    assert!((1e-12..=1e-2).contains(&change[0]), "{change:?}");
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
            load(grid, &f.parse().unwrap(), LoadRule::Bilinear {}).iter().map(|f| f * scale).collect();
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
