//! The layout of `src/`: rooms use only rooms that come before them, and modules of one room form no circle.
//!
//! The first eight are a package of their own, the mathematics; the program names them as if they were its own.

use crate::common::files_below;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of `src/`, each before those that use it.
const ROOMS: [&str; 14] = [
    "problem",
    "discrete",
    "saddle",
    "multigrid",
    "spectral",
    "bounds",
    "identify",
    "experiments",
    "pipeline",
    "timing",
    "figures",
    "report",
    "replication",
    "cli",
];

/// Every source file below `folder`.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let names = files_below(folder).into_keys().filter(|name| name.ends_with(".rs"));
    names.map(|name| folder.join(name)).collect()
}

fn source_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn mathematics() -> PathBuf {
    source_folder().join("mathematics")
}

/// The module that a source file holds, as a path from the root of its crate.
fn module(file: &Path) -> Vec<String> {
    let path = file.strip_prefix(mathematics()).or_else(|_| file.strip_prefix(source_folder()));
    let path = path.unwrap().with_extension("");
    let mut parts: Vec<_> = path.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if parts.last().is_some_and(|last| last == "mod") {
        parts.pop();
    }
    parts
}

/// What follows `prefix` in the code of a file, up to the end of the name; comments and unit tests do not count.
fn names_after<'a>(text: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    let text = text.split("\nmod tests {").next().unwrap_or_default();
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.flat_map(move |line| line.split(prefix).skip(1)).map(|rest| {
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        &rest[..end]
    })
}

#[test]
fn rooms_use_only_rooms_before_them() {
    let place = |room: &str| ROOMS.iter().position(|&known| known == room);
    let mut wrong = BTreeSet::new();
    let inside = [source_folder(), mathematics()].map(|folder| fs::read_dir(folder).unwrap());
    for room in inside.into_iter().flatten().map(|room| room.unwrap().path()) {
        let name = room.file_stem().unwrap().to_str().unwrap().to_owned();
        if !room.is_dir() || room == mathematics() {
            continue;
        }
        let here =
            place(&name).unwrap_or_else(|| panic!("src/{name} has no place among the rooms"));
        for file in sources(&room) {
            let text = fs::read_to_string(&file).unwrap();
            for used in names_after(&text, "crate::") {
                if place(used).is_none_or(|there| there > here) {
                    wrong.insert(format!("{} uses {used}", file.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn modules_of_a_room_form_no_circle() {
    // Arrows between modules with the same parent, read off `super::name` and full paths.
    let mut arrows: BTreeMap<Vec<String>, BTreeSet<Vec<String>>> = BTreeMap::new();
    let files = sources(&source_folder());
    let modules: BTreeSet<_> = files.iter().map(|file| module(file)).collect();
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        let here = module(file);
        let Some((_, parent)) = here.split_last() else { continue };
        let full = format!("crate::{}::", parent.join("::"));
        let used = names_after(&text, "super::").chain(names_after(&text, &full));
        for name in used {
            let there: Vec<_> = parent.iter().cloned().chain([name.to_owned()]).collect();
            if there != here && modules.contains(&there) {
                arrows.entry(here.clone()).or_default().insert(there);
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
