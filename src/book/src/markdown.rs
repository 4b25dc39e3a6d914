//! Markdown of a page as mdBook reads it, with formulas.

use pulldown_cmark::{Event, Options, Parser, Tag};
use std::ops::Range;

/// Parses as mdBook does, with formulas, and leaves out blocks of code.
pub(super) fn parse(markdown: &str) -> impl Iterator<Item = (Event<'_>, Range<usize>)> {
    let options = Options::ENABLE_TABLES
        | Options::ENABLE_FOOTNOTES
        | Options::ENABLE_STRIKETHROUGH
        | Options::ENABLE_TASKLISTS
        | Options::ENABLE_HEADING_ATTRIBUTES
        | Options::ENABLE_DEFINITION_LIST
        | Options::ENABLE_GFM
        | Options::ENABLE_MATH;
    let mut in_code = false;
    Parser::new_ext(markdown, options).into_offset_iter().filter(move |(event, _)| {
        match event {
            Event::Start(Tag::CodeBlock(_)) => in_code = true,
            Event::End(pulldown_cmark::TagEnd::CodeBlock) => in_code = false,
            _ => {}
        }
        !in_code
    })
}

/// Returns file and line of a byte in the text of a chapter.
pub(super) fn place(chapter: &str, markdown: &str, at: usize) -> String {
    format!("{chapter}:{}", 1 + markdown[..at].matches('\n').count())
}

/// Returns the formula without its closing `\tag{n}`, and n.
pub(super) fn split_tag(latex: &str) -> (&str, Option<&str>) {
    let trimmed = latex.trim();
    trimmed
        .strip_suffix('}')
        .and_then(|rest| rest.rsplit_once(r"\tag{"))
        .map_or((trimmed, None), |(body, label)| (body.trim(), Some(label)))
}
