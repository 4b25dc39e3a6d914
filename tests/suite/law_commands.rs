//! Laws on the command line and in scenes: answers, pictures, and what is refused.

use crate::common::Project;
use std::fs;

/// Scene with friction and all outputs that do not need a published table.
const SCENE: &str = "title = \"Friction\"\nf = \"halfplane(1,0,0)=8; else=-8\"\nlaw = { friction = 1 }\n\
    grids = [4, 8, 16]\nsolver = \"arrow-hurwicz\"\nload = { rule = \"nodal\", diagonal = \"rising\" }\nr = [10, 1e6]\nstop = [\"printed\", \"printed-dual\"]\n\
    outputs = [\"table\", \"surface\", \"contact\", \"history\"]\n";

fn project(scene: &str) -> Project {
    let project = Project::with(scene);
    project.add_book("# Laws\n\n![v](figures/a-surface.svg)\n");
    project
}

#[test]
fn answers_tell_what_sticks_and_which_way_the_rest_slips() {
    let project = Project::with(SCENE);
    let f = ["solve", "--f", "halfplane(1,0,0)=8; else=-8", "--friction", "1", "--h", "1/64"];
    let json = project.run(&[&f[..], &["--json"]].concat()).json();
    let state = |name: &str| json["states"][name].as_u64().unwrap();
    assert_eq!(["sticks", "slips_up", "slips_down"].map(state), [6, 125, 125]);
    assert_eq!((json["law"]["lo"].as_f64(), json["law"]["hi"].as_f64()), (Some(-1.0), Some(1.0)));
    assert!(json["kkt"]["relative"].as_f64().unwrap() < 1e-10, "{json}");
    assert!(json["force"].as_f64().unwrap().abs() < 1e-12, "{json}");
    assert!(json["kkt"]["complementarity"].as_f64().unwrap().abs() < 1e-12, "{json}");
    assert_eq!(json["contact"].as_array().unwrap().len(), 2);
    let text = project.run(&f);
    let lines = text.lines();
    let states = "6 of 256 boundary nodes stick, 125 slip up, 125 slip down";
    assert!(lines.iter().any(|line| line.starts_with(states)), "{lines:?}");
    // Sums of rounding errors.
    let zero = "flux through the boundary 0, minus the integral of f 0";
    assert!(lines.contains(&zero), "{lines:?}");
    assert!(lines.iter().all(|line| line.chars().count() <= 80 || line.starts_with("warning")));
    // The paper's law has no upper end, and no states but contact.
    let json = project.run(&["solve", "--f", "else=-1", "--json"]).json();
    assert!(json["law"].is_null() && json["states"].is_null(), "{json}");
    let json = project.run(&["solve", "--f", "else=-1", "--limit", "9", "--json"]).json();
    assert_eq!(json["law"]["hi"].as_f64(), Some(9.0));
}

#[test]
fn the_cube_and_every_solver_have_laws() {
    let project = Project::with(SCENE);
    let energy = |args: &[&str]| {
        let json = project.run(&[&["solve", "--json"], args].concat()).json();
        json["energy"].as_f64().unwrap()
    };
    let square = ["--f", "else=4", "--friction", "1.01", "--h", "1/16"];
    let expected = energy(&square);
    for solver in ["active-set", "arrow-hurwicz", "uzawa", "uzawa-proximal"] {
        let found = energy(&[&square[..], &["--solver", solver]].concat());
        let tolerance = if solver == "active-set" { 1e-12 } else { 5e-2 };
        assert!((found / expected - 1.0).abs() < tolerance, "{solver}: {found} {expected}");
    }
    let cube = ["--domain", "cube", "--f", "else=4", "--friction", "0.7", "--h", "1/8"];
    let other = energy(&[&cube[..], &["--solver", "active-set"]].concat());
    assert!((energy(&cube) / other - 1.0).abs() < 1e-12);
}

#[test]
fn scenes_with_a_law_are_made_and_kept() {
    let project = project(SCENE);
    project.run(&["run"]).lines();
    for figure in ["a-surface", "a-contact", "a-history"] {
        let svg = fs::read_to_string(project.path(&format!("figures/{figure}.svg"))).unwrap();
        assert!(svg.contains("</svg>"), "{figure}");
    }
    let results = fs::read_to_string(project.path("report/results.csv")).unwrap();
    assert_eq!(results.lines().count(), 1 + 2 * 2 * 3, "{results}");
    // What is solved stands in the row, to be plotted against.
    assert!(results.lines().next().unwrap().ends_with("domain,f,law,law_parameter"), "{results}");
    for row in results.lines().skip(1) {
        assert!(row.contains(",square,") && row.ends_with(",friction,1.0"), "{row}");
    }
    project.run(&["run"]).nothing_to_do();
    // Another law is another problem.
    project.scene("a", &SCENE.replace("{ friction = 1 }", "{ friction = 2 }"));
    project.run(&["run"]).lines();
    assert_ne!(results, fs::read_to_string(project.path("report/results.csv")).unwrap());
    // `solve` takes the law of the scene.
    let json = project.run(&["solve", "a", "--json"]).json();
    assert_eq!(json["law"]["hi"].as_f64(), Some(2.0));
}
