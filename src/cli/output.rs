//! What leaves the program: data on standard output, talk on standard error, files that the user named.

use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::{folder_of, link_target, write_atomically};
pub(super) use crate::pipeline::talk;
use clap::ValueEnum;
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes data to standard output; a reader that has gone away is no error.
pub(super) fn say(text: &str) -> Result<u8> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(0),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(0),
        Err(e) => Err(Error::input(format!(
            "cannot write to standard output: {e}; redirect it elsewhere"
        ))),
    }
}

pub(super) fn say_json(value: &impl serde::Serialize) -> Result<u8> {
    let text = serde_json::to_string_pretty(value).expect("answers are plain data");
    say(&(text + "\n"))
}

/// Says which pieces of an f, a scene's or the user's own, mean nothing: their numbers may be mistyped. Returns what
/// it said.
pub(super) fn warn_of_outside(scene: Option<&str>, pieces: &[String]) -> Vec<String> {
    let of = scene.map_or("f".to_owned(), |name| format!("f in scene `{name}`"));
    let warning = |piece| format!("{piece} of {of} lies outside [-0.5,0.5] and changes nothing");
    let warnings: Vec<String> = pieces.iter().map(warning).collect();
    warnings.iter().for_each(|warning| talk(&format!("warning: {warning}")));
    warnings
}

/// Refuses an option, with whether it is given and whom it is for, that whoever is chosen `by` another has no use for.
pub(super) fn check_options<T: ValueEnum + PartialEq>(
    by: &str,
    chosen: T,
    options: &[(&str, bool, &[T])],
) -> Result<()> {
    let Some((option, _, takers)) =
        options.iter().find(|(_, given, takers)| *given && !takers.contains(&chosen))
    else {
        return Ok(());
    };
    let name = |of: &T| of.to_possible_value().map_or(String::new(), |of| of.get_name().into());
    let takers = takers.iter().map(name).collect::<Vec<_>>().join(", ");
    Err(Error::input(format!(
        "{option} is for {by} {takers}, not {}; leave it out, or change {by}",
        name(&chosen)
    )))
}

pub(super) fn styled(text: &str, color: anstyle::AnsiColor) -> String {
    let style = anstyle::Style::new().fg_color(Some(color.into())).bold();
    format!("{style}{text}{style:#}")
}

/// Rows below a head, which may be empty, in columns as wide as their longest cell: those in `left` begin, all
/// others end at one place.
pub(super) fn columns(head: &[&str], left: &[usize], rows: Vec<Vec<String>>) -> String {
    let names = head.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let rows: Vec<_> = [names].into_iter().filter(|names| !names.is_empty()).chain(rows).collect();
    let widest =
        |k: usize| rows.iter().filter_map(|row| row.get(k)).map(|t| t.chars().count()).max();
    let cell = |(k, text): (usize, &String)| match (left.contains(&k), widest(k).unwrap_or(0)) {
        (true, width) => format!("{text:<width$}"),
        (false, width) => format!("{text:>width$}"),
    };
    let line = |row: &Vec<String>| {
        let cells: Vec<String> = row.iter().enumerate().map(cell).collect();
        cells.join("  ").trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

/// A path as a shell reads it, to be copied into a command.
pub(super) fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let text = if text.starts_with('-') { format!("./{text}") } else { text };
    match text.chars().all(|c| c.is_alphanumeric() || "/._-".contains(c)) {
        true => text,
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

/// Refuses a folder to write to that is not there: a misspelt name is not to make one.
pub(super) fn is_there(folder: &Path) -> Result<()> {
    let shown = folder.display();
    let remedy =
        || format!("--output {shown}: no such folder; make it with `mkdir -p {}`", quoted(folder));
    if folder.is_dir() { Ok(()) } else { Err(Error::input(remedy())) }
}

/// A file that the user named, found writable before the work whose result it is to hold.
#[derive(Debug)]
pub(super) struct OutputFile {
    path: PathBuf,
}

impl OutputFile {
    /// Checks that `path` can be written.
    pub(super) fn check(path: &Path) -> Result<Self> {
        let wrong =
            |what: &str| Err(Error::input(format!("cannot write {}: {what}", path.display())));
        // Of `v.npy/` the last part would be `v.npy`.
        let is_folder = path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/");
        let Some(name) = path.file_name().filter(|_| !is_folder) else {
            return wrong("it is a folder; name a file");
        };
        let target = match link_target(path) {
            Ok(target) => target,
            Err(e) => return wrong(&format!("{e}; remove the link, or name another file")),
        };
        let folder = folder_of(&target);
        if !folder.is_dir() {
            return wrong(&match target == path {
                true => "no such folder; make it, or name another file".to_owned(),
                false => format!(
                    "it links to {}, where there is no such folder; make it, or name another file",
                    target.display()
                ),
            });
        }
        let path = path.to_path_buf();
        if path.exists() && !path.is_file() {
            return Ok(Self { path });
        }
        if let Err(e) = OpenOptions::new().append(true).open(&path)
            && e.kind() != ErrorKind::NotFound
        {
            return wrong(&format!("{e}; make it writable, or name another file"));
        }
        let trial = folder.join(format!(".{}.trial{}", name.to_string_lossy(), std::process::id()));
        if let Err(e) = OpenOptions::new().write(true).create_new(true).open(&trial) {
            return wrong(&format!("{e}; name a file elsewhere"));
        }
        fs::remove_file(&trial).context("remove", &trial)?;
        Ok(Self { path })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn write(&self, bytes: &[u8]) -> Result<()> {
        // A pipe or a device can only be written in place.
        if self.path.exists() && !self.path.is_file() {
            return fs::write(&self.path, bytes).context("write", &self.path);
        }
        write_atomically(&self.path, bytes)
    }
}
