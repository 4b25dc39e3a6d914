//! Names of the files of a built book. mdBook writes one file over another of the same name without a word.

use mdbook_driver::errors::Result;
use mdbook_html::HtmlHandlebars;
use mdbook_renderer::{RenderContext, Renderer};
use std::collections::BTreeMap;

/// Folder with the pages alone. From there mdBook copies no other files: those beside the pages would replace its own.
pub(super) const PAGES: &str = "templates";

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

/// Adds to a built book the files that lie beside the pages.
///
/// # Errors
/// A sentence if the book has a file of the same name.
pub(super) fn add_files(
    built: &mut BTreeMap<String, Vec<u8>>,
    files: &BTreeMap<String, Vec<u8>>,
) -> std::result::Result<(), String> {
    for (name, bytes) in files.iter().filter(|(name, _)| !name.ends_with(".md")) {
        let Some(path) = name.strip_prefix("src/") else { continue };
        if built.insert(path.to_owned(), bytes.clone()).is_some() {
            return Err(format!(
                "{name}: the book has a file of this name that mdBook makes; rename this one"
            ));
        }
    }
    Ok(())
}
