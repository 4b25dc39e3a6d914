//! Where runs write and remove: nowhere outside of the project by way of links, and never over what others wrote.
#![cfg(unix)]

use crate::common::{Project, Said, wanting};
use std::fs;
use std::os::unix::fs::symlink;

/// A project beside an empty folder `home`, both in one temporary folder.
struct Beside {
    folder: Project,
    project: Project,
}

impl Beside {
    /// The project with a scene with these outputs, and a book of one page.
    fn with(outputs: &str) -> Self {
        let (folder, project) = (Project::empty(), Project::with(&wanting(outputs)));
        fs::create_dir(folder.path("home")).unwrap();
        project.add_book("# One\n");
        Self { folder, project }
    }

    /// Names of the files outside of the project.
    fn outside(&self) -> Vec<String> {
        self.folder.files("home").into_keys().collect()
    }

    /// Puts a link to this path of the folder `home` in the place of a file or folder of the project.
    fn lead(&self, path: &str, to: &str) {
        symlink(self.folder.path("home").join(to), self.project.path(path)).unwrap();
    }

    fn run(&self, args: &[&str]) -> Said {
        self.project.run(args)
    }
}

#[test]
fn no_link_leads_to_a_file_that_is_removed() {
    let beside = Beside::with("[\"source\"]");
    beside.run(&["run"]).lines();
    let (record, figure) = ("pipeline/.exported.json", "figures/a-source.svg");
    let bytes = fs::read(beside.project.path(figure)).unwrap();
    fs::write(beside.folder.path("home/v.svg"), &bytes).unwrap();
    fs::create_dir(beside.project.path("notes")).unwrap();
    beside.project.write("notes/v.svg", &bytes);
    fs::create_dir(beside.project.path("figures/sub")).unwrap();
    beside.lead("figures/sub/out", "");
    symlink("../../notes", beside.project.path("figures/sub/in")).unwrap();
    // Somebody has edited the record.
    let text = fs::read_to_string(beside.project.path(record)).unwrap();
    let line = text.lines().find(|line| line.contains(figure)).unwrap();
    let hashes = text.split_once(line).unwrap().1.split_once(']').unwrap().0;
    let added: String = [
        "figures/sub/out/v.svg",
        "figures/sub/in/v.svg",
        "figures/old.svg",
        "report/templates/v.bak",
    ]
    .map(|path| format!("{}{hashes}],", line.replace(figure, path)))
    .concat();
    beside.project.write(record, text.replace(line, &format!("{added}{line}")));
    beside.project.write("figures/old.svg", &bytes);
    // No task reads a backup.
    beside.project.write("report/templates/v.bak", &bytes);
    beside.run(&["run"]).lines();
    assert!(!beside.project.path("figures/old.svg").exists(), "what the record rightly names");
    assert_eq!(beside.outside(), ["v.svg"]);
    assert!(beside.project.path("notes/v.svg").exists());
    assert!(beside.project.path("report/templates/v.bak").exists());
}
