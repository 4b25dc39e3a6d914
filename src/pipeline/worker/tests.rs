//! Single tasks of a made-up plan, by several workers on one cache.

use super::super::{Artifacts, Inputs};
use super::*;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `a/1`, and `b/1` that adds its needs' bytes to its own; each counts how often it ran.
fn plan(value: u8, ran: &Arc<AtomicUsize>) -> Plan {
    plan_of("program", [value; 2], ran)
}

/// The same with a value for each, for this program.
fn plan_of(program: &str, [a, b]: [u8; 2], ran: &Arc<AtomicUsize>) -> Plan {
    let task = |id: &str, value: u8, needs: &[&str]| {
        let ran = ran.clone();
        let parameters = BTreeMap::from([("value".into(), value.to_string())]);
        let needs = needs.iter().map(|need| (*need).to_owned()).collect();
        Task::new(id, parameters, needs, move |inputs: &Inputs| {
            ran.fetch_add(1, Ordering::SeqCst);
            let needed = inputs.artifacts.values().flat_map(|made| made.values().flatten());
            Ok(Artifacts::from([("out".into(), vec![value + needed.sum::<u8>()])]))
        })
    };
    Plan::new(program, vec![task("a/1", a, &[]), task("b/1", b, &["a/1"])]).unwrap()
}

fn work_on(plan: &Plan, asked: &[&str], cache: &Path) -> Result<Summary> {
    let asked: Vec<String> = asked.iter().map(|id| (*id).to_owned()).collect();
    work(plan, &asked, &Store::new(cache).unwrap(), &Progress::new(false, true))
}

#[test]
fn a_stamp_names_all_that_a_task_is_made_from() {
    let stamps =
        |program: &str, values| plan_of(program, values, &Arc::new(AtomicUsize::new(0))).stamps();
    let one = stamps("program", [1, 1]);
    let changed = |other: Vec<String>| [0, 1].map(|k| one[k] != other[k]);
    assert_eq!(changed(stamps("program", [1, 1])), [false, false]);
    assert_eq!(changed(stamps("program", [1, 2])), [false, true]);
    assert_eq!(changed(stamps("program", [2, 1])), [true, true], "what is needed counts too");
    assert_eq!(changed(stamps("another", [1, 1])), [true, true]);
}

#[test]
fn garbage_keeps_the_stamps_of_runs_that_it_keeps() {
    let (cache, ran) = (tempfile::tempdir().unwrap(), Arc::new(AtomicUsize::new(0)));
    let store = Store::new(cache.path()).unwrap();
    let wanted = BTreeSet::from(["a/1".to_owned(), "b/1".to_owned()]);
    let there = |plan: &Plan| plan.stamps().iter().all(|s| store.stamp_file(s).exists());
    let [old, new] = [plan(1, &ran), plan(2, &ran)];
    for plan in [&old, &new] {
        work_on(plan, &["a/1", "b/1"], cache.path()).unwrap();
        assert!(there(plan));
    }
    store.collect_garbage(&wanted, 2, false).unwrap();
    assert!(there(&old) && there(&new));
    store.collect_garbage(&wanted, 1, false).unwrap();
    assert!(there(&new) && old.stamps().iter().all(|s| !store.stamp_file(s).exists()));
    // Two objects, two manifests and two stamps; the locks have gone already.
    let garbage = store.collect_garbage(&BTreeSet::new(), 1, true).unwrap();
    assert_eq!(garbage.files, 6, "{garbage:?}");
}

#[test]
fn an_edit_and_back_again_runs_nothing_twice() {
    let (cache, ran) = (tempfile::tempdir().unwrap(), Arc::new(AtomicUsize::new(0)));
    for value in [1, 2, 1, 2] {
        work_on(&plan(value, &ran), &["a/1", "b/1"], cache.path()).unwrap();
    }
    assert_eq!(ran.load(Ordering::SeqCst), 4);
}
