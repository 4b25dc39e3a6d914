//! This project itself, with all its scenes and its book, killed again and again, and run twice at once.

use crate::common::{Dice, Project, assert_same, promised};
use crate::faults::pairs_of_runs_at_once;
use crate::interruption::{made, started};
use std::collections::BTreeMap;
use std::fs;

/// This project after a run, and what the run made.
fn after_a_run() -> (Project, BTreeMap<String, Vec<u8>>) {
    let project = Project::whole();
    project.run(&["run"]).lines();
    project.run(&["gc"]).lines();
    let made = made(&project);
    assert!(made.contains_key("report/book/index.html"));
    (project, made)
}

/// The next run does what is left, to the same bytes, and nothing else stays.
#[track_caller]
fn completed(project: &Project, wanted: &BTreeMap<String, Vec<u8>>) {
    project.run(&["run"]).lines();
    project.run(&["gc"]).lines();
    assert_same(&made(project), wanted);
    assert_eq!(project.leftovers(), [""; 0]);
}

/// Forgets the results of some stages: what the next run has to do.
fn forget(project: &Project, cache: &str, stages: &[&str]) {
    for stage in stages {
        fs::remove_dir_all(project.path(&format!("{cache}/v2/tasks/{stage}"))).unwrap();
    }
}

#[test]
#[ignore = "takes a quarter of an hour; run with --ignored"]
fn runs_of_the_whole_project_killed_at_random_moments_resume() {
    let kills = promised("Killed over the whole project, in the long tests");
    let (project, wanted) = after_a_run();
    let mut dice = Dice(0x5768_6f6c);
    let (mut killed, mut in_book, mut chain) = (0, 0, 0);
    while killed < kills {
        // Each run goes on from what the last one left, until nothing is; then other stages are forgotten.
        let stages: &[&str] = match chain % 8 {
            7 => &["bench", "identify"],
            1 | 3 | 5 => &["report"],
            _ => &["solve", "tabulate", "diff", "figures", "report"],
        };
        forget(&project, ".signorini", stages);
        for folder in ["report/book", "figures"] {
            fs::remove_dir_all(project.path(folder)).unwrap();
        }
        loop {
            let mut child = started(&project, false, dice.below(3), dice.below(250_000));
            let ended = child.try_wait().unwrap().is_some();
            child.kill().unwrap();
            child.wait().unwrap();
            if ended {
                break;
            }
            killed += 1;
            in_book += usize::from(project.stale() == ["report/book"]);
        }
        completed(&project, &wanted);
        chain += 1;
        eprintln!("{killed} runs killed, {in_book} of them in the book; {chain} times completed");
    }
    assert!(in_book > 0);
}

#[test]
#[ignore = "takes some minutes; run with --ignored"]
fn two_runs_of_the_whole_project_at_once_do_not_disturb_each_other() {
    let pairs = promised("Two runs of the whole project at once, in the long tests");
    let (project, wanted) = after_a_run();
    project.run(&["run", "--cache-dir", "second"]).lines();
    let before = || {
        for cache in [".signorini", "second"] {
            forget(&project, cache, &["tabulate", "diff", "figures", "report"]);
        }
    };
    let after = || {
        project.run(&["run", "--cache-dir", "second"]).lines();
        completed(&project, &wanted);
    };
    pairs_of_runs_at_once(&project, (&["run"], pairs), before, after);
}
