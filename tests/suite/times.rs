//! Times that `solve` tells: each part of the work has one, and together they are no longer than the command.

use crate::common::{Project, TABLE, number};
use std::time::Instant;

/// Parts in JSON and in the text; the first has two names there.
const PARTS: [(&str, &str); 5] = [
    ("setup", "setup"),
    ("load", "load"),
    ("solve", "solver"),
    ("bounds", "bounds"),
    ("files", "files"),
];

/// Problems that take some tenths of a second, each with the parts that take a part of it worth naming.
const CASES: [(&str, &str); 7] = [
    ("--f 'formula(3*x*y - 1.1 + exp(-40*(x^2 + y^2)))' --h 1/256", "load solve bounds"),
    ("--f 'rect(0,0.5,0,0.5)=3; else=-1.1' --accuracy 8e-4", "solve bounds"),
    (
        "--domain disc --f 'halfplane(0,1,0)=-3; else=1.5' --refine 6 --out v.svg",
        "setup load solve bounds files",
    ),
    (
        "--domain cube --f 'ball(0,0,0,0.25)=2; else=-1' --h 1/16 --out v.vtu",
        "setup load solve bounds files",
    ),
    ("--domain lshape --f 'rect(-1,0,0,1)=2; else=-2' --accuracy 8e-3", "setup load solve bounds"),
    (
        "--domain disc --f 'halfplane(0,1,0)=-3; else=1.5' --accuracy-energy 1e-4",
        "setup load solve bounds",
    ),
    ("--f 'rect(0,0.5,0,0.5)=3; else=-1.1' --solver spectral --out v.npy --h 1/64", "solve files"),
];

#[test]
fn the_parts_of_the_work_have_times_within_that_of_the_command() {
    let project = Project::with(TABLE);
    for (line, parts) in CASES {
        let start = Instant::now();
        let json = project.answer(line);
        let wall = start.elapsed().as_secs_f64();
        let times = PARTS.map(|(name, _)| number(&json["seconds"][name]));
        assert_eq!(json["seconds"].as_object().unwrap().len(), PARTS.len(), "{line}");
        for ((name, _), time) in PARTS.into_iter().zip(times) {
            assert!(time > 0.0 || time == 0.0 && !parts.contains(name), "{name}: {line}");
        }
        assert!(times.iter().sum::<f64>() <= wall, "{line}: {times:?} of {wall}");
    }
}

#[test]
fn the_text_has_the_parts_that_took_time() {
    let project = Project::with(TABLE);
    for (line, parts) in &CASES[2..5] {
        let said = project.line(&format!("solve {line}"));
        let times = said.lines().into_iter().filter_map(|line| line.strip_prefix("time: "));
        let [told] = times.collect::<Vec<_>>()[..] else { panic!("{said:?}") };
        let shown = told.split(", ").filter_map(|part| part.split(' ').next());
        // The set-up of a mesh is called so.
        let shown: Vec<_> = shown.map(|name| if name == "mesh" { "setup" } else { name }).collect();
        for (json, name) in PARTS {
            assert!(shown.contains(&name) || !parts.contains(json), "{name}: {told}");
        }
        assert_eq!(shown.contains(&"files"), line.contains("--out"), "{told}");
        assert!(shown.iter().all(|name| PARTS.iter().any(|(_, text)| text == name)), "{told}");
    }
}
