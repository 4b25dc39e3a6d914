//! The command line: what it prints where, in which format, and with which exit code.

use crate::common::{PAPER, Project, Said, TABLE, commands, number};
use crate::reference::REFERENCES;
use expect_test::expect_file;
use serde_json::Value;
use std::fs;
use std::process::Stdio;

const BUMP: &str = "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1";

#[test]
fn help_is_as_reviewed() {
    let project = Project::with(TABLE);
    let mut text = String::new();
    let help = project.run(&["--help"]).out;
    for command in [None].into_iter().chain(commands(&help).into_iter().map(Some)) {
        let args: Vec<&str> = command.into_iter().chain(["--help"]).collect();
        let said = project.run(&args);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
        text += &format!("$ signorini {}\n{}\n", args.join(" "), said.out);
    }
    assert!(text.lines().all(|line| line.chars().count() <= 112), "fits a terminal");
    expect_file!["snapshots/help.txt"].assert_eq(&text);
}

/// Without the option of `build.rs`, the loader patches 290 000 addresses at every start.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn the_program_is_linked_for_one_place_in_memory() {
    let header = fs::read(env!("CARGO_BIN_EXE_signorini")).unwrap();
    // The type of an ELF file: 2 is a program for one place, 3 one for any place.
    assert_eq!(u16::from_ne_bytes([header[16], header[17]]), 2);
}

#[test]
fn accuracy_chooses_the_grid_and_an_answer_without_a_bound_says_why() {
    let project = Project::with(TABLE);
    let (f, energy) = (REFERENCES[0].f, REFERENCES[0].energy);
    let solve =
        |more: &[&str]| project.run(&[&["solve", "--f", f, "--json"], more].concat()).json();
    let json = solve(&["--accuracy", "0.004"]);
    // The energy is minus half the square of the energy norm.
    let norm = (-2.0 * energy).sqrt();
    let [least, most] = [0, 1].map(|k| json["bound"]["error"][k].as_f64().unwrap() / norm);
    assert!(0.0025 < least && most < 0.004, "reached, with a grid hardly too fine: {json}");
    let fixed = solve(&["--solver", "multigrid", "--load", "exact", "--h", "1/512"]);
    assert!(
        number(&json["h"]) >= number(&fixed["h"]) && number(&fixed["bound"]["error"][1]) < 0.004
    );
    let json = solve(&["--accuracy-energy", "1e-7", "--solver", "multigrid"]);
    let [low, high] = [0, 1].map(|k| json["bound"]["energy"][k].as_f64().unwrap());
    assert!(low <= energy && energy <= high, "{json}");
    let reached = (high - low) / -high;
    assert!((0.3e-7..1e-7).contains(&reached), "with a grid hardly too fine: {json}");
    // Read back, the ends of the bracket may be off by a bit.
    let stated = json["bound"]["relative"]["energy"].as_f64().unwrap();
    assert!((stated / reached - 1.0).abs() < 1e-8, "{json}");
    // The next grid has no lines along the borders of f, and a wider bracket, which is no sign of rounding errors.
    let aligned = ["--f", "rect(-0.2,0.3,-0.25,0.22)=4; else=-1.5", "--accuracy-energy", "1e-6"];
    let json = project.run(&[&["solve", "--json"], &aligned[..]].concat()).json();
    assert!(number(&json["bound"]["relative"]["energy"]) <= 1e-6, "{json}");
    assert_eq!(json["settings"]["accuracy-energy"], 1e-6);
    // On coarse grids the error may be larger than the solution, which is no sign of rounding errors either.
    let thin = ["--f", "rect(-0.5,0.5,-0.5,-0.499)=-3; else=0", "--accuracy-energy", "1e-2"];
    let json = project.run(&[&["solve", "--json"], &thin[..]].concat()).json();
    assert!(number(&json["bound"]["relative"]["energy"]) <= 1e-2, "{json}");
    // Single nodes where contact ends keep large residuals, which a guaranteed bound makes no matter.
    let f = "disc(0.125,0.2914,0.3053)=4; halfplane(-0.3227,-0.112,0.125)=0; quadrant(lr)=-4.09; \
        rect(0.2757,1,0,0.3331)=4; else=-1.226";
    let json = project.run(&["solve", "--f", f, "--accuracy", "0.002", "--json"]).json();
    assert!(number(&json["kkt"]["relative"]) > 0.1, "{json}");
    assert_eq!(json["warnings"], serde_json::json!([]));
    let cube = project
        .run(&["solve", "--domain", "cube", "--f", "else=-1", "--h", "1/8", "--json"])
        .json();
    let [low, high] = [0, 1].map(|k| cube["bound"]["energy"][k].as_f64().unwrap());
    // Fourier series of the solution, which is zero on the surface.
    assert!(low < -0.010_084_25 && high > -0.010_084_24 && high < 0.9 * -0.010_084, "{cube}");
    assert!(cube["contact"].is_null(), "{cube}");
}

/// Numbers as NPY and VTI files have them.
fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect()
}

#[test]
fn the_true_solution_is_written_at_the_nodes_that_h_asks_for() {
    let project = Project::with(TABLE);
    let written = |solver: &str| {
        let args = ["solve", "--f", BUMP, "--h", "1/32", "--solver", solver, "--out", "v.npy"];
        assert_eq!(project.run(&args).code, Some(0));
        let bytes = fs::read(project.path("v.npy")).unwrap();
        doubles(&bytes[bytes.len() - 8 * 33 * 33..])
    };
    let (truth, ours) = (written("spectral"), written("multigrid"));
    let greatest = truth.iter().copied().fold(0.0, f64::max);
    let error = truth.iter().zip(&ours).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(0.0 < error && error < 0.02 * greatest, "{error} of {greatest}");
}

#[test]
fn the_true_solution_is_what_multigrid_brackets_and_comes_near() {
    let project = Project::with(TABLE);
    let f = "rect(-0.5,0,-0.5,0.25)=3; else=-2.5";
    let solve =
        |more: &[&str]| project.run(&[&["solve", "--f", f, "--json"], more].concat()).json();
    let truth = solve(&["--solver", "spectral"]);
    let ours = solve(&["--solver", "multigrid", "--h", "1/128"]);
    let number = |json: &Value| json.as_f64().unwrap_or_else(|| panic!("{truth} {ours}"));
    let [low, high] = [0, 1].map(|k| number(&ours["bound"]["energy"][k]));
    assert!((low..=high).contains(&number(&truth["energy"])), "{truth} {ours}");
    for field in ["scene", "f", "dimension", "integral_f"] {
        assert_eq!(truth[field], ours[field]);
    }
    let [arcs, ours] = [&truth, &ours].map(|json| json["contact"].as_array().unwrap().as_slice());
    let ([arc], [near]) = (arcs, ours) else { panic!("{arcs:?} {ours:?}") };
    assert!((number(&arc["force"]) - number(&near["force"])).abs() < 1e-9);
    for (end, k) in [("from", 0), ("from", 1), ("to", 0), ("to", 1)] {
        let off = number(&arc[end][k]) - number(&near[end][k]);
        assert!(off.abs() < 0.25 / 128.0, "{end} {k}: {off:e}");
    }
    let [low, high] = [0, 1].map(|k| number(&truth["bound"]["energy"][k]));
    assert!(low <= high && high - low < 1e-9 * high.abs(), "{truth}");
    for check in ["residual", "balance"] {
        assert!(number(&truth["checks"][check]).abs() < 1e-9, "{truth}");
    }
    let small = ["solve", "--f", "else=-1e-30", "--solver", "spectral"];
    let said = project.run(&small);
    let energy = said.lines()[1].strip_prefix("energy ").unwrap().parse::<f64>().unwrap();
    assert!((energy / 1e-60 + 0.017572128).abs() < 1e-8, "{said:?}");
    let torsion = project.run(&["solve", "--f", "exact(torsion)", "--solver", "spectral"]);
    let bracket =
        torsion.out.split("true energy in [").nth(1).and_then(|text| text.split(']').next());
    let [low, high] =
        [0, 1].map(|k| bracket.unwrap().split(", ").nth(k).unwrap().parse::<f64>().unwrap());
    assert!(low < -0.01757212686939 && -0.01757212686940 < high, "{torsion:?}");
    assert!(high - low < 1e-9 * 0.0175, "{torsion:?}");
    let jump = ["solve", "--f", "formula(abs(x) - 1)", "--solver", "spectral"];
    assert!(project.run(&jump).refusal().contains("--solver multigrid"));
}

#[test]
fn uzawa_solvers_agree_with_arrow_hurwicz_and_count_their_sweeps() {
    let project = Project::with(TABLE);
    let solved = |solver: &str| {
        let args = ["solve", "--f", BUMP, "--h", "1/32", "--load", "nodal", "--solver", solver];
        let text = project.run(&args).out;
        assert_eq!(text.contains("sweeps"), solver != "arrow-hurwicz", "{text}");
        let json = project.run(&[&args[..], &["--json"]].concat()).json();
        assert_eq!((&json["solver"], &json["stop"]), (&solver.into(), &"converged".into()));
        // The gradient sees h r of what is left of y in contact, here 10 / 32.
        assert!(json["kkt"]["natural"].as_f64().unwrap() <= 4e-4, "{json}");
        let number = |name: &str| json[name].as_u64().unwrap();
        assert_eq!(json["sweeps_per_grid"].as_array().unwrap().len(), 4);
        (number("iterations"), number("sweeps"), json["energy"].as_f64().unwrap())
    };
    let (iterations, sweeps, want) = solved("arrow-hurwicz");
    assert_eq!(iterations, sweeps);
    for solver in ["uzawa", "uzawa-proximal"] {
        let (iterations, sweeps, energy) = solved(solver);
        assert!(0 < iterations && iterations < sweeps, "{iterations} of {sweeps}");
        assert!((energy - want).abs() < 1e-2 * want.abs(), "{energy} {want}");
    }
}

#[test]
fn printed_rule_leaves_a_residual_of_its_tolerance() {
    let project = Project::with(TABLE);
    // Grids 1/4, 1/8, 1/16, ...: the tolerance on the k-th is 10^-k.
    for (h, tolerance) in [("1/16", 1e-3), ("1/32", 1e-4), ("1/64", 1e-5)] {
        let json =
            project.run(&["solve", "--f", BUMP, "--h", h, "--stop", "printed", "--json"]).json();
        assert_eq!((&json["stop"], &json["scene"]), (&"converged".into(), &"square".into()));
        let natural = json["kkt"]["natural"].as_f64().unwrap();
        assert!(natural > 0.0 && natural <= tolerance, "{h}: {natural}");
    }
}

#[test]
fn solutions_are_written_for_numpy_and_paraview() {
    let project = Project::with(TABLE);
    for name in ["v.npy", "v.vti"] {
        let said = project.run(&["solve", "a", "--solver", "multigrid", "--out", name]);
        assert!(said.lines().contains(&format!("wrote {name}").as_str()), "{said:?}");
    }
    let npy = fs::read(project.path("v.npy")).unwrap();
    assert_eq!(&npy[..8], b"\x93NUMPY\x01\x00");
    let data = 10 + usize::from(u16::from_le_bytes([npy[8], npy[9]]));
    let header = std::str::from_utf8(&npy[10..data]).unwrap().trim_end();
    assert_eq!(header, "{'descr': '<f8', 'fortran_order': False, 'shape': (9, 9), }");
    let from_npy = doubles(&npy[data..]);
    assert_eq!((from_npy.len(), npy.len() - data, data % 64), (81, 81 * 8, 0));
    assert!(
        from_npy[40] < -0.01 && from_npy.iter().all(|v| v.is_finite()),
        "deepest in the middle"
    );

    let vti = fs::read(project.path("v.vti")).unwrap();
    let raw = 1 + vti.windows(2).position(|two| two == b"\n_").unwrap();
    let head = std::str::from_utf8(&vti[..raw]).unwrap();
    assert!(
        head.contains("WholeExtent=\"0 8 0 8 0 0\"") && head.contains("Spacing=\"0.125 0.125 1\""),
        "{head}"
    );
    let size = u64::from_le_bytes(vti[raw + 1..raw + 9].try_into().unwrap()) as usize;
    assert_eq!(doubles(&vti[raw + 9..raw + 9 + size]), from_npy);
    // v, the multiplier at all nodes, f in the cells.
    let blocks = [81, 81, 64].map(|doubles: usize| 8 + 8 * doubles);
    assert_eq!(&vti[raw + 1 + blocks.iter().sum::<usize>()..], b"\n</AppendedData>\n</VTKFile>\n");
    for (array, offset) in [("v", 0), ("multiplier", blocks[0]), ("f", blocks[0] + blocks[1])] {
        let line = format!("Name=\"{array}\" format=\"appended\" offset=\"{offset}\"");
        assert!(head.contains(&line), "{head}");
    }
    let said = project.run(&["solve", "a", "--solver", "multigrid", "--out", "v.npz"]);
    assert!(said.lines().contains(&"wrote v.npz"), "{said:?}");
    let npz = fs::read(project.path("v.npz")).unwrap();
    assert!(npz.windows(npy.len()).any(|part| part == npy), "it contains v.npy as it is");

    // The name of a format alone.
    let said = project.run(&["solve", "a", "--solver", "multigrid", "--out", "vti"]);
    assert!(said.lines().contains(&"wrote a.vti"), "{said:?}");
    assert_eq!(fs::read(project.path("a.vti")).unwrap(), vti);
    let said = project.run(&["solve", "--f", "else=-1", "--out", "npy"]);
    assert!(said.lines().contains(&"wrote solution.npy"), "{said:?}");
}

#[test]
fn multigrid_stops_at_the_tolerance_asked_for() {
    let project = Project::with(TABLE);
    let problems =
        [["square", "disc(0,0,0.25)=2; else=-1", "1/32"], ["cube", "exact(free-disc)", "1/16"]];
    for [domain, f, h] in problems {
        let solve = |more: &[&str]| {
            let args = ["solve", "--json", "--domain", domain, "--f", f, "--h", h];
            project.run(&[&args[..], &["--solver", "multigrid"], more].concat()).json()
        };
        let (floor, early) = (solve(&[]), solve(&["--tolerance", "1e-4"]));
        let number = |value: &Value| value.as_f64().expect("a number");
        assert_eq!(
            (&floor["stop"], &early["stop"]),
            (&"rounding-floor".into(), &"converged".into())
        );
        let left = number(&early["kkt"]["relative"]);
        assert!(left <= 1e-4 && left > number(&floor["kkt"]["relative"]), "{early}");
        assert!(number(&early["work_units"]) < number(&floor["work_units"]), "{early}");
    }
}

#[test]
fn the_cube_is_solved_by_unlike_solvers() {
    let project = Project::with(TABLE);
    let cube = ["solve", "--domain", "cube", "--f"];
    let energy = |solver: &str| {
        let more = ["exact(free-disc)", "--h", "1/16", "--solver", solver];
        let args = [&cube[..], &more].concat();
        let text = project.run(&args);
        assert!(text.lines()[0].starts_with("cube: f = exact(free-disc), integral -"), "{text:?}");
        let json = project.run(&[&args[..], &["--json"]].concat()).json();
        assert_eq!((&json["schema"], &json["dimension"]), (&1.into(), &3.into()));
        assert_eq!(json["solver"], solver);
        assert_eq!(json["unknowns"], 17 * 17 * 17);
        assert_eq!(json["work_units"].is_number(), solver == "multigrid");
        let number = |value: &Value| value.as_f64().expect("a number");
        assert!(number(&json["kkt"]["relative"]) < 1e-12, "{json}");
        assert!(number(&json["kkt"]["min_y"]) == 0.0 && number(&json["integral_f"]) < 0.0);
        assert!(number(&json["seconds"]["solve"]) >= 0.0);
        number(&json["energy"])
    };
    let [ours, direct] = ["multigrid", "active-set"].map(energy);
    assert!((ours - direct).abs() < 1e-12 * ours.abs(), "{ours} {direct}");

    let f = "ball(0,0,0,0.25)=2; else=-1";
    for name in ["v.npy", "v.vtu"] {
        let said = project.run(&[&cube[..], &[f, "--h", "1/8", "--out", name]].concat());
        assert!(said.lines().contains(&format!("wrote {name}").as_str()), "{said:?}");
        assert!(fs::read(project.path(name)).unwrap().len() > 729 * 8);
    }
}

#[test]
fn a_closed_pipe_is_no_panic() {
    // Tolerances that the comparison keeps, so that `diff` has nothing to complain about.
    let allowed = PAPER.replace("count_slack = 1000", "count_slack = 100000");
    let project = Project::with(&(TABLE.to_owned() + "paper_table = 1\n"));
    project.write("pipeline/paper.toml", allowed);
    project.run(&["run"]).lines();
    for args in [
        &["dag"][..],
        &["status", "--json"],
        &["run"],
        &["run", "-n"],
        &["status"],
        &["explain", "solve"],
        &["diff", "--json"],
        &["gc"],
        &["solve", "a", "--solver", "multigrid"],
        &["completions", "zsh"],
        &["man"],
        &["--help"],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = project.command(args).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        assert_eq!((output.status.code(), &output.stderr[..]), (Some(0), &b""[..]), "{args:?}");
    }
    // Nor is a standard error that nobody reads.
    for (args, code) in
        [(&["run", "--force", "-v"][..], 0), (&["run", "nobody"], 2), (&["frobnicate"], 2)]
    {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let status = project.command(args).stdout(Stdio::null()).stderr(writer).status().unwrap();
        assert_eq!(status.code(), Some(code), "{args:?}");
    }
}

#[test]
fn a_full_standard_output_is_an_error() {
    let project = Project::with(TABLE);
    for args in [
        &["dag"][..],
        &["--help"],
        &["-h"],
        &["--version"],
        &["help"],
        &["help", "run"],
        &["solve", "--help"],
        &["completions", "zsh"],
        &["man"],
        &["status", "--json"],
        &["gc", "-n"],
        &["solve", "a", "--solver", "multigrid"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = project.command(args).stdout(full).stderr(Stdio::piped()).output().unwrap();
        let said = Said::from(output);
        assert!(said.refusal().contains("cannot write to standard output"), "{args:?}: {said:?}");
    }
}

#[test]
fn manual_pages_exist_for_each_command() {
    let project = Project::with(TABLE);
    let page = project.run(&["man"]);
    assert_eq!((page.code, page.err.as_str()), (Some(0), ""));
    assert!(page.out.contains(".TH signorini 1") && page.out.contains("signorini\\-explain(1)"));
    assert!(
        project.run(&["man", "--output", "no"]).refusal().contains("make it with `mkdir -p no`")
    );
    fs::create_dir(project.path("man1")).unwrap();
    assert_eq!(project.run(&["man", "--output", "man1"]).lines(), [""; 0]);
    let pages = project.files("man1");
    assert_eq!(pages["signorini.1"], page.out.into_bytes());
    let help = project.run(&["--help"]).out;
    let mut count = 1;
    for name in commands(&help) {
        let page = String::from_utf8_lossy(&pages[&format!("signorini-{name}.1")]).into_owned();
        assert!(page.contains(&format!(".TH signorini-{name} 1  \"signorini ")), "{name}");
        count += 1;
    }
    assert_eq!(count, pages.len());
}
