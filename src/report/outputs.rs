//! Names of the files of a built book. mdBook writes one file over another of the same name without a word.

use super::markdown::{parse, place};
use super::paths::below;
use super::settings::Settings;
use crate::pipeline::files::read_tree;
use crate::pipeline::names::alike;
use mdbook_driver::book::Book;
use mdbook_driver::errors::{Error, Result};
use mdbook_html::HtmlHandlebars;
use mdbook_renderer::{RenderContext, Renderer};
use pulldown_cmark::{Event, Tag};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Folder with the pages alone. From there mdBook copies no other files: those beside the pages would replace its own.
pub(super) const PAGES: &str = "templates";

/// List of the pages.
const SUMMARY: &str = "src/SUMMARY.md";

/// Page with which a link to the book opens. mdBook copies the first page there, unless the book has a page of this
/// name.
const FIRST: &str = "index.html";

/// mdBook's HTML, without the files beside the pages.
pub(super) struct Pages;

impl Renderer for Pages {
    fn name(&self) -> &'static str {
        "html"
    }

    fn render(&self, context: &RenderContext) -> Result<()> {
        let mut context = context.clone();
        context.config.book.src = PAGES.into();
        HtmlHandlebars::new().render(&context)
    }
}

/// Names of the files that mdBook makes without being asked for them, in the form of [`alike`].
pub(super) struct Own(BTreeSet<String>);

impl Own {
    /// Returns the names that mdBook gives to the files of a book without pages; `scratch` is a folder to build it in.
    pub(super) fn of(root: &Path, settings: &Settings<'_>, scratch: &Path) -> Result<Self> {
        let mut config = settings.config.clone();
        // Names without hashes, and nothing of the user's.
        config.set("output.html.hash-files", false)?;
        for list in ["additional-css", "additional-js"] {
            config.set(format!("output.html.{list}"), Vec::<String>::new())?;
        }
        for table in ["redirect", "search.chapter"] {
            config.set(format!("output.html.{table}"), BTreeMap::<String, String>::new())?;
        }
        Pages.render(&RenderContext::new(root, Book::new(), config, scratch))?;
        let files = read_tree(scratch, |_| false).map_err(|(_, error)| Error::from(error))?;
        Ok(Self(files.keys().map(|name| alike(name)).collect()))
    }

    fn has(&self, name: &str) -> bool {
        self.0.contains(&alike(name))
    }
}

/// A page that `SUMMARY.md` lists.
pub(super) struct ListedPage {
    /// Path from the folder of `book.toml`.
    file: String,
    /// Path of its HTML in the book.
    html: String,
    /// Place in `SUMMARY.md`.
    place: String,
}

/// Returns the pages that `SUMMARY.md` lists, in its order.
///
/// # Errors
/// A sentence if there is none, or one is no page in the folder of the pages.
pub(super) fn listed(
    pages: &BTreeMap<&str, &str>,
    settings: &Settings<'_>,
) -> std::result::Result<Vec<ListedPage>, String> {
    let summary = pages.get(SUMMARY).unwrap_or(&"");
    let mut listed = Vec::new();
    for (event, range) in parse(summary) {
        let Event::Start(Tag::Link { dest_url, .. }) = event else { continue };
        // mdBook decodes spaces alone.
        let target = dest_url.replace("%20", " ");
        let place = place(SUMMARY, summary, range.start);
        if target.is_empty() {
            continue;
        }
        let Some(path) = below(&target) else {
            return Err(format!(
                "{place}: `{dest_url}` is no page in report/templates; copy it there, and list the copy"
            ));
        };
        if !path.ends_with(".md") {
            return Err(format!(
                "{place}: `{dest_url}` is listed, but is no page `*.md`; rename it, here too"
            ));
        }
        let html = html(&path, settings);
        listed.push(ListedPage { file: format!("src/{path}"), html, place });
    }
    match listed.is_empty() && pages.contains_key(SUMMARY) {
        true => Err(format!("{SUMMARY}:1: it lists no page; list one, as `- [Title](page.md)`")),
        false => Ok(listed),
    }
}

/// Returns the path in the book of the HTML of a page, given by its path among the pages.
fn html(page: &str, settings: &Settings<'_>) -> String {
    let path = Path::new(page);
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    // mdBook makes a readme the first page of its folder.
    let path = match stem.eq_ignore_ascii_case("readme") && settings.is_on("index") {
        true => path.with_file_name(FIRST),
        false => path.with_extension("html"),
    };
    path.to_string_lossy().into_owned()
}

/// Refuses pages and settings that would make one file of the book twice.
pub(super) fn check_names(
    pages: &BTreeMap<&str, &str>,
    listed: &[ListedPage],
    settings: &Settings<'_>,
    own: &Own,
) -> std::result::Result<(), String> {
    // The source of mdBook's page on errors is a page that no list names.
    let source = settings.html.input_404.as_deref().unwrap_or("404.md");
    for name in pages.keys() {
        let page = name.strip_prefix("src/").unwrap_or(name);
        let is_source = page == source && !listed.iter().any(|listed| listed.file == *name);
        if own.has(&html(page, settings)) && !is_source {
            return Err(format!(
                "{name}:1: mdBook makes a page of this name itself; rename this one, also in SUMMARY.md"
            ));
        }
    }
    let mut by_name: BTreeMap<String, &ListedPage> = BTreeMap::new();
    for page in listed {
        let first = by_name.insert(alike(&page.html), page);
        if let Some(first) = first.filter(|first| first.file != page.file) {
            let [one, other] = [first, page].map(|page| page.file.trim_start_matches("src/"));
            return Err(format!(
                "{}: `{one}` and `{other}` become one file of the book, {}; rename one of them",
                page.place, page.html
            ));
        }
    }
    let is_made =
        |name: &str| own.has(name) || by_name.contains_key(&alike(name)) || alike(name) == FIRST;
    settings.check_names(is_made).map_err(|e| e.to_string())
}

/// Adds to the HTML in `folder` of a built book the files that lie beside the pages.
///
/// # Errors
/// A sentence if the book has a file of the same name.
pub(super) fn add_files(
    built: &mut BTreeMap<String, Vec<u8>>,
    files: &BTreeMap<String, Vec<u8>>,
    folder: &str,
) -> std::result::Result<(), String> {
    let (mut made, mut folders) = (BTreeSet::new(), BTreeSet::new());
    for name in built.keys().filter_map(|name| name.strip_prefix(folder)) {
        made.insert(alike(name));
        folders.extend(name.match_indices('/').map(|(at, _)| alike(&name[..at])));
    }
    for (name, bytes) in files.iter().filter(|(name, _)| !name.ends_with(".md")) {
        let Some(path) = name.strip_prefix("src/") else { continue };
        let mut above = path.match_indices('/').map(|(at, _)| alike(&path[..at]));
        if made.contains(&alike(path))
            || folders.contains(&alike(path))
            || above.any(|folder| made.contains(&folder))
        {
            return Err(format!(
                "{name}: the book has a file of this name that mdBook makes; rename this one"
            ));
        }
        built.insert(format!("{folder}{path}"), bytes.clone());
    }
    Ok(())
}
