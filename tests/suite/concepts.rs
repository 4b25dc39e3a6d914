//! What has to be known of one package to work on another: the items that it names, the types that are public, and the
//! methods of its central trait, counted by parsing its sources.
//!
//! No file is exempt; code for tests alone does not count.

use crate::layout::{code_below, mathematics, paths_after, source_folder};
use std::collections::{BTreeMap, BTreeSet};

/// Most items of the mathematics that the program names.
const ITEMS_OF_THE_MATHEMATICS: usize = 60;

/// Most public types of the mathematics: structures, enumerations, traits and names of types.
const TYPES_OF_THE_MATHEMATICS: usize = 160;

/// Most methods of the trait of geometry and load.
const METHODS_OF_LEVELS: usize = 15;

/// Folders of the other packages.
const OTHER_PACKAGES: [&str; 3] = ["book/", "mathematics/", "pipeline/"];

/// Code of the program by path below `src/`.
fn program() -> BTreeMap<String, String> {
    let mut program = code_below(&source_folder());
    program.retain(|path, _| !OTHER_PACKAGES.iter().any(|folder| path.starts_with(folder)));
    program
}

/// Paths of the mathematics that a code names, one for each item of a group.
fn named(code: &str) -> BTreeSet<String> {
    let paths = paths_after(code, "signorini_mathematics::").into_iter();
    // A group may name its own path, and what is behind a path is no name.
    paths.map(|path| path.join("::").trim_end_matches("::self").to_owned()).collect()
}

#[test]
fn the_program_names_few_items_of_the_mathematics() {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (path, code) in program() {
        for item in named(&code) {
            found.entry(item).or_default().push(path.clone());
        }
    }
    assert!(found.len() > 50, "{found:#?}");
    assert!(found.len() <= ITEMS_OF_THE_MATHEMATICS, "{}: {found:#?}", found.len());
}

/// Types that a code declares as public.
fn public_types(code: &str) -> Vec<&str> {
    const KINDS: [&str; 5] = ["struct", "enum", "trait", "type", "union"];
    let lines = code.lines().filter_map(|line| line.trim_start().strip_prefix("pub "));
    let words = lines.map(|line| line.trim_start_matches("unsafe ").split_once(' '));
    let declared = words.flatten().filter(|(kind, _)| KINDS.contains(kind));
    declared.filter_map(|(_, rest)| rest.split(|c: char| !c.is_alphanumeric()).next()).collect()
}

#[test]
fn the_mathematics_has_few_public_types() {
    let sources = code_below(&mathematics());
    let found: Vec<_> = sources.values().flat_map(|code| public_types(code)).collect();
    assert!(found.len() > 50, "{found:?}");
    assert!(found.len() <= TYPES_OF_THE_MATHEMATICS, "{}: {found:?}", found.len());
    let code = "pub struct A<'a> {\n    pub b: C,\n}\npub(crate) enum D {}\npub fn struct_of() {}\npub type E = A;";
    assert_eq!(public_types(code), ["A", "E"]);
}

#[test]
fn levels_are_geometry_and_load() {
    let sources = code_below(&mathematics());
    let code = &sources["levels/mod.rs"];
    let (_, methods) = code.split_once("pub trait Levels").expect("the trait");
    let (methods, _) = methods.split_once("\n}\n").expect("its end");
    let methods: Vec<_> =
        methods.lines().filter(|line| line.trim_start().starts_with("fn ")).collect();
    assert!(methods.len() > 5 && methods.len() <= METHODS_OF_LEVELS, "{methods:#?}");
    // Nor are there others beside the trait.
    let beside = sources.values().filter(|code| code.contains("impl dyn Levels"));
    assert_eq!(beside.count(), 0);
}
