//! `man`: manual pages, made from the same words as `--help`.

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
        let (_, page) = page(&command);
        return say(&page);
    };
    is_there(folder)?;
    let pages: Vec<_> =
        std::iter::once(&command).chain(command.get_subcommands()).map(page).collect();
    for (name, text) in &pages {
        OutputFile::check(&folder.join(name))?.write(text.as_bytes())?;
    }
    talk(&format!("{} pages written to {}", pages.len(), folder.display()));
    Ok(0)
}

/// A command's page by its file name.
fn page(command: &Command) -> (String, String) {
    let page = Man::new(command.clone())
        .source(concat!("signorini ", env!("CARGO_PKG_VERSION")))
        .manual("Signorini problem");
    let mut text = Vec::new();
    page.render(&mut text).expect("memory takes every byte");
    (page.get_filename(), String::from_utf8_lossy(&text).into_owned())
}
