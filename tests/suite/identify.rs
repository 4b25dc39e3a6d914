//! The search for Figure 1 against the literal iteration, and on planted right-hand sides.

use crate::common::{config, this_project};
use proptest::prelude::*;
use signorini_mathematics::discrete::grid::nested;
use signorini_mathematics::discrete::nested::DiscreteLevels;
use signorini_mathematics::identify::*;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{Params, StopRule, solve_nested};
use signorini_mathematics::square::load::load;
use std::sync::atomic::{AtomicBool, Ordering};

const R: [f64; 5] = [1e6, 10.0, 5.0, 1.0, 0.5];

fn published(problem: usize) -> Target {
    let paper = this_project().paper;
    let table = paper.table.into_iter().find(|table| usize::from(table.number) == problem).unwrap();
    Target { r: paper.r, counts: table.counts, delta_a: table.delta_a }
}

/// The first columns of a table, which cost little.
fn coarse(mut target: Target, levels: usize) -> Target {
    target.counts.iter_mut().for_each(|row| row.truncate(levels));
    target
}

/// The table of f on `levels` grids by the plain solver, one r after the other.
fn literal(values: &[f64], measure: Measure, levels: usize) -> Table {
    let geometry = Geometry::quadrants();
    let variant = Variant::default();
    let cells: Vec<usize> = (0..levels).map(|level| COARSEST << level).collect();
    let grids = nested(&cells).unwrap();
    let f = geometry.source(values);
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, variant.load)).collect();
    let rule = if measure == Measure::Signed { StopRule::Signed } else { StopRule::Printed };
    let mut table = Table { counts: Vec::new(), delta_a: Vec::new() };
    for r in R {
        let params = Params { r, rule, max_iterations: 5000, ..Params::default() };
        let (outcomes, _) =
            solve_nested(DiscreteLevels::Grids(&grids, Law::SIGNORINI), &loads, &params, &mut ());
        table.counts.push(outcomes.iter().map(|o| Some(o.end.iterations)).collect());
        table.delta_a.push(outcomes[levels - 1].end.change());
    }
    table
}

fn target_of(table: &Table) -> Target {
    Target {
        r: R.to_vec(),
        counts: table.counts.iter().map(|row| row.iter().map(|n| n.unwrap()).collect()).collect(),
        delta_a: table.delta_a.iter().map(|d| d.max(f64::MIN_POSITIVE)).collect(),
    }
}

fn evaluator<'a>(target: &'a Target, variant: &Variant) -> Evaluator<'a> {
    Evaluator::new(target, variant, &[Geometry::quadrants()]).unwrap()
}

fn run(values: &str, target: &Target) -> SearchReport {
    target.searched(values, &Variant::default(), &AtomicBool::new(false)).unwrap()
}

/// The report of a search on so many threads.
fn run_on(threads: usize, values: &str, target: &Target) -> SearchReport {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| run(values, target))
}

proptest! {
    #![proptest_config(config(16))]

    #[test]
    fn lanes_repeat_the_literal_iteration_to_the_last_bit(
        values in prop::collection::vec(-60i32..40, 4), printed in any::<bool>(),
    ) {
        let values: Vec<f64> = values.iter().map(|&v| f64::from(v) / 10.0).collect();
        let measure = if printed { Measure::Printed } else { Measure::Signed };
        let table = literal(&values, measure, 3);
        // Where no saddle point exists, the iteration may go on for ever.
        prop_assume!(table.counts.iter().flatten().all(|n| n.is_some_and(|n| n < 5000)));
        let target = target_of(&table);
        let variant = Variant { measure, ..Variant::default() };
        let mut evaluator = evaluator(&target, &variant);
        prop_assert_eq!(evaluator.free(0, &values), table);
    }

    #[test]
    fn forced_runs_are_exact_just_where_free_runs_agree(one in -4i32..5, rest in -4i32..5) {
        let planted = [rest, one, rest, rest].map(f64::from);
        let table = literal(&planted, Measure::Signed, 3);
        prop_assume!(table.counts.iter().flatten().all(|n| n.is_some_and(|n| n < 5000)));
        let (target, geometries) = (target_of(&table), Geometry::odd_quadrants());
        let evaluator = Evaluator::new(&target, &Variant::default(), &geometries).unwrap();
        let pairs = (-4..5).flat_map(|one| (-4..5).map(move |rest| [one, rest]));
        let negative = pairs.filter(|[one, rest]| one + 3 * rest < 0);
        let all: Vec<_> = negative.map(|pair| pair.map(f64::from).to_vec()).collect();
        let exact = (0..geometries.len()).flat_map(|k| evaluator.held(k, &all));
        let exact = exact.filter(|held| !held.iter().flatten().any(|held| !held)).count();
        // The search forces its runs.
        prop_assert_eq!(run("-4:4:1", &target).exact as usize, exact);
    }
}

#[test]
fn both_published_tables_come_out_exactly() {
    for (problem, values, delta_a_exact) in [
        (1, [3.0, -1.002, -1.002, -1.002], 5),
        (1, [3.0, -1.0, -1.01, -1.0], 4),
        (2, [-6.0, 1.998, 1.998, 1.998], 4),
        (2, [-6.0, 2.0, 1.99, 2.0], 4),
    ] {
        let target = published(problem);
        let mut evaluator = evaluator(&target, &Variant::default());
        let table = evaluator.free(0, &values);
        assert_eq!(target_of(&table).counts, target.counts, "problem {problem}: {values:?}");
        let digits = |x: &f64| format!("{x:.1e}");
        let same =
            table.delta_a.iter().zip(&target.delta_a).filter(|(a, b)| digits(a) == digits(b));
        assert_eq!(same.count(), delta_a_exact, "problem {problem}: {:?}", table.delta_a);
    }
}

/// As the book says: only Table 2 tells whether the gradient is taken before or after the dual step.
#[test]
fn table_1_also_comes_out_with_the_gradient_before_the_dual_step() {
    let before = Variant { residual: ResidualTime::BeforeDual, ..Variant::default() };
    for (problem, values, exact) in
        [(1, [3.0, -1.002, -1.002, -1.002], true), (2, [-6.0, 1.998, 1.998, 1.998], false)]
    {
        let target = published(problem);
        let table = evaluator(&target, &before).free(0, &values);
        assert_eq!(target_of(&table).counts == target.counts, exact);
    }
}

#[test]
fn all_f_with_all_counts_are_found_and_those_with_the_right_delta_a_come_first() {
    let target = published(2);
    let report = run("-6.01:2:0.005", &target);
    assert!(report.complete && report.exact as usize == report.found.len());
    for found in &report.found {
        assert_eq!((found.exact, found.cells), (25, 25));
        assert!(
            found.integral < 0.0,
            "the integral of -6, 2, 2, 2 vanishes, so that (2) excludes it"
        );
    }
    // As the record says of this step, with the shortest of those that have four values of Delta a first.
    let all: Vec<_> = report.found.iter().map(|found| (&*found.f, found.delta_a_exact)).collect();
    assert!(all.is_sorted_by_key(|(f, exact)| (std::cmp::Reverse(*exact), f.len())), "{all:?}");
    for known in ["-6.005; else=2", "-5.98; else=1.99", "-5.975; else=1.99", "-5.99; else=1.995"] {
        assert!(all.iter().any(|(f, _)| *f == format!("quadrant(ll)={known}")), "{known}: {all:?}");
    }
}

/// Plants f, hides it, and searches the table of its first three grids.
#[test]
fn a_planted_f_or_an_equivalent_one_is_recovered() {
    let on_quadrant = |[one, rest]: [f64; 2]| [rest, one, rest, rest];
    for planted in [[-4.0, 1.0], [2.5, -1.5], [-3.5, 0.5]] {
        let target = target_of(&literal(&on_quadrant(planted), Measure::Signed, 3));
        let report = run("-4:4:0.5", &target);
        assert!(!report.found.is_empty(), "planted {planted:?}");
        for best in report.found {
            let f: signorini_mathematics::problem::source::Source = best.f.parse().unwrap();
            let quadrants = [[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]];
            let again = literal(&quadrants.map(|point| f.at(point)), Measure::Signed, 3);
            assert_eq!(target_of(&again).counts, target.counts);
        }
    }
}

#[test]
fn candidates_that_reach_a_grid_have_all_counts_on_the_coarser_ones() {
    let all = run("-8:4:0.1", &published(2));
    assert_eq!(all.reached[0], all.tried);
    for grids in 1..5 {
        let coarse = run("-8:4:0.1", &coarse(published(2), grids));
        assert_eq!(coarse.reached, all.reached[..grids]);
        assert_eq!(coarse.exact, all.reached[grids]);
    }
}

#[test]
fn reports_do_not_depend_on_threads() {
    let target = coarse(published(2), 1);
    // Several batches of items.
    for values in ["-8:4:0.02", "-8:4:0.1"] {
        let once = run_on(1, values, &target);
        assert!(once.complete && !once.found.is_empty());
        assert_eq!(once, run_on(3, values, &target));
    }
}

#[test]
fn searches_stop_in_the_midst_of_a_candidate() {
    // More iterations than anybody waits for: what ends must have looked at the flag between two.
    let mut target = coarse(published(2), 2);
    target.counts.iter_mut().for_each(|row| row[0] = 1_000_000_000_000);
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let searching =
            scope.spawn(|| target.searched("-6:2:1", &Variant::default(), &stop).unwrap());
        stop.store(true, Ordering::Relaxed);
        let report = searching.join().unwrap();
        assert!(!report.complete && report.found.is_empty(), "{report:?}");
    });
}

#[test]
fn a_raised_flag_keeps_what_was_found() {
    let (target, values) = (coarse(published(2), 2), "-8:4:0.05");
    let (all, stop) = (run(values, &target), AtomicBool::new(false));
    std::thread::scope(|scope| {
        let searching =
            scope.spawn(|| target.searched(values, &Variant::default(), &stop).unwrap());
        std::thread::sleep(std::time::Duration::from_millis(20));
        stop.store(true, Ordering::Relaxed);
        let report = searching.join().unwrap();
        assert!(report.exact <= all.exact && report.tried <= all.tried, "{report:?}");
        assert_eq!(report.complete, report == all);
        assert_eq!(report.exact == 0, report.found.is_empty());
    });
}

#[test]
fn counts_are_held_where_free_runs_give_them() {
    let target = published(2);
    let mut evaluator = evaluator(&target, &Variant::default());
    // More f than lanes; the last goes on and on.
    let moved = |k: i32| vec![-6.0 + 0.0155 * f64::from(k), 1.998, 1.998, 1.998];
    let all: Vec<_> = (-4..5).map(moved).chain([vec![9.0; 4]]).collect();
    let held = evaluator.held(0, &all);
    for (values, held) in all.iter().zip(&held) {
        let counts = evaluator.free(0, values).counts;
        let rows = counts.iter().zip(&target.counts);
        let same = rows.map(|(ours, published)| {
            ours.iter().zip(published).map(|(ours, n)| *ours == Some(*n)).collect::<Vec<_>>()
        });
        assert_eq!(*held, same.collect::<Vec<_>>(), "{values:?}");
    }
    // At -5.969 the counts for the largest r are 2, 4, 7, 15, 35: a first miss starts the next grid elsewhere.
    assert_eq!(all[6][0], -5.969);
    assert_eq!(held[6][0], [false, false, true, false, false]);
}

#[test]
fn room_ends_where_a_count_changes() {
    let target = published(2);
    let values = [-6.0, 2.0, 2.0, 2.0];
    let evaluator = evaluator(&target, &Variant::default());
    let map = identifiability(&evaluator, &values);
    assert_eq!((map.exact, map.directions.len()), (25, 5));
    for (piece, breaks) in map.directions.iter().enumerate() {
        for (side, sign) in [(&breaks.down, -1.0), (&breaks.up, 1.0)] {
            let moved = |by: f64| -> Vec<f64> {
                let shift = |(p, v): (usize, &f64)| match &breaks.quadrant {
                    Some(_) if piece == p => v + sign * by,
                    Some(_) => *v,
                    None => v * (1.0 + sign * by),
                };
                values.iter().enumerate().map(shift).collect()
            };
            let within = literal(&moved(0.99 * side.range), Measure::Signed, 5);
            assert_eq!(target_of(&within).counts, target.counts);
            let first = side.first.unwrap();
            let k = R.iter().position(|r| *r == first.r).unwrap();
            let level = (first.cells / COARSEST).ilog2() as usize;
            let beyond = literal(&moved(1.02 * side.range + 1e-5), Measure::Signed, 5);
            assert_ne!(beyond.counts[k][level], Some(target.counts[k][level]), "{breaks:?}");
        }
    }
    // No move is shorter than the shortest that changes any count.
    let shortest = map.directions[..4].iter().flat_map(|breaks| [&breaks.down, &breaks.up]);
    let shortest = shortest.map(|side| side.range).reduce(f64::min).unwrap();
    let moves = map.holds.iter().flat_map(|row| &row.moves);
    let least = moves.flatten().copied().reduce(f64::min).unwrap();
    assert!(least <= shortest && 1.25 * least > shortest, "{least} {shortest}");
    assert!(map.loose < 25 && map.percent == 0.06, "{map:?}");
    let plane = slice(&evaluator, &values, [0, 3], [0.1; 2], 5);
    assert_eq!(plane.exact[2][2], 25);
    assert!(plane.exact[0][0] < 25);
    let below = slice(&evaluator, &[-6.0, 1.986, 1.986, 1.986], [0, 3], [0.0; 2], 1);
    assert_eq!(below.exact, [[20]], "a forced run would give 22");
}

#[test]
fn tables_that_are_none_are_refused() {
    let bad = |change: &dyn Fn(&mut Target)| {
        let mut target = published(1);
        change(&mut target);
        target.validate().unwrap_err()
    };
    assert_eq!(bad(&|t| t.r.truncate(4)), IdentifyError::Ragged);
    assert_eq!(bad(&|t| t.counts[2].truncate(4)), IdentifyError::Ragged);
    assert_eq!(bad(&|t| t.counts[2][0] = 0), IdentifyError::NotPositive(3));
    assert_eq!(bad(&|t| t.r.clear()), IdentifyError::Rows(0));
}
