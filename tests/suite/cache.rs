//! The cache: what is up to date never runs, what is not wanted never runs, what changed does.

use crate::common::{EVERYTHING, Project, TABLE, assert_same, wanting};
use std::fs;

#[test]
fn gc_removes_garbage_and_nothing_else() {
    let project = Project::with(&wanting(EVERYTHING));
    project.run(&["run"]).lines();
    let clean = project.made();
    assert!(project.run(&["gc"]).lines()[0].starts_with("removed 0 files, 0 B; kept "));
    assert_same(&project.made(), &clean);
    // Garbage: a scene that went, temporary files of killed runs, an older layout.
    project.scene("b", &TABLE.replace("else=-1", "else=-3"));
    project.run(&["run"]).lines();
    fs::remove_file(project.path("pipeline/scenes/b.toml")).unwrap();
    project.run(&["run"]).lines();
    project.write(".signorini/v2/.signorini-x1y2z3.tmp", "half");
    fs::create_dir_all(project.path(".signorini/v2/.signorini-book01.tmp/src")).unwrap();
    project.write(".signorini/v2/.signorini-book01.tmp/src/page.md", "half");
    fs::create_dir_all(project.path(".signorini/v0/objects/ab")).unwrap();
    project.write(&format!(".signorini/v0/objects/ab/{}", "ab".repeat(32)), "old");
    // Not garbage, since we did not make it.
    project.write(".signorini/v2/notes.txt", "mine");
    fs::create_dir_all(project.path(".signorini/v3/tasks")).unwrap();
    project.write(".signorini/v3/tasks/todo.txt", "mine");
    project.write(".signorini/v2/objects/thesis.txt", "mine");
    project.write(".signorini/v4", "mine");
    project.write(".signorini/CACHEDIR.TAG", "mine");
    // Whatever the name of a file, its folder is not one of ours.
    let hash = "ab".repeat(32);
    let others =
        ["mine/objects/ab", "v/objects/ab", "v2x/objects/ab", "v2/notes/ab", "v2/objects/cd"];
    for folder in others {
        fs::create_dir_all(project.path(".signorini").join(folder)).unwrap();
        project.write(&format!(".signorini/{folder}/{hash}"), "mine");
    }
    let before = project.made();
    let would = project.run(&["gc", "-n"]).lines()[0].to_owned();
    assert_same(&project.made(), &before);
    let did = project.run(&["gc"]).lines()[0].to_owned();
    assert_eq!(would.replace("would remove", "removed"), did);
    let mut after = project.made();
    for name in ["notes.txt", "objects/thesis.txt"] {
        let name = format!(".signorini/v2/{name}");
        assert_eq!(after.remove(&name).as_deref(), Some(&b"mine"[..]), "{name}");
    }
    assert_eq!(fs::read(project.path(".signorini/v3/tasks/todo.txt")).unwrap(), b"mine");
    for folder in others {
        let file = format!(".signorini/{folder}/{hash}");
        assert_eq!(fs::read(project.path(&file)).unwrap(), b"mine", "{folder}");
        after.remove(&file);
    }
    assert_same(&after, &clean);
    assert!(!project.path(".signorini/v0/objects").exists());
    assert!(!project.path(".signorini/v2/tasks/solve/b").exists(), "no empty folders stay behind");
    assert!(["v4", "CACHEDIR.TAG"].iter().all(|n| project.path(".signorini").join(n).exists()));
    project.run(&["run"]).nothing_to_do();
    assert!(project.run(&["gc", "--keep", "0"]).refusal().contains("at least 1"));
    // A folder that was misspelt is not made.
    for args in [&["gc", "-n", "--cache-dir", "missing"][..], &["gc", "--cache-dir", "missing"]] {
        project.run(args).lines();
        assert!(!project.path("missing").exists());
    }
}

#[test]
fn results_do_not_depend_on_threads_or_place() {
    let project = Project::with(&wanting(EVERYTHING));
    project.scene("b", &wanting(EVERYTHING).replace("else=-1", "disc(0,0,0.3)=1; else=-2"));
    project.run(&["run", "-j", "1"]).lines();
    let made = project.made();
    assert!(made.len() > 30, "there is something to compare: {}", made.len());
    for jobs in ["2", "5"] {
        let elsewhere = Project::with(&wanting(EVERYTHING));
        elsewhere.scene("b", &wanting(EVERYTHING).replace("else=-1", "disc(0,0,0.3)=1; else=-2"));
        elsewhere.run(&["run", "-j", jobs]).lines();
        assert_same(&elsewhere.made(), &made);
    }
}

#[test]
fn what_a_run_would_find_is_no_garbage() {
    let project = Project::with(&wanting(EVERYTHING));
    project.add_book("# One\n");
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
