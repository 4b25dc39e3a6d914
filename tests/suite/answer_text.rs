//! The answer of `solve` as text: what was asked for comes first, in plain numbers; advice is one line.

use crate::common::{Project, TABLE, number};
use serde_json::Value;

const SOURCE: &str = "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5";
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
