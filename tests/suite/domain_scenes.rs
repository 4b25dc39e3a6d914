//! Scenes on domains other than the square: what they make, when they are made anew, and what is refused.

use crate::common::{Project, TABLE};
use std::fs;

/// Scene on the disc with all outputs that a domain in the plane has.
const DISC: &str = "title = \"Disc\"\nf = \"rect(-1,0,-1,0)=-6; else=1\"\n\
    domain = { name = \"disc\", refine = 3 }\nr = [10, 1]\nstop = [\"printed-dual\", \"signed\"]\n\
    outputs = [\"table\", \"source\", \"surface\", \"contact\"]\n";

/// Scene on a file with a free hole.
const GEAR: &str = "title = \"Gear\"\nf = \"region(gear)=formula(x - 1)\"\n\
    domain = { name = \"meshes/gear.msh\", refine = 1, free = [\"hole\"], curve = { hole = [0, 0, 0.3] } }\n\
    r = [10]\nstop = [\"printed-dual\"]\noutputs = [\"table\", \"surface\", \"contact\"]\n";

/// Scene in space, with a table alone.
const BALL: &str = "title = \"Ball\"\nf = \"formula(z - 1)\"\ndomain = { name = \"ball\", refine = 1 }\n\
    r = [10]\noutputs = [\"table\"]\n";

fn gear() -> String {
    let path = format!("{}/tests/meshes/gear.msh", env!("CARGO_MANIFEST_DIR"));
    fs::read_to_string(path).unwrap()
}

/// A project with the three scenes.
fn project() -> Project {
    let project = Project::with(DISC);
    project.scene("gear", GEAR);
    project.scene("ball", BALL);
    fs::create_dir(project.path("pipeline/meshes")).unwrap();
    project.write("pipeline/meshes/gear.msh", gear());
    fs::create_dir(project.path("report/templates")).unwrap();
    project.write("report/book.toml", "[book]\ntitle = \"Domains\"\n");
    project.write("report/templates/SUMMARY.md", "- [Domains](domains.md)\n");
    project
        .write("report/templates/domains.md", "# Domains\n\n![the disc](figures/a-surface.svg)\n");
    project
}

#[test]
fn tables_and_pictures_are_made_and_kept() {
    let project = project();
    project.run(&["run"]).lines();
    for figure in ["a-source", "a-surface", "a-contact", "gear-surface", "gear-contact"] {
        let svg = fs::read_to_string(project.path(&format!("figures/{figure}.svg"))).unwrap();
        assert!(svg.contains("</svg>"), "{figure}");
    }
    // A panel for the teeth and one for the hole, where there is no multiplier.
    let contact = fs::read_to_string(project.path("figures/gear-contact.csv")).unwrap();
    let (teeth, hole): (Vec<_>, Vec<_>) =
        contact.lines().skip(1).partition(|line| line.starts_with("Gear: teeth,"));
    assert!(!teeth.is_empty() && !hole.is_empty());
    assert!(hole.iter().all(|line| line.starts_with("Gear: hole,") && line.ends_with(",0")));
    // A row for each r, rule and mesh; meshes have nodes, and no cells per side.
    let results = fs::read_to_string(project.path("report/results.csv")).unwrap();
    let rows: Vec<_> = results.lines().skip(1).collect();
    let of = |start: &str| rows.iter().filter(|row| row.starts_with(start)).count();
    assert_eq!([of("a,"), of("gear,"), of("ball,")], [2 * 2 * 4, 2, 2], "{results}");
    assert!(rows[0].starts_with("a,printed-dual,10.0,,"), "{}", rows[0]);
    assert!(rows.iter().all(|row| row.split(',').nth(8) == Some("true")), "{results}");
    project.run(&["run"]).nothing_to_do();
}

#[test]
fn counts_are_those_of_the_command() {
    let project = project();
    project.run(&["run"]).lines();
    for scene in ["a", "gear", "ball"] {
        let said = project.run(&["solve", scene, "--json"]);
        // The rule stops on coarse meshes of the gear before there is a solution, which the answer says.
        assert_eq!(said.code, Some(if scene == "gear" { 3 } else { 0 }), "{said:?}");
        let json = said.json();
        let results = fs::read_to_string(project.path("report/results.csv")).unwrap();
        let rule = if scene == "ball" { "signed" } else { "printed-dual" };
        let r = if scene == "a" { "1.0" } else { "10.0" };
        let rows: Vec<_> = results
            .lines()
            .filter(|row| row.starts_with(&format!("{scene},{rule},{r},")))
            .map(|row| row.split(',').collect::<Vec<_>>())
            .collect();
        let grids = json["grids"].as_array().unwrap();
        assert_eq!(rows.len(), grids.len(), "{json}");
        for (row, grid) in rows.iter().zip(grids) {
            assert_eq!(
                [row[4], row[6]],
                [&*grid["nodes"].to_string(), &grid["iterations"].to_string()]
            );
        }
    }
    let said = project.run(&["solve", "a", "--refine", "4", "--solver", "multigrid"]);
    assert!(said.out.contains("not as in the scene: refine 4 instead of 3"), "{said:?}");
    for option in [&["--h", "1/8"][..], &["--load", "exact"], &["--free", "rim"]] {
        let said = project.run(&[&["solve", "a"], option].concat());
        assert!(said.refusal().contains(option[0]), "{said:?}");
    }
    let said = project.run(&["solve", "ball", "--out", "v.vtu", "--solver", "multigrid"]);
    assert!(said.out.contains("wrote v.vtu"), "{said:?}");
}

/// Laws of scenes, as their files have them; the first is the paper's.
const LAWS: [(&str, &str); 3] = [
    ("papers", ""),
    ("friction", "law = { friction = 0.45 }\n"),
    ("limit", "law = { limit = 0.7 }\n"),
];

/// Kinds of domain that a scene can have, each with an f that no law leaves at v = 0.
const DOMAINS: [(&str, &str); 7] = [
    ("square", "f = \"formula(16*x - 0.5)\"\ngrids = [4, 8]\n"),
    ("disc", "f = \"formula(3*x - 0.5)\"\ndomain = { name = \"disc\", refine = 2 }\n"),
    ("lshape", "f = \"formula(3*x - 0.1)\"\ndomain = { name = \"lshape\", refine = 2 }\n"),
    ("annulus", "f = \"formula(9*x - 0.5)\"\ndomain = { name = \"annulus\", refine = 1 }\n"),
    ("cube", "f = \"formula(16*x - 0.5)\"\ndomain = { name = \"cube\", refine = 2 }\n"),
    ("ball", "f = \"formula(6*x - 0.5)\"\ndomain = { name = \"ball\", refine = 1 }\n"),
    (
        "gear",
        "f = \"formula(3*x - 0.5)\"\n\
         domain = { name = \"meshes/gear.msh\", refine = 0, free = [\"hole\"] }\n",
    ),
];

#[test]
fn run_and_solve_have_one_answer_under_every_law_on_every_domain() {
    let project = project();
    for ((law, key), (domain, of_domain)) in
        LAWS.iter().flat_map(|law| DOMAINS.map(|of| (*law, of)))
    {
        let text = format!(
            "title = \"{domain}\"\n{of_domain}{key}r = [10]\nstop = [\"printed-dual\"]\noutputs = [\"table\"]\n"
        );
        project.scene(&format!("{domain}-{law}"), &text);
    }
    project.run(&["run"]).lines();
    let results = fs::read_to_string(project.path("report/results.csv")).unwrap();
    let mut energies = Vec::new();
    for (scene, (law, domain)) in DOMAINS
        .iter()
        .flat_map(|(domain, _)| LAWS.map(|(law, _)| (format!("{domain}-{law}"), (law, *domain))))
    {
        let json = project.run(&["solve", &scene, "--json"]).json();
        let grids = json["grids"].as_array().unwrap();
        let rows: Vec<Vec<&str>> = results
            .lines()
            .filter(|row| row.starts_with(&format!("{scene},")))
            .map(|row| row.split(',').collect())
            .collect();
        assert_eq!(rows.len(), grids.len(), "{scene}: {json}");
        for (row, grid) in rows.iter().zip(grids) {
            assert_eq!(row[6], grid["iterations"].to_string(), "{scene}: {json}");
            assert_eq!(row[7], grid["stop"], "{scene}: {json}");
            let numbers = [row[12], row[13], row[18]].map(|number| number.parse::<f64>().unwrap());
            let said = [&grid["energy"], &grid["sum_load"], &grid["kkt"]["natural"]];
            assert_eq!(numbers, said.map(|number| number.as_f64().unwrap()), "{scene}: {json}");
        }
        energies.push((domain, law, json["energy"].as_f64().unwrap()));
    }
    // Each law has a solution of its own, so that none stands in for another.
    for laws in energies.chunks(3) {
        let [papers, friction, limit] = [0, 1, 2].map(|at| laws[at].2);
        assert!(papers < 0.0 && friction < 0.0 && limit < 0.0, "{laws:?}");
        assert!(papers != friction && friction != limit && limit != papers, "{laws:?}");
    }
}

/// Laws of [`LAWS`] as options of `solve`.
const LAW_OPTIONS: [&[&str]; 3] = [&[], &["--friction", "0.45"], &["--limit", "0.7"]];

/// f and the domain of [`DOMAINS`] as options of `solve`.
const DOMAIN_OPTIONS: [&[&str]; 7] = [
    &["--f", "formula(16*x - 0.5)", "--h", "1/8", "--load", "nodal"],
    &["--f", "formula(3*x - 0.5)", "--domain", "disc", "--refine", "2"],
    &["--f", "formula(3*x - 0.1)", "--domain", "lshape", "--refine", "2"],
    &["--f", "formula(9*x - 0.5)", "--domain", "annulus", "--refine", "1"],
    &["--f", "formula(16*x - 0.5)", "--domain", "cube", "--refine", "2"],
    &["--f", "formula(6*x - 0.5)", "--domain", "ball", "--refine", "1"],
    &[
        "--f",
        "formula(3*x - 0.5)",
        "--domain",
        "pipeline/meshes/gear.msh",
        "--refine",
        "0",
        "--free",
        "hole",
    ],
];

#[test]
fn scenes_and_options_have_one_answer_under_every_law_by_every_other_solver() {
    let project = project();
    // The paper's method, which `run` has as well, is above.
    let solvers = ["uzawa", "uzawa-proximal", "active-set", "multigrid"];
    for ((law, key), law_options) in LAWS.into_iter().zip(LAW_OPTIONS) {
        for ((domain, of_domain), domain_options) in DOMAINS.into_iter().zip(DOMAIN_OPTIONS) {
            let text = format!(
                "title = \"t\"\n{of_domain}{key}r = [10]\nstop = [\"printed-dual\"]\noutputs = [\"table\"]\n"
            );
            project.scene("one", &text);
            for solver in solvers {
                let by_solver = ["--solver", solver, "--json"];
                let scene = project.run(&[&["solve", "one"], &by_solver[..]].concat()).json();
                let mut options = [&["solve"], domain_options, law_options].concat();
                if solver.starts_with("uzawa") {
                    options.extend(["--r", "10", "--stop", "printed-dual"]);
                }
                let options = project.run(&[&options[..], &by_solver[..]].concat()).json();
                for key in ["energy", "kkt", "sum_load", "stop", "bound", "iterations"] {
                    assert_eq!(scene[key], options[key], "{domain} {law} {solver} {key}");
                }
                assert!(scene["energy"].is_f64(), "{scene}");
            }
        }
    }
}

#[test]
fn a_name_alone_is_a_domain() {
    let project = project();
    for (name, kind) in [("disc", "rect"), ("meshes/gear.msh", "rect"), ("cube", "box")] {
        let numbers = if kind == "box" { "-1,0,-1,0,-1,0" } else { "-1,0,-1,0" };
        let text = format!(
            "title = \"t\"\nf = \"{kind}({numbers})=1; else=-2\"\ndomain = \"{name}\"\nr = [10]\noutputs = \
             [\"table\"]\n"
        );
        project.scene("alone", &text);
        let json = project.run(&["solve", "alone", "--solver", "multigrid", "--json"]).json();
        assert_eq!(json["stop"], "rounding-floor", "{json}");
    }
}

#[test]
fn an_edited_mesh_makes_its_scene_alone_anew() {
    let project = project();
    project.run(&["run"]).lines();
    // Another name of the file's part: the same domain in other bytes.
    project.write("pipeline/meshes/gear.msh", gear().replace("\"teeth\"", "\"cogs\""));
    let stale = project.stale();
    assert!(stale.iter().any(|id| id.starts_with("solve/gear/")), "{stale:?}");
    let others: Vec<_> = stale.iter().filter(|id| !id.contains("gear")).collect();
    assert!(
        others.iter().all(|id| ["diff/results", "report/book"].contains(&&***id)),
        "{others:?}"
    );
    let said = project.run(&["explain", "solve/gear"]);
    assert!(said.out.contains("file pipeline/meshes/gear.msh: "), "{said:?}");
    project.run(&["run"]).lines();
    project.run(&["run"]).nothing_to_do();
}

#[test]
fn what_does_not_go_with_a_domain_is_refused_in_one_line() {
    let project = Project::with(TABLE);
    for (from, to, words) in [
        ("r = [10, 1]", "r = [10]\ngrids = [4, 8]", "`grids` is for the square"),
        ("r = [10, 1]", "r = [10]\nload = { rule = \"exact\" }", "`load` is for the square"),
        ("r = [10, 1]", "r = [10]\nprolongation = \"bilinear\"", "`prolongation` is for"),
        ("r = [10, 1]", "r = [10]\npaper_table = 1", "`paper_table` is for the square"),
        ("r = [10, 1]", "r = [10]\nhuh = 1", "unknown field `huh`"),
        ("\"source\"", "\"history\"", "`history` is for the square"),
        ("\"source\"", "\"identify\"", "`identify` is for the square"),
        ("refine = 3", "refines = 3", "unknown field `refines`"),
        ("refine = 3", "refine = 19", "more than is sensible"),
        ("refine = 3", "free = [\"hole\"]", "free hole: the mesh has no part `hole`"),
        ("refine = 3", "fixed = [\"hole\"]", "fixed hole: the mesh has no part"),
        ("refine = 3", "curve = { rim = [0, 0] }", "curve rim: "),
        ("name = \"disc\"", "name = \"x.msh\"", "there is no pipeline/x.msh"),
        ("name = \"disc\", ", "", "missing field `name`"),
        (
            "name = \"disc\"",
            "name = \"gear\"",
            "there is no pipeline/gear; put the mesh there, or name one of the domains square, cube",
        ),
        ("name = \"disc\"", "name = \"../x.msh\"", "name a file below pipeline/"),
        ("name = \"disc\"", "name = \"./scenes/a.toml\"", "by its shortest path"),
        ("name = \"disc\"", "name = \"scenes//a.toml\"", "by its shortest path"),
        ("name = \"disc\"", "name = \"scenes/./a.toml\"", "by its shortest path"),
        ("name = \"disc\"", "name = \"scenes/../scenes/a.toml\"", "by its shortest path"),
        ("name = \"disc\"", "name = \"scenes/a.toml/\"", "by its shortest path"),
        ("name = \"disc\"", "name = \"scenes/a.toml\"", "does not begin with $MeshFormat"),
        ("{ name = \"disc\", refine = 3 }", "3", "a table such as { name = \"disc\""),
        ("else=1", "else=7", "(2) asks for a negative one"),
        ("else=1", "els=1", "cannot read `els=1`"),
        ("r = [10, 1]", "r = []", "`r` and `stop` must not be empty"),
        ("name = \"disc\"", "name = \"ball\"", "cannot read `rect("),
    ] {
        assert!(DISC.contains(from), "{from}");
        project.scene("a", &DISC.replace(from, to));
        let said = project.run(&["run"]);
        assert!(said.refusal().contains(words), "{words}: {said:?}");
        assert!(said.err.contains("scene `a`: "), "{said:?}");
    }
    project.scene("a", &BALL.replace("[\"table\"]", "[\"surface\"]"));
    let said = project.run(&["run"]);
    assert!(said.refusal().contains("signorini solve a --out a.vtu"), "{said:?}");
}
