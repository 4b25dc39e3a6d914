//! Mesh files as `solve` and `run` take them: what is said of parts that are not joined, units, names, and other files.

use crate::common::{Project, Said, TABLE};
use std::fmt::Write;

/// Unit squares side by side, of two triangles each; the second has nodes of its own.
const TWO_SQUARES: &str = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1 0 0\n6 2 0 0\n7 2 1 0\n8 1 1 0";
/// Cells of the squares, joined and not.
const JOINED: &str = "1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 2 2 2 6 7\n4 2 2 2 2 2 7 3";
const APART: &str = "1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 2 2 5 6 7\n4 2 2 2 2 5 7 8";
/// The second triangle of each square is numbered in the other sense.
const MIXED: &str = "1 2 2 1 1 1 2 3\n2 2 2 1 1 1 4 3\n3 2 2 2 2 2 6 7\n4 2 2 2 2 2 3 7";
/// Two tetrahedra on either side of a triangle.
const TETRAHEDRA: [&str; 2] =
    ["1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1", "1 4 2 1 1 1 2 3 4\n2 4 2 1 1 2 3 4 5"];

/// File of version 2.2 with these nodes, in some unit, and elements.
fn mesh(nodes: &str, unit: &str, elements: &str) -> String {
    let unit: f64 = unit.parse().unwrap();
    let mut text =
        format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", nodes.lines().count());
    for node in nodes.lines() {
        let mut words = node.split(' ');
        text += words.next().unwrap();
        for word in words {
            write!(text, " {:e}", unit * word.parse::<f64>().unwrap()).unwrap();
        }
        text += "\n";
    }
    let count = elements.lines().count();
    text + &format!("$EndNodes\n$Elements\n{count}\n{elements}\n$EndElements\n")
}

/// Answer of `solve` on a file, with more options.
fn solve(project: &Project, file: impl AsRef<[u8]>, more: &[&str]) -> Said {
    project.write("m.msh", file);
    let path = project.path("m.msh");
    project.run(&[&["solve", "--domain", path.to_str().unwrap(), "--refine", "2"], more].concat())
}

#[test]
fn warnings_do_not_depend_on_the_unit() {
    let project = Project::with(TABLE);
    for (nodes, elements) in [(TWO_SQUARES, JOINED), (TETRAHEDRA[0], TETRAHEDRA[1])] {
        let nodes =
            nodes.lines().filter(|node| elements == TETRAHEDRA[1] || !"58".contains(&node[..1]));
        let nodes = nodes.collect::<Vec<_>>().join("\n");
        for solver in ["multigrid", "active-set"] {
            let warnings = ["1", "1e-40", "1e-6", "1e6", "1e40"].map(|unit| {
                let more = ["--f", "else=-1", "--json", "--solver", solver];
                let json = solve(&project, mesh(&nodes, unit, elements), &more).json();
                json["warnings"].to_string()
            });
            assert!(
                !warnings[0].contains("balance") && !warnings[0].contains("sums"),
                "{warnings:?}"
            );
            assert!(warnings.iter().all(|one| *one == warnings[0]), "{warnings:?}");
        }
    }
}

#[test]
fn squares_that_are_not_joined_are_told_and_the_sense_of_their_elements_does_not_matter() {
    let project = Project::with(TABLE);
    let f = ["--f", "else=-1", "--json"];
    let joined = solve(&project, mesh(TWO_SQUARES, "1", JOINED), &f).json();
    let mixed = solve(&project, mesh(TWO_SQUARES, "1", MIXED), &f).json();
    assert_eq!(joined["energy"], mixed["energy"]);
    let told = "nodes 2 and 5 have the same place: the domain is in two parts, in contact along 1 edge; in Gmsh, \
        `Coherence`, fragments or `removeDuplicateNodes` join them";
    let apart = mesh(TWO_SQUARES, "1", APART);
    let json = solve(&project, &apart, &f).json();
    assert_eq!(json["warnings"][0], told);
    let text = solve(&project, &apart, &f[..2]).out;
    assert!(text.contains(&format!("warning: {told}\n")), "{text}");
    // A run tells it as well.
    project.write("pipeline/apart.msh", apart);
    project.scene(
        "apart",
        "title = \"Apart\"\nf = \"else=-1\"\ndomain = { name = \"apart.msh\", refine = 1 }\nsolver = \"arrow-hurwicz\"\nr = [10]\noutputs = \
         [\"table\"]\n",
    );
    let said = project.run(&["run", "apart"]);
    assert!(said.err.contains(&format!("warning: scene `apart`: {told}")), "{said:?}");
}

#[test]
fn contradictions_and_numbers_that_are_none_are_refused() {
    let project = Project::with(TABLE);
    let file = mesh(TWO_SQUARES, "1", APART);
    for (f, said) in [
        ("region(1)=-1", "f has no value on the region `2`; "),
        ("region(1)=-1; region(1)=-2; else=-1", "f has two values on the region `1`; "),
    ] {
        let refused = solve(&project, &file, &["--f", f]);
        assert!(refused.refusal().contains(said), "{refused:?}");
    }
}

#[test]
fn what_is_read_otherwise_than_it_stands_is_told() {
    let project = Project::with(TABLE);
    let nodes = "1 0 3 0\n2 1 3 0\n3 1 3 1\n4 0 3 1\n5 2 3 0\n6 2 3 1";
    let file = mesh(nodes, "1", "1 3 2 1 1 1 2 3 4\n2 3 2 2 1 2 5 6 3");
    let quadrangles = "2 quadrangles are cut into triangles, each by its shorter diagonal";
    let plane = "the mesh lies in a plane that is not z = const: in f and curves, x stands for x of the file and y for \
        z";
    // Its first square is where x is below 1.
    let same = ["region(1)=1; region(2)=-2", "halfplane(1,0,1)=1; else=-2"];
    let [one, two] = same.map(|f| {
        let json = solve(&project, &file, &["--f", f, "--json"]).json();
        assert_eq!(json["warnings"], serde_json::json!([quadrangles, plane]));
        json["energy"].as_f64().unwrap()
    });
    assert!((one - two).abs() <= 1e-12 * one.abs(), "{one} {two}");
    let said = solve(&project, &file, &["--f", "else=-1", "--out", "v.vtu"]);
    assert!(
        said.out.contains(&format!("\nwarning: {quadrangles}\nwarning: {plane}\n")),
        "{said:?}"
    );
    // Scenes say it too.
    project.write("pipeline/m.msh", &file);
    project.scene(
        "read",
        "title = \"t\"\nf = \"else=-1\"\ndomain = \"m.msh\"\noutputs = [\"table\"]\n",
    );
    let said = project.run(&["run", "read"]);
    assert!(said.err.contains(&format!("warning: scene `read`: {plane}")), "{said:?}");
}

#[test]
fn poles_at_nodes_and_at_midpoints_of_edges_are_found() {
    let project = Project::with(TABLE);
    let nodes = TWO_SQUARES.lines().filter(|node| !"58".contains(&node[..1]));
    let nodes = nodes.collect::<Vec<_>>().join("\n");
    let file = mesh(&nodes, "1", JOINED);
    // Of two refinements, the nodes have multiples of 1/4 and the midpoints of edges multiples of 1/8.
    for (f, at) in [("1/(x-1)-30", "(1, "), ("1/(x-0.375)-30", "(0.375, "), ("ln(y)-30", ", 0)")] {
        let refused = solve(&project, &file, &["--f", &format!("formula({f})")]);
        let refusal = refused.refusal();
        assert!(refusal.contains("inf at (") && refusal.contains(at), "{refused:?}");
    }
}

/// A hexagon with a square hole, of large triangles; the elements from 5 on are cells, and 5, 6, 11, 14 lie at the hole.
const HOLE: &str = "1 1 0 0\n2 0.5 0.8660254037844386 0\n3 -0.5 0.8660254037844386 0\n4 -1 0 0\n\
    5 -0.5 -0.8660254037844386 0\n6 0.5 -0.8660254037844386 0\n7 0.3535533905932738 0.3535533905932738 0\n\
    8 -0.3535533905932738 0.3535533905932738 0\n9 -0.3535533905932738 -0.3535533905932738 0\n\
    10 0.3535533905932738 -0.3535533905932738 0";
const AROUND_HOLE: &str = "1 1 2 7 7 7 8\n2 1 2 7 7 8 9\n3 1 2 7 7 9 10\n4 1 2 7 7 10 7\n5 2 2 3 1 9 8 4\n\
    6 2 2 3 1 7 10 1\n7 2 2 3 1 10 6 1\n8 2 2 3 1 2 7 1\n9 2 2 3 1 3 7 2\n10 2 2 3 1 4 8 3\n11 2 2 3 1 8 7 3\n\
    12 2 2 3 1 5 9 4\n13 2 2 3 1 6 10 5\n14 2 2 3 1 10 9 5";

#[test]
fn a_curve_that_is_too_far_away_is_refused_with_file_element_and_part() {
    let project = Project::with(TABLE);
    project.write("m.msh", mesh(HOLE, "1", AROUND_HOLE));
    let path = project.path("m.msh");
    for more in [["--refine", "3"], ["--accuracy", "0.001"]] {
        let args = ["solve", "--domain", path.to_str().unwrap(), "--f", "else=-1"];
        let curve = ["--curve", "7=0,0,0.5"];
        let said = project.run(&[&args[..], &curve, &more].concat());
        let refusal = said.refusal();
        let (file, fault) = refusal.split_once("m.msh: element ").expect(refusal);
        assert!(!file.contains("accuracy"), "{refusal}");
        let (element, fault) = fault.split_once(' ').unwrap();
        assert!(["5", "6", "11", "14"].contains(&element), "{refusal}");
        assert!(
            fault
                .starts_with("turns inside out, or a piece of it, when the new nodes of part `7` ")
        );
    }
}

#[test]
fn names_with_signs_of_f_and_of_options_stand_in_quotes_or_not() {
    let project = Project::with(TABLE);
    let names = "$PhysicalNames\n2\n1 7 \"a=b\"\n2 3 \"x=1; y=2\"\n$EndPhysicalNames\n$Nodes";
    project.write("m.msh", mesh(HOLE, "1", AROUND_HOLE).replacen("$Nodes", names, 1));
    let path = project.path("m.msh");
    let args = ["solve", "--domain", path.to_str().unwrap(), "--refine", "0", "--json"];
    let f = ["--f", "region(\"x=1; y=2\")=-2", "--curve", "a=b=0,0,0.5", "--free", "a=b"];
    let json = project.run(&[&args[..], &f].concat()).json();
    let plain = ["--f", "else=-2", "--curve", "a=b=0,0,0.5", "--free", "a=b"];
    assert_eq!(json["energy"], project.run(&[&args[..], &plain].concat()).json()["energy"]);
    assert_eq!(json["f"], "region(\"x=1; y=2\")=-2");
}

#[test]
fn regions_and_local_errors_are_in_files_of_any_mesh() {
    let project = Project::with(TABLE);
    for (ending, more) in
        [("npz", ["--refine", "2"]), ("vtu", ["--refine", "2"]), ("npz", ["--accuracy", "0.3"])]
    {
        let out = project.path(&format!("v.{ending}"));
        let args = ["solve", "--domain", "disc", "--f", "else=-1", "--out", out.to_str().unwrap()];
        let said = project.run(&[&args[..], &more].concat());
        assert!(said.err.is_empty(), "{said:?}");
        let file = std::fs::read(out).unwrap();
        for name in ["region", "local_error"] {
            assert!(file.windows(name.len()).any(|part| part == name.as_bytes()), "{name}");
        }
    }
}

#[test]
fn residuals_that_rounding_errors_leave_are_told() {
    let project = Project::with(TABLE);
    let said = |height: &str| {
        let (mut nodes, mut elements) = (Vec::new(), Vec::new());
        for k in 0..=300 {
            let x = f64::from(k) / 300.0;
            nodes.push(format!("{} {x} 0 0\n{} {x} {height} 0", k + 1, k + 302));
            if k < 300 {
                let [a, b, c, d] = [k + 1, k + 2, k + 303, k + 302];
                elements.push(format!("1 2 2 1 1 {a} {b} {c}\n1 2 2 1 1 {a} {c} {d}"));
            }
        }
        let file = mesh(&nodes.join("\n"), "1", &elements.join("\n"));
        ["multigrid", "active-set"].map(|solver| {
            let f = "rect(0,0.3,-9,9)=3; else=-2";
            solve(&project, &file, &["--f", f, "--refine", "0", "--json", "--solver", solver])
                .json()["warnings"]
                .to_string()
        })
    };
    let told = "rounding errors leave a KKT residual";
    assert!(said("1e-7").iter().all(|warnings| warnings.contains(told)), "{:?}", said("1e-7"));
    assert!(said("0.1").iter().all(|warnings| !warnings.contains(told)), "{:?}", said("0.1"));
}

#[test]
fn the_plane_solver_refuses_slits() {
    let nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 -1 1 0\n6 -1 0 0\n7 -1 -1 0\n8 0 -1 0\n9 1 -1 0\n10 1 0 0";
    let elements = (2..10).map(|k| format!("{k} 2 2 1 1 1 {k} {}", k + 1)).collect::<Vec<_>>();
    let file = mesh(nodes, "1", &elements.join("\n"));
    let project = Project::with(TABLE);
    for f in ["else=-1", "rect(-9,0,-9,0)=3; else=-2"] {
        project.write("slit.msh", &file);
        let path = project.path("slit.msh");
        let domain = path.to_str().unwrap();
        let said = project.run(&["solve", "--domain", domain, "--f", f, "--solver", "spectral"]);
        assert!(said.err.contains("has a slit"), "{}", said.err);
    }
}
