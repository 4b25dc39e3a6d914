//! The options of `identify`, and the search that they ask for.

use crate::cli::threads;
use crate::pipeline::error::{Error, Result, from_record};
use crate::replication::identified::IdentifiedRecord;
use crate::replication::project::{IDENTIFIED, Project};
use clap::Args;
use rayon::{ThreadPool, ThreadPoolBuilder};
use signorini_mathematics::identify::{Lattice, Target};

/// End of `identify --help`.
pub(in crate::cli) const EXAMPLES: &str = "\
How it works: f takes one value on a quadrant, any of the four, and one elsewhere, decimals from a range, \
and every such f with a negative integral is tried, grid by grid: nearly all miss a count on the two \
coarsest, where a run costs microseconds.\n\n\
Examples:\n  \
  signorini identify                                both problems\n  \
  signorini identify --problem 1 --values -4:4:0.01\n  \
  signorini identify --problem 2 --values -8:4:0.05 --variants\n  \
  signorini identify --values -8:4:0.002\n\n\
Before that, the f in pipeline/identified.toml are run. Found are at most twenty f with all counts: first \
those with the most values of Delta a to both printed digits, and of these those that are the shortest to \
write. The same command finds the same f whatever the threads.\n\n\
Exit codes: 0 done, 2 wrong input, 130 interrupted (what was found is shown).";

#[derive(Args, Debug)]
pub(in crate::cli) struct IdentifyArgs {
    /// The problem whose table f is to explain
    #[arg(long, value_name = "1|2|both", default_value = "both", hide_possible_values = true,
        value_parser = ["1", "2", "both"])]
    problem: String,
    /// Values f may take; the default takes about a minute
    #[arg(
        long,
        allow_hyphen_values = true,
        value_name = "MIN:MAX:STEP",
        default_value = "-8:4:0.005"
    )]
    values: String,
    /// Repeat the search under every reading of the method that differs in one choice
    #[arg(long)]
    pub(super) variants: bool,
    /// Threads [default: one per core]; results do not depend on it
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// A published table, and the f that are on record for it.
pub(super) struct Published {
    pub(super) number: u8,
    pub(super) target: Target,
    /// By their values on the quadrants.
    pub(super) recorded: Vec<[f64; 4]>,
}

/// The search that the options ask for.
pub(super) struct Search {
    /// The tables to explain.
    pub(super) tables: Vec<Published>,
    pub(super) lattice: Lattice,
    /// Threads, if their number is given.
    pub(super) pool: Option<ThreadPool>,
}

impl Search {
    /// Reads and checks all options.
    pub(super) fn read(args: &IdentifyArgs, project: &Project) -> Result<Self> {
        let tables = tables(args, project)?;
        let lattice = args.values.parse().map_err(|e| Error::input(format!("--values: {e}")))?;
        let pool = args.threads.map(pool).transpose()?;
        Ok(Self { tables, lattice, pool })
    }
}

fn tables(args: &IdentifyArgs, project: &Project) -> Result<Vec<Published>> {
    let numbers: Vec<u8> = match args.problem.parse() {
        Ok(number) => vec![number],
        Err(_) => project.paper.table.iter().map(|table| table.number).collect(),
    };
    if numbers.is_empty() {
        return Err(Error::input(
            "no published table is in pipeline/paper.toml; add one to explain",
        ));
    }
    let mut record: Option<IdentifiedRecord> = None;
    if let Some(file) = project.files.get(IDENTIFIED) {
        record = Some(from_record(IDENTIFIED, file.bytes()?)?);
    }
    let mut tables = Vec::new();
    for number in numbers {
        let recorded = record.as_ref().map_or(&[][..], |record| record.alternatives(number));
        let target = project.paper.target(number)?;
        tables.push(Published { number, target, recorded: recorded.to_vec() });
    }
    Ok(tables)
}

fn pool(asked: usize) -> Result<ThreadPool> {
    if asked == 0 {
        return Err(Error::input("--threads must be at least 1; leave it out for one per core"));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads("--threads", asked)).build();
    pool.map_err(|e| Error::input(format!("--threads {asked}: {e}; ask for fewer")))
}
