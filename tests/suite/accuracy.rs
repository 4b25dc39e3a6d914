//! Errors against known solutions, the record of times, and the command that makes it.

use crate::common::{Project, TABLE};
use signorini::timing::recorded::{GOALS, PATH, PUBLISHED, Timings, number, text};
use signorini_mathematics::experiments::timed::TimedPlan;
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::statement::{Domain, Fineness, Statement};
use std::process::{Command, Output};

#[test]
fn slopes_are_those_of_linear_elements() {
    for exact in Exact::ALL {
        let [coarse, fine] = [64, 128].map(|cells| {
            let f = format!("exact({})", exact.name());
            let usual = Statement::usual(Domain::square(), f);
            let solved = Statement { fineness: Fineness::Width(cells), ..usual }.solved(None);
            solved.unwrap().errors().unwrap()
        });
        for (coarse, fine, slope) in
            [(coarse.l2, fine.l2, 2.0), (coarse.h1, fine.h1, 1.0), (coarse.max, fine.max, 2.0)]
        {
            let found = (coarse / fine).log2();
            assert!((found - slope).abs() < 0.05, "{exact:?}: {found} for {slope}");
        }
    }
}

fn bench(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_signorini"));
    command.arg("bench").args(args).output().unwrap()
}

#[test]
fn each_run_that_is_timed_reaches_its_goal() {
    let output = bench(&["--quick", "--json", "--finest", "32", "--repeats", "1"]);
    assert!(output.status.success(), "{output:?}");
    let timings: Timings = serde_json::from_slice(&output.stdout).unwrap();
    // A column that is missing, or that nobody knows, is an error.
    assert_eq!(Timings::parse(timings.to_toml()).unwrap(), timings);
    assert!(!timings.spectral.is_empty() && !timings.adapted.is_empty());
    assert_eq!(timings.multigrid.texts("goal").unwrap(), GOALS);
    for row in timings.solver.iter() {
        let goal = text(row, "goal");
        let residual = match goal.strip_prefix("relative KKT ") {
            Some(target) => target.parse().unwrap(),
            // The published rule says nothing about the residual.
            None if goal == PUBLISHED => f64::INFINITY,
            None if goal == "discretisation error" => 1.0,
            None => 1e-10,
        };
        assert!(number(row, "kkt") <= residual, "{row:?}");
    }
    let on_grid = timings.solver.wherever("cells", 16).unwrap();
    for problem in timings.solver.texts("problem").unwrap() {
        for solver in Solver::on_grids() {
            let rows = on_grid.wherever("problem", problem).unwrap();
            let rows = rows.wherever("solver", solver.to_string()).unwrap();
            let goals = if solver.is_nested() { 5 } else { 1 };
            assert!(rows.len() >= goals, "{rows:?}");
            let least = rows
                .iter()
                .map(|row| number(row, "error") / number(row, "discretisation"))
                .fold(f64::INFINITY, f64::min);
            assert!(least <= TimedPlan::REACHED, "{rows:?}");
        }
    }
}

#[test]
fn f_of_a_paper_problem_is_that_of_its_scene() {
    let project = Project::with(TABLE);
    let scene = "title = \"t\"\npaper_table = 1\nf = \"formula(abs(x)-1)\"\noutputs = []\n";
    project.scene("first", scene);
    let said = project.run(&["bench", "--quick", "--solver", "spectral"]);
    let why = "error: problem 1: f is no polynomial in x and y: abs of x or y is in it; `bench` takes f from the scenes";
    assert!(said.refusal().starts_with(why), "{said:?}");
}

#[test]
fn a_record_keeps_what_was_entered_by_hand() {
    let project = Project::with(TABLE);
    project.write(PATH, format!("{RECORD}{PEER}{OWN_MESH}{ADAPTED}"));
    let said = project.run(&["bench", "--record", "--finest", "16", "--repeats", "1"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let after = Timings::parse(std::fs::read_to_string(project.path(PATH)).unwrap()).unwrap();
    assert_eq!((after.peer.len(), text(&after.peer[0], "solver")), (1, "other"));
    assert_eq!((after.own_mesh.len(), text(&after.own_mesh[0], "mesh")), (1, "disc"));
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
    assert_eq!(number(&more.own_mesh[0], "theirs"), 8.0);
    assert_eq!(text(&more.adapted[0], "way"), "adaptive");
    assert_eq!(Timings::parse(more.to_toml()).unwrap(), more);
    for (record, old, new, what) in [
        (OWN_MESH, "ours = 2", "ours = 0", "not a positive number"),
        (ADAPTED, "adaptive", "other", "unknown variant"),
        (ADAPTED, "nodes = 40", "nodes = 40.5", "not a natural number"),
        (PEER, "ours = 1\n", "", "missing field `ours`"),
        (PEER, "ours = 1\n", "ours = 1\nfaster = true\n", "unknown field `faster`"),
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
fn the_record_of_the_project_is_written_as_it_is_read() {
    let text = include_str!("../../pipeline/timings.toml");
    let written = Timings::parse(text).unwrap().to_toml();
    // What was entered by hand has other digits.
    let [old, new] = [text, &written].map(|text| text.split("[[peer]]").next());
    assert!(old == new && written.lines().count() == text.lines().count());
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
