//! `bench`: run times of every solver on this machine; `--record` keeps them for the book.

use super::current_folder;
use super::output::{OutputFile, columns, say, say_json, talk};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::read_if_there;
use crate::replication::project::Project;
use crate::timing::measure::{TIMED, TimingPlan, measure};
use crate::timing::recorded::{self, Peer, Timings};
use crate::timing::solver::Solver;
use clap::{Args, ValueEnum};

#[derive(Args)]
pub(super) struct BenchArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Coarse grids only: a few seconds, to see that it works
    #[arg(long)]
    quick: bool,
    /// Write pipeline/timings.toml, from which the book takes its times
    #[arg(long, conflicts_with_all = ["quick", "solver"])]
    record: bool,
    /// Runs per median [default: 9, with --quick 3]
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// Only these solvers [default: all]
    #[arg(long, value_enum)]
    solver: Vec<Solver>,
    /// Cells per side of the finest grid, a power of two [default: 4096, with --quick 128]
    #[arg(long, value_name = "N")]
    finest: Option<usize>,
}

/// Finest grid of a run: 2 GB for the load vector and multigrid.
const FINEST: usize = 8192;

pub(super) fn bench(args: &BenchArgs) -> Result<u8> {
    let repeats = args.repeats.unwrap_or(if args.quick { 3 } else { 9 });
    let finest = args.finest.unwrap_or(if args.quick { 128 } else { 4096 });
    if repeats == 0 {
        return Err(Error::input("--repeats 0: give at least 1"));
    }
    if !finest.is_power_of_two() || !(16..=FINEST).contains(&finest) {
        return Err(Error::input(format!(
            "--finest {finest}: give a power of two from 16 to {FINEST}, such as 1024"
        )));
    }
    let solvers = if args.solver.is_empty() { Solver::value_variants() } else { &args.solver };
    let plan = TimingPlan { repeats, quick: args.quick, solvers: solvers.into(), finest };
    // Before the measurement, because an error after it would waste minutes.
    let record = args.record.then(RecordFile::open).transpose()?;
    let mut timings = measure(&plan, talk).map_err(|e| Error::Stage(vec![e]))?;
    if let Some(record) = &record {
        timings.peer.clone_from(&record.peers);
    }
    if args.json { say_json(&timings) } else { say(&text(&timings)) }?;
    if let Some(record) = record {
        record.file.write(timings.to_toml().as_bytes())?;
        talk(&format!("wrote {}; `signorini` now builds the book with it", recorded::PATH));
    }
    Ok(0)
}

/// Record of times to be replaced.
struct RecordFile {
    file: OutputFile,
    /// Part of the earlier record that is kept.
    peers: Vec<Peer>,
}

impl RecordFile {
    fn open() -> Result<Self> {
        let path = Project::find(&current_folder()?)?.join(recorded::PATH);
        let peers = match read_if_there(&path)? {
            Some(text) => Timings::parse(text)?.peer,
            None => Vec::new(),
        };
        Ok(Self { file: OutputFile::check(&path)?, peers })
    }
}

fn text(timings: &Timings) -> String {
    let Timings { machine, bandwidth, .. } = timings;
    let mut text = format!(
        "{}, {} cores, {}\n{}, {}; load average {}\n",
        machine.cpu, machine.cores, machine.caches, machine.os, machine.rustc, machine.load
    );
    text += "noise: distance of the quartiles of a time over its median\n";
    text += &format!(
        "memory, one thread, arrays of {:.0} MB: triad {:.1} GB/s, in-place update {:.1} GB/s\n",
        bandwidth.megabytes, bandwidth.triad, bandwidth.update
    );
    if let Some(sweep) = &timings.sweep {
        text += &format!(
            "one iteration of Arrow-Hurwicz at 1/{}: {:.2} ns per node, noise {}\n",
            sweep.cells,
            sweep.ns,
            percent(sweep.spread)
        );
    }
    if !timings.multigrid.is_empty() {
        text += &format!("\nmultigrid, {}\n{}", TIMED.name(), multigrid(timings));
    }
    if !timings.solver.is_empty() {
        text += &format!("\n{}", solvers(timings));
    }
    if !timings.spectral.is_empty() {
        text += "\nspectral: error of the energy against a finer resolution, relative\n";
        text += &spectral(timings);
    }
    text
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

fn multigrid(timings: &Timings) -> String {
    let rows = timings.multigrid.iter().map(|line| {
        let ns = line.ns();
        vec![
            format!("1/{}", line.cells),
            line.unknowns().to_string(),
            line.threads.to_string(),
            line.goal.in_words().to_owned(),
            format!("{:.1}", line.work_units),
            format!("{ns:.1}"),
            format!("{:.2}", ns / line.work_units),
            percent(line.spread),
            format!("{:.1}", line.bytes),
            format!("{:.1}", line.traffic / timings.bandwidth.update),
        ]
    });
    let head =
        ["grid", "unknowns", "threads", "goal", "WU", "ns", "ns/WU", "noise", "bytes", "stream ns"];
    columns(&head, &[3], rows.collect())
}

fn solvers(timings: &Timings) -> String {
    let rows = timings.solver.iter().map(|line| {
        vec![
            line.solver.to_string(),
            line.problem.clone(),
            format!("1/{}", line.cells),
            line.goal.clone(),
            format!("{:.2e}", line.error),
            format!("{:.2e}", line.discretisation),
            format!("{:.1e}", line.kkt),
            format!("{:.6}", line.seconds),
            percent(line.spread),
        ]
    });
    let head =
        ["solver", "problem", "grid", "goal", "error", "discr.", "rel. KKT", "seconds", "noise"];
    columns(&head, &[0, 1, 3], rows.collect())
}

fn spectral(timings: &Timings) -> String {
    let rows = timings.spectral.iter().map(|line| {
        vec![
            line.problem.clone(),
            line.nodes.to_string(),
            line.levels.to_string(),
            format!("{:.1e}", line.error),
            format!("{:.6}", line.seconds),
            percent(line.spread),
        ]
    });
    let head = ["problem", "nodes", "levels", "error", "seconds", "noise"];
    columns(&head, &[0], rows.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_without_lines_is_left_out() {
        let mut timings = Timings::parse(include_str!("../../pipeline/timings.toml")).unwrap();
        assert_eq!(heads(&timings), [true; 3]);
        timings.multigrid.clear();
        timings.solver.clear();
        assert_eq!(heads(&timings), [false, false, true]);
        timings.spectral.clear();
        assert_eq!(heads(&timings), [false; 3]);
    }

    /// Presence of the tables of multigrid, of the solvers on grids, and of the spectral solver.
    fn heads(timings: &Timings) -> [bool; 3] {
        let text = text(timings);
        ["ns/WU", "rel. KKT", "levels"].map(|head| text.contains(head))
    }
}
