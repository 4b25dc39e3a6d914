//! Licences of the packages in the program: each is allowed, and its notices go with every archive of a release.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Text of a file of the repository.
fn read(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// Packages that these kinds of dependencies reach, each with its version and licence.
fn packages(edges: &str) -> BTreeSet<(String, String)> {
    let mut command = Command::new(env!("CARGO"));
    command.args(["tree", "--offline", "--locked", "--prefix", "none", "--edges", edges]);
    let said = command.args(["--format", "{p}|{l}"]).output().unwrap();
    assert!(said.status.success(), "{said:?}");
    let mut packages = BTreeSet::new();
    for line in String::from_utf8(said.stdout).unwrap().lines() {
        if let Some((package, licence)) = line.split_once('|').filter(|_| !line.contains(" (/")) {
            let package = package.replace(" v", " ").replace(" (proc-macro)", "");
            packages.insert((package, licence.trim_end_matches(" (*)").to_owned()));
        }
    }
    packages
}

#[test]
fn every_licence_that_is_allowed_is_that_of_a_package() {
    let settings: toml::Table = toml::from_str(&read("deny.toml")).unwrap();
    let allowed = settings["licenses"]["allow"].as_array().unwrap();
    let packages = packages("normal,build,dev");
    assert!(packages.len() > 150, "{packages:?}");
    for licence in allowed.iter().map(|licence| licence.as_str().unwrap()) {
        let is_used = packages.iter().any(|(_, of)| {
            of.split(['/', '(', ')']).any(|part| {
                part.split(" OR ")
                    .flat_map(|part| part.split(" AND "))
                    .any(|one| one.trim() == licence)
            })
        });
        assert!(is_used, "{licence}");
    }
}

#[test]
fn the_archive_of_a_release_has_the_notices_of_the_packages_in_the_program() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join(".ci/notices");
    let said = Command::new(script).arg("--offline").output().unwrap();
    assert!(said.status.success(), "{said:?}");
    let notices = String::from_utf8_lossy(&said.stdout);
    for (package, licence) in packages("normal,no-proc-macro") {
        let head =
            format!("\n======== {package}, licence {licence}\nsource: https://crates.io/crates/");
        let (_, after) = notices.split_once(&head).unwrap_or_else(|| panic!("{package}"));
        let part = after.split("\n======== ").next().unwrap();
        assert!(part.lines().filter(|line| !line.is_empty()).count() > 1, "{package}: {part}");
    }
    for text in [
        "Mozilla Public License, version 2.0",
        "Attribution 4.0 International",
        "THE SOFTWARE IS PROVIDED",
    ] {
        assert!(notices.contains(text), "{text}");
    }
    let workflow = read(".github/workflows/release.yml");
    assert!(workflow.contains(".ci/notices --target ${{ matrix.target }} > NOTICES"));
    let mut archived = workflow.lines().filter(|line| line.contains("tar -czf"));
    assert!(archived.all(|line| ["LICENSE", "NOTICES"].iter().all(|file| line.contains(file))));
    assert!(read("Containerfile").contains(".ci/notices > NOTICES"));
}
