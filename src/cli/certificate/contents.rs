//! Reservations of a certificate, and the files of its bundle with their descriptions.

use crate::cli::pipeline::Workplace;
use crate::pipeline::error::{IoContext, Result};
use crate::pipeline::{InputFiles, Summary, hash};
use crate::replication::comparison::TableComparison;
use crate::replication::paper::PAPER;
use crate::replication::project::{IDENTIFIED, Project, TRUTH};
use crate::replication::scene::Scene;
use crate::replication::scenes::SCENES;
use crate::replication::stages::tabulate;
use crate::timing::recorded;
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use serde::Serialize;
use signorini_mathematics::saddle::StopRule;
use std::fs;

/// A file of the bundle, with its description.
#[derive(Serialize)]
pub(super) struct File {
    pub(super) path: String,
    /// Path as an address of an RO-Crate.
    address: String,
    comment: String,
    media_type: &'static str,
    /// Number of bytes.
    size: usize,
    /// Hash in the cache, the lock file and the records: blake3.
    hash: String,
    #[serde(skip)]
    pub(super) bytes: Vec<u8>,
}

impl File {
    pub(super) fn new(path: impl Into<String>, comment: impl Into<String>, bytes: Vec<u8>) -> Self {
        let path = path.into();
        Self {
            address: address(&path),
            comment: comment.into(),
            media_type: media_type(&path),
            size: bytes.len(),
            hash: hash(&bytes),
            path,
            bytes,
        }
    }
}

/// ASCII characters that a relative address cannot have as they are.
const RESERVED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// Returns the address of a file in the bundle. RO-Crate prefers letters beyond ASCII as they are; other characters
/// there may be some that no address has.
fn address(path: &str) -> String {
    let mut address = String::new();
    for c in path.chars() {
        match c.is_alphanumeric() {
            true => address.push(c),
            false => address.extend(utf8_percent_encode(c.encode_utf8(&mut [0; 4]), RESERVED)),
        }
    }
    address
}

/// Returns the media type, as IANA registers it, of a file with this name.
fn media_type(path: &str) -> &'static str {
    match path.rsplit('.').next() {
        Some("css") => "text/css",
        Some("csv") => "text/csv",
        Some("js") => "text/javascript",
        Some("md") => "text/markdown",
        Some("msh") => MESH,
        Some("svg") => "image/svg+xml",
        Some("tera") => "text/plain",
        Some("toml") => "application/toml",
        _ => "application/octet-stream",
    }
}

/// Media type of meshes.
const MESH: &str = "model/mesh";

/// Returns the reservations of the project itself about its right-hand sides and stopping rules.
pub(super) fn reservations(project: &Project) -> Vec<&'static str> {
    let mut compared = project.scenes.iter().filter(|scene| scene.paper_table.is_some());
    let mut sentences = Vec::new();
    if project.files.contains_key(IDENTIFIED) {
        sentences.push(
            "The replicators' copy of the paper lacks the figure that defines the right-hand sides f; \
             they are recovered from these very tables, \
            so that the agreement tests the method and not the values of f, and a cell may differ because f does.",
        );
    }
    if compared
        .any(|scene| matches!(scene.first_rule(), Some(StopRule::Signed | StopRule::SignedDual)))
    {
        sentences.push(
            "The counts come out with the stopping criterion (13) read without its absolute value; \
            as printed, it gives these tables for no f that was tried.",
        );
    }
    sentences
}

/// Returns the files that the run `read`, with the bytes that it read.
pub(super) fn inputs(project: &Project, read: &InputFiles) -> Result<Vec<File>> {
    let mut files = Vec::new();
    for (path, file) in read {
        let is_mesh = project.scenes.iter().any(|scene| scene.files.contains_key(path))
            || media_type(path) == MESH;
        let comment = match path.as_str() {
            PAPER => "the published tables",
            IDENTIFIED => "the record of the searches for f",
            TRUTH => "digits of true solutions",
            recorded::PATH => "recorded run times",
            _ if is_mesh => "a mesh",
            _ if is_scene(project, path) => "a scene: a problem, its grids, and the outputs wanted",
            _ if path.starts_with("report/") => "a page, or a file of the book",
            _ => "a file that the run reads",
        };
        let mut file = File::new(format!("{INPUTS}{path}"), comment, file.bytes()?.to_vec());
        if is_mesh {
            file.media_type = MESH;
        }
        files.push(file);
    }
    Ok(files)
}

fn is_scene(project: &Project, path: &str) -> bool {
    project.scenes.iter().any(|scene| path == format!("{SCENES}/{}.toml", scene.name))
}

/// Folder of the inputs in the bundle. Their paths in it are those in the project, so that the folder is a project.
const INPUTS: &str = "inputs/";

/// Returns all tables, and all figures with their data, each with a comment on its contents.
pub(super) fn files(
    workplace: &Workplace,
    summary: &Summary,
    tables: &[TableComparison],
) -> Result<Vec<File>> {
    let mut files = Vec::new();
    for scene in &workplace.project.scenes {
        let Some(bytes) = table_of(workplace, summary, scene)? else { continue };
        let name = &scene.name;
        let compared = tables.iter().find(|table| table.scene == *name);
        if let (Some(table), Some(rule)) = (compared, scene.first_rule()) {
            let comment = format!(
                "Table {} of the paper: {} of {} counts exact",
                table.table, table.exact, table.cells
            );
            let under = tabulate::under(&String::from_utf8_lossy(&bytes), rule);
            let path = format!("tables/table{}.csv", table.table);
            files.push(File::new(path, comment, under.into_bytes()));
        }
        let comment = match scene.first_rule() {
            _ if scene.is_study => format!("numbers of the members of the study `{name}`"),
            Some(_) => format!("iteration counts and Delta a of scene `{name}`, rule by rule"),
            None => format!("energy and bounds of scene `{name}` by {}", scene.statement.solver),
        };
        files.push(File::new(format!("tables/{}", tabulate::file(scene)), comment, bytes));
    }
    let exports = &summary.exports.files;
    for path in exports.keys().filter(|path| path.starts_with("figures/")) {
        let on_disk = workplace.project.root.join(path);
        let bytes = fs::read(&on_disk).context("read", &on_disk)?;
        let picture = path.strip_suffix(".csv").map(|name| format!("{name}.svg"));
        let comment = match picture.filter(|picture| exports.contains_key(picture)) {
            Some(picture) => format!("what {picture} shows, as a table"),
            None if path.ends_with(".svg") => title(&bytes),
            None => "a file that the run makes".to_owned(),
        };
        files.push(File::new(path, comment, bytes));
    }
    Ok(files)
}

/// Returns the table of a scene, `None` if the run has none.
fn table_of(workplace: &Workplace, summary: &Summary, scene: &Scene) -> Result<Option<Vec<u8>>> {
    let task = tabulate::id(scene);
    let Some(manifest) = summary.manifests.get(&task) else { return Ok(None) };
    let mut artifacts = workplace.store.artifacts(&task, &manifest.outputs)?;
    Ok(artifacts.remove(&tabulate::file(scene)))
}

fn title(svg: &[u8]) -> String {
    let text = String::from_utf8_lossy(svg);
    let title = text.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>"));
    let title = title.map_or("a picture", |(title, _)| title);
    title.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::stages::{files_of, plan};
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn the_inputs_are_the_files_of_all_tasks() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf();
        let project = Project::read(root).unwrap();
        let plan = plan(&project, &project.select(&[]).unwrap(), None).unwrap();
        let of_tasks: BTreeSet<&String> =
            plan.tasks().iter().flat_map(|task| task.files.keys()).collect();
        let read = files_of(&project, plan.tasks());
        let inputs = inputs(&project, &read).unwrap();
        let certified = inputs.iter().map(|file| file.path.strip_prefix(INPUTS).unwrap());
        assert!(certified.eq(of_tasks.iter().map(|path| path.as_str())));
        let mesh = inputs.iter().find(|file| file.path.ends_with("gear.msh")).unwrap();
        assert_eq!((&*mesh.comment, mesh.media_type), ("a mesh", MESH));
    }
}
