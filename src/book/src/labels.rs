//! Equations, figures and tables that pages refer to, with their numbers.
//!
//! Equations carry their numbers themselves. Figures are elements `<figure id="figure-NAME">` and tables elements
//! `<figure id="table-NAME">`; they are numbered by the chapters of `SUMMARY.md`, as 5.1, so that a figure of the book
//! is not taken for one of a paper that it speaks of. Pages without a number are chapter 0.

use super::markdown::{parse, place, split_tag};
use super::summary::ListedPage;
use pulldown_cmark::Event;
use regex::Regex;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Tag of a figure or a table.
static FIGURE: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r#"<figure id="(figure|table)-([A-Za-z0-9_.%-]+)""#).expect("the pattern is tested")
});

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
}

impl Labels {
    /// Collects the labels of all pages, Markdown by path, of which some are listed.
    pub(super) fn of(pages: &BTreeMap<&str, &str>, listed: &[ListedPage]) -> Result<Self, String> {
        let mut labels = Self::default();
        for (name, text) in pages {
            labels.add_equations(name, text)?;
        }
        let mut counts = Counts::new();
        for ListedPage { path, number, .. } in listed {
            if let Some((name, text)) = pages.get_key_value(&*format!("src/{path}")) {
                labels.add_figures(name, text, |kind| numbered(&mut counts, kind, number))?;
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

    /// Adds the figures and tables of a page; `text` returns the text of links to the next one of a kind.
    fn add_figures(
        &mut self,
        page: &str,
        markdown: &str,
        mut text: impl FnMut(&str) -> String,
    ) -> Result<(), String> {
        for (event, range) in parse(markdown) {
            let (Event::Html(html) | Event::InlineHtml(html)) = event else { continue };
            for found in FIGURE.captures_iter(&html) {
                let (kind, name) = (&found[1], &found[2]);
                let text = text(kind);
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

/// Numbers of figures, and of tables, of the chapters so far, by kind and number of the chapter.
type Counts = BTreeMap<(String, String), usize>;

/// Returns the text of links to the next figure, or table, of a chapter.
fn numbered(counts: &mut Counts, kind: &str, chapter: &str) -> String {
    let count = counts.entry((kind.into(), chapter.into())).or_default();
    *count += 1;
    let what = if kind == "figure" { "Figure" } else { "Table" };
    format!("{what} {chapter}.{count}")
}

#[cfg(test)]
mod tests {
    use super::super::summary::{SUMMARY, listed};
    use super::*;

    const PICTURE: &str = "<figure id=\"figure-a\">\n</figure>\n";

    fn of(pages: &[(&'static str, &'static str)]) -> Result<Labels, String> {
        let pages: BTreeMap<&str, &str> = pages.iter().copied().collect();
        let listed = pages.get(SUMMARY).map_or(Ok(Vec::new()), |summary| listed(summary))?;
        Labels::of(&pages, &listed)
    }

    #[test]
    fn equations_are_found_from_other_pages() {
        let labels = of(&[("src/b.md", "$$ x \\tag{7} $$")]).unwrap();
        assert_eq!(labels.link("src/a.md", "eq:7"), Some(Ok("[(7)](<b.md#eq-7>)".into())));
        assert_eq!(labels.link("src/sub/a.md", "eq:7"), Some(Ok("[(7)](<../b.md#eq-7>)".into())));
        assert_eq!(labels.link("src/a.md", "https://a.b"), None);
    }

    #[test]
    fn figures_and_tables_are_numbered_by_chapter() {
        let summary = "# Summary\n\n[Z](z.md)\n\n- [A](a.md)\n\n# Part\n\n- [B](b.md)\n  - [C](c.md)\n\n[D](d.md)\n";
        let z =
            "<figure id=\"figure-z\">\n</figure>\n\n```text\n<figure id=\"figure-code\">\n```\n";
        let a = "<figure id=\"table-a\" class=\"table\">\n</figure>\n\n<figure id=\"figure-a\">\n</figure>\n";
        let b = "<figure id=\"figure-b\">\n</figure>\n\n<figure id=\"figure-b2\">\n</figure>\n";
        let c = "<figure id=\"figure-c\">\n</figure>\n";
        let d = "<figure id=\"table-d\" class=\"table\">\n</figure>\n";
        let pages =
            [("src/a.md", a), ("src/b.md", b), ("src/c.md", c), ("src/d.md", d), ("src/z.md", z)];
        let labels = of(&[&[(SUMMARY, summary)], &pages[..]].concat()).unwrap();
        let link = |target| labels.link("src/z.md", target).unwrap().unwrap();
        assert_eq!(link("figure:z"), "[Figure 0.1](<z.md#figure-z>)");
        assert_eq!(link("figure:a"), "[Figure 1.1](<a.md#figure-a>)");
        assert_eq!(link("table:a"), "[Table 1.1](<a.md#table-a>)");
        assert_eq!(link("figure:b2"), "[Figure 2.2](<b.md#figure-b2>)");
        assert_eq!(link("figure:c"), "[Figure 2.1.1](<c.md#figure-c>)");
        assert_eq!(link("table:d"), "[Table A.1](<d.md#table-d>)");
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
