//! Runs that are killed or interrupted: what was finished is kept, and the next run goes on to the same result.

use crate::common::{
    Dice, EVERYTHING, Project, Said, TABLE, assert_same, interrupt, promised, send,
    wait_for_handler, wanting,
};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Two dozen cells, six figures and a book: long enough to be killed anywhere in it.
fn long() -> Project {
    let scene = wanting(EVERYTHING).replace("[10, 1]", "[1e6, 100, 20, 10, 5, 2, 1, 0.5]");
    let rules = "[\"signed\", \"printed\", \"signed-dual\"]";
    let scene = scene.replace("[\"signed\"]", rules) + "paper_table = 1\n";
    let project = Project::with(&scene);
    project.scene(
        "b",
        &wanting("[\"surface\", \"source\"]").replace("else=-1", "disc(0,0,0.3)=1; else=-2"),
    );
    project.add_book("# One\n");
    project.write("report/templates/SUMMARY.md", "- [One](one.md)\n- [Two](two.md)\n");
    project.write("report/templates/two.md.tera", "# Two\n");
    project
}

/// What must be there again after any fault: what [`Project::made`] gives, the pages and the book.
pub(crate) fn made(project: &Project) -> BTreeMap<String, Vec<u8>> {
    let mut made = project.made();
    for folder in ["report/src", "report/book"] {
        let files = project.files(folder).into_iter();
        made.extend(files.map(|(name, bytes)| (format!("{folder}/{name}"), bytes)));
    }
    made
}

/// Starts a run and reads along until as many tasks have ended, then goes on for some microseconds
/// more, so that what follows may find it anywhere.
pub(crate) fn started(project: &Project, force: bool, tasks: u64, micros: u64) -> Child {
    let mut command =
        project.command(if force { &["run", "-v", "--force"] } else { &["run", "-v"] });
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut ended = 0;
    while ended < tasks {
        let Some(Ok(line)) = lines.next() else { break };
        ended += u64::from(line.starts_with("ran "));
    }
    // Read on, or the program would stop at a full pipe.
    std::thread::spawn(move || lines.for_each(drop));
    let until = Instant::now() + Duration::from_micros(micros);
    while Instant::now() < until {
        std::hint::spin_loop();
    }
    child
}

/// Kills as many runs, each at a random moment of its life; what is left must be resumed or redone.
fn killed_runs_resume(kills: usize, seed: u64) {
    let reference = long();
    reference.run(&["run"]).lines();
    let wanted = made(&reference);
    let all = reference.run(&["dag"]).lines().len();
    let mut dice = Dice(seed);
    let (mut project, mut killed, mut partial, mut in_book, mut late) = (long(), 0, 0, 0, 0);
    for attempt in 0..10 * kills {
        // By turns from nothing, on top of what the last one left, and rewriting a whole cache.
        if attempt % 4 == 0 {
            project = long();
        }
        // One in four while the book is built, or its files are written.
        let tasks = if dice.below(4) == 0 { all as u64 - 1 } else { dice.below(all as u64 + 1) };
        let mut child = started(&project, attempt % 4 > 1, tasks, dice.below(20_000));
        let too_late = child.try_wait().unwrap().is_some();
        child.kill().unwrap();
        child.wait().unwrap();
        killed += usize::from(!too_late);
        let stale = project.stale();
        partial += usize::from(!too_late && !stale.is_empty() && stale.len() < all);
        in_book += usize::from(!too_late && stale == ["report/book"]);
        late += usize::from(!too_late && stale.is_empty());
        if attempt % 2 == 1 {
            let said = project.run(&["run"]);
            assert_eq!(said.code, Some(0), "attempt {attempt}: {said:?}");
            project.run(&["gc"]).lines();
            assert_same(&made(&project), &wanted);
            assert_eq!(project.leftovers(), [""; 0], "attempt {attempt}");
            // However fast the machine is, attempts are left for all that is asked for.
            if killed >= kills && partial > 0 && in_book > 0 {
                break;
            }
        }
    }
    eprintln!(
        "{killed} runs killed: {partial} with some tasks done and some not, {in_book} of them in the book, {late} \
         after the last task"
    );
    assert!(killed >= kills && partial > 0 && in_book > 0, "{killed}, {partial}, {in_book}");
}

#[test]
fn runs_killed_at_random_moments_resume() {
    killed_runs_resume(promised("Killed (`SIGKILL`) at a random moment"), 0x5165_6e6f);
}

#[test]
#[ignore = "takes some minutes; run with --ignored"]
fn runs_killed_at_500_random_moments_resume() {
    killed_runs_resume(promised("Killed, in the long tests"), 0x7269_6e69);
}

#[test]
fn runs_interrupted_at_random_moments_resume() {
    let interrupts = promised("Ctrl-C (`SIGINT`) at a random moment");
    let project = long();
    project.run(&["run"]).lines();
    let wanted = made(&project);
    let all = project.run(&["dag"]).lines().len() as u64;
    let mut dice = Dice(0x4374_726c);
    let mut in_time = 0;
    // However fast the machine is, attempts are left.
    for _ in 0..10 * interrupts {
        if in_time == interrupts {
            break;
        }
        let mut child = started(&project, true, dice.below(all), dice.below(20_000));
        interrupt(&child);
        // No code: the signal came before the program was ready for it.
        let code = child.wait().unwrap().code();
        assert!(matches!(code, Some(0 | 130) | None), "{code:?}");
        in_time += usize::from(code != Some(0));
        project.run(&["run"]).lines();
        assert_same(&made(&project), &wanted);
    }
    assert_eq!(in_time, interrupts);
}

/// Cells that never converge: each takes its cap of iterations.
fn slow() -> Project {
    let text = TABLE
        .replace("else=-1", "else=-$c")
        .replace("[4, 8]", "[4, 8, 16, 32, 64]")
        .replace("r = [10, 1]", "r = [1e-9]\nvary = { c = [1, 2, 3, 4, 5, 6] }");
    Project::with(&(text.replace("\"signed\"", "\"printed\"") + "max_iterations = 20000\n"))
}

/// A run, one task after the other, that another command starts.
fn under(project: &Project, words: &[&str]) -> Command {
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).args([env!("CARGO_BIN_EXE_signorini"), "run", "-v", "-j", "1"]);
    command.current_dir(project.path("."));
    command
}

/// Starts this command, sends the signal after the first task, and waits; how the command ended, and what it said.
fn signalled(command: &mut Command, signal: &str) -> Said {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut err = String::new();
    let mut reader = child.stderr.take().unwrap();
    let mut byte = [0];
    while !err.contains(": first run\n") && reader.read(&mut byte).unwrap() == 1 {
        err.push(char::from(byte[0]));
    }
    assert!(err.contains("\nran solve/a/"), "{err}");
    send(signal, &child);
    reader.read_to_string(&mut err).unwrap();
    Said { code: child.wait().unwrap().code(), out: String::new(), err }
}

#[test]
fn signals_that_ask_a_run_to_end_keep_finished_cells() {
    for signal in ["INT", "TERM", "HUP"] {
        let project = slow();
        // Whoever started the tests may have had this signal ignored.
        let said = signalled(&mut under(&project, &["env", "--default-signal=HUP"]), signal);
        assert_eq!(said.code, Some(130), "{signal}: {said:?}");
        let last = "error: interrupted; what was finished is kept, repeat the command to go on\n";
        assert!(said.err.ends_with(last), "{signal}: {said:?}");
        let finished = said.err.lines().filter(|line| line.starts_with("ran ")).count();
        assert!((1..6).contains(&finished), "{signal}: {said:?}");
        assert_eq!(project.stale().len(), 7 - finished, "cells that are not done, and the table");
    }
}

#[test]
fn a_run_that_is_to_outlive_its_terminal_does() {
    let project = slow();
    let said = signalled(&mut under(&project, &["nohup"]), "HUP");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(project.stale(), [""; 0]);
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
    // To the end it would take an hour, and all memory. Before it has begun, the signal ends the run at once.
    let ended = (0..16).find_map(|k| {
        let project = Project::with(scene);
        let mut command = project.command(&["run", "-v"]);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        lines.find(|line| line.contains(" to run")).unwrap();
        std::thread::sleep(Duration::from_millis(1 << k));
        send("TERM", &child);
        assert_eq!(child.wait().unwrap().code(), Some(130));
        let said: Vec<_> = lines.collect();
        said[0].starts_with("finishing what has begun").then(|| (said, project.stale()))
    });
    let (said, stale) = ended.expect("a signal after the beginning");
    assert!(said[1].starts_with("ended early: solve/a"), "{said:?}");
    assert_eq!(stale.len(), 2);
}

#[test]
fn an_interrupted_search_shows_what_it_has_found() {
    let project = Project::copied();
    let mut command = project.command(&["identify", "--json"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    wait_for_handler(&child);
    interrupt(&child);
    let said = Said::from(child.wait_with_output().unwrap());
    assert_eq!(said.code, Some(130), "{said:?}");
    let json = said.json();
    let mut problems = json["problems"].as_array().unwrap().iter();
    assert!(problems.any(|problem| problem["complete"] == false), "{json}");
}
