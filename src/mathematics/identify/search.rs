//! The search: exhaustive enumeration of a lattice, or annealing from many starts.
//!
//! Work is cut into numbered items, each with its own seed; rayon deals them out in batches of fixed
//! size, an item knows only what earlier batches of its block found, and results are merged in an order
//! of their own. What is found therefore depends on the request alone, not on the number of threads or on how often the
//! search was interrupted and resumed.

use super::plan::{BLOCK, Item, Live, Plan};
use super::rank::{Best, Found};
use super::request::Request;
use super::{IdentifyError, Target};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Items between two checkpoints.
const BATCH: u64 = 8;
/// Time between two reports of progress within a batch.
const TICK: Duration = Duration::from_millis(100);

/// When to stop early; what was found until then is kept.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Time after which to stop, as if the stop flag had been set.
    pub time: Option<Duration>,
    /// Worker threads; none for as many as rayon's global pool has.
    pub threads: Option<usize>,
    /// The time since some moment.
    pub clock: fn() -> Duration,
}

impl Default for Budget {
    /// No limit, and a clock that stands still.
    fn default() -> Self {
        Self { time: None, threads: None, clock: || Duration::ZERO }
    }
}

/// State of a search between two batches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(super) request: Request,
    pub(super) target: Target,
    pub(super) next: u64,
    /// What the finished blocks found.
    pub(super) best: Best,
    /// What the block under way has found.
    block: Best,
    /// Candidates tried.
    pub(super) tried: u64,
    pub(super) entered: Vec<u64>,
}

impl Checkpoint {
    /// The state to resume from, or that before the first item of a plan.
    fn first(
        resume: Option<Self>,
        request: &Request,
        target: &Target,
        plan: &Plan,
    ) -> Result<Self, IdentifyError> {
        if let Some(state) = resume {
            let own = state.request == *request && state.target == *target;
            return if own { Ok(state) } else { Err(IdentifyError::ForeignCheckpoint) };
        }
        Ok(Self {
            request: request.clone(),
            target: target.clone(),
            next: plan.items.start,
            best: Best::new(request.top),
            block: Best::new(request.top),
            tried: 0,
            entered: vec![0; target.levels()],
        })
    }

    /// The best so far, with what a batch cut short has found.
    fn all(&self, cut_short: Option<Best>) -> Best {
        let mut all = self.best.clone();
        all.merge(cut_short.unwrap_or_else(|| self.block.clone()));
        all
    }

    /// What an observer sees of a search that began with these numbers of runs on each grid.
    fn progress(&self, plan: &Plan, live: &Live, before: &[u64], elapsed: Duration) -> Progress {
        let best = f64::from_bits(live.best.load(Ordering::Relaxed));
        Progress {
            items: (self.next - plan.items.start, plan.items.end - plan.items.start),
            tried: live.tried.load(Ordering::Relaxed),
            entered: self.entered.iter().zip(before).map(|(now, before)| now - before).collect(),
            elapsed,
            best: best.is_finite().then_some(best),
        }
    }

    fn count(&mut self, done: &[Item]) {
        for item in done {
            self.tried += item.tried;
            self.entered.iter_mut().zip(&item.entered).for_each(|(sum, n)| *sum += n);
        }
    }

    /// Adds a whole batch, of which `block` has the best, up to item `end`.
    fn take(&mut self, done: &[Item], block: Best, end: u64, plan: &Plan) {
        self.block = block;
        self.count(done);
        self.next = end;
        if end.is_multiple_of(BLOCK) || end == plan.items.end {
            self.best = self.all(None);
            self.block = Best::new(self.request.top);
        }
    }
}

/// Runs a batch of items, in the light of what the block has found before.
fn run_all(items: Range<u64>, plan: &Plan, block: &Best, live: &Live) -> Vec<Item> {
    let items = items.collect::<Vec<_>>().into_par_iter().with_max_len(1);
    let workspace = || plan.evaluator.clone().halted_by(live.halt);
    items.map_init(workspace, |e, item| plan.run(item, e, block, live)).collect()
}

/// What an observer sees, ten times a second and after each batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Items done, and in all.
    pub items: (u64, u64),
    /// Candidates tried since the search began or was resumed.
    pub tried: u64,
    /// Runs that reached each grid since then, in whole batches.
    pub entered: Vec<u64>,
    /// Time since then.
    pub elapsed: Duration,
    /// Smallest objective so far.
    pub best: Option<f64>,
}

/// What a search found. It serialises to the artifact of the pipeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Version of this format.
    pub schema: u8,
    /// What was asked.
    pub request: Request,
    /// Whether every item was done.
    pub complete: bool,
    /// Candidates tried.
    pub tried: u64,
    /// Runs that reached each grid: how the screening went.
    pub entered: Vec<u64>,
    /// The best, in order: those with every count first, then by [`super::Score::total`].
    pub found: Vec<Found>,
}

/// Runs a batch on other threads, and meanwhile calls `tick` on this one, ten times a second; nothing if a
/// worker panicked.
fn in_pool<T: Send>(
    pool: Option<&rayon::ThreadPool>,
    run: impl FnOnce() -> Vec<T> + Send,
    mut tick: impl FnMut(),
) -> Vec<T> {
    std::thread::scope(|scope| {
        let (sender, finished) = channel();
        scope.spawn(move || {
            let done = match pool {
                Some(pool) => pool.install(run),
                None => run(),
            };
            sender.send(done)
        });
        loop {
            match finished.recv_timeout(TICK) {
                Ok(done) => return done,
                Err(RecvTimeoutError::Timeout) => tick(),
                Err(RecvTimeoutError::Disconnected) => return Vec::new(),
            }
        }
    })
}

/// Searches, or goes on from a checkpoint.
///
/// `observe` is called on the calling thread; after a batch it is given the state to resume from.
/// When `stop` is set or the time is over, workers stop within a tick, in the midst of a candidate if need
/// be: a published count may be larger than anybody waits for. What they found by then is reported, but
/// their batch will be done again when the search is resumed.
///
/// # Errors
/// [`IdentifyError`] if the request makes no sense or the checkpoint is of another one.
pub fn search(
    request: &Request,
    target: &Target,
    budget: Budget,
    resume: Option<Checkpoint>,
    stop: &AtomicBool,
    observe: &mut dyn FnMut(&Progress, Option<&Checkpoint>),
) -> Result<Report, IdentifyError> {
    let halt = AtomicBool::new(false);
    let plan = Plan::new(request, target)?;
    let mut state = Checkpoint::first(resume, request, target, &plan)?;
    let pool =
        budget.threads.and_then(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().ok());
    let began = (budget.clock)();
    let elapsed = || (budget.clock)().saturating_sub(began);
    let live = Live::new(stop, &halt, &state.all(None));
    let entered_before = state.entered.clone();
    let progress = |state: &Checkpoint| state.progress(&plan, &live, &entered_before, elapsed());
    let look_up = || {
        let late = budget.time.is_some_and(|time| elapsed() >= time);
        halt.fetch_or(late || stop.load(Ordering::Relaxed), Ordering::Relaxed);
    };
    if plan.items.is_empty() {
        // A part may be one of more parts than there are blocks.
        observe(&progress(&state), Some(&state));
    }
    let mut cut_short = None;
    while state.next < plan.items.end {
        look_up();
        let batch = state.next..(state.next + BATCH).min(plan.items.end);
        let run = || run_all(batch.clone(), &plan, &state.block, &live);
        let done = in_pool(pool.as_ref(), run, || {
            observe(&progress(&state), None);
            look_up();
        });
        let whole = !done.is_empty() && done.iter().all(|item| item.whole);
        let mut block = state.block.clone();
        done.iter().for_each(|item| block.merge(item.best.clone()));
        if !whole {
            // No observer keeps this state: a resumed search does the batch again.
            state.count(&done);
            cut_short = Some(block);
            break;
        }
        state.take(&done, block, batch.end, &plan);
        observe(&progress(&state), Some(&state));
    }
    let complete = state.next == plan.items.end;
    Ok(Report {
        schema: 1,
        request: request.clone(),
        complete,
        found: plan.explain(&state.all(cut_short)),
        tried: state.tried,
        entered: state.entered,
    })
}
