//! Walks the plan: looks each task up, and runs what is stale as soon as all it needs is there.

use super::manifest::{Manifest, Reason, Verdict};
use super::run::run;
use super::store::{Hit, Store};
use super::{Hashes, Judged, Options, Plan, Progress, Ran, Summary, Task, why};
use crate::pipeline::error::{Error, Result};
use rayon::prelude::*;
use rayon::{Scope, ThreadPool, ThreadPoolBuilder};
use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::Instant;

/// Walks the plan; what it writes goes to the cache only, whose lock the caller holds.
///
/// `interrupted` is looked at before each task starts; what has started is finished.
///
/// # Errors
/// [`Error::Input`] or [`Error::Io`] if the cache refuses; [`Error::Interrupted`].
/// Tasks that fail are in the summary, not errors.
pub fn execute(
    plan: &Plan,
    store: &Store,
    options: Options,
    progress: &Progress,
    interrupted: &AtomicBool,
) -> Result<Summary> {
    let mut walk = Walk {
        plan,
        store,
        options,
        progress,
        interrupted,
        states: plan.tasks().iter().map(|_| State::Waiting).collect(),
        summary: Summary::default(),
    };
    let stale = walk.judge()?;
    if !options.dry_run && !stale.is_empty() {
        walk.run(stale.into())?;
    }
    Ok(walk.finish())
}

/// How far a task is.
enum State {
    /// For a task that it needs.
    Waiting,
    /// Up to date, from the start or since it ran.
    Done(Manifest),
    /// To be run, running, or run in vain, for this reason.
    Stale(Reason),
}

/// A stale task that can run.
struct Job {
    task: usize,
    inputs: BTreeMap<String, String>,
    reason: Reason,
}

/// What came of it: which task, why and how long it ran, and what it made.
type Done = (usize, Ran, Result<Manifest>);

struct Walk<'a> {
    plan: &'a Plan,
    store: &'a Store,
    options: Options,
    progress: &'a Progress,
    interrupted: &'a AtomicBool,
    states: Vec<State>,
    summary: Summary,
}

impl<'a> Walk<'a> {
    /// Looks up all tasks that wait for none any more; returns those that have to run.
    fn judge(&mut self) -> Result<Vec<Job>> {
        let mut jobs = Vec::new();
        loop {
            let waits = |k: &usize| matches!(self.states[*k], State::Waiting);
            let is_ready = |k: &usize| self.waits_for(&self.plan.tasks()[*k]).is_none();
            let ready: Vec<usize> = (0..self.states.len()).filter(waits).filter(is_ready).collect();
            if ready.is_empty() {
                return Ok(jobs);
            }
            // Side by side: to read and hash artifacts is most of a run with nothing to do.
            let found: Vec<_> = ready.par_iter().map(|&k| self.look_up(k)).collect();
            for (task, (inputs, found)) in ready.into_iter().zip(found) {
                self.states[task] = match found {
                    Ok(hit) => {
                        self.summary.reverted |= hit.reverted;
                        if hit.reverted && !self.options.dry_run {
                            self.store.renew(&hit.manifest)?;
                        }
                        State::Done(hit.manifest)
                    }
                    Err(reason) => {
                        jobs.push(Job { task, inputs, reason: reason.clone() });
                        State::Stale(reason)
                    }
                };
            }
        }
    }

    /// The inputs of a task, and its run with these if the cache has it.
    fn look_up(&self, k: usize) -> (BTreeMap<String, String>, std::result::Result<Hit, Reason>) {
        let task = &self.plan.tasks()[k];
        let inputs = self.plan.inputs(task, |need| &self.manifest(need).outputs);
        let found = if self.options.force {
            Err(Reason::Forced)
        } else {
            self.store.lookup(&task.id, &inputs)
        };
        (inputs, found)
    }

    /// The first task that this one needs and that is not up to date.
    fn waits_for(&self, task: &Task) -> Option<&'a str> {
        let done = |need: &&String| matches!(self.states[self.index(need)], State::Done(_));
        let need = task.needs.iter().find(|need| !done(need))?;
        Some(&self.plan.tasks()[self.index(need)].id)
    }

    /// The stale task that this one cannot do without, if only by way of others.
    fn blocked_by(&self, task: &'a Task) -> &'a str {
        let mut last = task;
        while let Some(need) = self.waits_for(last) {
            last = &self.plan.tasks()[self.index(need)];
        }
        &last.id
    }

    fn index(&self, id: &str) -> usize {
        self.plan.index(id).expect("a plan has all that its tasks need")
    }

    fn manifest(&self, id: &str) -> &Manifest {
        match &self.states[self.index(id)] {
            State::Done(manifest) => manifest,
            _ => unreachable!("{id} is not up to date"),
        }
    }

    /// Runs stale tasks, and after them those that waited and turn out stale.
    fn run(&mut self, mut queue: VecDeque<Job>) -> Result<()> {
        let pool = threads(self.options.jobs)?;
        self.announce(&queue);
        let (send, receive) = channel();
        let mut broken = None;
        pool.in_place_scope(|scope| {
            let mut running = 0;
            loop {
                // No more than there are threads, so that an interrupt finds nothing else started.
                while running < pool.current_num_threads() && !self.stops() && broken.is_none() {
                    let Some(job) = queue.pop_front() else { break };
                    self.start(job, scope, &send);
                    running += 1;
                }
                if running == 0 {
                    break;
                }
                let done = receive.recv().expect("this end has a sender as well");
                running -= 1;
                match self.settle(done) {
                    Ok(jobs) => queue.extend(jobs),
                    Err(e) => broken = broken.take().or(Some(e)),
                }
            }
        });
        self.progress.end();
        match broken {
            Some(e) => Err(e),
            None if self.interrupted.load(Ordering::Relaxed) => Err(Error::Interrupted),
            None => Ok(()),
        }
    }

    /// Says how much is to be done, and why.
    fn announce(&self, queue: &VecDeque<Job>) {
        let done = self.states.iter().filter(|state| matches!(state, State::Done(_))).count();
        let reasons: Vec<&Reason> = queue.iter().map(|job| &job.reason).collect();
        self.progress.begin(self.states.len() - done, &why(&reasons));
    }

    fn stops(&self) -> bool {
        let failed = !self.summary.failed.is_empty() && !self.options.keep_going;
        failed || self.interrupted.load(Ordering::Relaxed)
    }

    /// Hands a job with what it reads to a thread, which reports to `send`.
    fn start<'s>(&self, job: Job, scope: &Scope<'s>, send: &Sender<Done>)
    where
        'a: 's,
    {
        let (send, store) = (send.clone(), self.store);
        let task = &self.plan.tasks()[job.task];
        self.progress.start(&task.id);
        let needed = |need: &String| (need.clone(), self.manifest(need).outputs.clone());
        let needed: Vec<(String, Hashes)> = task.needs.iter().map(needed).collect();
        scope.spawn(move |_| {
            let start = Instant::now();
            let result = run(task, job.inputs, needed, store);
            let ran = Ran { task: task.id.clone(), reason: job.reason, time: start.elapsed() };
            // The receiver lives as long as the scope.
            let _ = send.send((job.task, ran, result));
        });
    }

    /// Notes what came of a task; returns those that waited and now have to run.
    fn settle(&mut self, (task, ran, result): Done) -> Result<Vec<Job>> {
        self.progress.done(&ran, result.is_ok());
        match result {
            Ok(manifest) => {
                self.states[task] = State::Done(manifest);
                self.summary.ran.push(ran);
            }
            Err(Error::Stage(reasons)) => self.summary.failed.extend(reasons),
            Err(other) => return Err(other),
        }
        let is_waiting = |k: &usize| matches!(self.states[*k], State::Waiting);
        let waited: Vec<usize> = (0..self.states.len()).filter(is_waiting).collect();
        let jobs = self.judge()?;
        for k in waited {
            if matches!(self.states[k], State::Done(_)) {
                self.progress.skip();
            }
        }
        Ok(jobs)
    }

    /// The summary, when nothing runs any more.
    fn finish(mut self) -> Summary {
        let mut ran: BTreeMap<String, Ran> =
            self.summary.ran.drain(..).map(|ran| (ran.task.clone(), ran)).collect();
        for (k, task) in self.plan.tasks().iter().enumerate() {
            let id = &task.id;
            let verdict = match &self.states[k] {
                State::Done(_) => {
                    ran.get(id).map_or(Verdict::Fresh, |ran| Verdict::Stale(ran.reason.clone()))
                }
                State::Stale(reason) => Verdict::Stale(reason.clone()),
                State::Waiting => Verdict::Waits(self.waits_for(task).unwrap_or_default().into()),
            };
            if self.options.keep_going && matches!(verdict, Verdict::Waits(_)) {
                let failed = self.blocked_by(task);
                self.summary.failed.push(format!("{id}: not run, because {failed} failed"));
            }
            self.summary.verdicts.push(Judged { task: id.clone(), verdict });
            self.summary.ran.extend(ran.remove(id));
        }
        let states = self.plan.tasks().iter().zip(self.states);
        self.summary.manifests = states
            .filter_map(|(task, state)| match state {
                State::Done(manifest) => Some((task.id.clone(), manifest)),
                _ => None,
            })
            .collect();
        self.summary
    }
}

fn threads(jobs: usize) -> Result<ThreadPool> {
    ThreadPoolBuilder::new()
        .num_threads(jobs)
        .thread_name(|k| format!("worker {}", k + 1))
        .build()
        .map_err(|e| Error::input(format!("cannot start threads: {e}; use fewer with -j")))
}

#[cfg(test)]
mod tests;
