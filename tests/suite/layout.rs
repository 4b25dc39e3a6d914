//! The layout of `src/`: rooms use only rooms that come before them, and modules of one room form no circle.
//!
//! The first fifteen are a package of their own, the mathematics, which the program uses by its name; so are the
//! pictures, which use the mathematics alone, the pipeline, which uses none of them, and the builder of the book, which
//! uses the pipeline alone.

use crate::common::files_below;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Most files outside the room of the square that name it: it makes the square faster, and could be deleted.
const FILES_THAT_NAME_THE_SQUARE: usize = 7;

/// The rooms of `src/`, each before those that use it.
pub(crate) const ROOMS: [&str; 22] = [
    "machine",
    "problem",
    "discrete",
    "mesh",
    "multigrid",
    "multilevel",
    "bounds",
    "square",
    "saddle",
    "spectral",
    "levels",
    "formats",
    "solvers",
    "statement",
    "identify",
    "figures",
    "pipeline",
    "book",
    "table",
    "timing",
    "replication",
    "cli",
];

/// Packages that are one room, each with those of ours that it uses.
const ONE_ROOM: [(&str, &[&str]); 3] =
    [("figures", &["signorini-mathematics"]), ("pipeline", &[]), ("book", &["signorini-pipeline"])];

/// Every source file below `folder`.
pub(crate) fn sources(folder: &Path) -> Vec<PathBuf> {
    let names = files_below(folder).into_keys().filter(|name| name.ends_with(".rs"));
    names.map(|name| folder.join(name)).collect()
}

/// The folder of all sources.
pub(crate) fn source_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

pub(crate) fn mathematics() -> PathBuf {
    source_folder().join("mathematics/src")
}

/// The module that a source file holds, as a path from the root of its crate; from its room if that is a package.
pub(crate) fn module(file: &Path) -> Vec<String> {
    let path = file.strip_prefix(mathematics()).or_else(|_| file.strip_prefix(source_folder()));
    let path = path.unwrap().with_extension("");
    let mut parts: Vec<_> = path.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if is_one_room(&parts[0]) && parts.len() > 1 {
        parts.remove(1);
        parts.retain(|part| part != "lib");
    }
    if parts.last().is_some_and(|last| last == "mod") {
        parts.pop();
    }
    parts
}

fn is_one_room(name: &str) -> bool {
    ONE_ROOM.iter().any(|(room, _)| *room == name)
}

/// The module from which the paths `crate::` of a module begin.
fn root(module: &[String]) -> &[String] {
    &module[..usize::from(module.first().is_some_and(|room| is_one_room(room)))]
}

/// Code of the sources below a folder by path from there; comments and what is compiled for tests alone do not count.
pub(crate) fn code_below(folder: &Path) -> BTreeMap<String, String> {
    let (mut code, mut of_tests) = (BTreeMap::new(), BTreeSet::new());
    for (path, bytes) in files_below(folder).into_iter().filter(|(path, _)| path.ends_with(".rs")) {
        let text = String::from_utf8(bytes).unwrap();
        let names = modules_of_tests(&text).into_iter();
        of_tests.extend(names.map(|name| format!("{}/{name}", place(&path))));
        code.insert(path, without_tests(&text));
    }
    let is_of_tests = |place: &str| of_tests.contains(place);
    code.retain(|path, _| {
        !Path::new(place(path)).ancestors().any(|at| is_of_tests(at.to_str().unwrap()))
    });
    code
}

/// Place of the submodules of a file.
fn place(path: &str) -> &str {
    let place = path.trim_end_matches(".rs").trim_end_matches("/mod");
    place.strip_suffix("/lib").unwrap_or(place)
}

/// Names of the modules in files of their own that a text declares for tests alone.
fn modules_of_tests(text: &str) -> Vec<&str> {
    let after = text.split("#[cfg(test)]\n").skip(1);
    let declared = after.filter_map(|rest| rest.lines().next()?.trim().strip_suffix(';'));
    declared.filter_map(|line| Some(line.rsplit_once("mod ")?.1)).collect()
}

/// Code of a text: without lines of comments, and without the unit tests, which end a file.
fn without_tests(text: &str) -> String {
    let tests =
        ["mod tests {", "pub(super) mod tests {"].map(|line| format!("#[cfg(test)]\n{line}"));
    let code = tests.iter().fold(text, |code, tests| code.split(tests.as_str()).next().unwrap());
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.fold(String::new(), |code, line| code + line + "\n")
}

/// Paths in some code, each as its names.
type Paths = Vec<Vec<String>>;

/// The paths in some code that follow `root`; what stands in braces counts as several.
pub(crate) fn paths_after(code: &str, root: &str) -> Paths {
    let mut found = Vec::new();
    for (at, _) in code.match_indices(root) {
        // Not the end of another word, and not in the middle of a path.
        if !code[..at].ends_with(|c: char| c.is_alphanumeric() || "_:".contains(c)) {
            read_path(&code[at + root.len()..], &[], &mut found);
        }
    }
    found
}

/// Reads a path or a group of paths in braces, each with `prefix` before it; returns the code that follows.
fn read_path<'a>(code: &'a str, prefix: &[String], found: &mut Paths) -> &'a str {
    if let Some(mut rest) = code.strip_prefix('{') {
        while let Some(next) = rest.find(|c: char| !c.is_whitespace() && c != ',') {
            if let Some(rest) = rest[next..].strip_prefix('}') {
                return rest;
            }
            rest = read_path(&rest[next..], prefix, found);
            // Other names for what is imported do not matter here.
            rest = &rest[rest.find([',', '}']).unwrap_or(rest.len())..];
        }
        return rest;
    }
    let end = code.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(code.len());
    let path = [prefix, &[code[..end].to_owned()]].concat();
    match code[end..].strip_prefix("::") {
        Some(rest) => read_path(rest, &path, found),
        None => {
            found.push(path);
            &code[end..]
        }
    }
}

/// The paths from a room on that some code names.
fn named(code: &str) -> Paths {
    let mut paths = paths_after(code, "crate::");
    paths.extend(paths_after(code, "signorini_mathematics::"));
    paths
}

#[test]
fn few_files_outside_the_room_of_the_square_name_it() {
    let code = code_below(&source_folder()).into_iter();
    let outside = code.filter(|(file, _)| !file.starts_with("mathematics/src/square/"));
    let names_it = outside.filter(|(_, code)| named(code).iter().any(|path| path[0] == "square"));
    let found: Vec<String> = names_it.map(|(file, _)| file).collect();
    assert!(found.len() > 1 && found.len() <= FILES_THAT_NAME_THE_SQUARE, "{found:#?}");
}

#[test]
fn rooms_use_only_rooms_before_them() {
    let place = |room: &str| ROOMS.iter().position(|&known| known == room);
    let mut wrong = BTreeSet::new();
    let inside = [source_folder(), mathematics()].map(|folder| fs::read_dir(folder).unwrap());
    for room in inside.into_iter().flatten().map(|room| room.unwrap().path()) {
        let name = room.file_stem().unwrap().to_str().unwrap().to_owned();
        if !room.is_dir() || mathematics().starts_with(&room) || is_one_room(&name) {
            continue;
        }
        // What calls the program from Python is no room.
        if sources(&room).is_empty() {
            continue;
        }
        let here =
            place(&name).unwrap_or_else(|| panic!("src/{name} has no place among the rooms"));
        for (file, code) in code_below(&room) {
            for path in named(&code) {
                if place(&path[0]).is_none_or(|there| there > here) {
                    wrong.insert(format!("{name}/{file} uses {}", path[0]));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Modules, and where each finds the names that it takes from its own submodules.
struct Modules {
    code: BTreeMap<Vec<String>, String>,
    imported: BTreeMap<Vec<String>, Vec<String>>,
}

impl Modules {
    fn read() -> Self {
        let files = code_below(&source_folder()).into_iter();
        let code = files.map(|(file, code)| (module(&source_folder().join(file)), code)).collect();
        let mut all = Self { code, imported: BTreeMap::new() };
        for (here, text) in &all.code {
            for path in paths_after(text, "use ") {
                let path = [&here[..], &path].concat();
                let there = all.module_of(&path);
                if there.len() > here.len() {
                    let name = [&here[..], &path[path.len() - 1..]].concat();
                    all.imported.insert(name, there);
                }
            }
        }
        all
    }

    /// The module that a path from the root leads to or into.
    fn module_of(&self, path: &[String]) -> Vec<String> {
        let depth = (0..=path.len()).rev().find(|&depth| self.code.contains_key(&path[..depth]));
        let there = &path[..depth.unwrap_or(0)];
        let name = path.get(..there.len() + 1).and_then(|name| self.imported.get(name));
        name.cloned().unwrap_or_else(|| there.into())
    }

    /// The modules that a module names.
    fn used_by(&self, here: &[String]) -> BTreeSet<Vec<String>> {
        let mut used = BTreeSet::new();
        for path in paths_after(&self.code[here], "crate::") {
            used.insert(self.module_of(&[root(here), &path].concat()));
        }
        for path in paths_after(&self.code[here], "super::") {
            let ups = path.iter().take_while(|name| *name == "super").count();
            let above = &here[..here.len().saturating_sub(ups + 1)];
            used.insert(self.module_of(&[above, &path[ups..]].concat()));
        }
        used
    }
}

#[test]
fn modules_of_a_room_form_no_circle() {
    let modules = Modules::read();
    // Arrows between modules with the same parent, also for what is inside them.
    let mut arrows: BTreeMap<Vec<String>, BTreeSet<Vec<String>>> = BTreeMap::new();
    for here in modules.code.keys() {
        for there in modules.used_by(here) {
            let common = here.iter().zip(&there).take_while(|(here, there)| here == there).count();
            if common > 0 && common < here.len().min(there.len()) {
                let [from, to] = [here, &there].map(|module| module[..=common].to_vec());
                arrows.entry(from).or_default().insert(to);
            }
        }
    }
    for start in arrows.keys() {
        let (mut seen, mut open) = (BTreeSet::new(), vec![start]);
        while let Some(next) = open.pop() {
            for there in arrows.get(next).into_iter().flatten() {
                assert!(
                    there != start,
                    "{} and {} use each other",
                    start.join("::"),
                    next.join("::")
                );
                if seen.insert(there) {
                    open.push(there);
                }
            }
        }
    }
}

#[test]
fn packages_of_one_room_know_no_others() {
    for (room, uses) in ONE_ROOM {
        let manifest = source_folder().join(room).join("Cargo.toml");
        let manifest: toml::Table = fs::read_to_string(manifest).unwrap().parse().unwrap();
        let needed = manifest["dependencies"].as_table().unwrap();
        let ours: Vec<_> = needed.keys().filter(|name| name.starts_with("signorini")).collect();
        assert_eq!(ours, uses, "{room}");
    }
}

#[test]
fn overrides_of_the_profile_are_for_crates_of_the_lock_file() {
    let read = |name: &str| -> toml::Table {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        fs::read_to_string(path).unwrap().parse().unwrap()
    };
    let (manifest, lock) = (read("Cargo.toml"), read("Cargo.lock"));
    let packages = lock["package"].as_array().unwrap().iter();
    let there: BTreeSet<&str> = packages.map(|one| one["name"].as_str().unwrap()).collect();
    let overrides = manifest["profile"]["release"]["package"].as_table().unwrap();
    let named = overrides.keys().filter(|name| *name != "*");
    let stale: Vec<_> =
        named.filter(|name| !there.contains(name.split('@').next().unwrap())).collect();
    assert!(
        stale.is_empty(),
        "profile.release.package has crates that Cargo.lock lacks: {stale:?}"
    );
}
