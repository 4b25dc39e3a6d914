//! The folder of a certificate: it becomes the bundle, whatever is there, and loses nothing that is somebody else's.

use crate::common::{Dice, Project, Said, TABLE, assert_same, files_below};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A project with a published table, and a second scene of this name, after a run.
fn with_scene(name: &str) -> Project {
    let project = Project::with(&(TABLE.to_owned() + "paper_table = 1\n"));
    project.scene(name, &TABLE.replace("[\"table\"]", "[\"table\", \"source\", \"contact\"]"));
    project.run(&["run"]).lines();
    project
}

/// A folder for a bundle.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, path: &str) -> PathBuf {
        self.0.path().join(path)
    }

    fn files(&self) -> BTreeMap<String, Vec<u8>> {
        files_below(self.0.path())
    }

    /// Writes a file of somebody else.
    fn add(&self, path: &str) {
        let path = self.path(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, "mine").unwrap();
    }

    /// Writes the certificate of a project here, in place of what is here.
    fn certify(&self, project: &Project) -> Said {
        project
            .command(&["certificate", "--force", "--output"])
            .arg(self.0.path())
            .env("SOURCE_DATE_EPOCH", "1795245605")
            .output()
            .unwrap()
            .into()
    }
}

/// The bundle of a project in a folder that was empty.
fn bundle(project: &Project) -> BTreeMap<String, Vec<u8>> {
    let folder = Folder::new();
    folder.certify(project).lines();
    folder.files()
}

#[test]
fn what_left_the_run_leaves_the_bundle() {
    let (one, other) = (with_scene("one"), with_scene("other"));
    let folder = Folder::new();
    folder.certify(&one).lines();
    fs::create_dir_all(folder.path("inputs/pipeline/empty/folder")).unwrap();
    folder.certify(&other).lines();
    assert_same(&folder.files(), &bundle(&other));
    assert!(!folder.path("inputs/pipeline/empty").exists());
    // An edited file of an earlier bundle is named; the remedy works.
    for path in
        ["figures/other-source.svg", "inputs/pipeline/scenes/other.toml", "tables/table1.csv"]
    {
        let text = fs::read(folder.path(path)).unwrap();
        fs::write(folder.path(path), [&text[..], b"edited"].concat()).unwrap();
        let before = folder.files();
        let said = folder.certify(&one);
        assert!(said.refusal().contains(&format!("{path} is there already")), "{said:?}");
        assert_same(&folder.files(), &before);
        fs::remove_file(folder.path(path)).unwrap();
    }
    folder.certify(&one).lines();
    assert_same(&folder.files(), &bundle(&one));
}

#[test]
fn files_of_others_stay_and_are_no_inputs() {
    let (one, other) = (with_scene("one"), with_scene("other"));
    let folder = Folder::new();
    folder.certify(&one).lines();
    folder.add("notes.txt");
    folder.add("figures/mine.svg");
    let said = folder.certify(&other);
    assert!(said.code == Some(0) && said.err.contains("figures/mine.svg"), "{said:?}");
    let mut wanted = bundle(&other);
    for path in ["notes.txt", "figures/mine.svg"] {
        wanted.insert(path.into(), b"mine".to_vec());
    }
    assert_same(&folder.files(), &wanted);
    for (path, named) in [
        ("inputs/pipeline/scenes/mine.toml", "inputs/pipeline/scenes/mine.toml"),
        ("inputs/.signorini/v2/objects/00", "inputs/.signorini"),
    ] {
        folder.add(path);
        let said = folder.certify(&other);
        assert!(said.refusal().contains(&format!("{named} is none of the inputs")), "{said:?}");
        assert!(folder.path(path).exists());
        fs::remove_file(folder.path(path)).unwrap();
    }
    folder.certify(&one).lines();
}

#[test]
#[cfg(unix)]
fn links_in_the_folder_are_not_followed() {
    use std::os::unix::fs::symlink;
    let project = with_scene("one");
    let before = project.files("pipeline");
    for (link, target) in [
        ("inputs", project.path(".")),
        ("inputs/pipeline/more.toml", project.path("pipeline/paper.toml")),
        ("certificate.md", project.path("pipeline/paper.toml")),
        ("figures", project.path("figures")),
    ] {
        let folder = Folder::new();
        fs::create_dir_all(folder.path(link).parent().unwrap()).unwrap();
        symlink(target, folder.path(link)).unwrap();
        let said = folder.certify(&project);
        assert!(said.refusal().contains(&format!("{link} is ")), "{said:?}");
        assert_same(&project.files("pipeline"), &before);
        fs::remove_file(folder.path(link)).unwrap();
        folder.certify(&project).lines();
    }
}

#[test]
fn a_bundle_without_its_records_is_mended() {
    let (one, other) = (with_scene("one"), with_scene("one"));
    other.scene("a", &(TABLE.replace("else=-1", "else=-2") + "paper_table = 1\n"));
    other.run(&["run"]).lines();
    let (manifest, record) = ("codecheck.yml", "ro-crate-metadata.json");
    for lost in [&[manifest][..], &[record], &[manifest, record], &[manifest, "certificate.md"]] {
        let folder = Folder::new();
        folder.certify(&one).lines();
        lost.iter().for_each(|name| fs::remove_file(folder.path(name)).unwrap());
        folder.certify(&other).lines();
        assert_same(&folder.files(), &bundle(&other));
        // An emptied file is as good as none.
        lost.iter().for_each(|name| fs::write(folder.path(name), "").unwrap());
        folder.certify(&one).lines();
        assert_same(&folder.files(), &bundle(&one));
    }
    // Another's RO-Crate is another's.
    let folder = Folder::new();
    fs::write(folder.path(record), "{\"@graph\": []}").unwrap();
    assert!(folder.certify(&one).refusal().contains("ro-crate-metadata.json is there already"));
}

#[test]
fn a_certificate_killed_at_any_moment_can_be_repeated() {
    const KILLS: usize = 12;
    let projects = [with_scene("one"), with_scene("other")];
    let wanted = projects.each_ref().map(bundle);
    let folder = Folder::new();
    folder.certify(&projects[0]).lines();
    let mut dice = Dice(0x6b69_6c6c);
    let mut killed = 0;
    // However fast the machine is, attempts are left.
    for attempt in 0..20 * KILLS {
        if killed == KILLS {
            break;
        }
        let mut command =
            projects[(attempt + 1) % 2].command(&["certificate", "--force", "--output"]);
        command.arg(folder.0.path()).env("SOURCE_DATE_EPOCH", "1795245605");
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while child.try_wait().unwrap().is_none() && !is_at_work(folder.0.path()) {
            std::thread::yield_now();
        }
        let longest = 1 << dice.below(16);
        let until = Instant::now() + Duration::from_micros(dice.below(longest));
        while Instant::now() < until && is_at_work(folder.0.path()) {
            std::hint::spin_loop();
        }
        child.kill().unwrap();
        child.wait().unwrap();
        killed += usize::from(is_at_work(folder.0.path()));
        // By turns the same certificate again, and that of the other project.
        let next = (attempt / 2) % 2;
        folder.certify(&projects[next]).lines();
        assert_same(&folder.files(), &wanted[next]);
    }
    assert_eq!(killed, KILLS);
}

/// True while a certificate changes this folder, or after it was killed there.
fn is_at_work(folder: &Path) -> bool {
    let mut entries = fs::read_dir(folder).unwrap().flatten();
    entries.any(|entry| entry.file_name().to_string_lossy().starts_with(".signorini-"))
}
