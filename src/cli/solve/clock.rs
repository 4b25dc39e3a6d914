//! Clock of `solve`: where the time of the command went.

use crate::cli::shown::brief;
use crate::pipeline::bar;
use indicatif::ProgressBar;
use serde_json::{Map, Value};
use signorini_mathematics::levels::Step;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Part of the command that takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// Options and scenes, the mesh with its refinements, the matrices.
    Setup,
    /// f and its integrals.
    Load,
    /// Solver.
    Solver,
    /// Judgement and bounds of the solution, the contact and the warnings.
    Bounds,
    /// Files that are written.
    Files,
}

impl Part {
    /// All, in the order in which they follow each other, each with its name in JSON.
    const ALL: [(Self, &'static str); 5] = [
        (Self::Setup, "setup"),
        (Self::Load, "load"),
        (Self::Solver, "solve"),
        (Self::Bounds, "bounds"),
        (Self::Files, "files"),
    ];
}

/// Clock that gives all time since its start to one part or another.
pub(super) struct Clock(Mutex<Laps>);

struct Laps {
    last: Instant,
    /// In the order of the parts.
    times: [Duration; Part::ALL.len()],
}

impl Clock {
    pub(super) fn start() -> Self {
        let times = [Duration::ZERO; Part::ALL.len()];
        Self(Mutex::new(Laps { last: Instant::now(), times }))
    }

    /// Gives the time since the last call to a part that has just ended. Of two that run at the same time the first to
    /// end has the time until then, and the other the rest.
    pub(super) fn ended(&self, part: Part) {
        let mut laps = self.laps();
        let now = Instant::now();
        let time = now - laps.last;
        laps.times[part as usize] += time;
        laps.last = now;
    }

    /// As [`Clock::ended`], for a step of the mathematics.
    pub(super) fn ended_step(&self, step: Step) {
        self.ended(match step {
            Step::Mesh => Part::Setup,
            Step::Load => Part::Load,
            Step::Solver => Part::Solver,
            Step::Bounds => Part::Bounds,
        });
    }

    /// A thread that panics ends the program.
    fn laps(&self) -> MutexGuard<'_, Laps> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the seconds of each part, which add up to the time since the start.
    pub(super) fn json(&self) -> Value {
        let times = self.laps().times;
        let parts = Part::ALL.iter().zip(times);
        let seconds = parts.map(|((_, name), time)| ((*name).into(), time.as_secs_f64().into()));
        Value::Object(seconds.collect::<Map<_, _>>())
    }

    /// Returns a line with the time of each part that took any; `setup` names the first, `solver` tells what the solver
    /// has done.
    pub(super) fn text(&self, setup: &str, solver: &str) -> String {
        let times = self.laps().times;
        let mut parts = Vec::new();
        for ((part, name), time) in Part::ALL.iter().zip(times).filter(|(_, time)| !time.is_zero())
        {
            let time = brief(time);
            parts.push(match part {
                Part::Setup => format!("{setup} {time}"),
                Part::Solver => format!("solver {time}{solver}"),
                Part::Load | Part::Bounds | Part::Files => format!("{name} {time}"),
            });
        }
        format!("time: {}\n", parts.join(", "))
    }
}

/// A bar without a length, with what is done at the moment and the time that it takes.
pub(super) fn turning(doing: &str) -> Option<ProgressBar> {
    bar("{spinner} {msg}, {elapsed}").inspect(|bar| {
        bar.set_message(doing.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
    })
}
