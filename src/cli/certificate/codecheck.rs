//! `codecheck.yml`: the check as the CODECHECK configuration file, version 1.0, describes it.

use super::yaml::Yaml;
use super::{AUTHOR, Check, TITLE};

const VERSION: &str = "https://codecheck.org.uk/spec/config/1.0";

/// The manifest of the files in the bundle, and what is to be known about the check.
pub(super) fn manifest(check: &Check) -> String {
    let file = |one: &super::File| {
        Yaml::Map(vec![
            ("file", Yaml::text(&one.path)),
            ("comment", Yaml::text(format!("{}; blake3 {}", one.comment, one.hash))),
        ])
    };
    let mut codechecker = vec![("name", Yaml::text(&check.codechecker))];
    codechecker.extend(check.orcid.iter().map(|orcid| ("ORCID", Yaml::text(orcid))));
    let pair = |(key, value): &(&'static str, String)| (*key, Yaml::text(value));
    let mut program = vec![("version", Yaml::text(env!("CARGO_PKG_VERSION")))];
    program.push(("compiler", Yaml::text(super::COMPILER)));
    program.extend(check.commit.iter().map(|commit| ("commit", Yaml::text(commit))));
    program.push(("lock_file_blake3", Yaml::text(&check.lock_hash)));
    program.push(("commands", Yaml::List(super::COMMANDS.map(|(c, _)| Yaml::text(c)).into())));
    Yaml::Map(vec![
        ("version", Yaml::text(VERSION)),
        ("manifest", Yaml::List(check.files.iter().map(file).collect())),
        (
            "paper",
            Yaml::Map(vec![
                ("title", Yaml::text(TITLE)),
                ("authors", Yaml::List(vec![Yaml::Map(vec![("name", Yaml::text(AUTHOR))])])),
                ("reference", Yaml::text(super::REFERENCE)),
            ]),
        ),
        ("codechecker", Yaml::List(vec![Yaml::Map(codechecker)])),
        ("report", Yaml::text("certificate.md in this folder; not published yet")),
        ("summary", Yaml::text(super::page::summary(check))),
        ("repository", Yaml::text(&check.repository)),
        ("check_time", Yaml::text(&check.time)),
        ("certificate", Yaml::text("not assigned")),
        // Nodes of our own, under one parent as the specification asks.
        (
            "signorini",
            Yaml::Map(vec![
                ("program", Yaml::Map(program)),
                ("machine", Yaml::Map(check.machine.iter().map(pair).collect())),
            ]),
        ),
    ])
    .document()
}
