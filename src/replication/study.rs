//! Studies: scenes whose members have other values of some fields, or of names in f.

use crate::replication::columns::{COLUMNS, END, STOP, beside};
use crate::replication::fields::lists::repeated;
use crate::replication::fields::member::{Member, Varying, in_words};
use crate::replication::fields::table::{Field, Reading, Refused, field};
use crate::replication::numbers::Numbers;
use crate::table::Table;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Members of a study, and the axes of its chart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// Names of what is varied, in the order of the columns.
    pub(crate) names: Vec<String>,
    /// In the order of the rows.
    pub(crate) members: Vec<Member>,
    /// Axes of the chart; none if there is no chart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) chart: Option<Axes>,
    /// Columns of the table that are wanted; empty for all in CSV, and in Markdown and LaTeX for what is varied and the
    /// [`USUAL`] ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) columns: Vec<String>,
}

/// Axes of a chart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Axes {
    /// Columns across and up; `1/` before a column is for one over its numbers.
    pub(crate) columns: [String; 2],
    /// True for a logarithmic axis.
    pub(crate) log: [bool; 2],
}

/// Axes of a chart as a scene gives them.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { x = \"friction\", y = \"force\", log = [\"x\"] }")]
pub(crate) struct ChartFields {
    /// Column across; none for the first that is varied.
    pub(crate) x: Option<String>,
    /// Column up; none for the energy.
    pub(crate) y: Option<String>,
    /// Axes that are logarithmic.
    #[serde(default)]
    pub(crate) log: Vec<AxisName>,
}

/// Name of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum AxisName {
    X,
    Y,
}

/// Columns of a table in Markdown and LaTeX behind those of what is varied: as many as a page has room for.
const USUAL: [&str; 4] = ["energy", "error_relative", "contact_length", "force"];

/// Columns that every table in CSV has.
const ALWAYS: [&str; 2] = [WARNINGS, "reason"];
/// Column with sentences in CSV and JSON, and their number in other tables.
pub(crate) const WARNINGS: &str = "warnings";

/// Columns of texts, which no axis shows.
const TEXTS: [&str; 8] =
    ["iterations_per_grid", STOP, END, "solver", "reserve", WARNINGS, "remedy", "reason"];

impl Study {
    /// Study of these members, which vary these names.
    pub(crate) fn of(names: &[String], members: Vec<Member>) -> Self {
        Self { names: names.to_vec(), members, chart: None, columns: Vec::new() }
    }

    /// Values of what varies in a member, in the order of the names.
    pub(crate) fn values<'a>(&'a self, member: &'a Member) -> impl Iterator<Item = Varying> + 'a {
        let value = |name: &String| member.value(name).expect("checked: a member has what varies");
        self.names.iter().map(value)
    }

    /// Different values of what varies, each list with its name, in the order of the members.
    pub(crate) fn lists(&self) -> Vec<(String, Vec<Varying>)> {
        let mut lists: Vec<_> = self.names.iter().map(|name| (name.clone(), Vec::new())).collect();
        for member in &self.members {
            for ((_, list), value) in lists.iter_mut().zip(self.values(member)) {
                if !list.contains(&value) {
                    list.push(value);
                }
            }
        }
        lists
    }

    /// Returns the axes that are given, or the usual ones: where the fineness varies, the error against the nodes.
    ///
    /// # Errors
    /// [`Refused`] if there is no such column of numbers.
    pub(crate) fn axes(&self, given: Option<&ChartFields>) -> Reading<Axes> {
        let mut fields = self.names.iter().filter_map(|name| field(name));
        if given.is_none() && fields.any(Field::is_about_fineness) {
            let columns = ["nodes", "error_relative"].map(str::to_owned);
            return Ok(Axes { columns, log: [true; 2] });
        }
        let (mut x, mut y) = (None, None);
        let mut log = [false; 2];
        if let Some(given) = given {
            (x, y) = (given.x.clone(), given.y.clone());
            log = [AxisName::X, AxisName::Y].map(|axis| given.log.contains(&axis));
        }
        let columns: Vec<&str> = self.columns_of_numbers();
        let first = columns.first().copied().unwrap_or_default();
        let chosen = [x.unwrap_or_else(|| first.into()), y.unwrap_or_else(|| "energy".into())];
        if let Some(unknown) = chosen.iter().find(|one| !columns.contains(&of_axis(one).0)) {
            let known = columns.join(", ");
            let text = format!("`chart`: no column of numbers `{unknown}`; choose from {known}");
            return Err(Refused::new("chart", text));
        }
        Ok(Axes { columns: chosen, log })
    }

    /// Returns the columns that are given for a table on a page, in their order there.
    ///
    /// # Errors
    /// [`Refused`] if there is no such column, or one is there twice.
    pub(crate) fn columns(&self, given: Option<&[String]>) -> Reading<Vec<String>> {
        let known: Vec<&str> = self.names.iter().map(String::as_str).chain(self.found()).collect();
        let given = given.unwrap_or_default();
        if let Some(column) = repeated(given) {
            let text = format!("`columns`: `{column}` is there twice; remove one");
            return Err(Refused::new("columns", text));
        }
        match given.iter().find(|column| !known.contains(&column.as_str())) {
            None => Ok(given.to_vec()),
            Some(unknown) => {
                let known = known.join(", ");
                let text = format!("`columns`: no column `{unknown}`; choose from {known}");
                Err(Refused::new("columns", text))
            }
        }
    }

    /// True if the table in Markdown and LaTeX has this column.
    pub(crate) fn shows(&self, column: &str) -> bool {
        match &self.columns[..] {
            [] => self.varies(column) || USUAL.contains(&column),
            columns => columns.iter().any(|wanted| wanted == column),
        }
    }

    /// Columns of what was found that the table in CSV has.
    fn tabulated(&self) -> Vec<&'static str> {
        let mut columns = self.found();
        columns.retain(|column| {
            self.columns.is_empty()
                || ALWAYS.contains(column)
                || self.shows(column)
                || self.columns.iter().any(|shown| beside(shown).contains(column))
        });
        columns
    }

    /// Columns of what was found, without those that are varied: where the stopping rule is, the column of the end has
    /// another name.
    pub(crate) fn found(&self) -> Vec<&'static str> {
        let mut columns = COLUMNS.to_vec();
        if self.varies(STOP) {
            columns.iter_mut().filter(|column| **column == STOP).for_each(|column| *column = END);
        }
        columns.retain(|column| !self.varies(column));
        columns
    }

    fn varies(&self, column: &str) -> bool {
        self.names.iter().any(|name| name == column)
    }

    /// Returns the table of the members with their numbers, with all digits: what was varied, then what was found, of
    /// which the columns may be given.
    pub(crate) fn table(&self, all: &[Numbers]) -> Table {
        let found = self.tabulated();
        let head: Vec<String> =
            self.names.iter().cloned().chain(found.iter().map(|&name| name.to_owned())).collect();
        let mut left: Vec<usize> = (0..head.len()).collect();
        left.retain(|&k| TEXTS.contains(&head[k].as_str()));
        let mut table = Table::new(head, &left);
        for (member, numbers) in self.members.iter().zip(all) {
            let values = self.values(member).map(|value| value.to_string());
            table.rows.push(values.chain(numbers.cells(&found)).collect());
        }
        table
    }

    /// Returns the members with their numbers as rows of JSON.
    pub(crate) fn rows(&self, all: &[Numbers]) -> Vec<Map<String, Value>> {
        let mut rows = Vec::new();
        for (member, numbers) in self.members.iter().zip(all) {
            let mut row = Map::new();
            for (name, value) in self.names.iter().zip(self.values(member)) {
                row.insert(name.clone(), value.json());
            }
            let found = numbers.values(&self.found());
            row.extend(found.into_iter().map(|(column, value)| (column.to_owned(), value)));
            rows.push(row);
        }
        rows
    }

    /// Columns that mark members in a table for people: the number of warnings if there are any, and the end of the
    /// solver if one has ended without a solution.
    pub(crate) fn marks(&self, all: &[Numbers]) -> Vec<&'static str> {
        let mut marks = Vec::new();
        let end = if self.varies(STOP) { END } else { STOP };
        marks.extend(all.iter().any(Numbers::is_no_solution).then_some(end));
        marks.extend(all.iter().any(|of| !of.warnings.is_empty()).then_some(WARNINGS));
        marks
    }

    /// Returns the columns of a table of members for a page, from the table with few digits: those that are shown, or
    /// else what is varied, and marks.
    pub(crate) fn page(&self, table: &Table, all: &[Numbers]) -> Table {
        let marks = self.marks(all);
        let order =
            [self.columns.clone(), marks.iter().map(ToString::to_string).collect()].concat();
        let page = table.with_columns(|column| self.shows(column) || marks.contains(&column));
        match page.head.is_empty() {
            true => table.with_columns(|column| self.varies(column)),
            false => page.in_order(&order),
        }
    }

    /// Returns a table with the number of warnings in place of their sentences.
    pub(crate) fn counted(table: &Table, all: &[Numbers]) -> Table {
        let mut table = table.clone();
        if let Some(place) = table.head.iter().position(|column| column == WARNINGS) {
            for (row, numbers) in table.rows.iter_mut().zip(all) {
                row[place] = count_of(numbers);
            }
        }
        table
    }

    /// Returns the reasons for which members have no solution, and all warnings, each once with the members, in a line
    /// each, for the first `most` of both.
    pub(crate) fn remarks<'a>(
        &self,
        found: impl IntoIterator<Item = (&'a Member, &'a Numbers)>,
        most: usize,
    ) -> Vec<String> {
        let (mut reasons, mut warnings) = (Vec::new(), Vec::new());
        for (member, numbers) in found {
            let whom = in_words(&self.names, self.values(member));
            // The remedy is that of the failure, which has it already.
            let remedy = numbers.remedy.as_ref().filter(|_| numbers.reason.is_none());
            if !numbers.warnings.is_empty() {
                let sentences = numbers.warnings.iter().chain(remedy);
                add(&mut warnings, sentences.cloned().collect::<Vec<_>>().join("; "), &whom);
            }
            numbers.reason.iter().for_each(|reason| add(&mut reasons, reason.clone(), &whom));
        }
        let mut lines = Vec::new();
        for (remarks, what) in [(reasons, "no solution"), (warnings, "warning")] {
            for Remark { sentence, first, members } in remarks.iter().take(most) {
                let with = if first.is_empty() { "" } else { " with " };
                let more = match members {
                    1 => String::new(),
                    count => format!(" ({count} members)"),
                };
                lines.push(format!("{what}{with}{first}{more}: {sentence}"));
            }
            if remarks.len() > most {
                lines.push(format!("{what}, further reasons: {}", remarks.len() - most));
            }
        }
        lines
    }

    /// Names of the columns of numbers.
    fn columns_of_numbers(&self) -> Vec<&str> {
        let mut columns = Vec::new();
        for name in &self.names {
            if self
                .members
                .iter()
                .all(|member| member.value(name).is_some_and(|v| v.number().is_some()))
            {
                columns.push(name.as_str());
            }
        }
        columns.extend(self.found().into_iter().filter(|column| !TEXTS.contains(column)));
        columns
    }
}

/// Sentence on members of a study.
struct Remark {
    sentence: String,
    /// Values of the first member.
    first: String,
    /// Number of the members.
    members: usize,
}

/// Adds a sentence on a member to those on others.
fn add(remarks: &mut Vec<Remark>, sentence: String, whom: &str) {
    match remarks.iter_mut().find(|known| known.sentence == sentence) {
        Some(known) => known.members += 1,
        None => remarks.push(Remark { sentence, first: whom.to_owned(), members: 1 }),
    }
}

/// Number of warnings as a table has it; empty without.
pub(crate) fn count_of(numbers: &Numbers) -> String {
    match numbers.warnings.len() {
        0 => String::new(),
        count => count.to_string(),
    }
}

/// Returns the column of an axis, and true if the axis has one over its numbers.
pub(crate) fn of_axis(chosen: &str) -> (&str, bool) {
    chosen.strip_prefix("1/").map_or((chosen, false), |column| (column, true))
}
