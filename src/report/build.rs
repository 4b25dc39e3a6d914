//! Build of the book from bytes to bytes, by mdBook in this process and in a temporary folder.

use super::backend::Backend;
use super::labels::Labels;
use super::mathml::convert;
use super::{includes, links};
use crate::pipeline::files::{read_tree, temporary_folder};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::str::FromStr;

/// Names of pages that mdBook adds.
const MADE_BY_MDBOOK: [&str; 2] = ["src/toc.md", "src/print.md"];

/// Returns the first page of a book with these files, by path from its folder.
///
/// In a book with further outputs, mdBook makes a folder for each output.
pub(crate) fn first_page<'a>(built: impl Iterator<Item = &'a str> + Clone) -> Option<&'static str> {
    ["index.html", "html/index.html"]
        .into_iter()
        .find(|page| built.clone().any(|path| path == *page))
}

/// Builds the book whose files, by path from the folder of `book.toml`, are `files`.
///
/// Files whose paths begin with `../` are outside that folder, and pages may include them. Formulas in `*.md` are set as
/// MathML. Returns every file of the built book by its path there; equal files give equal bytes. A temporary folder in
/// `scratch` is used and removed at the end, also after errors.
///
/// # Errors
/// A sentence if a formula, a reference or a link is wrong, mdBook refuses the book, or a file cannot be written.
pub fn build(
    files: &BTreeMap<String, Vec<u8>>,
    scratch: &Path,
) -> Result<BTreeMap<String, Vec<u8>>, String> {
    let mut pages = BTreeMap::new();
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".md")) {
        if MADE_BY_MDBOOK.iter().any(|made| made.eq_ignore_ascii_case(name)) {
            return Err(format!(
                "{name}:1: mdBook makes a page of this name itself; rename this one, also in SUMMARY.md"
            ));
        }
        let text = std::str::from_utf8(bytes);
        let text = text.map_err(|_| format!("{name}: not UTF-8 text"))?;
        pages.insert(name.as_str(), text);
    }
    let labels = Labels::of(&pages)?;
    let mut config = match files.get("book.toml") {
        Some(bytes) => settings(bytes)?,
        None => {
            return Err(
                "report/book.toml is missing; the book needs one, if only with a title".into()
            );
        }
    };
    config.build.create_missing = false;

    if is_on("links", &config) {
        for name in pages.keys() {
            includes::check(name, files)?;
        }
    }

    let scratch = temporary_folder(scratch).map_err(|source| io(scratch, source))?;
    let scratch = &scratch.path().join("report");
    for (name, bytes) in files {
        match pages.get(name.as_str()) {
            Some(text) => write(&scratch.join(name), convert(name, text, &labels)?.as_bytes())?,
            None => write(&scratch.join(name), bytes)?,
        }
    }
    let folder = scratch.join(&config.build.build_dir);
    with_mdbook(scratch, config).map_err(|error| {
        let copies = format!("{}/src/", scratch.display());
        format!("mdBook: {error:#}").replace(&copies, "report/templates/").replace('\n', " ")
    })?;
    let built = read_tree(&folder, |_| false).map_err(|(path, source)| io(&path, source))?;
    let first = first_page(built.keys().map(String::as_str)).unwrap_or_default();
    let inside = first.trim_end_matches("index.html");
    let mut html: BTreeMap<&str, &[u8]> = BTreeMap::new();
    for (name, bytes) in &built {
        if let Some(name) = name.strip_prefix(inside) {
            html.insert(name, bytes);
        }
    }
    for (name, text) in &pages {
        if let Some(page) = links::page(name, &html) {
            includes::refuse_left(name, text, html[page.as_str()])?;
            links::check(name, text, &page, &html)?;
        }
    }
    Ok(built)
}

/// Builds all outputs of the book in this folder by mdBook.
fn with_mdbook(folder: &Path, config: Config) -> mdbook_driver::errors::Result<()> {
    let outputs = config.outputs()?;
    let mut book = MDBook::load_with_config(folder, config)?;
    for backend in outputs.into_iter().filter_map(Backend::new) {
        book.with_renderer(backend);
    }
    book.build()
}

/// True if mdBook's own preprocessor with this name works on the pages.
fn is_on(preprocessor: &str, config: &Config) -> bool {
    let named = config.get::<toml::Value>(&format!("preprocessor.{preprocessor}"));
    config.build.use_default_preprocessors || named.is_ok_and(|named| named.is_some())
}

/// Reads `book.toml`.
pub(crate) fn settings(book_toml: &[u8]) -> Result<Config, String> {
    let text = std::str::from_utf8(book_toml).map_err(|_| "report/book.toml: not UTF-8 text")?;
    let config = Config::from_str(text).map_err(|error| format!("report/book.toml: {error:#}"))?;
    // mdBook empties the first folder and may write to the second: neither may hold files of the user.
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
