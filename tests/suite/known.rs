//! Hashes of files that have not changed: believed, so that nothing is read, and never where a file was changed.

use crate::common::{EVERYTHING, Project, wanting};
use std::fs::{self, File};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

const NOTES: &str = "pipeline/.hashes";

/// A project of two pages and all figures, up to date, with the files that only their hashes tell: an input, a copy in
/// the project, and an artifact.
fn project() -> (Project, [PathBuf; 3]) {
    let project = Project::with(&wanting(EVERYTHING));
    project.add_book("# One\n");
    project.run(&["run"]).lines();
    let objects = project.path(".signorini/v2/objects");
    let object = project.files(".signorini/v2/objects").into_keys().next().unwrap();
    let files = ["report/templates/one.md", "figures/a-source.svg"].map(|path| project.path(path));
    let [input, copy] = files;
    (project, [input, copy, objects.join(object)])
}

/// Changes the last letter of a file in place.
fn edit(file: &Path) {
    let bytes = fs::read(file).unwrap();
    let at = bytes.iter().rposition(u8::is_ascii_alphabetic).unwrap();
    let open = File::options().write(true).open(file).unwrap();
    open.write_all_at(&[bytes[at] ^ 1], at as u64).unwrap();
}

/// Changes a file, but neither its size nor its date.
fn edit_unseen(file: &Path) {
    let before = fs::metadata(file).unwrap().modified().unwrap();
    edit(file);
    File::options().write(true).open(file).unwrap().set_modified(before).unwrap();
}

/// Replaces a file by another of the same size and date.
fn replace(file: &Path) {
    let other = file.with_extension("other");
    fs::copy(file, &other).unwrap();
    edit(&other);
    let before = fs::metadata(file).unwrap().modified().unwrap();
    File::options().write(true).open(&other).unwrap().set_modified(before).unwrap();
    fs::rename(other, file).unwrap();
}

fn truncate(file: &Path) {
    File::options().write(true).open(file).unwrap().set_len(3).unwrap();
}

#[test]
fn a_change_is_noticed_whatever_it_leaves_as_it_was() {
    let (project, files) = project();
    let stale =
        |more: &[&str]| project.run(&[&["status", "--exit-code"], more].concat()).code == Some(1);
    for file in &files {
        let right = fs::read(file).unwrap();
        for (k, change) in [edit, edit_unseen, replace, truncate].into_iter().enumerate() {
            assert!(!stale(&[]), "{k} {}", file.display());
            change(file);
            assert!(stale(&[]) && stale(&["--verify"]), "{k} {}", file.display());
            fs::write(file, &right).unwrap();
            project.run(&["run"]).nothing_to_do();
        }
    }
    // A task that runs alone notices it too.
    edit_unseen(&files[2]);
    let status = project.run(&["status", "--json"]).json();
    let mut tasks = status["tasks"].as_object().unwrap().iter();
    let (id, _) = tasks.find(|(_, verdict)| verdict["state"] == "stale").unwrap();
    assert_eq!(project.run(&["run", "-v", "--task", id]).ran(), [id]);
    project.run(&["run"]).nothing_to_do();
}

#[test]
fn what_is_noted_is_believed_unless_all_is_to_be_read() {
    let (project, _) = project();
    let notes = fs::read(project.path(NOTES)).unwrap();
    let times = project.times();
    project.run(&["run"]).nothing_to_do();
    assert_eq!(project.times(), times);
    // Notes with another hash of an artifact, and the seal of these notes.
    let raw = |hash: &str| -> Vec<u8> {
        (0..hash.len())
            .step_by(2)
            .map(|k| u8::from_str_radix(&hash[k..k + 2], 16).unwrap())
            .collect()
    };
    // One that is no copy too.
    let hashes = project.files(".signorini/v2/objects").into_keys().map(|object| raw(&object[3..]));
    let places = |hash: Vec<u8>| -> Vec<usize> {
        (0..notes.len()).filter(|&at| notes[at..].starts_with(&hash)).collect()
    };
    let at = hashes.map(places).find(|places| places.len() == 1).expect("an artifact is noted")[0];
    let mut forged = notes[..notes.len() - 32].to_vec();
    forged[at] ^= 1;
    forged.extend(raw(&signorini::pipeline::hash(&forged)));
    project.write(NOTES, &forged);
    assert_eq!(project.run(&["status", "--exit-code"]).code, Some(1));
    for args in [&["status", "--verify", "--exit-code"][..], &["run", "--locked"]] {
        assert_eq!(project.run(args).code, Some(0), "{args:?}");
    }
    // A run that has something to do reads all, and notes it.
    project.write(NOTES, &forged);
    assert_eq!(project.run(&["run", "-v"]).ran(), [""; 0]);
    project.run(&["run"]).nothing_to_do();
    assert_eq!(project.run(&["status", "--exit-code"]).code, Some(0));
}

#[test]
fn without_notes_nothing_runs_again() {
    let (project, _) = project();
    for damage in [None, Some(&b"half"[..]), Some(b"")] {
        match damage {
            None => fs::remove_file(project.path(NOTES)).unwrap(),
            Some(bytes) => project.write(NOTES, bytes),
        }
        project.run(&["run"]).nothing_to_do();
        assert!(project.path(NOTES).metadata().unwrap().len() > 1000, "noted again");
    }
    // Files that were written again as they were: noted again as well.
    let before = fs::read(project.path(NOTES)).unwrap();
    let page = project.path("report/templates/one.md");
    fs::write(&page, fs::read(&page).unwrap()).unwrap();
    project.run(&["run"]).nothing_to_do();
    assert_ne!(fs::read(project.path(NOTES)).unwrap(), before);
}
