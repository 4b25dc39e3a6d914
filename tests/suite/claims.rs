//! The experiment on the paper's claims: its counts, what must hold of them, and the verdicts.

use crate::common::this_project as project;
use crate::solvers::on_threads;
use signorini::replication::scene::Scene;
use signorini_mathematics::experiments::claims::{
    ClaimMeasure, ClaimVerdict, Claims, ClaimsPlan, KktTarget, claims,
};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{NestedGrids, Params, StopRule, solve_nested};
use signorini_mathematics::statement::Fineness;
use std::sync::OnceLock;

/// The plan of the book with fewer r, and without the finest grid where it is dear.
fn plan() -> ClaimsPlan {
    let targets = KktTarget::all([(1e-3, 32), (1e-6, 16)]);
    let problems = project().scenes.iter().filter_map(Scene::table_problem).collect();
    ClaimsPlan { per_decade: 2, targets, ..ClaimsPlan::new(problems) }
}

fn measured() -> &'static Claims {
    static ONCE: OnceLock<Claims> = OnceLock::new();
    ONCE.get_or_init(|| claims(&plan()).unwrap())
}

#[test]
fn the_signed_table_is_the_published_one() {
    let project = project();
    for problem in &measured().problems {
        let table = problem.tables.iter().find(|table| table.rule == StopRule::Signed).unwrap();
        let rows: Vec<_> = table
            .lines
            .iter()
            .map(|line| signorini::replication::comparison::Row {
                r: line.r,
                counts: line.counts.iter().map(|count| count.reached().unwrap()).collect(),
                capped: vec![false; line.counts.len()],
                delta_a: line.delta_a,
            })
            .collect();
        let compared = project.paper.compare(problem.number, "claims", &rows).unwrap();
        assert_eq!(compared.exact, 25, "problem {}", problem.number);
    }
}

#[test]
fn the_lanes_count_what_the_solver_counts() {
    let project = project();
    let scene = project.scene("problem2").unwrap();
    let loads: Vec<_> = scene
        .grids()
        .iter()
        .map(|&grid| {
            signorini_mathematics::discrete::load::load(grid, &scene.source(), scene.load())
        })
        .collect();
    for table in &measured().problems[1].tables {
        let line = table.lines.iter().find(|line| line.r == 10.0).unwrap();
        let params = Params { r: 10.0, rule: table.rule, ..Params::default() };
        let (outcomes, _) = solve_nested(
            &NestedGrids { grids: &scene.grids(), prolongation: scene.saddle().prolongation },
            Law::SIGNORINI.with_loads(&loads),
            &params,
            &mut (),
        );
        let theirs: Vec<_> = outcomes.iter().map(|outcome| outcome.end.iterations).collect();
        let ours: Vec<_> = line.counts.iter().map(|count| count.iterations).collect();
        assert_eq!(ours, theirs, "{}", table.rule);
        assert_eq!(line.delta_a, outcomes[4].end.change());
        assert_eq!(line.kkt, outcomes[4].kkt.relative);
    }
}

#[test]
fn from_ten_up_r_makes_no_difference_to_an_accuracy() {
    // For large r the penalty alone holds the contact nodes at zero.
    for problem in &measured().problems {
        for row in &problem.rows {
            if matches!(row.measure, ClaimMeasure::Kkt(_)) {
                let from = measured().r.iter().position(|&r| r == 10.0).unwrap();
                let counts = || row.counts[from..].iter().map(|count| count.iterations);
                let (least, greatest) = (counts().min().unwrap(), counts().max().unwrap());
                assert!(greatest * 100 <= least * 101, "{row:?}");
            }
        }
    }
}

#[test]
fn the_verdicts_reproduce() {
    let verdicts = &measured().verdicts;
    assert_eq!(verdicts.depends_on_r.verdict, ClaimVerdict::Partly);
    assert_eq!((verdicts.still_moves.holds, verdicts.still_moves.cases), (10, 10));
    assert_eq!((verdicts.more_in_last.holds, verdicts.more_in_last.cases), (5, 5));
    assert_eq!((verdicts.dual_costs.holds, verdicts.dual_costs.cases), (10, 10));
    assert_eq!((verdicts.dual_costs_printed.holds, verdicts.dual_costs_printed.cases), (5, 10));
    assert_eq!(verdicts.cheaper.verdict, ClaimVerdict::Confirmed);
    assert_eq!(verdicts.cheapest.verdict, ClaimVerdict::Partly);
    assert_eq!(verdicts.gain_depends_on_r.verdict, ClaimVerdict::Confirmed);
}

#[test]
fn threads_change_nothing() {
    let small = || {
        let plan =
            ClaimsPlan { per_decade: 1, decades: (0, 2), compared_r: vec![1.0, 10.0], ..plan() };
        let problems = plan.problems.iter().cloned().map(|mut problem| {
            problem.statement.fineness = Fineness::Grids(vec![4, 8, 16]);
            problem
        });
        claims(&ClaimsPlan {
            problems: problems.collect(),
            targets: KktTarget::all([(1e-3, 16)]),
            ..plan
        })
        .unwrap()
    };
    assert_eq!(on_threads(1, small), small());
}

#[test]
fn a_load_without_solution_is_an_error() {
    let mut plan = plan();
    plan.problems[0].statement.f = "else=1".into();
    let error = claims(&plan).unwrap_err();
    assert!(error.contains("no solution on grid 1/4"), "{error}");
}
