//! A project folder: the scenes, published values and templates that a run reads, and where it writes.

use crate::pipeline::Artifacts;
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::{read_if_there, read_text, read_tree};
use crate::pipeline::names::{alike, is_left_behind, refuse_forbidden_name};
use crate::replication::paper::{PAPER, Paper};
use crate::replication::scene::Scene;
use crate::report;
use crate::timing::recorded::{self, Timings};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Path of the record of the searches for f in the project.
pub const IDENTIFIED: &str = "pipeline/identified.toml";

/// Path of the digits of true solutions in the project.
pub const TRUTH: &str = "pipeline/truth.toml";

/// A folder with `pipeline/scenes/`, read and validated.
#[derive(Debug)]
pub struct Project {
    /// The folder.
    pub root: PathBuf,
    /// All scenes, by name.
    pub scenes: Vec<Scene>,
    /// The published tables; none in a study of something else.
    pub paper: Paper,
    /// Contents of the files under `pipeline/`, by path in the project: scenes, and those that exist of the published
    /// tables, the digits of true solutions, and the records of the search and of times. The two records and the
    /// digits are not parsed yet.
    pub files: Artifacts,
    /// Contents of all files under `report/` that are not generated, by path in that folder.
    pub templates: Artifacts,
    /// True if only some scenes were read: then no task is planned that concerns several scenes.
    pub(crate) partial: bool,
    /// Returns the commands of the program, for the book: the `name` of each, empty for the program without a command,
    /// and its `help`. Empty unless the command line has set it.
    pub commands: fn() -> Vec<Value>,
}

impl Project {
    /// Returns the nearest project folder at or above `from`.
    pub(crate) fn find(from: &Path) -> Result<PathBuf> {
        from.ancestors()
            .find(|folder| folder.join("pipeline").join("scenes").is_dir())
            .map(Path::to_path_buf)
            .ok_or_else(|| {
                Error::input(format!(
                    "no pipeline/scenes in {} or above; run inside a clone of signorini, begin a study with `signorini init FOLDER`, or use `signorini solve --f ...`",
                    from.display()
                ))
            })
    }

    /// Reads the project in `root`.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Input`] from its parts.
    pub fn read(root: PathBuf) -> Result<Self> {
        let (scenes, mut files) = read_scenes(&root, |_| true)?;
        if scenes.is_empty() {
            let folder = root.join(SCENES);
            let folder = folder.display();
            return Err(Error::input(format!(
                "no scenes in {folder}; add one as the README shows"
            )));
        }
        for path in [PAPER, IDENTIFIED, TRUTH, recorded::PATH] {
            files.extend(read_if_there(&root.join(path))?.map(|text| (path.into(), text)));
        }
        let paper = files.get(PAPER).map(Paper::parse).transpose()?.unwrap_or_default();
        let report = root.join("report");
        // Git keeps no empty folder.
        let templates = match report.exists() || report.is_symlink() {
            true => read_tree(&report, is_excluded)
                .or_else(|(path, e)| Err(e).context("read", &path))?,
            false => Artifacts::new(),
        };
        for name in templates.keys() {
            refuse_forbidden_name("file", name)?;
        }
        Ok(Self { root, scenes, paper, files, templates, partial: false, commands: Vec::new })
    }

    /// Reads only the files that tasks of single scenes depend on, for the scenes with these names; names without a
    /// scene are ignored.
    ///
    /// # Errors
    /// As [`Project::read`], but neither for other scenes nor for the book.
    pub(crate) fn read_part(root: PathBuf, names: &[&str]) -> Result<Self> {
        let (scenes, mut files) = read_scenes(&root, |name| names.contains(&name))?;
        let mut paper = Paper::default();
        if scenes.iter().any(|scene| scene.paper_table.is_some()) {
            for path in [PAPER, IDENTIFIED] {
                files.extend(read_if_there(&root.join(path))?.map(|text| (path.into(), text)));
            }
            paper = files.get(PAPER).map(Paper::parse).transpose()?.unwrap_or_default();
        }
        let templates = Artifacts::new();
        Ok(Self { root, scenes, paper, files, templates, partial: true, commands: Vec::new })
    }

    /// Refuses a broken record of times, and settings of the book that name another folder for it. Not part of
    /// [`Project::read`]: a run that has nothing to do need not parse files that tasks of an earlier run have parsed.
    pub(crate) fn check(&self) -> Result<()> {
        if let Some(text) = self.files.get(recorded::PATH) {
            Timings::parse(text)?;
        }
        if let Some(text) = self.templates.get("book.toml") {
            report::check_settings(text)?;
        }
        Ok(())
    }

    /// Returns the scenes with these names, each once, or all if no name is given.
    pub(crate) fn select(&self, names: &[String]) -> Result<Vec<&Scene>> {
        for name in names {
            self.scene(name)?;
        }
        let mut selected: Vec<&Scene> = self.scenes.iter().collect();
        selected.retain(|scene| names.is_empty() || names.contains(&scene.name));
        Ok(selected)
    }

    /// Returns the scenes of the paper's problems 1 and 2, if they exist; the chapters are about them.
    pub(crate) fn problems(&self) -> Vec<&Scene> {
        let mut problems: Vec<_> = self.scenes.iter().filter(|scene| scene.is_problem()).collect();
        problems.sort_by_key(|scene| scene.paper_table);
        problems
    }

    /// Returns the scene with this name.
    ///
    /// # Errors
    /// [`Error::Unknown`] with the known names if there is none.
    pub fn scene(&self, name: &str) -> Result<&Scene> {
        self.scenes.iter().find(|scene| scene.name == name).ok_or_else(|| {
            let known: Vec<_> = self.scenes.iter().map(|scene| scene.name.as_str()).collect();
            Error::Unknown(format!("no scene `{name}`; there are: {}", known.join(", ")))
        })
    }
}

/// Files and folders under `report/` that a run writes.
const GENERATED: [&str; 3] = ["src", "book", "results.csv"];

/// True if a path under `report/` is generated, or is a file that operating systems and other programs leave.
fn is_excluded(path: &str) -> bool {
    GENERATED.contains(&path) || path.rsplit('/').next().is_some_and(is_left_behind)
}

/// Refuses names that some file systems do not tell apart: there, the files of one scene would overwrite those of the
/// other.
fn refuse_names_alike(scenes: &[Scene]) -> Result<()> {
    let mut names = BTreeMap::new();
    for Scene { name, .. } in scenes {
        if let Some(other) = names.insert(alike(name), name) {
            return Err(Error::input(format!(
                "pipeline/scenes: `{other}` and `{name}` are one name where capitals or the way to write accents do not count; rename one of them"
            )));
        }
    }
    Ok(())
}

/// Refuses two scenes for one published table: the chapters and figures on the paper show one scene per table.
fn refuse_second_of_a_table(scenes: &[Scene]) -> Result<()> {
    for (k, scene) in scenes.iter().enumerate() {
        let Some(number) = scene.paper_table else { continue };
        let Some(first) = scenes[..k].iter().find(|one| one.paper_table == Some(number)) else {
            continue;
        };
        return Err(Error::input(format!(
            "pipeline/scenes: `{}` and `{}` both have `paper_table = {number}`; leave it out of the one that is not the paper's",
            first.name, scene.name
        )));
    }
    Ok(())
}

/// Folder of the scenes in the project.
pub const SCENES: &str = "pipeline/scenes";

/// Reads every `pipeline/scenes/*.toml` with a `wanted` name, sorted by name.
fn read_scenes(root: &Path, wanted: impl Fn(&str) -> bool) -> Result<(Vec<Scene>, Artifacts)> {
    let folder = root.join(SCENES);
    let (mut scenes, mut files) = (Vec::new(), Artifacts::new());
    for entry in fs::read_dir(&folder).context("read", &folder)? {
        let path = entry.context("read", &folder)?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let is_scene = path.extension().is_some_and(|end| end == "toml");
        let left_behind =
            path.file_name().and_then(|name| name.to_str()).is_some_and(is_left_behind);
        if !is_scene || left_behind || !wanted(&name) {
            continue;
        }
        if path.file_name().is_none_or(|name| name.to_str().is_none()) {
            let path = path.display();
            return Err(Error::input(format!("the name of {path} is not UTF-8; rename it")));
        }
        refuse_forbidden_name("scene", &name)?;
        let text = read_text(&path)?;
        let mut scene = Scene::parse(&name, &text)?;
        scene.read_domain(root)?;
        files.extend(scene.domain.iter().flat_map(|domain| domain.files.clone()));
        scenes.push(scene);
        files.insert(format!("{SCENES}/{name}.toml"), text.into_bytes());
    }
    scenes.sort_by(|a, b| a.name.cmp(&b.name));
    refuse_names_alike(&scenes)?;
    refuse_second_of_a_table(&scenes)?;
    Ok((scenes, files))
}
