//! Build of the book from bytes to bytes, by mdBook in this process and in a temporary folder.

use super::contents::{PRINT, with_contents};
use super::labels::Labels;
use super::mathml::convert;
use super::outputs::{self, PAGES, Pages};
use super::settings::{THEME, of_mdbook};
use super::summary::{SUMMARY, listed, title};
use super::{includes, links};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use rayon::prelude::*;
use signorini_pipeline::files::{is_forbidden, read_tree, temporary_folder};
use signorini_pipeline::names::described;
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Page with which the book opens.
pub const FIRST: &str = "index.html";

/// Builds the book whose files, by path in its folder, are `files`.
///
/// Files whose paths begin with `../` are outside that folder, and pages may include them. Formulas in `*.md` are set
/// as MathML. Returns every file of the built book by its path there; equal files give equal bytes. A temporary folder
/// in `scratch` is used and removed at the end, also after errors.
///
/// # Errors
/// A sentence if a formula, a reference or a link is wrong, mdBook refuses the book, or a file cannot be written.
pub fn build(
    files: &BTreeMap<String, Vec<u8>>,
    scratch: &Path,
) -> Result<BTreeMap<String, Vec<u8>>, String> {
    let mut pages = BTreeMap::new();
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".md")) {
        let text = std::str::from_utf8(bytes);
        let text = text.map_err(|_| format!("{name}: not UTF-8 text"))?;
        refuse_forbidden(name, text)?;
        pages.insert(name.as_str(), text);
    }
    let Some(summary) = pages.get(SUMMARY) else {
        return Err(
            "report/templates has no SUMMARY.md; list the pages there, as `- [Title](page.md)`"
                .into(),
        );
    };
    let listed = listed(summary)?;
    for path in listed.iter().map(|page| &page.path) {
        if !pages.contains_key(format!("src/{path}").as_str()) {
            return Err(format!(
                "report/templates/SUMMARY.md lists `{path}`, and there is no such file; add it, or take it from the \
                 list"
            ));
        }
    }
    let labels = Labels::of(&pages, &listed)?;
    for name in pages.keys() {
        includes::check(name, files)?;
    }

    let set: Vec<_> =
        pages.par_iter().map(|(name, text)| (*name, convert(name, text, &labels))).collect();
    let scratch = temporary_folder(scratch).map_err(|source| io(scratch, source))?;
    let root = &scratch.path().join("report");
    for (name, bytes) in files.iter().filter(|(name, _)| !pages.contains_key(name.as_str())) {
        write(&root.join(name), bytes)?;
    }
    for (name, page) in set {
        let page = page?;
        write(&root.join(name), page.as_bytes())?;
        if let Some(path) = name.strip_prefix("src/") {
            write(&root.join(PAGES).join(path), page.as_bytes())?;
        }
    }
    fs::create_dir_all(root.join(THEME)).map_err(|source| io(root, source))?;
    for (name, bytes) in files.iter().filter(|(name, _)| name.starts_with("theme/fonts/")) {
        write(&root.join(name.replacen("theme", THEME, 1)), bytes)?;
    }
    let config = of_mdbook(title(summary), files);
    with_mdbook(root, config).map_err(|error| in_templates(error, root))?;
    let mut built =
        read_tree(&root.join("book"), |_| false).map_err(|(path, source)| io(&path, source))?;
    if let Some(print) = built.get_mut(PRINT) {
        *print = with_contents(&String::from_utf8_lossy(print), &listed).into_bytes();
    }
    outputs::add_files(&mut built, files)?;
    check_links(&pages, &built)?;
    Ok(built)
}

/// Refuses links of pages that lead to nothing in the built book.
fn check_links(
    pages: &BTreeMap<&str, &str>,
    built: &BTreeMap<String, Vec<u8>>,
) -> Result<(), String> {
    let site = links::Site::new(built);
    for (name, text) in pages {
        let page = outputs::html(name);
        // A page that no list names is not built.
        if built.contains_key(&page) {
            links::check(name, text, &page, &site)?;
        }
    }
    Ok(())
}

/// Returns an error of mdBook in one line, with the paths of the pages that the user knows.
fn in_templates(error: mdbook_driver::errors::Error, root: &Path) -> String {
    let mut said = format!("mdBook: {error:#}");
    for folder in ["src", PAGES] {
        said = said.replace(&format!("{}/{folder}/", root.display()), "report/templates/");
    }
    said = said.replace(&format!("{}/", root.display()), "report/");
    with_remedy(said)
}

/// Returns an error of the system with a remedy, if it is a full disk.
fn with_remedy(said: String) -> String {
    let is_full = ["No space left", "Disk quota exceeded"].iter().any(|full| said.contains(full));
    if is_full { said + "; free some space and repeat the command" } else { said }
}

/// Refuses a page with a character that no line of text may have; tabs and ends of lines and pages are none.
fn refuse_forbidden(name: &str, text: &str) -> Result<(), String> {
    for (k, line) in text.lines().enumerate() {
        if let Some(c) =
            line.chars().find(|c| is_forbidden(*c) && !['\t', '\r', '\u{c}'].contains(c))
        {
            return Err(format!("{name}:{}: {}; take it out", k + 1, described(c)));
        }
    }
    Ok(())
}

/// Builds the book in this folder by mdBook.
fn with_mdbook(folder: &Path, config: Config) -> mdbook_driver::errors::Result<()> {
    let mut book = MDBook::load_with_config(folder, config)?;
    book.with_renderer(Pages);
    book.build()
}

fn io(path: &Path, error: std::io::Error) -> String {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            with_remedy(format!("{}: No space left", path.display()))
        }
        _ => format!("{}: {error}; building the book needs this folder for itself", path.display()),
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(path, bytes))
        .map_err(|source| io(path, source))
}
