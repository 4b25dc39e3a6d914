//! Studies: options, scenes and saved scenes, interrupts, and what studies of this project find.

use crate::common::{Project, Said, TABLE, rows, send, wait_for_handler};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

const F: &str = "halfplane(1,0,0)=8; else=-9";
const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Project with the study `s`, of this f and these lines.
fn with(f: &str, lines: &str) -> Project {
    let project = Project::with(TABLE);
    project.scene("s", &format!("title = \"t\"\nf = \"{f}\"\n{lines}\n"));
    project
}

/// Study of four members, one of which has no solution.
fn four() -> Project {
    let lines = "vary = { friction = [0.1, 1], h = [\"1/8\", 16] }\noutputs = [\"table\", \"chart\"]\n\
        chart = { x = \"friction\", y = \"force\", log = [\"x\"] }";
    with(F, lines)
}

#[test]
fn options_scenes_and_saved_scenes_are_one_study() {
    let project = four();
    let options = format!("solve --f '{F}' --vary friction=0.1,1 --vary h=1/8,16");
    project.line(&format!("{options} --save saved --csv by-options.csv")).lines();
    project.run(&["run", "-k", "s", "saved"]).lines();
    project.run(&["solve", "saved", "--csv", "of-scene.csv"]).lines();
    let csv = project.read("by-options.csv");
    for path in ["report/tables/s.csv", "report/tables/saved.csv", "of-scene.csv"] {
        assert_eq!(project.read(path), csv, "{path}");
    }
    let json = project.line(&format!("{options} --json"));
    let lines: Vec<Value> = json.lines().iter().map(|line| line.parse().unwrap()).collect();
    assert_eq!(lines.len(), 4);
    assert_eq!([&lines[2]["friction"], &lines[2]["h"]], [&1.into(), &Value::from(0.125)]);
    assert_eq!(lines[2]["energy"].to_string(), rows(&csv)[2]["energy"]);
}

/// Study of so many members.
fn of(members: usize) -> Project {
    let values: Vec<_> = (1..=members).map(|k| format!("{}", 1.0 + k as f64 / 1000.0)).collect();
    let values = values.join(", ");
    with(F, &format!("h = \"1/4\"\nvary = {{ friction = [{values}] }}\noutputs = [\"table\"]"))
}

#[test]
fn killed_and_interrupted_studies_go_on_where_they_were() {
    let whole = of(200);
    whole.run(&["run", "s"]).lines();
    let table = fs::read(whole.path("report/tables/s.csv")).unwrap();
    for signal in ["KILL", "INT"] {
        let project = of(200);
        let mut command = project.command(&["run", "-v", "-j", "1", "s"]);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        wait_for_handler(&child);
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let ran =
            lines.by_ref().filter(|l| l.as_ref().is_ok_and(|l| l.starts_with("ran "))).take(20);
        assert_eq!(ran.count(), 20);
        send(signal, &child);
        let before = 20 + lines.filter(|l| l.as_ref().is_ok_and(|l| l.starts_with("ran "))).count();
        child.wait().unwrap();
        let after = project.run(&["run", "-v", "s"]).ran().len();
        // The member at work when a run is killed may be solved again.
        assert!((200..=202).contains(&(before + after)) && after < 185, "{before} + {after}");
        assert_eq!(fs::read(project.path("report/tables/s.csv")).unwrap(), table, "{signal}");
    }
}

/// Rows of a study, of this project or of options.
fn rows_of_own(study: &[&str]) -> Vec<Value> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_signorini"));
    command.args(["solve", "--json"]).args(study).current_dir(ROOT);
    let said = Said::from(command.output().unwrap());
    said.lines().iter().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn errors_on_the_cube_fall_at_the_optimal_rate() {
    let f = "f=exact(full-contact)|exact(free-strip)|exact(free-disc)";
    let rows = rows_of_own(&["--domain", "cube", "--vary", f, "--vary", "h=16,32"]);
    assert_eq!(rows.len(), 6);
    for meshes in rows.chunks(2) {
        for (column, order, reach) in
            [("error_l2", 2.0, 0.1), ("error_h1", 1.0, 0.05), ("error_max", 2.0, 0.2)]
        {
            let [coarse, fine] = [0, 1].map(|k| meshes[k][column].as_f64().unwrap());
            let found = (coarse / fine).log2();
            assert!((found - order).abs() < reach, "{column} {found}: {}", meshes[1]);
        }
    }
}

#[test]
fn arcs_that_stick_shrink_exponentially_as_friction_gets_weaker() {
    let rows = rows_of_own(&["arcs"]);
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
    // Two arcs of equal length.
    let lengths: Vec<f64> = rows.iter().map(|row| number(row, "contact_length") / 2.0).collect();
    assert!(lengths.len() == 7 && lengths[0] > 1e-2 && lengths[6] < 1e-4, "{lengths:?}");
    for pair in rows.windows(2) {
        let [one, next] = [&pair[0], &pair[1]];
        let fall = number(one, "contact_length") / number(next, "contact_length");
        let rate = fall.ln() / (1.0 / number(next, "friction") - 1.0 / number(one, "friction"));
        assert!((5.5..7.5).contains(&rate), "{rate}: {one} {next}");
    }
}
