//! Every engine gives the same numbers to the last bit.

use super::*;
use crate::discrete::grid::nested;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::network::Network;
use crate::discrete::transfer::Prolongation;
use crate::problem::source::Source;
use crate::saddle::{self, GradientMeasure, Params, arrow_hurwicz, solve, solve_nested};

fn setting() -> (Grid, Vec<f64>, Pair) {
    let grid = Grid::new(16).unwrap();
    let f = "quadrant(ll)=-6; else=1.998".parse().unwrap();
    (grid, load(grid, &f, LoadRule::Bilinear {}), Pair::zero(grid))
}

fn laws() -> [Law; 2] {
    [Law::SIGNORINI, Law::friction(0.6).unwrap()]
}

/// Fails unless each run in lanes has the end and the last pair that it has alone.
fn compare_with_runs_alone(grid: Grid, load: &[f64]) {
    let start = Pair::zero(grid);
    let rules = StopRule::ALL;
    let all = || [0.3, 1.0, 5.0, 1e6].iter().flat_map(|&r| rules.map(|rule| (r, rule)));
    let mut jobs = Vec::new();
    // Under both laws at once.
    for ((r, rule), law) in all().flat_map(|run| laws().map(|law| (run, law))) {
        let (method, goal) = (Method::ArrowHurwicz, JobGoal::Rule(rule, 1e-4));
        jobs.push(Job { law, load, start: &start, method, r, goal, cap: 1000 });
    }
    for (job, (ours, last)) in jobs.iter().zip(run(grid, &jobs)) {
        let JobGoal::Rule(rule, tolerance) = job.goal else { unreachable!() };
        let params =
            Params { r: job.r, rule, tolerance, max_iterations: 1000, ..Params::default() };
        let mut pair = start.clone();
        let theirs = arrow_hurwicz(grid, job.law.with_load(load), &params, &mut pair);
        assert_eq!((ours, &last), (theirs.end, &pair), "{job:?}");
        assert_eq!(run(grid, &[*job]), [(ours, last)]);
    }
}

#[test]
fn each_lane_is_arrow_hurwicz_to_the_last_bit() {
    let (grid, load, start) = setting();
    compare_with_runs_alone(grid, &load);
    let (law, method, goal) = (laws()[1], Method::ArrowHurwicz, JobGoal::Kkt(1e-3));
    let job = Job { law, load: &load, start: &start, method, r: 3.0, goal, cap: 1000 };
    let (end, last) = &run(grid, &[job])[0];
    let outcome = job.outcome(grid, *end, last);
    assert_eq!((outcome.end, outcome.end.stop), (*end, Stop::Converged));
}

#[test]
fn and_over_nested_grids() {
    let f: Source = "quadrant(ll)=-6; else=1.998".parse().unwrap();
    let grids = nested(&[4, 8, 16]).unwrap();
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, LoadRule::Bilinear {})).collect();
    let levels = &NestedGrids { grids: &grids, prolongation: Prolongation::default() };
    let mut jobs = Vec::new();
    for (law, rule) in laws().into_iter().flat_map(|law| StopRule::ALL.map(|rule| (law, rule))) {
        jobs.extend([0.5, 10.0].map(|r| NestedJob { law, loads: &loads, r, rule }));
    }
    for (job, ends) in jobs.iter().zip(run_all_nested(levels, &jobs, |_, _| 500)) {
        let params = Params { r: job.r, rule: job.rule, max_iterations: 500, ..Params::default() };
        let (outcomes, pair) = solve_nested(levels, job.law, &loads, &params, &mut ());
        assert_eq!(ends[2].1, pair);
        assert!(ends.iter().zip(outcomes).all(|((end, _), outcome)| *end == outcome.end));
    }
}

#[test]
fn all_engines_have_the_same_pairs_and_measures_to_the_last_bit() {
    let (grid, load, start) = setting();
    let network = Network::of_square(grid);
    for law in laws() {
        let run = RunStart { load: &load, method: Method::ArrowHurwicz, r: 3.0, pair: &start };
        let (mut square, mut definition) =
            (saddle::engine(grid, law, &run), saddle::engine(&network, law, &run));
        let mut lanes: Lanes = Lanes::new(grid, Law::SIGNORINI, Order::Lexicographic, 1.0);
        lanes.enter(5, law, &run);
        for _ in 0..20 {
            square.sweep();
            definition.sweep();
            lanes.sweep();
            let change = square.dual_step([true])[0];
            assert_eq!(definition.dual_step([true]), [change]);
            assert_eq!(lanes.dual_step([true; LANES])[5], change);
            for measure in GradientMeasure::ALL {
                let worst = square.worst(measure)[0];
                assert_eq!(definition.worst(measure), [worst], "{measure:?}");
                assert_eq!(lanes.worst(measure)[5], worst, "{measure:?}");
                assert!(lanes.within(measure, [Some(worst); LANES])[5]);
                let below = [Some(worst - 1e-9); LANES];
                assert!(!lanes.within(measure, below)[5], "{measure:?}");
                assert_eq!(square.within(measure, [Some(worst)]), [true]);
                assert_eq!(definition.within(measure, [Some(worst)]), [true]);
            }
        }
        assert_eq!(square.pair(0), definition.pair(0));
        assert_eq!(lanes.pair(5), square.pair(0));
    }
}

#[test]
fn what_is_no_number_anywhere_meets_no_goal() {
    let (grid, load, start) = setting();
    for node in [0, 7, grid.nodes() / 2, grid.nodes() - 1] {
        let mut load = load.clone();
        load[node] = f64::NAN;
        let rules = StopRule::ALL.map(|rule| JobGoal::Rule(rule, f64::MAX));
        for goal in rules.into_iter().chain([JobGoal::Kkt(f64::MAX)]) {
            let method = Method::ArrowHurwicz;
            // One sweep leaves numbers before the node; a cap of none is one as well.
            for cap in [0, 1] {
                let law = Law::SIGNORINI;
                let job = Job { law, load: &load, start: &start, method, r: 1.0, goal, cap };
                let (end, _) = &run(grid, &[job])[0];
                assert!(end.stop != Stop::Converged, "node {node}, {goal:?}");
                assert_eq!(end.sweeps(), 1);
            }
        }
    }
}

#[test]
fn and_uzawa_with_and_without_the_proximal_term() {
    let (grid, load, start) = setting();
    let all = [(0.0, 3.0, false), (1.0, 3.0, true), (10.0, 1e4, false), (0.0, 1e4, true)];
    for law in laws() {
        let jobs = all.map(|(weight, r, loose)| {
            let method = Method::Uzawa { weight, inner: 1e-5, loose };
            let goal = JobGoal::Rule(StopRule::Printed, 1e-4);
            Job { law, load: &load, start: &start, method, r, goal, cap: 100_000 }
        });
        for (job, (ours, last)) in jobs.iter().zip(run(grid, &jobs)) {
            let params = Params {
                method: job.method,
                r: job.r,
                tolerance: 1e-4,
                rule: StopRule::Printed,
                ..Params::default()
            };
            let mut pair = start.clone();
            let run = solve(grid, law.with_load(&load), &params, &mut pair, None);
            assert_eq!(ours, run.end);
            assert_eq!((ours.stop, &last), (Stop::Converged, &pair));
        }
    }
}

#[test]
fn jobs_that_differ_in_their_goals_alone_have_one_run() {
    let (grid, load, start) = setting();
    let (zero, method) = (Pair::zero(grid), Method::ArrowHurwicz);
    let mut jobs = Vec::new();
    for (law, r) in laws().into_iter().flat_map(|law| [0.5, 10.0].map(|r| (law, r))) {
        let rules = StopRule::ALL.map(|rule| JobGoal::Rule(rule, 1e-4));
        for goal in rules.into_iter().chain([JobGoal::Kkt(1e-3), JobGoal::Kkt(1e-2)]) {
            // An equal start counts as the same one; a limit has a run of its own.
            let start = if jobs.len() % 2 == 0 { &start } else { &zero };
            jobs.push(Job { law, load: &load, start, method, r, goal, cap: 300 });
        }
        jobs.push(Job { cap: 20, ..jobs[jobs.len() - 1] });
    }
    assert_eq!(same_runs(&jobs).len(), 8);
    for (job, ended) in jobs.iter().zip(run(grid, &jobs)) {
        assert_eq!(run(grid, &[*job]), [ended], "{job:?}");
    }
}
