//! Data of the tables on the pages: CSV with all digits, made from the tables themselves, so that the file behind a
//! table has the columns, the names and the rows of the table.
//!
//! Between the rendering of a template and the page, a number is in the text twice, as it is shown and with all its
//! digits: [`with_digits`].

use super::text::csv;
use regex::Regex;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Characters around a number as it is shown, and its digits. Unicode leaves them to private use.
const MARKS: [char; 3] = ['\u{E000}', '\u{E001}', '\u{E002}'];

/// A number as it is shown, and its digits.
static NUMBER: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new("\u{E000}([^\u{E001}]*)\u{E001}([^\u{E002}]*)\u{E002}")
        .expect("the pattern is tested")
});

/// A table of a page: its name, and what is between its tags.
static TABLE: LazyLock<Regex> = LazyLock::new(|| {
    let pattern = r#"(?s)<figure id="table-([A-Za-z0-9_.-]+)"[^>]*>(.*?)</figure>"#;
    Regex::new(pattern).expect("the pattern is tested")
});

/// A tag of HTML; the end of a line in a cell is one.
static TAG: LazyLock<Regex> =
    LazyLock::new(|| Regex::new("</?[a-z][^>]*>").expect("the pattern is tested"));

/// A formula in a cell.
static FORMULA: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"\$([^$]*)\$").expect("the pattern is tested"));

/// Returns a number as it is shown together with its digits.
pub(super) fn with_digits(shown: &str, digits: &str) -> String {
    let [start, middle, end] = MARKS;
    format!("{start}{shown}{middle}{digits}{end}")
}

/// Returns a text with its numbers as they are shown.
pub(super) fn as_shown(text: &str) -> String {
    NUMBER.replace_all(text, "$1").into_owned()
}

/// Returns the CSV of each table of a rendered page that links to it as `data/NAME.csv`, by the name of its file.
pub(super) fn of_tables(page: &str) -> BTreeMap<String, String> {
    let mut files = BTreeMap::new();
    for found in TABLE.captures_iter(page) {
        let (file, table) = (format!("{}.csv", &found[1]), &found[2]);
        if table.contains(&format!("\"data/{file}\"")) {
            files.insert(file, csv_of(table));
        }
    }
    files
}

/// Returns the CSV of a table in Markdown.
fn csv_of(table: &str) -> String {
    let mut lines = table.lines().filter(|line| line.starts_with('|')).map(cells);
    let heads = lines.next().unwrap_or_default();
    let mut rows: Vec<Vec<DataCell>> = Vec::new();
    // The second line has the alignments.
    for row in lines.skip(1) {
        rows.push(row.iter().map(|text| DataCell::of(text)).collect());
    }
    let mut columns: Vec<(String, Vec<String>)> = Vec::new();
    for (k, name) in names(&heads).into_iter().enumerate() {
        let of_column: Vec<DataCell> =
            rows.iter().map(|row| row.get(k).cloned().unwrap_or_default()).collect();
        let has_numbers = of_column.iter().any(|cell| !cell.number.is_empty());
        let words = of_column.iter().map(|cell| cell.words.clone()).collect();
        match has_numbers {
            false => columns.push((name, words)),
            true => {
                let has_words = of_column.iter().any(|cell| !cell.words.is_empty());
                let numbers = of_column.iter().map(|cell| cell.number.clone()).collect();
                columns.push((name.clone(), numbers));
                // A column of numbers has no words, so that programs read it as numbers.
                columns.extend(has_words.then(|| (format!("{name}, remark"), words)));
            }
        }
    }
    let head = columns.iter().map(|(name, _)| name).collect::<Vec<_>>();
    let rows = (0..rows.len()).map(|k| columns.iter().map(|(_, cells)| &cells[k]).collect());
    csv(std::iter::once(head).chain(rows))
}

/// DataCell of a table as data.
#[derive(Clone, Debug, Default)]
struct DataCell {
    /// The number with all its digits; empty if the cell has none, or more.
    number: String,
    /// Other text of the cell.
    words: String,
}

impl DataCell {
    fn of(text: &str) -> Self {
        // Below a number may stand one to compare it with.
        if let Some((number, small)) = text.split_once("<small>") {
            let cell = Self::of(number);
            let small = plain(&NUMBER.replace_all(small, "$2"));
            return match cell.number.is_empty() {
                true => Self { words: format!("{} {small}", cell.words), ..cell },
                false => Self { words: small, ..cell },
            };
        }
        let all = plain(&NUMBER.replace_all(text, "$2"));
        if all == "–" {
            return Self::default();
        }
        if all.parse::<f64>().is_ok() {
            return Self { number: all, words: String::new() };
        }
        let mut numbers = NUMBER.captures_iter(text).map(|found| found[2].to_owned());
        let rest = plain(&NUMBER.replace_all(text, ""));
        // As in "> 5000": more than signs beside a number make a sentence, which stays whole.
        if let (Some(number), None) = (numbers.next(), numbers.next())
            && !rest.contains(char::is_alphanumeric)
        {
            return Self { number, words: rest };
        }
        Self { number: String::new(), words: all }
    }
}

/// Returns the cells of a line of a table.
fn cells(line: &str) -> Vec<String> {
    let line = line.trim().trim_start_matches('|').trim_end_matches('|');
    let line = line.replace(r"\|", "\u{0}");
    line.split('|').map(|cell| cell.trim().replace('\u{0}', "|")).collect()
}

/// Returns the names of columns with these heads, each another: a head that occurs twice begins with that of its group,
/// as in "problem 1: stop | solution", or else with the last head that occurs once.
fn names(heads: &[String]) -> Vec<String> {
    let heads: Vec<String> = heads.iter().map(|head| plain(&as_shown(head))).collect();
    let (mut group, mut before) = (None, "");
    let mut names: Vec<String> = Vec::new();
    for head in &heads {
        let occurs = heads.iter().filter(|other| *other == head).count();
        if let Some((of, _)) = head.split_once(": ") {
            group = Some(of);
        }
        let name = match group {
            _ if occurs == 1 => head.clone(),
            Some(of) => format!("{of}: {head}"),
            None => format!("{before}, {head}").trim_start_matches(", ").to_owned(),
        };
        if occurs == 1 {
            before = head;
        }
        names.push(name);
    }
    names
}

/// Returns Markdown without its marks.
fn plain(markdown: &str) -> String {
    let text = TAG.replace_all(markdown, " ");
    let text = FORMULA.replace_all(&text, |found: &regex::Captures| {
        let mut latex = found[1].to_owned();
        for (from, to) in [(r"\ge", ">="), (r"\le", "<="), (r"\cdot", "·"), (r"\infty", "inf")] {
            latex = latex.replace(from, to);
        }
        latex.replace(['\\', '{', '}'], "")
    });
    let text = text.replace("&gt;", ">").replace("&lt;", "<").replace("&ge;", ">=");
    let text = text.replace("**", "").replace(['`', '\u{202f}'], "");
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    match text.strip_prefix('*').and_then(|text| text.strip_suffix('*')) {
        Some(emphasised) => emphasised.to_owned(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of a page with these lines.
    fn made(lines: &str) -> String {
        let page = format!(
            "<figure id=\"table-a\" class=\"table\">\n<a href=\"data/a.csv\">Data</a>\n\n{lines}\n</figure>\n"
        );
        of_tables(&page)["a.csv"].clone()
    }

    #[test]
    fn a_file_has_the_columns_and_rows_of_its_table_and_all_digits() {
        let third = with_digits("$0.33$", "0.3333333333333333");
        let many = with_digits("10\u{202f}000", "10000");
        let table = format!(
            "| $h$ | error of `v` | count | what |\n| ---: | ---: | ---: | --- |\n\
             | {half} | {third} | &gt; {many} | a, \\|b\\| |\n\
             | {half} | – | refused | <b>{third} to {third}</b> |\n",
            half = with_digits("$1/2$", "0.5")
        );
        expect_test::expect![[r#"
            h,error of v,count,"count, remark",what
            0.5,0.3333333333333333,10000,>,"a, |b|"
            0.5,,,refused,0.3333333333333333 to 0.3333333333333333
        "#]]
        .assert_eq(&made(&table));
        assert!(as_shown(&table).contains("| &gt; 10\u{202f}000 | a"));
    }

    #[test]
    fn a_number_below_another_is_a_remark() {
        let [ours, paper] = [with_digits("$4$", "4.3"), with_digits("$4$", "4.2")];
        let cell = format!("<span class=\"near\">{ours}<small>paper: {paper}</small></span>");
        assert_eq!(
            made(&format!("| x |\n| --- |\n| {cell} |\n")),
            "x,\"x, remark\"\n4.3,paper: 4.2\n"
        );
    }

    #[test]
    fn names_of_columns_are_those_of_the_heads_and_no_two_are_equal() {
        let heads = |line: &str| names(&cells(line));
        assert_eq!(
            heads("| $L_2$ | order | at nodes | order |"),
            ["L_2", "L_2, order", "at nodes", "at nodes, order"]
        );
        assert_eq!(
            heads("| x | problem 1: stop | solution | problem 2: stop | solution |"),
            [
                "x",
                "problem 1: stop",
                "problem 1: solution",
                "problem 2: stop",
                "problem 2: solution"
            ]
        );
        assert_eq!(heads(r"| $\Delta a^{(n)}$ | $r \ge 10$ |"), ["Delta a^(n)", "r >= 10"]);
    }

    #[test]
    fn tables_without_a_link_to_data_have_none() {
        let page = "<figure id=\"table-a\">\n\n| a |\n| --- |\n| 1 |\n</figure>\n";
        assert_eq!(of_tables(page), BTreeMap::new());
    }
}
