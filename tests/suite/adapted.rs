//! Meshes that are refined where the error is large, as `solve` and scenes make them.

use crate::common::{Project, TABLE, number};
use serde_json::Value;
use std::fs;

/// f on the L-shape whose true energy is known, by extrapolation from uniform refinements of an adapted mesh.
const F: &str = "rect(-9,0,-9,0)=3; else=-2";
const ENERGY: f64 = -3.019_877_99;

fn pair(value: &Value) -> [f64; 2] {
    [0, 1].map(|k| value[k].as_f64().unwrap_or_else(|| panic!("{value}")))
}

#[test]
fn an_accuracy_on_a_mesh_is_reached_and_the_answer_says_how() {
    let project = Project::with(TABLE);
    let solve = |more: &[&str]| {
        project.run(&[&["solve", "--f", F, "--domain", "lshape"][..], more].concat())
    };
    let json = solve(&["--accuracy", "0.05", "--json"]).json();
    let [low, high] = pair(&json["bound"]["energy"]);
    assert!(low < ENERGY && ENERGY < high, "{json}");
    let reached = json["bound"]["relative"]["error"].as_f64().unwrap();
    assert!((0.03..=0.05).contains(&reached), "{reached}");
    let adapted = &json["adapted"];
    assert_eq!((&adapted["end"], &adapted["reached"]), (&"goal".into(), &reached.into()));
    assert_eq!(adapted["kind"], "adapted");
    assert_eq!(adapted["nodes"], json["unknowns"]);
    assert_eq!(adapted["meshes"], json["grids"].as_array().unwrap().len());
    assert_eq!((&json["stop"], &json["warnings"]), (&"converged".into(), &serde_json::json!([])));
    // A lower bound of the error that is no zero.
    let [least, most] = pair(&json["bound"]["error"]);
    assert!(least > 0.4 * most, "{least} {most}");
    let said = solve(&["--accuracy-energy", "0.01", "--verbose"]);
    assert!(said.err.starts_with("mesh 1: 8 nodes, "), "{said:?}");
    assert!(said.out.contains("the error is as small as asked"), "{said:?}");
}

#[test]
fn an_answer_on_uniform_refinements_says_so() {
    let project = Project::with(TABLE);
    let nodes = "1 0 0 0\n2 1 0 0\n3 1 2e-4 0\n4 0 2e-4 0\n";
    let strip = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 1 \"side\"\n$EndPhysicalNames\n$Nodes\n4\n\
         {nodes}$EndNodes\n$Elements\n3\n1 1 2 1 1 4 1\n2 2 2 2 1 1 2 3\n3 2 2 2 1 1 3 4\n$EndElements\n"
    );
    fs::write(project.path("strip.msh"), strip).unwrap();
    let command = ["solve", "--f", "else=-1", "--domain", "strip.msh", "--free", "side"];
    let solve = |more: &[&str]| project.run(&[&command[..], &["--accuracy", "0.1"], more].concat());
    let (json, said) = (solve(&["--json"]).json(), solve(&[]));
    assert_eq!((&json["unknowns"], &json["adapted"]["kind"]), (&4225.into(), &"uniform".into()));
    assert_eq!(json["adapted"]["meshes"], json["grids"].as_array().unwrap().len());
    assert!(said.out.contains(" uniform meshes"), "{said:?}");
}

#[test]
fn curves_files_and_parts_are_adapted_too() {
    let project = Project::with(TABLE);
    let gear = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/meshes/gear.msh");
    for (domain, more, is_curved) in [
        ("annulus", &["--fixed", "inner"][..], true),
        ("disc", &["--friction", "0.3"], true),
        (gear, &[], false),
        ("square", &[], false),
    ] {
        let command = ["solve", "--f", "rect(0,9,0,9)=1; else=-1", "--domain", domain];
        let said = project.run(&[&command[..], more, &["--accuracy", "0.1", "--json"]].concat());
        let json = said.json();
        assert!(number(&json["bound"]["relative"]["error"]) <= 0.1, "{domain}: {json}");
        assert_eq!(json["bound"]["curve"].as_f64().is_some_and(|size| size > 0.0), is_curved);
        // The square has grids of its own.
        assert_eq!(json["adapted"].is_null(), domain == "square", "{domain}");
    }
}

#[test]
fn files_have_the_local_error_and_a_picture_the_mesh() {
    let project = Project::with(TABLE);
    for (file, more) in [("a.vtu", &[][..]), ("a.svg", &["--mesh"])] {
        let command = ["solve", "--f", F, "--domain", "lshape", "--accuracy", "0.2", "--out", file];
        project.run(&[&command[..], more].concat()).lines();
    }
    let vtu = fs::read(project.path("a.vtu")).unwrap();
    let text = String::from_utf8_lossy(&vtu);
    assert!(text.contains("Name=\"local_error\""));
    let cells = text.split("NumberOfCells=\"").nth(1).unwrap().split('"').next().unwrap();
    let svg = fs::read_to_string(project.path("a.svg")).unwrap();
    assert!(svg.matches("<path").count() >= cells.parse().unwrap(), "{cells}");
}

#[test]
fn a_scene_on_a_mesh_may_ask_for_an_accuracy() {
    let scene = format!("title = \"L\"\ndomain = \"lshape\"\nf = \"{F}\"\naccuracy = 0.1\n");
    let outputs = "outputs = [\"table\", \"source\", \"map\", \"contact\"]\n";
    let project = Project::with(&format!("{scene}{outputs}"));
    project.run(&["run"]).lines();
    project.run(&["run"]).nothing_to_do();
    let of_scene = project.run(&["solve", "a", "--json"]).json();
    let option = ["solve", "--f", F, "--domain", "lshape", "--accuracy", "0.1", "--json"];
    let option = project.run(&option).json();
    for key in ["energy", "bound", "grids", "contact", "adapted"] {
        assert_eq!(option[key], of_scene[key], "{key}");
    }
    let other = project.run(&["solve", "a", "--refine", "1"]);
    assert!(other.out.contains("without accuracy = 0.1"), "{other:?}");
    project
        .scene("a", &format!("{}{outputs}", scene.replace("lshape", "ball").replace(F, "else=-1")));
    assert!(project.run(&["run"]).refusal().contains("is for domains in the plane"));
}
