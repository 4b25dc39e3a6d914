//! When work on nodal vectors is shared between threads.

use rayon::iter::{IndexedParallelIterator, MinLen};

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

/// Least number of some items, each of `size` numbers, a task has at least.
fn items_per_task(items: usize, size: usize) -> usize {
    if stays(items * size) { items } else { TASK.div_ceil(size) }
}

/// Does work of several steps on so many numbers among the threads: it is handed over once, not at each step.
pub(crate) fn among_threads<R: Send>(numbers: usize, work: impl FnOnce() -> R + Send) -> R {
    if stays(numbers) { work() } else { rayon::scope(|_| work()) }
}

#[cfg(test)]
mod tests {
    use super::*;

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
