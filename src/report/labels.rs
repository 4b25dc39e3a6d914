//! Equations, figures and tables that pages refer to, with their numbers.
//!
//! Equations carry their numbers themselves. Figures are elements `<figure id="figure-NAME">` and tables elements
//! `<figure id="table-NAME">`; they are numbered in the order of the pages in `SUMMARY.md`.

use super::markdown::{parse, place, split_tag};
use pulldown_cmark::{Event, Tag};
use regex::Regex;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Tag of a figure or a table.
static FIGURE: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r#"<figure id="(figure|table)-([A-Za-z0-9_.-]+)""#).expect("the pattern is tested")
});

/// Path of the list of the pages.
const SUMMARY: &str = "src/SUMMARY.md";

/// Part of a page to which links may lead.
struct Label {
    /// Path of the page.
    page: String,
    id: String,
    /// Text of a link to the part.
    text: String,
}

/// Labels by the target of the links that lead to them: `eq:NUMBER`, `figure:NAME` or `table:NAME`.
#[derive(Default)]
pub(super) struct Labels {
    by_target: BTreeMap<String, Label>,
    figures: usize,
    tables: usize,
}

impl Labels {
    /// Collects the labels of all pages, Markdown by path.
    pub(super) fn of(pages: &BTreeMap<&str, &str>) -> Result<Self, String> {
        let mut labels = Self::default();
        for (name, text) in pages {
            labels.add_equations(name, text)?;
        }
        for name in listed(pages) {
            if let Some((name, text)) = pages.get_key_value(name.as_str()) {
                labels.add_figures(name, text)?;
            }
        }
        Ok(labels)
    }

    fn add_equations(&mut self, page: &str, markdown: &str) -> Result<(), String> {
        for (event, range) in parse(markdown) {
            if let Event::DisplayMath(latex) = event
                && let (_, Some(number)) = split_tag(&latex)
            {
                let label = Label {
                    page: page.into(),
                    id: format!("eq-{number}"),
                    text: format!("({number})"),
                };
                if let Some(first) = self.by_target.insert(format!("eq:{number}"), label) {
                    return Err(format!(
                        "{}: equation ({number}) is numbered already in {}; tags must be unique",
                        place(page, markdown, range.start),
                        first.page
                    ));
                }
            }
        }
        Ok(())
    }

    fn add_figures(&mut self, page: &str, markdown: &str) -> Result<(), String> {
        for (event, range) in parse(markdown) {
            let (Event::Html(html) | Event::InlineHtml(html)) = event else { continue };
            for found in FIGURE.captures_iter(&html) {
                let (kind, name) = (&found[1], &found[2]);
                let text = match kind {
                    "figure" => {
                        self.figures += 1;
                        format!("Figure {}", self.figures)
                    }
                    _ => {
                        self.tables += 1;
                        format!("Table {}", self.tables)
                    }
                };
                let label = Label { page: page.into(), id: format!("{kind}-{name}"), text };
                if let Some(first) = self.by_target.insert(format!("{kind}:{name}"), label) {
                    return Err(format!(
                        "{}: the {kind} `{name}` is in {} already; names must be unique",
                        place(page, markdown, range.start),
                        first.page
                    ));
                }
            }
        }
        Ok(())
    }

    /// Returns the Markdown of the link in a page that leads to a label; `None` if the target is no label.
    pub(super) fn link(&self, page: &str, target: &str) -> Option<Result<String, String>> {
        let (kind, name) = target.split_once(':')?;
        let what = match kind {
            "eq" => format!("no equation is tagged ({name})"),
            "figure" | "table" => {
                format!("no page in SUMMARY.md has `<figure id=\"{kind}-{name}\">`")
            }
            _ => return None,
        };
        let Some(Label { page: home, id, text }) = self.by_target.get(target) else {
            return Some(Err(format!("{what}, but `{target}` refers to it")));
        };
        // Both paths begin with the folder of the pages.
        let up = "../".repeat(page.matches('/').count().saturating_sub(1));
        let file = home.strip_prefix("src/").unwrap_or(home);
        Some(Ok(format!("[{text}](<{up}{file}#{id}>)")))
    }
}

/// Returns the paths of the pages in the order of `SUMMARY.md`.
fn listed(pages: &BTreeMap<&str, &str>) -> Vec<String> {
    let mut listed = Vec::new();
    for (event, _) in parse(pages.get(SUMMARY).unwrap_or(&"")) {
        if let Event::Start(Tag::Link { dest_url, .. }) = event {
            listed.push(format!("src/{}", dest_url.trim_start_matches("./")));
        }
    }
    listed
}

#[cfg(test)]
mod tests {
    use super::*;

    const PICTURE: &str = "<figure id=\"figure-a\">\n</figure>\n";

    fn of(pages: &[(&'static str, &'static str)]) -> Result<Labels, String> {
        Labels::of(&pages.iter().copied().collect())
    }

    #[test]
    fn equations_are_found_from_other_pages() {
        let labels = of(&[("src/b.md", "$$ x \\tag{7} $$")]).unwrap();
        assert_eq!(labels.link("src/a.md", "eq:7"), Some(Ok("[(7)](<b.md#eq-7>)".into())));
        assert_eq!(labels.link("src/sub/a.md", "eq:7"), Some(Ok("[(7)](<../b.md#eq-7>)".into())));
        assert_eq!(labels.link("src/a.md", "https://a.b"), None);
    }

    #[test]
    fn figures_and_tables_are_numbered_in_the_order_of_the_summary() {
        let summary = "# Summary\n\n[Z](z.md)\n\n- [A](a.md)\n";
        let z =
            "<figure id=\"figure-z\">\n</figure>\n\n```text\n<figure id=\"figure-code\">\n```\n";
        let a = "<figure id=\"table-a\" class=\"table\">\n</figure>\n\n<figure id=\"figure-a\">\n</figure>\n";
        let labels = of(&[(SUMMARY, summary), ("src/a.md", a), ("src/z.md", z)]).unwrap();
        let link = |target| labels.link("src/z.md", target).unwrap().unwrap();
        assert_eq!(link("figure:z"), "[Figure 1](<z.md#figure-z>)");
        assert_eq!(link("figure:a"), "[Figure 2](<a.md#figure-a>)");
        assert_eq!(link("table:a"), "[Table 1](<a.md#table-a>)");
        assert!(labels.link("src/z.md", "figure:code").unwrap().is_err());
    }

    #[test]
    fn mistakes_are_named() {
        let summary = (SUMMARY, "[A](a.md)\n[B](b.md)\n");
        let twice = of(&[summary, ("src/a.md", PICTURE), ("src/b.md", PICTURE)]);
        let twice = twice.err().unwrap();
        assert!(twice.starts_with("src/b.md:1: the figure `a` is in src/a.md already"), "{twice}");
        let equations = "$$ a \\tag{1} $$\n\n$$ b \\tag{1} $$";
        let twice = of(&[("src/a.md", equations)]).err().unwrap();
        assert!(twice.contains("(1) is numbered already in src/a.md"), "{twice}");
        let none = of(&[("src/a.md", PICTURE)]).unwrap();
        let missing = none.link("src/a.md", "figure:a").unwrap().unwrap_err();
        assert!(missing.starts_with("no page in SUMMARY.md has `<figure id=\"figure-a\">`"));
        let missing = none.link("src/a.md", "eq:99").unwrap().unwrap_err();
        assert_eq!(missing, "no equation is tagged (99), but `eq:99` refers to it");
    }
}
