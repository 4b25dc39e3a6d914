//! Faults: whatever breaks, a run ends with the right result or one clear line, and the next run repairs.

use crate::common::{Dice, EVERYTHING, Project, Said, TABLE, assert_same, promised, wanting};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::PathBuf;
use std::process::Stdio;
use std::time::{Duration, SystemTime};

/// Task id before the first slash, or `objects`: the kinds of file in a cache.
fn by_kind(project: &Project) -> BTreeMap<String, Vec<PathBuf>> {
    let mut kinds = BTreeMap::<String, Vec<PathBuf>>::new();
    for name in project.files(".signorini/v2").into_keys() {
        let parts: Vec<&str> = name.split('/').collect();
        let kind = if parts[0] == "tasks" { parts[1] } else { parts[0] };
        kinds.entry(kind.into()).or_default().push(project.path(".signorini/v2").join(&name));
    }
    kinds
}

#[test]
fn every_damaged_file_of_the_cache_is_noticed_and_repaired() {
    let project = Project::with(&(wanting(EVERYTHING) + "paper_table = 1\n"));
    project.run(&["run"]).lines();
    let made = project.made();
    let kinds = by_kind(&project);
    let names: Vec<&str> = kinds.keys().map(String::as_str).collect();
    assert_eq!(names, ["diff", "figures", "objects", "solve", "tabulate"]);
    let mut dice = Dice(1);
    let mut repaired = 0;
    // Each object, and one manifest of each kind of task.
    for (kind, files) in kinds {
        let count = if kind == "objects" { files.len() } else { 1 };
        for file in &files[..count] {
            let bytes = fs::read(file).unwrap();
            let mut flipped = bytes.clone();
            // Half way in: inside a value of a manifest, not in white space.
            let at = (bytes.len() / 2..bytes.len())
                .find(|&k| bytes[k].is_ascii_alphanumeric() || bytes[k] == 0);
            flipped[at.unwrap()] ^= 1 << dice.below(4);
            let truncated = &bytes[..dice.below(bytes.len() as u64) as usize];
            for damage in [None, Some(truncated), Some(&flipped), Some(b"")] {
                match damage {
                    None => fs::remove_file(file).unwrap(),
                    Some(bytes) => fs::write(file, bytes).unwrap(),
                }
                assert_eq!(
                    project.run(&["status", "--exit-code"]).code,
                    Some(1),
                    "{}",
                    file.display()
                );
                let ran = project.run(&["run", "-v"]);
                assert_eq!(ran.ran().len(), 1, "only what was damaged: {ran:?}");
                assert_same(&project.made(), &made);
                repaired += 1;
            }
        }
    }
    let kinds = ["deleted", "truncated", "with a flipped bit", "emptied"];
    let counts = kinds.map(|kind| promised(&format!("File of the cache {kind}")));
    assert_eq!(counts, [repaired / 4; 4]);
}

#[test]
fn a_record_edited_by_hand_removes_no_input_and_nothing_elsewhere() {
    let project = Project::with(TABLE);
    project.add_book("# One\n");
    project.run(&["run"]).lines();
    project.write("notes.txt", "mine");
    fs::create_dir_all(project.path("figures")).unwrap();
    project.write("figures/old.svg", "made once");
    let mut text = project.read("pipeline/lock.toml");
    let kept = [
        "notes.txt",
        "pipeline/scenes/a.toml",
        "report/templates/SUMMARY.md",
        "report/templates/one.md",
    ];
    for path in kept.into_iter().chain(["figures/old.svg"]) {
        let hash = signorini::pipeline::hash(&fs::read(project.path(path)).unwrap());
        text += &format!("\"{path}\" = \"{hash}\"\n");
    }
    project.write("pipeline/lock.toml", text);
    let said = project.run(&["run"]);
    assert!(said.lines().contains(&"removed figures/old.svg"), "{said:?}");
    assert!(!project.path("figures/old.svg").exists());
    assert!(kept.iter().all(|path| project.path(path).exists()));
}

#[test]
fn a_second_run_at_once_is_told_who_runs() {
    let project = Project::with(TABLE);
    project.run(&["run"]).lines();
    let lock = project.path("pipeline/.lock");
    fs::write(&lock, "process 4711\n").unwrap();
    let held = File::options().read(true).write(true).open(&lock).unwrap();
    held.try_lock().unwrap();
    project.run(&["run"]).nothing_to_do(); // to look is allowed
    let said = project.run(&["run", "--force"]);
    assert!(said.refusal().contains("another signorini (process 4711) is at work in "), "{said:?}");
    assert!(said.refusal().ends_with("; wait for it"), "{said:?}");
    assert_eq!(project.run(&["status", "--exit-code"]).code, Some(0));
    // Another cache is no way round: both would write to one project.
    let other = ["run", "--cache-dir", "elsewhere"];
    project.run(&other).refusal();
    drop(held);
    project.run(&other).lines();
    let cache = project.path("elsewhere/lock");
    let held = File::options().read(true).write(true).open(&cache).unwrap();
    held.try_lock().unwrap();
    project.run(&["gc", "--cache-dir", "elsewhere"]).refusal();
    drop(held);
    project.run(&["run"]).nothing_to_do();
}

/// Starts as many pairs of runs at once in one project, by turns with one cache and with two, each pair after `before`
/// and followed by `after`.
pub(crate) fn pairs_of_runs_at_once(
    project: &Project,
    (args, pairs): (&[&str], usize),
    before: impl Fn(),
    after: impl Fn(),
) {
    let mut refused = 0;
    for pair in 0..pairs {
        before();
        let caches = if pair % 2 == 0 { [".signorini"; 2] } else { [".signorini", "second"] };
        let both = caches.map(|cache| {
            let mut command = project.command(&[args, &["--cache-dir", cache]].concat());
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
        });
        let both = both.map(|run| Said::from(run.wait_with_output().unwrap()));
        for said in both.iter().filter(|said| said.code != Some(0)) {
            assert!(said.refusal().contains("another signorini ("), "{said:?}");
            refused += 1;
        }
        assert!(both.iter().any(|said| said.code == Some(0)), "one of them ran: {both:?}");
        after();
    }
    eprintln!("{refused} of {pairs} second runs came while the first was at work");
}

/// Pairs of runs that make all of a small project.
fn pairs_of_small_runs(pairs: usize) {
    let [reference, project] = [(); 2].map(|()| Project::with(&wanting(EVERYTHING)));
    reference.run(&["run"]).lines();
    let wanted = reference.made();
    let after = || {
        assert_eq!(project.run(&["run"]).code, Some(0));
        assert_same(&project.made(), &wanted);
        assert_eq!(project.leftovers(), [""; 0]);
    };
    pairs_of_runs_at_once(&project, (&["run", "--force"], pairs), || (), after);
}

#[test]
fn two_runs_started_at_once_do_not_disturb_each_other() {
    pairs_of_small_runs(promised("Two runs started at once"));
}

#[test]
#[ignore = "takes a minute; run with --ignored"]
fn two_hundred_pairs_of_runs_at_once_do_not_disturb_each_other() {
    pairs_of_small_runs(promised("Two runs started at once, in the long tests"));
}

#[test]
fn what_the_clock_says_does_not_matter() {
    let project = Project::with(&wanting(EVERYTHING));
    project.run(&["run"]).lines();
    let made = project.made();
    let mut wrong = 0;
    // 1980 and 2100.
    for seconds in [315_532_800, 4_102_444_800] {
        let then = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
        let date =
            |file: &PathBuf| File::options().write(true).open(file).unwrap().set_modified(then);
        project.times().keys().for_each(|file| date(file).unwrap());
        project.run(&["run"]).nothing_to_do(); // dated, not changed
        wrong += 1;
        let edited = project.path("pipeline/scenes/a.toml");
        project.scene("a", &wanting(EVERYTHING).replace("else=-1", "else=-2"));
        date(&edited).unwrap();
        assert_eq!(project.run(&["run", "-v"]).ran().len(), 7, "changed, whatever the date");
        wrong += 1;
        project.scene("a", &wanting(EVERYTHING));
        project.run(&["run"]).lines();
        for (name, bytes) in project.files("figures") {
            assert!(made[&format!("figures/{name}")] == bytes, "{name}");
        }
        fs::remove_dir_all(project.path(".signorini")).unwrap();
        project.run(&["run"]).lines();
        assert_same(&project.made(), &made);
    }
    assert_eq!(wrong, promised("Clock set back or ahead"));
}

#[test]
fn what_goes_with_an_output_that_the_chapters_show_is_named() {
    let project = Project::whole();
    let dry_run = || project.run(&["run", "--dry-run"]).lines()[0].to_owned();
    let times = fs::read(project.path("pipeline/timings.toml")).unwrap();
    fs::remove_file(project.path("pipeline/timings.toml")).unwrap();
    assert!(dry_run().ends_with(": they show recorded times; restore pipeline/timings.toml"));
    project.write("pipeline/timings.toml", times);
    let scene = project.read("pipeline/scenes/problem1.toml");
    let without = scene.replace("\"history\", ", "");
    assert_ne!(without, scene);
    project.scene("problem1", &without);
    let reason = "the book leaves out all pages from *.md.tera: they show scene `problem1`; add \"history\" to \
        `outputs`";
    assert_eq!(dry_run(), reason);
    let said = project.run(&["run"]);
    let lines = said.lines();
    let removed = lines.iter().find(|line| line.starts_with("removed figures/cost.csv, "));
    assert!(
        lines[0] == reason && removed.is_some_and(|line| line.contains("figures/rules.svg")),
        "{said:?}"
    );
}
