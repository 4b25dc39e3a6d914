//! The replication itself: the committed scenes against the published tables, and the method against exact solutions.

use crate::common::this_project as project;
use signorini::replication::comparison::Row;
use signorini::replication::paper::Paper;
use signorini::replication::scene::Scene;
use signorini_mathematics::discrete::end::{Outcome, Stop};
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::nested::DiscreteLevels;
use signorini_mathematics::discrete::network::Network;
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{
    Iteration, Monitor, Pair, Params, StopRule, solve, solve_nested, tolerance,
};
use signorini_mathematics::square::errors::errors;
use signorini_mathematics::square::load::load;

fn rows(scene: &Scene, rule: StopRule) -> Vec<Row> {
    let loads: Vec<_> =
        scene.grids().iter().map(|&grid| load(grid, &scene.source(), scene.load())).collect();
    let row = |&r: &f64| {
        let params = Params { r, rule, max_iterations: 100_000, ..Params::default() };
        let (outcomes, _) = solve_nested(
            DiscreteLevels::Grids(&scene.grids(), Law::SIGNORINI),
            &loads,
            &params,
            &mut (),
        );
        Row {
            r,
            counts: outcomes.iter().map(|o| o.end.iterations).collect(),
            capped: outcomes.iter().map(|o| o.end.stop == Stop::IterationLimit).collect(),
            delta_a: outcomes.last().unwrap().end.change(),
        }
    };
    scene.r().iter().map(row).collect()
}

fn exact_counts(paper: &Paper, scene: &Scene, rule: StopRule) -> usize {
    let number = scene.paper_table.unwrap();
    paper.compare(number, &scene.name, &rows(scene, rule)).unwrap().exact
}

#[test]
fn every_published_count_comes_out_under_the_signed_rule() {
    let project = project();
    for name in ["problem1", "problem2"] {
        let scene = project.scene(name).unwrap();
        assert_eq!(exact_counts(&project.paper, scene, StopRule::Signed), 25, "{name}");
    }
}

#[test]
fn the_definition_gives_every_count_and_iterate_of_the_tables_to_the_last_bit() {
    const CAP: usize = 100_000;
    let project = project();
    for (name, rule, r) in ["problem1", "problem2"].into_iter().flat_map(|name| {
        let r = project.scene(name).unwrap().r();
        let rules =
            r.into_iter().flat_map(|r| [StopRule::Signed, StopRule::Printed].map(|rule| (rule, r)));
        rules.map(move |(rule, r)| (name, rule, r))
    }) {
        let scene = project.scene(name).unwrap();
        let load = |&grid: &Grid| load(grid, &scene.source(), scene.load());
        let grids = &scene.grids()[..];
        let loads = grids.iter().map(load).collect::<Vec<_>>();
        let params = Params { r, rule, max_iterations: CAP, ..Params::default() };
        let levels = DiscreteLevels::Grids(grids, Law::SIGNORINI);
        let (made, made_pair) = solve_nested(levels, &loads, &params, &mut ());
        let (mut pair, mut defined) = (Pair::zero((grids[0], Law::SIGNORINI)), Vec::new());
        for k in 0..grids.len() {
            if k > 0 {
                pair = pair.interpolated(levels, k, params.prolongation);
            }
            let network = Network::of_square(grids[k], Law::SIGNORINI);
            let params = Params { tolerance: tolerance(k + 1), ..params };
            defined.push(solve(&network, &loads[k], &params, &mut pair));
        }
        let ends = |outcomes: &[Outcome]| -> Vec<_> {
            outcomes.iter().map(|end| (end.end.iterations, end.end.stop, end.end.delta_a)).collect()
        };
        assert_eq!(ends(&defined), ends(&made), "{name} {rule} r = {r}");
        let bits =
            |pair: &Pair| pair.y.iter().chain(&pair.a).map(|v| v.to_bits()).collect::<Vec<_>>();
        assert!(bits(&pair) == bits(&made_pair), "{name} {rule} r = {r}");
    }
}

#[test]
fn the_printed_rule_gives_few_of_the_counts() {
    let project = project();
    for name in ["problem1", "problem2"] {
        let scene = project.scene(name).unwrap();
        let exact = exact_counts(&project.paper, scene, StopRule::Printed);
        assert!(exact <= 5, "{name}: {exact}");
    }
}

/// Thousandths between which each value of f gives all counts, the other value being that of the scene; one thousandth
/// further out some count is another.
#[test]
fn counts_hold_each_value_of_f_within_a_few_thousandths() {
    let project = project();
    for (name, value_is_odd, thousandths) in [
        ("problem1", true, 2996..=3000),
        ("problem1", false, -1003..=-1002),
        ("problem2", true, -6003..=-5995),
        ("problem2", false, 1997..=2000),
    ] {
        let mut scene = project.scene(name).unwrap().clone();
        let [odd, other] = if name == "problem1" { [3000, -1002] } else { [-6000, 1998] };
        for value in thousandths.start() - 1..=thousandths.end() + 1 {
            let [odd, other] = if value_is_odd { [value, other] } else { [odd, value] };
            let f = format!("quadrant(ll)={odd}e-3; else={other}e-3");
            scene.statement.f.clone_from(&f);
            let all = exact_counts(&project.paper, &scene, StopRule::Signed) == 25;
            assert_eq!(all, thousandths.contains(&value), "{f}");
        }
    }
}

/// Keeps the greatest nodal error on each grid.
struct ErrorsOnGrids<'a> {
    exact: Exact,
    grids: &'a [Grid],
    largest: Vec<f64>,
}

impl Monitor for ErrorsOnGrids<'_> {
    fn level(&mut self, pair: &Pair, _: &[Iteration]) {
        let grid = self.grids[self.largest.len()];
        self.largest.push(errors(grid, self.exact, &pair.y).max);
    }
}

#[test]
fn errors_fall_with_the_square_of_the_width_when_iterated_to_the_end() {
    let project = project();
    let scene = project.scene("full-contact").unwrap();
    let exact = scene.source().exact().unwrap();
    let mut found = Vec::new();
    for n in [8, 16, 32] {
        let grid = Grid::new(n).unwrap();
        let params =
            Params { r: 10.0, tolerance: 1e-11, rule: StopRule::Printed, ..Params::default() };
        let mut pair = Pair::zero((grid, Law::SIGNORINI));
        let outcome = solve(
            (grid, Law::SIGNORINI),
            &load(grid, &scene.source(), scene.load()),
            &params,
            &mut pair,
        );
        assert_eq!(outcome.end.stop, Stop::Converged);
        assert!(outcome.kkt.relative < 1e-6, "{:?}", outcome.kkt);
        found.push(errors(grid, exact, &pair.y).max);
    }
    for pair in found.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.1, "order {order} of {found:?}");
    }
}

#[test]
fn stopping_by_ten_to_the_minus_n_spoils_that_order() {
    // What the tolerance of the paper costs: the error no longer follows the grid.
    let project = project();
    let scene = project.scene("full-contact").unwrap();
    let exact = scene.source().exact().unwrap();
    let grids = nested(&[4, 8, 16, 32, 64]).unwrap();
    let loads: Vec<_> =
        grids.iter().map(|&grid| load(grid, &scene.source(), scene.load())).collect();
    let params = Params { r: 10.0, rule: StopRule::Printed, ..Params::default() };
    let mut errors = ErrorsOnGrids { exact, grids: &grids, largest: Vec::new() };
    solve_nested(DiscreteLevels::Grids(&grids, Law::SIGNORINI), &loads, &params, &mut errors);
    let order = (errors.largest[3] / errors.largest[4]).log2();
    assert!(order < 1.7, "order {order} of {:?}", errors.largest);
}
