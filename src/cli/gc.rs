//! `gc`: removes garbage from the cache.

use super::CacheArgs;
use super::output::say;
use super::pipeline::Workplace;
use crate::pipeline::error::{Error, Result};
use clap::Args;

#[derive(Args)]
pub(super) struct GcArgs {
    /// Count only; remove nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// Keep this many latest runs of each task, besides the one that is in use
    #[arg(long, value_name = "N", default_value_t = 1)]
    keep: usize,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn gc(args: &GcArgs) -> Result<u8> {
    if args.keep == 0 {
        return Err(Error::input(
            "--keep must be at least 1; to drop everything, remove the cache folder",
        ));
    }
    let workplace = Workplace::open(&args.cache)?;
    let plan = workplace.tasks(&[], None)?;
    // Counting needs no lock; and without a cache no lock is taken, which would create a folder that was misspelt.
    let there = workplace.store.folder().is_dir();
    let _lock = if args.dry_run || !there { None } else { Some(workplace.store.lock()?) };
    let garbage = workplace.store.collect_garbage(&plan, args.keep, args.dry_run)?;
    let verb = if args.dry_run { "would remove" } else { "removed" };
    let records = match garbage.records {
        0 => String::new(),
        count => format!(" and {count} records of runs"),
    };
    say(&format!(
        "{verb} {} files{records}, {}; kept {} files, {}\n",
        garbage.files,
        size(garbage.bytes),
        garbage.kept_files,
        size(garbage.kept_bytes)
    ))
}

fn size(bytes: u64) -> String {
    match bytes {
        0..10_000 => format!("{bytes} B"),
        10_000..10_000_000 => format!("{} kB", bytes / 1000),
        _ => format!("{} MB", bytes / 1_000_000),
    }
}
