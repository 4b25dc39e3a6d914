//! One answer in all voices: `solve`, a study, a scene that is run, and Python say the same warnings, failure and
//! remedy.
//!
//! `SIGNORINI_STATEMENTS` is the number of random statements, 100 without it.

use crate::common::{Dice, Project, TABLE};
use crate::edits::number;
use crate::python::python;
use serde_json::{Value, json};
use signorini_mathematics::problem::text::plain;
use std::fs;

/// What options are called in a scene.
const AS_KEYS: [(&str, &str); 9] = [
    ("--load exact --solver multigrid", "load = \"exact\", solver = \"multigrid\""),
    ("--load exact", "load = \"exact\""),
    ("--load bilinear", "load = \"bilinear\""),
    ("--solver multigrid", "solver = \"multigrid\""),
    ("--solver active-set", "solver = \"active-set\""),
    ("--stop printed-dual", "stop = \"printed-dual\""),
    ("--max-iterations", "`max_iterations`"),
    ("--tolerance 1e-17", "tolerance = 1e-17"),
    ("--h", "`h`"),
];

/// Statement as options of `solve` besides f.
struct Stated {
    f: String,
    options: Vec<(&'static str, String)>,
}

/// Options one of which a study varies, that of the first that is there; f where none is.
const VARIED: [&str; 5] = ["h", "refine", "accuracy", "friction", "limit"];

impl Stated {
    /// Statement whose answer has doubts, or none.
    fn doubtful(dice: &mut Dice) -> Self {
        let size = dice.between(0.05, 4.0);
        let integral = -size / 100.0;
        let h = ("h", ["1/8", "1/16"][dice.below(2) as usize]);
        let (f, more): (String, &[(&'static str, &str)]) = match dice.below(7) {
            0 => (peak_with(integral), &[("load", "nodal")]),
            1 => (peak_with(integral / 4.0), &[("load", "nodal")]),
            2 => (format!("else={size:.4}"), &[]),
            3 => (format!("else=-{size:.4}"), &[("friction", "0.01")]),
            4 => (
                format!("formula({size:.4}*x^2 - 3 + 400*exp(-4000*(x^2+y^2)))"),
                &[("load", "nodal")],
            ),
            5 => (format!("else=-{size:.4}"), &[("tolerance", "1e-17")]),
            _ => (
                peak_with(integral),
                &[("solver", "arrow-hurwicz"), ("load", "nodal"), ("max_iterations", "7")],
            ),
        };
        let mut stated = Self::of(f, &[&[h], more].concat());
        if dice.below(8) == 0
            && stated.option("solver").is_none()
            && stated.option("tolerance").is_none()
        {
            stated.options.push(("solver", "active-set".into()));
        }
        stated
    }

    /// Statement of any domain, law and solver.
    fn any(dice: &mut Dice) -> Self {
        let (size, elsewhere) = (dice.between(0.5, 4.0), dice.between(-2.0, 0.3));
        let size = if dice.below(2) == 0 { size } else { -size };
        let domain =
            ["square", "square", "lshape", "disc", "annulus", "cube"][dice.below(6) as usize];
        let f = match domain {
            "cube" => format!("ball(0,0,0,0.25)={size:.3}; else={elsewhere:.3}"),
            _ => format!("rect(-1,0,-1,0)={size:.3}; else={elsewhere:.3}"),
        };
        let mut stated = Self::of(f, &[("domain", domain)]);
        let solvers = ["active-set", "arrow-hurwicz", "uzawa", "uzawa-proximal", "spectral"];
        let solver = solvers.get(dice.below(10) as usize).copied();
        let is_nested =
            solver.is_some_and(|name| name.starts_with(['u', 'a']) && name != "active-set");
        let in_plane = domain != "cube";
        match (domain, solver) {
            (_, Some("spectral")) if in_plane => {}
            (_, None) if in_plane && dice.below(4) == 0 => stated.add("accuracy", "0.3"),
            ("square", _) => stated.add("h", "1/8"),
            ("cube", _) => stated.add("h", "1/4"),
            _ => stated.add("refine", "1"),
        }
        solver.iter().for_each(|solver| stated.add("solver", solver));
        match dice.below(4) {
            0 => stated.add("friction", &format!("{:.3}", dice.between(0.05, 1.5))),
            1 => stated.add("limit", &format!("{:.3}", dice.between(0.2, 3.0))),
            _ => {}
        }
        if domain == "annulus" && dice.below(2) == 0 {
            stated.add("fixed", "inner");
        }
        if is_nested && dice.below(3) == 0 {
            stated.add("max_iterations", "7");
        }
        stated
    }

    fn of(f: String, options: &[(&'static str, &str)]) -> Self {
        let options = options.iter().map(|(name, value)| (*name, (*value).to_owned())).collect();
        Self { f, options }
    }

    fn add(&mut self, name: &'static str, value: &str) {
        self.options.push((name, value.into()));
    }

    fn option(&self, name: &str) -> Option<&str> {
        self.options.iter().find(|(known, _)| *known == name).map(|(_, value)| &**value)
    }

    /// Option that a study varies.
    fn varied(&self) -> &str {
        VARIED.into_iter().find(|name| self.option(name).is_some()).unwrap_or("f")
    }

    /// Arguments of `solve`; one of them is the list of a study, if it is `varied`.
    fn arguments(&self, varied: bool) -> Vec<String> {
        let mut arguments = vec!["solve".into(), "--json".into()];
        for (name, value) in [&[("f", self.f.clone())][..], &self.options].concat() {
            let option = name.replace('_', "-");
            arguments.push(match varied && self.varied() == name {
                true => format!("--vary={name}={value}|"),
                false => format!("--{option}={value}"),
            });
        }
        arguments
    }

    /// Scene with a table that states the same.
    fn scene(&self) -> String {
        let mut text = format!("title = \"t\"\nf = \"{}\"\noutputs = [\"table\"]\n", self.f);
        let mut domain = String::new();
        for (name, value) in &self.options {
            match *name {
                "domain" => domain = format!("name = \"{value}\"{domain}"),
                "refine" => domain += &format!(", refine = {value}"),
                "fixed" => domain += &format!(", fixed = [\"{value}\"]"),
                "h" | "load" | "solver" => text += &format!("{name} = \"{value}\"\n"),
                "friction" | "limit" => text += &format!("law = {{ {name} = {value} }}\n"),
                _ => text += &format!("{name} = {value}\n"),
            }
        }
        match domain.is_empty() {
            true => text,
            false => format!("{text}domain = {{ {domain} }}\n"),
        }
    }
}

/// f that is 7 on a quarter of the square, with this integral.
fn peak_with(integral: f64) -> String {
    format!("quadrant(ll)=7; else={:.4}", (integral - 1.75) / 0.75)
}

/// Words of a voice on a statement.
#[derive(Debug, PartialEq)]
struct Spoken {
    warnings: Value,
    remedy: Value,
    /// Reason for which there is no solution.
    reason: Option<String>,
}

/// Reason without the name of the problem before it.
fn bare(text: &str) -> String {
    let text = text.trim().trim_start_matches("error: ");
    let known = ["square: ", "lshape: ", "disc: ", "annulus: ", "cube: "];
    known.iter().fold(text, |text, name| text.trim_start_matches(name)).to_owned()
}

fn with_keys(text: &str) -> String {
    AS_KEYS.iter().fold(text.to_owned(), |text, (option, key)| text.replace(option, key))
}

/// Statement as `solve --json` and a caller in Python state it, and what both say.
struct Heard {
    call: serde_json::Map<String, Value>,
    expected: Value,
    /// 0 if it was refused, 1 without a solution, 2 with a warning, 3 without.
    kind: usize,
}

/// Numbers of statements that were refused, without a solution, with warnings and without, of so many random ones that
/// are said in all voices.
fn said_in_all_voices(count: u64) -> [usize; 4] {
    let (project, mut dice, mut kinds) = (Project::with(TABLE), Dice(7), [0; 4]);
    let (mut calls, mut expected) = (Vec::new(), Vec::new());
    for number in 0..count {
        let stated = match dice.below(2) {
            0 => Stated::doubtful(&mut dice),
            _ => Stated::any(&mut dice),
        };
        let heard = heard(&project, number, &stated);
        kinds[heard.kind] += 1;
        calls.push(heard.call);
        expected.push(heard.expected);
    }
    assert_python(&calls, &expected);
    kinds
}

/// Checks what `solve`, a study and a run say of a statement.
fn heard(project: &Project, number: u64, stated: &Stated) -> Heard {
    let [alone, row] = [false, true].map(|varied| {
        let arguments = stated.arguments(varied);
        project.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    });
    let answer: Value = serde_json::from_str(&alone.out).unwrap_or_default();
    let reason = (alone.code != Some(0)).then(|| bare(alone.err.lines().last().unwrap()));
    let of_solve = Spoken {
        warnings: answer.get("warnings").cloned().unwrap_or(json!([])),
        remedy: answer["remedy"].clone(),
        reason,
    };
    let kind = match (answer.is_null(), &of_solve.reason) {
        (true, _) => 0,
        (_, Some(_)) => 1,
        (_, None) if of_solve.warnings != json!([]) => 2,
        (_, None) => 3,
    };
    // What was tried is no remedy.
    let advice = format!("{:?} {:?}", of_solve.remedy, of_solve.reason);
    for name in ["solver", "load"] {
        let tried = stated.option(name).map(|value| format!("--{name} {value}"));
        assert!(!tried.is_some_and(|tried| advice.contains(&tried)), "{advice}");
    }
    let row: Value = serde_json::from_str(&row.out).unwrap_or_else(|_| panic!("{row:?} {alone:?}"));
    let of_study = Spoken {
        warnings: row["warnings"].clone(),
        remedy: row["remedy"].clone(),
        reason: row["reason"].as_str().map(str::to_owned),
    };
    assert_eq!(of_study, of_solve, "{:?}", stated.arguments(true));
    assert_member(&row, &answer, stated.varied());
    assert_text(project, stated, &answer);
    assert_run(project, number, stated, (&of_solve, &answer));
    let mut call: serde_json::Map<String, Value> =
        stated.options.iter().map(|(name, value)| ((*name).into(), json!(value))).collect();
    call.insert("f".into(), json!(stated.f));
    let failure = answer["failure"].as_str().map(str::to_owned);
    let expected = json!([of_solve.warnings, failure.or(of_solve.reason), timeless(&answer)]);
    Heard { call, expected, kind }
}

/// Answer without its times.
fn timeless(answer: &Value) -> Value {
    let mut answer = answer.clone();
    answer.as_object_mut().and_then(|fields| fields.remove("seconds"));
    answer
}

/// Checks that the only member of a study is the answer alone, in all fields but those of the command.
fn assert_member(row: &Value, answer: &Value, varied: &str) {
    assert_eq!(row["varied"].as_object().unwrap().len(), 1, "{row}");
    for (name, value) in answer.as_object().into_iter().flatten() {
        if !["seconds", "not_as_in_scene", varied].contains(&name.as_str()) {
            assert_eq!(row[name], *value, "{name}");
        }
    }
}

/// Checks the energy, the values at nodes and the iterations that the text of `solve` has.
fn assert_text(project: &Project, stated: &Stated, answer: &Value) {
    let mut arguments = stated.arguments(false);
    arguments.retain(|argument| argument != "--json");
    let said = project.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(said.out.is_empty(), answer.is_null(), "{said:?}");
    let with_digits = |name: &str, digits| plain(answer[name].as_f64().unwrap(), digits);
    if let Some(steps) = answer["iterations"].as_u64().filter(|_| answer["grids"].is_null()) {
        assert!(said.out.contains(&format!("({steps} Newton steps)")), "{said:?}");
    } else if !answer.is_null() {
        let [least, greatest] = ["v_least", "v_greatest"].map(|name| with_digits(name, 6));
        let energy = with_digits("energy", 7);
        for line in [format!("energy {energy}\n"), format!("v from {least} to {greatest}\n")] {
            assert!(said.out.contains(&line), "{said:?}: {line}");
        }
        let sweeps = answer["sweeps"].as_u64().filter(|_| said.out.contains("sweeps  "));
        let sweeps = sweeps.map_or(String::new(), |sweeps| format!(" {sweeps}"));
        let row = format!("{}{sweeps} {}", answer["iterations"], answer["stop"].as_str().unwrap());
        let words = said.out.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(&row), "{said:?}: {row}");
    }
    let warnings = answer["warnings"].as_array().into_iter().flatten();
    let text = said.out.split_whitespace().collect::<Vec<_>>().join(" ");
    for warning in warnings.filter_map(Value::as_str) {
        assert!(text.contains(warning), "{said:?}: {warning}");
    }
}

/// Checks the numbers of the last row of a table of a run, as far as it has them.
fn assert_table(csv: &str, answer: &Value) {
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let (head, last) = (lines.next().unwrap(), lines.next_back().unwrap());
    for (name, cell) in head.into_iter().zip(last) {
        let known = &answer[if name == "error_bound" { "" } else { name }];
        match (known.as_f64(), known.as_str()) {
            (Some(number), _) if name != "r" => {
                assert_eq!(cell.parse(), Ok(number), "{name}: {answer}");
            }
            (None, Some(text)) => assert_eq!(cell, text, "{name}: {answer}"),
            _ => {}
        }
    }
}

/// Checks what `run` says of a statement, and its table.
fn assert_run(
    project: &Project,
    number: u64,
    stated: &Stated,
    (of_solve, answer): (&Spoken, &Value),
) {
    let name = format!("s{number}");
    project.scene(&name, &stated.scene());
    let said = project.run(&["run", &name]);
    let scene = project.path(&format!("pipeline/scenes/{name}.toml"));
    let read = |ending| fs::read_to_string(project.path(&format!("report/tables/{name}.{ending}")));
    let table = read("md");
    if let (Ok(csv), false) = (read("csv"), answer.is_null()) {
        assert_table(&csv, answer);
    }
    fs::remove_file(scene).unwrap();
    match &of_solve.reason {
        Some(reason) => assert!(said.err.contains(&with_keys(reason)), "{said:?}: {reason}"),
        None => {
            let table = table.unwrap_or_else(|_| panic!("{said:?}"));
            for warning in of_solve.warnings.as_array().unwrap() {
                let warning = with_keys(warning.as_str().unwrap());
                assert!(said.err.contains(&warning), "{said:?}: {warning}");
                assert!(table.contains(&warning), "{table}: {warning}");
            }
            let remedy = of_solve.remedy.as_str().map(with_keys).unwrap_or_default();
            assert!(said.err.contains(&remedy), "{said:?}: {remedy}");
        }
    }
}

/// Checks warnings, failures and all fields in Python.
fn assert_python(calls: &[serde_json::Map<String, Value>], expected: &[Value]) {
    let program = "import json, sys, signorini\n\
        for options in json.loads(sys.argv[1]):\n\
        \x20   try:\n\
        \x20       answer = signorini.solve(**options)\n\
        \x20       numbers = {k: v for k, v in answer.answer.items() if k != 'seconds'}\n\
        \x20       print(json.dumps([answer.warnings, answer.failure, numbers]))\n\
        \x20   except signorini.Refused as refused: print(json.dumps([[], str(refused), None]))\n";
    let Some(output) = python(&["-c", program, &json!(calls).to_string()]) else { return };
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().count(), expected.len(), "{}", String::from_utf8_lossy(&output.stderr));
    for (line, expected) in text.lines().zip(expected) {
        let mut said: Value = serde_json::from_str(line).unwrap();
        if let Some(failure) = said[1].as_str().map(bare) {
            said[1] = failure.into();
        }
        assert_eq!(said, *expected);
    }
}

#[test]
fn all_voices_say_the_same_of_an_answer() {
    let count = number("SIGNORINI_STATEMENTS", 100);
    let kinds = said_in_all_voices(count);
    let least = [30, 10, 20, 5].map(|percent| (percent * count / 100) as usize);
    assert!(kinds.iter().zip(least).all(|(count, least)| *count >= least), "{kinds:?}");
}
