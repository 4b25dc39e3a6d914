//! The command line: what it prints where, in which format, and with which exit code.

use crate::common::{PAPER, Project, TABLE, commands};
use expect_test::expect_file;
use std::fs;
use std::process::Stdio;

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

/// Numbers as NPY and VTI files have them.
fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect()
}

#[test]
fn solutions_are_written_for_numpy_and_paraview() {
    let project = Project::with(TABLE);
    let [npy, vti, npz] = ["v.npy", "v.vti", "v.npz"].map(|name| {
        let said = project.run(&["solve", "a", "--solver", "multigrid", "--out", name]);
        assert!(said.lines().contains(&&*format!("wrote {name}")), "{said:?}");
        fs::read(project.path(name)).unwrap()
    });
    assert_eq!(&npy[..8], b"\x93NUMPY\x01\x00");
    let data = 10 + usize::from(u16::from_le_bytes([npy[8], npy[9]]));
    let header = std::str::from_utf8(&npy[10..data]).unwrap().trim_end();
    assert_eq!(header, "{'descr': '<f8', 'fortran_order': False, 'shape': (9, 9), }");
    let v = doubles(&npy[data..]);
    assert_eq!((v.len(), npy.len() - data, data % 64), (81, 81 * 8, 0));
    assert!(v[40] < -0.01 && v.iter().all(|v| v.is_finite()), "deepest in the middle");
    assert!(npz.windows(npy.len()).any(|part| part == npy), "it contains v.npy as it is");

    let raw = 1 + vti.windows(2).position(|two| two == b"\n_").unwrap();
    let head = std::str::from_utf8(&vti[..raw]).unwrap();
    let size = u64::from_le_bytes(vti[raw + 1..raw + 9].try_into().unwrap()) as usize;
    assert_eq!(doubles(&vti[raw + 9..raw + 9 + size]), v);
    // v, the multiplier at all nodes, f in the cells.
    let blocks = [81, 81, 64].map(|doubles: usize| 8 + 8 * doubles);
    assert_eq!(&vti[raw + 1 + blocks.iter().sum::<usize>()..], b"\n</AppendedData>\n</VTKFile>\n");
    for (array, offset) in [("v", 0), ("multiplier", blocks[0]), ("f", blocks[0] + blocks[1])] {
        let line = format!("Name=\"{array}\" format=\"appended\" offset=\"{offset}\"");
        assert!(head.contains(&line), "{head}");
    }
    for line in ["WholeExtent=\"0 8 0 8 0 0\"", "Spacing=\"0.125 0.125 1\""] {
        assert!(head.contains(line), "{head}");
    }
}

#[test]
fn a_closed_pipe_is_no_panic() {
    // Tolerances that the comparison keeps, so that `diff` has nothing to complain about.
    let allowed = PAPER.replace("count_slack = 1000", "count_slack = 100000");
    let project = Project::with(&(TABLE.to_owned() + "paper_table = 1\n"));
    project.write("pipeline/paper.toml", allowed);
    project.run(&["run"]).lines();
    for line in [
        "dag",
        "status --json",
        "run",
        "run -n",
        "status",
        "explain solve",
        "diff --json",
        "gc",
        "solve a --solver multigrid",
        "completions zsh",
        "man",
        "--help",
    ] {
        let args: Vec<_> = line.split(' ').collect();
        let (_, writer) = std::io::pipe().unwrap();
        let output = project.command(&args).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        assert_eq!((output.status.code(), &output.stderr[..]), (Some(0), &b""[..]), "{line}");
    }
    // Nor is a standard error that nobody reads.
    for (args, code) in
        [(&["run", "--force", "-v"][..], 0), (&["run", "nobody"], 2), (&["frobnicate"], 2)]
    {
        let (_, writer) = std::io::pipe().unwrap();
        let status = project.command(args).stdout(Stdio::null()).stderr(writer).status().unwrap();
        assert_eq!(status.code(), Some(code), "{args:?}");
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
