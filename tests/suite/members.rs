//! Rows of studies say what was solved: random studies, of which each row is solved again alone by its label, and the
//! ways in which a label and a statement could differ.
//!
//! `SIGNORINI_STUDIES` is the number of random studies, 12 without it; `SIGNORINI_SEED` is the seed of the first.

use crate::common::{Dice, Project, Said, TABLE, interrupt, wait_for_handler};
use crate::edits::number;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::process::Stdio;

/// Right-hand sides on any domain in the plane, with their names.
const TEMPLATES: [(&str, &[&str]); 8] = [
    ("disc(0.1,0,$R)=$b; else=-3", &["R", "b"]),
    ("halfplane($R,1,0)=-$b; else=-1", &["R", "b"]),
    ("formula($b^2*x - 1/$R - 9)", &["R", "b"]),
    ("formula(-$b*x - 2*-$b - 12)", &["b"]),
    ("rect(-$R,$R,-1/4, $R )=-$b/3; else=-2", &["R", "b"]),
    ("formula(-1 - $b^2)", &["b"]),
    ("halfplane(1,0,0)=3; else=-5", &[]),
    ("else=-1", &[]),
];
/// Values of names in f, in any spelling of a number.
const OF_NAMES: [&str; 9] = ["0.1", "1/4", "0.30", "2e-1", "0.125", "+0.35", "1/3", ".5", "0.45"];
/// Values that are negative as well.
const SIGNED: [&str; 6] = ["-2", "-1/2", "1.50", "-0.25", "2", "0"];

/// Fields that may vary together, with values of each: of every line, one field at most.
const ON_THE_SQUARE: [&[(&str, &[&str])]; 5] = [
    &[
        ("h", &["1/8", "16", "0.25", "1/12", "6", "1/7"]),
        ("grids", &["4,8", "8", "3,6,12", "5,10"]),
        ("accuracy", &["0.5", "3e-1", "0.4"]),
    ],
    LAWS,
    &[("load", &["exact", "nodal", "bilinear"])],
    &[("solver", &["multigrid", "active-set"]), ("tolerance", &["1e-6", "0.001"])],
    &[("r", &["10", "5.0", "1e2"]), ("max_iterations", &["100000", "20000"])],
];
const ON_MESHES: [&[(&str, &[&str])]; 4] = [
    &[("refine", &["0", "1", "2"])],
    LAWS,
    &[("fixed", &["inner", "", "outer,inner"]), ("free", &["outer", "inner", ""])],
    &[("solver", &["multigrid", "active-set"])],
];
const LAWS: &[(&str, &[&str])] =
    &[("friction", &["8", "1.50", "20", "12.5"]), ("limit", &["9", "1e1", "11.0"])];

/// Random study: its options, and its lists of values by name.
struct Study {
    f: &'static str,
    domain: &'static str,
    others: Vec<String>,
    lists: Vec<(&'static str, Vec<&'static str>)>,
}

/// One of several things.
fn one_of<'a, T>(dice: &mut Dice, things: &'a [T]) -> &'a T {
    &things[dice.below(things.len() as u64) as usize]
}

/// Some of these values, one at least, each once.
fn some_of<'a>(dice: &mut Dice, values: &[&'a str]) -> Vec<&'a str> {
    let mut left = values.to_vec();
    let count = 1 + dice.below(3.min(values.len() as u64));
    (0..count).map(|_| left.remove(dice.below(left.len() as u64) as usize)).collect()
}

impl Study {
    fn random(dice: &mut Dice) -> Self {
        let (f, names) = *one_of(dice, &TEMPLATES);
        let domain = *one_of(dice, &["square", "square", "annulus", "disc"]);
        let fields = if domain == "square" { &ON_THE_SQUARE[..] } else { &ON_MESHES };
        let mut lists = Vec::new();
        for name in names {
            let values = if *name == "R" { &OF_NAMES[..] } else { &SIGNED };
            lists.push((*name, some_of(dice, values)));
        }
        let mut others = Vec::new();
        for line in fields {
            let (name, values) = *one_of(dice, line);
            let is_of_parts = ["fixed", "free"].contains(&name);
            // The paper's method takes neither, and is asked for by its own keys.
            let clashes = |name: &str| match name {
                "r" | "max_iterations" => &["solver", "tolerance", "accuracy"][..],
                _ => &[],
            };
            let is_there = |name: &str| {
                lists.iter().any(|(known, _)| *known == name)
                    || others
                        .iter()
                        .any(|option: &String| option.starts_with(&format!("--{name}=")))
            };
            if clashes(name).iter().any(|other| is_there(other))
                || name == "tolerance" && is_there("accuracy")
                || name == "solver" && is_there("accuracy")
                || is_of_parts && domain != "annulus"
            {
                continue;
            }
            // How fine is always said: the usual meshes take a while.
            let is_fineness = line == &fields[0];
            match dice.below(if is_fineness { 2 } else { 3 }) {
                0 if lists.len() < 3 => lists.push((name, some_of(dice, values))),
                0 | 1 if !is_of_parts => others.push(option(name, one_of::<&str>(dice, values))),
                _ => {}
            }
        }
        if lists.is_empty() {
            lists.push(("friction", vec!["8"]));
            others.retain(|option| {
                !option.starts_with("--limit") && !option.starts_with("--friction")
            });
        }
        for k in (1..lists.len()).rev() {
            lists.swap(k, dice.below(k as u64 + 1) as usize);
        }
        Self { f, domain, others, lists }
    }

    /// Runs `solve` for an f with options behind those that do not vary.
    fn solve(&self, project: &Project, f: &str, more: &[String]) -> Said {
        let mut args = vec!["solve", "--f", f, "--json"];
        if self.domain != "square" {
            args.extend(["--domain", self.domain]);
        }
        args.extend(self.others.iter().chain(more).map(String::as_str));
        project.run(&args)
    }

    /// Solves a row alone, by its values; the numbers of names are put into f by this test.
    fn alone(&self, project: &Project, row: &Value) -> Said {
        let (mut f, mut more) = (self.f.to_owned(), Vec::new());
        for (name, _) in &self.lists {
            let label = text(&row[name]);
            if let Some(place) = f.find(&format!("${name}")) {
                let mut places = Some(place);
                while let Some(place) = places {
                    f = with_number(&f, place, name, label.parse().unwrap());
                    places = f.find(&format!("${name}"));
                }
            } else if ["fixed", "free"].contains(name) {
                more.extend(
                    label.split(',').filter(|part| !part.is_empty()).map(|part| option(name, part)),
                );
            } else {
                more.push(option(name, &label));
            }
        }
        self.solve(project, &f, &more)
    }
}

/// An option with its value.
fn option(name: &str, value: &str) -> String {
    format!("--{}={value}", name.replace('_', "-"))
}

/// A value of JSON as options have it.
fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Returns f with a number in one place of a name.
fn with_number(f: &str, place: usize, name: &str, number: f64) -> String {
    let (before, after) = (&f[..place], &f[place + 1 + name.len()..]);
    if f.starts_with("formula") {
        return format!("{before}({number}){after}");
    }
    match before.strip_suffix('-') {
        Some(before) if number != 0.0 => format!("{before}{}{after}", -number),
        Some(before) => format!("{before}0{after}"),
        None => format!("{before}{number}{after}"),
    }
}

/// Checks that the rows of a study are those of its members solved alone; returns the number of rows.
fn check(study: &Study, project: &Project) -> usize {
    let lists: Vec<String> = study
        .lists
        .iter()
        .map(|(name, values)| format!("--vary={name}={}|", values.join("|")))
        .collect();
    let said = study.solve(project, study.f, &lists);
    let shown = format!("{} {} {:?} {lists:?}", study.domain, study.f, study.others);
    assert!([Some(0), Some(3)].contains(&said.code), "{shown}: {said:?}");
    let rows: Vec<Value> =
        said.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let members: usize = study.lists.iter().map(|(_, values)| values.len()).product();
    assert_eq!(rows.len(), members, "{shown}");
    let mut labels = BTreeSet::new();
    for row in &rows {
        let label: Vec<_> = study.lists.iter().map(|(name, _)| row[name].to_string()).collect();
        assert!(labels.insert(label), "{shown}: {row}");
        let alone = study.alone(project, row);
        // A member without a solution may have numbers at its stop.
        if !row["reason"].is_null() {
            assert!(alone.code != Some(0), "{shown}: {row} {alone:?}");
            continue;
        }
        assert_eq!(alone.code, Some(0), "{shown}: {row} {alone:?}");
        let alone: Value = serde_json::from_str(alone.out.trim()).unwrap();
        for key in ["energy", "v_least", "v_greatest", "force", "nodes", "iterations", "solver"] {
            assert_eq!(row[key], alone[key], "{key}: {shown}: {row}");
        }
        assert_eq!(row["error_relative"], alone["bound"]["relative"]["error"], "{shown}: {row}");
    }
    rows.len()
}

#[test]
fn each_row_is_what_its_label_says() {
    let (studies, seed) = (number("SIGNORINI_STUDIES", 12), number("SIGNORINI_SEED", 1));
    let project = Project::with(TABLE);
    let mut rows = 0;
    for seed in seed..seed + studies {
        let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        rows += check(&Study::random(&mut dice), &project);
    }
    assert!(rows as u64 >= studies, "{rows}");
}

/// Rows of a study, without the name of the scene or of the domain.
fn rows(project: &Project, line: &str) -> Vec<Value> {
    let said = project.line(&format!("solve --json {line}"));
    let mut rows: Vec<Value> = said.lines().iter().map(|line| line.parse().unwrap()).collect();
    rows.iter_mut().for_each(|row| row["scene"] = Value::Null);
    rows
}

#[test]
fn an_interrupted_study_keeps_the_rows_that_it_has() {
    let project = Project::with(TABLE);
    let values: Vec<_> = (1..=400).map(|k| format!("{}", 1.0 + f64::from(k) / 1000.0)).collect();
    let vary = format!("friction={}", values.join(","));
    let f = ["solve", "--f", "halfplane(1,0,0)=8; else=-9", "--h", "1/256", "--csv", "t.csv"];
    let mut command = project.command(&[&f[..], &["--vary", &vary]].concat());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for_handler(&child);
    interrupt(&child);
    let said = Said::from(child.wait_with_output().unwrap());
    assert!(said.code == Some(130) && said.err.contains("finishing what has begun"), "{said:?}");
    let csv = project.read("t.csv");
    let interrupted =
        csv.lines().filter(|row| row.ends_with("interrupted; solve it again")).count();
    assert!(csv.lines().count() == 401 && interrupted > 0, "{csv}");
}

#[test]
fn what_is_saved_has_the_same_members() {
    let project = Project::with(TABLE);
    let f = "'f=disc(0,0,$R)=4; else=-1|disc(0.1,0,$R)=4; else=-1|'";
    for line in [
        &format!("--vary {f} --vary R=0.1,0.2 --h 8"),
        "--f else=-1 --vary domain=disc,annulus --refine 1",
        "--f else=-1 --domain annulus --refine 0 --vary 'fixed=inner,outer||inner|'",
        "--f 'else=-$R' --h 8 --vary R=0.1:0.3:0.1 --vary load=nodal,exact",
        "--f else=-1 --vary 'grids=4,8|8|' --vary tolerance=1e-3,1e-6",
    ] {
        let own = rows(&project, &format!("{line} --save own"));
        assert_eq!(rows(&project, "own"), own, "{line}");
        assert!(own.len() > 1);
        fs::remove_file(project.path("pipeline/scenes/own.toml")).unwrap();
    }
}
