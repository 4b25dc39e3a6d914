//! The options of `identify`, and the search that they ask for.

use super::refused;
use crate::cli::threads;
use crate::pipeline::error::{Error, Result};
use crate::replication::project::Project;
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use rayon::{ThreadPool, ThreadPoolBuilder};
use signorini_mathematics::identify::{Lattice, Request, Space, Target, Variant};

/// End of `identify --help`.
pub(in crate::cli) const EXAMPLES: &str = "\
How it works: f takes one value on a region and one elsewhere, decimals from a list or range, and every \
combination is tried. A run with the published numbers of iterations tells how far each count is from \
coming out (the misfit). Grids 1 and 2 cost microseconds and discard nearly everything; the best are run \
in full.\n\n\
Regions:\n  \
  odd-quadrant  a quadrant, any of the four\n  \
  rectangles    a rectangle with corners on the grid 1/4\n\n\
Examples:\n  \
  signorini identify                                both problems\n  \
  signorini identify --problem 1 --values '2.9:3.1:0.001; -1.02:-0.98:0.001'\n  \
  signorini identify --problem 2 --values -8:4:0.05 --variants\n  \
  signorini identify --values -8:4:0.002\n\n\
The table has f with all counts first, then ranks by total = misfit + 0.3 (misfit of Delta a) + 0.005 \
(complexity); complexity counts distinct values and their decimal places. The same command finds the \
same f whatever the threads.\n\nExit codes: 0 done, 2 wrong input, 130 interrupted (what was found is shown).";

/// A space by its name in `--space`, as in JSON.
#[derive(Clone, Copy, Debug)]
struct Family(Space);

impl ValueEnum for Family {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self(Space::OddQuadrant), Self(Space::Rectangles)]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(match self.0 {
            Space::OddQuadrant => "odd-quadrant",
            Space::Rectangles => "rectangles",
        }))
    }
}

#[derive(Args, Debug)]
pub(in crate::cli) struct IdentifyArgs {
    /// The problem whose table f is to explain
    #[arg(long, value_name = "1|2|both", default_value = "both", hide_possible_values = true,
        value_parser = ["1", "2", "both"])]
    problem: String,
    /// Region of the first value; see below
    #[arg(long, value_enum, hide_possible_values = true, default_value = "odd-quadrant")]
    space: Family,
    /// Values f may take: MIN:MAX:STEP or a comma-separated list; with `;`, one such for the region and
    /// one for the rest [default: -8:4:0.005; for rectangles -8:4:0.1]
    #[arg(long, allow_hyphen_values = true, value_name = "LIST|MIN:MAX:STEP")]
    values: Option<String>,
    /// Number of coarse grids on which every count must come out [default: 2]
    #[arg(long, value_name = "N")]
    exact_grids: Option<usize>,
    /// Admit f whose integral is not negative, against (2)
    #[arg(long)]
    any_integral: bool,
    /// Repeat the search under every reading of the method that differs in one choice
    #[arg(long)]
    pub(super) variants: bool,
    /// Number of candidates to keep
    #[arg(long, value_name = "K", default_value_t = 5)]
    top: usize,
    /// Threads [default: one per core]; results do not depend on it
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// The search that the options ask for.
pub(super) struct Search {
    /// The tables to explain, with their numbers.
    pub(super) tables: Vec<(u8, Target)>,
    pub(super) request: Request,
    /// Threads, if their number is given.
    pub(super) pool: Option<ThreadPool>,
}

impl Search {
    /// Reads and checks all options.
    pub(super) fn read(args: &IdentifyArgs, project: &Project) -> Result<Self> {
        let tables = tables(args, project)?;
        let grids = tables.iter().map(|(_, target)| target.levels()).min();
        let request = request(args, grids.expect("at least one table"))?;
        let pool = args.threads.map(pool).transpose()?;
        Ok(Self { tables, request, pool })
    }
}

fn tables(args: &IdentifyArgs, project: &Project) -> Result<Vec<(u8, Target)>> {
    let numbers: Vec<u8> = match args.problem.parse() {
        Ok(number) => vec![number],
        Err(_) => project.paper.table.iter().map(|table| table.number).collect(),
    };
    if numbers.is_empty() {
        return Err(Error::input(
            "no published table is in pipeline/paper.toml; add one to explain",
        ));
    }
    numbers.into_iter().map(|number| Ok((number, project.paper.target(number)?))).collect()
}

/// The question, of tables with so many `grids`.
fn request(args: &IdentifyArgs, grids: usize) -> Result<Request> {
    // Lattices that take about a minute.
    let values = args.values.as_deref().unwrap_or(match args.space.0 {
        Space::OddQuadrant => "-8:4:0.005",
        Space::Rectangles => "-8:4:0.1",
    });
    if args.top == 0 {
        return Err(Error::input("--top must be at least 1"));
    }
    let exact_grids = args.exact_grids.unwrap_or(2.min(grids));
    if exact_grids > grids {
        return Err(Error::input(format!("--exact-grids {exact_grids}: the table has {grids}")));
    }
    Ok(Request {
        space: args.space.0,
        values: Lattice::parse_all(values).map_err(|e| refused(&e))?,
        variant: Variant::default(),
        negative_integral: !args.any_integral,
        exact_grids,
        top: args.top,
    })
}

fn pool(asked: usize) -> Result<ThreadPool> {
    if asked == 0 {
        return Err(Error::input("--threads must be at least 1; leave it out for one per core"));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads("--threads", asked)).build();
    pool.map_err(|e| Error::input(format!("--threads {asked}: {e}; ask for fewer")))
}
