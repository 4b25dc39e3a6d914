//! The accuracy experiment, the record of times, and the command that makes it.

use crate::common::{Project, TABLE, paper_problems};
use crate::solvers::{ALGEBRAIC, HARD_WORK_UNITS, TEXTBOOK, WORK_UNITS, on_threads};
use signorini::timing::recorded::{Goal, PATH, PUBLISHED, Timings};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::experiments::accuracy::{AccuracyFindings, AccuracyPlan, accuracy};
use signorini_mathematics::experiments::adapted::Way;
use signorini_mathematics::experiments::work::REACHED;
use signorini_mathematics::solvers::Solver;
use std::collections::BTreeSet;
use std::process::{Command, Output};
use std::sync::OnceLock;

fn findings() -> &'static AccuracyFindings {
    static ONCE: OnceLock<AccuracyFindings> = OnceLock::new();
    ONCE.get_or_init(|| {
        let plan = AccuracyPlan {
            problems: paper_problems(),
            cells: vec![16, 32, 64, 128],
            contact: vec![16, 32, 64, 128],
            others: vec![64],
            laws: vec![("exact(free-corner)".into(), vec![16, 32, 64])],
            compared: vec![8, 16, 32],
        };
        accuracy(&plan).unwrap()
    })
}

#[test]
fn slopes_are_those_of_linear_elements() {
    assert_eq!(findings().problems.len(), 6);
    for problem in &findings().problems {
        for level in &problem.levels[1..] {
            let orders = level.orders.unwrap();
            assert!((orders.h1 - 1.0).abs() < 0.05, "{} {orders:?}", problem.name);
            match orders.l2 {
                Some(l2) => {
                    assert!((l2 - 2.0).abs() < 0.05, "{} {orders:?}", problem.name);
                    assert!(orders.multiplier_l2 > 0.9, "{} {orders:?}", problem.name);
                }
                // Where f jumps: h^2 |log h|.
                None => assert!(orders.max > 1.5, "{} {orders:?}", problem.name),
            }
        }
    }
}

#[test]
fn multigrid_takes_few_work_units() {
    let ranges = &findings().ranges;
    assert!(ranges.work[0].known.greatest < TEXTBOOK, "{ranges:?}");
    assert!(ranges.algebraic.iter().all(|ratio| *ratio <= ALGEBRAIC), "{ranges:?}");
    for (work, (usual, hard)) in ranges.work.iter().zip(WORK_UNITS.into_iter().zip(HARD_WORK_UNITS))
    {
        assert!(work.known.greatest < usual && work.others.greatest < hard, "{ranges:?}");
    }
    for level in findings().problems.iter().flat_map(|problem| &problem.levels) {
        assert_eq!(level.cost.goals[2].stop, Stop::RoundingFloor);
        assert!(level.cost.residuals[1] <= 1e-10);
    }
}

#[test]
fn sweeps_grow_like_the_inverse_square_of_the_width() {
    for law in findings().laws.iter().filter(|law| !law.nested) {
        assert!((law.exponent.unwrap() - 2.0).abs() < 0.25, "{law:?}");
    }
    // On the finest grid multigrid takes far less, and each method has reached the error on each grid.
    let rows = &findings().comparison.rows;
    assert_eq!(rows.len(), 3);
    assert!(rows[2].arrow_hurwicz.min(rows[2].uzawa) > 20.0 * rows[2].multigrid, "{rows:?}");
}

#[test]
fn the_experiment_depends_on_no_thread_count() {
    let plan = AccuracyPlan {
        problems: paper_problems(),
        cells: vec![8, 16],
        // Fine enough for several threads.
        contact: vec![8, 256],
        others: vec![16],
        laws: Vec::new(),
        compared: vec![4, 8],
    };
    let found = || serde_json::to_string(&accuracy(&plan).unwrap()).unwrap();
    assert_eq!(on_threads(1, found), on_threads(3, found));
}

fn bench(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_signorini"));
    command.arg("bench").args(args).output().unwrap()
}

#[test]
fn each_run_that_is_timed_reaches_its_goal() {
    let output = bench(&["--quick", "--json", "--finest", "32", "--repeats", "1"]);
    assert!(output.status.success(), "{output:?}");
    // A field that is missing, or that nobody knows, is an error.
    let timings: Timings = serde_json::from_slice(&output.stdout).unwrap();
    assert!(!timings.spectral.is_empty() && !timings.adapted.is_empty());
    assert!(Goal::ALL.iter().all(|goal| timings.multigrid.iter().any(|line| line.goal == *goal)));
    for line in &timings.solver {
        let residual = match line.goal.strip_prefix("relative KKT ") {
            Some(target) => target.parse().unwrap(),
            // The published rule says nothing about the residual.
            None if line.goal == PUBLISHED => f64::INFINITY,
            None if line.goal == Goal::Discretisation.in_words() => 1.0,
            None => 1e-10,
        };
        assert!(line.kkt <= residual, "{line:?}");
    }
    let problems: BTreeSet<_> = timings.solver.iter().map(|line| &line.problem).collect();
    for (problem, solver) in
        problems.iter().flat_map(|p| Solver::on_grids().into_iter().map(|s| (*p, s)))
    {
        let lines = timings.solver.iter().filter(|line| line.solver == solver && line.cells == 16);
        let lines: Vec<_> = lines.filter(|line| line.problem == *problem).collect();
        let goals = if solver.is_nested() { 5 } else { 1 };
        assert!(lines.len() >= goals, "{lines:?}");
        let least =
            lines.iter().map(|line| line.error / line.discretisation).fold(f64::INFINITY, f64::min);
        assert!(least <= REACHED, "{lines:?}");
    }
    assert_eq!(Timings::parse(timings.to_toml()).unwrap(), timings);
}

#[test]
fn f_of_a_paper_problem_is_that_of_its_scene() {
    let project = Project::with(TABLE);
    let scene = "title = \"t\"\npaper_table = 1\nf = \"formula(x-1)\"\noutputs = []\n";
    project.scene("first", scene);
    let said = project.run(&["bench", "--quick", "--solver", "spectral"]);
    let why =
        "error: problem 1: f must consist of constant pieces; `bench` takes f from the scenes";
    assert!(said.refusal().starts_with(why), "{said:?}");
}

#[test]
fn a_record_keeps_what_was_entered_by_hand() {
    let project = Project::with(TABLE);
    project.write(PATH, format!("{RECORD}{PEER}{OWN_MESH}{ADAPTED}"));
    let said = project.run(&["bench", "--record", "--finest", "16", "--repeats", "1"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let after = Timings::parse(std::fs::read_to_string(project.path(PATH)).unwrap()).unwrap();
    assert_eq!((after.peer.len(), &after.peer[0].solver[..]), (1, "other"));
    assert_eq!((after.own_mesh.len(), &after.own_mesh[0].mesh[..]), (1, "disc"));
    // Measured anew.
    let by_hand = Timings::parse(format!("{RECORD}{ADAPTED}")).unwrap();
    assert!(!after.adapted.contains(&by_hand.adapted[0]));
    project.write(PATH, "schema = 1");
    let said = project.run(&["bench", "--record"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("line 1"), "{said:?}");
}

const RECORD: &str = "schema = 1\nbandwidth = 20\n[machine]\ncpu = \"c\"\n\
    cores = 2\ncaches = \"\"\nos = \"o\"\nrustc = \"r\"\nload = 0.1\nrepeats = 9\n";
const PEER: &str = "[[peer]]\nsolver = \"other\"\nf = \"else=-1\"\ncells = 8\ntheirs = 1\n\
    their_kkt = 1e-9\nours = 1\nour_kkt = 1e-9\n";
const OWN_MESH: &str = "[[own_mesh]]\nmesh = \"disc\"\nnodes = 9\nsolver = \"other\"\ntheirs = 8\n\
    their_kkt = 1e-9\nours = 2\nour_kkt = 1e-12\n";
const ADAPTED: &str = "[[adapted]]\nproblem = \"L-shape\"\nway = \"adaptive\"\nnodes = 40\n\
    error = 0.3\nseconds = 1e-3\n";

#[test]
fn a_spoilt_record_is_refused_with_line_and_remedy() {
    let good = RECORD;
    assert!(Timings::parse(good).is_ok());
    let more = Timings::parse(format!("{good}{PEER}{OWN_MESH}{ADAPTED}")).unwrap();
    assert_eq!([more.peer.len(), more.own_mesh.len(), more.adapted.len()], [1; 3]);
    assert_eq!((more.own_mesh[0].theirs, more.adapted[0].way), (8.0, Way::Adaptive));
    assert_eq!(Timings::parse(more.to_toml()).unwrap(), more);
    for (record, old, new, what) in [
        (OWN_MESH, "ours = 2", "ours = 0", "not a positive number"),
        (ADAPTED, "adaptive", "other", "unknown variant"),
    ] {
        let message = Timings::parse(format!("{good}{}", record.replace(old, new))).unwrap_err();
        assert!(message.to_string().contains(what), "{message}");
    }
    for (old, new, line, what) in [
        ("bandwidth = 20", "bandwidth = -1", 2, "not a positive number"),
        ("bandwidth = 20", "bandwidth = nan", 2, "not a positive number"),
        ("cores = 2", "cores = \"two\"", 5, "invalid type"),
        ("load = 0.1", "lord = 0.1", 9, "unknown field"),
    ] {
        let message = Timings::parse(good.replace(old, new)).unwrap_err().to_string();
        assert!(message.starts_with(&format!("{PATH}: line {line}: ")), "{message}");
        assert!(message.contains(what) && message.contains("bench --record"), "{message}");
    }
    let message = Timings::parse(good.replace("schema = 1", "schema = 2")).unwrap_err();
    assert!(message.to_string().contains("schema 2"), "{message}");
    let message = Timings::parse(b"schema = 1 # \xff").unwrap_err();
    assert!(message.to_string().contains("save it as UTF-8"), "{message}");
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    for (args, remedy) in [
        (&["--finest", "100"][..], "power of two"),
        (&["--repeats", "0"], "at least 1"),
        (&["--record", "--quick"], "--quick"),
        (&["--solver", "simplex"], "possible values"),
    ] {
        let output = bench(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains(remedy), "{message}");
    }
}
