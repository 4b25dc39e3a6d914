//! What each command reads and writes, what it refuses, and what it says that a run will do.

use crate::common::{EVERYTHING, Project, TABLE, assert_same, send, wait_for_handler, wanting};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::Stdio;
use std::time::{Duration, SystemTime};

/// Times of the files of the project outside of the cache.
fn committed(project: &Project) -> BTreeMap<PathBuf, SystemTime> {
    let mut times = project.times();
    times.retain(|path, _| !path.components().any(|part| part.as_os_str() == ".signorini"));
    times
}

/// Scene with a published table.
fn published() -> String {
    TABLE.to_owned() + "paper_table = 1\n"
}

/// A project with pages, of which one shows nothing.
fn with_pages(scene: &str) -> Project {
    let project = Project::with(scene);
    project.add_book("# One\n");
    project
}

#[test]
fn a_page_says_why_a_scene_has_no_result_where_the_run_is_to_go_on() {
    let project = Project::with(TABLE);
    let up = "title = \"t\"\nf = \"else=1\"\nh = 8\noutputs = [\"table\", \"map\"]\n";
    project.scene("up", up);
    project.add_book(
        "{{#include tables/up.md}}\n\n[all](tables/up.csv)\n\n![map](figures/up-map.svg)\n",
    );
    for _ in 0..2 {
        let said = project.run(&["run", "-k"]);
        assert!(said.code == Some(3) && said.out.contains("made without up\n"), "{said:?}");
        for file in ["index.html", "tables/up.csv"] {
            let made = fs::read_to_string(project.path(&format!("report/book/{file}"))).unwrap();
            assert!(made.contains("the integral of f is 1.000"), "{made}");
        }
        let picture = fs::read_to_string(project.path("report/book/figures/up-map.svg")).unwrap();
        assert!(picture.contains("Not there: "), "{picture}");
    }
    // Without `-k`, and when the scene has a solution, nothing of it is left.
    assert_eq!(project.run(&["run"]).code, Some(2));
    project.scene("up", &up.replace("else=1", "else=-1"));
    project.run(&["run"]).lines();
    assert!(
        !fs::read_to_string(project.path("report/book/index.html")).unwrap().contains("Not there")
    );
    project.run(&["run"]).nothing_to_do();
}

#[test]
fn a_comparison_writes_to_the_cache_alone() {
    let project = with_pages(&published());
    project.scene("heavy", &TABLE.replace("[4, 8]", "[4, 8, 16]"));
    project.run(&["run"]);
    project.scene("a", &published().replace("else=-1", "else=-1.5"));
    project.scene("heavy", &TABLE.replace("[4, 8]", "[4, 8, 16, 32]"));
    let before = committed(&project);
    let compared = project.run(&["diff", "--json"]);
    assert_eq!(compared.json()["tables"][0]["table"], 1, "{compared:?}");
    assert_eq!(committed(&project), before);
    // Only what is compared was solved.
    let stale = project.stale();
    assert!(!stale.iter().any(|id| id.starts_with("solve/a/")), "{stale:?}");
    assert!(stale.iter().any(|id| id.starts_with("solve/heavy/")), "{stale:?}");
    // The record still tells of the change.
    let locked = project.run(&["run", "--locked"]);
    assert_eq!(locked.code, Some(1), "{locked:?}");
    assert!(locked.out.contains("solve/a/signed/r=10"), "{locked:?}");
    assert_eq!(project.run(&["diff", "--json"]).out, compared.out);
}

#[test]
fn what_a_run_would_find_is_no_garbage() {
    let project = with_pages(&wanting(EVERYTHING));
    project.run(&["run"]).lines();
    let edited = wanting(EVERYTHING).replace("else=-1", "else=-2");
    project.scene("a", &edited);
    project.run(&["run"]).lines();
    project.scene("a", &wanting(EVERYTHING));
    assert_eq!(project.stale(), [""; 0]);
    project.run(&["gc"]).lines();
    assert_eq!(project.stale(), [""; 0]);
    // An artifact in the middle is gone: what is made from it is found once it is there again.
    let objects = project.files(".signorini/v2/objects");
    let runs = fs::read(project.path(".signorini/v2/tasks/solve/a/signed/r=10.runs")).unwrap();
    let text = String::from_utf8(runs).unwrap();
    // The latest is that of the edit.
    let first = text.lines().next().unwrap();
    let of_first = |name: &&String| first.contains(name.rsplit('/').next().unwrap());
    for name in objects.keys().filter(of_first) {
        fs::remove_file(project.path(&format!(".signorini/v2/objects/{name}"))).unwrap();
    }
    project.run(&["gc"]).lines();
    let said = project.run(&["run", "-v"]);
    assert_eq!(said.ran(), ["solve/a/signed/r=10"], "{said:?}");
    // Both states are in use by turns.
    project.scene("a", &edited);
    assert_eq!(project.stale(), [""; 0]);
    project.run(&["run"]).lines();
    project.run(&["gc"]).lines();
    project.scene("a", &wanting(EVERYTHING));
    assert!(!project.stale().is_empty(), "the other one went");
}

/// A scene on this domain whose flux cannot balance f.
fn unsolvable(domain: &str) -> String {
    format!("title = \"Up\"\nf = \"else=1\"\n{domain}outputs = [\"table\"]\n")
}

#[test]
fn a_scene_that_cannot_run_does_not_stop_the_others_where_the_run_is_to_go_on() {
    let project = with_pages(TABLE);
    project.scene("b", TABLE);
    project.run(&["run"]).lines();
    let shown = project.files("report/src");
    project.scene("a", &TABLE.replace("else=-1", "else=-2"));
    project.scene("up", &unsolvable(""));
    project.scene("high", &unsolvable("domain = { name = \"disc\", refine = 1 }\n"));
    project.scene("part", &unsolvable("domain = { name = \"disc\", free = [\"no\"] }\n"));
    let said = project.run(&["run", "-k"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    for (task, why) in
        [("solve/up: ", "integral of f"), ("solve/high: ", "integral of f"), ("solve/part: ", "no")]
    {
        let line = said.err.lines().find(|line| line.contains(task)).unwrap();
        assert!(line.contains(why), "{line}");
    }
    assert!(!said.err.contains("results"), "{said:?}");
    assert!(said.out.contains("is made without high, part, up"), "{said:?}");
    // All that shows several scenes is that of the others.
    let results = fs::read_to_string(project.path("report/results.csv")).unwrap();
    let names: BTreeSet<&str> =
        results.lines().skip(1).map(|row| row.split(',').next().unwrap()).collect();
    assert_eq!(names, BTreeSet::from(["a", "b"]));
    let of_others = |id: &String| !["up", "high", "part"].iter().any(|name| id.contains(name));
    let left: Vec<String> = project.stale().into_iter().filter(of_others).collect();
    assert_eq!(left, ["diff/results", "report/book"]);
    // One that cannot be read is listed, too, and what it made stays.
    for name in ["up", "high", "part"] {
        fs::remove_file(project.path(&format!("pipeline/scenes/{name}.toml"))).unwrap();
    }
    project.run(&["run"]).lines();
    project.scene("b", "x = 1\n");
    project.scene("a", &TABLE.replace("else=-1", "else=-3"));
    let (lock, before) = (project.path("pipeline/lock.toml"), project.files("report/src"));
    let said = project.run(&["run", "-k"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.ends_with(
        "error: scene `b`: line 1: unknown field `x`, expected one of \
        `title`, `paper_table`, `f`, `domain`, `law`, `h`, `grids`, `solver`, `load`, `r`, `stop`, `draw_r`, \
        `max_iterations`, `prolongation`, `tolerance`, `accuracy`, `accuracy_energy`, `outputs`, `vary`, `picture`, \
        `chart`, `columns`\n"
    ));
    assert!(said.out.contains("solve"), "{said:?}");
    assert!(fs::read_to_string(lock).unwrap().contains("solve/b/"));
    assert_same(&project.files("report/src"), &before);
    assert_eq!(shown.len(), before.len());
    assert!(project.run(&["run"]).refusal().contains("scene `b`"));
    assert!(project.run(&["run", "-k", "--locked"]).refusal().contains("scene `b`"));
    assert!(project.run(&["run", "-k", "b"]).refusal().contains("scene `b`"));
}

#[test]
fn a_signal_ends_at_once_what_has_not_begun() {
    let project = Project::with(TABLE);
    fs::create_dir(project.path(".signorini")).unwrap();
    let lock = File::create(project.path(".signorini/lock")).unwrap();
    lock.lock().unwrap();
    for signal in ["INT", "TERM"] {
        let mut command = project.command(&["run", "--task", "solve/a/signed/r=10"]);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        wait_for_handler(&child);
        send(signal, &child);
        // It would wait for ever.
        let said = child.wait_with_output().unwrap();
        assert_eq!(said.status.code(), Some(130), "{said:?}");
        let err = String::from_utf8(said.stderr).unwrap();
        assert!(!err.contains("finishing"), "{err}");
        assert!(err.ends_with("repeat the command to go on\n"), "{err}");
    }
    drop(lock);
    assert_eq!(project.stale().len(), 3);
}

#[test]
fn refinement_ends_between_two_meshes() {
    let scene = "title = \"Fine\"\nf = \"else=-1\"\ndomain = \"lshape\"\naccuracy = 1e-5\noutputs = [\"table\"]\n";
    let project = Project::with(scene);
    let mut command = project.command(&["run", "-v"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    lines.find(|line| line.as_ref().unwrap().contains(" to run")).unwrap().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    send("TERM", &child);
    // To the end it would take an hour, and all memory.
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let said: Vec<String> = lines.map(Result::unwrap).collect();
    assert!(said[0].starts_with("finishing what has begun"), "{said:?}");
    assert!(said[1].starts_with("ended early: solve/a"), "{said:?}");
    assert_eq!(project.stale().len(), 2);
}
