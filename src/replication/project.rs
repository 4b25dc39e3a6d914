//! A project folder: the scenes, published values and templates that a run reads, and where it writes.

use crate::pipeline::Artifacts;
use crate::pipeline::error::{Error, IoContext, Result, from_toml};
use crate::pipeline::files::{read_if_there, read_text, read_tree};
use crate::replication::paper::Paper;
use crate::replication::scene::Scene;
use crate::report;
use crate::timing::recorded::{self, Timings};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Path of the published tables in the project.
pub const PAPER: &str = "pipeline/paper.toml";

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
    /// The files under `pipeline/` as read, by path in the project: scenes, and as far as they are there
    /// the published tables, the digits of true solutions, and the records of the search and of times, which
    /// whoever needs them parses.
    pub files: Artifacts,
    /// Everything under `report/` that is not generated, by path from there.
    pub templates: Artifacts,
    /// Whether only some scenes were read, so that nothing can be said of several together.
    pub(crate) partial: bool,
    /// Tells the commands of the program, for the book: the `name`, empty for the program without a command, and
    /// the `help` of each. A reader of the folder alone knows none.
    pub commands: fn() -> Vec<Value>,
}

impl Project {
    /// The nearest project folder at or above `from`.
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
        let templates = read_tree(&root.join("report"), is_not_ours)
            .or_else(|(path, e)| Err(e).context("read", &path))?;
        Ok(Self { root, scenes, paper, files, templates, partial: false, commands: Vec::new })
    }

    /// Reads only what the tasks of single scenes depend on, for the scenes with these names, as far as they exist.
    ///
    /// # Errors
    /// As [`Project::read`], but for other scenes and for the book.
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

    /// Refuses a broken record of times, and a book to be built elsewhere. Not part of [`Project::read`]:
    /// a run that has nothing to do need not parse what tasks of an earlier run have parsed.
    pub(crate) fn check(&self) -> Result<()> {
        if let Some(text) = self.files.get(recorded::PATH) {
            Timings::parse(text)?;
        }
        if let Some(text) = self.templates.get("book.toml") {
            from_toml::<toml::Table>("report/book.toml", text)?;
            report::settings(text).map_err(Error::input)?;
        }
        Ok(())
    }

    /// The scenes with these names, each once, or all if no name is given.
    pub(crate) fn select(&self, names: &[String]) -> Result<Vec<&Scene>> {
        names.iter().try_for_each(|name| self.scene(name).map(drop))?;
        let is_wanted = |scene: &&Scene| names.is_empty() || names.contains(&scene.name);
        Ok(self.scenes.iter().filter(is_wanted).collect())
    }

    /// The scenes of the paper's problems 1 and 2, as far as there are any; the chapters are about them.
    pub(crate) fn problems(&self) -> Vec<&Scene> {
        let mut problems: Vec<_> = self.scenes.iter().filter(|scene| scene.is_problem()).collect();
        problems.sort_by_key(|scene| scene.paper_table);
        problems
    }

    /// The scene with this name.
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

/// What a run writes under `report/`.
const GENERATED: [&str; 3] = ["src", "book", "results.csv"];

/// Whether a path under `report/` is hidden or generated.
fn is_not_ours(path: &str) -> bool {
    path.rsplit('/').next().is_some_and(|name| name.starts_with('.')) || GENERATED.contains(&path)
}

/// Refuses two scenes for one published table: the chapters and figures on the paper would be about either.
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
const SCENES: &str = "pipeline/scenes";

/// Reads every `pipeline/scenes/*.toml` with a `wanted` name, sorted by name.
fn read_scenes(root: &Path, wanted: impl Fn(&str) -> bool) -> Result<(Vec<Scene>, Artifacts)> {
    let folder = root.join(SCENES);
    let (mut scenes, mut files) = (Vec::new(), Artifacts::new());
    for entry in fs::read_dir(&folder).context("read", &folder)? {
        let path = entry.context("read", &folder)?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        // Editors keep locks and backups as hidden files.
        if path.extension().is_none_or(|e| e != "toml") || name.starts_with('.') || !wanted(&name) {
            continue;
        }
        if path.file_name().is_none_or(|name| name.to_str().is_none()) {
            let path = path.display();
            return Err(Error::input(format!("the name of {path} is not UTF-8; rename it")));
        }
        let text = read_text(&path)?;
        scenes.push(Scene::parse(&name, &text)?);
        files.insert(format!("{SCENES}/{name}.toml"), text.into_bytes());
    }
    scenes.sort_by(|a, b| a.name.cmp(&b.name));
    refuse_second_of_a_table(&scenes)?;
    Ok((scenes, files))
}
