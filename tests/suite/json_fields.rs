//! Fields of real answers in JSON, beside the tables of fields in the book.

use crate::common::{PAPER, Project, TABLE};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;

/// Paths of fields, with a colon before each that is one of the field before.
type Fields = BTreeSet<String>;

/// Fields whose values are settings by name, of which each has fields of its own.
const OPEN: [&str; 1] = ["own_mesh"];

/// Objects whose fields are ids.
const BY_ID: &str = "tasks";

/// Adds the fields of an answer.
fn add(fields: &mut Fields, path: &str, value: &Value) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| add(fields, path, value)),
        Value::Object(map) if path == BY_ID && !map.contains_key("id") => {
            let is_verdict = map.contains_key("state");
            for (name, value) in map {
                let path = if is_verdict { format!("{path}: {name}") } else { path.to_owned() };
                fields.extend(is_verdict.then(|| path.clone()));
                add(fields, &path, value);
            }
        }
        Value::Object(map) => {
            for (name, value) in map {
                let path = if path.is_empty() { name.clone() } else { format!("{path}: {name}") };
                fields.insert(path.clone());
                if !OPEN.contains(&&*path) {
                    add(fields, &path, value);
                }
            }
        }
        _ => (),
    }
}

fn fields_of(answers: &[Value]) -> Fields {
    let mut fields = Fields::new();
    for answer in answers {
        assert_eq!(answer["schema"], 1, "{answer}");
        add(&mut fields, "", answer);
    }
    fields.remove("schema");
    fields
}

/// Fields in the rows of a table of the book of which one column, the first or the second, names this command or form
/// of an answer.
fn documented(table: &str, [column, fields]: [usize; 2], of: &str) -> Fields {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/report/templates/fields.md.tera");
    let page = fs::read_to_string(path).unwrap();
    let (_, table) = page.split_once(&format!("table name=\"{table}\"")).unwrap();
    let (table, _) = table.split_once("{% </table> %}").unwrap();
    let mut found = Fields::new();
    for row in table.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        if cells[column].split(", ").any(|name| name.trim_matches('`') == of) {
            found.extend(paths(cells[fields]));
        }
    }
    found
}

/// Paths of the fields in a cell, as `` `a`: `b`, `c` ``.
fn paths(cell: &str) -> Fields {
    let (mut found, mut paths) = (Fields::new(), vec![String::new()]);
    for names in cell.split(": ") {
        let mut longer = Vec::new();
        for path in &paths {
            for name in names.split(", ") {
                let name = name.strip_prefix('`').and_then(|name| name.strip_suffix('`'));
                let name = name.unwrap_or_else(|| panic!("{cell}"));
                longer.push(if path.is_empty() { name.into() } else { format!("{path}: {name}") });
            }
        }
        found.extend(longer.iter().cloned());
        paths = longer;
    }
    found
}

/// Fields of an answer that the book has for a form: `J`, `S` or `R`.
fn of_answers(form: &str) -> Fields {
    documented("fields", [1, 0], form)
}

/// Fields that the book has for the JSON of a command.
fn of_command(command: &str) -> Fields {
    documented("json", [0, 1], command)
}

/// Requires the same fields in answers and in the book.
#[track_caller]
fn agree(answers: &[Value], documented: &Fields) {
    let found = fields_of(answers);
    let unknown: Vec<_> = found.difference(documented).collect();
    assert!(unknown.is_empty(), "fields without a line in the book: {unknown:?}");
    let gone: Vec<_> = documented.difference(&found).collect();
    assert!(gone.is_empty(), "lines of the book without a field: {gone:?}");
}

#[test]
fn each_field_of_solve_has_a_line_in_the_book_and_each_line_a_field() {
    let project = Project::with(TABLE);
    let mut answers = vec![project.answer("a --r 3")];
    for options in [
        "--h 1/16 --solver arrow-hurwicz --stop signed",
        "--h 1/16 --solver uzawa",
        "--h 1/16 --solver uzawa-proximal",
        "--h 1/16 --solver active-set",
        "--h 1/16 --solver multigrid --tolerance 1e-6",
        "--h 1/16 --friction 0.4",
        "--h 1/16 --limit 3",
        "--friction 0.4 --solver spectral",
        "--solver spectral",
        "--accuracy 0.5",
        "--accuracy-energy 0.1",
        "--h 1/16 --max-iterations 1 --at 0.1,0.2",
    ] {
        answers.push(project.answer(&format!("--f 'rect(0,0.25,0,0.25)=4; else=-1.5' {options}")));
    }
    let mesh = "--f 'halfplane(0,1,0)=-3; else=1.5'";
    for problem in [
        // Points miss a part of f, so that there is no bound.
        "--f 'formula(-1+2.5e3*exp(-1e4*((x-0.1)^2+(y-0.13)^2)))' --h 1/8",
        "--domain disc --f else=-1 --solver spectral",
        "--f 'exact(torsion)' --h 1/8",
        "--f 'formula(x - 1)' --h 1/8 --out v.npy",
        &format!("--domain disc {mesh} --refine 2"),
        &format!("--domain disc {mesh} --accuracy 0.3"),
        "--domain lshape --f else=-1 --accuracy-energy 0.1",
        &format!("--domain disc {mesh} --refine 2 --solver arrow-hurwicz"),
        "--domain annulus --f else=-1 --refine 1 --friction 2",
        "--domain cube --f 'ball(0,0,0,0.25)=2; else=-1' --h 1/4",
        "--domain cube --f 'exact(free-disc)' --h 1/4",
    ] {
        answers.push(project.answer(problem));
    }
    let mut known = of_answers("J");
    // Of members of studies alone.
    assert!(known.remove("varied"));
    agree(&answers, &known);
    // A field that is null says why.
    for answer in &answers {
        for name in ["bound", "contact", "grids"] {
            assert_eq!(answer[name].is_null(), answer[format!("{name}_reason")].is_string());
        }
    }
}

#[test]
fn each_field_of_other_commands_has_a_line_in_the_book_and_each_line_a_field() {
    let project = Project::with(&format!("paper_table = 1\n{TABLE}"));
    project.scene("broken", "title = 1\n");
    let list = project.run(&["list", "--json"]).json();
    assert_eq!(list["broken"].as_array().unwrap().len(), 1);
    agree(&[list], &of_command("list"));
    fs::remove_file(project.path("pipeline/scenes/broken.toml")).unwrap();

    agree(&[project.run(&["dag", "--json"]).json()], &of_command("dag"));
    let never = project.run(&["status", "--json"]).json();
    let explained = project.run(&["explain", "solve", "--json"]).json();
    agree(&[project.run(&["diff", "--json"]).json(), capped()], &of_command("diff"));
    project.run(&["run"]).lines();
    let fresh = project.run(&["status", "--json"]).json();
    project.scene("a", &format!("paper_table = 1\n{}", TABLE.replace("else=-1", "else=-2")));
    let changed = project.run(&["status", "--json"]).json();
    agree(&[never, fresh, changed], &of_command("status"));
    let changed = project.run(&["explain", "solve", "--json"]).json();
    let waits = project.run(&["explain", "tabulate", "--json"]).json();
    agree(&[explained, changed, waits], &of_command("explain"));
}

/// Answer of `diff` to a table with a count that was cut off.
fn capped() -> Value {
    let scene = format!("paper_table = 1\nmax_iterations = 1\n{TABLE}");
    let project = Project::with(&scene);
    project.write("pipeline/paper.toml", PAPER);
    project.run(&["diff", "--json"]).json()
}

#[test]
fn each_column_of_studies_and_results_has_a_line_in_the_book_and_each_line_a_column() {
    let project = Project::with(TABLE);
    project.add_book("# One\n");
    project.run(&["run"]).lines();
    let study = ["solve", "--f", "else=-1", "--vary", "h=4,8", "--csv", "s.csv"];
    project.run(&study).lines();
    for (form, file) in [("R", "report/results.csv"), ("S", "s.csv")] {
        let text = project.read(file);
        let header = text.lines().next().unwrap().split(',').map(str::to_owned);
        let columns: Fields = header.filter(|name| form == "R" || name != "h").collect();
        assert_eq!(columns, of_answers(form), "{form}");
    }
}
