//! f as the page with the live iteration reads it: what the program takes and what it refuses, and the same loads.

use crate::browser::run_script;
use serde_json::{Value, json};
use signorini::replication::scene::Scene;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::square::load::load;
use std::fmt::Write;
use std::path::Path;

const TEXTS: &str = include_str!("grammar.txt");
/// The script that reads f.
pub(crate) const SCRIPT: &str = include_str!("../../report/templates/right-hand-side.js");

/// Grids on which loads are compared.
const GRIDS: [usize; 2] = [4, 16];

/// Reads all texts and makes their loads: an array, for each text the loads by rule and grid, or a message.
const READ_ALL: &str = r#"
const choices = { tie: "lower-left", diagonal: "rising" };
const answers = texts.map((text) => {
  try {
    const f = rightHandSide.parse(text);
    const on = (rule) => grids.map((n) => [...rightHandSide.load(n, f, rule, choices)]);
    return { nodal: on("nodal"), exact: on("exact"), bilinear: on("bilinear") };
  } catch (error) {
    return error.message;
  }
});
// Numbers as text keep all their digits.
const answer = JSON.stringify(answers, (_, v) => (typeof v === "number" ? String(v) : v));
"#;

/// Who takes each text, and the text.
fn texts() -> Vec<(&'static str, String)> {
    let lines = TEXTS.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    let split = |line: &'static str| {
        let (takers, text) = line.split_once(' ').expect("two parts");
        (takers, serde_json::from_str(text).expect(line))
    };
    lines.map(split).collect()
}

/// The f of a scene with this text, or the program's message.
fn by_program(text: &str) -> Result<Source, String> {
    let f = json!(text);
    // JSON has no other escapes than TOML, and TOML no raw control characters either.
    let scene = format!("title = \"f\"\nf = {f}\ngrids = [4]\noutputs = [\"table\"]\n");
    let parsed = Scene::parse("f", &scene).map_err(|error| error.to_string());
    let without_place = |message: String| {
        message.trim_start_matches("scene `f`: ").trim_start_matches("line 2: ").to_owned()
    };
    let scene = parsed.map_err(without_place)?;
    scene.check().map_err(|error| without_place(error.to_string()))?;
    Ok(scene.source())
}

/// What the script makes of all texts; nothing without a browser and without node.
fn by_page() -> Option<Vec<Value>> {
    let all: Vec<String> = texts().into_iter().map(|(_, text)| text).collect();
    let data = format!("const texts = {}, grids = {};\n", json!(all), json!(GRIDS));
    let answer = run_script(&format!("{SCRIPT}{data}{READ_ALL}"))?;
    Some(serde_json::from_str(&answer).unwrap())
}

#[test]
fn the_program_takes_and_refuses_the_listed_texts() {
    let mut wrong = String::new();
    for (takers, text) in texts() {
        assert!(["good", "bad", "program"].contains(&takers), "{takers}");
        if by_program(&text).is_ok() != (takers != "bad") {
            writeln!(wrong, "{takers} {text:?}").unwrap();
        }
    }
    assert_eq!(wrong, "");
}

#[test]
fn the_page_takes_the_same_texts_with_the_same_loads_and_refuses_others_with_the_same_words() {
    let Some(answers) = by_page() else { return };
    let texts = texts();
    assert_eq!(answers.len(), texts.len());
    let mut wrong = String::new();
    for ((takers, text), answer) in texts.iter().zip(&answers) {
        match answer.as_str() {
            None if *takers == "good" => wrong += &different_loads(text, answer),
            // Of known solutions and formulas the page says that the program has them; it calls no such text wrong.
            Some(message)
                if text.trim().starts_with("formula(")
                    || text.trim().starts_with("exact(") && text.trim().ends_with(')') =>
            {
                assert!(message.contains("signorini solve --f has"), "{text}: {message}");
            }
            Some(message) if *takers == "bad" => {
                let program = by_program(text).unwrap_err();
                if !same_words(&program, message) {
                    writeln!(wrong, "{text:?}:\n  {program}\n  {message}").unwrap();
                }
            }
            _ => writeln!(wrong, "{takers} {text:?}: {answer}").unwrap(),
        }
    }
    assert_eq!(wrong, "");
}

/// Whether two messages have the same words, and the same numbers up to rounding errors.
fn same_words(program: &str, page: &str) -> bool {
    program.split(' ').count() == page.split(' ').count()
        && program.split(' ').zip(page.split(' ')).all(|(ours, theirs)| same_word(ours, theirs))
}

fn same_word(ours: &str, theirs: &str) -> bool {
    match [ours, theirs].map(|word| word.trim_end_matches(',').parse::<f64>()) {
        [Ok(ours), Ok(theirs)] => (ours - theirs).abs() <= 1e-9 * ours.abs(),
        _ => ours == theirs,
    }
}

/// Says where a load of the page is not the program's: f at the nodes to the last bit, integrals to rounding errors.
fn different_loads(text: &str, page: &Value) -> String {
    let f = by_program(text).expect("a good text");
    let diagonal = Diagonal::Rising;
    let rules = [
        ("nodal", LoadRule::default(), 0.0),
        ("exact", LoadRule::Exact { diagonal }, 1e-12),
        ("bilinear", LoadRule::Bilinear {}, 1e-12),
    ];
    let mut wrong = String::new();
    for (name, rule, tolerance) in rules {
        for (level, cells) in GRIDS.into_iter().enumerate() {
            let ours = load(Grid::new(cells).unwrap(), &f, rule);
            let largest = ours.iter().fold(0.0f64, |most, part| most.max(part.abs()));
            let theirs = page[name][level].as_array().unwrap();
            assert_eq!(theirs.len(), ours.len());
            for (node, (our, their)) in ours.iter().zip(theirs).enumerate() {
                let their: f64 = their.as_str().unwrap().parse().unwrap();
                let apart = (our - their).abs();
                if apart.is_nan() || apart > tolerance * largest {
                    writeln!(wrong, "{text}: {name} on 1/{cells}, node {node}: {our:e}, {their:e}")
                        .unwrap();
                }
            }
        }
    }
    wrong.lines().take(3).fold(String::new(), |lines, line| lines + line + "\n")
}

#[test]
fn the_page_loads_the_script_that_is_tested() {
    let page = include_str!("../../report/templates/tables.md.tera");
    let [f, method] = ["right-hand-side.js", "arrow-hurwicz.js"]
        .map(|name| page.find(&format!("<script src=\"{name}\">")).expect(name));
    assert!(f < method, "the method needs f");
    // What comments name is there.
    for script in [SCRIPT, include_str!("../../report/templates/arrow-hurwicz.js")] {
        for name in script.split_whitespace().filter(|word| word.starts_with("src/")) {
            let name = name.trim_end_matches([',', '.', ';', ':']);
            assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(name).exists(), "{name}");
        }
    }
}
