//! Answers that say what they are worth, and inputs that are refused before any work is done.

use crate::common::{Project, Said, TABLE, interrupt, number};
use serde_json::Value;
use std::fs;
use std::io::Read;
use std::process::{Command, Stdio};
use std::time::Duration;

const CORNER: &str = "quadrant(ll)=3; else=-1.1";

/// The JSON of an answer that is none: shown all the same, with exit code 3 and the reason in one line.
#[track_caller]
fn refused(said: &Said) -> Value {
    assert_eq!((said.code, said.err.lines().count()), (Some(3), 1), "{said:?}");
    said.json()
}

#[test]
fn converged_is_said_only_where_the_conditions_hold() {
    let project = Project::with(TABLE);
    let solve = |more: &[&str]| {
        project.run(&[&["solve", "--f", CORNER, "--load", "nodal", "--json"], more].concat())
    };
    let paper = ["--solver", "arrow-hurwicz"];
    // The load sums to +0.305: no minimiser.
    let json = refused(&solve(&[&paper[..], &["--h", "1/6"]].concat()));
    assert!(json["sum_load"].as_f64().unwrap() > 0.0);
    assert_ne!(json["stop"], "converged");
    let uzawa = ["--solver", "uzawa", "--max-iterations", "20000"];
    let json = refused(&solve(&[&uzawa[..], &["--h", "1/16"]].concat()));
    assert_ne!(json["stop"], "converged");
    // Coarse grids without a minimiser must not lead astray unnoticed: the energy is -0.1099.
    let json = solve(&[&uzawa[..], &["--h", "1/32"]].concat()).json();
    let energy = json["energy"].as_f64().unwrap();
    assert!(json["stop"] != "converged" || (energy + 0.1099).abs() < 0.01, "{json}");
    assert!(json["warnings"][0].as_str().unwrap().contains("1/4, 1/8, 1/16"), "{json}");
    // Too few iterations: the answer is shown, and not called one.
    let json = refused(&solve(&["--h", "1/64", "--max-iterations", "3"]));
    assert_eq!(json["stop"], "iteration-limit");
    assert!(json["grids"].as_array().unwrap().iter().any(|grid| grid["stop"] != "converged"));
    // A problem with a solution, well solved.
    for how in [&paper[..], &["--tolerance", "1e-6"]] {
        let args = ["solve", "--f", "else=-1", "--h", "1/64", "--json"];
        let said = project.run(&[&args[..], how].concat());
        assert_eq!((said.code, &said.json()["stop"]), (Some(0), &"converged".into()));
    }
}

#[test]
fn complementarity_is_the_sum_of_v_r_and_contact_is_counted() {
    let project = Project::with(TABLE);
    // Contact everywhere, and v r is a rounding error there.
    let args = ["solve", "--f", "else=-1", "--h", "1/32", "--solver", "multigrid", "--json"];
    let json = project.run(&args).json();
    assert_eq!(json["contact_nodes"]["nodes"], json["contact_nodes"]["boundary_nodes"]);
    assert_eq!(
        (&json["contact_nodes"]["nodes"], &json["kkt"]["complementarity"]),
        (&128.into(), &0.0.into())
    );
    assert_eq!(json["kkt"]["max_min"], 0.0);
    // In a corner without load both v and r are zero, and the nodes beside it are in contact.
    let f = "rect(-0.25,0.25,-0.25,0.25)=-4; else=0";
    let json = project.run(&[&["solve", "--f", f], &args[3..]].concat()).json();
    assert_eq!(json["contact_nodes"]["nodes"], json["contact_nodes"]["boundary_nodes"]);
    let arcs = json["contact"].as_array().unwrap();
    assert!(arcs.len() == 1 && arcs[0]["from"] == arcs[0]["to"], "{json}");
    // For a solution E = -<F, v> / 2 + <r, v> / 2, so that v r can be told from energies of scaled loads.
    let args = ["solve", "--f", CORNER, "--load", "nodal", "--h", "1/64", "--stop", "printed"];
    let json = project.run(&[&args[..], &["--json"]].concat()).json();
    let number = |name: &str| json["kkt"][name].as_f64().unwrap();
    assert!(number("complementarity").abs() > number("max_min"), "a sum, not a maximum: {json}");
    let cube = ["solve", "--domain", "cube", "--f", "else=-1", "--h", "1/8", "--json"];
    let json = project.run(&cube).json();
    assert_eq!(json["contact_nodes"]["boundary_nodes"], 9 * 9 * 9 - 7 * 7 * 7);
}

#[test]
fn loads_are_integrals_unless_told_otherwise_and_one_that_misses_the_jumps_is_announced() {
    let project = Project::with(TABLE);
    let disc = ["solve", "--f", "disc(0.1,0,0.23)=2; else=-1", "--h", "1/32"];
    let ball = ["solve", "--domain", "cube", "--f", "ball(0,0.1,0,0.3)=2; else=-1", "--h", "1/32"];
    let number = |json: &Value, name: &str| json[name].as_f64().unwrap();
    // On the cube both are sums over 196 608 tetrahedra.
    for (args, rounding) in [(&disc[..], 1e-13), (&ball, 1e-11)] {
        let json = project.run(&[args, &["--json"]].concat()).json();
        let [sum, integral] = ["sum_load", "integral_f"].map(|name| number(&json, name));
        assert!((sum - integral).abs() < rounding, "{json}");
        assert_eq!(json["warnings"], Value::Array(Vec::new()));
    }
    let json = project.run(&[&disc[..], &["--json"]].concat()).json();
    assert_eq!(json["settings"]["load"], "bilinear");
    // The nodal rule misses the circle, and half of a jump along a line of the grid.
    let missed = "values at the nodes miss where f jumps";
    project.scene("jump", &TABLE.replace("else=-1", "quadrant(ll)=2; else=-1"));
    for args in [&[&disc[..], &["--load", "nodal"]].concat()[..], &["solve", "jump"]] {
        let json = project.run(&[args, &["--json"]].concat()).json();
        assert_eq!(json["settings"]["load"], "nodal");
        let off = number(&json, "sum_load") - number(&json, "integral_f");
        assert!(off.abs() > number(&json, "h").powi(2), "{json}");
        let warnings = json["warnings"].as_array().unwrap();
        assert!(warnings.iter().any(|text| text.as_str().unwrap().contains(missed)), "{json}");
        let text = project.run(args).out;
        assert_eq!(text.lines().filter(|line| line.contains(missed)).count(), 1, "{text}");
    }
    // Without a jump there is nothing to miss.
    let said = project.run(&["solve", "--f", "else=-1", "--load", "nodal", "--json"]);
    assert_eq!(said.json()["warnings"], Value::Array(Vec::new()));
}

#[test]
fn energies_of_large_f_are_right() {
    let project = Project::with(TABLE);
    for solver in ["multigrid", "active-set", "spectral"] {
        let [large, one] = ["else=-1e129", "else=-1"].map(|f| {
            number(
                &project.run(&["solve", "--f", f, "--solver", solver, "--json"]).json()["energy"],
            )
        });
        assert!((large / 1e258 - one).abs() < 1e-12 * one.abs(), "{solver}: {large} {one}");
    }
}

/// The binary in a shell with limits.
fn limited(limits: &str, project: &Project, args: &[&str]) -> Said {
    let mut command = Command::new("bash");
    let script = format!("trap '' XFSZ; {limits}; exec \"$0\" \"$@\"");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_signorini")]).args(args);
    command.current_dir(project.path("")).stdin(Stdio::null());
    command.output().unwrap().into()
}

#[test]
fn sizes_that_cannot_fit_are_refused_with_what_would() {
    let project = Project::with(TABLE);
    let solve = |n: &str| {
        let args = ["solve", "--f", "else=-1", "--h", n, "--solver", "multigrid"];
        limited("ulimit -v 1000000", &project, &args)
    };
    let said = solve("1/8192");
    let line = said.refusal();
    let fits = line.split("; 1/").nth(1).and_then(|rest| rest.strip_suffix(" would fit"));
    assert_eq!(solve(&format!("1/{}", fits.unwrap())).code, Some(0), "{line}");
    // Writing takes memory too.
    let recovered =
        ["solve", "--f", "else=-1", "--h", "1/2048", "--solver", "multigrid", "--recover"];
    for (args, code) in [(&recovered[..7], 0), (&[&recovered[..], &["--out", "v.vti"]].concat(), 2)]
    {
        let said = limited("ulimit -v 1000000", &project, args);
        assert_eq!(said.code, Some(code), "{said:?}");
    }
    let accurate = ["solve", "--f", "quadrant(ll)=3; else=-1.1", "--accuracy", "2e-4"];
    // On a mesh.
    let mesh = ["solve", "--domain", "disc", "--f", "else=-1", "--refine", "11"];
    let said = limited("ulimit -v 1000000", &project, &mesh);
    assert!(
        said.refusal().contains("--refine 11 takes about 6040 MB of memory, where "),
        "{said:?}"
    );
    assert!(said.refusal().ends_with(" MB are left; --refine 9 would fit"), "{said:?}");
    let said = limited("ulimit -v 700000", &project, &accurate);
    assert!(said.refusal().starts_with("error: --accuracy 0.0002: grid 1/7168 takes"), "{said:?}");
    // What is not foreseen ends in a line as well, not in an abort.
    let said = limited("ulimit -v 140000", &project, &["bench", "--quick", "--finest", "8192"]);
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

#[test]
fn a_certificate_is_written_to_a_new_or_an_empty_folder_as_a_whole() {
    let project = Project::with(&(TABLE.to_owned() + "paper_table = 1\n"));
    project.run(&["run"]).lines();
    let certify = |folder: &str| project.run(&["certificate", "--output", folder]);
    fs::create_dir(project.path("review")).unwrap();
    project.write("review/notes.txt", "mine");
    project.write("file", "mine");
    for taken in ["review", "file"] {
        let said = certify(taken);
        let remedy = "is there already; move it away, or name a new folder with --output";
        assert!(said.refusal().ends_with(&format!("{taken} {remedy}")), "{said:?}");
    }
    assert_eq!(project.files("review").len(), 1, "nothing is written beside it");
    fs::remove_file(project.path("review/notes.txt")).unwrap();
    certify("review").lines();
    let page = fs::read_to_string(project.path("review/certificate.md")).unwrap();
    assert!(page.contains("| program built from | `"), "{page}");
    certify("new").lines();
    assert!(certify("new").refusal().contains("new is there already"));
    #[cfg(unix)]
    {
        fs::create_dir(project.path("empty")).unwrap();
        std::os::unix::fs::symlink("empty", project.path("link")).unwrap();
        certify("link/").lines();
        assert!(project.path("empty/certificate.md").exists());
    }
    let left = fs::read_dir(project.path(".")).unwrap().flatten();
    let names = left.map(|entry| entry.file_name().to_string_lossy().into_owned());
    assert_eq!(names.filter(|name| name.ends_with(".tmp")).count(), 0);
}
