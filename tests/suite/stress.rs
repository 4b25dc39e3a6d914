//! Extreme parameters, data, tolerances and starts: no solver may hang, claim what is wrong, or return nonsense.

use crate::common::config;
use proptest::prelude::*;
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{Pair, Params, StopRule, solve};
use signorini_mathematics::square::load::load;

#[test]
fn what_is_not_a_number_is_never_a_result() {
    let grid = Grid::new(8).unwrap();
    let good = load(grid, &"else=-1".parse().unwrap(), LoadRule::default());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for rule in StopRule::ALL {
            let params = Params { rule, max_iterations: 1000, ..Params::default() };
            let mut poisoned = good.clone();
            poisoned[40] = bad;
            let outcome = solve(
                (grid, Law::SIGNORINI),
                &poisoned,
                &params,
                &mut Pair::zero((grid, Law::SIGNORINI)),
            );
            assert_eq!(outcome.end.stop, Stop::Diverged, "load {bad} {rule}");
            let mut pair = Pair::zero((grid, Law::SIGNORINI));
            pair.a[3] = bad;
            let outcome = solve((grid, Law::SIGNORINI), &good, &params, &mut pair);
            let finite = pair.y.iter().chain(&pair.a).all(|v| v.is_finite());
            assert!(finite || outcome.end.stop == Stop::Diverged, "a {bad} {rule}");
        }
    }
}

proptest! {
    #![proptest_config(config(48))]

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
        let mut pair = Pair { y: vec![start * largest; grid.nodes()], ..Pair::zero((grid, Law::SIGNORINI)) };
        let outcome = solve((grid, Law::SIGNORINI), &load, &params, &mut pair);
        let natural = judge((grid, Law::SIGNORINI), &pair.y, &load).kkt.natural;
        prop_assert!(natural.is_finite());
        if outcome.end.stop == Stop::Converged {
            let bound = tolerance * (1.0 / r).max(1.0);
            prop_assert!(natural <= bound * (1.0 + 1e-9), "{natural:e} {bound:e} {outcome:?}");
        }
    }
}
