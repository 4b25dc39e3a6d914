//! A statement as options of `solve`, and as the keys of a scene.

use super::Fields;
use super::member::Varying;
use super::table::{BOUNDARY, FIELDS, FOLDER, toml};
use crate::replication::output::Output;
use signorini_mathematics::statement::{Fineness, Statement};
use std::borrow::Cow;
use toml::{Table, Value};

/// Returns the options of `solve` that state a problem, each with its value.
fn options(statement: &Statement) -> Vec<[String; 2]> {
    let mut options = Vec::new();
    for field in &FIELDS {
        let texts = field.named(statement).into_iter().flatten();
        options.extend(texts.map(|text| [field.option(), text]));
    }
    options
}

/// Returns the arguments of `solve` that state a problem.
#[cfg(test)]
pub(crate) fn arguments(statement: &Statement) -> Vec<String> {
    options(statement).into_iter().flat_map(|[option, value]| joined(option, value)).collect()
}

/// Returns an option and its value as words; a value that begins like an option needs the sign between.
fn joined(option: String, value: String) -> Vec<String> {
    match value.starts_with('-') {
        true => vec![format!("{option}={value}")],
        false => vec![option, value],
    }
}

/// Returns the words of the command that solves the statement of a scene, in the folder of the project, each as a shell
/// reads it: an option with its value is one. A true solution has a fineness for files alone.
pub(crate) fn command(of_scene: &Statement) -> Vec<String> {
    let mut statement = of_scene.clone();
    if !statement.solver.entry().is_discrete {
        statement.fineness = Fineness::Usual;
    }
    if statement.domain.is_file() {
        statement.domain.name = format!("{FOLDER}/{}", statement.domain.name);
    }
    let mut words = vec!["signorini".to_owned(), "solve".to_owned()];
    for [option, value] in options(&statement) {
        let quoted = joined(option, value).into_iter();
        let quoted =
            quoted.map(|word| shlex::try_quote(&word).map_or(word.clone(), Cow::into_owned));
        words.push(quoted.collect::<Vec<_>>().join(" "));
    }
    words
}

/// Returns the text of a scene with a title, a statement and outputs.
pub(crate) fn scene(title: &str, statement: &Statement, outputs: &[Output]) -> String {
    let outputs: Vec<_> = outputs.iter().map(Output::to_string).collect();
    keys(title, statement, (&[], &Fields::default()))
        + &format!("outputs = {}\n", Value::from(outputs))
}

/// Returns the text of a study with a title and what it varies: lists of values, each with its name; `first` is the
/// statement of its first member, with f as it is given, and laws have the names in the fields that are `given`.
pub(crate) fn study(
    title: &str,
    first: &Statement,
    lists: &[(String, Vec<Varying>)],
    given: &Fields,
) -> String {
    let names: Vec<&str> = lists.iter().map(|(name, _)| name.as_str()).collect();
    let mut varied = Vec::new();
    for (name, values) in lists {
        let values: Vec<Value> = values.iter().map(Varying::toml).collect();
        varied.push(format!("{name} = {}", Value::from(values)));
    }
    let outputs = "outputs = [\"table\", \"chart\"]\n";
    keys(title, first, (&names, given)) + &format!("vary = {{ {} }}\n{outputs}", varied.join(", "))
}

/// Returns the lines of a title and a statement without these fields, with the names that laws have in the fields that
/// are given; of a domain about which nothing else is said, its name.
fn keys(title: &str, statement: &Statement, (without, given): (&[&str], &Fields)) -> String {
    let (mut lines, mut boundary) = (vec![("title", Value::from(title))], Table::new());
    for field in FIELDS.iter().filter(|field| !without.contains(&field.name)) {
        let named = given.with_names(field).or_else(|| field.named(statement));
        let Some(texts) = named else { continue };
        let (of_parts, texts): (Vec<_>, Vec<_>) =
            texts.into_iter().partition(|text| field.part_and_number(text).is_some());
        for (part, number) in of_parts.iter().filter_map(|text| field.part_and_number(text)) {
            let numbers = boundary.entry(part).or_insert_with(|| Value::Table(Table::new()));
            let numbers = numbers.as_table_mut().expect("made above");
            numbers.insert(field.name.to_owned(), toml(number));
        }
        if texts.is_empty() {
            continue;
        }
        let (key, value) = (field.table.unwrap_or(field.name), field.toml(&texts));
        let known = lines.iter_mut().find(|(known, _)| *known == key);
        match known.map(|(_, known)| known) {
            Some(Value::Table(table)) => _ = table.insert(field.name.to_owned(), value),
            Some(name) => *name = table([("name", name.clone()), (field.name, value)]),
            None if field.table.is_some() => lines.push((key, table([(field.name, value)]))),
            None => lines.push((key, value)),
        }
    }
    if !boundary.is_empty() {
        lines.push((BOUNDARY, boundary.into()));
    }
    let lines: Vec<_> = lines.iter().map(|(key, value)| format!("{key} = {value}")).collect();
    lines.join("\n") + "\n"
}

/// Returns the table with these keys.
fn table<const N: usize>(keys: [(&str, Value); N]) -> Value {
    Value::Table(keys.map(|(key, value)| (key.to_owned(), value)).into_iter().collect())
}
