//! The list of contents of the page with the whole book, for paper: mdBook has one beside the pages alone.

use super::summary::ListedPage;
use regex::Regex;
use std::sync::LazyLock;

/// Page with the whole book.
pub(super) const PRINT: &str = "print.html";

/// Heading of a chapter or a section.
static HEADING: LazyLock<Regex> = LazyLock::new(|| {
    let pattern = r#"<h([12]) id="([^"]+)"><a class="header" href="[^"]*">(.*?)</a></h"#;
    Regex::new(pattern).expect("the pattern is tested")
});

/// Returns the page with the whole book, with the chapters, by the numbers of the `listed` pages, and sections before
/// its text. Browsers know no numbers of printed pages while they set a text: the list has links.
pub(super) fn with_contents(print: &str, listed: &[ListedPage]) -> String {
    let (mut list, mut numbers) = (String::new(), listed.iter().map(|page| &*page.number));
    for heading in HEADING.captures_iter(print) {
        let [level, id, title] = [1, 2, 3].map(|group| &heading[group]);
        let number = numbers.by_ref().take(usize::from(level == "1")).find(|number| *number != "0");
        let number = number.map_or(String::new(), |number| format!("{number}. "));
        let class = if level == "1" { " class=\"chapter\"" } else { "" };
        list += &format!("<p{class}><a href=\"#{id}\">{number}{title}</a></p>\n");
    }
    let list = format!("<main>\n<nav class=\"contents\" aria-label=\"Contents\">\n{list}</nav>\n");
    print.replacen("<main>", &list, 1)
}

#[cfg(test)]
mod tests {
    use super::super::summary::listed;
    use super::*;

    #[test]
    fn chapters_have_their_numbers_and_sections_none() {
        let heading = |level, id| {
            format!(
                "<h{level} id=\"{id}\"><a class=\"header\" href=\"#{id}\">T {id}</a></h{level}>\n"
            )
        };
        let headings = [(1, "a"), (2, "b"), (1, "c"), (3, "d"), (1, "e")];
        let print: String = headings.map(|(level, id)| heading(level, id)).concat();
        let listed = listed("[A](a.md)\n\n- [C](c.md)\n\n---\n\n[E](e.md)\n").unwrap();
        let print = with_contents(&format!("<main>{print}</main>"), &listed);
        let list = print.split("</nav>").next().unwrap();
        for item in [
            "<p class=\"chapter\"><a href=\"#a\">T a</a></p>",
            "<p><a href=\"#b\">T b</a></p>",
            "<p class=\"chapter\"><a href=\"#c\">1. T c</a></p>",
            "<p class=\"chapter\"><a href=\"#e\">A. T e</a></p>",
        ] {
            assert!(list.contains(item), "{list}");
        }
        assert_eq!(list.matches("<p").count(), 4);
    }
}
