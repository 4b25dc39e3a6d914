//! The list of the pages of a book.

use super::markdown::{parse, place};
use pulldown_cmark::{Event, Tag, TagEnd};

/// List of the pages.
pub(super) const SUMMARY: &str = "src/SUMMARY.md";

/// A page that `SUMMARY.md` lists.
pub(super) struct ListedPage {
    /// Path among the pages.
    pub path: String,
    /// Number that mdBook gives to the chapter, such as `5.1`; without one `0`, or behind the chapters a letter, of an
    /// appendix.
    pub number: String,
}

/// Returns the title of the book: the heading of the list, if it begins with one.
pub(super) fn title(summary: &str) -> Option<&str> {
    summary.trim_start().lines().next()?.strip_prefix("# ").map(str::trim)
}

/// Returns the pages that `SUMMARY.md` lists, in its order.
///
/// # Errors
/// A sentence if there is none, or one is no page in the folder of the pages.
pub(super) fn listed(summary: &str) -> Result<Vec<ListedPage>, String> {
    let (mut listed, mut depth) = (Vec::new(), 0);
    // Numbers of the chapter and of those in which it is. The first goes on after the title of a part.
    let mut numbers: Vec<usize> = Vec::new();
    let mut appendices = 'A'..='Z';
    for (event, range) in parse(summary) {
        match event {
            Event::Start(Tag::List(_)) => depth += 1,
            Event::End(TagEnd::List(_)) => depth -= 1,
            Event::Start(Tag::Item) => {
                numbers.resize(depth, 0);
                numbers[depth - 1] += 1;
            }
            Event::Start(Tag::Link { dest_url, .. }) if !dest_url.is_empty() => {
                let place = place(SUMMARY, summary, range.start);
                let path =
                    page(&dest_url).map_err(|why| format!("{place}: `{dest_url}` is {why}"))?;
                let texts: Vec<String> = numbers.iter().map(usize::to_string).collect();
                let number = match depth {
                    0 if numbers.is_empty() => "0".into(),
                    0 => appendices.next().map_or_else(String::new, String::from),
                    _ => texts.join("."),
                };
                listed.push(ListedPage { path, number });
            }
            _ => {}
        }
    }
    match listed.is_empty() {
        true => Err(format!("{SUMMARY}:1: it lists no page; list one, as `- [Title](page.md)`")),
        false => Ok(listed),
    }
}

/// Returns the path among the pages to which a link of the list leads.
fn page(target: &str) -> Result<String, &'static str> {
    // mdBook decodes spaces alone.
    match below(&target.replace("%20", " ")) {
        None => Err("no page in report/templates; copy it there, and list the copy"),
        Some(path) if !path.ends_with(".md") => {
            Err("listed, but is no page `*.md`; rename it, here too")
        }
        Some(path) => Ok(path),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_lies_among_the_pages() {
        assert_eq!(page("./a/../b%20c.md").as_deref(), Ok("b c.md"));
        for target in ["/a.md", "../a.md", "a/../../b.md", "a.txt"] {
            assert!(page(target).is_err(), "{target}");
        }
    }
}
