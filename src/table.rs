//! Table of text: in columns for a terminal, in Markdown, in LaTeX, and in CSV.

pub(crate) mod rows;

pub(crate) use signorini_book::{code_in_markdown, csv, in_markdown};

use unicode_width::UnicodeWidthStr;

/// Space between columns of text.
const GAP: &str = "  ";

/// Rows of text below a head.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    /// Names of the columns; empty for a table without a head.
    pub(crate) head: Vec<String>,
    /// Rows, each with a cell per column.
    pub(crate) rows: Vec<Vec<String>>,
    /// Columns that are aligned on the left, counted from 0; all others are aligned on the right.
    pub(crate) left: Vec<usize>,
}

impl Table {
    /// Table without rows, with this head.
    pub(crate) fn new<T: Into<String>>(head: impl IntoIterator<Item = T>, left: &[usize]) -> Self {
        let head = head.into_iter().map(Into::into).collect();
        Self { head, rows: Vec::new(), left: left.into() }
    }

    /// Table with these rows and without a head.
    pub(crate) fn without_head(rows: Vec<Vec<String>>, left: &[usize]) -> Self {
        Self { head: Vec::new(), rows, left: left.into() }
    }

    /// Returns lines with columns as wide as their longest cell.
    pub(crate) fn text(&self) -> String {
        self.first_columns(&self.widths())
    }

    /// Returns the same without the last columns below the head that a page of `room` columns of text has no room for;
    /// a last line names those.
    pub(crate) fn text_within(&self, room: usize) -> String {
        let widths = self.widths();
        let (mut columns, mut taken) = (0, 0);
        for width in &widths {
            taken += width + if columns > 0 { GAP.len() } else { 0 };
            if taken > room && columns > 0 && !self.head.is_empty() {
                break;
            }
            columns += 1;
        }
        let mut text = self.first_columns(&widths[..columns]);
        if let Some(first @ [_, ..]) = self.head.get(columns..) {
            text += &format!("no room for: {}\n", first.join(", "));
        }
        text
    }

    /// Widths of the columns.
    fn widths(&self) -> Vec<usize> {
        let mut widths: Vec<usize> = Vec::new();
        for line in self.lines() {
            widths.resize(widths.len().max(line.len()), 0);
            for (width, cell) in widths.iter_mut().zip(line) {
                *width = (*width).max(cell.width());
            }
        }
        widths
    }

    /// Returns lines with the first columns, which have these widths.
    fn first_columns(&self, widths: &[usize]) -> String {
        let mut text = String::new();
        for line in self.lines() {
            let mut padded = Vec::new();
            for (k, (cell, &width)) in line.iter().zip(widths).enumerate() {
                // A format would count characters, of which some are two columns wide, and some have none.
                let space = " ".repeat(width - cell.width());
                padded.push(match self.left.contains(&k) {
                    true => format!("{cell}{space}"),
                    false => format!("{space}{cell}"),
                });
            }
            text += padded.join(GAP).trim_end();
            text.push('\n');
        }
        text
    }

    /// Returns the table in Markdown, each cell as `shown`: by [`in_markdown`], unless it is Markdown already.
    pub(crate) fn markdown(&self, shown: impl Fn(&str) -> String) -> String {
        let mut text = line_in_markdown(&self.head, &shown) + "|";
        for k in 0..self.head.len() {
            text += if self.left.contains(&k) { "---|" } else { "---:|" };
        }
        text.push('\n');
        for row in &self.rows {
            text += &line_in_markdown(row, &shown);
        }
        text
    }

    /// Returns the table in LaTeX, as a `tabular` with the rules of the package booktabs.
    pub(crate) fn tex(&self) -> String {
        let columns = (0..self.head.len()).map(|k| if self.left.contains(&k) { 'l' } else { 'r' });
        let mut text = format!(
            "% Needs \\usepackage{{booktabs}}.\n\\begin{{tabular}}{{@{{}}{}@{{}}}}\n\\toprule\n",
            { columns.collect::<String>() }
        );
        let head = self.head.iter().map(|name| in_tex(name));
        text += &(head.collect::<Vec<_>>().join(" & ") + " \\\\\n\\midrule\n");
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|cell| in_tex(cell)).collect();
            text += &(cells.join(" & ") + " \\\\\n");
        }
        text + "\\bottomrule\n\\end{tabular}\n"
    }

    /// Returns the columns that are wanted and have a cell with a text.
    pub(crate) fn with_columns(&self, is_wanted: impl Fn(&str) -> bool) -> Self {
        let mut kept: Vec<usize> = (0..self.head.len()).collect();
        kept.retain(|&k| {
            is_wanted(&self.head[k]) && self.rows.iter().any(|row| !row[k].is_empty())
        });
        self.of(&kept)
    }

    /// Returns the table with its columns in the order of these names, behind those without.
    pub(crate) fn in_order(&self, names: &[String]) -> Self {
        let mut order: Vec<usize> = (0..self.head.len()).collect();
        order.sort_by_key(|&k| names.iter().position(|name| *name == self.head[k]));
        self.of(&order)
    }

    /// Table of these columns, in this order.
    fn of(&self, kept: &[usize]) -> Self {
        let left = kept.iter().enumerate().filter(|(_, k)| self.left.contains(k));
        Self {
            head: cells(&self.head, kept),
            rows: self.rows.iter().map(|row| cells(row, kept)).collect(),
            left: left.map(|(place, _)| place).collect(),
        }
    }

    /// Returns the table in CSV with a header line.
    pub(crate) fn csv(&self) -> String {
        csv(self.lines())
    }

    /// Iterates over the head, if there is one, and the rows.
    fn lines(&self) -> impl Iterator<Item = &Vec<String>> {
        Some(&self.head).filter(|head| !head.is_empty()).into_iter().chain(&self.rows)
    }
}

/// Returns a line of a table in Markdown, each cell as `shown`.
fn line_in_markdown(cells: &[String], shown: impl Fn(&str) -> String) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| shown(cell)).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// Returns some cells of a line.
fn cells(line: &[String], columns: &[usize]) -> Vec<String> {
    columns.iter().map(|&k| line[k].clone()).collect()
}

/// Returns a cell in LaTeX: a number in its mathematics, a text with its signs escaped.
fn in_tex(cell: &str) -> String {
    let is_number = cell.parse::<f64>().is_ok_and(f64::is_finite);
    match cell.split_once('e') {
        Some((digits, exponent)) if is_number => {
            let exponent = exponent.trim_start_matches('+');
            format!("${digits} \\cdot 10^{{{exponent}}}$")
        }
        _ if is_number => format!("${cell}$"),
        _ => cell.chars().map(letter_in_tex).collect(),
    }
}

/// Returns a character of a text in LaTeX.
fn letter_in_tex(c: char) -> String {
    match c {
        '&' | '%' | '$' | '#' | '_' | '{' | '}' => format!("\\{c}"),
        '\\' => "\\textbackslash{}".into(),
        '~' => "$\\sim$".into(),
        '^' => "\\textasciicircum{}".into(),
        '<' | '>' | '|' => format!("${c}$"),
        'Δ' => "$\\Delta$".into(),
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_counted_as_a_terminal_shows_them() {
        let names = ["ab", "鍋", "e\u{301}t", "ひび割れ"];
        let rows = names.map(|name| vec![name.to_owned(), "1".to_owned()]).to_vec();
        for line in Table::without_head(rows, &[0]).text().lines() {
            assert_eq!(line.width(), 8 + 2 + 1, "{line}");
        }
        let rows = vec![vec!["鍋".into()], vec!["abc".into()]];
        assert_eq!(Table::without_head(rows, &[]).text(), " 鍋\nabc\n");
    }

    #[test]
    fn last_columns_without_room_are_named_and_no_cell_is_broken() {
        let mut table = Table::new(["grid", "energy", "KKT residual"], &[]);
        table.rows = vec![vec!["1/4".into(), "-0.17".into(), "1e-14".into()]];
        assert_eq!(table.text_within(26), table.text());
        assert_eq!(
            table.text_within(25),
            "grid  energy\n 1/4   -0.17\nno room for: KKT residual\n"
        );
        assert_eq!(table.text_within(11), "grid\n 1/4\nno room for: energy, KKT residual\n");
        assert!(table.text_within(1).starts_with("grid\n 1/4\n"));
        let headless = Table::without_head(vec![vec!["a".into(), "b".into()]], &[]);
        assert_eq!(headless.text_within(1), headless.text());
    }

    #[test]
    fn one_table_is_text_markdown_latex_and_csv() {
        let mut table = Table::new(["f", "n"], &[0]);
        table.rows = vec![vec!["a,b".into(), "10".into()], vec!["c".into(), "2".into()]];
        assert_eq!(table.text(), "f     n\na,b  10\nc     2\n");
        assert_eq!(table.markdown(in_markdown), "| f | n |\n|---|---:|\n| a,b | 10 |\n| c | 2 |\n");
        assert_eq!(table.csv(), "f,n\n\"a,b\",10\nc,2\n");
        let mut table = Table::new(["f", "v least"], &[0]);
        table.rows = vec![vec!["50 %".into(), "-1.5e-7".into()], vec!["a~b".into(), "0.5".into()]];
        expect_test::expect![[r"
            % Needs \usepackage{booktabs}.
            \begin{tabular}{@{}lr@{}}
            \toprule
            f & v least \\
            \midrule
            50 \% & $-1.5 \cdot 10^{-7}$ \\
            a$\sim$b & $0.5$ \\
            \bottomrule
            \end{tabular}
        "]]
        .assert_eq(&table.tex());
        table.rows[0][0].clear();
        table.rows[1][0].clear();
        assert_eq!(table.with_columns(|name| name != "g").csv(), "v least\n-1.5e-7\n0.5\n");
    }
}
