//! When work on nodal vectors is shared between threads.

use rayon::iter::{IndexedParallelIterator, MinLen};
use std::ops::Range;

/// Numbers that a task has at least: fewer take no longer than waking a thread.
pub(crate) const TASK: usize = 1 << 14;
/// Numbers from which on a caller that is none of the threads hands its work to them, and sleeps until it is done.
/// That takes some 30 microseconds, each time.
const WORTH_HANDING_OVER: usize = 1 << 17;

/// True if work on so many numbers stays with the caller, who may be the only thread or do better alone.
pub(crate) fn stays(numbers: usize) -> bool {
    let outside = rayon::current_thread_index().is_none();
    rayon::current_num_threads() == 1 || (outside && numbers < WORTH_HANDING_OVER)
}

/// The items, each of `size` numbers, in tasks that are worth a thread's while.
pub(crate) fn in_tasks<I: IndexedParallelIterator>(items: I, size: usize) -> MinLen<I> {
    let each = items_per_task(items.len(), size);
    items.with_min_len(each)
}

/// Number of items, each of `size` numbers, that are worth a thread's while: all of them where one thread does better.
pub(crate) fn items_per_task(items: usize, size: usize) -> usize {
    if stays(items * size) { items.max(1) } else { TASK.div_ceil(size) }
}

/// Does both, side by side where a thread is free; returns both results.
pub(crate) fn join<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    let (mut one, mut other) = (Some(one), Some(other));
    let (mut of_one, mut of_other) = (None, None);
    both(
        &mut || {
            of_one = one.take().map(|one| one());
        },
        &mut || {
            of_other = other.take().map(|other| other());
        },
    );
    (of_one.expect("called once"), of_other.expect("called once"))
}

/// Hands work to other threads: compiled once here, and not for each kind of work, which would be a fifth of the
/// package.
fn both(one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
    rayon::join(one, other);
}

/// Returns the values of a function at some items, in their order; a task has `least` items.
pub(crate) fn map<'a, T: Sync, R: Send>(
    items: &'a [T],
    least: usize,
    value: impl Fn(&'a T) -> R + Sync,
) -> Vec<R> {
    map_range(0..items.len(), least, |k| value(&items[k]))
}

/// Returns the values of a function at some numbers, in their order; a task has `least` of them.
pub(crate) fn map_range<R: Send>(
    numbers: Range<usize>,
    least: usize,
    value: impl Fn(usize) -> R + Sync,
) -> Vec<R> {
    map_with_room(numbers, least, || (), |(), k| value(k))
}

/// As [`map_range`]; each task has room of its own.
pub(crate) fn map_with_room<S, R: Send>(
    numbers: Range<usize>,
    least: usize,
    room: impl Fn() -> S + Sync,
    value: impl Fn(&mut S, usize) -> R + Sync,
) -> Vec<R> {
    let mut values: Vec<Option<R>> = Vec::new();
    values.resize_with(numbers.len(), || None);
    for_runs(&mut values, least, &|run, places: &mut [Option<R>]| {
        let mut room = room();
        for (k, place) in (numbers.start + run * least..).zip(places) {
            *place = Some(value(&mut room, k));
        }
    });
    values.into_iter().map(|value| value.expect("each place is filled")).collect()
}

/// Changes a slice in runs of so many numbers, each by its number among them.
pub(crate) fn for_runs<T: Send>(
    all: &mut [T],
    run: usize,
    change: &(dyn Fn(usize, &mut [T]) + Sync),
) {
    let runs = all.len().div_ceil(run);
    halve(all, 0..runs, run, change);
}

fn halve<T: Send>(
    all: &mut [T],
    runs: Range<usize>,
    run: usize,
    change: &(dyn Fn(usize, &mut [T]) + Sync),
) {
    if runs.len() < 2 {
        return runs.for_each(|number| change(number, all));
    }
    let middle = runs.start + runs.len() / 2;
    let (one, other) = all.split_at_mut((middle - runs.start) * run);
    both(&mut || halve(one, runs.start..middle, run, change), &mut || {
        halve(other, middle..runs.end, run, change);
    });
}

/// Does work of several steps on so many numbers among the threads: it is handed over once, not at each step.
pub(crate) fn among_threads<R: Send>(numbers: usize, work: impl FnOnce() -> R + Send) -> R {
    if stays(numbers) { work() } else { rayon::scope(|_| work()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_in_their_order_whatever_the_runs() {
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("three threads can be had").install(|| {
                for (count, run) in [(0, 3), (1, 1), (7, 1), (9, 3), (10, 3), (11, 100)] {
                    let squares: Vec<_> = (5..5 + count).map(|k| k * k).collect();
                    let found = map_with_room(5..5 + count, run, Vec::new, |room, k| {
                        room.push(k);
                        room[room.len() - 1] * k
                    });
                    assert_eq!(found, squares);
                    let mut runs = vec![0; count];
                    for_runs(&mut runs, run, &|number, run| run.fill(number));
                    assert_eq!(runs, (0..count).map(|k| k / run).collect::<Vec<_>>());
                }
                assert_eq!(join(|| 1, || "two"), (1, "two"));
            });
        }
    }

    #[test]
    fn little_work_stays_and_much_is_handed_over() {
        let in_pool = |numbers| among_threads(numbers, || rayon::current_thread_index().is_some());
        assert!(!in_pool(WORTH_HANDING_OVER - 1));
        assert_eq!(in_pool(WORTH_HANDING_OVER), rayon::current_num_threads() > 1);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let items =
                pool.expect("two threads can be had").install(|| items_per_task(9, TASK / 2));
            assert_eq!(items, if threads == 1 { 9 } else { 2 });
        }
    }
}
