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

const RECORD: &str = "[questions]\nspace = \"odd-quadrant\"\nvalues = \"-7:3:0.5\"\ntop = 2\n\
    reach = [0.5, 0.5]\npoints = 5\n\n[[problem]]\ntable = 2\nalternatives = [\"-6; 2; 1.99; 2\"]\n\n\
    [selection]\ncommands = []\ncandidates = 0\nvariant = []\n\n\
    [[run]]\nwhat = \"none\"\ncandidates = 0\noutcome = \"none\"\n";

fn project() -> Project {
    let project = Project::with(SCENE);
    project.write("pipeline/paper.toml", PAPER);
    project.write("pipeline/identified.toml", RECORD);
    project
}

#[test]
fn json_has_every_field_and_the_table_the_same_ranking() {
    let project = project();
    let args = ["identify", "--problem", "2", "--values", "-7:3:0.5", "--top", "3"];
    let said = project.run(&[&args[..], &["--json"]].concat());
    assert_eq!(said.code, Some(0), "{said:?}");
    let json = said.json();
    assert_eq!(json["schema"], 1);
    let answer = &json["problems"][0];
    assert_eq!((&answer["problem"], &answer["complete"]), (&2.into(), &true.into()));
    assert!(answer["tried"].as_u64().unwrap() > 500, "{answer}");
    assert_eq!(answer["entered"][0], answer["tried"]);
    assert_eq!(answer["rates"].as_array().unwrap().len(), 2);
    assert!(answer["seconds"].as_f64().unwrap() >= 0.0);
    assert_eq!(answer["request"]["space"], "odd-quadrant");
    let found = answer["found"].as_array().unwrap();
    assert_eq!(found.len(), 3);
    for one in found {
        for part in ["exact", "cells", "misfit", "delta_a_exact", "delta_a_misfit", "complexity"] {
            assert!(one["score"][part].is_number(), "{part}");
        }
        assert!(one["integral"].as_f64().unwrap() < 0.0);
    }
    assert_eq!(found[0]["score"]["exact"], 6);
    let table = project.run(&args);
    let lines = table.lines();
    for (rank, one) in found.iter().enumerate() {
        let line = lines.iter().find(|line| line.starts_with(&format!("{:>4} ", rank + 1)));
        assert!(line.unwrap().ends_with(one["f"].as_str().unwrap()), "{table:?}");
    }
    assert!(table.out.contains("complexity  distinct values of f"), "{table:?}");
    let single = project.run(&[&args[..], &["--json", "--threads", "1"]].concat()).json();
    assert_eq!(single["problems"][0]["found"], answer["found"], "whatever the threads");
}

#[test]
fn readings_of_the_method_are_ranked() {
    let said = project().run(&["identify", "--variants", "--values", "-6,2", "--json"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let json = said.json();
    let all = json["selection"].as_array().unwrap();
    assert!(all.len() > 10 && json["request"]["space"] == "odd-quadrant");
    assert!(all.iter().any(|one| one["description"] == "as selected"), "{json}");
    let said = project().run(&["identify", "--variants", "--values", "-6,2"]);
    for (line, one) in said.lines()[1..=all.len()].iter().zip(all) {
        assert!(line.ends_with(one["description"].as_str().unwrap()), "{said:?}");
    }
}

#[test]
fn an_interrupted_search_goes_on_to_the_same_end() {
    let project = project();
    let args = ["identify", "--values", "-7:3:0.01", "--json"];
    let whole = project.run(&args).json();
    let resumable = [&args[..], &["--checkpoint", "state.json"]].concat();
    let mut child = project.command(&resumable);
    let mut child = child.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    wait_for_handler(&child);
    interrupt(&child);
    let output: Said = {
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let out = lines.map(|line| line.unwrap() + "\n").collect();
        Said { code: child.wait().unwrap().code(), out, err: String::new() }
    };
    assert_eq!(output.code, Some(130), "{output:?}");
    let partial = &output.json()["problems"][0];
    assert_eq!(partial["complete"], false, "what was found until then is shown");
    let resumed = project.run(&resumable);
    assert_eq!(resumed.code, Some(0), "{resumed:?}");
    for field in ["found", "tried", "entered", "complete"] {
        assert_eq!(resumed.json()["problems"][0][field], whole["problems"][0][field], "{field}");
    }
    // A finished search is only shown again; a different one is refused.
    let again = project.run(&resumable).json();
    assert_eq!(again["problems"][0]["found"], whole["problems"][0]["found"]);
    let other = ["identify", "--values", "-7:3:0.02", "--checkpoint", "state.json"];
    assert!(project.run(&other).err.contains("belongs to a different search"));
}

#[test]
fn the_parts_of_a_search_are_together_the_whole() {
    let project = project();
    // Times and rates aside.
    let timeless = |said: Said| {
        let mut json = said.json();
        let answer = json["problems"][0].as_object_mut().unwrap();
        assert!(answer.remove("seconds").is_some() && answer.remove("rates").is_some());
        serde_json::to_string(&json).unwrap()
    };
    for search in [
        // Four blocks, on which more depends than the order.
        &["--values", "-8:4:0.02", "--exact-grids", "1", "--top", "7"][..],
        &["--space", "quadrants", "--values", "-8:4:0.5", "--chains", "7", "--steps", "40"],
    ] {
        let args = [&["identify", "--json"], search].concat();
        let whole = timeless(project.run(&args));
        let files = ["p1.json", "p2.json", "p3.json"];
        for (part, file) in ["1/3", "2/3", "3/3"].into_iter().zip(files) {
            let _ = std::fs::remove_file(project.path(file));
            let args = [&args[..], &["--part", part, "--checkpoint", file]].concat();
            let said = project.run(&args);
            assert!(said.json()["problems"][0]["tried"].as_u64().unwrap() > 0, "{part}: {said:?}");
        }
        let merge =
            |files: &[&str]| project.run(&[&["identify", "--json", "--merge"], files].concat());
        assert_eq!(timeless(merge(&files)), whole);
        assert_eq!(timeless(merge(&["p3.json", "p1.json", "p2.json"])), whole, "in any order");
        let refusals = [
            (&files[..2], "part 3/3 is missing; make it with --part 3/3"),
            (&["p1.json", "p2.json", "p1.json"], "part 1/3 is given twice"),
            (&["p1.json", "p4.json"], "p4.json is not there"),
        ];
        for (files, why) in refusals {
            let said = merge(files);
            assert!(said.refusal().contains(why), "{why}: {said:?}");
        }
    }
    let state = std::fs::read_to_string(project.path("p2.json")).unwrap();
    let edited =
        state.replace("\"part\":{\"number\":2,\"of\":3}", "\"part\":{\"number\":0,\"of\":0}");
    assert_ne!(edited, state);
    project.write("edited.json", edited);
    let said = project.run(&["identify", "--merge", "edited.json"]);
    assert!(said.refusal().contains("`0/0` is no part of a search"), "{said:?}");
    // A part that was stopped before it had begun is not the whole.
    let begun = ["identify", "--part", "1/2", "--budget", "0", "--checkpoint", "none.json"];
    project.run(&begun);
    let said = project.run(&["identify", "--merge", "none.json"]);
    assert!(said.refusal().contains("none.json holds no search yet"), "{said:?}");
    let one = ["identify", "--values", "-7:3:0.5", "--part", "2/3", "--checkpoint", "p2.json"];
    assert!(project.run(&one).refusal().contains("belongs to a different search"));
    std::fs::remove_file(project.path("p2.json")).unwrap();
    project.run(&one);
    let said = project.run(&["identify", "--merge", "p1.json", "p2.json", "p3.json"]);
    assert!(said.refusal().contains("of different searches"), "{said:?}");
}

#[test]
fn a_budget_ends_a_search_without_an_error() {
    let args = ["identify", "--values", "-8:8:0.001", "--budget", "0.2", "--json"];
    let said = project().run(&args);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(said.json()["problems"][0]["complete"], false);
}

#[test]
fn wrong_input_is_refused_in_one_line() {
    let project = project();
    project.write("torn.json", "{\"schema\":");
    project.write("later.json", "{\"schema\":2,\"problems\":{}}");
    for (args, remedy) in [
        (&["--problem", "1"][..], "has no table 1; it has 2"),
        (&["--values", "1:2"], "write a range such as"),
        (&["--values", "2:1:0.1"], "write MIN:MAX:STEP with MIN <= MAX"),
        (&["--budget", "-1"], "give seconds"),
        (&["--threads", "0"], "leave it out"),
        (&["--method", "anneal", "--chains", "0"], "--chains must be at least 1"),
        (&["--chains", "4"], "is for --method anneal, not enumerate; leave it out"),
        (&["--method", "anneal", "--exact-grids", "1"], "is for --method enumerate, not anneal"),
        (&["--exact-grids", "9"], "the table has 2"),
        (&["--values", "1,2;3;4"], "--values has 3 lists for 2 values of f"),
        (&["--top", "0"], "--top must be at least 1"),
        (&["--part", "3/2", "--checkpoint", "c.json"], "write K/N with 1 <= K <= N"),
        (&["--part", "0/2", "--checkpoint", "c.json"], "write K/N with 1 <= K <= N"),
        (&["--merge", "torn.json"], "delete it or name another file"),
        (&["--checkpoint", "torn.json"], "delete it or name another file"),
        (&["--checkpoint", "later.json"], "its schema is 2, not 1"),
        (&["--space", "blocks4", "--method", "enumerate"], "use fewer values"),
    ] {
        let said = project.run(&[&["identify"], args].concat());
        assert!(said.refusal().contains(remedy), "{remedy}: {said:?}");
    }
    let said = project.run(&["identify", "--space", "discs"]);
    assert!(said.code == Some(2) && said.err.contains("possible values: quadrants"), "{said:?}");
}

#[test]
fn the_stage_runs_once_and_only_where_it_is_asked_for() {
    let project = project();
    let ran = project.run(&["run", "-v"]);
    assert_eq!(ran.ran(), ["figures/identifiability", "identify/a"], "no cell is solved");
    assert_eq!(project.run(&["run", "-v"]).lines(), ["nothing to do"]);
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
    assert!(said.err.contains("not made of quadrants"), "{said:?}");
}
