//! The controls of the page with the live iteration, pressed in a browser as a reader would.

use super::{book, notes, signorini};
use crate::browser::browser;
use crate::common::skip;
use serde_json::{Value, json};

/// Goes through the controls, and notes what the page says.
const GO_THROUGH: &str = r#"
await note("opened");
choose("problem", "1"); await note("problem 1");
choose("problem", "2"); await note("problem 2");
document.querySelector('[data-r="1"]').click(); await note("r = 1");
choose("rule", "printed"); await note("printed");
choose("rule", "signed"); await note("signed");
choose("finest", "16"); await note("three grids");
press("restart"); await note("start", 0);
press("step"); await note("one step", 0);
press("grid"); await note("one grid");
form.speed.value = 2;
press("play"); await note("played", 5000);
press("play"); await note("playing", 300);
await note("played again", 5000);
press("play"); await note("playing again", 300);
press("play"); await note("paused");
press("play"); await sleep(100); heard = [];
press("step"); await note("step while playing");
press("end"); await note("end");
choose("problem", "own"); await note("own");
choose("f", "disc(1/8,0,0.25)=7/3; else=-1"); await note("disc");
choose("f", "disc(0,0)=2; else=-1"); await note("nonsense");
choose("f", "disc(0,1)=2; else=-1"); await note("nonsense again");
choose("f", "else=1"); await note("no solution");
choose("f", "else=-1e131"); await note("huge");
choose("f", "else=-1"); await note("good again");
choose("r", "0"); await note("r = 0");
choose("r", "10"); await note("r = 10");
choose("problem", "2"); await sleep(500); heard = [];
const canvas = document.querySelector(".explore canvas"), both = canvas.toDataURL();
const dashed = () => document.querySelectorAll('[data-chart="boundary"] .known').length;
const traces = dashed();
form.truth.click();
await note(`net ${canvas.toDataURL() !== both && traces === 2 && dashed() === 0}`);
"#;

#[test]
fn the_controls_do_what_they_say() {
    let Some(browser) = browser() else {
        skip("no chromium; nobody has pressed the buttons of tables.html");
        return;
    };
    let notes = notes(&browser, book(), "", GO_THROUGH);
    let note = |what: &str| {
        let found = notes.iter().find(|note| note["what"] == what);
        found.unwrap_or_else(|| panic!("{what}: {notes:#?}"))
    };
    assert!(notes.iter().all(|note| note["what"] != "error"), "{notes:#?}");

    // What the page says, and the counts of its grids.
    for (what, status, counts) in [
        ("opened", "Done: 5 of 5 counts as published; Δa = 2.2·10⁻³", "3 4 7 11 23"),
        ("problem 1", "Done: 5 of 5 counts as published", "1 2 10 41 150"),
        ("problem 2", "Done: 5 of 5 counts as published", "3 4 7 11 23"),
        ("r = 1", "Δa = 5.8·10⁻², published 5.8·10⁻²", "3 2 2 5 16"),
        ("printed", "Done: 1 of 5 counts as published", "3 38 284 1807 10270"),
        ("signed", "Done: 5 of 5 counts as published", "3 2 2 5 16"),
        ("three grids", "Done: 3 of 3 counts as published", "3 2 2"),
        ("start", "Grid 1/4, iteration 0.", "0  "),
        ("one step", "Grid 1/4, iteration 1.", "1  "),
        ("one grid", "The rule is met on 1/4 after 3 iterations.", "3  "),
        ("played", "Done: 3 of 3 counts as published", "3 2 2"),
        ("played again", "Done: 3 of 3 counts as published", "3 2 2"),
        ("end", "Done: 3 of 3 counts as published", "3 2 2"),
    ] {
        let note = note(what);
        assert!(note["status"].as_str().unwrap().contains(status), "{note:#}");
        assert_eq!(note["counts"], counts, "{note:#}");
    }

    // A bad f or r marks its field, which the message describes; a good one takes the mark away.
    for (what, status, marked) in [
        ("own", "Done: ", ["", ""]),
        ("disc", "Done: ", ["", ""]),
        ("nonsense", "`disc` takes x,y,radius, e.g. disc(0,0,0.25).", ["true", ""]),
        (
            "no solution",
            "the integral of f is 1.000, but the flux through the boundary can only balance a negative",
            ["true", ""],
        ),
        ("huge", "the largest value of |f| is 1e131, outside 1e-130 to 1e130", ["true", ""]),
        ("good again", "Done: ", ["", ""]),
        ("r = 0", "r must be a number from 0.001 to 1000000000.", ["", "true"]),
        ("r = 10", "Done: ", ["", ""]),
    ] {
        let note = note(what);
        assert!(note["status"].as_str().unwrap().starts_with(status), "{note:#}");
        assert_eq!(note["marked"], json!(marked), "{note:#}");
        assert_eq!(note["command"] == "", marked != ["", ""], "{note:#}");
    }

    // A screen reader hears each stop once, and nothing while the iteration runs or where nothing stops.
    for note in &notes[1..] {
        let what = note["what"].as_str().unwrap();
        let runs = ["playing", "playing again", "net true"].contains(&what);
        let heard = if runs { json!([]) } else { json!([note["status"]]) };
        assert_eq!(note["heard"], heard, "{note:#}");
    }
    assert!(notes.iter().any(|note| note["what"] == "net true"), "no net of the true solution");
}

#[test]
fn the_command_that_is_shown_makes_the_same_iterations() {
    const LOADS_AND_RULES: &str = r#"
choose("finest", "32");
await note("problem 2");
choose("problem", "own"); await note("own, as it begins");
choose("f", "disc(-1/4,0,1/5)=6; halfplane(1,2,-0.9)=-3; else=-1"); await note("own");
choose("load", "exact"); choose("rule", "signed-dual"); choose("r", "2.5"); await note("other");
choose("load", "nodal"); choose("rule", "printed-dual"); await note("nodal");
"#;
    let Some(browser) = browser() else {
        skip("no chromium; nobody has read the command of tables.html");
        return;
    };
    let notes = notes(&browser, book(), "", LOADS_AND_RULES);
    assert_eq!(notes.len(), 5, "{notes:#?}");
    for note in &notes {
        let (quoted, command) = ("'", note["command"].as_str().unwrap());
        let [before, f, after] = command.split(quoted).collect::<Vec<_>>()[..] else {
            panic!("{note:#}")
        };
        let words = before.split_whitespace().chain([f]).chain(after.split_whitespace());
        let args: Vec<&str> = words.skip(1).chain(["--json"]).collect();
        let said = signorini(&args);
        let answer: Value = serde_json::from_slice(&said.stdout).expect(command);
        let counts: Vec<String> = answer["grids"]
            .as_array()
            .unwrap()
            .iter()
            .map(|grid| grid["iterations"].to_string())
            .collect();
        assert_eq!(note["counts"], counts.join(" "), "{note:#}");
    }
    // As it begins, the page solves as `solve --f` does when it is asked for the paper's method.
    let said = signorini(&[
        "solve",
        "--f",
        "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1",
        "--r",
        "10",
        "--json",
    ]);
    let answer: Value = serde_json::from_slice(&said.stdout).unwrap();
    let [load, stop] = ["load", "stop"].map(|name| answer["settings"][name].as_str().unwrap());
    assert_eq!([&notes[1]["controls"]["load"], &notes[1]["controls"]["rule"]], [load, stop]);
}

#[test]
fn the_address_follows_the_controls_and_reads_back() {
    const CHOOSE: &str = r#"
await note("opened");
choose("problem", "own");
choose("f", "disc(1/8, -0.1,0.25)=+2 ;; else=-3/2"); choose("r", "2.5");
choose("load", "exact"); choose("rule", "signed-dual"); choose("finest", "32"); choose("truth", false);
await settle(); await note("chosen");
choose("f", "100% & more = ?#"); await note("nonsense");
document.querySelector('[data-r="5"]').click(); choose("problem", "1"); choose("truth", true);
await settle(); await note("problem 1");
"#;
    let Some(browser) = browser() else {
        skip("no chromium; nobody has read the address of tables.html");
        return;
    };
    let notes_of = |query: &str, script: &str| notes(&browser, book(), query, script);
    let chosen = notes_of("?search=f", CHOOSE);
    assert_eq!(chosen[0]["address"], "?search=f", "only controls change the address");
    for note in &chosen[1..] {
        let address = note["address"].as_str().unwrap();
        assert!(
            address.starts_with("?search=f&"),
            "what others say in the address stays: {address}"
        );
        let back = notes_of(address, r#"await settle(); await note("back");"#).remove(0);
        for what in ["status", "command", "marked", "address"] {
            assert_eq!(back[what], note[what], "{what}: {back:#}");
        }
        let (mut ours, mut theirs) = (note["controls"].clone(), back["controls"].clone());
        if ours["problem"] != "own" {
            // An f that is not shown is not in the address.
            (ours["f"], theirs["f"]) = (Value::Null, Value::Null);
        }
        assert_eq!(ours, theirs);
    }

    // Links of the book, an f alone, and what no control offers.
    let open = |query: &str| notes_of(query, r#"await note("opened");"#).remove(0);
    let [plain, linked, own, wrong] = [
        "",
        "?problem=1&r=0.5&truth=0",
        "?f=else=-2",
        "?problem=9&load=none&rule=&finest=5&truth=2&r=x",
    ]
    .map(open);
    let controls = |note: &Value| {
        ["problem", "r", "load", "rule", "finest", "truth"]
            .map(|name| note["controls"][name].as_str().unwrap().to_owned())
    };
    assert_eq!(controls(&plain), ["2", "10", "nodal", "signed", "64", "true"]);
    assert_eq!(controls(&linked), ["1", "0.5", "nodal", "signed", "64", "false"]);
    assert_eq!(controls(&own), ["own", "10", "bilinear", "printed", "64", "true"]);
    assert_eq!(own["controls"]["f"], "else=-2");
    assert_eq!(controls(&wrong), ["2", "", "nodal", "signed", "64", "true"]);
    assert_eq!(wrong["marked"], json!(["", "true"]));
    let unknown =
        "The address asks for problem=9, load=none, rule=, finest=5, which this page does not have";
    assert!(wrong["unknown"].as_str().unwrap().starts_with(unknown), "{wrong:#}");
    assert!([plain, linked, own].iter().all(|note| note["unknown"] == ""));
}
