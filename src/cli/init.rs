//! `init`: begins a study, with files that the program contains.

use super::output::{in_projects, quoted, refuse_tilde, tell};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::read_if_there;
use crate::pipeline::place::{TAKEN, own_place, write_own};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct InitArgs {
    /// Folder of the study; other files in it stay as they are, but .gitignore and .gitattributes get lines at
    /// the end
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

/// Files of a new study: the shortest commented scene of this project, one on another domain, a mesh for a third, and a
/// page that shows them.
const FILES: [(&str, &str); 5] = [
    ("pipeline/scenes/plate.toml", include_str!("../../pipeline/scenes/plate.toml")),
    ("pipeline/scenes/disc.toml", include_str!("init/disc.toml")),
    ("pipeline/meshes/gear.msh", include_str!("../../pipeline/meshes/gear.msh")),
    ("report/templates/SUMMARY.md", include_str!("init/SUMMARY.md")),
    ("report/templates/plate.md", include_str!("init/plate.md")),
];

/// Files of lines that a new repository often has: what is missing is added at the end.
const LINES: [(&str, &str); 2] = [
    (".gitignore", include_str!("init/gitignore")),
    (".gitattributes", include_str!("init/gitattributes")),
];

pub(super) fn init(args: &InitArgs) -> Result<u8> {
    let folder = &args.folder;
    refuse_tilde(folder)?;
    if folder.exists() && !folder.is_dir() {
        return Err(Error::input(format!("{} is a file; name a folder", folder.display())));
    }
    in_projects(folder, "the study", &TAKEN)?;
    // A study begun in another project would be a part of that one.
    let own = FILES.map(|(path, _)| path).into_iter().chain(["pipeline/scenes"]);
    for path in own.map(|path| folder.join(path)) {
        if path.exists() || path.is_symlink() {
            return Err(Error::input(format!(
                "{} is there already; move it away, or name another folder",
                path.display()
            )));
        }
    }
    for (path, _) in FILES.into_iter().chain(LINES) {
        own_place(folder, path)?;
    }
    let mut lines = Vec::new();
    for (path, text) in LINES {
        let there = read_if_there(&folder.join(path))?.unwrap_or_default();
        lines.push((path, with_lines(there, text)));
    }
    for (path, text) in lines {
        write_own(folder, path, &text).map_err(elsewhere)?;
    }
    for (path, text) in FILES {
        write_own(folder, path, text.as_bytes()).map_err(elsewhere)?;
    }
    tell(&format!(
        "a study with two scenes in pipeline/scenes, plate and disc,\n\
        and one page, report/templates/plate.md\n\
        next: cd {} && signorini run\n",
        quoted(folder)
    ))
}

/// Returns the bytes of a file with those lines of `text` that it lacks at the end.
fn with_lines(mut there: Vec<u8>, text: &str) -> Vec<u8> {
    let known: Vec<Vec<u8>> =
        there.split(|&byte| byte == b'\n').map(|line| line.trim_ascii_end().to_vec()).collect();
    for line in text.lines().filter(|line| !known.iter().any(|known| known == line.as_bytes())) {
        if there.last().is_some_and(|&last| last != b'\n') {
            there.push(b'\n');
        }
        there.extend(line.bytes().chain([b'\n']));
    }
    there
}

/// Replaces the remedy of an I/O error, which speaks of the cache and of results.
fn elsewhere(mut e: Error) -> Error {
    if let Error::Io { remedy, .. } = &mut e {
        *remedy = "name a folder in another place";
    }
    e
}
