//! Plans of made-up tasks, walked in a temporary cache.

use super::super::{Artifacts, Inputs, Made, hash};
use super::*;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex};

/// A task that makes one artifact.
fn task(id: &str, needs: &[&str], byte: u8, make: fn(&u8, &Inputs) -> Made) -> Task {
    Task::new(id, &byte, needs.iter().map(|need| (*need).to_owned()).collect(), make)
}

/// The artifact `out` of one byte.
fn out(byte: u8) -> Artifacts {
    Artifacts::from([("out".into(), vec![byte])])
}

fn walk(plan: &Plan, cache: &Path, options: Options) -> Summary {
    let store = Store::new(cache).unwrap();
    execute(plan, &store, options, &Progress::new(false, true), &Interrupt::new()).unwrap()
}

#[test]
fn another_program_never_finds_the_results_of_the_first() {
    let cache = tempfile::tempdir().unwrap();
    let [old, new] = [("old", 1), ("new", 2)].map(|(program, damping): (&str, u8)| {
        // The byte of the first task stands for what the program has in its code.
        let first: fn(&u8, &Inputs) -> Made =
            if damping == 1 { |_, _| Ok(out(1)) } else { |_, _| Ok(out(2)) };
        let tasks =
            vec![task("a/1", &[], 0, first), task("b/1", &["a/1"], 7, |byte, _| Ok(out(*byte)))];
        Plan::new(hash(program.as_bytes()), tasks).unwrap()
    });
    let options = Options::default();
    let first = walk(&old, cache.path(), options);
    assert!(walk(&old, cache.path(), options).nothing_to_do());
    let dry = walk(&new, cache.path(), Options { dry_run: true, ..options });
    let verdicts: Vec<String> = dry.verdicts.iter().map(|j| j.verdict.to_string()).collect();
    let change = format!("{} -> {}", &hash(b"old")[..12], &hash(b"new")[..12]);
    assert_eq!(verdicts, [format!("stale: the program changed: {change}"), "waits for a/1".into()]);
    let second = walk(&new, cache.path(), options);
    assert_eq!(second.manifests["a/1"].outputs["out"], hash(&[2]), "the second program's");
    assert_eq!(second.manifests["b/1"].outputs, first.manifests["b/1"].outputs);
    // And back: the cache still has the artifacts of the first program.
    let back = walk(&old, cache.path(), options);
    assert!(back.ran.is_empty() && back.reverted);
    assert_eq!(back.manifests["a/1"].outputs["out"], hash(&[1]));
    // Where the latest run of a task is damaged, the others are not.
    let file = Store::new(cache.path()).unwrap().runs_file("a/1");
    let mut runs = std::fs::read(&file).unwrap();
    *runs.iter_mut().nth_back(9).unwrap() ^= 1;
    std::fs::write(&file, runs).unwrap();
    assert!(walk(&new, cache.path(), options).ran.is_empty());
    assert_eq!(walk(&old, cache.path(), options).ran.len(), 1);
}

#[test]
fn a_task_starts_when_all_it_needs_is_there_and_not_before_nor_after() {
    // `slow` ends only after `second`, of a later stage, has run: a barrier between stages would
    // never end.
    static ORDER: AtomicUsize = AtomicUsize::new(0);
    static SECOND_HAS_RUN: (Mutex<bool>, Condvar) = (Mutex::new(false), Condvar::new());
    let tasks = vec![
        task("a/slow", &[], 0, |_, _| {
            let has_run = SECOND_HAS_RUN.0.lock().unwrap();
            drop(SECOND_HAS_RUN.1.wait_while(has_run, |has_run| !*has_run).unwrap());
            Ok(out(0))
        }),
        task("a/first", &[], 0, |_, _| Ok(out(ORDER.fetch_add(1, Ordering::SeqCst) as u8))),
        task("b/second", &["a/first"], 0, |_, _| {
            *SECOND_HAS_RUN.0.lock().unwrap() = true;
            SECOND_HAS_RUN.1.notify_all();
            Ok(out(ORDER.fetch_add(1, Ordering::SeqCst) as u8))
        }),
    ];
    let plan = Plan::new("program", tasks).unwrap();
    let cache = tempfile::tempdir().unwrap();
    let summary = walk(&plan, cache.path(), Options { jobs: 2, ..Options::default() });
    let ran: Vec<&str> = summary.ran.iter().map(|ran| ran.task.as_str()).collect();
    assert_eq!(ran, ["a/slow", "a/first", "b/second"], "in the plan's order");
    assert_eq!(summary.manifests["b/second"].outputs["out"], hash(&[1]));
}

#[test]
fn a_panic_is_the_failure_of_one_task() {
    let tasks = vec![
        task("a/wild", &[], 0, |_, _| panic!("on purpose")),
        task("a/tame", &[], 1, |byte, _| Ok(out(*byte))),
        task("b/waits", &["a/tame", "a/wild"], 2, |byte, _| Ok(out(*byte))),
        task("c/waits", &["b/waits"], 3, |byte, _| Ok(out(*byte))),
    ];
    let plan = Plan::new("program", tasks).unwrap();
    let cache = tempfile::tempdir().unwrap();
    let summary = walk(&plan, cache.path(), Options { keep_going: true, ..Options::default() });
    assert!(summary.failed[0].starts_with("a/wild: panicked"), "{:?}", summary.failed);
    let waited = ["b/waits", "c/waits"].map(|id| format!("{id}: not run, because a/wild failed"));
    assert_eq!(summary.failed[1..], waited);
    assert!(summary.manifests.contains_key("a/tame"));
}

#[test]
fn a_task_that_takes_long_may_end_early() {
    let (cache, interrupt) = (tempfile::tempdir().unwrap(), Interrupt::new());
    let long =
        task("a/long", &[], 0, |_, inputs| match inputs.interrupted.load(Ordering::SeqCst) {
            true => Err(Error::Interrupted.into()),
            false => Ok(Artifacts::new()),
        });
    let store = Store::new(cache.path()).unwrap();
    interrupt.ask();
    for (asked, ends) in [(&interrupt, true), (&Interrupt::new(), false)] {
        let job = run::PreparedTask { task: &long, inputs: BTreeMap::new(), needed: Vec::new() };
        let ended = run::run(vec![job], &store, asked);
        assert_eq!(matches!(ended[0], Err(Error::Interrupted)), ends, "{ended:?}");
    }
}

#[test]
fn tasks_of_a_group_run_side_by_side_each_with_a_record_of_its_own() {
    static SIZES: Mutex<Vec<usize>> = Mutex::new(Vec::new());
    let made = |all: &[(u8, &Inputs)]| -> Vec<Made> {
        SIZES.lock().unwrap().push(all.len());
        assert!(all.len() == 1 || all.iter().all(|(byte, _)| *byte < 20), "on purpose");
        let each = |(byte, _): &(u8, &Inputs)| match byte {
            19 => Err("odd one out".into()),
            byte => Ok(out(*byte)),
        };
        all.iter().map(each).collect()
    };
    let plan = |bytes: &[u8]| {
        let group = |byte: u8| Some(Group { key: format!("tens {}", byte / 10), most: 3 });
        let task = |byte: &u8| Task::in_group(format!("a/{byte}"), byte, group(*byte), made);
        Plan::new("program", bytes.iter().map(task).collect()).unwrap()
    };
    let sizes = || std::mem::take(&mut *SIZES.lock().unwrap());
    let cache = tempfile::tempdir().unwrap();
    let options = Options { jobs: 1, ..Options::default() };
    let first = walk(&plan(&[0, 1, 10, 2, 3, 11]), cache.path(), options);
    assert_eq!(sizes(), [2, 2, 2], "at most three, in equal parts");
    assert_eq!(first.ran.len(), 6);
    assert_eq!(first.manifests["a/3"].outputs["out"], hash(&[3]));
    // One more is run alone, or with others that are stale.
    assert_eq!(walk(&plan(&[0, 1, 2, 3, 4]), cache.path(), options).ran.len(), 1);
    assert_eq!(sizes(), [1]);
    // No thread is left without work.
    walk(&plan(&[5, 6]), cache.path(), Options { jobs: 2, ..options });
    assert_eq!(sizes(), [1, 1]);
    // A failure is that of one task, and a panic too.
    let options = Options { keep_going: true, ..options };
    let failed = walk(&plan(&[17, 18, 19]), cache.path(), options);
    assert_eq!((failed.failed, failed.ran.len()), (vec!["a/19: odd one out".into()], 2));
    let panics = walk(&plan(&[20, 21]), cache.path(), options);
    assert_eq!((panics.failed.len(), panics.ran.len()), (0, 2));
    assert_eq!(sizes(), [3, 2, 1, 1]);
}

#[test]
fn what_is_at_work_is_counted() {
    let cache = tempfile::tempdir().unwrap();
    static INTERRUPT: Interrupt = Interrupt::new();
    let seen = task("a/1", &[], 0, |_, _| Ok(out(u8::from(INTERRUPT.is_at_work()))));
    let plan = Plan::new("program", vec![seen]).unwrap();
    let (store, progress) = (Store::new(cache.path()).unwrap(), Progress::new(false, true));
    let summary = execute(&plan, &store, Options::default(), &progress, &INTERRUPT).unwrap();
    assert_eq!(summary.manifests["a/1"].outputs["out"], hash(&[1]));
    assert!(!INTERRUPT.is_at_work());
}
