//! The tables of the pages as CSV, each linked where it is shown.

use crate::figures::table::quoted;
use std::collections::BTreeMap;

/// What a page says before a table whose numbers do not come from the run: `<!-- made by: COMMAND -->`.
const MADE_BY: &str = "<!-- made by: ";
/// What makes the numbers of all other tables.
const RUN: &str = "signorini run";

/// A page with a line below each of its tables that leads to the data, and the data: files of the folder
/// `data`, by name.
///
/// `page` is Markdown; `name` is that of its file, without ending. Numbers keep the digits of the page.
pub fn with_data(name: &str, page: &str) -> (String, BTreeMap<String, Vec<u8>>) {
    let (mut out, mut files) = (String::new(), BTreeMap::new());
    let (mut command, mut fenced) = (RUN, false);
    let mut lines = page.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with("```") {
            fenced = !fenced;
        }
        if let Some(text) = line.strip_prefix(MADE_BY).filter(|_| !fenced) {
            command = text.trim_end_matches("-->").trim();
            continue;
        }
        out += line;
        out.push('\n');
        let header = !fenced && line.starts_with('|');
        if !(header && lines.peek().is_some_and(|next| is_rule(next))) {
            continue;
        }
        let mut csv = row(line);
        out += lines.next().unwrap_or_default();
        out.push('\n');
        while let Some(line) = lines.next_if(|line| line.starts_with('|')) {
            csv += &row(line);
            out += line;
            out.push('\n');
        }
        let file = format!("{name}-{}.csv", files.len() + 1);
        out += &format!(
            "\n<p class=\"data\"><a href=\"data/{file}\">Data</a> | made by <code>{command}</code></p>\n\n"
        );
        files.insert(file, csv.into_bytes());
    }
    (out, files)
}

/// Whether a line parts the head of a table from its rows.
fn is_rule(line: &str) -> bool {
    line.starts_with('|') && line.contains('-') && line.chars().all(|c| " :-|".contains(c))
}

/// A row of a table as a line of CSV.
fn row(line: &str) -> String {
    // An escaped bar is part of a cell.
    let line = line.trim().trim_start_matches('|').replace(r"\|", "\u{1}");
    let line = line.trim_end().strip_suffix('|').map_or(line.as_str(), |rest| rest);
    let cells = line.split('|').map(|cell| quoted(&plain(&cell.replace('\u{1}', "|"))));
    cells.collect::<Vec<_>>().join(",") + "\n"
}

/// A cell without mark-up.
fn plain(cell: &str) -> String {
    let mut text = String::new();
    for (k, part) in cell.split('$').enumerate() {
        if k % 2 == 1 {
            text += &number(part);
        } else {
            text += part;
        }
    }
    let text = text.replace("<small>", " (").replace("</small>", ")");
    let text = without_links(&without_tags(&text));
    let text = text.replace(['`', '\u{202f}'], "").replace("**", "");
    let text = text.replace("&gt;", ">").replace("&ge;", ">=").replace("&lt;", "<");
    match text.trim() {
        "\u{2013}" => String::new(),
        text => text.into(),
    }
}

/// A formula as text; a number with a power of ten as programs read it.
fn number(latex: &str) -> String {
    let text = latex.replace(r" \cdot 10^{", "e").replace("10^{", "1e");
    // The brace that such a power opened.
    let text = match text.find('e').filter(|_| text != latex) {
        Some(_) => text.replacen('}', "", 1),
        None => text,
    };
    text.replace(r"\infty", "inf").replace(r"\,", "").trim().into()
}

fn without_tags(text: &str) -> String {
    let mut out = String::new();
    for (k, part) in text.split('<').enumerate() {
        let tag = k > 0 && part.starts_with(|c: char| c.is_ascii_alphabetic() || c == '/');
        match part.split_once('>').filter(|_| tag) {
            Some((_, rest)) => out += rest,
            None if k > 0 => {
                out.push('<');
                out += part;
            }
            None => out += part,
        }
    }
    out
}

/// `[text](target)` as text.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("](") {
        let Some((_, tail)) = after.split_once(')') else { break };
        let (head, name) = before.rsplit_once('[').unwrap_or((before, ""));
        out += head;
        out += name;
        rest = tail;
    }
    out + rest
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
    fn the_command_is_that_of_the_page() {
        let page = "<!-- made by: signorini bench --record -->\n| a |\n| --- |\n| b |\n";
        let (text, _) = with_data("p", page);
        assert!(text.contains("<code>signorini bench --record</code>") && !text.contains("<!--"));
    }

    #[test]
    fn cells_lose_their_mark_up() {
        for (cell, text) in [
            (r" $1.6 \cdot 10^{-4}$ ", "1.6e-4"),
            (" `disc(0,0)` ", "disc(0,0)"),
            (" [results](results.csv), **all** ", "results, all"),
            (" 4\u{202f}225 ", "4225"),
            (" \u{2013} ", ""),
            (" &gt; 100 ", "> 100"),
            (r" $\max \lvert x\rvert$ ", r"\max \lvert x\rvert"),
            (" $h = 1/64$ ", "h = 1/64"),
        ] {
            assert_eq!(plain(cell), text);
        }
        assert_eq!(row(r"| `a \| b` | 1, 2 |"), "a | b,\"1, 2\"\n");
    }
}
