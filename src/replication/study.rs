//! Studies: scenes whose members have other values of some fields, or of names in f.

use crate::replication::fields::keys::{AxisName, ChartFields};
use crate::replication::fields::member::{Member, Varying, in_words};
use crate::replication::fields::table::{Reading, Refused};
use crate::replication::numbers::{COLUMNS, Numbers, is_of_bounds};
use crate::replication::scene::repeated;
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

/// Columns of a table in Markdown and LaTeX behind those of what is varied: as many as a page has room for.
const USUAL: [&str; 4] = ["energy", "error_relative", "contact_length", "force"];

/// Column that every table in CSV has.
const REASON: &str = "reason";

/// Columns of texts, which no axis shows.
const TEXTS: [&str; 2] = ["solver", REASON];

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

    /// Returns the axes that are given, or the usual ones.
    ///
    /// # Errors
    /// [`Refused`] if there is no such column of numbers.
    pub(crate) fn axes(&self, given: Option<&ChartFields>) -> Reading<Axes> {
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
            [] => self.names.iter().any(|name| name == column) || USUAL.contains(&column),
            columns => columns.iter().any(|wanted| wanted == column),
        }
    }

    /// True if a column of the table, or an axis of the chart, needs bounds.
    pub(crate) fn needs_bounds(&self) -> bool {
        let on_axis = self.chart.iter().flat_map(|axes| &axes.columns);
        let mut shown = self.columns.iter().chain(on_axis);
        self.columns.is_empty() || shown.any(|column| is_of_bounds(of_axis(column).0))
    }

    /// Columns of what was found that the table in CSV has.
    fn tabulated(&self) -> Vec<&'static str> {
        let mut columns = self.found();
        columns.retain(|column| self.columns.is_empty() || *column == REASON || self.shows(column));
        columns
    }

    /// Columns of what was found, without those that are varied.
    pub(crate) fn found(&self) -> Vec<&'static str> {
        let mut columns = COLUMNS.to_vec();
        columns.retain(|column| !self.names.iter().any(|name| name == column));
        columns
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
            for column in self.found() {
                row.insert(column.into(), numbers.value(column));
            }
            rows.push(row);
        }
        rows
    }

    /// Returns a line for each reason for which members have no solution, for the first `most` of them.
    pub(crate) fn reasons(&self, all: &[Numbers], most: usize) -> String {
        let (mut text, mut count) = (String::new(), 0);
        for (member, numbers) in self.members.iter().zip(all) {
            let Some(reason) = numbers.reason() else { continue };
            count += 1;
            if count <= most {
                text += &format!(
                    "no solution with {}: {reason}\n",
                    in_words(&self.names, self.values(member))
                );
            }
        }
        if count > most {
            text += &format!("no solution of {} more\n", count - most);
        }
        text
    }

    /// Names of the columns of numbers.
    fn columns_of_numbers(&self) -> Vec<&str> {
        let mut columns = Vec::new();
        for name in &self.names {
            let number = |member: &Member| member.value(name)?.number();
            if self.members.iter().all(|member| number(member).is_some()) {
                columns.push(name.as_str());
            }
        }
        columns.extend(self.found().into_iter().filter(|column| !TEXTS.contains(column)));
        columns
    }
}

/// Returns the column of an axis, and true if the axis has one over its numbers.
pub(crate) fn of_axis(chosen: &str) -> (&str, bool) {
    chosen.strip_prefix("1/").map_or((chosen, false), |column| (column, true))
}
