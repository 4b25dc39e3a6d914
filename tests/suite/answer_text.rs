//! The answer of `solve` as text: what was asked for comes first, in plain numbers; advice is one line.

use crate::common::{Project, TABLE, number};
use serde_json::Value;

const SOURCE: &str = "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5";
const GEAR: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/meshes/gear.msh");

/// Text and JSON of the same answer.
fn answer(args: &[&str]) -> (String, Value) {
    let project = Project::with(TABLE);
    let args = [&["solve"], args].concat();
    let text = project.run(&args);
    text.lines();
    (text.out, project.run(&[&args[..], &["--json"]].concat()).json())
}

/// Numbers of the first line that begins with some words.
#[track_caller]
fn numbers(text: &str, words: &str) -> Vec<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(words));
    let line = line.unwrap_or_else(|| panic!("{words}: {text}"));
    line.split([' ', '[', ']', ',', '%']).filter_map(|word| word.parse().ok()).collect()
}

/// True if both are the same to a few digits.
fn near(a: f64, b: &Value) -> bool {
    let b = b.as_f64().unwrap();
    (a - b).abs() <= 1e-5 * b.abs()
}

#[test]
fn the_answer_comes_first_and_then_how_it_was_found() {
    let (text, json) = answer(&["--f", SOURCE, "--h", "1/64"]);
    let begins = [
        "square: f = ",
        "energy ",
        "guaranteed: true energy in [",
        "  error in the energy norm ",
        "v from ",
        "contact in ",
        "contact from ",
        "contact force ",
        "solver multigrid, load bilinear",
        "grid ",
        "time: ",
    ];
    let mut lines = text.lines();
    for begin in begins {
        assert!(
            lines.any(|line| line.trim_start_matches(' ').starts_with(begin.trim_start())),
            "{begin}: {text}"
        );
    }
    assert!(near(numbers(&text, "energy ")[0], &json["energy"]), "{text}");
    let bracket = numbers(&text, "guaranteed: true energy in ");
    let exact = [0, 1].map(|k| json["bound"]["energy"][k].as_f64().unwrap());
    assert!(bracket[0] <= exact[0] && exact[1] <= bracket[1], "rounded outwards: {text}");
    assert!(near(bracket[0], &json["bound"]["energy"][0]), "{text}");
    let v = numbers(&text, "v from ");
    assert!(near(v[0], &json["v_least"]) && near(v[1], &json["v_greatest"]), "{text}");
    // The torsion of the square, whose greatest value is known.
    let (text, _) = answer(&["--f", "else=-1", "--h", "1/128"]);
    let v = numbers(&text, "v from ");
    assert!((v[0] + 0.073_671_4).abs() < 1e-5 && v[1] == 0.0, "{text}");
    // No number from 1e-3 to 1e5 has an exponent, and no zero has a sign.
    for word in text.split([' ', ',', '(', ')', '[', ']', '\n']) {
        let Ok(number) = word.parse::<f64>() else { continue };
        let is_plain = (1e-3..1e5).contains(&number.abs()) || number == 0.0;
        assert!(!(is_plain && word.contains('e')), "{word}: {text}");
        assert!(number != 0.0 || !word.starts_with('-'), "{word}: {text}");
    }
    let (text, _) = answer(&["--f", "else=-1", "--domain", "disc", "--refine", "3"]);
    let [least, most] = [0, 1].map(|k| numbers(&text, "  error in the energy norm ")[k]);
    assert!(0.5 * most < least && least < most, "{text}");
}

#[test]
fn the_error_of_the_recovered_solution_is_told_with_it() {
    let project = Project::with(TABLE);
    let args = ["solve", "--f", SOURCE, "--h", "1/64"];
    let without = project.run(&args).out;
    assert!(!without.contains("recovered"), "{without}");
    let text = project.run(&[&args[..], &["--recover", "--out", "v.npy"]].concat()).out;
    let json = project.run(&[&args[..], &["--json"]].concat()).json();
    let told = numbers(&text, "  of the recovered solution at most ");
    assert!((told[0] / json["bound"]["recovered"].as_f64().unwrap() - 1.0).abs() < 1e-3, "{text}");
}

#[test]
fn arcs_have_the_names_of_their_parts_and_a_direction_where_there_are_any() {
    let hole = ["--domain", GEAR, "--f", "else=-1", "--refine", "3"];
    let (text, json) = answer(&[&hole[..], &["--free", "hole"]].concat());
    assert!(text.contains("contact everywhere on teeth, force "), "{text}");
    assert!(text.contains("\nsolver multigrid, refined 3 times\n"), "{text}");
    assert!(
        !text.contains("anticlockwise") && !text.contains("on the left"),
        "no end of an arc: {text}"
    );
    let arcs = json["contact"].as_array().unwrap();
    assert!(arcs.len() == 1 && arcs[0]["part"] == "teeth" && arcs[0]["closed"] == true, "{json}");
    let (text, json) = answer(&hole);
    let parts: Vec<_> =
        json["contact"].as_array().unwrap().iter().map(|arc| &arc["part"]).collect();
    assert_eq!(parts, ["hole", "teeth"], "{text}");

    let pushed = ["--domain", GEAR, "--f", "disc(0.5,0.5,0.3)=3; else=-1", "--free", "hole"];
    let (text, json) = answer(&pushed);
    assert!(
        text.contains(" boundary nodes; arcs with the domain on the left\ncontact from ("),
        "{text}"
    );
    let arcs = json["contact"].as_array().unwrap();
    assert!(
        !arcs.is_empty() && arcs.iter().all(|arc| arc["part"] == "teeth" && arc["closed"] == false),
        "{json}"
    );

    let (text, json) = answer(&["--f", SOURCE, "--h", "1/16"]);
    assert!(text.contains(" of 64 boundary nodes; arcs anticlockwise\ncontact from ("), "{text}");
    assert!(
        json["contact"][0]["part"].is_null() && json["contact"][0]["closed"] == false,
        "{json}"
    );
    let (text, json) = answer(&["--f", "else=-1", "--h", "1/16"]);
    assert!(text.contains(" of 64 boundary nodes\ncontact everywhere, force 1.00000\n"), "{text}");
    assert_eq!(json["contact"][0]["closed"], true);
    // In space there are no arcs, but parts.
    let (text, json) = answer(&["--domain", "ball", "--f", "else=-1", "--refine", "1"]);
    assert!(text.contains(" boundary nodes\ncontact force "), "{text}");
    assert!(json["contact"].is_null() && !text.contains("anticlockwise"), "{text}");
    let notch = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/meshes/notch.msh");
    let (text, _) =
        answer(&["--domain", notch, "--f", "else=-1", "--refine", "0", "--free", "notch"]);
    assert!(text.contains(" boundary nodes, on walls\ncontact force "), "{text}");
    // Without more words, an answer on the cube has a bound.
    let (text, _) = answer(&["--domain", "cube", "--f", "ball(0,0,0,0.25)=2; else=-1"]);
    assert!(text.contains("guaranteed: true energy in ["), "{text}");
}

#[test]
fn advice_is_one_line_that_mends_all() {
    let project = Project::with(
        "title = \"t\"\nf = \"quadrant(ll)=-6; else=1.998\"\ngrids = [4, 8, 16, 32, 64]\n\
         solver = \"arrow-hurwicz\"\nr = [10]\nload = { rule = \
         \"nodal\" }\nstop = [\"signed\"]\noutputs = [\"table\"]\n",
    );
    let text = project.run(&["solve", "a"]);
    let lines = text.lines();
    let warnings = lines.iter().filter(|line| line.starts_with("warning: ")).count();
    assert!(warnings >= 3 && !text.out.contains("; use") && !text.out.contains("try"), "{text:?}");
    let remedy = lines.last().unwrap().strip_prefix("remedy for all: use ").unwrap();
    assert_eq!(remedy, "--load exact --solver multigrid");
    let mended: Vec<_> = ["solve", "a"].into_iter().chain(remedy.split(' ')).collect();
    let mended = project.run(&mended);
    assert!(!mended.out.contains("warning") && mended.code == Some(0), "{mended:?}");
    // In JSON the sentences are those of the text, and the remedy is the one of its last line.
    let json = project.run(&["solve", "a", "--json"]).json();
    let sentences: Vec<_> =
        lines.iter().filter_map(|line| line.strip_prefix("warning: ")).collect();
    assert_eq!(json["warnings"], serde_json::json!(sentences));
    assert_eq!(
        (&json["remedy"], &json["failure"]),
        (&"use --load exact --solver multigrid".into(), &Value::Null)
    );
    // What is no solution has a remedy as complete.
    let failed = project.run(&["solve", "a", "--r", "1"]);
    assert!(failed.out.contains("not a solution"), "{failed:?}");
    assert!(failed.err.ends_with("; use --load exact --solver multigrid\n"), "{failed:?}");
}

#[test]
fn json_has_the_reason_and_the_remedy_of_each_failure() {
    let project = Project::with(TABLE);
    let corner = "quadrant(ll)=3; else=-1.1";
    let cases: [&[&str]; 3] = [
        &["--f", corner, "--load", "nodal", "--h", "1/6", "--solver", "arrow-hurwicz"],
        &["--f", SOURCE, "--max-iterations", "2"],
        &["--f", corner, "--load", "nodal", "--h", "1/101", "--stop", "printed"],
    ];
    for args in cases {
        let text = project.run(&[&["solve"], args].concat());
        let said = project.run(&[&["solve", "--json"], args].concat());
        let json = said.json();
        let [failure, remedy] = ["failure", "remedy"].map(|name| json[name].as_str().unwrap());
        assert_eq!(said.code, Some(3), "{said:?}");
        let name = json["scene"].as_str().unwrap();
        assert_eq!(text.err, format!("error: {name}: {failure}; {remedy}\n"), "{json}");
    }
    // A warning alone has its remedy in the line of the text, and apart in JSON.
    let poor = ["--f", "disc(0,0,1e-7)=1e15; else=-100"];
    let text = project.run(&[&["solve"], &poor[..]].concat()).out;
    let json = project.run(&[&["solve", "--json"], &poor[..]].concat()).json();
    let [fact, remedy] = [&json["warnings"][0], &json["remedy"]].map(|text| text.as_str().unwrap());
    assert_eq!(text.lines().last(), Some(&*format!("warning: {fact}; {remedy}")));
    let well = project.run(&["solve", "--f", "else=-1", "--json"]).json();
    assert_eq!((&well["failure"], &well["remedy"]), (&Value::Null, &Value::Null));
}

#[test]
fn commands_with_a_mistake_are_recognised_whatever_options_follow() {
    let project = Project::with(TABLE);
    for (args, command) in
        [(&["solv", "--f", "else=-1"][..], "solve"), (&["statsu", "--exit-code"], "status")]
    {
        let said = project.run(args);
        let word = args.iter().find(|word| !word.starts_with('-')).unwrap();
        let expected = format!("error: no command `{word}`; did you mean `signorini {command}`?");
        assert_eq!(said.refusal(), expected);
    }
    let said = project.run(&["nothing-like-it", "--f", "else=-1"]);
    assert!(said.code == Some(2) && !said.err.contains("--force"), "{said:?}");
    assert_eq!(project.run(&["list", "--json"]).json()["schema"], 1);
}

#[test]
fn a_fixed_part_is_said_to_carry_what_the_contact_does_not() {
    let said = "\nfixed parts carry the difference\n";
    let f = ["--domain", "annulus", "--refine", "2", "--f", "else=-1"];
    let (text, json) = answer(&[&f[..], &["--fixed", "inner"]].concat());
    let forces = numbers(&text, "contact force ");
    assert!(text.contains(said) && forces[0] < 0.9 * forces[1], "{text}");
    assert!(near(forces[0], &json["force"]));
    for free in [&f[..], &[&f[..], &["--free", "inner"]].concat()] {
        assert!(!answer(free).0.contains(said));
    }
}

#[test]
fn each_arc_is_told_as_it_is() {
    let of = |domain, f| ["--domain", domain, "--f", f];
    let commands = [
        of("square", "else=-1"),
        of("square", SOURCE),
        of("square", "quadrant(ll)=-6; else=1.99"),
        of("disc", "else=-1"),
        of("disc", "halfplane(0,1,0)=-3; else=1.5"),
        of("annulus", "else=-1"),
        of("annulus", "disc(0.7,0,0.2)=9; else=-1"),
        of("lshape", "rect(-1,0,-1,0)=3; else=-2"),
    ];
    let mut kinds = [0, 0];
    for command in commands {
        let (text, json) = answer(&command);
        let arcs = json["contact"].as_array().unwrap();
        let closed = arcs.iter().filter(|arc| arc["closed"] == true).count();
        let counts = [closed, arcs.len() - closed];
        let told =
            ["\ncontact everywhere", "\ncontact from ("].map(|words| text.matches(words).count());
        assert_eq!(told, counts, "{text}");
        // One that is closed holds all nodes of its part of the boundary.
        let Value::Object(nodes) = &json["contact_nodes"] else { panic!("{json}") };
        let is_everywhere = nodes["nodes"] == nodes["boundary_nodes"];
        let words = text.lines().filter(|line| line.starts_with("contact in ")).collect::<Vec<_>>();
        assert_eq!(words.len(), 1, "{text}");
        assert!(!is_everywhere || counts[1] == 0, "{text}");
        for (kind, count) in kinds.iter_mut().zip(counts) {
            *kind += count;
        }
    }
    assert!(kinds.into_iter().all(|count| count > 3), "{kinds:?}");
}

#[test]
fn where_f_varies_within_cells_no_least_error_is_claimed() {
    let project = Project::with(TABLE);
    for (domain, f, is_claimed) in [
        ("lshape", "else=-1", true),
        ("lshape", "formula(x-3)", false),
        ("lshape", "formula(-1-sin(40*x)*sin(40*y))", false),
        ("cube", "else=-1", true),
        ("cube", "exact(free-disc)", false),
        ("cube", "exact(full-contact)", false),
        ("ball", "formula(z-3)", false),
    ] {
        let fineness: &[&str] = if domain == "cube" { &["--h", "1/8"] } else { &["--refine", "2"] };
        let solve = ["solve", "--json", "--domain", domain, "--f", f];
        let json = project.run(&[&solve[..], fineness].concat()).json();
        let [least, most] = [0, 1].map(|end| number(&json["bound"]["error"][end]));
        assert!(least < most && (least > 0.0) == is_claimed, "{domain} {f}: {json}");
        if let Some(h1) = json["errors"]["h1"].as_f64() {
            let l2 = number(&json["errors"]["l2"]);
            assert!(least <= h1 && h1 * h1 - l2 * l2 <= most * most, "{domain} {f}: {json}");
        }
    }
}
