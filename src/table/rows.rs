//! Tables of findings: rows of plain values under the names of columns.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::ops::Deref;

/// Row of a table: a value under the name of each column.
pub(crate) type Row = Map<String, Value>;

/// Rows of a table: a text, a number, a flag or nothing under the name of each column; a list only where one cell of a
/// page, or a picture, shows it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Rows(pub Vec<Row>);

impl Deref for Rows {
    type Target = [Row];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl Rows {
    /// Values of a column, in the order of the rows.
    ///
    /// # Errors
    /// A sentence with the names of the columns if no row has this one.
    pub fn column(&self, name: &str) -> Result<Vec<&Value>, String> {
        let values: Vec<_> = self.iter().filter_map(|row| row.get(name)).collect();
        match self.first() {
            Some(row) if values.is_empty() => {
                let names: Vec<_> = row.keys().map(String::as_str).collect();
                Err(format!("no column `{name}`; there are {}", names.join(", ")))
            }
            _ => Ok(values),
        }
    }

    /// Rows with this value in a column.
    ///
    /// # Errors
    /// As [`Rows::column`].
    pub fn wherever(&self, name: &str, value: impl Into<Value>) -> Result<Self, String> {
        self.column(name)?;
        let value = value.into();
        Ok(Self(self.iter().filter(|row| row.get(name) == Some(&value)).cloned().collect()))
    }

    /// Rows with a number in a column that is between two others.
    pub(crate) fn within(&self, name: &str, least: f64, greatest: f64) -> Self {
        let is_within = |row: &&Row| (least..=greatest).contains(&number(row, name));
        Self(self.iter().filter(is_within).cloned().collect())
    }

    /// Numbers of a column, of the rows that have one there.
    ///
    /// # Errors
    /// As [`Rows::column`].
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, String> {
        Ok(self.column(name)?.into_iter().filter_map(Value::as_f64).collect())
    }

    /// Texts of a column, each once.
    ///
    /// # Errors
    /// As [`Rows::column`].
    pub fn texts(&self, name: &str) -> Result<Vec<&str>, String> {
        let mut texts = Vec::new();
        for text in self.column(name)?.into_iter().filter_map(Value::as_str) {
            if !texts.contains(&text) {
                texts.push(text);
            }
        }
        Ok(texts)
    }

    /// Numbers of two columns, of the rows that have one in both.
    ///
    /// # Errors
    /// As [`Rows::column`].
    pub fn points(&self, x: &str, y: &str) -> Result<Vec<(f64, f64)>, String> {
        self.column(x)?;
        self.column(y)?;
        let points = self.iter().map(|row| Some((row.get(x)?.as_f64()?, row.get(y)?.as_f64()?)));
        Ok(points.flatten().collect())
    }
}

/// Number in a column of a row; NaN if it has none.
pub(crate) fn number(row: &Row, name: &str) -> f64 {
    row.get(name).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rows_are_asked_by_names_that_are_there() {
        let rows = json!([
            { "of": "a", "x": 1, "y": 0.5 },
            { "of": "b", "x": 2, "y": null },
            { "of": "a", "x": 3, "y": 2.0 },
        ]);
        let rows: Rows = serde_json::from_value(rows).unwrap();
        assert_eq!(rows.texts("of").unwrap(), ["a", "b"]);
        assert_eq!(rows.points("x", "y").unwrap(), [(1.0, 0.5), (3.0, 2.0)]);
        assert_eq!(rows.wherever("of", "a").unwrap().numbers("x").unwrap(), [1.0, 3.0]);
        assert!(rows.wherever("x", 2).unwrap().numbers("y").unwrap().is_empty());
        assert_eq!(rows.numbers("z").unwrap_err(), "no column `z`; there are of, x, y");
        assert_eq!(Rows::default().numbers("z"), Ok(Vec::new()));
    }
}
