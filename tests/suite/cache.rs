//! The cache: what is up to date never runs, what is not wanted never runs, what changed does.

use crate::common::{EVERYTHING, Project, TABLE, assert_same, wanting};
use std::fs;

const CELLS: [&str; 2] = ["solve/a/signed/r=1", "solve/a/signed/r=10"];

#[test]
fn a_second_run_does_nothing_and_touches_nothing() {
    let project = Project::with(&wanting(EVERYTHING));
    assert_eq!(project.run(&["run", "-v"]).ran().len(), 7);
    let (made, times) = (project.made(), project.times());
    let again = project.run(&["run", "-v"]);
    assert_eq!((again.lines(), again.err.as_str()), (vec!["nothing to do: up to date"], ""));
    assert_same(&project.made(), &made);
    assert_eq!(project.times(), times);
    assert_eq!(project.run(&["status", "--exit-code"]).code, Some(0));
    project.run(&["run", "-n"]).nothing_to_do();
    assert_eq!(project.run(&["run", "-n", "--force"]).lines().len(), 7);
}

#[test]
fn a_dry_run_tells_what_would_run_and_writes_nothing() {
    let project = Project::with(TABLE);
    let before = project.times();
    let said = project.run(&["run", "-n"]);
    assert_eq!(
        said.lines(),
        [
            "solve/a/signed/r=10: stale: first run",
            "solve/a/signed/r=1: stale: first run",
            "tabulate/a: waits for solve/a/signed/r=10"
        ]
    );
    assert_eq!(project.run(&["status", "--exit-code"]).code, Some(1));
    assert_eq!(project.times(), before);
}

#[test]
fn a_scene_that_wants_a_table_draws_nothing() {
    let project = Project::with(TABLE);
    let ran = project.run(&["run", "-v"]);
    assert_eq!(ran.ran(), [CELLS[0], CELLS[1], "tabulate/a"]);
    assert!(!project.path("figures").exists());
    // Nor does it keep what only drawings need.
    let outputs = fs::read_to_string(project.path(".signorini/v2/tasks/solve/a/signed/r=10.runs"));
    let outputs = outputs.unwrap();
    assert!(outputs.contains("numbers.json") && !outputs.contains("pair.f64"), "{outputs}");
}

#[test]
fn a_scene_that_wants_a_map_of_f_solves_nothing() {
    let project = Project::with(&wanting("[\"source\"]"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["figures/a-source"]);
}

#[test]
fn a_surface_solves_only_the_r_that_is_drawn() {
    let project = Project::with(&(wanting("[\"surface\"]") + "draw_r = 10\n"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["figures/a-surface", CELLS[1]]);
}

#[test]
fn an_r_or_a_grid_not_asked_for_is_nowhere() {
    let project = Project::with(&TABLE.replace("[10, 1]", "[5]").replace("[4, 8]", "[4, 8, 16]"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["solve/a/signed/r=5", "tabulate/a"]);
    for (name, bytes) in project.files(".signorini/v2") {
        let text = String::from_utf8(bytes).unwrap();
        assert!(!name.contains("r=1") && !text.contains("r=1"), "{name}: {text}");
        for absent in ["1/64", "\"cells\": 64", "32]", "64]"] {
            assert!(!text.contains(absent), "{absent} in {name}: {text}");
        }
    }
    let grids = project.files(".signorini/v2/tasks/solve/a/signed");
    assert!(String::from_utf8_lossy(&grids["r=5.runs"]).contains("\"[4,8,16]\""));
}

#[test]
fn one_scene_of_two_leaves_the_other_alone() {
    let project = Project::with(TABLE);
    project.scene("b", TABLE);
    let only = project.run(&["run", "-v", "b", "b"]);
    assert_eq!(
        only.ran(),
        ["solve/b/signed/r=1", "solve/b/signed/r=10", "tabulate/b"],
        "once each, however often it is named"
    );
    let lock = || fs::read_to_string(project.path("pipeline/lock.toml")).unwrap();
    assert!(lock().contains("solve/b/") && !lock().contains("solve/a/"), "what did not run");
    assert_eq!(project.run(&["run", "-v"]).ran(), [CELLS[0], CELLS[1], "tabulate/a"]);
    assert!(lock().contains("solve/b/") && lock().contains("solve/a/"));
}

#[test]
fn only_a_stage_runs_it_and_what_it_needs() {
    let project = Project::with(&wanting("[\"table\", \"source\", \"surface\"]"));
    let ran = project.run(&["run", "-v", "--only", "figures"]);
    assert_eq!(ran.ran(), ["figures/a-source", "figures/a-surface", CELLS[0]], "r = 1 is drawn");
    assert_eq!(project.run(&["run", "-v", "--only", "tabulate"]).ran(), [CELLS[1], "tabulate/a"]);
}

#[test]
fn a_longer_list_of_r_solves_only_the_new_cell() {
    let project = Project::with(TABLE);
    project.run(&["run"]).lines();
    project.scene("a", &TABLE.replace("[10, 1]", "[10, 1, 5]"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["solve/a/signed/r=5", "tabulate/a"]);
}

#[test]
fn a_comment_or_a_title_that_nothing_shows_changes_nothing() {
    let project = Project::with(TABLE);
    project.run(&["run"]).lines();
    project.scene("a", &format!("# A remark.\n{}", TABLE.replace("Suction", "Pull")));
    project.run(&["run", "-v"]).nothing_to_do();
    // A figure shows the title: there it counts, and only there.
    project.scene("a", &wanting("[\"table\", \"source\"]"));
    project.run(&["run"]).lines();
    project.scene("a", &wanting("[\"table\", \"source\"]").replace("Suction", "Pull"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["figures/a-source"]);
}

#[test]
fn cells_that_come_out_the_same_stop_there() {
    let project = Project::with(&wanting(EVERYTHING));
    project.run(&["run"]).lines();
    project.scene("a", &(wanting(EVERYTHING) + "max_iterations = 999999\n"));
    assert_eq!(project.run(&["run", "-v"]).ran(), CELLS, "not a table, not a figure");
}

#[test]
fn another_f_runs_everything_again() {
    let project = Project::with(&wanting(EVERYTHING));
    let first = project.run(&["run", "-v"]);
    let lock = fs::read(project.path("pipeline/lock.toml")).unwrap();
    project.scene("a", &wanting(EVERYTHING).replace("else=-1", "else=-2"));
    assert_eq!(project.run(&["run", "-v"]).ran(), first.ran());
    assert_ne!(fs::read(project.path("pipeline/lock.toml")).unwrap(), lock);
}

#[test]
fn explain_prints_old_and_new() {
    let project = Project::with(TABLE);
    project.run(&["run"]).lines();
    assert_eq!(project.run(&["explain", "tabulate"]).lines(), ["tabulate/a: up to date"]);
    project.scene("a", &TABLE.replace("else=-1", "else=-2").replace("[4, 8]", "[8, 16]"));
    assert_eq!(
        project.run(&["explain", "solve/a/signed/r=10"]).lines(),
        [
            "solve/a/signed/r=10: stale",
            "  parameter f: else=-1 -> else=-2",
            "  parameter fineness.grids: [4,8] -> [8,16]"
        ]
    );
    let both = project.run(&["explain", "solve/a/signed/r=1", "--json"]).json();
    assert_eq!(both["tasks"].as_object().unwrap().len(), 1, "a task, not all that begin like it");
    let both = project.run(&["explain", "solve/a/signed/r", "--json"]).json();
    assert_eq!(both["tasks"].as_object().unwrap().len(), 2);
    // The table waits: it has the grids from the solutions.
    assert_eq!(
        project.run(&["explain", "tabulate"]).lines(),
        ["tabulate/a: waits for solve/a/signed/r=10"]
    );
    let json = project.run(&["explain", "solve", "--json"]).json();
    let change = &json["tasks"][CELLS[0]]["reason"]["what"][0];
    assert_eq!((json["schema"].as_u64(), change["old"].as_str()), (Some(1), Some("else=-1")));
    assert!(project.run(&["explain", "paint"]).refusal().contains("stages are solve"));
}

#[test]
fn a_reverted_edit_is_a_hit_and_survives_gc() {
    let project = Project::with(&wanting("[\"table\", \"surface\"]"));
    project.run(&["run"]).lines();
    let figures = project.files("figures");
    project.scene("a", &wanting("[\"table\", \"surface\"]").replace("else=-1", "else=-2"));
    project.run(&["run"]).lines();
    assert_ne!(project.files("figures"), figures);
    project.scene("a", &wanting("[\"table\", \"surface\"]"));
    let back = project.run(&["run", "-v"]);
    assert_eq!(
        (back.ran(), back.lines()),
        (
            vec![],
            vec![
                "4 files written to figures/ and report/",
                "pipeline/lock.toml brought up to date"
            ]
        )
    );
    assert_same(&project.files("figures"), &figures);
    // What is in use now is the older result; gc must keep that one.
    project.run(&["gc"]).lines();
    project.run(&["run", "-v"]).nothing_to_do();
}

#[test]
fn a_result_in_use_again_survives_gc_though_nothing_else_is_to_do() {
    let project = Project::with(TABLE);
    project.run(&["run"]).lines();
    let lock = fs::read(project.path("pipeline/lock.toml")).unwrap();
    project.scene("a", &TABLE.replace("else=-1", "else=-2"));
    project.run(&["run"]).lines();
    // As `git checkout` does it, the lock file with the scene.
    project.scene("a", TABLE);
    project.write("pipeline/lock.toml", lock);
    assert_eq!(project.run(&["run", "-v"]).ran(), [""; 0]);
    project.run(&["gc"]).lines();
    project.run(&["run", "-v"]).nothing_to_do();
}

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
fn force_runs_everything_and_changes_nothing() {
    let project = Project::with(&wanting(EVERYTHING));
    let first = project.run(&["run", "-v"]);
    let made = project.made();
    assert_eq!(project.run(&["run", "-v", "--force"]).ran(), first.ran());
    assert_same(&project.made(), &made);
}

#[test]
fn a_task_that_fails_leaves_the_others_up_to_date() {
    let project = Project::with(&wanting(EVERYTHING));
    project.add_book("# One\n\n[to nowhere](nowhere.md)\n");
    for args in [&["run", "-j", "1"][..], &["run", "-k"]] {
        let said = project.run(args);
        assert!(said.code == Some(3) && said.err.contains("leads nowhere"), "{said:?}");
        assert_eq!(project.stale(), ["report/book"]);
    }
    project.write("report/templates/one.md", "# One\n");
    assert_eq!(project.run(&["run", "-v"]).ran(), ["report/book"]);
}

#[test]
fn a_locked_run_fails_on_a_difference_and_leaves_the_lock_file() {
    let project = Project::with(&wanting("[\"table\", \"source\"]"));
    project.run(&["run"]).lines();
    project.run(&["run", "--locked"]).nothing_to_do();
    project.scene("a", &wanting("[\"table\", \"source\"]").replace("else=-1", "else=-2"));
    let lock = fs::read(project.path("pipeline/lock.toml")).unwrap();
    let figure = fs::read(project.path("figures/a-source.svg")).unwrap();
    let said = project.run(&["run", "--locked"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert_eq!(fs::read(project.path("figures/a-source.svg")).unwrap(), figure, "compared first");
    assert!(said.out.contains("solve/a/signed/r=10: ") && said.out.contains(" -> "), "{said:?}");
    assert_eq!(fs::read(project.path("pipeline/lock.toml")).unwrap(), lock);
    assert_eq!(project.run(&["run", "--locked"]).code, Some(1), "still, though nothing has to run");
    project.run(&["run"]).lines();
    assert_eq!(project.run(&["run", "--locked"]).code, Some(0));
}

#[test]
fn status_and_a_dry_run_say_that_files_are_missing_or_old_if_they_are() {
    let project = Project::with(&wanting("[\"source\"]"));
    project.run(&["run"]).lines();
    let said = |words: &str| {
        let texts = [&["status"][..], &["run", "-n"], &["run", "-n", "a"]];
        texts.map(|args| project.run(args).out.contains(words))
    };
    let (files, lock) =
        ("files in figures/ or report/ are missing or old", "lock.toml is missing or old");
    assert_eq!((said(files), said(lock)), ([false; 3], [false; 3]));
    fs::remove_file(project.path("figures/a-source.svg")).unwrap();
    assert_eq!((said(files), said(lock)), ([true; 3], [false; 3]));
    project.run(&["run"]).lines();
    fs::remove_file(project.path("pipeline/lock.toml")).unwrap();
    assert_eq!((said(files), said(lock)), ([false; 3], [true; 3]));
}
