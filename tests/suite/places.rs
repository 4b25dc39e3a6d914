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
fn no_link_leads_a_run_out_of_the_project() {
    for folder in ["report/book", "report/src", "report/tables", "figures"] {
        let beside = Beside::with("[\"table\", \"source\"]");
        beside.lead(folder, "");
        for args in [&["run"][..], &["run", "-n"], &["run", "--force"]] {
            let said = beside.run(args);
            assert!(said.refusal().contains("out of the project"), "{folder}: {said:?}");
        }
        assert!(!beside.project.path(".signorini").exists(), "{folder}: told before any work");
        assert_eq!(beside.outside(), [""; 0], "{folder}");
    }
    // A file, and the files that the program keeps for itself.
    for file in ["figures/a-source.svg", "pipeline/lock.toml", "pipeline/.exported.json"] {
        let beside = Beside::with("[\"source\"]");
        beside.run(&["run"]).lines();
        fs::rename(beside.project.path(file), beside.folder.path("home/kept")).unwrap();
        beside.lead(file, "kept");
        beside.project.scene("a", &wanting("[\"source\"]").replace("else=-1", "else=-2"));
        let before = beside.folder.files("home");
        let said = beside.run(&["run"]);
        assert!(said.refusal().contains("out of the project"), "{file}: {said:?}");
        assert!(beside.folder.files("home") == before, "{file}");
    }
    let beside = Beside::with("[\"table\"]");
    beside.lead(".signorini", "");
    assert!(beside.run(&["run"]).refusal().contains("the cache: a link leads out of the project"));
    assert_eq!(beside.outside(), [""; 0]);
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

#[test]
fn force_overwrites_files_but_nothing_to_which_a_link_leads() {
    let beside = Beside::with("[\"source\"]");
    beside.run(&["run"]).lines();
    let (figure, scene) = ("figures/a-source.svg", "pipeline/scenes/a.toml");
    let [mine, kept] = [figure, scene].map(|path| fs::read(beside.project.path(path)).unwrap());
    beside.project.write("notes.txt", "mine");
    for target in ["../pipeline/scenes/a.toml", "../notes.txt", "../report/templates/one.md"] {
        fs::remove_file(beside.project.path(figure)).unwrap();
        symlink(target, beside.project.path(figure)).unwrap();
        for args in [&["run"][..], &["run", "-n"], &["run", "--force"], &["run", "-f", "-n"]] {
            beside.run(args).refusal();
        }
        assert_eq!(fs::read(beside.project.path(scene)).unwrap(), kept, "{target}");
        assert_eq!(fs::read(beside.project.path("notes.txt")).unwrap(), b"mine", "{target}");
        assert_eq!(fs::read(beside.project.path("report/templates/one.md")).unwrap(), b"# One\n");
    }
    fs::remove_file(beside.project.path(figure)).unwrap();
    beside.project.write(figure, "edited");
    beside.run(&["run"]).refusal();
    beside.run(&["run", "--force"]).lines();
    assert_eq!(fs::read(beside.project.path(figure)).unwrap(), mine);
}

#[test]
fn files_that_the_user_names_stay_in_the_project_and_replace_no_input() {
    let beside = Beside::with("[\"table\"]");
    fs::write(beside.folder.path("home/kept.svg"), "kept").unwrap();
    beside.lead("out", "");
    beside.lead("v.svg", "kept.svg");
    symlink("pipeline/scenes/a.toml", beside.project.path("w.svg")).unwrap();
    symlink("report/templates/one.md", beside.project.path("t.csv")).unwrap();
    let before = beside.project.files("");
    let solve = ["solve", "--f", "disc(0,0,0.2)=4; else=-1"];
    for (option, file) in [
        ("--out", "out/v.svg"),
        ("--out", "v.svg"),
        ("--out", "w.svg"),
        ("--out", "pipeline/scenes/v.svg"),
        ("--csv", "out/t.csv"),
        ("--csv", "t.csv"),
        ("--csv", "pipeline/t.csv"),
    ] {
        let more: &[&str] = if option == "--csv" { &["--vary", "h=4"] } else { &["--h", "4"] };
        beside.run(&[&solve[..], more, &[option, file]].concat()).refusal();
    }
    assert!(beside.project.files("") == before);
    // Who names the place itself means it.
    let named = beside.folder.path("home/v.svg");
    beside.run(&[&solve[..], &["--h", "4", "--out", named.to_str().unwrap()]].concat()).lines();
    assert_eq!(beside.outside(), ["kept.svg", "v.svg"]);
    fs::remove_file(named).unwrap();
    beside.lead("pipeline/scenes/b.toml", "b.toml");
    beside.run(&[&solve[..], &["--save", "b"]].concat()).refusal();
    fs::remove_file(beside.project.path("pipeline/scenes/b.toml")).unwrap();
    fs::create_dir(beside.folder.path("home/empty")).unwrap();
    beside.lead("codecheck", "empty");
    beside.run(&["run"]).lines();
    assert!(beside.run(&["certificate"]).refusal().contains("out of the project"));
    fs::create_dir(beside.folder.path("new")).unwrap();
    for (link, to) in [("new/pipeline", "home/empty"), ("new/.gitignore", "home/kept.svg")] {
        symlink(beside.folder.path(to), beside.folder.path(link)).unwrap();
        beside.folder.run(&["init", "new"]).refusal();
        fs::remove_file(beside.folder.path(link)).unwrap();
    }
    assert_eq!(beside.outside(), ["kept.svg"]);
    assert_eq!(fs::read(beside.folder.path("home/kept.svg")).unwrap(), b"kept");
    assert_eq!(beside.folder.files("new").len(), 0);
}

#[test]
fn an_edit_by_hand_is_told_before_any_work() {
    for edited in ["figures/a-source.svg", "report/src/one.md", "report/book/one.html"] {
        let project = Project::with(&wanting("[\"table\", \"source\"]"));
        project.add_book("# One\n");
        project.run(&["run"]).lines();
        project.write(edited, "mine");
        project.scene("a", &wanting("[\"table\", \"source\"]").replace("else=-1", "else=-2"));
        project.write("report/templates/one.md", "# One\n\nMore.\n");
        let cache = project.files(".signorini");
        for args in [&["run", "-n"][..], &["run"]] {
            let said = project.run(args);
            let wanted = format!("error: {edited} was edited by hand");
            assert!(said.refusal().starts_with(&wanted), "{said:?}");
        }
        let status = project.run(&["status"]);
        assert!(status.out.contains(&format!("{edited} was edited by hand")), "{status:?}");
        assert!(project.files(".signorini").keys().eq(cache.keys()), "nothing ran");
        // Also without a cache, of what is on record by its name.
        fs::remove_dir_all(project.path(".signorini")).unwrap();
        if !edited.contains("src") {
            assert!(project.run(&["run", "-n"]).refusal().contains(edited), "{edited}");
        }
    }
}

#[test]
fn force_goes_on_after_a_task_that_fails() {
    let project = Project::with(&wanting("[\"source\"]"));
    project.run(&["run"]).lines();
    project.write("figures/a-source.svg", "mine");
    // Of the tasks the first.
    let fails = "title = \"None\"\nf = \"quadrant(ll)=7; else=-2.34\"\ngrids = [8]\nload = { rule = \"nodal\" }\n\
        outputs = [\"table\"]\n";
    project.scene("0", fails);
    let said = project.run(&["run", "--force", "-j", "1"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert_ne!(fs::read(project.path("figures/a-source.svg")).unwrap(), b"mine", "{said:?}");
}

#[test]
fn gc_removes_nothing_to_which_a_link_leads() {
    let beside = Beside::with("[\"table\"]");
    beside.run(&["run"]).lines();
    let hash = "ab".repeat(32);
    for folder in ["home/objects/ab", "home/ab"] {
        fs::create_dir_all(beside.folder.path(folder)).unwrap();
        fs::write(beside.folder.path(folder).join(&hash), "mine").unwrap();
    }
    fs::create_dir(beside.project.path(".signorini/v3")).unwrap();
    for (link, to) in [("v0", ""), ("v3/objects", ""), ("v2/objects/cd", "ab")] {
        beside.lead(&format!(".signorini/{link}"), to);
    }
    beside.run(&["gc"]).lines();
    assert_eq!(beside.outside().len(), 2);
}
