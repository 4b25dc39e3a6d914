//! What is left for others to read: the reviewer's certificate.

use crate::common::{EVERYTHING, Project, Said, assert_same, wanting};
use std::fs;

/// A project with a published table of which one cell comes out differently and one is far off.
fn published() -> Project {
    Project::with(&(wanting(EVERYTHING) + "paper_table = 1\n"))
}

/// How many files the manifest of a certificate names, each of which is in the bundle with the hash it is said to have.
fn files_of_manifest(project: &Project, yaml: &str) -> usize {
    let mut files = 0;
    let mut rest = yaml.lines().filter_map(|line| line.trim_start().split_once(": "));
    while let Some((key, value)) = rest.next() {
        if key == "- file" {
            let (_, comment) = rest.next().unwrap();
            let (_, hash) = comment.trim_matches('"').rsplit_once("blake3 ").unwrap();
            let bytes = fs::read(project.path("codecheck").join(value.trim_matches('"'))).unwrap();
            assert_eq!(signorini::pipeline::hash(&bytes), hash, "{value}");
            files += 1;
        }
    }
    files
}

#[test]
fn a_certificate_says_what_matched_and_how_to_do_it_again() {
    let project = published();
    project.run(&["run"]).lines();
    let args = ["certificate", "--name", "A. \"R\" Reviewer"];
    let command = |args: &[&str]| {
        let mut command = project.command(args);
        command.env("SOURCE_DATE_EPOCH", "1795245605");
        Said::from(command.output().unwrap())
    };
    let said = command(&args);
    let lines = said.lines();
    assert!(lines[0].ends_with("codecheck/certificate.md"), "{said:?}");
    assert!(lines[1].ends_with("codecheck/codecheck.yml") && said.err.contains("2 of 4"));
    let printed = said.out.lines().chain(said.err.lines());
    printed.for_each(|line| assert!(line.chars().count() <= 80, "{line}"));

    let yaml = project.read("codecheck/codecheck.yml");
    assert!(
        yaml.starts_with("%YAML 1.1\n---\nversion: \"https://codecheck.org.uk/spec/config/1.0\"\n")
    );
    let keys: Vec<&str> = yaml
        .lines()
        .skip(2)
        .filter(|l| !l.starts_with(' '))
        .map(|l| l.split(':').next().unwrap())
        .collect();
    let wanted = "version manifest paper codechecker report summary repository check_time certificate signorini";
    assert_eq!(keys, wanted.split(' ').collect::<Vec<_>>());
    for line in [
        "codechecker:\n  - name: \"A. \\\"R\\\" Reviewer\"\n",
        "check_time: \"2026-11-21 07:20:05\"\n",
        "  authors:\n    - name: \"N. N. Maksimova (Н. Н. Максимова)\"\n",
        "    compiler: \"rustc 1.",
        "    processor: \"",
    ] {
        assert!(yaml.contains(line), "{line} is not in {yaml}");
    }
    let count = files_of_manifest(&project, &yaml);
    assert_eq!(count, 8, "the paper's table, that of the scene, four figures, and the data of two");

    let page = project.read("codecheck/certificate.md");
    for part in [
        "2 of 4 counts exact, 3 within tolerance",
        "**4** ~ 2",
        "**7** ! 100000",
        "**2.12e-2** ~",
        "| `signorini run --locked` | fails if",
        "| processor | ",
    ] {
        assert!(page.contains(part), "{part} is not in {page}");
    }
    assert!(page.lines().count() <= 60, "more than one page: {page}");
    // The same again is the same but for the clock, and nothing is overwritten.
    let said = command(&args);
    assert!(said.refusal().contains("codecheck is there already; move it away"), "{said:?}");
    command(&[&args[..], &["--output", "again"]].concat()).lines();
    assert_same(&project.files("again"), &project.files("codecheck"));
    fs::remove_dir_all(project.path("again")).unwrap();
    // It is no part of the run.
    project.run(&["run"]).nothing_to_do();
}
