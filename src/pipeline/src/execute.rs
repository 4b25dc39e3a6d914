//! Walk of the plan: looks each task up in the cache, and runs the stale ones as soon as all they need is up to date.
//!
//! Central is [`execute`].

use super::manifest::{Manifest, Reason, Verdict};
use super::names::in_shell;
use super::run;
use super::store::{Hit, Store};
use super::{Group, Interrupt, Judged, Options, Plan, Progress, Ran, Summary, Task, why};
use crate::error::{Error, Result};
use rayon::prelude::*;
use rayon::{Scope, ThreadPool, ThreadPoolBuilder};
use std::collections::{BTreeMap, VecDeque};
use std::sync::mpsc::{Sender, channel};
use std::time::Instant;

/// Walks the plan; writes only to the cache, whose lock the caller holds.
///
/// 1. Judge: look up all tasks whose needs are up to date, until none is left; those that the cache lacks are stale.
/// 2. Run stale tasks, each in a thread of its own or with others of its group in one, in no more threads than there
///    are.
/// 3. After each task that ends, judge the tasks that waited for it, and run those that are stale.
///
/// Easily broken: the inputs of a task are known only when all its needs are up to date, because artifacts are inputs
/// by content; so a task that runs and makes the same artifacts again leaves later tasks up to date.
///
/// `interrupt` is read before each task starts; a task that has started is finished, unless it reads it too.
///
/// # Errors
/// [`Error::Input`] or [`Error::Io`] if the cache refuses, or if one task is to run alone and another, which it needs,
/// is not up to date; [`Error::Interrupted`].
/// Tasks that fail are in the summary, not errors.
pub fn execute(
    plan: &Plan,
    store: &Store,
    options: Options,
    progress: &Progress,
    interrupt: &Interrupt,
) -> Result<Summary> {
    let mut walk = Walk {
        plan,
        store,
        options,
        progress,
        interrupt,
        states: plan.tasks().iter().map(|_| State::Waiting).collect(),
        failed: BTreeMap::new(),
        summary: Summary::default(),
    };
    let stale = walk.judge()?;
    options.only.map_or(Ok(()), |k| walk.refuse_waiting(&plan.tasks()[k]))?;
    if !options.dry_run && !stale.is_empty() {
        walk.run(stale.into())?;
    }
    Ok(walk.finish())
}

/// State of a task during the walk.
enum State {
    /// A task that it needs is not up to date.
    Waiting,
    /// Up to date, from the start or since it ran.
    Done(Manifest),
    /// To be run, running, or failed; it runs for this reason.
    Stale(Reason),
}

/// Inputs of a task, and its run with these inputs or the reason to run it.
type LookedUp = (BTreeMap<String, String>, std::result::Result<Hit, Reason>);

/// Stale task that can run.
struct Job {
    task: usize,
    inputs: BTreeMap<String, String>,
    reason: Reason,
}

/// Task that has run, with its record.
type Ended = (Ran, Result<Manifest>);

struct Walk<'a> {
    plan: &'a Plan,
    store: &'a Store,
    options: Options,
    progress: &'a Progress,
    interrupt: &'a Interrupt,
    states: Vec<State>,
    /// Reasons of the tasks that failed, by their numbers: the order does not depend on threads.
    failed: BTreeMap<usize, Vec<String>>,
    summary: Summary,
}

impl<'a> Walk<'a> {
    /// Looks up all waiting tasks whose needs are up to date; returns those that have to run.
    fn judge(&mut self) -> Result<Vec<Job>> {
        let mut jobs = Vec::new();
        loop {
            let mut ready = self.waiting();
            ready.retain(|&k| self.waits_for(&self.plan.tasks()[k]).is_none());
            if ready.is_empty() {
                return Ok(jobs);
            }
            // In parallel: reading and hashing artifacts takes most of the time of a run with nothing to do.
            let found: Vec<_> = ready.par_iter().map(|&k| self.look_up(k)).collect();
            for (task, looked_up) in ready.into_iter().zip(found) {
                let (inputs, found) = looked_up?;
                self.states[task] = match found {
                    Ok(hit) => {
                        if hit.reverted && self.may_run(task) {
                            self.summary.reverted = true;
                            if !self.options.dry_run {
                                self.store.renew(&hit.manifest)?;
                            }
                        }
                        State::Done(hit.manifest)
                    }
                    Err(reason) => {
                        if self.may_run(task) {
                            jobs.push(Job { task, inputs, reason: reason.clone() });
                        }
                        State::Stale(reason)
                    }
                };
            }
        }
    }

    /// True if the walk may write to the record of this task.
    fn may_run(&self, k: usize) -> bool {
        self.options.only.is_none_or(|only| only == k)
    }

    /// Refuses to run a task alone while it waits for another.
    fn refuse_waiting(&self, task: &'a Task) -> Result<()> {
        let id = self.blocked_by(task);
        match &self.states[self.index(id)] {
            State::Stale(reason) if id != task.id => Err(Error::input(format!(
                "{id} is needed and not up to date ({reason}); first `signorini run --task {}`",
                in_shell(id)
            ))),
            _ => Ok(()),
        }
    }

    /// Numbers of the tasks that wait for another.
    fn waiting(&self) -> Vec<usize> {
        let states = self.states.iter().enumerate();
        states.filter(|(_, state)| matches!(state, State::Waiting)).map(|(k, _)| k).collect()
    }

    /// Returns the inputs of a task, and its run with these inputs if the cache has it.
    fn look_up(&self, k: usize) -> Result<LookedUp> {
        let task = &self.plan.tasks()[k];
        let inputs = self.plan.inputs(task, |need| &self.manifest(need).outputs)?;
        let found = if self.options.force {
            Err(Reason::Forced)
        } else {
            self.store.lookup(&task.id, &inputs)
        };
        Ok((inputs, found))
    }

    /// Returns the first task that this one needs and that is not up to date.
    fn waits_for(&self, task: &Task) -> Option<&'a str> {
        let mut needs = task.needs.iter().map(|need| self.index(need));
        let need = needs.find(|&need| !matches!(self.states[need], State::Done(_)))?;
        Some(&self.plan.tasks()[need].id)
    }

    /// Returns the stale task for which this one waits, directly or through others.
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
                // At most as many as there are threads, so that after an interrupt no other task is started.
                while running < pool.current_num_threads() && !self.stops() && broken.is_none() {
                    let jobs = self.next(&mut queue, pool.current_num_threads());
                    if jobs.is_empty() {
                        break;
                    }
                    self.start(jobs, scope, &send);
                    running += 1;
                }
                if running == 0 {
                    break;
                }
                let ended = receive.recv().expect("this end has a sender as well");
                running -= 1;
                let failed = self.failed.len();
                for (ran, made) in ended {
                    let is_other = self.failed.len() > failed && !self.options.keep_going;
                    if is_other && matches!(made, Err(Error::Stage(_))) {
                        // Of a group that failed, as of all tasks, the first reason is told.
                        continue;
                    }
                    match self.settle(ran, made) {
                        Ok(jobs) => queue.extend(jobs),
                        Err(e) => broken = broken.take().or(Some(e)),
                    }
                }
            }
        });
        self.progress.end();
        match broken {
            Some(e) => Err(e),
            None if self.interrupt.is_asked() => Err(Error::Interrupted),
            None => Ok(()),
        }
    }

    /// Announces the number of tasks to run, and the reasons.
    fn announce(&self, queue: &VecDeque<Job>) {
        let states = self.states.iter().enumerate();
        let left = states.filter(|(k, state)| self.may_run(*k) && !matches!(state, State::Done(_)));
        let reasons: Vec<&Reason> = queue.iter().map(|job| &job.reason).collect();
        self.progress.begin(left.count(), &why(&reasons));
    }

    fn stops(&self) -> bool {
        let failed = !self.failed.is_empty() && !self.options.keep_going;
        failed || self.interrupt.is_asked()
    }

    fn group(&self, job: &Job) -> Option<&'a Group> {
        self.plan.tasks()[job.task].group.as_ref()
    }

    /// Takes the next job from a queue, with as many others of its group as leave no thread without work.
    fn next(&self, queue: &mut VecDeque<Job>, threads: usize) -> Vec<Job> {
        let share = queue.len().div_ceil(threads);
        let Some(first) = queue.pop_front() else { return Vec::new() };
        let of_first = self.group(&first);
        let mut jobs = vec![first];
        if let Some(Group { most, .. }) = of_first {
            let others = queue.iter().filter(|job| self.group(job) == of_first).count();
            // In equal parts.
            let parts = (1 + others).div_ceil(share.clamp(1, *most));
            let part = (1 + others).div_ceil(parts);
            for job in std::mem::take(queue) {
                match jobs.len() < part && self.group(&job) == of_first {
                    true => jobs.push(job),
                    false => queue.push_back(job),
                }
            }
        }
        jobs
    }

    /// Starts jobs side by side in a thread, which reports their ends to `send`.
    fn start<'s>(&self, jobs: Vec<Job>, scope: &Scope<'s>, send: &Sender<Vec<Ended>>)
    where
        'a: 's,
    {
        let (send, store, interrupt) = (send.clone(), self.store, self.interrupt);
        let (mut tasks, mut reasons) = (Vec::new(), Vec::new());
        for Job { task, inputs, reason } in jobs {
            let task = &self.plan.tasks()[task];
            self.progress.start(&task.id);
            let needs = task.needs.iter();
            let needed = needs.map(|need| (need.clone(), self.manifest(need).outputs.clone()));
            tasks.push(run::PreparedTask { task, inputs, needed: needed.collect() });
            reasons.push((task.id.clone(), reason));
        }
        let at_work = interrupt.begin();
        scope.spawn(move |_| {
            let start = Instant::now();
            let made = run::run(tasks, store, interrupt);
            drop(at_work);
            let time = start.elapsed() / made.len() as u32;
            let ended = made.into_iter().zip(reasons);
            let ended = ended.map(|(made, (task, reason))| (Ran { task, reason, time }, made));
            // The receiver lives as long as the scope.
            let _ = send.send(ended.collect());
        });
    }

    /// Records the end of a job; returns the tasks that waited and now have to run.
    fn settle(&mut self, ran: Ran, made: Result<Manifest>) -> Result<Vec<Job>> {
        let verdict = match made {
            Ok(_) => "ran",
            Err(Error::Interrupted) => "ended early:",
            Err(_) => "FAILED",
        };
        self.progress.done(&ran, verdict);
        let task = self.index(&ran.task);
        match made {
            Ok(manifest) => {
                self.states[task] = State::Done(manifest);
                self.summary.ran.push(ran);
            }
            Err(Error::Stage(reasons)) => _ = self.failed.insert(task, reasons),
            Err(other) => return Err(other),
        }
        if self.interrupt.is_asked() {
            // Nothing is started any more, and judging may take long.
            return Ok(Vec::new());
        }
        let waited = self.waiting();
        let jobs = self.judge()?;
        for k in waited {
            if matches!(self.states[k], State::Done(_)) {
                self.progress.skip();
            }
        }
        Ok(jobs)
    }

    /// Completes the summary after all jobs have ended.
    fn finish(mut self) -> Summary {
        self.summary.failed = std::mem::take(&mut self.failed).into_values().flatten().collect();
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
        for (task, state) in self.plan.tasks().iter().zip(self.states) {
            if let State::Done(manifest) = state {
                self.summary.manifests.insert(task.id.clone(), manifest);
            }
        }
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
