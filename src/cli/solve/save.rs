//! Scene of the project that `solve --save` writes.

use super::SolveArgs;
use super::request::Request;
use crate::cli::output::talk;
use crate::cli::project_root;
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::names::{in_shell, refuse_forbidden_name};
use crate::pipeline::place::{own_place, write_own};
use crate::replication::fields::member::{Member, Varying};
use crate::replication::fields::names::NAMED;
use crate::replication::fields::table::{FOLDER, text};
use crate::replication::fields::write;
use crate::replication::scene::{Output, Scene};
use crate::replication::scenes::{SCENES, taken, why_no_scene};
use crate::replication::study::Study;
use signorini_mathematics::statement::Statement;
use std::fs;
use std::path::{Path, PathBuf};

/// Returns the scene with this name of a request in so many dimensions, if there is none yet.
pub(super) fn scene<'a>(name: &'a str, request: &Request, dimension: u8) -> Result<NewScene<'a>> {
    let place = NewScene::new(name)?;
    let statement = place.stated(&request.statement, request.scene.is_some())?;
    let outputs: &[_] =
        if dimension == 2 { &[Output::Table, Output::Map] } else { &[Output::Table] };
    place.with(write::scene(&request.title, &statement, outputs), &[])
}

/// Returns the scene with this name of a study that options ask for, if there is none yet.
pub(super) fn study<'a>(name: &'a str, args: &SolveArgs, study: &Study) -> Result<NewScene<'a>> {
    let place = NewScene::new(name)?;
    if args.scene.is_some() {
        return Err(
            place.refused("a study of a scene is not saved; add `vary` to a copy of the scene")
        );
    }
    let mut study = study.clone();
    for member in &mut study.members {
        member.statement = place.stated(&member.statement, false)?;
    }
    let mut first = study.members[0].statement.clone();
    let title = args.fields.text("f").unwrap_or("Study of f");
    if let Some(f) = args.fields.text("f") {
        f.clone_into(&mut first.f);
    }
    if let Some(k) = args.fields.text("k") {
        first.k = Some(k.to_owned());
    }
    let mut lists = study.lists();
    // Of f and k, the members have numbers in place of their names.
    for (name, values) in lists.iter_mut().filter(|(name, _)| NAMED.contains(&&**name)) {
        let given =
            args.vary.iter().filter(|list| list.name == *name).flat_map(|list| &list.values);
        *values = given.map(|value| Varying::Text(text(value))).collect();
    }
    let text = write::study(title, &first, &lists, &args.fields);
    place.with(text, &study.members)
}

/// Scene that is to be written.
pub(super) struct NewScene<'a> {
    name: &'a str,
    /// Folder of the project.
    root: PathBuf,
    text: String,
}

impl<'a> NewScene<'a> {
    /// Place of the scene with this name, if there is none yet.
    fn new(name: &'a str) -> Result<Self> {
        refuse_forbidden_name("scene", name)?;
        let mut place = Self { name, root: PathBuf::new(), text: String::new() };
        if let Some(reason) = why_no_scene(name) {
            let without = match name.contains(['/', '\\']) {
                true => "a name without folders",
                false => "another name",
            };
            return Err(place.refused(&format!("{reason}; give {without}, such as plate")));
        }
        place.root = project_root().map_err(|e| place.refused(&e.to_string()))?;
        let taken = taken(&place.root, name)?;
        if let Some(taken) = taken {
            let text = format!("there is {taken} already; choose another name");
            return Err(place.refused(&text));
        }
        own_place(&place.root, &place.path())?;
        Ok(place)
    }

    /// Path in the project.
    fn path(&self) -> String {
        format!("{SCENES}/{}.toml", self.name)
    }

    fn refused(&self, reason: &str) -> Error {
        Error::input(format!("--save {}: {reason}", self.name))
    }

    /// Returns a statement of options with the path of its mesh as scenes have it; one of a scene has it already.
    fn stated(&self, statement: &Statement, of_scene: bool) -> Result<Statement> {
        let mut statement = statement.clone();
        if statement.domain.is_file() && !of_scene {
            statement.domain.name = in_project(&self.root, &statement.domain.name)?;
        }
        Ok(statement)
    }

    /// Returns the scene with its text, which is checked: it has these members.
    fn with(self, text: String, members: &[Member]) -> Result<Self> {
        let scene = Scene::parse(self.name, &text).map_err(|e| self.refused(&e.to_string()))?;
        if scene.is_study && scene.study.members != members {
            return Err(self.refused("no scene has these members; write one with `vary` by hand"));
        }
        Ok(Self { text, ..self })
    }

    /// Writes the scene.
    pub(super) fn write(&self) -> Result<()> {
        let path = self.path();
        write_own(&self.root, &path, self.text.as_bytes())?;
        talk(&format!("wrote {path}; `signorini run {}` solves and draws it", in_shell(self.name)));
        Ok(())
    }
}

/// Returns the path of a mesh below the folder from which scenes name theirs.
fn in_project(root: &Path, mesh: &str) -> Result<String> {
    let folder = root.join(FOLDER);
    let real = |path: &Path| -> Result<PathBuf> { fs::canonicalize(path).context("read", path) };
    let path = real(Path::new(mesh))?;
    let below = path.strip_prefix(real(&folder)?).ok().and_then(Path::to_str);
    below.map(|below| below.replace('\\', "/")).ok_or_else(|| {
        Error::input(format!(
            "--domain {mesh}: scenes have their meshes below {FOLDER}; copy it to {FOLDER}/meshes, and name it there"
        ))
    })
}
