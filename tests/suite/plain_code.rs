//! Counts of what makes the sources hard to read. Each limit is the present count or the goal: a limit may only fall.

use crate::common::files_below;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Named local closures, `let name = |..| ..`, per 100 lines.
const CLOSURES_PER_100_LINES: f64 = 0.4;
/// Type names that stand for more than one type of a package.
const SHARED_TYPE_NAMES: usize = 5;
/// Documentation lines that begin with one of [`INDIRECT`].
const INDIRECT_DOCUMENTATION: usize = 10;
/// Most arguments of a function, `self` included.
const ARGUMENTS: usize = 5;

/// Most columns of a line, strings and comments included.
const COLUMNS: usize = 120;

/// First words of documentation that hide the noun.
const INDIRECT: [&str; 6] = ["What", "Whether", "Where", "How", "The same", "Its"];

/// Most functions with a loop over the iterations of the saddle-point methods.
const ITERATION_LOOPS: usize = 1;

/// Folders of the packages beside the program.
const PACKAGES: [&str; 4] = ["src/book/", "src/figures/", "src/mathematics/", "src/pipeline/"];

/// A source file: its path from the root of the repository, and its text.
struct Source {
    path: String,
    text: String,
}

/// Every Rust file below `src/`.
fn sources() -> Vec<Source> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let files = files_below(&folder).into_iter().filter(|(name, _)| name.ends_with(".rs"));
    files
        .map(|(name, bytes)| Source {
            path: format!("src/{name}"),
            text: String::from_utf8(bytes).unwrap(),
        })
        .collect()
}

/// Number of bindings `let name = |` or `let name = move |` in a text, over line ends as well.
fn named_closures(text: &str) -> usize {
    let binds_closure = |rest: &&str| {
        let Some((pattern, value)) = rest.split_once('=') else { return false };
        let name = pattern.split(':').next().unwrap_or_default();
        let name = name.trim().trim_start_matches("mut ");
        let value = value.trim_start();
        let value = value.strip_prefix("move").map_or(value, str::trim_start);
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        !pattern.contains(';') && name.chars().all(is_name) && value.starts_with('|')
    };
    text.split("let ").skip(1).filter(binds_closure).count()
}

/// Name of the type that a line at the margin of its module defines.
fn defined_type(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let line = match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
        Some(rest) => rest.trim_start(),
        None => line,
    };
    let rest = ["struct ", "enum ", "trait "].iter().find_map(|kind| line.strip_prefix(kind))?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()
}

/// Number of arguments of each function of a text, by its name.
fn arguments(text: &str) -> Vec<(&str, usize)> {
    let code: Vec<&str> = text.split("fn ").skip(1).collect();
    code.into_iter().filter_map(|rest| Some((name_of(rest)?, count_arguments(rest)?))).collect()
}

fn name_of(rest: &str) -> Option<&str> {
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_')?;
    (end > 0).then(|| &rest[..end])
}

/// Number of arguments between the parentheses that follow a function's name and its generic parameters.
fn count_arguments(rest: &str) -> Option<usize> {
    let (mut depth, mut angle, mut count, mut pending, mut last) = (0, 0, 0, false, ' ');
    for c in rest.chars() {
        match c {
            '<' => angle += 1,
            '>' if last != '-' && last != '=' => angle -= 1,
            '(' | '[' | '{' if depth > 0 || angle == 0 => depth += 1,
            ')' | ']' | '}' if depth > 1 => depth -= 1,
            ')' if depth == 1 => return Some(count + usize::from(pending)),
            ',' if depth == 1 && angle == 0 => {
                count += usize::from(pending);
                pending = false;
            }
            c if depth == 1 && !c.is_whitespace() => pending = true,
            c if depth == 0 && angle == 0 && !c.is_alphanumeric() && !"_' \n".contains(c) => {
                return None;
            }
            _ => (),
        }
        last = c;
    }
    None
}

#[test]
fn closures_have_no_names() {
    let sources = sources();
    let lines: usize = sources.iter().map(|source| source.text.lines().count()).sum();
    let closures: usize = sources.iter().map(|source| named_closures(&source.text)).sum();
    let share = 100.0 * closures as f64 / lines as f64;
    assert!(share <= CLOSURES_PER_100_LINES, "{closures} in {lines} lines, {share:.2} per 100");
}

#[test]
fn a_type_name_means_one_thing_in_its_package() {
    let mut places: BTreeMap<(Option<&str>, String), BTreeSet<String>> = BTreeMap::new();
    for source in sources() {
        let package = PACKAGES.into_iter().find(|package| source.path.starts_with(package));
        for name in source.text.lines().filter_map(defined_type) {
            let found = places.entry((package, name.to_owned())).or_default();
            found.insert(source.path.clone());
        }
    }
    places.retain(|_, found| found.len() > 1);
    assert!(places.len() <= SHARED_TYPE_NAMES, "{}: {places:#?}", places.len());
}

#[test]
fn documentation_begins_with_the_noun_or_the_verb() {
    let sources = sources();
    let mut found = Vec::new();
    for source in &sources {
        for line in source.text.lines().map(str::trim_start) {
            let Some(said) = line.strip_prefix("/// ").or_else(|| line.strip_prefix("//! ")) else {
                continue;
            };
            let begins = |word: &&str| {
                said.strip_prefix(*word)
                    .is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
            };
            if INDIRECT.iter().any(begins) {
                found.push(format!("{}: {said}", source.path));
            }
        }
    }
    assert!(found.len() <= INDIRECT_DOCUMENTATION, "{}: {found:#?}", found.len());
}

#[test]
fn functions_take_few_arguments() {
    let sources = sources();
    let mut found = Vec::new();
    for source in &sources {
        let long = arguments(&source.text).into_iter().filter(|(_, count)| *count > ARGUMENTS);
        found.extend(long.map(|(name, count)| format!("{}: {name} takes {count}", source.path)));
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// Names of the functions of a text, unit tests apart, that take the step (12) of the multiplier: each goes round in a
/// loop over iterations, itself or with its callers. An engine's own `dual_step` may pass the call on.
fn stepping_functions(text: &str) -> Vec<&str> {
    let code = text.split("mod tests {").next().unwrap_or_default();
    let functions = code.split("fn ").skip(1);
    let stepping = functions.filter(|body| {
        let lines = body.lines().filter(|line| !line.trim_start().starts_with("//"));
        lines.into_iter().any(|line| line.contains(".dual_step("))
    });
    stepping.filter_map(name_of).filter(|name| *name != "dual_step").collect()
}

#[test]
fn one_function_has_a_loop_over_the_iterations_of_the_paper() {
    let mut found = Vec::new();
    for source in sources().iter().filter(|source| !source.path.ends_with("tests.rs")) {
        let names = stepping_functions(&source.text);
        found.extend(names.into_iter().map(|name| format!("{}: {name}", source.path)));
    }
    assert!(!found.is_empty() && found.len() <= ITERATION_LOOPS, "{found:#?}");
}

#[test]
fn lines_end_at_120_columns() {
    let mut found = Vec::new();
    for Source { path, text } in sources() {
        let long = (1..).zip(text.lines()).filter(|(_, line)| line.chars().count() > COLUMNS);
        found.extend(long.map(|(number, _)| format!("{path}:{number}")));
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// Comparisons with `Some` on the greater side, which a number that is missing passes.
fn passed_by_none(text: &str) -> usize {
    let code = text.split_whitespace().collect::<Vec<_>>().join(" ");
    ["< Some(", "<= Some("].iter().map(|sign| code.matches(sign).count()).sum()
}

#[test]
fn no_comparison_is_passed_by_a_number_that_is_missing() {
    let mut texts: Vec<_> =
        sources().into_iter().map(|Source { path, text }| (path, text)).collect();
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() && !path.ends_with("plain_code.rs") {
            texts.push((path.display().to_string(), fs::read_to_string(path).unwrap()));
        }
    }
    texts.retain(|(_, text)| passed_by_none(text) > 0);
    let found: Vec<_> = texts.iter().map(|(path, _)| path).collect();
    assert!(found.is_empty(), "{found:#?}");
}
