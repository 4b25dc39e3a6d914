//! Meshes that are refined where the error is large, as `solve` makes them.

use crate::common::{Project, TABLE, bracket, mesh_path, number};
use serde_json::json;

#[test]
fn an_accuracy_on_a_mesh_is_reached_and_the_answer_says_how() {
    // The true energy, by extrapolation from uniform refinements of an adapted mesh.
    let energy = -3.019_877_99;
    let project = Project::with(TABLE);
    let f = "--f 'rect(-9,0,-9,0)=3; else=-2'";
    let json = project.answer(&format!("--domain lshape {f} --accuracy 0.05"));
    let [low, high] = bracket(&json);
    assert!(low < energy && energy < high, "{json}");
    let reached = number(&json["bound"]["relative"]["error"]);
    assert!((0.03..=0.05).contains(&reached), "{reached}");
    let adapted = &json["adapted"];
    let expected = json!(["goal", reached, "adapted", json["unknowns"]]);
    let found = ["end", "reached", "kind", "nodes"].map(|name| &adapted[name]);
    assert_eq!(json!(found), expected);
    assert_eq!(adapted["meshes"], json["grids"].as_array().unwrap().len());
    assert_eq!((&json["stop"], &json["warnings"]), (&"converged".into(), &json!([])));
    // A lower bound of the error that is no zero.
    let [least, most] = [0, 1].map(|end| number(&json["bound"]["error"][end]));
    assert!(least > 0.4 * most, "{least} {most}");
}

#[test]
fn curves_files_and_parts_are_adapted_too() {
    let project = Project::with(TABLE);
    let gear = mesh_path("gear");
    for (domain, is_curved) in [
        ("annulus --fixed inner", true),
        ("disc --friction 0.3", true),
        (&gear, false),
        ("square", false),
    ] {
        let f = "--f 'rect(0,9,0,9)=1; else=-1' --accuracy 0.1";
        let json = project.answer(&format!("{f} --domain {domain}"));
        assert!(number(&json["bound"]["relative"]["error"]) <= 0.1, "{domain}: {json}");
        assert_eq!(json["bound"]["curve"].as_f64().is_some_and(|size| size > 0.0), is_curved);
        // The square has grids of its own.
        assert_eq!(json["adapted"].is_null(), domain == "square", "{domain}");
    }
}
