//! Names of the files of a built book. mdBook writes one file over another of the same name without a word.

use super::summary::ListedPage;
use crate::pipeline::names::alike;
use mdbook_driver::errors::Result;
use mdbook_html::HtmlHandlebars;
use mdbook_renderer::{RenderContext, Renderer};
use std::collections::{BTreeMap, BTreeSet};

/// Folder with the pages alone. From there mdBook copies no other files: those beside the pages would replace its own.
pub(super) const PAGES: &str = "templates";

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

/// Returns the path in the book of the page that mdBook makes of a page in Markdown.
pub(super) fn html(page: &str) -> String {
    let page = page.strip_prefix("src/").unwrap_or(page);
    page.strip_suffix(".md").unwrap_or(page).to_owned() + ".html"
}

/// Refuses pages that would make one file of the book twice.
pub(super) fn check_names(
    pages: &BTreeMap<&str, &str>,
    listed: &[ListedPage],
) -> std::result::Result<(), String> {
    if let Some(name) = pages.keys().find(|name| OWN.contains(&&*alike(&html(name)))) {
        return Err(format!(
            "{name}:1: mdBook makes a page of this name itself; rename this one, also in SUMMARY.md"
        ));
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
