//! Names in ARCHITECTURE.md: what stands there in backticks exists.

use crate::layout::{ROOMS, source_folder, sources};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Folders from which paths are named: the root, and the sources of the packages.
const FOLDERS: [&str; 6] =
    ["", "src", "src/mathematics/src", "src/figures/src", "src/pipeline/src", "src/book/src"];

/// Words before the name of an item.
const KEYWORDS: [&str; 8] = ["fn", "struct", "enum", "trait", "const", "static", "type", "mod"];

fn architecture() -> String {
    fs::read_to_string(Path::new(ROOT).join("ARCHITECTURE.md")).unwrap()
}

/// Code of all packages and tests, and what cargo reads, in which names are looked up.
fn code() -> String {
    let mut files = sources(&source_folder());
    files.extend(sources(&Path::new(ROOT).join("tests/suite")));
    files.retain(|file| !file.ends_with("documents.rs"));
    for folder in ["", "src/book", "src/figures", "src/mathematics", "src/pipeline"] {
        files.push(Path::new(ROOT).join(folder).join("Cargo.toml"));
    }
    files.iter().map(|file| fs::read_to_string(file).unwrap()).collect()
}

/// True if a path is there, or is named by the program, which makes it.
fn has_path(path: &str, code: &str) -> bool {
    let made = format!("\"{}\"", path.trim_end_matches('/'));
    FOLDERS.iter().any(|folder| Path::new(ROOT).join(folder).join(path).exists())
        || code.contains(&made)
}

fn is_path(part: &str) -> bool {
    part.contains('/') || [".rs", ".md", ".toml", ".lock"].iter().any(|end| part.ends_with(end))
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// Names after the keywords in some code, comments apart.
fn items(code: &str) -> impl Iterator<Item = &str> {
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.flat_map(|line| {
        let is_keyword = |(before, _): &(&str, &str)| KEYWORDS.contains(before);
        words(line).zip(words(line).skip(1)).filter(is_keyword).map(|(_, name)| name)
    })
}

/// Texts of a page in backticks and, of its blocks, the words that name paths or items.
fn quoted(page: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for (k, part) in page.split("```").enumerate() {
        if k % 2 == 0 {
            found.extend(part.split('`').skip(1).step_by(2));
        } else {
            let names = part.split_whitespace().map(|word| word.trim_end_matches([',', ';']));
            found.extend(names.filter(|name| {
                !name.contains('*')
                    && (name.contains("::") || name.ends_with(".rs") || name.ends_with(".toml"))
            }));
        }
    }
    found
}

/// Rows of the table of a page whose head begins with this word, each as its cells.
fn rows<'a>(page: &'a str, head: &str) -> Vec<Vec<&'a str>> {
    let lines = page.lines().skip_while(|line| !line.starts_with(&format!("| {head} |"))).skip(2);
    let rows = lines.take_while(|line| line.starts_with('|'));
    rows.map(|row| row.split('|').skip(1).map(str::trim).collect()).collect()
}

#[test]
fn names_in_the_architecture_exist() {
    let (page, code) = (architecture(), code());
    let known: BTreeSet<_> = words(&code).collect();
    let quoted = quoted(&page);
    assert!(quoted.len() > 100, "{quoted:?}");
    let parts = quoted.iter().flat_map(|quoted| quoted.split_whitespace());
    // A variable of the environment is read by another program.
    let parts =
        parts.map(|part| part.trim_end_matches([',', ';'])).filter(|part| !part.contains('='));
    let is_missing = |part: &&str| match is_path(part) {
        true => !has_path(part, &code),
        false => words(part).any(|word| !known.contains(word)),
    };
    let missing: Vec<_> = parts.filter(is_missing).collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md names what does not exist: {missing:#?}");
}

#[test]
fn types_of_the_map_are_defined_in_their_files_and_the_rooms_are_in_their_order() {
    let page = architecture();
    let types = rows(&page, "type");
    assert!(types.len() > 7);
    for row in types {
        let file = row[1].trim_matches('`');
        let mut there = FOLDERS.iter().map(|folder| Path::new(ROOT).join(folder).join(file));
        let code = fs::read_to_string(there.find(|path| path.exists()).unwrap()).unwrap();
        for name in row[0].split('`').skip(1).step_by(2) {
            assert!(items(&code).any(|item| item == name), "{file} does not define {name}");
        }
    }
    let rooms = rows(&page, "room");
    let rooms = rooms.iter().map(|row| row[0].trim_matches('`').trim_end_matches(".rs"));
    assert_eq!(rooms.map(|room| room.trim_end_matches('/')).collect::<Vec<_>>(), ROOMS);
}
