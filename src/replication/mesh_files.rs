//! Meshes of scenes: files of the project, and what is checked of them before a scene is run.

use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::is_plain;
use crate::pipeline::names::found;
use crate::pipeline::{InputFile, InputFiles};
use crate::replication::fields::table::{FOLDER, Voice};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::statement::{Domain, Statement};
use std::path::Path;

/// Most nodes of a mesh of a scene; the method of the paper takes days on it.
const MOST_NODES: f64 = 1e7;

/// Returns the path of the mesh of a domain in the project, if it is a file.
pub(crate) fn path_of(domain: &Domain) -> Option<String> {
    domain.is_file().then(|| format!("{FOLDER}/{}", domain.name))
}

/// Finds the mesh of a domain in the project in `root`, among the `known` files or else on the disk, and does not read
/// it: other scenes with this mesh share what is read.
pub(crate) fn find_mesh(
    domain: &Domain,
    root: &Path,
    known: &mut InputFiles,
) -> Result<InputFiles> {
    let Some(path) = path_of(domain) else { return Ok(InputFiles::new()) };
    if !is_plain(&path) {
        return Err(Error::input(format!(
            "{path}: name a file below {FOLDER}/ by its shortest path, as domain = \"meshes/gear.msh\""
        )));
    }
    let file = match known.get(&path) {
        Some(file) => file.clone(),
        None => InputFile::if_there(&found(&root.join(&path)))?.ok_or_else(|| {
            let names = AnyMesh::built_in_names().join(", ");
            Error::input(format!(
                "there is no {path}; put the mesh there, or name one of the domains {names}"
            ))
        })?,
    };
    known.insert(path.clone(), file.clone());
    Ok(InputFiles::from([(path, file)]))
}

/// Returns the coarsest mesh of a statement of a scene, read from these files; none on the square.
pub(crate) fn mesh(statement: &Statement, files: &InputFiles) -> Result<Option<AnyMesh>> {
    mesh_in(Voice::Keys, statement, files)
}

/// As [`mesh`], of a statement in these words.
fn mesh_in(voice: Voice, statement: &Statement, files: &InputFiles) -> Result<Option<AnyMesh>> {
    let file = path_of(&statement.domain).and_then(|path| files.get(&path));
    statement.mesh(file.map(InputFile::bytes).transpose()?).map_err(|e| voice.stated(&e))
}

/// Returns the problem of a statement of a scene, whose mesh is read from these files.
pub(crate) fn problem(statement: &Statement, files: &InputFiles) -> Result<Problem> {
    problem_in(Voice::Keys, statement, files, true)
}

/// As [`problem`], of a statement in these words; `has_nodes` if values at nodes are wanted of every solver.
pub(crate) fn problem_in(
    voice: Voice,
    statement: &Statement,
    files: &InputFiles,
    has_nodes: bool,
) -> Result<Problem> {
    let mesh = mesh_in(voice, statement, files)?;
    let problem = match has_nodes {
        true => statement.problem(mesh.as_ref(), &|_| ()),
        false => statement.without_nodes(mesh.as_ref()).problem(mesh.as_ref(), &|_| ()),
    };
    problem.map_err(|e| voice.stated(&e))
}

/// Checks that there is a problem, and that its meshes are of a sensible size; `coarsest` is what [`mesh`] has read.
/// Takes time. Returns what a user has to know, in a line each.
pub(crate) fn check(statement: &Statement, coarsest: Option<&AnyMesh>) -> Result<Vec<String>> {
    if let Some(mesh) = coarsest {
        let (times, nodes) = size(statement, mesh)?;
        if nodes > MOST_NODES {
            return Err(Error::input(format!(
                "refine = {times} makes about {nodes:.0e} nodes, more than is sensible; {MOST_NODES:.0e} are the most"
            )));
        }
    }
    statement.checked(coarsest).map_err(|e| Voice::Keys.stated(&e))
}

/// Returns how often the coarsest mesh of a statement is refined, to meshes of the usual size for an accuracy, and how
/// many nodes there are then, about.
pub(crate) fn size(statement: &Statement, coarsest: &AnyMesh) -> Result<(usize, f64)> {
    let times = statement.on_usual_meshes().refinements(coarsest);
    let times = times.map_err(|e| Voice::Keys.stated(&e))?;
    Ok((times, coarsest.nodes_after(times)))
}
