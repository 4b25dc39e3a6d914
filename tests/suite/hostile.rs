//! Random scenes and command lines: an answer or a refusal with a documented exit code, soon.

use crate::common::{Dice, PAPER, Project, Said};
use std::process::{Command, Stdio};
use std::time::{SystemTime, UNIX_EPOCH};

/// Seconds after which a command counts as hung.
const PATIENCE: &str = "10";

fn one<'a>(dice: &mut Dice, of: &[&'a str]) -> &'a str {
    of[dice.below(of.len() as u64) as usize]
}

fn chance(dice: &mut Dice, percent: u64) -> bool {
    dice.below(100) < percent
}

fn number(dice: &mut Dice) -> String {
    if chance(dice, 60) {
        return format!("{}", (dice.below(4001) as f64 - 2000.0) / 1000.0);
    }
    let odd = [
        "0",
        "-0",
        "1",
        "-1",
        "0.5",
        "-0.5",
        "0.25",
        "1e-3",
        "1e6",
        "1e12",
        "1e-12",
        "1e300",
        "-1e300",
        "1e-300",
        "1e400",
        "nan",
        "inf",
        "-inf",
        "1e19",
        "18446744073709551616",
        "",
        "x",
        "0x10",
        "1_000",
        "--",
        "\u{2212}1",
    ];
    one(dice, &odd).into()
}

fn list(dice: &mut Dice, count: usize) -> String {
    (0..count).map(|_| number(dice)).collect::<Vec<_>>().join(",")
}

/// A right-hand side on the square or the cube, or nearly one.
fn source(dice: &mut Dice) -> String {
    if chance(dice, 10) {
        let names =
            ["full-contact", "torsion", "free-segment", "free-corner", "free-strip", "none"];
        return format!("exact({})", one(dice, &names));
    }
    let mut parts = Vec::new();
    for _ in 0..dice.below(4) {
        let region = match dice.below(7) {
            0 => format!("rect({})", list(dice, 4)),
            1 => format!("disc({})", list(dice, 3)),
            2 => format!("halfplane({})", list(dice, 3)),
            3 => format!("quadrant({})", one(dice, &["ll", "lr", "ul", "ur", "xx"])),
            4 => format!("box({})", list(dice, 6)),
            5 => format!("ball({})", list(dice, 4)),
            _ => one(dice, &["else", "", "rect(", "()", "disc(0,0,1)"]).into(),
        };
        parts.push(format!("{region}={}", number(dice)));
    }
    let background = if chance(dice, 50) { "-1".into() } else { number(dice) };
    parts.push(format!("else={background}"));
    parts.join("; ")
}

fn scene(dice: &mut Dice) -> String {
    let mut text = format!("title = \"t\"\nf = \"{}\"\n", source(dice));
    let grids = [
        "[4, 8]",
        "[4]",
        "[2, 4, 8, 16]",
        "[3, 6]",
        "[5]",
        "[]",
        "[1]",
        "[8, 4]",
        "[16384]",
        "[-4]",
        "4",
    ];
    text += &format!("grids = {}\n", one(dice, &grids));
    let caps = ["1", "7", "1000", "0", "-1", "1e3", "18446744073709551615"];
    let cap = if chance(dice, 80) { "1000" } else { one(dice, &caps[..6]) };
    text += &format!("max_iterations = {cap}\n");
    if chance(dice, 70) {
        text += &format!(
            "r = [{}]\n",
            one(dice, &["10, 1", "1e6", "10", "0.5, 0.5", "nan", "-1", "", "1e13"])
        );
    }
    if chance(dice, 50) {
        text += &format!(
            "stop = [\"{}\"]\n",
            one(dice, &["signed", "printed", "signed-dual", "printed-dual", "never"])
        );
    }
    if chance(dice, 40) {
        let loads = [
            "{ rule = \"exact\" }",
            "{ rule = \"nodal\", tie = \"upper-right\" }",
            "{ rule = \"lumped-average\" }",
            "{ rule = \"none\" }",
            "3",
        ];
        text += &format!("load = {}\n", one(dice, &loads));
    }
    if chance(dice, 30) {
        text += &format!("paper_table = {}\n", one(dice, &["1", "2", "0", "300"]));
    }
    let outputs = [
        "[\"table\"]",
        "[\"table\", \"source\"]",
        "[\"surface\", \"contact\"]",
        "[\"history\"]",
        "[]",
        "[\"identify\"]",
        "[\"none\"]",
    ];
    text + &format!("outputs = {}\n", one(dice, &outputs))
}

/// Adds an option with one of these values, sometimes.
fn maybe(dice: &mut Dice, args: &mut Vec<String>, percent: u64, option: &str, values: &[&str]) {
    if chance(dice, percent) {
        args.push(option.into());
        args.push(one(dice, values).into());
    }
}

fn solve(dice: &mut Dice) -> Vec<String> {
    let mut args = vec!["solve".to_owned()];
    match dice.below(10) {
        0..5 => args.extend(["--f".into(), source(dice)]),
        5..8 => args.extend(["--cube".into(), source(dice)]),
        _ => args.push(one(dice, &["a", "b", ""]).into()),
    }
    let widths = [
        "1/2",
        "1/3",
        "1/4",
        "4",
        "1/6",
        "1/7",
        "1/8",
        "16",
        "1/12",
        "0.25",
        "1/0",
        "1/1",
        "0",
        "x",
        "1/",
        "-1",
        "1/18446744073709551616",
        "1/100000000",
        "0.3",
    ];
    maybe(dice, &mut args, 95, "--h", &widths);
    let solvers = ["arrow-hurwicz", "uzawa", "uzawa-proximal", "multigrid", "active-set", "magic"];
    maybe(dice, &mut args, 80, "--solver", &solvers);
    maybe(dice, &mut args, 30, "--load", &["nodal", "exact", "lumped-average", "x"]);
    if chance(dice, 30) {
        args.extend(["--r".into(), number(dice)]);
    }
    maybe(
        dice,
        &mut args,
        30,
        "--stop",
        &["signed", "printed", "signed-dual", "printed-dual", "x"],
    );
    // With the default cap a run without a solution takes minutes; that is asked for, not a hang.
    let caps = ["1000", "2000", "1", "0", "-1", "1e3"];
    if !args.contains(&"--cube".to_owned()) {
        maybe(dice, &mut args, 100, "--max-iterations", &caps);
    }
    if chance(dice, 20) {
        args.extend(["--tolerance".into(), number(dice)]);
    }
    if chance(dice, 50) {
        args.push("--json".into());
    }
    let files = [
        "v.npy",
        "v.svg",
        "v.vti",
        "no/v.npy",
        "vtk",
        "svg",
        "/dev/null",
        "v.doc",
        "",
        ".",
        "pipeline",
    ];
    maybe(dice, &mut args, 40, "--out", &files);
    args
}

fn identify(dice: &mut Dice) -> Vec<String> {
    let mut args = vec!["identify".to_owned()];
    maybe(dice, &mut args, 100, "--budget", &["0.05", "0.02", "0", "1e-9", "-1", "nan", "x"]);
    maybe(dice, &mut args, 70, "--problem", &["1", "2", "both", "3"]);
    maybe(
        dice,
        &mut args,
        40,
        "--space",
        &["odd-quadrant", "quadrants", "rectangles", "blocks4", "x"],
    );
    if chance(dice, 50) {
        let parts = |dice: &mut Dice| match dice.below(4) {
            0 => list(dice, 2),
            1 => format!("{}:{}:{}", number(dice), number(dice), number(dice)),
            2 => one(dice, &["0:999999:0.000000001", "0:1e9:1", "999999999999999:1:1", "-8:4:0.5"])
                .into(),
            _ => number(dice),
        };
        let values = format!("{};{}", parts(dice), parts(dice));
        args.extend(["--values".into(), values]);
    }
    maybe(dice, &mut args, 30, "--method", &["enumerate", "anneal", "x"]);
    let counts = ["0", "1", "3", "100000", "18446744073709551615", "-1", "x"];
    for option in ["--chains", "--steps", "--top", "--threads", "--seed", "--exact-grids"] {
        maybe(dice, &mut args, 15, option, &counts);
    }
    for flag in ["--any-integral", "--json", "--variants"] {
        if chance(dice, 10) {
            args.push(flag.into());
        }
    }
    maybe(
        dice,
        &mut args,
        10,
        "--checkpoint",
        &["c.json", "no/c.json", ".", "pipeline/paper.toml"],
    );
    args
}

fn other(dice: &mut Dice) -> Vec<String> {
    let commands = [
        "run -q",
        "run -n",
        "run a -q",
        "run -q --only figures",
        "run -q --only diff",
        "run -q -j 3",
        "run -q -j -1",
        "run -q -k",
        "run --locked -q",
        "run b",
        "run --trace no/t.json",
        "status",
        "status --json",
        "status --exit-code",
        "explain solve",
        "explain figures",
        "explain x",
        "explain solve/a",
        "dag",
        "dag --dot",
        "dag --mermaid",
        "diff",
        "diff --json",
        "diff --md",
        "gc -n",
        "gc",
        "gc --keep 0",
        "certificate",
        "certificate --output no",
        "man",
        "completions bash",
        "bench --repeats 0",
        "bench --finest 17",
        "x",
        "",
        "--version",
        "report",
    ];
    one(dice, &commands).split_whitespace().map(str::to_owned).collect()
}

/// Runs this many random commands; each is answered or refused.
fn hostile(cases: usize) {
    let fresh = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos() as u64;
    let asked = std::env::var("SIGNORINI_SEED").ok().and_then(|text| text.parse().ok());
    let seed: u64 = asked.unwrap_or(fresh | 1);
    println!("SIGNORINI_SEED={seed} repeats these {cases} cases");
    let mut dice = Dice(seed);
    let mut codes = [0; 4];
    let mut project = Project::with("");
    for case in 0..cases {
        if case % 8 == 0 {
            project = Project::with(&scene(&mut dice));
            if chance(&mut dice, 20) {
                project.scene("b", &scene(&mut dice));
            }
            if chance(&mut dice, 10) {
                let from = ["1e-4", "[1, 2]", "number = 1", "10.0", "0.1", "1000"];
                let paper = PAPER.replace(one(&mut dice, &from), &number(&mut dice));
                project.write("pipeline/paper.toml", paper);
            }
        }
        let args = match dice.below(10) {
            0..6 => solve(&mut dice),
            6..8 => identify(&mut dice),
            _ => other(&mut dice),
        };
        let mut command = Command::new("timeout");
        command.args(["-s", "KILL", PATIENCE, env!("CARGO_BIN_EXE_signorini")]).args(&args);
        command.current_dir(project.path("")).stdin(Stdio::null());
        let said = Said::from(command.output().unwrap());
        let scene = std::fs::read_to_string(project.path("pipeline/scenes/a.toml")).unwrap();
        let why =
            |what: &str| format!("{what}; seed {seed}, case {case}: {args:?}\n{scene}\n{said:?}");
        match said.code {
            Some(code @ 0..4) => codes[code as usize] += 1,
            _ => panic!("{}", why("hung, or an exit code that is not documented")),
        }
        let bug = said.err.contains("panicked") || said.err.contains("this is a bug");
        assert!(!bug, "{}", why("a panic"));
        let silent = said.code == Some(2) && !said.err.contains("error: ");
        assert!(!silent, "{}", why("refused without a word"));
    }
    println!("exit codes 0, 1, 2, 3: {codes:?}");
}

#[test]
fn random_commands_are_answered_or_refused() {
    hostile(60);
}

#[test]
#[ignore = "takes an hour; SIGNORINI_CASES says how many"]
fn many_random_commands_are_answered_or_refused() {
    let asked = std::env::var("SIGNORINI_CASES").ok().and_then(|text| text.parse().ok());
    hostile(asked.unwrap_or(20_000));
}
