//! Scene of the project that `solve --save` writes.

use super::request::Request;
use crate::cli::output::talk;
use crate::cli::project_root;
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::write_atomically;
use crate::pipeline::names::refuse_forbidden_name;
use crate::replication::fields::write;
use crate::replication::mesh_files::FOLDER;
use crate::replication::scene::{Output, Scene};
use crate::replication::scenes::SCENES;
use std::fs;
use std::path::{Path, PathBuf};

/// Writes the scene with this name, if there is none yet.
pub(super) fn save(name: &str, request: &Request, dimension: u8) -> Result<()> {
    let option = format!("--save {name}");
    let in_option = |e: Error| Error::input(format!("{option}: {e}"));
    refuse_forbidden_name("scene", name)?;
    if name.contains(['/', '\\']) || name.starts_with('.') {
        return Err(Error::input(format!("{option}: give a name without folders, such as plate")));
    }
    let root = project_root().map_err(in_option)?;
    let place = format!("{SCENES}/{name}.toml");
    let path = root.join(&place);
    if path.exists() {
        return Err(Error::input(format!(
            "{option}: there is {place} already; choose another name"
        )));
    }
    let mut statement = request.statement.clone();
    if statement.domain.is_file() && request.scene.is_none() {
        statement.domain.name = in_project(&root, &statement.domain.name)?;
    }
    let outputs: &[_] =
        if dimension == 2 { &[Output::Table, Output::Map] } else { &[Output::Table] };
    let text = write::scene(&request.title, &statement, outputs);
    Scene::parse(name, &text).map_err(in_option)?;
    write_atomically(&path, text.as_bytes())?;
    talk(&format!("wrote {place}; `signorini run {name}` solves and draws it"));
    Ok(())
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
