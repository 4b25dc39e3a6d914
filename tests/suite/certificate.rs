//! Which commit a certificate names, and of which files it says that they are that commit's: what git says, wherever
//! the project lies.

use crate::common::{EVERYTHING, Project, Said, absent, files_below, wanting};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// A folder with a finished run in its folder `study`, whose inputs are a scene and the published values.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        let project = Project::with(&(wanting(EVERYTHING) + "paper_table = 1\n"));
        copy(&project.path("."), &place.path("study"));
        place.signorini("study", &["run"], &[]).lines();
        place
    }

    fn path(&self, path: &str) -> PathBuf {
        self.0.path().join(path)
    }

    fn signorini(&self, folder: &str, args: &[&str], env: &[(&str, &str)]) -> Said {
        let mut command = Command::new(env!("CARGO_BIN_EXE_signorini"));
        command.args(args).current_dir(self.path(folder));
        command.envs(env.iter().copied()).output().unwrap().into()
    }

    /// The page of a certificate for the project in `folder`, and what is said on standard error.
    fn certificate(&self, folder: &str, env: &[(&str, &str)]) -> (String, String) {
        let _ = fs::remove_dir_all(self.path(folder).join("codecheck"));
        let said = self.signorini(folder, &["certificate"], env);
        said.lines();
        let page = fs::read_to_string(self.path(folder).join("codecheck/certificate.md")).unwrap();
        (page, said.err)
    }

    /// Output of git in `folder`, with settings of its own.
    fn git(&self, folder: &str, args: &[&str]) -> String {
        let mut git = Command::new("git");
        git.args([
            "-c",
            "user.name=x",
            "-c",
            "user.email=x@example.org",
            "-c",
            "commit.gpgsign=false",
        ]);
        git.args(["-c", "init.defaultBranch=main", "-c", "protocol.file.allow=always"]);
        git.args(args).current_dir(self.path(folder));
        for file in ["GIT_CONFIG_GLOBAL", "GIT_CONFIG_SYSTEM"] {
            git.env(file, "/dev/null");
        }
        // A hook that runs these tests names a repository, in which nothing is to be changed.
        for name in
            ["GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_OBJECT_DIRECTORY", "GIT_PREFIX"]
        {
            git.env_remove(name);
        }
        let said = git.output().unwrap();
        assert!(said.status.success(), "{args:?}: {said:?}");
        String::from_utf8(said.stdout).unwrap().trim().to_owned()
    }

    /// Makes a repository of `folder` with all its files but a cache in one commit; the commit.
    fn repository(&self, folder: &str) -> String {
        fs::write(self.path(folder).join(".gitignore"), ".signorini\ncodecheck\n**/pipeline/.*\n")
            .unwrap();
        self.git(folder, &["init", "-q"]);
        self.commit(folder)
    }

    fn commit(&self, folder: &str) -> String {
        self.git(folder, &["add", "-A"]);
        self.git(folder, &["commit", "-qm", "all"]);
        self.git(folder, &["rev-parse", "HEAD"])
    }

    fn edit_and_run(&self, folder: &str) {
        let scene = self.path(folder).join("pipeline/scenes/a.toml");
        let text = fs::read_to_string(&scene).unwrap();
        fs::write(&scene, text.replace("else=-1", "else=-2")).unwrap();
        self.signorini(folder, &["run"], &[]).lines();
    }
}

fn copy(from: &Path, to: &Path) {
    assert!(Command::new("cp").arg("-R").arg(from).arg(to).status().unwrap().success());
}

#[track_caller]
fn assert_says(page: &str, parts: &[&str]) {
    parts.iter().for_each(|part| assert!(page.contains(part), "{part} is not in {page}"));
    assert!(!page.contains("authors'"), "{page}");
}

/// What a page says of a whole project in a commit of its repository, in which it is this folder.
fn whole(folder: &str, commit: &str) -> [String; 3] {
    let folder = match folder {
        "" => String::new(),
        folder => format!(", in which it is the folder `{folder}`"),
    };
    [
        format!(
            "checked out from commit `{commit}` of its git repository{folder}, without changes"
        ),
        "Of the 2 inputs, all are as in this commit.".into(),
        format!(", which is the one in commit `{commit}`."),
    ]
}

#[track_caller]
fn assert_whole((page, warnings): (String, String), folder: &str, commit: &str) {
    let parts = whole(folder, commit);
    assert_says(&page, &parts.each_ref().map(String::as_str));
    assert!(!warnings.contains("warning"), "{warnings}");
}

#[test]
fn a_certificate_says_which_files_are_those_of_the_commit() {
    let place = Place::new();
    let first = place.repository("study");
    assert_whole(place.certificate("study", &[]), "", &first);
    place.edit_and_run("study");
    let edited = |page: &str| {
        let lock = format!("is **not** the one in commit `{first}`");
        assert_says(page, &["with changes to files", "**1** are as in this commit", &lock]);
    };
    edited(&place.certificate("study", &[]).0);
    // Git itself may be told not to look.
    let files = ["pipeline/lock.toml", "pipeline/scenes/a.toml"];
    for flag in ["--assume-unchanged", "--skip-worktree"] {
        place.git("study", &["update-index", flag, files[0], files[1]]);
        let page = place.certificate("study", &[]).0;
        let lock = format!("is **not** the one in commit `{first}`");
        assert_says(&page, &["**1** are as in this commit", &lock]);
        place.git("study", &["update-index", &flag.replace("--", "--no-"), files[0], files[1]]);
    }
    place.git("study", &["add", "-A"]);
    edited(&place.certificate("study", &[]).0);
    // The reader's own commit is as good as another; whose it is cannot be known.
    let own = place.commit("study");
    assert_whole(place.certificate("study", &[]), "", &own);
    place.git("study", &["checkout", "-q", "--detach"]);
    assert_whole(place.certificate("study", &[]), "", &own);
    place.git("study", &["rm", "-q", "--cached", "pipeline/lock.toml"]);
    place.git("study", &["commit", "-qm", "without"]);
    let without = place.git("study", &["rev-parse", "HEAD"]);
    let page = place.certificate("study", &[]).0;
    assert_says(
        &page,
        &["all are as in this commit", &format!(", which commit `{without}` does **not** have.")],
    );
    let yaml = fs::read_to_string(place.path("study/codecheck/codecheck.yml")).unwrap();
    assert_says(
        &yaml,
        &[
            &format!("    commit: \"{without}\"\n"),
            "    inputs_as_committed: \"2 of 2\"\n",
            "    lock_file: \"absent\"\n",
        ],
    );
}

#[test]
fn a_foreign_repository_around_the_project_is_not_taken_for_its_own() {
    let place = Place::new();
    fs::write(place.path(".gitignore"), "*\n").unwrap();
    place.git(".", &["init", "-q"]);
    place.git(".", &["add", "-f", ".gitignore"]);
    place.git(".", &["commit", "-qm", "settings"]);
    let foreign = place.git(".", &["rev-parse", "HEAD"]);
    for _ in 0..2 {
        let page = place.certificate("study", &[]).0;
        assert_says(
            &page,
            &[
                "**0** are as in this commit",
                &format!(", which commit `{foreign}` does **not** have."),
            ],
        );
        place.edit_and_run("study");
    }
    // Nor one that hooks name.
    copy(&place.path("study"), &place.path("other"));
    let own = place.repository("study");
    let hook = [("GIT_DIR", place.path(".git")), ("GIT_WORK_TREE", place.path("."))];
    let hook = hook.each_ref().map(|(name, path)| (*name, path.to_str().unwrap()));
    let index = [("GIT_INDEX_FILE", "/nonexistent"), ("GIT_PREFIX", "study/")];
    for env in [&hook[..1], &hook, &index] {
        assert_whole(place.certificate("study", env), "", &own);
    }
}

#[test]
fn projects_in_folders_work_trees_and_submodules_have_their_commit() {
    let place = Place::new();
    // In a folder of the user's repository, where others may have changed.
    fs::write(place.path("thesis.tex"), "one").unwrap();
    let outer = place.repository(".");
    fs::write(place.path("thesis.tex"), "two").unwrap();
    assert_whole(place.certificate("study", &[]), "study", &outer);
    place.git(".", &["worktree", "add", "-q", "--detach", "tree"]);
    place.signorini("tree/study", &["run"], &[]).lines();
    assert_whole(place.certificate("tree/study", &[]), "study", &outer);
    copy(&place.path("study"), &place.path("inner"));
    let inner = place.repository("inner");
    fs::create_dir(place.path("super")).unwrap();
    place.git("super", &["init", "-q"]);
    place.git("super", &["submodule", "--quiet", "add", "../inner", "sub"]);
    place.commit("super");
    place.signorini("super/sub", &["run"], &[]).lines();
    assert_whole(place.certificate("super/sub", &[]), "", &inner);
}

#[test]
fn where_git_names_no_commit_the_certificate_says_why() {
    let place = Place::new();
    let refused = |env: &[(&str, &str)], why: &str| {
        let (page, said) = place.certificate("study", env);
        assert_says(&page, &[&format!("No commit can be named: {why}")]);
        assert!(!page.contains("in commit") && !page.contains("checked out"), "{page}");
        let warning = format!("warning: the certificate names no commit: {why}");
        assert!(said.lines().last().is_some_and(|line| line.starts_with(&warning)), "{said}");
        let yaml = fs::read_to_string(place.path("study/codecheck/codecheck.yml")).unwrap();
        assert!(yaml.contains(&format!("  no_checkout: \"{why}")), "{yaml}");
        let here = place.path("").canonicalize().unwrap().display().to_string();
        assert!(!page.contains(&here) && !yaml.contains(&here), "{page}{yaml}");
    };
    refused(&[], "git refuses: not a git repository");
    refused(&[("PATH", "")], "git cannot be started (");
    place.git("study", &["init", "-q"]);
    refused(&[], "the repository has no commit yet");
    place.repository("study");
    refused(&[("PATH", "/nonexistent")], "git cannot be started (");
    let owner = Command::new("chown").args(["-R", "12345"]).arg(place.path("study")).output();
    if !owner.is_ok_and(|said| said.status.success()) {
        return absent("chown gives no folder to another owner");
    }
    refused(
        &[("HOME", "/nonexistent")],
        "git refuses: detected dubious ownership in repository at",
    );
    // Settings in the environment are settings, and a trace is no reason.
    let own = fs::read_to_string(place.path("study/.git/refs/heads/main")).unwrap();
    let settings = [
        ("HOME", "/nonexistent"),
        ("GIT_CONFIG_COUNT", "1"),
        ("GIT_CONFIG_KEY_0", "safe.directory"),
        ("GIT_CONFIG_VALUE_0", "*"),
        ("GIT_TRACE", "1"),
    ];
    assert_whole(place.certificate("study", &settings), "", own.trim());
    let traced = [("HOME", "/nonexistent"), ("GIT_TRACE", "1")];
    refused(&traced, "git refuses: detected dubious ownership in repository at");
}

#[test]
fn what_leaves_the_machine_names_no_place_on_it() {
    let place = Place::new();
    let telling = "home-of-a-person";
    copy(&place.path("study"), &place.path(telling));
    place.repository(telling);
    place.edit_and_run(telling);
    place.certificate(telling, &[]);
    let mut files = files_below(&place.path(telling).join("codecheck"));
    for folder in ["pipeline", "figures", "report"] {
        for (name, bytes) in files_below(&place.path(telling).join(folder)) {
            files.insert(format!("../{folder}/{name}"), bytes);
        }
    }
    assert!(files.contains_key("ro-crate-metadata.json") && files.contains_key("codecheck.yml"));
    let root = place.path("").display().to_string();
    for (name, bytes) in files {
        let text = String::from_utf8_lossy(&bytes);
        for part in [telling, root.trim_end_matches('/')] {
            assert!(!text.contains(part), "{name} has {part}");
        }
    }
    let workflow = place.signorini(telling, &["dag", "--snakemake"], &[]);
    assert!(!workflow.out.contains(telling), "{workflow:?}");
}
