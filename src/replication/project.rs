//! A project folder: the scenes, published values and templates that a run reads, and where it writes.

use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::list_tree;
use crate::pipeline::names::{composed, is_left_behind, refuse_forbidden_name};
use crate::pipeline::place::own_place;
use crate::pipeline::{InputFile, InputFiles};
use crate::replication::paper::{PAPER, Paper};
use crate::replication::scene::Scene;
use crate::replication::scenes::{SCENES, SceneFolder, find, problems};
use crate::timing::recorded::{self, Timings};
use std::collections::{BTreeMap, BTreeSet};
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
    /// All scenes that can be read, by name.
    pub scenes: Vec<Scene>,
    /// Scenes that cannot be read: the name of each, and the error, which names it too.
    pub broken: BTreeMap<String, String>,
    /// Files that look like scenes and are none, each in words with the remedy.
    pub ignored: Vec<String>,
    /// The published tables; none in a study of something else.
    pub paper: Paper,
    /// Files under `pipeline/`, by path in the project: scenes and meshes, and those that exist of the published
    /// tables, the digits of true solutions, and the records of the search and of times. Meshes, digits and records are
    /// not read yet.
    pub files: InputFiles,
    /// All files under `report/` that are not generated, by path in that folder; they are not read yet.
    pub templates: InputFiles,
    /// True if only some scenes were read: then no task is planned that concerns several scenes.
    pub(crate) partial: bool,
}

impl Project {
    /// Returns the nearest project folder at or above `from`.
    pub(crate) fn find(from: &Path) -> Result<PathBuf> {
        from.ancestors()
            .find(|folder| folder.join("pipeline").join("scenes").is_dir())
            .map(Path::to_path_buf)
            .ok_or_else(|| {
                Error::input(format!(
                    "no pipeline/scenes in {} or above; run inside a clone of signorini, begin a study with \
                     `signorini init FOLDER`, or use `signorini solve --f ...`",
                    from.display()
                ))
            })
    }

    /// Reads the project in `root`: of large files, and of those of the book, only the names.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Input`] from its parts, but not from a single scene.
    pub fn read(root: PathBuf) -> Result<Self> {
        Self::read_for(root, &[])
    }

    /// Reads the project in `root` as far as tasks of the scenes with these names depend on it; all of it if no name is
    /// given.
    ///
    /// # Errors
    /// As [`Project::read`], but not from files that no such task reads.
    pub(crate) fn read_for(root: PathBuf, names: &[String]) -> Result<Self> {
        let folder = Self::read_scenes(&root)?;
        let asked = folder.scenes.iter();
        let asked: Vec<_> =
            asked.filter(|one| names.is_empty() || names.contains(&one.name)).collect();
        let of_all = asked.len() == folder.scenes.len() || asked.iter().any(|one| one.is_problem());
        let more: &[&str] = match of_all {
            true => &[PAPER, IDENTIFIED, TRUTH, recorded::PATH],
            false => files_of_single_scenes(&asked),
        };
        let (broken, partial) = (refuse_broken(&folder.broken), !folder.broken.is_empty());
        let read = Self::with(root, folder, more).and_then(|mut project| {
            if of_all {
                project.templates = listed_templates(&project.root)?;
            }
            Ok(Self { partial, ..project })
        });
        // Of several mistakes, that in a scene comes first.
        read.or_else(|e| if names.is_empty() { broken.and(Err(e)) } else { Err(e) })
    }

    /// Reads the scenes of the project in `root`, and nothing else.
    ///
    /// # Errors
    /// [`Error::Input`] if there are none; [`Error::Io`] if the folder cannot be listed.
    pub(crate) fn read_scenes(root: &Path) -> Result<SceneFolder> {
        let folder = SceneFolder::read(root, |name| !is_left_behind(&format!("{name}.toml")))?;
        if folder.scenes.is_empty() && folder.broken.is_empty() {
            let folder = root.join(SCENES);
            let folder = folder.display();
            return Err(Error::input(format!(
                "no scenes in {folder}; add one as the README shows"
            )));
        }
        Ok(folder)
    }

    /// Returns the project with these scenes and those `more` files that exist.
    fn with(root: PathBuf, folder: SceneFolder, more: &[&str]) -> Result<Self> {
        let SceneFolder { scenes, broken, ignored, mut files, .. } = folder;
        for &path in more {
            let file = InputFile::if_there(&root.join(path))?;
            files.extend(file.map(|file| (path.into(), file)));
        }
        let paper = match files.get(PAPER) {
            Some(file) => Paper::parse(file.bytes()?)?,
            None => Paper::default(),
        };
        Ok(Self {
            root,
            scenes,
            broken,
            ignored,
            paper,
            files,
            templates: InputFiles::new(),
            partial: false,
        })
    }

    /// Reads only the files that tasks of single scenes depend on, for the scenes with these names; names without a
    /// scene are ignored.
    ///
    /// # Errors
    /// As [`Project::read`], but neither for other scenes nor for the book.
    pub(crate) fn read_part(root: PathBuf, names: &[&str]) -> Result<Self> {
        let folder = SceneFolder::read(&root, |name| names.contains(&name))?;
        let more = files_of_single_scenes(&folder.scenes.iter().collect::<Vec<_>>());
        Ok(Self { partial: true, ..Self::with(root, folder, more)? })
    }

    /// Checks the scenes with these names, and a record of times if it is among the `files` that a task is to read. Not
    /// part of [`Project::read`]: a run that has nothing to do need not look into files that tasks of an earlier run
    /// have read.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Io`] for the files, but not from scenes.
    pub(crate) fn check(
        &self,
        at_work: &BTreeSet<&str>,
        files: &BTreeSet<&str>,
    ) -> Result<Checked> {
        let mut checked = Checked::default();
        for scene in self.scenes.iter().filter(|scene| at_work.contains(&*scene.name)) {
            match scene.check() {
                Ok(notes) => checked.warnings.extend(
                    notes.iter().map(|note| format!("warning: scene `{}`: {note}", scene.name)),
                ),
                Err(why) => _ = checked.refused.insert(scene.name.clone(), why.to_string()),
            }
        }
        // Of several mistakes, that in a scene comes first.
        if !checked.refused.is_empty() {
            return Ok(checked);
        }
        if let Some(file) =
            self.files.get(recorded::PATH).filter(|_| files.contains(recorded::PATH))
        {
            Timings::parse(file.bytes()?)?;
        }
        Ok(checked)
    }

    /// Returns the scenes with these names, each once, or all if no name is given.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a name without a scene, [`Error::Input`] for a scene that cannot be read.
    pub(crate) fn select(&self, names: &[String]) -> Result<Vec<&Scene>> {
        if names.is_empty() {
            refuse_broken(&self.broken)?;
        }
        for name in names {
            self.scene(name)?;
        }
        let mut selected: Vec<&Scene> = self.scenes.iter().collect();
        selected.retain(|scene| names.is_empty() || names.contains(&scene.name));
        Ok(selected)
    }

    /// Returns the scenes of the paper's problems 1 and 2, if they exist; the chapters are about them.
    pub(crate) fn problems(&self) -> Vec<&Scene> {
        problems(&self.scenes)
    }

    /// Returns the scene with this name.
    ///
    /// # Errors
    /// [`Error::Unknown`] with the known names if there is none, [`Error::Input`] if it cannot be read.
    pub fn scene(&self, name: &str) -> Result<&Scene> {
        find(name, &self.scenes, &self.broken)
    }
}

/// Result of the check of scenes that are to be run.
#[derive(Debug, Default)]
pub(crate) struct Checked {
    /// Facts that a user has to know, in a line each.
    pub warnings: Vec<String>,
    /// Scenes that cannot be run: the name of each, and the error, which names it too.
    pub refused: BTreeMap<String, String>,
}

/// Returns the files of the project that tasks of these scenes alone may read.
fn files_of_single_scenes(scenes: &[&Scene]) -> &'static [&'static str] {
    match scenes.iter().any(|scene| scene.paper_table.is_some()) {
        true => &[PAPER, IDENTIFIED],
        false => &[],
    }
}

/// Lists the files of the book, by path in `report/`.
fn listed_templates(root: &Path) -> Result<InputFiles> {
    let report = root.join("report");
    for name in GENERATED {
        own_place(root, &format!("report/{name}"))?;
    }
    // Git keeps no empty folder.
    if !report.exists() && !report.is_symlink() {
        return Ok(InputFiles::new());
    }
    let listed = list_tree(&report, is_excluded);
    let listed = listed.or_else(|(path, e)| Err(e).context("read", &path))?;
    for name in listed.keys() {
        refuse_forbidden_name("file", name)?;
    }
    let files = listed.into_iter();
    Ok(files.map(|(name, path)| (composed(&name), InputFile::new(path))).collect())
}

/// Refuses scenes that cannot be read or run, each by its name.
pub(crate) fn refuse_broken(broken: &BTreeMap<String, String>) -> Result<()> {
    let Some((name, first)) = broken.first_key_value() else { return Ok(()) };
    let others: Vec<_> = broken.keys().filter(|other| *other != name).cloned().collect();
    Err(Error::input(match &others[..] {
        [] => first.clone(),
        _ => format!("{first}; there are mistakes in these scenes as well: {}", others.join(", ")),
    }))
}

/// Files and folders under `report/` that a run writes.
const GENERATED: [&str; 4] = ["src", "book", "results.csv", "tables"];

/// True if a path under `report/` is generated, or is a file that operating systems and other programs leave.
fn is_excluded(path: &str) -> bool {
    GENERATED.contains(&path) || path.rsplit('/').next().is_some_and(is_left_behind)
}
