//! Single tasks of a made-up plan, by several workers on one cache.

use super::super::{Artifacts, Inputs, Task};
use super::*;
use std::path::Path;

/// Plan of `a/1` and `b/1` with one value.
fn plan(value: u8) -> Plan {
    plan_of("program", [value; 2])
}

/// Plan, for this program, of `a/1`, and of `b/1`, which adds the bytes of `a/1` to its own.
fn plan_of(digest: &str, [a, b]: [u8; 2]) -> Plan {
    let tasks = vec![task("a/1", a, &[]), task("b/1", b, &["a/1"])];
    Plan::new(digest, tasks).unwrap()
}

fn task(id: &str, value: u8, needs: &[&str]) -> Task {
    let needs = needs.iter().map(|need| (*need).to_owned()).collect();
    Task::new(id, &value, needs, |value, inputs: &Inputs| {
        let needed = inputs.artifacts.values().flat_map(|made| made.values().flatten());
        Ok(Artifacts::from([("out".into(), vec![value + needed.sum::<u8>()])]))
    })
}

fn work_on(plan: &Plan, asked: &[&str], cache: &Path) -> Result<Summary> {
    let asked: Vec<String> = asked.iter().map(|id| (*id).to_owned()).collect();
    let (store, progress) = (Store::new(cache).unwrap(), Progress::new(false, true));
    work(plan, &asked, &store, &progress, &Interrupt::new())
}

#[test]
fn a_stamp_names_all_that_a_task_is_made_from() {
    let stamps = plan_of("program", [1, 1]).stamps().unwrap();
    for (program, values, changed) in [
        ("program", [1, 1], [false, false]),
        ("program", [1, 2], [false, true]),
        // The stamp of `b/1` stands for the inputs of `a/1` too.
        ("program", [2, 1], [true, true]),
        ("another", [1, 1], [true, true]),
    ] {
        let others = plan_of(program, values).stamps().unwrap();
        assert_eq!([0, 1].map(|k| stamps[k] != others[k]), changed, "{program} {values:?}");
    }
}

#[test]
fn garbage_keeps_the_stamps_of_runs_that_it_keeps() {
    let cache = tempfile::tempdir().unwrap();
    let store = Store::new(cache.path()).unwrap();
    let [old, new] = [plan(1), plan(2)];
    for plan in [&old, &new] {
        work_on(plan, &["a/1", "b/1"], cache.path()).unwrap();
        assert_eq!(stamps_in(&store, plan), 2);
    }
    store.collect_garbage(&new, 2, false).unwrap();
    assert_eq!([&old, &new].map(|plan| stamps_in(&store, plan)), [2, 2]);
    // One run of each task, and those that a run of this plan finds.
    store.collect_garbage(&old, 1, false).unwrap();
    assert_eq!([&old, &new].map(|plan| stamps_in(&store, plan)), [2, 2]);
    store.collect_garbage(&new, 1, false).unwrap();
    assert_eq!([&old, &new].map(|plan| stamps_in(&store, plan)), [0, 2]);
    // Two objects, two manifests and two stamps; the locks have gone already.
    let garbage =
        store.collect_garbage(&Plan::new("program", Vec::new()).unwrap(), 1, true).unwrap();
    assert_eq!(garbage.files, 6, "{garbage:?}");
}

/// Number of stamps of a plan in a cache.
fn stamps_in(store: &Store, plan: &Plan) -> usize {
    plan.stamps().unwrap().iter().filter(|stamp| store.stamp_file(stamp).exists()).count()
}

#[test]
fn an_edit_and_back_again_runs_nothing_twice() {
    let cache = tempfile::tempdir().unwrap();
    let ran = [1, 2, 1, 2]
        .map(|value| work_on(&plan(value), &["a/1", "b/1"], cache.path()).unwrap().ran.len());
    assert_eq!(ran, [2, 2, 0, 0]);
}
