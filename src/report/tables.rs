//! The tables of the pages as CSV, each linked where it is shown.

use super::mathml::parse;
use crate::figures::table::quoted;
use pulldown_cmark::{Event, Tag, TagEnd};
use std::collections::BTreeMap;

/// What a page says before a table whose numbers do not come from the run: `<!-- made by: COMMAND -->`.
const MADE_BY: &str = "<!-- made by: ";
/// What makes the numbers of all other tables.
const RUN: &str = "signorini run";

/// A page with a line below each of its tables that leads to the data, and the data: files of the folder
/// `data`, by name.
///
/// `page` is Markdown; `name` is that of its file, by its path among the pages and without ending. Numbers keep the
/// digits of the page.
pub(crate) fn with_data(name: &str, page: &str) -> (String, BTreeMap<String, Vec<u8>>) {
    let (mut out, mut files) = (String::new(), BTreeMap::new());
    let up = "../".repeat(name.matches('/').count());
    let (mut command, mut done) = (RUN.to_owned(), 0);
    let (mut csv, mut row, mut cell) = (String::new(), Vec::new(), String::new());
    for (event, range) in parse(page) {
        match event {
            Event::Html(text) if text.starts_with(MADE_BY) => {
                command = text[MADE_BY.len()..].trim().trim_end_matches("-->").trim().to_owned();
                out += &page[done..range.start];
                done = range.end;
            }
            Event::Start(Tag::TableCell) => cell.clear(),
            Event::Text(text) | Event::Code(text) => cell += &text,
            Event::InlineMath(latex) => cell += &number(&latex),
            Event::InlineHtml(tag) if &*tag == "<small>" => cell += " (",
            Event::InlineHtml(tag) if &*tag == "</small>" => cell.push(')'),
            Event::InlineHtml(tag) if &*tag == "<br>" => cell += "; ",
            // The link to an equation has no text of its own: its number comes later.
            Event::Start(Tag::Link { dest_url, .. }) if dest_url.starts_with("eq:") => {
                cell += &format!("({})", &dest_url["eq:".len()..]);
            }
            Event::End(TagEnd::TableCell) => {
                // Narrow spaces part digits, and a dash stands for no number.
                let text = cell.replace('\u{202f}', "").replace('\u{2265}', ">=");
                let text = text.trim();
                row.push(if text == "\u{2013}" { String::new() } else { text.to_owned() });
            }
            Event::End(end @ (TagEnd::TableHead | TagEnd::TableRow)) => {
                if end == TagEnd::TableHead {
                    number_repeated(&mut row);
                }
                let cells: Vec<_> = row.drain(..).map(|cell| quoted(&cell)).collect();
                csv += &(cells.join(",") + "\n");
            }
            Event::End(TagEnd::Table) => {
                let file = format!("{name}-{}.csv", files.len() + 1);
                out += page[done..range.end].trim_end();
                out += &format!(
                    "\n\n<p class=\"data\"><a href=\"{up}data/{file}\">Data</a> | made by <code>{command}</code></p>\n\n"
                );
                done = range.end;
                files.insert(file, std::mem::take(&mut csv).into_bytes());
            }
            _ => {}
        }
    }
    (out + &page[done..], files)
}

/// A formula as text; a number with a power of ten as programs read it.
fn number(latex: &str) -> String {
    let text = latex.replace(r" \cdot 10^{", "e").replace("10^{", "1e");
    // The brace that such a power opened.
    let text = match text.find('e').filter(|_| text != latex) {
        Some(_) => text.replacen('}', "", 1),
        None => text,
    };
    let signs =
        [(r"\infty", "inf"), (r"\,", ""), (r"\ge", ">="), (r"\lvert", "|"), (r"\rvert", "|")];
    let marks = [("^{(n)}", ""), (r"\tilde ", ""), ("\\", "")];
    let plain = |text: String, (from, to): (&str, &str)| text.replace(from, to);
    signs.into_iter().chain(marks).fold(text, plain).trim().into()
}

/// Names of columns are told apart by numbers, as the readers of CSV ask for.
fn number_repeated(names: &mut [String]) {
    for k in (1..names.len()).rev() {
        let before = names[..k].iter().filter(|name| **name == names[k]).count();
        if before > 0 {
            names[k] += &format!(" {}", before + 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_becomes_a_file_and_a_link() {
        let page = "# P\n\n| $r$ | count |\n| ---: | ---: |\n| $10^{6}$ | <span class=\"far\">12<small>13</small></span> |\n\ntext\n";
        let (text, files) = with_data("p", page);
        assert!(text.contains("| count |\n| ---: | ---: |\n"), "{text}");
        assert!(
            text.contains("<a href=\"data/p-1.csv\">Data</a> | made by <code>signorini run</code>")
        );
        assert!(text.ends_with("\n\ntext\n"));
        assert_eq!(files["p-1.csv"], b"r,count\n1e6,12 (13)\n");
        assert_eq!(with_data("p", "```text\n| a |\n| - |\n```\n").1.len(), 0);
    }

    #[test]
    fn a_page_in_a_folder_leads_out_of_it() {
        let (text, files) = with_data("sub/p", "| a |\n| --- |\n| b |\n");
        assert!(text.contains("<a href=\"../data/sub/p-1.csv\">Data</a>"), "{text}");
        assert!(files.contains_key("sub/p-1.csv"));
    }

    #[test]
    fn the_command_is_that_of_the_page() {
        let page = "<!-- made by: signorini bench --record -->\n| a |\n| --- |\n| b |\n";
        let (text, _) = with_data("p", page);
        assert!(text.contains("<code>signorini bench --record</code>") && !text.contains("<!--"));
    }

    #[test]
    fn columns_have_names_of_their_own() {
        let (_, files) = with_data("p", "| h | order | v | order |\n| --- | --- | --- | --- |\n");
        assert_eq!(files["p-1.csv"], b"h,order,v,order 2\n");
    }

    #[test]
    fn cells_lose_their_mark_up() {
        for (cell, text) in [
            (r" $1.6 \cdot 10^{-4}$ ", "1.6e-4"),
            (" `disc(0,0)` ", "\"disc(0,0)\""),
            (" [results](results.csv) and **all** ", "results and all"),
            (" 4\u{202f}225 ", "4225"),
            (" \u{2013} ", ""),
            (" &gt; 100 ", "> 100"),
            (r" $\max \lvert \Delta a^{(n)} \rvert$ ", "max | Delta a |"),
            (" with [](eq:13)<br>and ", "with (13); and"),
            (" $h = 1/64$ ", "h = 1/64"),
            (r" `a \| b` ", "a | b"),
        ] {
            let (_, files) = with_data("p", &format!("word\n\n| a |\n| --- |\n|{cell}|\n"));
            assert_eq!(files["p-1.csv"], format!("a\n{text}\n").into_bytes());
        }
    }
}
