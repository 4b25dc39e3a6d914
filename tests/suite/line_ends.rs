//! Line ends that git changes where a system or a setting asks it to.

use crate::common::{Project, Said, TABLE};
use std::fs;
use std::process::Command;

fn git(place: &Project, folder: &str, args: &[&str]) {
    let mut git = Command::new("git");
    git.args(["-c", "user.name=x", "-c", "user.email=x@example.org", "-c", "commit.gpgsign=false"]);
    git.args(["-c", "protocol.file.allow=always"]).args(args).current_dir(place.path(folder));
    for file in ["GIT_CONFIG_GLOBAL", "GIT_CONFIG_SYSTEM"] {
        git.env(file, "/dev/null");
    }
    assert!(git.output().unwrap().status.success(), "{args:?}");
}

fn run(place: &Project, folder: &str, args: &[&str]) -> Said {
    place.command(args).current_dir(place.path(folder)).output().unwrap().into()
}

#[test]
fn a_clone_of_a_study_runs_where_git_changes_line_ends() {
    let place = Project::with(TABLE);
    place.run(&["init", "study"]).lines();
    run(&place, "study", &["run"]).lines();
    git(&place, "study", &["init", "-q"]);
    git(&place, "study", &["add", "-A"]);
    git(&place, "study", &["commit", "-qm", "all"]);
    git(&place, ".", &["clone", "-q", "-c", "core.autocrlf=true", "study", "clone"]);
    run(&place, "clone", &["run", "--locked"]).lines();
    // As a study begun by an older program has it: the message names what happened, and a remedy that works.
    git(&place, "study", &["rm", "-q", ".gitattributes"]);
    git(&place, "study", &["commit", "-qm", "none"]);
    git(&place, ".", &["clone", "-q", "-c", "core.autocrlf=true", "study", "changed"]);
    let lock = fs::read(place.path("changed/pipeline/lock.toml")).unwrap();
    for args in [&["run"][..], &["run", "--locked"], &["run", "disc"]] {
        let said = run(&place, "changed", args);
        let line = said.refusal();
        assert!(
            line.contains("other line ends than signorini wrote")
                && line.contains("figures/disc-surface.svg")
                && line.contains("core.autocrlf=false"),
            "{args:?}: {line}"
        );
        assert_eq!(fs::read(place.path("changed/pipeline/lock.toml")).unwrap(), lock, "{args:?}");
    }
    git(&place, ".", &["clone", "-q", "-c", "core.autocrlf=false", "study", "again"]);
    run(&place, "again", &["run", "--locked"]).lines();
}

#[test]
fn a_text_edited_beside_its_line_ends_was_edited() {
    let project = Project::with(&TABLE.replace("\"table\"", "\"source\""));
    project.run(&["run"]).lines();
    let svg = fs::read_to_string(project.path("figures/a-source.svg")).unwrap();
    let changed = svg.replace('\n', "\r\n");
    project.write("figures/a-source.svg", &changed);
    let said = project.run(&["run"]);
    assert!(said.refusal().contains("a-source.svg has other line ends"), "{said:?}");
    project.write("figures/a-source.svg", changed.replacen("<svg", "<svg data-mine=\"1\"", 1));
    assert!(project.run(&["run"]).refusal().contains("was edited by hand"));
}
