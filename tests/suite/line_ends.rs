//! Line ends that git changes where a system or a setting asks it to.

use crate::common::{Project, Said, TABLE};
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
}
