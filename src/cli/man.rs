//! `man`: manual pages, made from the texts of `--help`.

use super::Cli;
use super::output::{OutputFile, is_there, say, talk};
use crate::pipeline::error::Result;
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use std::path::Path;

pub(super) fn man(output: Option<&Path>) -> Result<u8> {
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let Some(folder) = output else {
        return say(&text(&page(&command)));
    };
    is_there(folder)?;
    let mut pages = vec![page(&command)];
    pages.extend(command.get_subcommands().map(page));
    for page in &pages {
        OutputFile::check(&folder.join(page.get_filename()))?.write(text(page).as_bytes())?;
    }
    talk(&format!("{} pages written to {}", pages.len(), folder.display()));
    Ok(0)
}

/// Returns the page of a command.
fn page(command: &Command) -> Man {
    Man::new(command.clone())
        .source(concat!("signorini ", env!("CARGO_PKG_VERSION")))
        .manual("Signorini problem")
}

fn text(page: &Man) -> String {
    let mut text = Vec::new();
    page.render(&mut text).expect("memory takes every byte");
    String::from_utf8_lossy(&text).into_owned()
}
