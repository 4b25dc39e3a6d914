//! Answers that say what they are worth, on every domain, and sizes that cannot fit.

use crate::common::{Project, Said, TABLE, bracket, interrupt, number};
use crate::reference::REFERENCES;
use serde_json::{Value, json};
use std::io::Read;
use std::process::{Command, Stdio};
use std::time::Duration;

const CORNER: &str = "--f 'quadrant(ll)=3; else=-1.1'";

/// The JSON of an answer that is none: shown all the same, with exit code 3 and the reason in one line.
#[track_caller]
fn refused(said: &Said) -> Value {
    assert_eq!((said.code, said.err.lines().count()), (Some(3), 1), "{said:?}");
    said.json()
}

#[test]
fn converged_is_said_only_where_the_conditions_hold() {
    let project = Project::with(TABLE);
    let solve = |more: &str| project.line(&format!("solve {CORNER} --load nodal --json {more}"));
    // The load sums to +0.305: no minimiser.
    let json = refused(&solve("--solver arrow-hurwicz --h 1/6"));
    assert!(number(&json["sum_load"]) > 0.0 && json["stop"] != "converged", "{json}");
    let uzawa = "--solver uzawa --max-iterations 20000 --h";
    assert_ne!(refused(&solve(&format!("{uzawa} 1/16")))["stop"], "converged");
    // Coarse grids without a minimiser must not lead astray unnoticed: the energy is -0.1099.
    let json = solve(&format!("{uzawa} 1/32")).json();
    let is_near = (number(&json["energy"]) + 0.1099).abs() < 0.01;
    assert!(json["stop"] != "converged" || is_near, "{json}");
    assert!(json["warnings"][0].as_str().unwrap().contains("1/4, 1/8, 1/16"), "{json}");
    // Too few iterations: the answer is shown, and not called one.
    let json = refused(&solve("--h 1/64 --max-iterations 3"));
    assert_eq!(json["stop"], "iteration-limit");
    assert!(json["grids"].as_array().unwrap().iter().any(|grid| grid["stop"] != "converged"));
    // A problem with a solution, well solved.
    for how in ["--solver arrow-hurwicz", "--tolerance 1e-6"] {
        let said = project.line(&format!("solve --f else=-1 --h 1/64 --json {how}"));
        assert_eq!((said.code, &said.json()["stop"]), (Some(0), &"converged".into()));
    }
}

#[test]
fn complementarity_is_the_sum_of_v_r_and_contact_is_counted() {
    let project = Project::with(TABLE);
    // Contact everywhere, and v r is a rounding error there.
    let json = project.answer("--f else=-1 --h 1/32 --solver multigrid");
    assert_eq!(json["contact_nodes"], json!({ "nodes": 128, "boundary_nodes": 128 }));
    assert_eq!([&json["kkt"]["complementarity"], &json["kkt"]["max_min"]], [0.0; 2]);
    // In a corner without load both v and r are zero, and the nodes beside it are in contact.
    let json =
        project.answer("--f 'rect(-0.25,0.25,-0.25,0.25)=-4; else=0' --h 1/32 --solver multigrid");
    assert_eq!(json["contact_nodes"]["nodes"], json["contact_nodes"]["boundary_nodes"]);
    let arcs = json["contact"].as_array().unwrap();
    assert!(arcs.len() == 1 && arcs[0]["from"] == arcs[0]["to"], "{json}");
    // For a solution E = -<F, v> / 2 + <r, v> / 2, so that v r can be told from energies of scaled loads.
    let kkt = &project.answer(&format!("{CORNER} --load nodal --h 1/64 --stop printed"))["kkt"];
    let [sum, most] = ["complementarity", "max_min"].map(|name| number(&kkt[name]));
    assert!(sum.abs() > most, "a sum, not a maximum: {kkt}");
    let json = project.answer("--domain cube --f else=-1 --h 1/8");
    assert_eq!(json["contact_nodes"]["boundary_nodes"], 9 * 9 * 9 - 7 * 7 * 7);
}

#[test]
fn accuracy_chooses_the_grid_and_an_answer_without_a_bound_says_why() {
    let project = Project::with(TABLE);
    let (f, energy) = (REFERENCES[0].f, REFERENCES[0].energy);
    let solve = |more: &str| project.answer(&format!("--f '{f}' {more}"));
    let json = solve("--accuracy 0.004");
    // The energy is minus half the square of the energy norm.
    let norm = (-2.0 * energy).sqrt();
    let [least, most] = [0, 1].map(|k| number(&json["bound"]["error"][k]) / norm);
    assert!(0.0025 < least && most < 0.004, "reached, with a grid hardly too fine: {json}");
    let fixed = solve("--solver multigrid --load exact --h 1/512");
    assert!(number(&json["h"]) >= number(&fixed["h"]));
    assert!(number(&fixed["bound"]["error"][1]) < 0.004);
    let json = solve("--accuracy-energy 1e-7 --solver multigrid");
    let [low, high] = bracket(&json);
    assert!(low <= energy && energy <= high, "{json}");
    let reached = (high - low) / -high;
    assert!((0.3e-7..1e-7).contains(&reached), "with a grid hardly too fine: {json}");
    // Read back, the ends of the bracket may be off by a bit.
    let stated = number(&json["bound"]["relative"]["energy"]);
    assert!((stated / reached - 1.0).abs() < 1e-8, "{json}");
    // The next grid has no lines along the borders of f, and a wider bracket; on coarse grids the error may be larger
    // than the solution. Neither is a sign of rounding errors.
    for (f, accuracy) in [
        ("rect(-0.2,0.3,-0.25,0.22)=4; else=-1.5", 1e-6),
        ("rect(-0.5,0.5,-0.5,-0.499)=-3; else=0", 1e-2),
    ] {
        let json = project.answer(&format!("--f '{f}' --accuracy-energy {accuracy}"));
        assert!(number(&json["bound"]["relative"]["energy"]) <= accuracy, "{json}");
        assert_eq!(json["settings"]["accuracy_energy"], accuracy);
    }
    // Single nodes where contact ends keep large residuals, which a guaranteed bound makes no matter.
    let json = project.answer(
        "--f 'disc(0.125,0.2914,0.3053)=4; halfplane(-0.3227,-0.112,0.125)=0; quadrant(lr)=-4.09; \
         rect(0.2757,1,0,0.3331)=4; else=-1.226' --accuracy 0.002",
    );
    assert!(number(&json["kkt"]["relative"]) > 0.1, "{json}");
    assert_eq!(json["warnings"], json!([]));
    let cube = project.answer("--domain cube --f else=-1 --h 1/8");
    let [low, high] = bracket(&cube);
    // Fourier series of the solution, which is zero on the surface.
    assert!(low < -0.010_084_25 && high > -0.010_084_24 && high < 0.9 * -0.010_084, "{cube}");
    assert!(cube["contact"].is_null(), "{cube}");
}

/// v and the first two components of its gradient at the only point of an answer.
fn at_point(answer: &Value) -> [f64; 3] {
    let value = &answer["values"][0];
    [&value["v"], &value["gradient"][0], &value["gradient"][1]].map(number)
}

#[test]
fn grids_meshes_and_the_true_solution_agree_at_a_point() {
    let project = Project::with(TABLE);
    let [truth, fine, coarse] = ["--solver spectral", "--h 1/512", "--accuracy 2e-2"].map(|how| {
        let f = "--f 'disc(-0.25,0,0.2)=6; else=-1' --at 0.13,-0.21";
        at_point(&project.answer(&format!("{f} {how}")))
    });
    for (found, bounds) in [(fine, [1e-5, 1e-2, 1e-2]), (coarse, [1e-3, 0.1, 0.1])] {
        let is_near = (0..3).all(|d| (found[d] - truth[d]).abs() < bounds[d]);
        assert!(is_near, "{found:?} {truth:?}");
    }
    // Uniform and adapted meshes of one domain.
    let [uniform, adapted] = ["--refine 6", "--accuracy 1e-2"].map(|how| {
        let f = "--domain lshape --f 'rect(-9,0,-9,0)=3; else=-2' --at -0.3,-0.4";
        at_point(&project.answer(&format!("{f} {how}")))
    });
    assert!((uniform[0] - adapted[0]).abs() < 5e-3, "{uniform:?} {adapted:?}");
    let cube = project.answer("--domain cube --f else=-1 --h 1/8 --at 0,0,0");
    assert_eq!(cube["values"][0]["gradient"].as_array().unwrap().len(), 3);
    assert!(at_point(&cube)[0] < 0.0, "{cube}");
}

#[test]
fn where_f_varies_within_cells_no_least_error_is_claimed() {
    let project = Project::with(TABLE);
    for (domain, f, is_claimed) in [
        ("lshape", "else=-1", true),
        ("lshape", "formula(x-3)", false),
        ("lshape", "formula(-1-sin(40*x)*sin(40*y))", false),
        ("cube", "else=-1", true),
        ("cube", "exact(free-disc)", false),
        ("cube", "exact(full-contact)", false),
        ("ball", "formula(z-3)", false),
    ] {
        let fine = if domain == "cube" { "--h 1/8" } else { "--refine 2" };
        let json = project.answer(&format!("--domain {domain} --f '{f}' {fine}"));
        let [least, most] = [0, 1].map(|end| number(&json["bound"]["error"][end]));
        assert!(least < most && (least > 0.0) == is_claimed, "{domain} {f}: {json}");
        if let Some(h1) = json["errors"]["h1"].as_f64() {
            let l2 = number(&json["errors"]["l2"]);
            assert!(least <= h1 && h1 * h1 - l2 * l2 <= most * most, "{domain} {f}: {json}");
        }
    }
}

#[test]
fn the_length_in_contact_is_that_of_the_arcs_on_every_domain() {
    let project = Project::with(TABLE);
    for (f, fine, tolerance) in [
        ("--domain lshape --f 'rect(-1,0,-1,0)=3; else=-2'", "--refine 4", 0.05),
        ("--f 'halfplane(1,0,0)=8; else=-9'", "--h 1/128", 0.02),
    ] {
        let [truth, found] = ["--solver spectral", fine].map(|how| {
            number(&project.answer(&format!("{f} --friction 1 {how}"))["contact_length"])
        });
        assert!((truth - found).abs() < tolerance, "{f}: {truth} {found}");
        assert!(!f.contains("lshape") || (truth - 7.0803).abs() < 1e-3, "{truth}");
    }
}

/// The binary in a shell with so many kilobytes of memory.
fn limited(kilobytes: usize, project: &Project, line: &str) -> Said {
    let mut command = Command::new("bash");
    let script = format!("ulimit -v {kilobytes}; exec \"$0\" {line}");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_signorini")]);
    command.current_dir(project.path("")).stdin(Stdio::null());
    command.output().unwrap().into()
}

#[test]
fn sizes_that_cannot_fit_are_refused_with_what_would() {
    let project = Project::with(TABLE);
    let solve = |more: &str| limited(1_000_000, &project, &format!("solve --f else=-1 {more}"));
    let said = solve("--solver multigrid --h 1/8192");
    let fits = said.refusal().split("; 1/").nth(1).and_then(|rest| rest.strip_suffix(" would fit"));
    assert_eq!(solve(&format!("--h 1/{}", fits.unwrap())).code, Some(0), "{said:?}");
    // On a mesh.
    let said = solve("--domain disc --refine 11");
    assert!(said.refusal().contains("--refine 11 takes about 6040 MB of memory, where "));
    assert!(said.refusal().ends_with(" MB are left; --refine 9 would fit"), "{said:?}");
    let said = limited(700_000, &project, &format!("solve {CORNER} --accuracy 2e-4"));
    assert!(said.refusal().starts_with("error: --accuracy 0.0002: grid 1/7168 takes"), "{said:?}");
    // What is not foreseen ends in a line as well, not in an abort.
    let said = limited(140_000, &project, "bench --quick --finest 8192");
    assert!(matches!(said.code, Some(2 | 3)) && said.err.contains("error: "), "{said:?}");
}

#[test]
fn the_first_interrupt_answers_and_the_second_ends_at_once() {
    // One cell that would take weeks: from far away, in steps of almost nothing.
    let text = TABLE.replace("else=-1", "else=-1e9").replace("[4, 8]", "[64]");
    let text = text.replace("[10, 1]", "[1e-9]");
    let text = text.replace("\"signed\"", "\"printed\"");
    let project = Project::with(&(text + "max_iterations = 1000000000000\n"));
    // Where the signal comes before the cell has begun, the run ends at once: the next one gets it later.
    let mut delays = (0..16).map(|k| Duration::from_millis(1 << k));
    let ended = delays.find_map(|delay| interrupted_twice(&project, delay));
    assert_eq!(ended, Some(130));
}

/// Exit code of a run after two interrupts, the first so long after the run has named its tasks; none if the first was
/// not answered, since no task had begun.
fn interrupted_twice(project: &Project, delay: Duration) -> Option<i32> {
    let mut command = project.command(&["run", "-j", "1"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut reader = child.stderr.take().unwrap();
    wait_for("to run", &mut reader).unwrap();
    std::thread::sleep(delay);
    interrupt(&child);
    let answered = wait_for("again to stop at once", &mut reader);
    if answered.is_some() {
        interrupt(&child);
    }
    let code = child.wait().unwrap().code();
    answered.and(code)
}

/// Reads until these words have been said; none if they are not.
fn wait_for(words: &str, reader: &mut impl Read) -> Option<()> {
    let (mut said, mut byte) = (String::new(), [0]);
    while !said.contains(words) {
        if reader.read(&mut byte).unwrap() == 0 {
            return None;
        }
        said.push(char::from(byte[0]));
    }
    Some(())
}
