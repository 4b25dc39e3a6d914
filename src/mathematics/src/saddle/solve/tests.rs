//! The methods against each other, and how a run ends.

use super::*;
use crate::discrete::end::Stop;
use crate::discrete::grid::Grid;
use crate::discrete::load::LoadRule;
use crate::discrete::network::Network;
use crate::problem::law::Law;
use crate::square::load::load;

const PROBLEMS: [&str; 2] = ["quadrant(ll)=3; else=-1.002", "quadrant(ll)=-6; else=1.998"];

fn setting(f: &str) -> (Grid, Vec<f64>) {
    let grid = Grid::new(16).unwrap();
    (grid, load(grid, &f.parse().unwrap(), LoadRule::Bilinear {}))
}

fn tight(r: f64) -> Params {
    Params { r, tolerance: 1e-9, rule: StopRule::Printed, ..Params::default() }
}

fn uzawa(weight: f64) -> Method {
    Method::Uzawa { weight, inner: 1e-10, loose: false }
}

/// Outcome, sweeps and last pair, from zero: plain and proximal.
fn both(grid: Grid, load: &[f64], params: &Params, weight: f64) -> [(Outcome, usize, Pair); 2] {
    [0.0, weight].map(|weight| {
        let mut pair = Pair::zero((grid, Law::SIGNORINI));
        let end = solve(
            (grid, Law::SIGNORINI),
            load,
            &Params { method: uzawa(weight), ..*params },
            &mut pair,
        );
        (end, end.end.sweeps(), pair)
    })
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst, (a, b)| (a - b).abs().max(worst))
}

#[test]
fn every_method_finds_the_solution_of_arrow_hurwicz() {
    for f in PROBLEMS {
        let (grid, load) = setting(f);
        let mut want = Pair::zero((grid, Law::SIGNORINI));
        let outcome = solve((grid, Law::SIGNORINI), &load, &tight(10.0), &mut want);
        assert_eq!(outcome.end.stop, Stop::Converged);
        for r in [1.0, 10.0, 1e3, 1e6] {
            for (end, sweeps, pair) in both(grid, &load, &tight(r), 1.0) {
                let at = format!("{f}, r = {r}: {end:?}");
                assert_eq!(end.end.stop, Stop::Converged, "{at}");
                // Where a stays positive the gradient sees only h r of what is left of y.
                let bound = 2e-9 * (1.0 / (grid.h() * r)).max(1.0);
                assert!(end.kkt.natural <= bound, "{at}");
                assert!(distance(&pair.y, &want.y) <= 1e-6, "{at}");
                assert!(distance(&pair.a, &want.a) <= 1e-5, "{at}");
                assert!(sweeps >= end.end.iterations, "{at}");
            }
        }
    }
}

#[test]
fn one_sweep_inside_is_arrow_hurwicz_to_the_last_bit() {
    let (grid, load) = setting(PROBLEMS[0]);
    let once = Method::Uzawa { weight: 0.0, inner: f64::INFINITY, loose: false };
    let mut ours = Pair::zero((grid, Law::SIGNORINI));
    let end =
        solve((grid, Law::SIGNORINI), &load, &Params { method: once, ..tight(3.0) }, &mut ours);
    let mut theirs = Pair::zero((grid, Law::SIGNORINI));
    assert_eq!(end, solve((grid, Law::SIGNORINI), &load, &tight(3.0), &mut theirs));
    assert_eq!(end.end.sweeps(), end.end.iterations);
    assert_eq!(ours, theirs);
}

#[test]
fn a_nearly_empty_contact_set_is_no_obstacle() {
    // The mean of f is less than 1e-4 of its size; the solution leaves the boundary almost everywhere.
    let (grid, load) = setting("quadrant(ll)=-6.001; else=2");
    for weight in [0.1, 1.0, 10.0] {
        let [_, (outcome, _, pair)] = both(grid, &load, &tight(10.0), weight);
        assert_eq!(outcome.end.stop, Stop::Converged, "{outcome:?}");
        assert!(outcome.kkt.natural <= 1e-8, "{outcome:?}");
        let contact = pair.a.iter().filter(|&&a| a > 0.0).count();
        assert!((1..=8).contains(&contact), "{contact} nodes in contact");
    }
}

#[test]
fn without_a_minimum_both_end_at_a_cap() {
    let (grid, load) = setting("else=0.5");
    let capped = Params { method: uzawa(0.0), max_iterations: 3000, ..tight(1.0) };
    let [(plain, sweeps, up), (proximal, ..)] = both(grid, &load, &capped, 100.0);
    assert_eq!((plain.end.stop, sweeps), (Stop::IterationLimit, 3000));
    assert_eq!(plain.end.iterations, 0, "the inner problem has no minimum");
    let mut further = up.clone();
    solve((grid, Law::SIGNORINI), &load, &capped, &mut further);
    let drift = 3000.0 * 0.5 * grid.h() * grid.h() * load.iter().sum::<f64>();
    for (low, high) in up.y.iter().zip(&further.y) {
        assert!((high - low - drift).abs() < 1e-9 * drift, "{} {drift}", high - low);
    }
    assert_eq!(proximal.end.stop, Stop::IterationLimit);
    assert!(proximal.end.iterations > 0, "each proximal problem has one");
}

#[test]
fn the_cap_is_on_sweeps() {
    let (grid, load) = setting(PROBLEMS[1]);
    let params = Params { max_iterations: 7, ..tight(1.0) };
    for (outcome, sweeps, _) in both(grid, &load, &params, 1.0) {
        assert_eq!((outcome.end.stop, sweeps), (Stop::IterationLimit, 7));
    }
}

#[test]
fn what_is_no_number_diverges() {
    let (grid, good) = setting(PROBLEMS[0]);
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let mut load = good.clone();
        load[grid.index(8, 8)] = bad;
        for (outcome, sweeps, _) in both(grid, &load, &tight(1.0), 1.0) {
            assert_eq!(outcome.end.stop, Stop::Diverged, "{bad}");
            assert!(sweeps < 100);
        }
    }
    let huge: Vec<f64> = good.iter().map(|f| f * 1e308).collect();
    for (outcome, ..) in both(grid, &huge, &tight(1.0), 1.0) {
        assert_ne!(outcome.end.stop, Stop::Converged);
    }
}

#[test]
fn a_history_has_each_step() {
    let (grid, load) = setting(PROBLEMS[1]);
    let params = Params { method: uzawa(0.0), ..tight(1.0) };
    let (load, start) = (&load[..], &Pair::zero((grid, Law::SIGNORINI)));
    let run = AskedRun { load, params, start, has_history: true };
    let without = AskedRun { has_history: false, ..run };
    for runs in [vec![run], vec![without, without, run]] {
        let ends = solve_together((grid, Law::SIGNORINI).into(), &runs);
        let LevelEnd { outcome, history, .. } = &ends[runs.len() - 1];
        assert!(history.iter().map(|iteration| iteration.number).eq(1..=outcome.end.iterations));
        let last = history.last().unwrap();
        assert_eq!(Some(last.gradient_abs), outcome.gradient_abs);
        assert_eq!(Some(last.delta_a), outcome.end.delta_a);
        assert!(ends[..runs.len() - 1].iter().all(|end| end.history.is_empty()));
    }
}

#[test]
fn runs_side_by_side_have_the_bits_of_each_alone() {
    let grid = Grid::new(16).unwrap();
    let loads = PROBLEMS.map(|f| load(grid, &f.parse().unwrap(), LoadRule::Bilinear {}));
    let (start, loose) = (&Pair::zero((grid, Law::SIGNORINI)), uzawa(0.0).loose());
    let mut runs = Vec::new();
    for load in &loads {
        for method in [Method::ArrowHurwicz, uzawa(0.0), loose, uzawa(2.0)] {
            for (r, kkt) in [(0.7, None), (10.0, Some(1e-5)), (1e5, None)] {
                let params = Params {
                    method,
                    kkt,
                    r,
                    max_iterations: 3000,
                    rule: StopRule::Printed,
                    ..Params::default()
                };
                runs.push(AskedRun { load, params, start, has_history: false });
            }
        }
    }
    for (run, end) in runs.iter().zip(solve_together((grid, Law::SIGNORINI).into(), &runs)) {
        let mut pair = start.clone();
        assert_eq!(
            solve((grid, Law::SIGNORINI), run.load, &run.params, &mut pair),
            end.outcome,
            "{:?}",
            run.params
        );
        assert_eq!(pair, end.pair, "{:?}", run.params);
    }
}

#[test]
fn uzawa_ends_at_the_rounding_errors_of_huge_loads() {
    let grid = Grid::new(8).unwrap();
    let network = Network::of_square(grid, Law::SIGNORINI);
    let load: Vec<_> =
        (0..grid.nodes()).map(|k| 1e20 * ((k * 37 % 11) as f64 - 5.6) / 64.0).collect();
    for (weight, rule) in [0.0, 1.0].into_iter().flat_map(|w| StopRule::ALL.map(|of| (w, of))) {
        let method = Method::Uzawa { weight, inner: 1e-4, loose: false };
        let params = Params { method, r: 4.0, tolerance: 1e-3, rule, ..Params::default() };
        let (mut on_grid, mut on_network) =
            (Pair::zero((grid, Law::SIGNORINI)), Pair::zero(&network));
        let run = solve((grid, Law::SIGNORINI), &load, &params, &mut on_grid);
        assert_eq!(run.end.stop, Stop::Converged, "{weight} {rule}");
        assert!(rule != StopRule::PrintedDual || run.kkt.relative < 1e-9, "{run:?}");
        let run = solve(&network, &load, &params, &mut on_network);
        assert_eq!(run.end.stop, Stop::Converged, "{weight} {rule}");
    }
}

#[test]
fn every_method_gives_the_bits_of_the_square() {
    let grid = Grid::new(8).unwrap();
    let load: Vec<_> = (0..grid.nodes()).map(|k| ((k * 37 % 11) as f64 - 5.6) / 64.0).collect();
    let uzawa = |weight, loose| Method::Uzawa { weight, inner: 1e-4, loose };
    let methods = [Method::ArrowHurwicz, uzawa(0.0, false), uzawa(0.0, true), uzawa(2.0, false)];
    let laws = [Law::SIGNORINI, Law::friction(0.4).unwrap(), Law::limited(0.5).unwrap()];
    for (method, law) in methods.into_iter().flat_map(|method| laws.map(|law| (method, law))) {
        let params = Params {
            method,
            r: 4.0,
            tolerance: 1e-3,
            rule: StopRule::Printed,
            ..Params::default()
        };
        let network = Network::of_square(grid, law);
        let [mut on_grid, mut on_network] = [(); 2].map(|()| Pair::zero(&network));
        let expected = solve((grid, law), &load, &params, &mut on_grid);
        let run = solve(&network, &load, &params, &mut on_network);
        assert_eq!(run.end.iterations, expected.end.iterations, "{method:?} {law}");
        assert_eq!(run.end.sweeps(), expected.end.sweeps(), "{method:?} {law}");
        if method.weight() == 0.0 {
            assert_eq!(on_network, on_grid, "{method:?} {law}");
        } else {
            // The diagonal is divided by, not multiplied with its inverse.
            let far = on_network.y.iter().zip(&on_grid.y).any(|(a, b)| (a - b).abs() > 1e-13);
            assert!(!far, "{method:?} {law}");
        }
    }
}
