//! `report`: builds the book.

use super::CacheArgs;
use super::output::say;
use super::pipeline::Workplace;
use crate::pipeline::error::{Error, Result};
use crate::replication::stages::Stage;
use clap::Args;
use signorini_book::FIRST;
use std::path::Path;
use std::process::Command;

#[derive(Args)]
pub(super) struct ReportArgs {
    /// Open the book in the browser
    #[arg(long)]
    open: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn report(args: &ReportArgs) -> Result<u8> {
    let mut workplace = Workplace::open(&args.cache)?;
    let mut tasks = workplace.tasks(&[], Some(Stage::Report))?;
    let manifests = workplace.bring_up_to_date(&mut tasks)?;
    let made = manifests.values().flat_map(|manifest| manifest.outputs.keys());
    let made: Vec<String> = made.map(|name| format!("report/{name}")).collect();
    let page = first_page(made.iter()).ok_or_else(|| {
        Error::input(
            "the project has no pages; they need report/templates/SUMMARY.md, as `signorini init` writes it",
        )
    })?;
    let book = workplace.project.root.join(page);
    if args.open {
        open(&book)?;
    }
    say(&format!("{}\n", book.display()))
}

/// Returns the path of the first page of the book, if it is among the paths of exported files.
pub(super) fn first_page<'a>(mut exported: impl Iterator<Item = &'a String>) -> Option<String> {
    let page = format!("report/book/{FIRST}");
    exported.any(|path| *path == page).then_some(page)
}

fn open(page: &Path) -> Result<()> {
    let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let why = match Command::new(opener).arg(page).status() {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => format!("`{opener}` failed ({status})"),
        Err(e) => format!("`{opener}` cannot be started ({e})"),
    };
    Err(Error::input(format!("{why}; open {} by hand", page.display())))
}
