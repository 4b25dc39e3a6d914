//! Run times of every solver: medians with their noise, never part of any test or artifact.
//!
//! The mathematics prepares and judges the runs; here is the clock. Central is [`measure`].

mod median;

use super::bandwidth::bandwidth;
use super::machine::cores;
use crate::pipeline::error::{Error, Result};
use crate::timing::recorded::{Machine, SCHEMA, Timings};
use median::{MedianTime, time};
use signorini_mathematics::experiments::Rows;
use signorini_mathematics::experiments::timed::{TimedFacts, TimedPlan, TimedRun};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// Measurements to make.
#[derive(Clone, Debug)]
pub struct TimingPlan {
    /// Runs to time.
    pub timed: TimedPlan,
    /// Runs per median; fewer where a run takes long.
    pub repeats: usize,
    /// Set to end the measurements early; the one that has begun is finished.
    pub interrupted: &'static AtomicBool,
}

/// Seconds that a single run may take by extrapolation from the one before in its series.
const LONGEST: f64 = 4.0;

/// Measures run times; `say` gets the name of the next measurement, once per solver, problem and grid.
///
/// Easily broken: a time includes everything that its run does, so that allocation, loads and checks have to be on the
/// side of the clock on which the field of [`Timings`] says that they are.
///
/// If it is interrupted, the times measured until then are returned.
///
/// # Errors
/// [`Error::Input`] if one of the paper's problems is none for the spectral solver, [`Error::Stage`] if a solver fails.
pub fn measure(plan: &TimingPlan, mut say: impl FnMut(&str)) -> Result<Timings> {
    let mut lists = plan.timed.runs().map_err(|e| {
        Error::input(format!("{e}; `bench` takes f from the scenes with `paper_table = 1` and 2"))
    })?;
    let machine = Machine::here(plan.repeats);
    if let Some(warning) = machine.busy() {
        say(&warning);
    }
    say("memory bandwidth");
    let mut timings = Timings {
        schema: SCHEMA,
        bandwidth: bandwidth(&plan.timed, 5),
        machine,
        multigrid: Rows::default(),
        solver: Rows::default(),
        spectral: Rows::default(),
        peer: Rows::default(),
        own_mesh: Rows::default(),
        adapted: Rows::default(),
    };
    let (mut series, mut said) = (BTreeMap::new(), String::new());
    while !plan.ended()
        && let Some(runs) = lists.next()
    {
        for run in runs.map_err(failed)? {
            if plan.ended() || takes_too_long(&run, &series) {
                continue;
            }
            if run.name != said {
                say(&run.name);
                said.clone_from(&run.name);
            }
            let Some(facts) = run.judged().map_err(failed)? else { continue };
            let median = median(&run, plan.repeats).map_err(failed)?;
            series.entry(run.series).or_default().push(median.seconds);
            timings.enter(facts, &median);
        }
    }
    Ok(timings)
}

fn failed(why: String) -> Error {
    Error::Stage(vec![why])
}

impl TimingPlan {
    fn ended(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

/// True if a run is expected to take longer than it may, by the times measured so far in each series.
fn takes_too_long(run: &TimedRun, series: &BTreeMap<String, Vec<f64>>) -> bool {
    let before = series.get(&run.series).and_then(|times| times.last()).unwrap_or(&0.0);
    let rival = run.rival.and_then(|rival| series.get(rival));
    let longest = rival.and_then(|times| times.iter().copied().reduce(f64::max));
    run.growth * before > longest.unwrap_or(LONGEST).min(LONGEST)
}

/// Times a run with the threads that it asks for.
fn median(run: &TimedRun, repeats: usize) -> std::result::Result<MedianTime, String> {
    let Some(threads) = run.threads else { return Ok(time(repeats, || run.execute())) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| format!("cannot start {threads} threads: {e}"))?;
    Ok(pool.install(|| time(repeats, || run.execute())))
}

/// Returns the numbers of threads with which multigrid is timed.
pub fn threads() -> Vec<usize> {
    if cores() > 1 { vec![1, 2] } else { vec![1] }
}

impl Timings {
    /// Enters a time with the facts of its run.
    fn enter(&mut self, TimedFacts { table, mut row }: TimedFacts, time: &MedianTime) {
        row.insert("seconds".into(), time.seconds.into());
        if table != "adapted" {
            row.insert("spread".into(), time.spread.into());
        }
        let rows = match table {
            "multigrid" => &mut self.multigrid,
            "solver" => &mut self.solver,
            "spectral" => &mut self.spectral,
            _ => &mut self.adapted,
        };
        rows.0.push(row);
    }
}
