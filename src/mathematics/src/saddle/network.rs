//! The saddle-point methods on any triangulation, by the definition of the sweep.

use super::method::Method;
use super::plain::Plain;
use super::stopping::{GradientTerms, RoundingFloor, SWEEPS_TO_FLOOR};
use super::{Outcome, Pair, Params, tolerance};
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::law_and_load::{LawAndLoad, LawAndLoads};
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::Network;
use crate::discrete::norms::largest;
use crate::discrete::stop::Stop;

/// End of a saddle-point method on one network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkRun {
    /// Steps of the multiplier done: the iterations of the paper.
    pub iterations: usize,
    /// Number of Gauss-Seidel sweeps.
    pub sweeps: usize,
    /// Reason for the end.
    pub stop: Stop,
    /// Last change of the multiplier, the paper's Delta a.
    pub delta_a: f64,
}

impl NetworkRun {
    /// Judges the last pair of this run.
    pub fn outcome(&self, problem: &Plain<'_>, pair: &Pair) -> Outcome {
        let Plain { network, law, load, .. } = *problem;
        let Judgement { kkt, energy, work, .. } = judge(network, law, &pair.y, load);
        let sum_load = load.iter().sum();
        let (mut gradient_signed, mut gradient_abs) = (f64::NEG_INFINITY, 0.0f64);
        for node in 0..network.nodes() {
            let gradient = problem.gradient(node, pair);
            gradient_signed = gradient.max(gradient_signed);
            gradient_abs = gradient.abs().max(gradient_abs);
        }
        Outcome {
            cells: network.nodes(),
            iterations: self.iterations,
            stop: self.stop,
            gradient_signed,
            gradient_abs,
            delta_a: self.delta_a,
            energy,
            sum_load,
            kkt,
            work,
            has_solution: if network.fixed().is_empty() {
                (!law.is_signorini())
                    .then(|| law.check_solvable(sum_load, network.perimeter()).is_ok())
            } else {
                Some(true)
            },
        }
    }
}

/// Iterates on `pair` until the stopping rule is met or the limit on sweeps is reached; as
/// [`solve`](super::solve) does on the square, with the same bits there.
///
/// # Panics
/// If a slice has the wrong length for `network`, or `params.r` is not positive.
pub fn solve_network(
    network: &Network,
    LawAndLoad { law, load }: LawAndLoad<'_>,
    params: &Params,
    pair: &mut Pair,
) -> NetworkRun {
    let Params { method, r, .. } = *params;
    assert!(r > 0.0, "the duality parameter r must be positive");
    assert!(load.len() == network.nodes() && pair.y.len() == load.len());
    let outer = Plain { network, law, load, r };
    // The proximal term adds to the diagonal, and its centre to the load.
    let weight = method.weight();
    let shifted = (weight > 0.0).then(|| network.with_masses(weight));
    let inner_network = shifted.as_ref().unwrap_or(network);
    let mut bound = method.inner_bound(largest(load));
    let mut run = NetworkRun { iterations: 0, sweeps: 0, stop: Stop::IterationLimit, delta_a: 0.0 };
    let terms = terms_on(inner_network, r);
    let mut floor = RoundingFloor::default();
    let mut target = load.to_vec();
    loop {
        if weight > 0.0 {
            for (node, target) in target.iter_mut().enumerate() {
                *target = load[node] + weight * network.masses()[node] * pair.y[node];
            }
        }
        let inner = Plain { network: inner_network, law, load: &target, r };
        loop {
            if run.sweeps >= params.max_iterations {
                return run;
            }
            inner.sweep(pair);
            run.sweeps += 1;
            let Some(bound) = bound else { break };
            if run.sweeps.is_multiple_of(SWEEPS_TO_FLOOR) {
                floor = terms.floor(largest(&target), pair);
            }
            if inner.largest_gradient(pair) <= bound.max(floor.gradient) {
                break;
            }
            if !pair.y.iter().all(|value| value.is_finite()) {
                return NetworkRun { stop: Stop::Diverged, ..run };
            }
        }
        run.delta_a = outer.dual_step(pair);
        run.iterations += 1;
        if !pair.a.iter().chain(&pair.y).all(|value| value.is_finite()) {
            return NetworkRun { stop: Stop::Diverged, ..run };
        }
        let method = method.above(floor.gradient);
        if matches!(method, Method::Uzawa { loose: true, .. }) {
            bound = method.inner_bound(outer.largest_gradient(pair));
        }
        // A change of the multiplier that is a rounding error counts as none.
        let delta_a = if run.delta_a <= floor.dual { 0.0 } else { run.delta_a };
        if outer.stops(params.rule, params.tolerance.max(floor.gradient), delta_a, pair) {
            return NetworkRun { stop: Stop::Converged, ..run };
        }
    }
}

/// Sizes of the terms of the gradient on a network.
fn terms_on(network: &Network, r: f64) -> GradientTerms {
    let measures = || network.contact().iter().map(|contact| contact.measure);
    let most_measure = measures().fold(0.0, f64::max);
    GradientTerms {
        matrix: 2.0 * largest(network.diagonal()) + most_measure * r,
        most_measure,
        least_measure: measures().fold(f64::INFINITY, f64::min),
    }
}

/// Solves on each of nested networks in turn, coarsest first, starting from zero and then from the interpolated pair, with
/// the [`tolerance`] of each; ends after a network on which the iteration diverged. There is a load vector for each.
/// `after` receives the position of each network, its end and its pair. Returns the last pair.
///
/// # Panics
/// If there are no levels, or as [`solve_network`].
pub fn solve_networks(
    levels: &[NestedNetwork],
    LawAndLoads { law, loads }: LawAndLoads<'_>,
    params: &Params,
    after: &mut dyn FnMut(usize, &NetworkRun, &Pair),
) -> Pair {
    let mut pair = Pair::zero_on(&levels[0].network);
    for (k, (level, load)) in levels.iter().zip(loads).enumerate() {
        if k > 0 {
            let a = level.interpolate_boundary(&levels[k - 1].network, &pair.a);
            pair = Pair { y: level.interpolate(&pair.y), a };
        }
        let tolerance = tolerance(k + 1);
        let method = match params.method {
            Method::Uzawa { weight, loose, .. } => {
                Method::Uzawa { weight, inner: 0.1 * tolerance, loose }
            }
            Method::ArrowHurwicz => Method::ArrowHurwicz,
        };
        let params = Params { method, tolerance, ..*params };
        let run = solve_network(&level.network, law.with_load(load), &params, &mut pair);
        after(k, &run, &pair);
        if run.stop == Stop::Diverged {
            break;
        }
    }
    pair
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::grid::Grid;
    use crate::problem::law::Law;
    use crate::saddle::{StopRule, solve};

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
            let (mut on_grid, mut on_network) = (Pair::zero(grid), Pair::zero_on(&network));
            let run = solve(grid, problem, &params, &mut on_grid, None);
            assert_eq!(run.outcome.stop, Stop::Converged, "{weight} {rule}");
            assert!(rule != StopRule::PrintedDual || run.outcome.kkt.relative < 1e-9, "{run:?}");
            let run = solve_network(&network, problem, &params, &mut on_network);
            assert_eq!(run.stop, Stop::Converged, "{weight} {rule}");
        }
    }

    #[test]
    fn every_method_gives_the_bits_of_the_square() {
        let grid = Grid::new(8).unwrap();
        let network = Network::of_square(grid);
        let load: Vec<_> = (0..grid.nodes()).map(|k| ((k * 37 % 11) as f64 - 5.6) / 64.0).collect();
        let uzawa = |weight, loose| Method::Uzawa { weight, inner: 1e-4, loose };
        let methods =
            [Method::ArrowHurwicz, uzawa(0.0, false), uzawa(0.0, true), uzawa(2.0, false)];
        let laws = [Law::SIGNORINI, Law::friction(0.4).unwrap(), Law::limited(0.5).unwrap()];
        for (method, law) in methods.into_iter().flat_map(|method| laws.map(|law| (method, law))) {
            let params = Params {
                method,
                r: 4.0,
                tolerance: 1e-3,
                rule: StopRule::Printed,
                ..Params::default()
            };
            let (mut on_grid, mut on_network) = (Pair::zero(grid), Pair::zero_on(&network));
            let expected = solve(grid, law.with_load(&load), &params, &mut on_grid, None);
            let run = solve_network(&network, law.with_load(&load), &params, &mut on_network);
            assert_eq!(run.iterations, expected.outcome.iterations, "{method:?} {law}");
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
}
