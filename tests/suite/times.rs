//! Times that `solve` tells: all of the time of the command, part by part.

use crate::common::{Project, Said, TABLE};
use serde_json::Value;
use std::time::{Duration, Instant};

/// Time that the parts may leave out, besides a tenth and what the program takes to start and to end.
const SLACK: Duration = Duration::from_millis(20);
/// Trials, because a busy system may stop a program just at its start or its end.
const TRIALS: usize = 10;
/// Parts in JSON and in the text; the first has two names there.
const PARTS: [(&str, &str); 5] = [
    ("setup", "setup"),
    ("load", "load"),
    ("solve", "solver"),
    ("bounds", "bounds"),
    ("files", "files"),
];

/// Problem that takes some tenths of a second, with the parts that take a part of it worth naming.
struct Case {
    args: &'static [&'static str],
    parts: &'static [&'static str],
}

const CASES: [Case; 7] = [
    Case {
        args: &["--f", "formula(3*x*y - 1.1 + exp(-40*(x^2 + y^2)))", "--h", "1/256"],
        parts: &["load", "solve", "bounds"],
    },
    Case {
        args: &["--f", "rect(0,0.5,0,0.5)=3; else=-1.1", "--accuracy", "8e-4"],
        parts: &["solve", "bounds"],
    },
    Case {
        args: &[
            "--domain",
            "disc",
            "--f",
            "halfplane(0,1,0)=-3; else=1.5",
            "--refine",
            "6",
            "--out",
            "v.svg",
        ],
        parts: &["setup", "load", "solve", "bounds", "files"],
    },
    Case {
        args: &[
            "--domain",
            "cube",
            "--f",
            "ball(0,0,0,0.25)=2; else=-1",
            "--h",
            "1/16",
            "--out",
            "v.vtu",
        ],
        parts: &["setup", "load", "solve", "bounds", "files"],
    },
    Case {
        args: &["--domain", "lshape", "--f", "rect(-1,0,0,1)=2; else=-2", "--accuracy", "8e-3"],
        parts: &["setup", "load", "solve", "bounds"],
    },
    Case {
        args: &[
            "--domain",
            "disc",
            "--f",
            "halfplane(0,1,0)=-3; else=1.5",
            "--accuracy-energy",
            "1e-4",
        ],
        parts: &["setup", "load", "solve", "bounds"],
    },
    Case {
        args: &[
            "--f",
            "rect(0,0.5,0,0.5)=3; else=-1.1",
            "--solver",
            "spectral",
            "--out",
            "v.npy",
            "--h",
            "1/64",
        ],
        parts: &["solve", "files"],
    },
];

fn timed(project: &Project, args: &[&str]) -> (Said, Duration) {
    let start = Instant::now();
    let said = project.run(args);
    (said, start.elapsed())
}

/// Seconds of all parts.
fn sum(seconds: &Value) -> Duration {
    let parts = seconds.as_object().unwrap().values();
    Duration::from_secs_f64(parts.map(|part| part.as_f64().unwrap()).sum())
}

#[test]
fn the_parts_add_up_to_the_time_of_the_command() {
    let project = Project::with(TABLE);
    for Case { args, parts } in CASES {
        let args = [&["solve", "--json"], args].concat();
        let mut left_out = Duration::MAX;
        for _ in 0..TRIALS {
            let (_, start) = timed(&project, &["list", "--json"]);
            let (said, wall) = timed(&project, &args);
            let seconds = &said.json()["seconds"];
            for (name, _) in PARTS {
                let time = seconds[name].as_f64().unwrap();
                assert!(time >= 0.0 && (time > 1e-6 || !parts.contains(&name)), "{name}: {said:?}");
            }
            let told = sum(seconds);
            assert!(told <= wall, "{args:?}: {told:?} of {wall:?}");
            left_out = wall.saturating_sub(told + wall / 10 + start);
            if left_out <= SLACK {
                break;
            }
        }
        assert!(left_out <= SLACK, "{args:?}: {left_out:?} are not told");
    }
}

#[test]
fn the_text_has_the_parts_that_took_time() {
    let project = Project::with(TABLE);
    for &Case { args, parts } in &CASES[2..5] {
        let said = project.run(&[&["solve"], args].concat());
        let times: Vec<_> =
            said.lines().into_iter().filter_map(|line| line.strip_prefix("time: ")).collect();
        let [line] = times[..] else { panic!("{said:?}") };
        let setup = if args.contains(&"--domain") { "mesh" } else { "setup" };
        let names = PARTS.map(|(json, text)| (json, if json == "setup" { setup } else { text }));
        let shown: Vec<_> = line
            .split(", ")
            .filter_map(|part| part.split_once(' '))
            .map(|(name, _)| name)
            .collect();
        for (json, name) in names {
            assert!(shown.contains(&name) || !parts.contains(&json), "{name}: {line}");
        }
        assert_eq!(shown.contains(&"files"), args.contains(&"--out"), "{line}");
        assert!(shown.iter().all(|name| names.iter().any(|(_, text)| text == name)), "{line}");
    }
}
