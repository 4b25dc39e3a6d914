//! Data of the tables on the pages: CSV with all digits, made from the values that a template shows.

use crate::table::quoted;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use tera::{Kwargs, State, Tera, TeraResult};

/// Characters that must be escaped in a link.
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// CSV files for which the templates asked, by name.
#[derive(Clone, Debug, Default)]
pub(super) struct Data(Arc<Mutex<BTreeMap<String, String>>>);

impl Data {
    /// Registers the filter `data`: `{{ ROWS | data(name="NAME") }}` makes `data/NAME.csv` of the rows, objects
    /// with equal fields, and returns the path of the file in the book.
    ///
    /// `keys=["a", "b"]` keeps only these fields.
    pub(super) fn register(&self, tera: &mut Tera) {
        let data = self.clone();
        tera.register_filter("data", move |rows: tera::Value, kwargs: Kwargs, _: &State| {
            data.add(&rows, &kwargs)
        });
    }

    fn add(&self, rows: &tera::Value, kwargs: &Kwargs) -> TeraResult<String> {
        let name = kwargs.must_get::<String>("name")?.replace(' ', "-");
        let mut rows = serde_json::to_value(rows).map_err(tera::Error::message)?;
        if let Some(keys) = kwargs.get::<Vec<String>>("keys")? {
            keep(&mut rows, &keys);
        }
        let csv = csv(&rows);
        let mut files = self.0.lock().expect("no panic while it is held");
        if files.get(&name).is_some_and(|there| *there != csv) {
            return Err(tera::Error::message(format!("two different data are named `{name}`")));
        }
        files.insert(name.clone(), csv);
        Ok(format!("data/{}.csv", utf8_percent_encode(&name, RESERVED)))
    }

    /// Returns the files so far, by their names with ending.
    pub(super) fn files(&self) -> BTreeMap<String, String> {
        let files = self.0.lock().expect("no panic while it is held");
        files.iter().map(|(name, csv)| (format!("{name}.csv"), csv.clone())).collect()
    }
}

/// Removes all fields but `keys` from an object, or from each of a list.
fn keep(value: &mut Value, keys: &[String]) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| keep(item, keys)),
        Value::Object(fields) => fields.retain(|key, _| keys.contains(key)),
        _ => {}
    }
}

/// Cells of a row of a data file, each with the name of its column.
type DataRow = Vec<(String, Value)>;

/// Returns CSV with a line for each element of a list, or one line for an object.
///
/// Fields of objects in objects have a column each, `outer.inner`, and so do elements of a list without objects,
/// `list.1`. A list with objects has a line for each element, which repeats the other fields.
fn csv(value: &Value) -> String {
    let rows: Vec<DataRow> = match value {
        Value::Array(items) => items.iter().flat_map(|item| rows("", item)).collect(),
        other => rows("", other),
    };
    let mut columns: Vec<&String> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !columns.contains(&name) {
            columns.push(name);
        }
    }
    let header: Vec<String> = columns.iter().map(|name| quoted(name)).collect();
    let mut csv = header.join(",") + "\n";
    for row in &rows {
        let cells: Vec<String> = columns.iter().map(|name| cell(row, name)).collect();
        csv += &(cells.join(",") + "\n");
    }
    csv
}

fn cell(row: &DataRow, column: &str) -> String {
    match row.iter().find(|(name, _)| name == column).map(|(_, value)| value) {
        None => String::new(),
        Some(Value::String(text)) => quoted(text),
        Some(other) => other.to_string(),
    }
}

/// Returns the rows of a value whose name is `name`.
fn rows(name: &str, value: &Value) -> Vec<DataRow> {
    match value {
        Value::Array(items) if has_object(value) => {
            items.iter().flat_map(|item| rows(name, item)).collect()
        }
        Value::Array(items) => {
            let numbered = (1..).zip(items);
            joined(numbered.map(|(k, item)| (inner_name(name, &format!("{k}")), item)).collect())
        }
        Value::Object(fields) => {
            joined(fields.iter().map(|(key, field)| (inner_name(name, key), field)).collect())
        }
        Value::Null => vec![DataRow::new()],
        scalar => vec![vec![(name.to_owned(), scalar.clone())]],
    }
}

/// Returns the name of the part `key` of a value.
fn inner_name(outer: &str, key: &str) -> String {
    if outer.is_empty() { key.to_owned() } else { format!("{outer}.{key}") }
}

/// Returns the rows of an object with these fields: the rows of its lists of objects, each with all other fields.
fn joined(fields: Vec<(String, &Value)>) -> Vec<DataRow> {
    let (mut same, mut lines) = (DataRow::new(), Vec::new());
    for (name, field) in fields {
        let of_field = rows(&name, field);
        match field {
            _ if has_object(field) && field.is_array() => lines.extend(of_field),
            _ if of_field.len() > 1 => lines.extend(of_field),
            _ => same.extend(of_field.into_iter().flatten()),
        }
    }
    if lines.is_empty() {
        return vec![same];
    }
    lines.into_iter().map(|line| same.clone().into_iter().chain(line).collect()).collect()
}

fn has_object(value: &Value) -> bool {
    match value {
        Value::Object(_) => true,
        Value::Array(items) => items.iter().any(has_object),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nested_values_become_columns_and_lines() {
        let value = json!([
            { "name": "a,b", "range": { "least": 0.1, "greatest": null }, "of": [1, 2],
              "levels": [{ "cells": 4, "error": 1.0 / 3.0 }, { "cells": 8, "error": 1e-300 }] },
            { "name": "c", "range": { "least": 0.2, "greatest": 7.0 }, "of": [3, 4], "levels": [] },
        ]);
        expect_test::expect![[r#"
            name,of.1,of.2,range.least,levels.cells,levels.error,range.greatest
            "a,b",1,2,0.1,4,0.3333333333333333,
            "a,b",1,2,0.1,8,1e-300,
            c,3,4,0.2,,,7.0
        "#]]
        .assert_eq(&csv(&value));
    }

    #[test]
    fn lists_in_lists_and_several_lists_are_all_there() {
        assert_eq!(csv(&json!([[{ "x": 1 }, { "x": 2 }], [{ "x": 3 }]])), "x\n1\n2\n3\n");
        assert_eq!(csv(&json!([[1, [2, 3]]])), "1,2.1,2.2\n1,2,3\n");
        let two = json!({ "r": 5, "a": [{ "x": 1 }], "b": [{ "y": 2 }] });
        assert_eq!(csv(&two), "r,a.x,b.y\n5,1,\n5,,2\n");
    }

    #[test]
    fn a_name_stands_for_one_file() {
        let (mut tera, data) = (Tera::new(), Data::default());
        data.register(&mut tera);
        let context = tera::Context::from_serialize(&json!({ "a": [{ "x": 1, "y": 2 }], "b": [] }));
        let context = context.unwrap();
        tera.add_raw_templates([
            ("first", "{{ a | data(name=\"a b\", keys=[\"x\"]) }}"),
            ("second", "{{ b | data(name=\"a b\") }}"),
        ])
        .unwrap();
        assert_eq!(tera.render("first", &context).unwrap(), "data/a-b.csv");
        assert_eq!(data.files(), BTreeMap::from([("a-b.csv".into(), "x\n1\n".into())]));
        let error = tera.render("second", &context).unwrap_err().to_string();
        assert!(error.contains("two different data are named `a-b`"), "{error}");
    }
}
