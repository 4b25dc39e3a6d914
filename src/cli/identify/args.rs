//! The arguments of `identify`, and the request that they make.

use super::refused;
use crate::cli::output::check_options;
use crate::identify::{Lattice, Method, Request, Space, Variant};
use crate::pipeline::error::{Error, Result};
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// What `identify --help` ends with.
pub(in crate::cli) const EXAMPLES: &str = "\
How it works: f takes constant values on the pieces of a space, decimals from a list or range. A run \
with the published numbers of iterations tells how far each count is from coming out (the misfit). \
Grids 1 and 2 cost microseconds and discard nearly everything; the best are run in full.\n\n\
Spaces:\n  \
  odd-quadrant  one value on a quadrant, any of the four, and one elsewhere\n  \
  quadrants     four values: lower left, lower right, upper left, upper right\n  \
  rectangles    one value on a rectangle with corners on the grid 1/4, one elsewhere\n  \
  blocks4       sixteen values, on blocks of side 1/4\n\n\
Examples:\n  \
  signorini identify                                both problems, two values\n  \
  signorini identify --problem 2 --space quadrants  four values, by annealing\n  \
  signorini identify --problem 1 --values '2.9:3.1:0.001; -1.02:-0.98:0.001'\n  \
  signorini identify --problem 2 --variants --budget 300\n  \
  signorini identify --values -8:4:0.002 --checkpoint long.json\n  \
  signorini identify --values -8:4:0.001 --part 2/8 --checkpoint 2.json\n  \
  signorini identify --merge [1-8].json\n\n\
The table has f with all counts first, then ranks by total = misfit + 0.3 (misfit of Delta a) + 0.005 \
(complexity); complexity counts distinct values and their decimal places. The same command finds the \
same f whatever the threads.\n\nExit codes: 0 done or out of budget, 2 wrong input, 130 interrupted.";

/// A space by its name in `--space`, as in JSON.
#[derive(Clone, Copy, Debug)]
struct Family(Space);

impl ValueEnum for Family {
    fn value_variants<'a>() -> &'a [Self] {
        &[
            Self(Space::Quadrants),
            Self(Space::OddQuadrant),
            Self(Space::Rectangles),
            Self(Space::Blocks4),
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(match self.0 {
            Space::Quadrants => "quadrants",
            Space::OddQuadrant => "odd-quadrant",
            Space::Rectangles => "rectangles",
            Space::Blocks4 => "blocks4",
        }))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Way {
    Enumerate,
    Anneal,
}

#[derive(Args, Debug)]
pub(in crate::cli) struct IdentifyArgs {
    /// The problem whose table f is to explain
    #[arg(long, value_name = "1|2|both", default_value = "both", hide_possible_values = true,
        value_parser = ["1", "2", "both"])]
    pub(super) problem: String,
    /// Family of f; see below
    #[arg(long, value_enum, hide_possible_values = true, default_value = "odd-quadrant")]
    space: Family,
    /// Values f may take: MIN:MAX:STEP or a comma-separated list; with `;`, one such per piece
    /// [default: -8:4:0.005, or coarser where the space is large]
    #[arg(long, allow_hyphen_values = true, value_name = "LIST|MIN:MAX:STEP")]
    values: Option<String>,
    /// How to search [default: enumerate two values, anneal more]
    #[arg(long, value_enum, hide_possible_values = true, value_name = "enumerate|anneal")]
    method: Option<Way>,
    /// Annealing: independent chains [default: 16]
    #[arg(long, value_name = "N")]
    chains: Option<u64>,
    /// Annealing: candidates per chain [default: 2500]
    #[arg(long, value_name = "N")]
    steps: Option<u64>,
    /// Enumeration: coarse grids on which every count must come out [default: 2]
    #[arg(long, value_name = "N")]
    exact_grids: Option<usize>,
    /// Admit f whose integral is not negative, against (2)
    #[arg(long)]
    any_integral: bool,
    /// Repeat the search under every reading of the method that differs in one choice
    #[arg(long, conflicts_with = "checkpoint")]
    pub(super) variants: bool,
    /// Stop after this time, shared by all searches of the command, and show what was found
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(super) budget: Option<f64>,
    /// Annealing: seed of everything random [default: 1]
    #[arg(long)]
    seed: Option<u64>,
    /// How many candidates to keep
    #[arg(long, value_name = "K", default_value_t = 5)]
    top: usize,
    /// Threads [default: one per core]; results do not depend on it
    #[arg(long, value_name = "N")]
    pub(super) threads: Option<usize>,
    /// Keep the state of the search in this file, and go on from it if it exists
    #[arg(long, value_name = "FILE")]
    pub(super) checkpoint: Option<PathBuf>,
    /// Do only the Kth of N parts; --merge puts the checkpoints of all together
    #[arg(long, value_name = "K/N", requires = "checkpoint", conflicts_with = "variants")]
    part: Option<String>,
    /// Search no further: show what these checkpoints, of all parts of a search, have found together
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = [
        "problem", "space", "values", "method", "chains", "steps", "exact_grids", "any_integral",
        "variants", "budget", "seed", "top", "threads", "checkpoint", "part",
    ])]
    pub(super) merge: Vec<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// What is asked, of tables with so many `grids`.
pub(super) fn request(args: &IdentifyArgs, grids: usize) -> Result<Request> {
    // Where few values are asked for, all of them; and lattices that take about a minute.
    let (way, values) = match args.space.0 {
        Space::OddQuadrant => (Way::Enumerate, "-8:4:0.005"),
        Space::Rectangles => (Way::Enumerate, "-8:4:0.1"),
        Space::Quadrants => (Way::Anneal, "-8:4:0.01"),
        Space::Blocks4 => (Way::Anneal, "-8:4:0.1"),
    };
    let positive = |n: u64, name: &str| {
        if n == 0 { Err(Error::input(format!("--{name} must be at least 1"))) } else { Ok(n) }
    };
    let way = args.method.unwrap_or(way);
    let (anneal, enumerate) = (&[Way::Anneal][..], &[Way::Enumerate][..]);
    let options = [
        ("--chains", args.chains.is_some(), anneal),
        ("--steps", args.steps.is_some(), anneal),
        ("--seed", args.seed.is_some(), anneal),
        ("--exact-grids", args.exact_grids.is_some(), enumerate),
    ];
    check_options("--method", way, &options)?;
    let exact_grids = args.exact_grids.unwrap_or(2.min(grids));
    if exact_grids > grids {
        return Err(Error::input(format!("--exact-grids {exact_grids}: the table has {grids}")));
    }
    Ok(Request {
        space: args.space.0,
        values: Lattice::parse_all(args.values.as_deref().unwrap_or(values)).map_err(refused)?,
        variant: Variant::default(),
        method: match way {
            Way::Enumerate => Method::Enumerate,
            Way::Anneal => Method::Anneal {
                chains: positive(args.chains.unwrap_or(16), "chains")?,
                steps: positive(args.steps.unwrap_or(2500), "steps")?,
            },
        },
        negative_integral: !args.any_integral,
        exact_grids,
        seed: args.seed.unwrap_or(1),
        top: positive(args.top as u64, "top")? as usize,
        part: args.part.as_deref().map(str::parse).transpose().map_err(refused)?,
    })
}
