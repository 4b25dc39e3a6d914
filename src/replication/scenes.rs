//! The folder of scenes: all that can be read, and by name those that cannot, so that one hides no other.

use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::read_text;
use crate::pipeline::names::{are_alike, composed, is_left_behind, refuse_forbidden_name};
use crate::pipeline::{InputFile, InputFiles};
use crate::replication::scene::Scene;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Folder of the scenes in the project.
pub(crate) const SCENES: &str = "pipeline/scenes";

/// Scenes of a project.
#[derive(Debug, Default)]
pub(crate) struct SceneFolder {
    /// Scenes that can be read, by name. Meshes are there, and not read yet.
    pub scenes: Vec<Scene>,
    /// Scenes that cannot be read: the name of each, and the error, which names it too.
    pub broken: BTreeMap<String, String>,
    /// Files that look like scenes and are none, each in words with the remedy.
    pub ignored: Vec<String>,
    /// Files of the scenes and their meshes, by path in the project.
    pub files: InputFiles,
}

/// Returns the scenes of the paper's problems 1 and 2 among others.
pub(crate) fn problems(scenes: &[Scene]) -> Vec<&Scene> {
    let mut problems: Vec<_> = scenes.iter().filter(|scene| scene.is_problem()).collect();
    problems.sort_by_key(|scene| scene.paper_table);
    problems
}

impl SceneFolder {
    /// Reads every `pipeline/scenes/*.toml` with a `wanted` name.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be listed. What is wrong with a single scene is no error.
    pub(crate) fn read(root: &Path, wanted: impl Fn(&str) -> bool) -> Result<Self> {
        let folder = root.join(SCENES);
        let mut names = Vec::new();
        let mut found = Self::default();
        for entry in fs::read_dir(&folder).context("list", &folder)? {
            let path = entry.context("list", &folder)?.path();
            let name = composed(&path.file_name().unwrap_or_default().to_string_lossy());
            match name.strip_suffix(ENDING) {
                _ if path.is_dir() => found.ignored.extend(scene_in_folder(&path, &name)),
                Some(name) if wanted(name) => names.push((name.to_owned(), path)),
                None if name.to_lowercase().ends_with(ENDING) => found.ignored.push(format!(
                    "{SCENES}/{name} is no scene, whose name ends with {ENDING} in small letters; rename it"
                )),
                _ => {}
            }
        }
        names.sort();
        found.ignored.sort();
        for (name, path) in names {
            match found.scene(root, &name, &path) {
                Ok(scene) => found.scenes.push(scene),
                Err(error) => _ = found.broken.insert(name, error.to_string()),
            }
        }
        Ok(found)
    }

    /// Returns the scene with this name.
    ///
    /// # Errors
    /// As [`find`].
    pub(crate) fn named(&self, name: &str) -> Result<&Scene> {
        find(name, &self.scenes, &self.broken)
    }

    /// Reads one scene; refuses one that does not go with those before it.
    fn scene(&mut self, root: &Path, name: &str, path: &Path) -> Result<Scene> {
        if path.file_name().is_none_or(|name| name.to_str().is_none()) {
            let path = path.display();
            return Err(Error::input(format!("the name of {path} is not UTF-8; rename it")));
        }
        refuse_forbidden_name("scene", name)?;
        if let Some(reason) = why_no_scene(name) {
            return Err(Error::input(format!("{SCENES}/{name}{ENDING}: {reason}; rename it")));
        }
        if let Some(first) = self.scenes.iter().find(|one| are_alike(&one.name, name)) {
            return Err(Error::input(format!(
                "{SCENES}: the names of `{}` and `{name}` differ in capitals or accents alone, as files do not \
                 everywhere; rename one",
                first.name
            )));
        }
        let text = read_text(path)?;
        let mut scene = Scene::parse(name, &composed(&text))?;
        scene.find_mesh(root, &mut self.files)?;
        self.refuse_second_of_a_table(&scene)?;
        let file = InputFile::with(path.to_path_buf(), text.into_bytes());
        self.files.insert(format!("{SCENES}/{name}{ENDING}"), file);
        Ok(scene)
    }

    /// Refuses a second scene for one published table: the chapters and figures on the paper show one scene per table.
    fn refuse_second_of_a_table(&self, scene: &Scene) -> Result<()> {
        let Some(number) = scene.paper_table else { return Ok(()) };
        match self.scenes.iter().find(|one| one.paper_table == Some(number)) {
            None => Ok(()),
            Some(first) => Err(Error::input(format!(
                "{SCENES}: `{}` and `{}` both have `paper_table = {number}`; leave it out of the one that is not the \
                 paper's",
                first.name, scene.name
            ))),
        }
    }
}

/// Returns the scene with this name.
///
/// # Errors
/// [`Error::Unknown`] with the known names if there is none, [`Error::Input`] if it is among the `broken` ones.
pub(super) fn find<'a>(
    name: &str,
    scenes: &'a [Scene],
    broken: &BTreeMap<String, String>,
) -> Result<&'a Scene> {
    if let Some(scene) = scenes.iter().find(|scene| scene.name == name) {
        return Ok(scene);
    }
    if let Some(why) = broken.get(name) {
        return Err(Error::input(why.clone()));
    }
    let known: Vec<_> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    Err(Error::Unknown(format!("no scene `{name}`; there are: {}", known.join(", "))))
}

/// Returns the reason why a file with this name, without its ending, is no scene, if there is one.
pub(crate) fn why_no_scene(name: &str) -> Option<&'static str> {
    match name {
        _ if name.trim().is_empty() => Some("a scene has a name"),
        _ if name.contains(['/', '\\']) => Some("a scene has no folder in its name"),
        _ if name.starts_with('-') => Some("a name that begins with - is read as an option"),
        _ if is_left_behind(&format!("{name}{ENDING}")) => {
            Some("files of such a name are those that other programs leave, and not read")
        }
        _ => None,
    }
}

/// Returns the path in the project of a scene whose name is one with this where file names ignore capitals, or write
/// accents the other way.
///
/// # Errors
/// [`Error::Io`] if the folder cannot be listed.
pub(crate) fn taken(root: &Path, name: &str) -> Result<Option<String>> {
    let folder = root.join(SCENES);
    for entry in fs::read_dir(&folder).context("list", &folder)? {
        let there = entry.context("list", &folder)?.file_name().to_string_lossy().into_owned();
        if there.strip_suffix(ENDING).is_some_and(|there| are_alike(there, name)) {
            return Ok(Some(format!("{SCENES}/{there}")));
        }
    }
    Ok(None)
}

/// Ending of the files of scenes.
const ENDING: &str = ".toml";

/// Says that a folder among the scenes is not looked into, if scenes are there.
fn scene_in_folder(path: &Path, name: &str) -> Option<String> {
    let mut entries = fs::read_dir(path).ok()?.flatten();
    let scene = entries.find(|entry| entry.file_name().to_string_lossy().ends_with(ENDING))?;
    let scene = scene.file_name().to_string_lossy().into_owned();
    Some(format!(
        "{SCENES}/{name}/{scene} is no scene; scenes lie in {SCENES} itself: move it there"
    ))
}
