//! Names of the files of a built book. mdBook writes one file over another of the same name without a word.

use super::markdown::{parse, place};
use crate::pipeline::names::alike;
use mdbook_driver::errors::Result;
use mdbook_html::HtmlHandlebars;
use mdbook_renderer::{RenderContext, Renderer};
use pulldown_cmark::{Event, Tag};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Folder with the pages alone. From there mdBook copies no other files: those beside the pages would replace its own.
pub(super) const PAGES: &str = "templates";

/// List of the pages.
pub(super) const SUMMARY: &str = "src/SUMMARY.md";

/// Pages that mdBook makes of all pages. It also copies the first page to `index.html`, unless the book has a page of
/// this name.
const OWN: [&str; 2] = ["print.html", "toc.html"];

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

/// A page that `SUMMARY.md` lists.
pub(super) struct ListedPage {
    /// Path among the pages.
    pub path: String,
    /// Place in `SUMMARY.md`.
    place: String,
}

/// Returns the pages that `SUMMARY.md` lists, in its order.
///
/// # Errors
/// A sentence if there is none, or one is no page in the folder of the pages.
pub(super) fn listed(summary: &str) -> std::result::Result<Vec<ListedPage>, String> {
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
        listed.push(ListedPage { path, place });
    }
    match listed.is_empty() {
        true => Err(format!("{SUMMARY}:1: it lists no page; list one, as `- [Title](page.md)`")),
        false => Ok(listed),
    }
}

/// Returns the path without steps upwards; `None` for one that leads out of the folder where it begins.
fn below(path: &str) -> Option<String> {
    let mut steps = Vec::new();
    for step in path.split('/') {
        match step {
            "" if steps.is_empty() => return None,
            "" | "." => (),
            ".." => _ = steps.pop()?,
            step => steps.push(step),
        }
    }
    Some(steps.join("/"))
}

/// Returns the path in the book of the HTML of a page, given by its path among the pages.
fn html(page: &str) -> String {
    Path::new(page).with_extension("html").to_string_lossy().into_owned()
}

/// Refuses pages that would make one file of the book twice.
pub(super) fn check_names(
    pages: &BTreeMap<&str, &str>,
    listed: &[ListedPage],
) -> std::result::Result<(), String> {
    for name in pages.keys() {
        let page = name.strip_prefix("src/").unwrap_or(name);
        if OWN.contains(&&*alike(&html(page))) {
            return Err(format!(
                "{name}:1: mdBook makes a page of this name itself; rename this one, also in SUMMARY.md"
            ));
        }
    }
    let mut by_name: BTreeMap<String, &ListedPage> = BTreeMap::new();
    for page in listed {
        let html = html(&page.path);
        let first = by_name.insert(alike(&html), page);
        if let Some(first) = first.filter(|first| first.path != page.path) {
            return Err(format!(
                "{}: `{}` and `{}` become one file of the book, {html}; rename one of them",
                page.place, first.path, page.path
            ));
        }
    }
    Ok(())
}

/// Adds to a built book the files that lie beside the pages.
///
/// # Errors
/// A sentence if the book has a file of the same name.
pub(super) fn add_files(
    built: &mut BTreeMap<String, Vec<u8>>,
    files: &BTreeMap<String, Vec<u8>>,
) -> std::result::Result<(), String> {
    let (mut made, mut folders) = (BTreeSet::new(), BTreeSet::new());
    for name in built.keys() {
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
        built.insert(path.to_owned(), bytes.clone());
    }
    Ok(())
}
