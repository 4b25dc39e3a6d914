//! mdBook, run in this process in a folder of its own, from bytes to bytes.

use super::links;
use super::mathml::{Labels, collect_labels, convert};
use crate::pipeline::files::{read_tree, temporary_folder};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::str::FromStr;

/// Builds the book whose files, by path from the folder of `book.toml`, are `files`.
///
/// Formulas in `*.md` are set as MathML. Returns every file of the built book by its path in it.
/// The same files give the same bytes. A folder of its own in `scratch` is used meanwhile and removed
/// at the end, also on errors.
///
/// # Errors
/// A sentence if a formula, a reference or a link is wrong, mdBook refuses the book, or the disk does.
pub fn build(
    files: &BTreeMap<String, Vec<u8>>,
    scratch: &Path,
) -> Result<BTreeMap<String, Vec<u8>>, String> {
    let mut pages = BTreeMap::new();
    let mut labels = Labels::new();
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".md")) {
        let text = std::str::from_utf8(bytes);
        let text = text.map_err(|_| format!("{name}: not UTF-8 text"))?;
        collect_labels(name, text, &mut labels)?;
        pages.insert(name, text);
    }
    let mut config = match files.get("book.toml") {
        Some(bytes) => settings(bytes)?,
        None => {
            return Err(
                "report/book.toml is missing; the book needs one, if only with a title".into()
            );
        }
    };
    config.build.create_missing = false;

    let scratch = temporary_folder(scratch).map_err(|source| io(scratch, source))?;
    let scratch = scratch.path();
    for (name, bytes) in files {
        match pages.get(name) {
            Some(text) => write(&scratch.join(name), convert(name, text, &labels)?.as_bytes())?,
            None => write(&scratch.join(name), bytes)?,
        }
    }
    let built = scratch.join(&config.build.build_dir);
    MDBook::load_with_config(scratch, config).and_then(|book| book.build()).map_err(|error| {
        let copies = format!("{}/src/", scratch.display());
        format!("mdBook: {error:#}").replace(&copies, "report/templates/")
    })?;
    let built = read_tree(&built, |_| false).map_err(|(path, source)| io(&path, source))?;
    pages.iter().try_for_each(|(name, text)| links::check(name, text, &built))?;
    Ok(built)
}

/// Reads `book.toml`.
pub(crate) fn settings(book_toml: &[u8]) -> Result<Config, String> {
    let text = std::str::from_utf8(book_toml).map_err(|_| "report/book.toml: not UTF-8 text")?;
    let config = Config::from_str(text).map_err(|error| format!("report/book.toml: {error:#}"))?;
    // mdBook empties the first folder and may write to the second: they must be ours.
    for (setting, folder, ours) in [
        ("build.build-dir", &config.build.build_dir, "book"),
        ("book.src", &config.book.src, "src"),
    ] {
        if folder != Path::new(ours) {
            let folder = folder.display();
            return Err(format!("report/book.toml: {setting} is `{folder}`, but must be `{ours}`"));
        }
    }
    Ok(config)
}

fn io(path: &Path, error: std::io::Error) -> String {
    format!("{}: {error}; building the book needs this folder for itself", path.display())
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(path, bytes))
        .map_err(|source| io(path, source))
}
