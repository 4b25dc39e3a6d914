//! Random scenes and command lines: an answer or a refusal with a documented exit code, soon.
//!
//! `SIGNORINI_CASES` is the number of commands, 60 without it; `SIGNORINI_SEED` is the seed.

use crate::common::{Dice, PAPER, Project, Said};
use crate::edits::number;
use std::process::{Command, Stdio};

/// Seconds after which a command counts as hung, on a machine that may be busy.
const LONGEST: &str = "600";

/// Chooses at random, and what is wrong in some of its choices.
struct Chooser {
    dice: Dice,
    /// Of a hundred choices, how many may be wrong.
    wrong: u64,
}

/// The parts of a text between the marks.
fn parts(text: &str) -> Vec<&str> {
    text.split('¦').map(str::trim).collect()
}

/// The words of a text.
fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().collect()
}

impl Chooser {
    fn chance(&mut self, percent: u64) -> bool {
        self.dice.below(100) < percent
    }

    /// One of the words; those after "|" are wrong ones.
    fn one<'a>(&mut self, words: &[&'a str]) -> &'a str {
        let bar = words.iter().position(|word| *word == "|").unwrap_or(words.len());
        let wrong = bar < words.len() && self.chance(self.wrong);
        let from = if wrong { &words[bar + 1..] } else { &words[..bar] };
        from[self.dice.below(from.len() as u64) as usize]
    }

    fn number(&mut self) -> String {
        let words = words(
            "small | 0 -0 1e300 -1e300 1e-300 1e400 nan inf -inf 1e19 18446744073709551616 x 0x10 1_000 -- \u{2212}1",
        );
        match self.one(&words) {
            "small" => format!("{}", (self.dice.below(2001) as f64 - 1000.0) / 1000.0),
            word => word.into(),
        }
    }

    fn numbers(&mut self, count: usize) -> String {
        (0..count).map(|_| self.number()).collect::<Vec<_>>().join(",")
    }

    /// Two numbers per axis, the smaller one first unless something is wrong.
    fn sides(&mut self, axes: usize) -> String {
        if self.chance(self.wrong) {
            return self.numbers(2 * axes);
        }
        let mut side = || {
            let low = self.dice.below(80) as f64 / 100.0 - 0.5;
            format!("{low},{}", low + (self.dice.below(50) + 1) as f64 / 100.0)
        };
        (0..axes).map(|_| side()).collect::<Vec<_>>().join(",")
    }

    /// A right-hand side on the square or the cube, or nearly one.
    fn source(&mut self, cube: bool) -> String {
        if self.chance(10) {
            let square = ["full-contact", "torsion", "free-segment", "free-corner", "|", "none"];
            let names =
                if cube { &["full-contact", "free-strip", "free-disc"][..] } else { &square };
            return format!("exact({})", self.one(names));
        }
        let mut text = String::new();
        for _ in 0..self.dice.below(4) {
            let size = 1 + self.dice.below(8);
            text += &match (cube, self.dice.below(4)) {
                _ if self.chance(self.wrong) => {
                    self.one(&["else", "", "rect(", "()", "x(0,0,1)"]).into()
                }
                (false, 0) => format!("rect({})", self.sides(2)),
                (false, 1) => format!("disc({},0.{size})", self.numbers(2)),
                (false, 2) => format!("halfplane({})", self.numbers(3)),
                (false, _) => {
                    format!("quadrant({})", self.one(&["ll", "lr", "ul", "ur", "|", "xx"]))
                }
                (true, 0) => format!("box({})", self.sides(3)),
                (true, 1) => format!("halfspace({})", self.numbers(4)),
                (true, _) => format!("ball({},0.{size})", self.numbers(3)),
            };
            text += &format!("={}; ", self.number());
        }
        text + "else=" + self.one(&["-1", "-2", "-3", "-0.75", "|", "1", "nan", "-1e308", ""])
    }

    fn scene(&mut self) -> String {
        let mut text = format!("title = \"t\"\nf = \"{}\"\n", self.source(false));
        let grids = parts(
            "[4, 8] ¦ [4] ¦ [2, 4, 8, 16] ¦ [3, 6] ¦ [5] ¦ | ¦ [] ¦ [1] ¦ [8, 4] ¦ [16384] ¦ [-4] ¦ 4",
        );
        text += &format!("grids = {}\n", self.one(&grids));
        let solvers = words("arrow-hurwicz uzawa uzawa-proximal | multigrid spectral active-set x");
        text += &format!("solver = \"{}\"\n", self.one(&solvers));
        let caps = parts("1000 ¦ 7 ¦ 1 ¦ | ¦ 0 ¦ -1 ¦ 1e3");
        text += &format!("max_iterations = {}\n", self.one(&caps));
        let r = parts("10, 1 ¦ 1e6 ¦ 10 ¦ 0.5 ¦ | ¦ 0.5, 0.5 ¦ nan ¦ -1 ¦  ¦ 1e13");
        text += &format!("r = [{}]\n", self.one(&r));
        let stop = parts("signed ¦ printed ¦ signed-dual ¦ printed-dual ¦ | ¦ never");
        text += &format!("stop = [\"{}\"]\n", self.one(&stop));
        let loads = parts(
            "{ rule = \"exact\" } ¦ { rule = \"nodal\", tie = \"upper-right\" } ¦ | ¦ { rule = \"none\" } ¦ 3",
        );
        text += &format!("load = {}\n", self.one(&loads));
        if self.chance(30) {
            text += &format!("paper_table = {}\n", self.one(&["1", "|", "2", "0", "300"]));
        }
        let outputs = parts(
            "\"table\" ¦ \"table\", \"source\" ¦ \"surface\", \"contact\" ¦ \"history\" ¦  ¦ | ¦ \"identify\" ¦ \"none\" ¦ 3",
        );
        text + &format!("outputs = [{}]\n", self.one(&outputs))
    }

    /// An option with one of these values, sometimes.
    fn maybe(&mut self, args: &mut Vec<String>, percent: u64, option: &str, values: &[&str]) {
        if self.chance(percent) {
            args.push(option.into());
            args.push(self.one(values).into());
        }
    }

    /// Options for the methods over nested grids.
    fn iteration(&mut self, args: &mut Vec<String>) {
        // With the default cap a run without a solution takes minutes; that is asked for, not a hang.
        self.maybe(args, 100, "--max-iterations", &["1000", "2000", "1", "|", "0", "-1", "1e3"]);
        self.maybe(args, 30, "--r", &["0.5", "1", "10", "1e6", "|", "0", "-1", "nan", "1e300"]);
        self.maybe(
            args,
            30,
            "--stop",
            &["signed", "printed", "signed-dual", "printed-dual", "|", "x"],
        );
    }

    fn solve(&mut self) -> Vec<String> {
        let mut args = vec!["solve".to_owned()];
        let cube = self.chance(30);
        match self.dice.below(10) {
            0 => args.push(self.one(&["a", "|", "b", ""]).into()),
            _ if cube => {
                args.extend(["--domain", "cube", "--f"].map(str::to_owned));
                args.push(self.source(true));
            }
            _ => args.extend(["--f".into(), self.source(false)]),
        }
        let widths = words(
            "1/2 1/4 4 1/6 1/8 16 1/12 0.25 | 1/3 1/7 1/0 1/1 0 x 1/ -1 1/18446744073709551616 1/100000000 0.3",
        );
        self.maybe(&mut args, 100, "--h", &widths);
        let cubes = ["multigrid", "active-set", "|", "spectral"];
        let squares =
            ["arrow-hurwicz", "uzawa", "uzawa-proximal", "multigrid", "active-set", "|", "magic"];
        self.maybe(&mut args, 80, "--solver", if cube { &cubes } else { &squares });
        let on_one_grid = |arg: &String| ["cube", "multigrid", "active-set"].contains(&&**arg);
        if args[1] != "--domain" {
            self.maybe(&mut args, 30, "--load", &["nodal", "exact", "bilinear", "|", "x"]);
        }
        if !args.iter().any(on_one_grid) || self.chance(5) {
            self.iteration(&mut args);
        }
        if args.contains(&"multigrid".to_owned()) {
            self.maybe(
                &mut args,
                20,
                "--tolerance",
                &["1e-6", "1", "1e-30", "|", "0", "nan", "-1"],
            );
        }
        if self.chance(50) {
            args.push("--json".into());
        }
        let files = parts(
            "v.npy ¦ v.vti ¦ vti ¦ /dev/null ¦ | ¦ v.svg ¦ no/v.npy ¦ v.doc ¦  ¦ . ¦ pipeline",
        );
        self.maybe(&mut args, 40, "--out", &files);
        args
    }

    fn other(&mut self) -> Vec<String> {
        let commands = "run -q, run -n, run a -q, run -q --only figures, run -q -j 3, run -q -k, status, \
            status --json, explain solve, explain solve/a, dag, dag --mermaid, dag --mermaid, diff, \
            diff --json, diff --md, gc -n, gc, man, completions bash, report, |, run -q -j -1, \
            run -q --only x, run --locked -q, run b, status --exit-code, explain x, gc --keep 0, \
            certificate, certificate --output no, bench --repeats 0, bench --finest 17, x, ";
        let commands: Vec<_> = commands.split(", ").collect();
        self.one(&commands).split_whitespace().map(str::to_owned).collect()
    }

    fn project(&mut self) -> Project {
        let project = Project::with(&self.scene());
        if self.chance(20) {
            project.scene("b", &self.scene());
        }
        let mut paper = PAPER.to_owned();
        if self.chance(self.wrong) {
            let from = ["1e-4", "[1, 2]", "number = 1", "10.0", "0.1", "1000"];
            paper = paper.replace(self.one(&from), &self.number());
        }
        project.write("pipeline/paper.toml", paper);
        project
    }
}

/// Runs this many random commands; each is answered or refused.
fn hostile(cases: usize, seed: u64) {
    println!("SIGNORINI_SEED={seed} repeats these {cases} cases");
    let mut chooser = Chooser { dice: Dice(seed), wrong: 0 };
    let mut codes = [0; 4];
    let mut project = Project::with("");
    for case in 0..cases {
        // By turns without a mistake, with a few, and with many.
        chooser.wrong = [0, 5, 30][case % 3];
        if case % 9 == 0 {
            project = chooser.project();
        }
        let args = match chooser.dice.below(10) {
            0..8 => chooser.solve(),
            _ => chooser.other(),
        };
        let mut command = Command::new("timeout");
        command.args(["-s", "KILL", LONGEST, env!("CARGO_BIN_EXE_signorini")]).args(&args);
        command.current_dir(project.path("")).stdin(Stdio::null());
        let said = Said::from(command.output().unwrap());
        let scene = project.read("pipeline/scenes/a.toml");
        let why =
            |what: &str| format!("{what}; seed {seed}, case {case}: {args:?}\n{scene}\n{said:?}");
        match said.code {
            Some(code @ 0..4) => codes[code as usize] += 1,
            _ => panic!("{}", why("hung, or an exit code that is not documented")),
        }
        let bug = said.err.contains("panicked") || said.err.contains("this is a bug");
        assert!(!bug, "{}", why("a panic"));
        let silent = matches!(said.code, Some(2 | 3)) && !said.err.contains("error: ");
        assert!(!silent, "{}", why("refused without a word"));
    }
    println!("exit codes 0, 1, 2, 3: {codes:?}");
}

#[test]
fn random_commands_are_answered_or_refused() {
    // The same ones every time: a failure is a failure for everyone.
    hostile(number("SIGNORINI_CASES", 60) as usize, number("SIGNORINI_SEED", 1));
}
