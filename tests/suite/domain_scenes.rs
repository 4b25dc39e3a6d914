//! Scenes on domains other than the square: what they make, when they are made anew, and what is refused.

use crate::common::{Project, TABLE};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

/// Scene on the disc with all outputs that a domain in the plane has.
const DISC: &str = "title = \"Disc\"\nf = \"rect(-1,0,-1,0)=-6; else=1\"\n\
    domain = { name = \"disc\", refine = 3 }\nsolver = \"arrow-hurwicz\"\nr = [10, 1]\nstop = [\"printed-dual\", \"signed\"]\n\
    outputs = [\"table\", \"source\", \"surface\", \"contact\"]\n";

/// Scene on a file with a free hole.
const GEAR: &str = "title = \"Gear\"\nf = \"region(gear)=formula(x - 1)\"\n\
    domain = { name = \"meshes/gear.msh\", refine = 1, free = [\"hole\"], curve = { hole = [0, 0, 0.3] } }\n\
    solver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"printed-dual\"]\noutputs = [\"table\", \"surface\", \"contact\"]\n";

/// Scene in space, with a table alone.
const BALL: &str = "title = \"Ball\"\nf = \"formula(z - 1)\"\ndomain = { name = \"ball\", refine = 1 }\n\
    solver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"signed\"]\noutputs = [\"table\"]\n";

fn gear() -> String {
    let path = format!("{}/tests/meshes/gear.msh", env!("CARGO_MANIFEST_DIR"));
    fs::read_to_string(path).unwrap()
}

/// Writes the mesh of the gear into a project.
fn with_gear(project: Project) -> Project {
    fs::create_dir_all(project.path("pipeline/meshes")).unwrap();
    project.write("pipeline/meshes/gear.msh", gear());
    project
}

/// A project with the three scenes.
fn project() -> Project {
    let project = with_gear(Project::with(DISC));
    project.scene("gear", GEAR);
    project.scene("ball", BALL);
    project.add_book("# Domains\n\n![the disc](figures/a-surface.svg)\n");
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
    // The table of each scene has all its rows, rule by rule.
    for (scene, rows) in [("a", 4), ("gear", 1), ("ball", 1)] {
        let table =
            fs::read_to_string(project.path(&format!("report/tables/{scene}.csv"))).unwrap();
        assert!(table.starts_with("rule,r,"), "{table}");
        assert_eq!(table.lines().count(), 1 + rows, "{table}");
    }
    assert!(rows[0].starts_with("a,arrow-hurwicz,printed-dual,10.0,,"), "{}", rows[0]);
    assert!(rows.iter().all(|row| row.split(',').nth(9) == Some("true")), "{results}");
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
            .filter(|row| row.starts_with(&format!("{scene},arrow-hurwicz,{rule},{r},")))
            .map(|row| row.split(',').collect::<Vec<_>>())
            .collect();
        let grids = json["grids"].as_array().unwrap();
        assert_eq!(rows.len(), grids.len(), "{json}");
        for (row, grid) in rows.iter().zip(grids) {
            assert_eq!(
                [row[5], row[7]],
                [&*grid["nodes"].to_string(), &grid["iterations"].to_string()]
            );
        }
    }
    let said = project.run(&["solve", "a", "--refine", "4", "--solver", "multigrid"]);
    assert!(
        said.out.contains(
            "not as in the scene: solver multigrid instead of arrow-hurwicz, refine 4 instead of 3"
        ),
        "{said:?}"
    );
    for option in [&["--h", "1/8"][..], &["--load", "exact"], &["--domain", "disc"]] {
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
    ("limit", "law = { limit = 0.4 }\n"),
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

/// Solvers of scenes on every domain, each as the keys of a file; the first is the usual one.
const SOLVERS: [(&str, &str); 5] = [
    ("multigrid", ""),
    ("active-set", "solver = \"active-set\"\n"),
    ("arrow-hurwicz", "solver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"printed-dual\"]\n"),
    ("uzawa", "solver = \"uzawa\"\nr = [10]\nstop = [\"printed-dual\"]\n"),
    ("uzawa-proximal", "solver = \"uzawa-proximal\"\nr = [10]\nstop = [\"printed-dual\"]\n"),
];

/// Rows of `report/results.csv`, each by the names of its columns.
fn results(project: &Project) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(project.path("report/results.csv")).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<_> = lines.next().unwrap().collect();
    lines.map(|values| names.iter().cloned().zip(values).collect()).collect()
}

/// Number in a column of a row, none if it is empty.
fn number(row: &BTreeMap<String, String>, column: &str) -> Option<f64> {
    let text = &row[column];
    (!text.is_empty()).then(|| text.parse().unwrap())
}

/// Compares the answer of `solve` to a scene with its rows among the results.
fn same_numbers(scene: &str, solver: &str, json: &Value, results: &[BTreeMap<String, String>]) {
    assert_eq!(json["solver"], solver, "{scene}");
    let grids = json["grids"].as_array().unwrap();
    let rows: Vec<_> = results.iter().filter(|row| row["problem"] == scene).collect();
    assert_eq!(rows.len(), grids.len(), "{scene}: {json}");
    for (row, grid) in rows.iter().zip(grids) {
        assert_eq!(row["solver"], solver);
        assert_eq!(row["iterations"], grid["iterations"].to_string(), "{scene}: {json}");
        assert_eq!(row["stop"], grid["stop"], "{scene}: {json}");
        let said = [&grid["energy"], &grid["sum_load"], &grid["kkt"]["natural"]];
        let numbers = ["energy", "sum_load", "kkt_natural"].map(|name| number(row, name));
        assert_eq!(numbers, said.map(Value::as_f64), "{scene}: {json}");
    }
    let row = rows[rows.len() - 1];
    let values = ["v_least", "v_greatest"].map(|name| (number(row, name), json[name].as_f64()));
    assert!(
        values.iter().all(|(of_run, of_solve)| of_run.is_some() && of_run == of_solve),
        "{scene}: {json}"
    );
    let bounds = ["energy_lower", "energy_upper", "error_bound", "error_relative"];
    let bounds = bounds.map(|name| number(row, name));
    if ["multigrid", "active-set"].contains(&solver) {
        let bound = &json["bound"];
        let relative = &bound["relative"]["error"];
        let said = [&bound["energy"][0], &bound["energy"][1], &bound["error"][1], relative];
        assert_eq!(bounds, said.map(Value::as_f64), "{scene}: {json}");
        let reserve: Vec<_> = bound["reserve"].as_array().unwrap().iter().collect();
        assert_eq!(row["reserve"].split_whitespace().collect::<Vec<_>>(), reserve, "{scene}");
        assert_eq!([&row["rule"], &row["r"], &row["tolerance"], &row["met"]], [""; 4]);
    } else {
        assert_eq!(bounds, [None; 4], "{scene}");
        assert_eq!([&row["rule"], &row["r"]], ["printed-dual", "10.0"]);
    }
}

/// Laws of [`LAWS`] as options of `solve`.
const LAW_OPTIONS: [&[&str]; 3] = [&[], &["--friction", "0.45"], &["--limit", "0.4"]];

/// f and the domain of [`DOMAINS`] as options of `solve`.
const DOMAIN_OPTIONS: [&[&str]; 7] = [
    &["--f", "formula(16*x - 0.5)", "--h", "1/8"],
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

/// Laws under which a solver is tried on a domain, by their places in the tables: the usual solver under each, so that
/// the others have an energy to compare with, and every other under one, so that each pair of solver and law, of solver
/// and domain, and of law and domain is tried.
fn laws_tried(solver: usize, domain: usize) -> Vec<usize> {
    let all = 0..LAWS.len();
    all.filter(|law| solver == 0 || (solver + domain) % LAWS.len() == *law).collect()
}

/// Answer of `solve` to the options that state what a scene states.
fn answer_to_options(project: &Project, solver: &str, stated: [&[&str]; 2]) -> Value {
    let mut options = [&["solve", "--json", "--solver", solver], stated[0], stated[1]].concat();
    if ["arrow-hurwicz", "uzawa", "uzawa-proximal"].contains(&solver) {
        options.extend(["--r", "10", "--stop", "printed-dual"]);
    }
    project.run(&options).json()
}

#[test]
fn run_scene_and_options_have_one_answer() {
    // A project for each domain: every command reads all scenes of its project.
    for (of_domain, (domain, domain_keys)) in DOMAINS.into_iter().enumerate() {
        let project = with_gear(Project::empty());
        fs::create_dir(project.path("pipeline/scenes")).unwrap();
        // The table of all results is made for a book.
        project.add_book("# One\n");
        let mut scenes = Vec::new();
        for (of_solver, (solver, keys)) in SOLVERS.into_iter().enumerate() {
            for law in laws_tried(of_solver, of_domain) {
                let (law_name, law_keys) = LAWS[law];
                let name = format!("{domain}-{law_name}-{solver}");
                let keys = format!("{domain_keys}{law_keys}{keys}outputs = [\"table\"]\n");
                project.scene(&name, &format!("title = \"t\"\n{keys}"));
                scenes.push((name, law, solver));
            }
        }
        project.run(&["run"]).lines();
        let results = results(&project);
        let mut solutions = [f64::NAN; LAWS.len()];
        for (scene, law, solver) in scenes {
            let json = project.run(&["solve", &scene, "--json"]).json();
            same_numbers(&scene, solver, &json, &results);
            let stated = [DOMAIN_OPTIONS[of_domain], LAW_OPTIONS[law]];
            let options = answer_to_options(&project, solver, stated);
            for key in ["energy", "kkt", "sum_load", "stop", "bound", "iterations"] {
                assert_eq!(json[key], options[key], "{scene} {key}");
            }
            let energy = json["energy"].as_f64().unwrap();
            if solver == "multigrid" {
                solutions[law] = energy;
            } else if solver == "active-set" {
                let solution = solutions[law];
                assert!((energy / solution - 1.0).abs() < 1e-9, "{scene}: {energy} {solution}");
            }
        }
        // Each law has a solution of its own, so that none stands in for another.
        let [papers, friction, limit] = solutions;
        assert!(papers < 0.0 && friction < 0.0 && limit < 0.0, "{domain}");
        assert!(papers != friction && friction != limit && limit != papers, "{domain}");
    }
}

/// Two scenes on the square that choose their grid, and one without.
const WITHOUT_GRIDS: [(&str, &str); 3] = [
    ("close", "accuracy = 0.05\n"),
    ("energy", "accuracy_energy = 1e-4\n"),
    ("true", "solver = \"spectral\"\ngrids = [16]\n"),
];

#[test]
fn a_scene_may_ask_for_an_accuracy_or_for_the_true_solution() {
    let plate = "title = \"Plate\"\nf = \"rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5\"\n";
    let project = Project::with(&format!("{plate}outputs = [\"table\"]\n"));
    for (name, keys) in WITHOUT_GRIDS {
        let outputs = "outputs = [\"table\", \"source\", \"surface\", \"contact\"]\n";
        project.scene(name, &format!("{plate}{keys}{outputs}"));
    }
    project.add_book("# Plates\n\n![v](figures/close-surface.svg)\n");
    project.run(&["run"]).lines();
    project.run(&["run"]).nothing_to_do();
    let results = results(&project);
    let truth = project.run(&["solve", "true", "--json"]).json();
    let energy = truth["energy"].as_f64().unwrap();
    for (name, _) in WITHOUT_GRIDS {
        let json = project.run(&["solve", name, "--json"]).json();
        let rows: Vec<_> = results.iter().filter(|row| row["problem"] == name).collect();
        let row = rows[rows.len() - 1];
        assert_eq!(number(row, "energy"), json["energy"].as_f64(), "{name}: {json}");
        assert_eq!(row["iterations"], json["iterations"].to_string(), "{name}: {json}");
        let svg = fs::read_to_string(project.path(&format!("figures/{name}-surface.svg"))).unwrap();
        if name == "true" {
            assert_eq!((rows.len(), &*row["nodes"]), (1, ""));
            let bracket = ["energy_lower", "energy_upper"].map(|name| number(row, name).unwrap());
            assert!(bracket[0] <= energy && energy <= bracket[1], "{bracket:?} {energy}");
            assert!(svg.contains(">Plate</text>"), "{svg}");
            continue;
        }
        // Finer and finer grids, the last one as close as was asked for, with the true energy in its bracket.
        assert_eq!(rows.len(), json["grids"].as_array().unwrap().len());
        assert!(rows.len() > 1);
        assert_eq!(row["cells"], json["grids"][rows.len() - 1]["cells"].to_string());
        let [low, high] = ["energy_lower", "energy_upper"].map(|name| number(row, name).unwrap());
        assert!(low <= energy && energy <= high, "{low} {energy} {high}");
        let (accuracy, reached) = match name {
            "close" => (0.05, number(row, "error_bound").unwrap() / (-2.0 * high).sqrt()),
            _ => (1e-4, (high - low) / -high),
        };
        assert!(reached <= accuracy, "{name}: {reached}");
        let answers = number(row, "energy").unwrap();
        assert!(name == "close" || (low <= answers && answers <= high), "{low} {answers} {high}");
        let error = 100.0 * json["bound"]["relative"]["error"].as_f64().unwrap();
        let error = signorini_mathematics::problem::text::plain(error, 3);
        let title = format!(">error at most {error} %</text>");
        assert!(svg.contains(&title), "{title}");
        assert!(svg.contains("<desc>Guaranteed: true energy in [-0.0417"), "{svg}");
    }
    // As `solve --accuracy` does.
    let f = "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5";
    let option = project.run(&["solve", "--f", f, "--accuracy", "0.05", "--json"]).json();
    let scene = project.run(&["solve", "close", "--json"]).json();
    for key in ["energy", "bound", "grids", "contact", "settings"] {
        assert_eq!(option[key], scene[key], "{key}");
    }
    // Options that name a grid or a solver replace the accuracy, which the answer says.
    for options in [&["--h", "1/32"][..], &["--solver", "active-set"], &["--r", "10"]] {
        let said = project.run(&[&["solve", "close"], options].concat());
        assert!(said.out.contains("without accuracy = 0.05"), "{said:?}");
    }
    // What no grid reaches is told in options by `solve`, and in keys by `run`.
    project.scene("close", &format!("{plate}accuracy = 1e-9\noutputs = [\"table\"]\n"));
    for (command, [asked, remedy]) in [
        ("solve", ["--accuracy 1e-9 takes a grid", "--solver spectral needs no grid"]),
        ("run", ["accuracy = 1e-9 takes a grid", "solver = \"spectral\" needs no grid"]),
    ] {
        let said = project.run(&[command, "close"]);
        assert!(said.err.contains(asked) && said.err.contains(remedy), "{said:?}");
    }
}

#[test]
fn the_table_of_a_solver_without_rules_has_its_bounds() {
    let plate =
        "title = \"t\"\nf = \"rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5\"\ngrids = [8, 16]\n";
    let project = Project::with(&format!("{plate}outputs = [\"table\"]\n"));
    project.run(&["run"]).lines();
    let head = "grid,iterations,stop,energy,energy_lower,energy_upper,error_bound,error_relative,kkt_relative\n";
    let made = project.files(".signorini/v2/objects");
    let mut texts = made.values().map(|bytes| String::from_utf8_lossy(bytes));
    let table = texts.find_map(|text| text.strip_prefix(head).map(str::to_owned)).unwrap();
    let mut lines = table.lines();
    let row: Vec<_> = lines.next().unwrap().split(',').collect();
    let bound = &project.run(&["solve", "a", "--json"]).json()["bound"];
    assert_eq!((row[0], row[2]), ("1/16", "rounding-floor"));
    let said =
        [&bound["energy"][0], &bound["energy"][1], &bound["error"][1], &bound["relative"]["error"]];
    let numbers = [4, 5, 6, 7].map(|place| row[place].parse::<f64>().ok());
    assert_eq!(numbers, said.map(Value::as_f64), "{table}");
    assert_eq!(lines.next(), None, "{table}");
}

#[test]
fn a_name_alone_is_a_domain() {
    let project = project();
    for (name, kind) in [("disc", "rect"), ("meshes/gear.msh", "rect"), ("cube", "box")] {
        let numbers = if kind == "box" { "-1,0,-1,0,-1,0" } else { "-1,0,-1,0" };
        let text = format!(
            "title = \"t\"\nf = \"{kind}({numbers})=1; else=-2\"\ndomain = \"{name}\"\noutputs = \
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
fn scenes_without_a_boundary_in_contact_run_as_they_are_solved() {
    let project = Project::with(TABLE);
    project.add_book("# One\n");
    let pictures = "outputs = [\"table\", \"source\", \"surface\", \"map\", \"contact\"]\n";
    let disc = "domain = { name = \"disc\", refine = 1, fixed = [\"rim\"] }\n";
    let annulus =
        "domain = { name = \"annulus\", refine = 0, fixed = [\"inner\"], free = [\"outer\"] }\n";
    let ball = "domain = { name = \"ball\", refine = 0, fixed = [\"surface\"] }\n";
    let mut scenes =
        vec![format!("{}accuracy = 0.3\n{pictures}", disc.replace(", refine = 1", ""))];
    for keys in
        ["", "solver = \"arrow-hurwicz\"\n", "solver = \"uzawa\"\n", "law = { friction = 1 }\n"]
    {
        for (domain, outputs) in
            [(disc, pictures), (annulus, pictures), (ball, "outputs = [\"table\"]\n")]
        {
            scenes.push(format!("{domain}{keys}{outputs}"));
        }
    }
    for (k, keys) in scenes.iter().enumerate() {
        project.scene(&format!("held{k}"), &format!("title = \"Held\"\nf = \"else=-1\"\n{keys}"));
    }
    project.run(&["run"]).lines();
    let csv = fs::read_to_string(project.path("report/results.csv")).unwrap();
    let columns: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let at = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let held: Vec<_> = rows.iter().filter(|row| row[0].starts_with("held")).collect();
    assert!(held.len() >= scenes.len());
    for row in held {
        assert_eq!([row[at("kkt_min_y")], row[at("kkt_min_lambda")]], ["", ""], "{row:?}");
        let finite = |name: &str| row[at(name)].parse().is_ok_and(f64::is_finite);
        assert!(["energy", "kkt_natural", "kkt_relative"].into_iter().all(finite), "{row:?}");
    }
    let json = project.run(&["solve", "held1", "--json"]).json();
    assert!(json["kkt"]["min_y"].is_null() && json["energy"].as_f64().unwrap() < 0.0, "{json}");
}
