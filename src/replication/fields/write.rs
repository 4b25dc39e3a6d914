//! A statement as options of `solve`, and as the keys of a scene.

use super::table::FIELDS;
use crate::replication::mesh_files::FOLDER;
use crate::replication::scene::{Output, Scene};
use signorini_mathematics::statement::Statement;
use std::borrow::Cow;
use toml::Value;

/// Returns the options of `solve` that state a problem, each followed by its value.
pub(crate) fn options(statement: &Statement) -> Vec<String> {
    let mut options = Vec::new();
    for field in &FIELDS {
        let Some(value) = field.named(statement) else { continue };
        for value in field.options(statement, value) {
            options.extend([field.option(), value]);
        }
    }
    options
}

/// Returns the words of the command that solves a scene, in the folder of the project, each as a shell reads it: an
/// option with its value is one.
pub(crate) fn command(scene: &Scene) -> Vec<String> {
    let mut statement = scene.statement.clone();
    if statement.domain.is_file() {
        statement.domain.name = format!("{FOLDER}/{}", statement.domain.name);
    }
    let options = options(&statement);
    let words = options.chunks(2).map(|option| {
        let value = shlex::try_quote(&option[1]).unwrap_or(Cow::Borrowed(&option[1]));
        format!("{} {value}", option[0])
    });
    ["signorini".to_owned(), "solve".to_owned()].into_iter().chain(words).collect()
}

/// Returns a command as lines for a shell: `first`, then the words, broken between them or, where one is too long, behind
/// the semicolons of f, which may stand at the end of a line.
pub(crate) fn lines(first: &str, words: &[String], width: usize) -> String {
    let mut lines = vec![first.to_owned()];
    for word in words {
        let mut parts = word.split_inclusive("; ").map(str::trim_end);
        let is_long = INDENT.len() + word.len() + BREAK.len() > width;
        let whole = if is_long { parts.next().unwrap_or_default() } else { word.as_str() };
        let last = lines.len() - 1;
        if lines[last].len() + whole.len() + BREAK.len() < width {
            lines[last] += &format!(" {whole}");
        } else {
            lines[last] += BREAK;
            lines.push(format!("{INDENT}{whole}"));
        }
        for part in parts.filter(|_| is_long) {
            let last = lines.len() - 1;
            if lines[last].len() + part.len() + BREAK.len() < width {
                lines[last] += &format!(" {part}");
            } else {
                lines.push(format!("{INDENT}{part}"));
            }
        }
    }
    lines.join("\n")
}

/// Beginning of a line that goes on with a command.
const INDENT: &str = "    ";
/// End of a line whose command goes on in the next.
const BREAK: &str = " \\";

/// Returns the text of a scene with a title, a statement and outputs.
pub(crate) fn scene(title: &str, statement: &Statement, outputs: &[Output]) -> String {
    let mut text = format!("title = {}\n", Value::from(title));
    let mut tables: Vec<&str> = Vec::new();
    for field in &FIELDS {
        let key = field.table.unwrap_or(field.name);
        if tables.contains(&key) {
            continue;
        }
        let is_table = FIELDS.iter().any(|field| field.table == Some(key));
        let value = match is_table {
            false => field.named(statement),
            true => {
                tables.push(key);
                table(key, statement)
            }
        };
        text.extend(value.map(|value| format!("{key} = {value}\n")));
    }
    let outputs: Vec<_> = outputs.iter().map(Output::to_string).collect();
    text + &format!("outputs = {}\n", Value::from(outputs))
}

/// Returns the fields of a table of a scene: of a domain about which nothing else is said, its name.
fn table(key: &str, statement: &Statement) -> Option<Value> {
    let mut table = toml::Table::new();
    for field in FIELDS.iter().filter(|field| field.table == Some(key)) {
        table.extend(field.named(statement).map(|value| (field.name.to_owned(), value)));
    }
    let name = FIELDS.iter().find(|field| field.name == key);
    match name.and_then(|field| field.named(statement)) {
        Some(name) if table.is_empty() => Some(name),
        Some(name) => {
            table.insert("name".into(), name);
            Some(Value::Table(table))
        }
        None => (!table.is_empty()).then_some(Value::Table(table)),
    }
}
