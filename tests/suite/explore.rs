//! The book of this project as a reader opens it: the live iteration in a browser gives the tables'
//! counts, and what the book says about the program is what the program says.

use crate::common::{browser, commands, copy, dom, skip, unescaped};
use serde_json::Value;
use signorini::discrete::grid::nested;
use signorini::discrete::load::load;
use signorini::pipeline::hash;
use signorini::replication::scene::Scene;
use signorini::saddle::{Params, StopRule, solve_nested};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Presses "Compute both tables here", which leaves all numbers in the page.
const PRESS_ALL: &str = r#"document.querySelector('[data-do="all"]').click();"#;

/// Goes through the controls as a reader would, and notes what the page says.
const GO_THROUGH: &str = r##"
// Pictures come by the browser's real clock, everything else in here by its virtual one.
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 16);
const form = document.querySelector(".explore form"), log = [];
const say = (what) => log.push([what, document.querySelector(".explore-status").textContent,
  [...document.querySelectorAll(".explore-counts tbody tr:first-child td")].map((c) => c.textContent).join(" ")]);
const press = (name) => document.querySelector(`[data-do="${name}"]`).click();
const choose = (name, value) => {
  form[name].value = value;
  form.dispatchEvent(new Event("change", { bubbles: true }));
};
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
window.addEventListener("error", (event) => log.push(["error", event.message, ""]));
(async () => {
  await sleep(500); say("opened");
  choose("problem", "2"); await sleep(500); say("problem 2");
  document.querySelector('[data-r="1"]').click(); await sleep(500); say("r = 1");
  choose("rule", "printed"); await sleep(500); say("printed");
  choose("rule", "signed"); choose("finest", "16"); await sleep(500); say("three grids");
  press("restart"); say("start");
  press("step"); say("one step");
  press("grid"); await sleep(100); say("one grid");
  press("play"); await sleep(5000); say("played");
  choose("problem", "own"); await sleep(500); say("own");
  choose("f", "disc(0,0,0.25)=2; else=-1"); await sleep(500); say("disc");
  choose("f", "disc(0,0)=2; else=-1"); await sleep(500); say("nonsense");
  choose("f", "else=1"); await sleep(500); say("no solution");
  choose("problem", "2"); await sleep(500);
  const canvas = document.querySelector(".explore canvas"), alone = canvas.toDataURL();
  form.truth.click();
  log.push(["truth", `${!form.truth.disabled && canvas.toDataURL() !== alone}`, ""]);
  log.push(["spent", document.querySelector('[data-value="spent"]').textContent, ""]);
  const paths = document.querySelectorAll(".explore svg path[d^=M]").length;
  log.push(["drawn", String(paths), ""]);
  document.body.dataset.log = JSON.stringify(log);
})();"##;

#[test]
fn the_page_gives_the_published_counts_and_the_last_bit() {
    let book = book();
    let tables = match browser() {
        Some(browser) => {
            let page = opened(&browser, book, "?problem=2&r=1", PRESS_ALL, 10_000);
            assert!(page.contains("published 5.8·10⁻²"), "the link's problem is not shown");
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
        let cells: Vec<_> = scene.grids.iter().map(|grid| grid.cells()).collect();
        let grids = nested(&cells).unwrap();
        let loads: Vec<_> = grids.iter().map(|&g| load(g, &scene.f, scene.load)).collect();
        for (row, &r) in scene.r.iter().enumerate() {
            let params = Params { r, rule: StopRule::Signed, ..Params::default() };
            let (outcomes, _) = solve_nested(&grids, &loads, &params, scene.prolongation, &mut ());
            let theirs: f64 = tables[k]["delta_a"][row].as_str().unwrap().parse().unwrap();
            assert_eq!(theirs.to_bits(), outcomes[4].delta_a.to_bits(), "{name}, r = {r}");
        }
    }
}

#[test]
fn the_controls_do_what_they_say() {
    let Some(browser) = browser() else {
        skip("no chromium; nobody has pressed the buttons of explore.html");
        return;
    };
    let page = opened(&browser, book(), "", GO_THROUGH, 40_000);
    let log = page.split(r#"data-log=""#).nth(1).unwrap_or_else(|| panic!("no log in {page}"));
    let log: Vec<[String; 3]> =
        serde_json::from_str(&unescaped(log.split('"').next().unwrap())).unwrap();
    let said: BTreeMap<&str, (&str, &str)> =
        log.iter().map(|[what, status, counts]| (&**what, (&**status, &**counts))).collect();
    assert!(!said.contains_key("error"), "{log:?}");
    let is = |what: &str, status: &str, counts: &str| {
        let (true_status, true_counts) = said[what];
        assert!(true_status.contains(status), "{what}: {true_status}");
        assert_eq!(true_counts, counts, "{what}");
    };
    is("opened", "Done: 5 of 5 counts as published", "1 2 10 41 150");
    is("problem 2", "Done: 5 of 5 counts as published", "3 4 7 11 23");
    is("r = 1", "Δa = 5.8·10⁻², published 5.8·10⁻²", "3 2 2 5 16");
    is("printed", "Done: 1 of 5 counts as published", "3 38 284 1807 10270");
    is("three grids", "Done: 3 of 3 counts as published", "3 2 2");
    is("start", "Grid 1/4, iteration 0.", "0  ");
    is("one step", "Grid 1/4, iteration 1.", "1  ");
    is("one grid", "The rule is met on 1/4 after 3 iterations.", "3  ");
    is("played", "Done: 3 of 3 counts as published", "3 2 2");
    assert!(said["own"].0.starts_with("Done: "), "{log:?}");
    assert_ne!(said["own"].1, said["disc"].1);
    assert_eq!(said["nonsense"].0, "cannot read “disc(0,0)”.");
    assert!(said["no solution"].0.contains("that discrete problem has no solution"), "{log:?}");
    assert_eq!(said["truth"].0, "true", "the net of the true solution is drawn");
    assert!(said["spent"].0.ends_with(" ms"), "{log:?}");
    // Two residuals, trace, multiplier, and the bar of contact.
    assert!(said["drawn"].0.parse::<usize>().unwrap() >= 4, "{log:?}");
}

#[test]
fn the_reference_is_what_the_program_says() {
    let page = fs::read_to_string(book().join("../src/commands.md")).unwrap();
    let help = String::from_utf8(signorini(&["--help"]).stdout).unwrap();
    let names = commands(&help);
    assert!(names.len() > 8, "{names:?}");
    assert!(page.contains(&without_padding(&help)), "--help");
    for name in names {
        let help = String::from_utf8(signorini(&[name, "--help"]).stdout).unwrap();
        let shown = format!("## `signorini {name}`\n\n```text\n{}```\n", without_padding(&help));
        assert!(page.contains(&shown), "{name}: {page}");
    }
}

/// Lines as the page has them.
fn without_padding(text: &str) -> String {
    text.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}

#[test]
fn the_graph_is_what_dag_prints() {
    let page = fs::read_to_string(book().join("../src/provenance.md")).unwrap();
    let graph = String::from_utf8(signorini(&["dag", "--mermaid"]).stdout).unwrap();
    assert!(graph.starts_with("graph LR\n") && page.contains(&graph));
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

/// The elements of the page that a link asks by `query` after `script` has run at its end for so many
/// milliseconds of its own time.
fn opened(browser: &Path, book: &Path, query: &str, script: &str, budget: u32) -> String {
    let source = fs::read_to_string(book.join("explore.html")).unwrap();
    // Beside the page itself, so that all it loads is where it expects it.
    let page = book.join(format!("explore-test-{budget}.html"));
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
const page = fs.readFileSync(book + "/explore.html", "utf8");
const data = /class="explore-data">([^]*?)<\/script>/.exec(page)[1];
const { allCells } = new Function(script + "; return signorini")();
const text = (_, v) => (typeof v === "number" ? String(v) : v);
console.log(JSON.stringify(allCells(JSON.parse(data)), text));"#;
    let output = Command::new("node").args(["-e", PROGRAM]).arg(book).output().ok()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).ok()
}
