//! `signorini identify` and the stage of that name: what they say, how they stop, and what is kept.

use crate::common::{Project, Said, interrupt, wait_for_handler};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// Two grids and three rows of the published Table 2: enough to be searched in milliseconds.
const PAPER: &str = "r = [1e6, 10.0, 5.0]\n\n[[table]]\nnumber = 2\n\
    counts = [[3, 3], [3, 4], [3, 1]]\ndelta_a = [1e-2, 1e-2, 1e-2]\n\
    count_share = 0.0\ncount_slack = 0\ndelta_a_factor = 1e30\n";

const SCENE: &str = "title = \"Two\"\npaper_table = 2\nf = \"quadrant(ll)=-6; else=1.998\"\n\
    grids = [4, 8]\nr = [1e6, 10, 5]\n\
    load = { rule = \"nodal\", tie = \"lower-left\", diagonal = \"rising\" }\n\
    outputs = [\"identify\"]\n";

const RECORD: &str = "program = \"0123456\"\n\n[questions]\nvalues = \"-7:3:0.5\"\n\
    reach = [0.5, 0.5]\npoints = 5\n\n[[problem]]\ntable = 2\nalternatives = [[-6, 2, 1.99, 2]]\n\n\
    [selection]\ncommand = \"\"\ncandidates = 0\nvariant = []\n\n\
    [[run]]\nwhat = \"none\"\ncandidates = 0\noutcome = \"none\"\n";

fn project() -> Project {
    searching("-7:3:0.5")
}

/// Project whose search takes these values.
fn searching(values: &str) -> Project {
    let project = Project::with(SCENE);
    project.write("pipeline/paper.toml", PAPER);
    project.write("pipeline/identified.toml", RECORD.replace("-7:3:0.5", values));
    project
}

#[test]
fn json_has_every_field_and_the_table_the_same_order() {
    let project = project();
    let said = project.run(&["identify", "--json"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let json = said.json();
    assert_eq!(json["schema"], 1);
    let answer = &json["problems"][0];
    assert_eq!((&answer["problem"], &answer["complete"]), (&2.into(), &true.into()));
    assert!(answer["tried"].as_u64().unwrap() > 500, "{answer}");
    assert_eq!(answer["reached"][0], answer["tried"]);
    let recorded = &answer["recorded"][0];
    assert_eq!((&recorded["exact"], &recorded["cells"]), (&6.into(), &6.into()));
    let found = answer["found"].as_array().unwrap();
    assert!(found.len() > 1 && answer["exact"].as_u64().unwrap() >= found.len() as u64, "{answer}");
    for one in found {
        assert_eq!(one["exact"], 6);
        assert!(one["delta_a_exact"].is_number() && one["delta_a"].is_array(), "{one}");
        assert!(one["integral"].as_f64().unwrap() < 0.0);
    }
    let table = project.run(&["identify"]);
    let lines = table.lines();
    let shown = lines.iter().filter(|line| line.contains("6/6")).map(|line| {
        let (_, f) = line.split_once(" quadrant").unwrap();
        format!("quadrant{f}")
    });
    let all = std::iter::once(recorded).chain(found).map(|one| one["f"].as_str().unwrap());
    assert!(shown.eq(all), "{table:?}");
}

#[test]
fn the_search_is_repeated_under_each_reading_of_the_method() {
    let project = searching("-6:2:2");
    let said = project.run(&["identify", "--variants", "--json"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let json = said.json();
    let all = json["readings"].as_array().unwrap();
    assert_eq!((all.len(), &all[0]["description"]), (18, &"as selected".into()));
    let said = project.run(&["identify", "--variants"]);
    for (line, one) in said.lines()[1..=all.len()].iter().zip(all) {
        assert!(line.ends_with(one["description"].as_str().unwrap()), "{said:?}");
        let exact = one["searches"][0]["exact"].as_u64().unwrap();
        assert!(exact == 0 || line.trim_start().starts_with(&format!("{exact} on all grids")));
    }
}

#[test]
fn an_interrupted_search_shows_what_it_has_found() {
    let project = searching("-8:8:0.0005");
    let mut child = project.command(&["identify", "--json"]);
    let mut child = child.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    wait_for_handler(&child);
    interrupt(&child);
    let output: Said = {
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let out = lines.map(|line| line.unwrap() + "\n").collect();
        Said { code: child.wait().unwrap().code(), out, err: String::new() }
    };
    assert_eq!(output.code, Some(130), "{output:?}");
    let problems = output.json()["problems"].as_array().unwrap().clone();
    assert!(
        !problems.is_empty() && problems.iter().all(|problem| problem["complete"] == false),
        "{output:?}"
    );
}

#[test]
fn wrong_input_is_refused_in_one_line() {
    for (values, remedy) in [
        ("1:2", "write MIN:MAX:STEP with MIN <= MAX"),
        ("2:1:0.1", "write MIN:MAX:STEP with MIN <= MAX"),
        ("0:999999:0.000000001", "too many"),
        ("-999999999:999999999999999:0.000000001", "cannot read the values"),
    ] {
        let said = searching(values).run(&["identify"]);
        assert!(said.refusal().contains(remedy), "{said:?}");
    }
    let project = project();
    std::fs::remove_file(project.path("pipeline/identified.toml")).unwrap();
    assert!(project.run(&["identify"]).refusal().contains("restore it"));
}

#[test]
fn the_stage_runs_once_and_only_where_it_is_asked_for() {
    let project = project();
    let ran = project.run(&["run", "-v"]);
    assert_eq!(ran.ran(), ["figures/identifiability", "identify/a"], "no cell is solved");
    project.run(&["run", "-v"]).nothing_to_do();
    // Another map, and it runs again; the figure follows.
    project.write("pipeline/identified.toml", RECORD.replace("points = 5", "points = 3"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["figures/identifiability", "identify/a"]);
    // The title is the figure's business only.
    project.scene("a", &SCENE.replace("Two", "Second"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["figures/identifiability"]);
    project.scene("a", &SCENE.replace("identify", "source"));
    assert_eq!(project.run(&["run", "-v"]).ran(), ["figures/figure1"]);
}

#[test]
fn the_stage_names_what_it_lacks() {
    let project = project();
    std::fs::remove_file(project.path("pipeline/identified.toml")).unwrap();
    assert!(project.run(&["run"]).refusal().contains("needs pipeline/identified.toml"));
    project.write("pipeline/identified.toml", RECORD.replace("points", "pionts"));
    assert!(project.run(&["run"]).refusal().contains("pipeline/identified.toml: line"));
    project.write("pipeline/identified.toml", RECORD);
    project.scene("a", &SCENE.replace("quadrant(ll)=-6; else=1.998", "disc(0,0,0.1)=1; else=-1"));
    let said = project.run(&["run"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("not made of quadrants; correct it, or drop `identify`"), "{said:?}");
}
