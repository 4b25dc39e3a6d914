//! Beside an edit: options over studies, and exports that are edited by hand.

use super::{Files, one_of};
use crate::common::{Dice, Project};
use serde_json::Value;
use std::fs;

/// Options over a study, each with its key of a scene.
const OPTIONS: [([&str; 2], &str); 8] = [
    (["--solver", "active-set"], "solver = \"active-set\""),
    (["--solver", "multigrid"], "solver = \"multigrid\""),
    (["--h", "1/8"], "h = 8"),
    (["--grids", "4,8"], "grids = [4, 8]"),
    (["--tolerance", "1e-6"], "tolerance = 0.000001"),
    (["--load", "nodal"], "load = { rule = \"nodal\" }"),
    (["--accuracy", "0.5"], "accuracy = 0.5"),
    (["--refine", "1"], "domain = { name = \"disc\", refine = 1 }"),
];

/// Solves a study with an option over it, and one whose scene has the key: the rows are the same, or one is refused.
/// Returns true if there were rows.
pub(super) fn compare_options(
    dice: &mut Dice,
    project: &Project,
    files: &Files,
) -> Result<bool, String> {
    let studies: Vec<_> = files.iter().filter(|(_, text)| text.contains("vary = ")).collect();
    if studies.is_empty() {
        return Ok(false);
    }
    let (path, text) = *one_of(dice, &studies);
    let (option, line) = one_of(dice, &OPTIONS);
    let key = line.split(' ').next().unwrap_or_default();
    let name = path.trim_start_matches("pipeline/scenes/").trim_end_matches(".toml");
    let over = project.run(&[&["solve", name, "--json"], &option[..]].concat());
    let same = format!("{key} = ");
    let others = text.lines().filter(|line| !line.starts_with(&same));
    project.scene("beside", &(others.collect::<Vec<_>>().join("\n") + "\n" + line + "\n"));
    let in_scene = project.run(&["solve", "beside", "--json"]);
    fs::remove_file(project.path("pipeline/scenes/beside.toml")).unwrap();
    if [over.code, in_scene.code].contains(&Some(2)) {
        return Ok(false);
    }
    match rows(&over.out) == rows(&in_scene.out) {
        true => Ok(!over.out.is_empty()),
        false => Err(format!("{option:?} over {text}: {over:?}\nas a key: {in_scene:?}")),
    }
}

/// Rows of a study in JSON, without the name of its scene.
fn rows(text: &str) -> Vec<Value> {
    let mut rows: Vec<Value> = text.lines().map(|row| row.parse().unwrap()).collect();
    for fields in rows.iter_mut().filter_map(Value::as_object_mut) {
        fields.remove("scene");
    }
    rows
}

/// Edits an export by hand: the dry run refuses what the run refuses, and names the file; then the export is as it was.
pub(super) fn edit_an_export(dice: &mut Dice, project: &Project) -> Result<(), String> {
    let folder = *one_of(dice, &["figures", "report/tables"]);
    let exports: Vec<_> = project.files(folder).into_iter().collect();
    if exports.is_empty() {
        return Ok(());
    }
    let (name, bytes) = one_of(dice, &exports);
    let path = format!("{folder}/{name}");
    project.write(&path, [&bytes[..], b"x"].concat());
    let [dry, run] = [&["run", "-n"][..], &["run"]].map(|args| project.run(args));
    project.write(&path, bytes);
    let is_told = dry.code == Some(2) && dry.err.contains(&path) && dry.refusal() == run.refusal();
    if is_told { Ok(()) } else { Err(format!("{path}: {dry:?}\n{run:?}")) }
}
