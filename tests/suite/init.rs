//! `signorini init`: what it begins with is a project that runs.

use crate::common::{Project, Said, TABLE};
use std::fs;

#[test]
fn a_new_study_runs() {
    let place = Project::with(TABLE);
    let said = place.run(&["init", "new/study"]);
    assert_eq!(said.lines().last(), Some(&"next: cd new/study && signorini run"));
    let run = |args: &[&str]| -> Said {
        place.command(args).current_dir(place.path("new/study")).output().unwrap().into()
    };
    let ran = run(&["run"]);
    assert_eq!(ran.lines().last(), Some(&"the book: report/book/index.html"));
    assert!(!ran.err.contains("left out") && !ran.err.contains("leaves out"), "{ran:?}");
    assert_eq!(run(&["run"]).lines(), ["nothing to do"]);
    // What the page points to is in the book.
    let book = place.path("new/study/report/book");
    let page = fs::read_to_string(book.join("plate.html")).unwrap();
    for name in ["figures/plate-surface.svg", "results.csv"] {
        assert!(page.contains(&format!("\"{name}\"")) && book.join(name).exists(), "{name}");
    }
    assert!(run(&["identify"]).refusal().contains("no published table"));
    assert!(run(&["diff"]).refusal().contains("paper_table"));
}

#[test]
fn a_study_begins_in_an_empty_folder() {
    let place = Project::with(TABLE);
    fs::create_dir(place.path("empty")).unwrap();
    place.run(&["init", "empty"]).lines();
    for taken in ["empty", ".", "pipeline/scenes/a.toml"] {
        let before = place.times();
        let said = place.run(&["init", taken]);
        assert!(said.refusal().contains(taken), "{said:?}");
        assert_eq!(place.times(), before);
    }
    // Where there is no cache yet, none is to be moved.
    let said = place.run(&["init", "pipeline/scenes/a.toml/study"]);
    assert!(said.refusal().ends_with("; name a folder in another place"), "{said:?}");
}
