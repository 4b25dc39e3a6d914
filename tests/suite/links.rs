//! Files that the program writes by way of links, and their permissions.
#![cfg(unix)]

use crate::common::{Project, TABLE, wanting};
use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};

/// Solves a small problem into a file of the project.
fn solve_to(project: &Project, file: &str) -> crate::common::Said {
    project.run(&["solve", "--f", "disc(0,0,0.2)=4; else=-1", "--h", "1/8", "--out", file])
}

#[test]
fn a_file_keeps_its_permissions_and_a_hard_link_its_bytes() {
    let project = Project::with(TABLE);
    for mode in [0o600, 0o640, 0o666] {
        project.write("v.svg", "old");
        fs::set_permissions(project.path("v.svg"), fs::Permissions::from_mode(mode)).unwrap();
        let _ = fs::remove_file(project.path("other.svg"));
        fs::hard_link(project.path("v.svg"), project.path("other.svg")).unwrap();
        solve_to(&project, "v.svg").lines();
        let kept = fs::metadata(project.path("v.svg")).unwrap().mode() & 0o777;
        assert_eq!(kept, mode, "{kept:o}");
        assert_eq!(fs::read(project.path("other.svg")).unwrap(), b"old");
    }
}

#[test]
fn exports_and_the_lock_file_may_be_links() {
    let project = Project::with(&wanting("[\"table\", \"source\"]"));
    project.run(&["run"]).lines();
    fs::create_dir(project.path("shared")).unwrap();
    let files = ["figures/a-source.svg", "pipeline/lock.toml"];
    for file in files {
        let real = project.path("shared").join(file.replace('/', "-"));
        fs::rename(project.path(file), &real).unwrap();
        fs::set_permissions(&real, fs::Permissions::from_mode(0o600)).unwrap();
        symlink(&real, project.path(file)).unwrap();
    }
    let before = files.map(|file| fs::read(project.path(file)).unwrap());
    project.scene("a", &wanting("[\"table\", \"source\"]").replace("else=-1", "else=-2"));
    project.run(&["run"]).lines();
    for (file, before) in files.into_iter().zip(before) {
        assert!(fs::symlink_metadata(project.path(file)).unwrap().is_symlink(), "{file}");
        assert_ne!(fs::read(project.path(file)).unwrap(), before, "{file}");
        assert_eq!(fs::metadata(project.path(file)).unwrap().mode() & 0o777, 0o600, "{file}");
    }
}
