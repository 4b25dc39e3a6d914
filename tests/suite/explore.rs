//! The book of this project as a reader opens it: the live iteration in a browser gives the tables'
//! counts, and what the book says about the program is what the program says.

mod controls;
mod pictures;

use crate::browser::{browser, dom, run_script, unescaped};
use crate::common::{copy, skip};
use crate::grammar::SCRIPT;
use serde_json::Value;
use signorini::pipeline::hash;
use signorini::replication::scene::Scene;
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::nested::DiscreteLevels;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{Pair, Params, StopRule, solve_nested};
use signorini_mathematics::square::load::load;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Presses "Compute both tables here", which leaves all numbers in the page.
const PRESS_ALL: &str = r#"document.querySelector('[data-do="all"]').click();"#;

/// What all tests do on the page, before what one of them does.
const READER: &str = include_str!("explore/reader.js");

#[test]
fn the_page_gives_the_published_counts_and_the_last_bit() {
    let book = book();
    let tables = match browser() {
        Some(browser) => {
            let page = opened(&browser, book, "?problem=2&r=1", PRESS_ALL, 10_000);
            assert!(page.contains("published 5.8·10⁻²"), "the link's problem is not shown");
            // What the keyboard reaches first.
            let skip = page.find(r##"<a class="skip" href="#"##).expect("a link to the text");
            assert!(page[..skip].find("<button").is_none() && page.contains("<main"), "{skip}");
            let out = page.split(r#"class="explore-all" data-tables=""#).nth(1);
            let out = out.unwrap_or_else(|| panic!("no tables in the page: {page}"));
            let (text, rest) = out.split_once('"').unwrap();
            assert!(rest.contains("50 of 50 counts as published"), "{rest}");
            unescaped(text)
        }
        None => {
            skip("no chromium, so that the page itself is not opened; trying node");
            let Some(text) = in_node(book) else {
                skip("no node either; the script's counts are not checked at all");
                return;
            };
            text
        }
    };
    let tables: Value = serde_json::from_str(&tables).unwrap();

    // The tables as `diff` tells them.
    let said = signorini(&["diff", "--json"]);
    let diff: Value = serde_json::from_slice(&said.stdout).unwrap();
    let mut compared = 0;
    for (k, table) in diff["tables"].as_array().unwrap().iter().enumerate() {
        assert_eq!(tables[k]["number"], table["table"].to_string());
        for (row, line) in table["rows"].as_array().unwrap().iter().enumerate() {
            for (level, count) in line["ours"].as_array().unwrap().iter().enumerate() {
                assert_eq!(tables[k]["counts"][row][level], count.to_string(), "{line}");
                assert_eq!(count, &line["paper"][level]);
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 50);

    // Delta a depends on every operation before it: equal bits say that all of them are the same.
    for (k, name) in ["problem1", "problem2"].into_iter().enumerate() {
        let text = fs::read_to_string(format!("{ROOT}/pipeline/scenes/{name}.toml")).unwrap();
        let scene = Scene::parse(name, &text).unwrap();
        let cells: Vec<_> = scene.grids().iter().map(|grid| grid.cells()).collect();
        let grids = nested(&cells).unwrap();
        let loads: Vec<_> = grids.iter().map(|&g| load(g, &scene.source(), scene.load())).collect();
        for (row, &r) in scene.r().iter().enumerate() {
            let params = Params { r, rule: StopRule::Signed, ..Params::default() };
            let (outcomes, _) = solve_nested(
                DiscreteLevels::Grids(&grids, Law::SIGNORINI),
                &loads,
                &params,
                &mut (),
            );
            let theirs: f64 = tables[k]["delta_a"][row].as_str().unwrap().parse().unwrap();
            assert_eq!(theirs.to_bits(), outcomes[4].end.change().to_bits(), "{name}, r = {r}");
        }
    }
}

#[test]
fn contact_is_where_the_program_finds_it() {
    const TEXTS: [&str; 5] = [
        "quadrant(ll)=-6; else=1.998",
        "else=-1",
        "disc(0.1,0,0.25)=4; else=-1",
        "halfplane(1,-1,0)=1; disc(0,0,0.25)=-9; else=-1",
        "disc(0,0,0.25)=4e-12; else=-1e-12",
    ];
    // Before the first iteration, where v and the multiplier are zero, after one, and at the end.
    const RUN: &str = r#"
const answer = JSON.stringify(texts.map((f) => {
  const problem = { f, load: "nodal", tie: "lower-left", diagonal: "rising", prolongation: "bilinear" };
  const run = new signorini.Run(problem, [4, 8, 16], 10, "printed-dual");
  const contact = () => run.contact().map(Number).join("");
  return [[contact()], (run.step(), [contact()]), (run.finish(), [contact()])].flat();
}));
"#;
    let data = format!("const texts = {};\n", serde_json::json!(TEXTS));
    let method = include_str!("../../report/templates/arrow-hurwicz.js");
    let Some(answer) = run_script(&[SCRIPT, method, &data, RUN].concat()) else { return };
    let answers: Vec<[String; 3]> = serde_json::from_str(&answer).unwrap();
    let grids = nested(&[4, 8, 16]).unwrap();
    for (text, page) in TEXTS.into_iter().zip(answers) {
        let f = text.parse().unwrap();
        let loads: Vec<_> = grids.iter().map(|&g| load(g, &f, LoadRule::default())).collect();
        let params = |max_iterations| Params {
            r: 10.0,
            rule: StopRule::PrintedDual,
            max_iterations,
            ..Params::default()
        };
        let after = |grids: &[Grid], max_iterations| {
            let params = params(max_iterations);
            let (_, pair) = solve_nested(
                DiscreteLevels::Grids(grids, Law::SIGNORINI),
                &loads[..grids.len()],
                &params,
                &mut (),
            );
            digits(&pair.in_contact((grids[grids.len() - 1], Law::SIGNORINI)))
        };
        let start =
            digits(&Pair::zero((grids[0], Law::SIGNORINI)).in_contact((grids[0], Law::SIGNORINI)));
        let program = [start, after(&grids[..1], 1), after(&grids, 1_000_000)];
        assert_eq!(page, program, "{text}");
    }
}

fn digits(in_contact: &[bool]) -> String {
    in_contact.iter().map(|&contact| if contact { '1' } else { '0' }).collect()
}

/// The project's book, built once from a copy of the project with a cache of its own.
pub(crate) fn book() -> &'static Path {
    static BOOK: OnceLock<PathBuf> = OnceLock::new();
    BOOK.get_or_init(|| {
        let said = signorini(&["run", "--only", "report"]);
        assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
        project().join("report/book")
    })
}

fn project() -> &'static Path {
    static PROJECT: OnceLock<PathBuf> = OnceLock::new();
    PROJECT.get_or_init(|| {
        let project = Path::new(env!("CARGO_TARGET_TMPDIR")).join("explore");
        // What another build has cached may be of another form, while its version is not yet raised.
        let build = hash(&fs::read(env!("CARGO_BIN_EXE_signorini")).unwrap());
        if fs::read_to_string(project.join("build")).ok().as_ref() != Some(&build) {
            let _ = fs::remove_dir_all(&project);
        }
        fs::create_dir_all(&project).unwrap();
        fs::write(project.join("build"), build).unwrap();
        // `.ci/run` has made one already.
        if let Some(cache) = std::env::var_os("SIGNORINI_TEST_CACHE") {
            copy(Path::new(&cache), &project.join(".signorini"));
        }
        for part in ["pipeline", "report"] {
            // What was removed from the project must not live on in the copy.
            let _ = fs::remove_dir_all(project.join(part));
            copy(&Path::new(ROOT).join(part), &project.join(part));
        }
        project
    })
}

fn signorini(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_signorini"));
    command.args(args).current_dir(project()).output().expect("the binary starts")
}

/// What a test notes on the page that a link asks for by `query`, where it does `act`.
fn notes(browser: &Path, book: &Path, query: &str, act: &str) -> Vec<Value> {
    let script = format!("{READER}\nread(async () => {{{act}}});");
    let page = opened(browser, book, query, &script, 60_000);
    let log = page.split(r#"data-log=""#).nth(1).unwrap_or_else(|| panic!("no notes in {page}"));
    serde_json::from_str(&unescaped(log.split('"').next().unwrap())).unwrap()
}

/// The elements of the page that a link asks by `query` after `script` has run at its end for so many
/// milliseconds of its own time.
fn opened(browser: &Path, book: &Path, query: &str, script: &str, budget: u32) -> String {
    static OPENED: AtomicUsize = AtomicUsize::new(0);
    let source = fs::read_to_string(book.join("tables.html")).unwrap();
    // Beside the page itself, so that all it loads is where it expects it.
    let number = OPENED.fetch_add(1, Ordering::Relaxed);
    let page = book.join(format!("explore-test-{number}.html"));
    let body = source.replace("</body>", &format!("<script>{script}</script></body>"));
    assert_ne!(body, source);
    fs::write(&page, body).unwrap();
    let dom = dom(browser, &page, query, budget);
    fs::remove_file(&page).unwrap();
    dom
}

/// The tables computed by the page's script and data without a page; `None` if node is not there.
fn in_node(book: &Path) -> Option<String> {
    const PROGRAM: &str = r#"
const fs = require("fs"), book = process.argv[1];
const script = ["right-hand-side.js", "arrow-hurwicz.js"]
  .map((name) => fs.readFileSync(book + "/" + name, "utf8")).join("");
const page = fs.readFileSync(book + "/tables.html", "utf8");
const data = /class="explore-data">([^]*?)<\/script>/.exec(page)[1];
const { allCells } = new Function(script + "; return signorini")();
const text = (_, v) => (typeof v === "number" ? String(v) : v);
console.log(JSON.stringify(allCells(JSON.parse(data)), text));"#;
    let output = Command::new("node").args(["-e", PROGRAM]).arg(book).output().ok()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).ok()
}
