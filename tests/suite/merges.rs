//! What `git` leaves behind: conflicts of a merge, and a project cleaned between runs.

use crate::common::{Project, wanting};
use std::fs;

/// A scene with a table and a picture.
fn project() -> Project {
    Project::with(&scene(1))
}

fn scene(value: u8) -> String {
    wanting("[\"table\", \"source\"]").replace("else=-1", &format!("else=-{value}"))
}

/// Two versions of a text, as a merge in conflict leaves them.
fn conflict(ours: &str, theirs: &str) -> String {
    format!("<<<<<<< HEAD\n{ours}=======\n{theirs}>>>>>>> other\n")
}

#[test]
fn a_conflict_is_named_with_a_remedy_that_works() {
    let project = project();
    project.run(&["run"]).lines();
    let files = ["pipeline/lock.toml", "figures/a-source.svg"];
    let ours = files.map(|file| fs::read_to_string(project.path(file)).unwrap());
    project.scene("a", &scene(2));
    project.run(&["run"]).lines();
    for (file, ours) in files.iter().zip(&ours) {
        let theirs = fs::read_to_string(project.path(file)).unwrap();
        project.write(file, conflict(ours, &theirs));
    }
    for file in files {
        let refusal = project.run(&["run"]);
        let line = refusal.refusal();
        assert!(
            line.contains(file)
                && line.ends_with("has a conflict of a merge; delete it and run again"),
            "{line}"
        );
        fs::remove_file(project.path(file)).unwrap();
    }
    project.run(&["run"]).lines();
    // Only people can resolve it in what they wrote.
    project.scene("a", &conflict(&scene(1), &scene(2)));
    let refusal = project.run(&["run"]);
    assert!(refusal.refusal().contains("scene `a`: line 1: conflict of a merge"), "{refusal:?}");
}

#[test]
fn a_page_with_a_conflict_is_not_published() {
    let project = project();
    project.add_book(&format!("# One\n\n{}", conflict("a\n", "b\n")));
    let said = project.run(&["run"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("report/templates/one.md: line 3: conflict of a merge"), "{said:?}");
}

#[test]
fn files_without_a_record_are_not_said_to_be_edited() {
    let project = project();
    project.run(&["run"]).lines();
    let lock = fs::read(project.path("pipeline/lock.toml")).unwrap();
    project.scene("a", &scene(2));
    project.run(&["run"]).lines();
    // `git checkout pipeline`, `git clean -fdx`.
    project.scene("a", &scene(1));
    project.write("pipeline/lock.toml", lock);
    fs::remove_file(project.path("pipeline/.exported.json")).unwrap();
    fs::remove_dir_all(project.path(".signorini")).unwrap();
    let said = project.run(&["run"]);
    let line = said.refusal();
    assert!(line.contains("nothing is on record of ") && !line.contains("by hand"), "{line}");
    project.run(&["run", "--force"]).lines();
}

#[test]
fn an_unreadable_record_is_not_an_absent_one() {
    let project = project();
    project.run(&["run"]).lines();
    let record = project.path(".signorini/v2/tasks/tabulate/a.runs");
    fs::remove_file(&record).unwrap();
    fs::create_dir(&record).unwrap();
    let said = project.run(&["explain", "tabulate"]);
    assert!(said.lines()[0].contains("stale: cannot read "), "{said:?}");
    let said = project.run(&["status"]);
    assert!(!said.out.contains("first run") && said.out.contains("cannot read "), "{said:?}");
}
