//! What is left for others to read: the reviewer's certificate.

use crate::common::{EVERYTHING, Project, Said, TABLE, assert_same, files_below, wanting};
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

    let yaml = fs::read_to_string(project.path("codecheck/codecheck.yml")).unwrap();
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

    let page = fs::read_to_string(project.path("codecheck/certificate.md")).unwrap();
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

#[test]
fn what_leaves_the_machine_names_no_place_on_it() {
    let project = published();
    project.run(&["run"]).lines();
    project.run(&["certificate"]).lines();
    let place = project.path("").canonicalize().unwrap().display().to_string();
    for folder in ["codecheck", "pipeline", "figures", "report"] {
        for (name, bytes) in files_below(&project.path(folder)) {
            assert!(!String::from_utf8_lossy(&bytes).contains(&place), "{folder}/{name}");
        }
    }
    assert!(!project.run(&["dag", "--snakemake"]).out.contains(&place));
}

#[test]
fn a_certificate_is_refused_unless_everything_is_up_to_date() {
    let project = published();
    let refused = |project: &Project, why: &str| {
        let said = project.run(&["certificate"]);
        assert!(said.refusal().contains(why), "{why}: {said:?}");
        assert!(!project.path("codecheck").exists());
    };
    refused(&project, "of 8 tasks are not up to date (solve/a/signed/r=10 stale: first run)");
    project.run(&["run"]).lines();
    project.scene("a", &(wanting(EVERYTHING).replace("else=-1", "else=-2") + "paper_table = 1\n"));
    refused(&project, "do `signorini run` first");
    project.scene("a", &(wanting(EVERYTHING) + "paper_table = 1\n"));
    let figure = fs::read(project.path("figures/figure1.svg")).unwrap();
    project.write("figures/figure1.svg", "<svg>mine</svg>");
    refused(&project, "figures/figure1.svg was edited by hand");
    fs::remove_file(project.path("figures/figure1.svg")).unwrap();
    refused(&project, "files in figures/ or report/ are missing or old");
    project.write("figures/figure1.svg", figure);
    let lock = fs::read_to_string(project.path("pipeline/lock.toml")).unwrap();
    project.write("pipeline/lock.toml", lock.replace("[exports]", "\"more\" = \"0\"\n[exports]"));
    refused(&project, "pipeline/lock.toml differs from this run in 1 hashes (more: 0 -> absent)");
    project.write("pipeline/lock.toml", lock);
    let said = project.run(&["certificate", "--output", "nowhere/new"]);
    assert!(said.refusal().contains("--output nowhere: no such folder; make it with `mkdir"));
    let said = project.run(&["certificate", "--output", "report"]);
    assert!(said.refusal().contains("the certificate would lie in report/"), "{said:?}");
    fs::create_dir(project.path("here")).unwrap();
    project.run(&["certificate", "--output", "here"]).lines();
    assert!(project.path("here/codecheck.yml").exists() && !project.path("codecheck").exists());
}

#[test]
fn a_run_without_a_published_table_has_a_record_without_a_manifest() {
    let project = published();
    project.run(&["run"]).lines();
    project.run(&["certificate"]).lines();
    project.scene("a", TABLE);
    project.run(&["run"]).lines();
    fs::remove_dir_all(project.path("codecheck")).unwrap();
    let said = project.run(&["certificate"]);
    assert_eq!(said.lines(), ["codecheck/certificate.md", "codecheck/ro-crate-metadata.json"]);
    let files = project.files("codecheck");
    let wanted = [
        "certificate.md",
        "inputs/pipeline/paper.toml",
        "inputs/pipeline/scenes/a.toml",
        "ro-crate-metadata.json",
        "tables/a.csv",
    ];
    assert_eq!(files.keys().collect::<Vec<_>>(), wanted);
    for name in ["certificate.md", "ro-crate-metadata.json"] {
        let text = str::from_utf8(&files[name]).unwrap();
        assert!(text.contains("Scenes: a. No published table is compared."), "{text}");
        assert!(!text.contains("Maksimova") && !text.contains("signorini diff"), "{text}");
    }
    assert!(project.run(&["diff"]).refusal().contains("no scene has a `paper_table`"));
}
