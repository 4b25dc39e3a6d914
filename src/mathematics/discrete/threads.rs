//! When work on nodal vectors is shared between threads.

/// Numbers that a task has at least: fewer take no longer than waking a thread.
pub(crate) const TASK: usize = 1 << 14;
/// Numbers from which on it pays to hand the work to the pool of threads and to sleep until it is done: this takes some
/// 30 microseconds, each time, for a caller that is none of them.
const WORTH_HANDING_OVER: usize = 1 << 17;

/// Whether work on so many numbers stays with the thread that asks for it.
pub(crate) fn stays(numbers: usize) -> bool {
    let outside = rayon::current_thread_index().is_none();
    rayon::current_num_threads() == 1 || (outside && numbers < WORTH_HANDING_OVER)
}

/// How many of so many items, of `size` numbers each, a task has at least.
pub(crate) fn items_per_task(items: usize, size: usize) -> usize {
    if stays(items * size) { items } else { TASK.div_ceil(size) }
}

/// Does work on so many numbers, that of several steps, among the threads of the pool: handed over once, not at each step.
pub(crate) fn among_threads<R: Send>(numbers: usize, work: impl FnOnce() -> R + Send) -> R {
    if stays(numbers) { work() } else { rayon::scope(|_| work()) }
}
