//! What a task reads is what its hash holds: tasks with the same inputs make the same bytes, and nothing stays old.

use crate::common::{Project, assert_same};
use crate::edits::{Files, KEYS, book, exported, kind, study, write};
use serde_json::Value;
use std::collections::BTreeMap;

/// The method of the paper with two r and two rules, and a picture of each kind.
const METHOD: &str = "title = \"T\"\nf = \"quadrant(ll)=3; else=-1.1\"\nsolver = \"arrow-hurwicz\"\ngrids = [4, 8]\n\
    r = [1, 10]\ndraw_r = 10\nstop = [\"signed\", \"printed\"]\n";

/// A study of one scene with the mesh of [`study`]; with a book, a run also makes the table of all results.
fn project(scene: &str, has_book: bool) -> Project {
    let project = Project::with(scene);
    let mut files = study();
    files.retain(|path, _| path.ends_with(".msh"));
    files.extend(book().into_iter().filter(|_| has_book));
    write(&project, &Files::new(), &files);
    project
}

#[test]
fn an_edit_leaves_nothing_old() {
    let with = |outputs: &str| format!("{METHOD}outputs = [{outputs}]\n");
    let all = with("\"table\", \"surface\", \"map\", \"history\", \"contact\"");
    let spectral = "title = \"T\"\nf = \"quadrant(ll)=3; else=-1.1\"\nsolver = \"spectral\"\ngrids = [8]\n\
        outputs = [\"surface\", \"map\"]\n";
    let rules = ("[\"signed\", \"printed\"]", "[\"printed\", \"signed\"]");
    for (scene, (from, to), has_book) in [
        (with("\"table\", \"history\""), ("[1, 10]", "[10, 1]"), true),
        (with("\"table\""), rules, true),
        (with("\"contact\""), rules, false),
        (with("\"history\""), ("draw_r = 10", "draw_r = 1"), false),
        (all.clone(), ("draw_r = 10", "draw_r = 1"), false),
        (all.clone(), rules, false),
        (all, ("title = \"T\"", "title = \"U\""), false),
        (spectral.to_owned(), ("title = \"T\"", "title = \"T\"\nlaw = { limit = 1000 }"), false),
    ] {
        assert!(scene.contains(from), "{scene}");
        let project = project(&scene, has_book);
        project.run(&["run"]).lines();
        let edited = scene.replace(from, to);
        project.scene("a", &edited);
        project.run(&["run"]).lines();
        let fresh = self::project(&edited, has_book);
        fresh.run(&["run"]).lines();
        assert_same(&exported(&project), &exported(&fresh));
        assert_eq!(exported(&project).contains_key("report/results.csv"), has_book);
    }
    let project = project(&(spectral.to_owned() + "law = { limit = 1000 }\n"), false);
    project.run(&["run"]).lines();
    for (name, bytes) in project.files("figures").iter().filter(|(name, _)| name.ends_with(".svg"))
    {
        let svg = String::from_utf8_lossy(bytes);
        assert!(svg.contains("sticks") && !svg.contains("in contact"), "{name}");
    }
}

/// Inputs and outputs of every task that a run has made.
fn runs(project: &Project) -> Vec<(String, Value)> {
    let mut runs = Vec::new();
    for (name, bytes) in project.files(".signorini/v2/tasks") {
        for line in String::from_utf8(bytes).unwrap().lines() {
            let (_, json) = line.split_once(' ').unwrap_or_else(|| panic!("{name}: {line}"));
            let run: Value = serde_json::from_str(json).unwrap();
            runs.push((format!("{} {}", run["task"], run["inputs"]), run["outputs"].clone()));
        }
    }
    runs
}

#[test]
fn two_scenes_that_differ_in_a_key_or_an_order_share_no_task_that_differs() {
    let (mut made, mut scenes, mut shared) = (BTreeMap::<String, (Value, String)>::new(), 0, 0);
    let bases: Vec<String> = study()
        .into_iter()
        .filter(|(path, _)| path.starts_with("pipeline/scenes/"))
        .map(|(_, text)| text)
        .collect();
    for base in &bases {
        let kind = kind(base);
        for (_, key, values) in KEYS.iter().filter(|(kinds, ..)| kinds.contains(&kind)) {
            for value in values {
                let others = base.lines().filter(|line| !line.starts_with(&format!("{key} = ")));
                let scene = others.fold(String::new(), |text, line| text + line + "\n");
                let scene = format!("{scene}{key} = {value}\n");
                let project = project(&scene, false);
                if project.run(&["run"]).code != Some(0) {
                    continue;
                }
                scenes += 1;
                for (inputs, outputs) in runs(&project) {
                    let (first, of) = made
                        .entry(inputs.clone())
                        .or_insert_with(|| (outputs.clone(), scene.clone()));
                    assert_eq!(*first, outputs, "{inputs}\n{of}\n{scene}");
                    shared += usize::from(*of != scene);
                }
            }
        }
    }
    assert!(scenes > 40 && shared > 100, "{scenes} scenes, {shared} tasks in common");
}
