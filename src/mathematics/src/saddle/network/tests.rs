//! Uzawa's method on networks, against the square.

use super::*;
use crate::discrete::grid::Grid;
use crate::discrete::stop::Stop;
use crate::problem::law::Law;
use crate::saddle::{Method, Params, StopRule, solve};

#[test]
fn uzawa_ends_at_the_rounding_errors_of_huge_loads() {
    let grid = Grid::new(8).unwrap();
    let network = Network::of_square(grid);
    let load: Vec<_> =
        (0..grid.nodes()).map(|k| 1e20 * ((k * 37 % 11) as f64 - 5.6) / 64.0).collect();
    for (weight, rule) in [0.0, 1.0].into_iter().flat_map(|w| StopRule::ALL.map(|of| (w, of))) {
        let method = Method::Uzawa { weight, inner: 1e-4, loose: false };
        let params = Params { method, r: 4.0, tolerance: 1e-3, rule, ..Params::default() };
        let problem = Law::SIGNORINI.with_load(&load);
        let (mut on_grid, mut on_network) = (Pair::zero(grid), Pair::zero(&network));
        let run = solve(grid, problem, &params, &mut on_grid, None);
        assert_eq!(run.stop, Stop::Converged, "{weight} {rule}");
        assert!(rule != StopRule::PrintedDual || run.kkt.relative < 1e-9, "{run:?}");
        let run = solve(&network, problem, &params, &mut on_network, None);
        assert_eq!(run.stop, Stop::Converged, "{weight} {rule}");
    }
}

#[test]
fn every_method_gives_the_bits_of_the_square() {
    let grid = Grid::new(8).unwrap();
    let network = Network::of_square(grid);
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
        let (mut on_grid, mut on_network) = (Pair::zero(grid), Pair::zero(&network));
        let expected = solve(grid, law.with_load(&load), &params, &mut on_grid, None);
        let run = solve(&network, law.with_load(&load), &params, &mut on_network, None);
        assert_eq!(run.iterations, expected.iterations, "{method:?} {law}");
        assert_eq!(run.sweeps, expected.sweeps, "{method:?} {law}");
        if method.weight() == 0.0 {
            assert_eq!(on_network, on_grid, "{method:?} {law}");
        } else {
            // The diagonal is divided by, not multiplied with its inverse.
            let far = on_network.y.iter().zip(&on_grid.y).any(|(a, b)| (a - b).abs() > 1e-13);
            assert!(!far, "{method:?} {law}");
        }
    }
}
