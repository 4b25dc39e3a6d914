//! Build of the book from bytes to bytes, by mdBook in this process and in a temporary folder.

use super::backend::Backend;
use super::labels::Labels;
use super::mathml::convert;
use super::outputs::{self, Own, PAGES, Pages};
use super::settings::Settings;
use super::{includes, links, programs};
use crate::pipeline::error::Error;
use crate::pipeline::files::{read_tree, temporary_folder};
use crate::pipeline::names::described;
use mdbook_driver::MDBook;
use rayon::prelude::*;
use signorini_mathematics::problem::text::is_forbidden;
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Returns the first page of a book with these files, by path from its folder.
///
/// In a book with further outputs, mdBook makes a folder for each output.
pub(crate) fn first_page<'a>(built: impl Iterator<Item = &'a str> + Clone) -> Option<&'static str> {
    ["index.html", "html/index.html"]
        .into_iter()
        .find(|page| built.clone().any(|path| path == *page))
}

/// Refuses a `book.toml` with a mistake, or with a path that leads out of its folder.
///
/// # Errors
/// [`Error::Input`](crate::pipeline::error::Error::Input) with the line of the mistake.
pub(crate) fn check_settings(book_toml: &[u8]) -> Result<(), Error> {
    checked(book_toml).map(|_| ())
}

/// Reads and checks `book.toml`.
fn checked(book_toml: &[u8]) -> Result<Settings<'_>, Error> {
    let settings = Settings::read(book_toml)?;
    programs::check(&settings)?;
    Ok(settings)
}

/// Builds the book whose files, by path from the folder of `book.toml`, are `files`.
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
    let Some(book_toml) = files.get("book.toml") else {
        return Err("report/book.toml is missing; the book needs one, if only with a title".into());
    };
    let settings = checked(book_toml).map_err(|e| e.to_string())?;
    settings.check_files(files).map_err(|e| e.to_string())?;
    programs::check_files(&settings, files).map_err(|e| e.to_string())?;
    let mut pages = BTreeMap::new();
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".md")) {
        let text = std::str::from_utf8(bytes);
        let text = text.map_err(|_| format!("{name}: not UTF-8 text"))?;
        refuse_forbidden(name, text)?;
        pages.insert(name.as_str(), text);
    }
    if !pages.contains_key("src/SUMMARY.md") {
        return Err(
            "report/templates has no SUMMARY.md; list the pages there, as `- [Title](page.md)`"
                .into(),
        );
    }
    let labels = Labels::of(&pages)?;
    if settings.is_on("links") {
        for name in pages.keys() {
            includes::check(name, files)?;
        }
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
    for program in programs::own(&settings).map_err(|e| e.to_string())? {
        allow_to_run(&root.join(program))?;
    }
    let listed = outputs::listed(&pages, &settings)?;
    if settings.has_html() {
        let own = Own::of(root, &settings, &scratch.path().join("own"))
            .map_err(|e| in_templates(e, root))?;
        outputs::check_names(&pages, &listed, &settings, &own)?;
    }
    with_mdbook(root, &settings).map_err(|error| in_templates(error, root))?;
    let folder = root.join(&settings.config.build.build_dir);
    let mut built = read_tree(&folder, |_| false).map_err(|(path, source)| io(&path, source))?;
    if let Some(inside) = settings.html_folder() {
        outputs::add_files(&mut built, files, inside)?;
        check_links(&pages, &built, inside)?;
    }
    Ok(built)
}

/// Refuses links and directives of pages that lead to nothing in the HTML, which is in the folder `inside` of the book.
fn check_links(
    pages: &BTreeMap<&str, &str>,
    built: &BTreeMap<String, Vec<u8>>,
    inside: &str,
) -> Result<(), String> {
    let mut html: BTreeMap<&str, &[u8]> = BTreeMap::new();
    for (name, bytes) in built {
        if let Some(name) = name.strip_prefix(inside) {
            html.insert(name, bytes);
        }
    }
    let site = links::Site::new(&html);
    for (name, text) in pages {
        if let Some(page) = links::page(name, &html) {
            includes::refuse_left(name, text, html[page.as_str()])?;
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

/// Builds all outputs of the book in this folder by mdBook.
fn with_mdbook(folder: &Path, settings: &Settings<'_>) -> mdbook_driver::errors::Result<()> {
    let mut book = MDBook::load_with_config(folder, settings.config.clone())?;
    for (name, table) in &settings.outputs {
        book.with_renderer(Backend::new(name, table)?);
    }
    if settings.has_html() {
        book.with_renderer(Pages);
    }
    book.build()
}

/// Marks a file as a program.
fn allow_to_run(path: &Path) -> Result<(), String> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(path, fs::Permissions::from_mode(0o755))
            .map_err(|source| io(path, source))?;
    }
    Ok(())
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
