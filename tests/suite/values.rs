//! `solve --at` and `--line`: v and its gradient at points, on every kind of domain, as text, JSON and CSV; and the list
//! of all meshes for ParaView.

use crate::common::{Project, TABLE};
use serde_json::{Value, json};
use std::fs;

/// Right-hand side on the square, constant on pieces.
const F: &str = "disc(-0.25,0,0.2)=6; else=-1";

/// Answer of `solve` with these options, as JSON.
fn solved(project: &Project, more: &[&str]) -> Value {
    project.run(&[&["solve", "--json"], more].concat()).json()
}

/// v and the first two components of its gradient at the only point of an answer.
fn at_point(answer: &Value) -> [f64; 3] {
    let value = &answer["values"][0];
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{answer}"));
    [number(&value["v"]), number(&value["gradient"][0]), number(&value["gradient"][1])]
}

#[test]
fn grids_meshes_and_the_true_solution_agree_at_a_point() {
    let project = Project::with(TABLE);
    let [truth, fine, coarse] = [
        &["--f", F, "--solver", "spectral", "--at", "0.13,-0.21"][..],
        &["--f", F, "--h", "1/512", "--at", "0.13,-0.21"],
        &["--f", F, "--accuracy", "2e-2", "--at", "0.13,-0.21"],
    ]
    .map(|more| at_point(&solved(&project, more)));
    for (found, bounds) in [(fine, [1e-5, 1e-2]), (coarse, [1e-3, 0.1])] {
        assert!((found[0] - truth[0]).abs() < bounds[0], "{found:?} {truth:?}");
        for d in [1, 2] {
            assert!((found[d] - truth[d]).abs() < bounds[1], "{found:?} {truth:?}");
        }
    }
    // Uniform and adapted meshes of one domain.
    let l = ["--domain", "lshape", "--f", "rect(-9,0,-9,0)=3; else=-2", "--at", "-0.3,-0.4"];
    let [uniform, adapted] = [["--refine", "6"], ["--accuracy", "1e-2"]]
        .map(|how| at_point(&solved(&project, &[&l[..], &how].concat())));
    assert!((uniform[0] - adapted[0]).abs() < 5e-3, "{uniform:?} {adapted:?}");
    // In space.
    let cube = ["--domain", "cube", "--f", "else=-1", "--h", "1/8", "--at", "0,0,0"];
    let cube = solved(&project, &cube);
    assert_eq!(cube["values"][0]["gradient"].as_array().unwrap().len(), 3);
    assert!(at_point(&cube)[0] < 0.0, "{cube}");
}

#[test]
fn a_line_is_the_same_as_text_json_and_csv() {
    let project = Project::with(TABLE);
    let line = ["solve", "--f", F, "--h", "1/8", "--line", "-0.5,0,0.5,0"];
    let json = project.run(&[&line[..], &["--json"]].concat()).json();
    let values = json["values"].as_array().unwrap();
    assert_eq!(values.len(), 101);
    assert_eq!(
        [&values[0]["point"], &values[100]["point"]],
        [&json!([-0.5, 0.0]), &json!([0.5, 0.0])]
    );
    let said = project.run(&line);
    let text = said.lines();
    let head = text.iter().position(|l| l.split_whitespace().eq(["x", "y", "v", "dv_dx", "dv_dy"]));
    assert!(text[head.unwrap() + 1].trim_start().starts_with("-0.500000"), "{said:?}");
    // What a file has is not printed.
    let said = project.run(&[&line[..], &["--out", "line.csv"]].concat());
    assert!(said.lines().len() < 20, "{said:?}");
    assert_eq!(said.lines().last(), Some(&"wrote line.csv"));
    let csv = fs::read_to_string(project.path("line.csv")).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("x,y,v,dv_dx,dv_dy"));
    for (line, value) in lines.zip(values) {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let [point, gradient] = ["point", "gradient"].map(|name| value[name].as_array().unwrap());
        let expected = point.iter().chain([&value["v"]]).chain(gradient);
        assert!(
            numbers.iter().copied().eq(expected.map(|v| v.as_f64().unwrap())),
            "{line} {value}"
        );
    }
}

#[test]
fn all_meshes_of_an_accuracy_are_listed_for_paraview() {
    let project = Project::with(TABLE);
    let f = "rect(-9,0,-9,0)=3; else=-2";
    let said = project.run(&[
        "solve",
        "--domain",
        "lshape",
        "--f",
        f,
        "--accuracy",
        "0.1",
        "--out",
        "meshes/l.pvd",
    ]);
    assert_eq!(said.lines().last(), Some(&"wrote meshes/l.pvd"));
    let list = fs::read_to_string(project.path("meshes/l.pvd")).unwrap();
    let files: Vec<_> =
        list.split("file=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(files.len() > 3 && files[0] == "l-0.vtu", "{list}");
    let mut sizes = Vec::new();
    for file in files {
        let bytes = fs::read(project.path(&format!("meshes/{file}"))).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        let (_, nodes) = text.split_once("NumberOfPoints=\"").unwrap();
        sizes.push(nodes.split('"').next().unwrap().parse::<usize>().unwrap());
        assert!(text.contains("Name=\"gradient\" NumberOfComponents=\"3\""));
    }
    assert!(sizes.is_sorted_by(|one, next| one < next), "{sizes:?}");
}
