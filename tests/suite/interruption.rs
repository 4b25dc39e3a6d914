//! Runs that are killed or interrupted: what was finished is kept, and the next run goes on to the same result.

use crate::common::{Dice, EVERYTHING, Project, TABLE, assert_same, promised, wanting};
use std::io::Read;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Two dozen cells and six figures: long enough to be killed anywhere in it.
fn long() -> Project {
    let scene = wanting(EVERYTHING).replace("[10, 1]", "[1e6, 100, 20, 10, 5, 2, 1, 0.5]")
        + "stop = [\"signed\", \"printed\", \"signed-dual\"]\npaper_table = 1\n";
    let project = Project::with(&scene);
    project.scene(
        "b",
        &wanting("[\"surface\", \"source\"]").replace("else=-1", "disc(0,0,0.3)=1; else=-2"),
    );
    project
}

/// Kills as many runs, each at a random moment of its life; what is left must be resumed or redone.
fn killed_runs_resume(kills: usize, seed: u64) {
    let reference = long();
    let start = Instant::now();
    reference.run(&["run"]).lines();
    // Kept near the time that a run takes, which varies with the load of the machine.
    let mut bound = start.elapsed().as_micros() as u64;
    let made = reference.made();
    let all = reference.run(&["dag"]).lines().len();

    let mut dice = Dice(seed);
    let (mut project, mut killed, mut partial) = (long(), 0, 0);
    for attempt in 0.. {
        // By turns from nothing, on top of what the last one left, and rewriting a whole cache.
        if attempt % 4 == 0 {
            project = long();
        }
        let mut child = project.start(if attempt % 4 > 1 { &["run", "--force"] } else { &["run"] });
        std::thread::sleep(Duration::from_micros(dice.below(bound)));
        let too_late = child.try_wait().unwrap().is_some();
        child.kill().unwrap();
        child.wait().unwrap();
        killed += usize::from(!too_late);
        bound = if too_late { bound * 8 / 10 } else { bound * 21 / 20 };
        let stale = project.stale().len();
        partial += usize::from(stale > 0 && stale < all);
        if attempt % 4 % 2 == 1 {
            let said = project.run(&["run"]);
            assert_eq!(said.code, Some(0), "attempt {attempt}: {said:?}");
            project.run(&["gc"]).lines();
            assert_same(&project.made(), &made);
            assert!(attempt < 10 * kills, "only {killed} of {attempt} runs were killed in time");
            if killed >= kills {
                break;
            }
        }
    }
    eprintln!("{killed} runs killed, {partial} of them with some tasks done and some not");
    assert!(partial >= kills / 16, "{partial} of {killed}");
}

#[test]
fn runs_killed_at_random_moments_resume() {
    killed_runs_resume(promised("Killed (`SIGKILL`) at a random moment"), 0x5165_6e6f);
}

#[test]
#[ignore = "takes a minute; run with --ignored"]
fn runs_killed_at_1000_random_moments_resume() {
    killed_runs_resume(1000, 0x7269_6e69);
}

#[test]
fn runs_interrupted_at_random_moments_resume() {
    let interrupts = promised("Ctrl-C (`SIGINT`) at a random moment");
    let project = long();
    let start = Instant::now();
    project.run(&["run"]).lines();
    let bound = start.elapsed().as_micros() as u64;
    let made = project.made();
    let mut dice = Dice(0x4374_726c);
    let mut in_time = 0;
    for _ in 0..interrupts {
        let mut child = project.start(&["run", "--force"]);
        std::thread::sleep(Duration::from_micros(dice.below(bound)));
        let id = child.id().to_string();
        // Fails if the run has ended by itself.
        let _ = Command::new("kill").args(["-INT", &id]).stderr(Stdio::null()).status().unwrap();
        // No code: the signal came before the program was ready for it.
        let code = child.wait().unwrap().code();
        assert!(matches!(code, Some(0 | 130) | None), "{code:?}");
        in_time += usize::from(code != Some(0));
        project.run(&["run"]).lines();
        assert_same(&project.made(), &made);
    }
    eprintln!("{in_time} of {interrupts} interrupted in time");
    assert!(in_time > interrupts / 4, "{in_time} of {interrupts}");
}

#[test]
fn ctrl_c_keeps_finished_cells() {
    // Cells that never converge: each takes its cap of iterations.
    let text = TABLE
        .replace("[4, 8]", "[4, 8, 16, 32, 64]")
        .replace("[10, 1]", "[1e-9, 2e-9, 3e-9, 4e-9, 5e-9, 6e-9]");
    let project = Project::with(&(text + "stop = [\"printed\"]\nmax_iterations = 20000\n"));
    let mut command = project.command(&["run", "-v", "-j", "1"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = String::new();
    let mut reader = child.stderr.take().unwrap();
    let mut byte = [0];
    while !said.contains(": never ran\n") && reader.read(&mut byte).unwrap() == 1 {
        said.push(char::from(byte[0]));
    }
    assert!(said.contains("\nran solve/a/printed/"), "{said}");
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    reader.read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
    assert!(
        said.ends_with("error: interrupted; what was finished is kept, run again to go on\n"),
        "{said}"
    );
    let finished = said.lines().filter(|line| line.starts_with("ran ")).count();
    assert!((1..6).contains(&finished), "{said}");
    assert_eq!(project.stale().len(), 7 - finished, "cells that are not done, and the table");
}
