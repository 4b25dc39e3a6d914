//! What a person sees: colours, bars and columns, as far as the terminal can show them.

use crate::common::{Project, TABLE, TALK, skip};
use std::process::{Command, Stdio};

/// [`TABLE`], whose counts are compared with published ones.
fn published() -> Project {
    Project::with(&(TABLE.to_owned() + "paper_table = 1\n"))
}

#[test]
fn colour_is_for_those_who_see_it() {
    let project = Project::with(TABLE);
    project.run(&["run"]).lines();
    let escapes = |args: &[&str], env: &[(&str, &str)]| {
        let output = project.command(args).envs(env.iter().copied()).output().unwrap();
        output.stdout.contains(&0x1b) || output.stderr.contains(&0x1b)
    };
    for args in [&["status"][..], &["run", "nobody"], &["--help"]] {
        assert!(!escapes(args, &[]), "not a terminal: {args:?}");
        assert!(escapes(args, &[("CLICOLOR_FORCE", "1")]), "asked for: {args:?}");
        let both = [("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")];
        assert!(!escapes(args, &both), "NO_COLOR: {args:?}");
    }
    assert!(!escapes(&["run", "-f", "-v"], &[]), "no bar without a terminal");
}

/// What a command shows on a terminal of so many columns, with these variables; none where no terminal can be had.
fn shown(project: &Project, columns: usize, args: &str, env: &[(&str, &str)]) -> Option<String> {
    let line = format!("stty rows 24 cols {columns}; '{}' {args}", env!("CARGO_BIN_EXE_signorini"));
    let mut script = Command::new("script");
    script.args(["-qec", &line, "/dev/null"]);
    TALK.iter().for_each(|name| _ = script.env_remove(name));
    let script = script.envs(env.iter().copied()).current_dir(project.path("."));
    match script.stdin(Stdio::null()).output() {
        Ok(output) => Some(String::from_utf8_lossy(&output.stdout).replace("\r\n", "\n")),
        Err(e) => {
            skip(&format!("script(1) gives no terminal: {e}"));
            None
        }
    }
}

const DUMB: &[(&str, &str)] = &[("TERM", "dumb")];
const XTERM: &[(&str, &str)] = &[("TERM", "xterm")];
const PLAIN: &[(&str, &str)] = &[("TERM", "xterm"), ("NO_COLOR", "1")];

#[test]
fn lines_are_broken_between_words_and_tables_lack_columns_where_the_terminal_ends() {
    let project = published();
    let solve = "solve --f 'quadrant(ll)=-6; else=1.998' --load nodal --stop signed";
    // A table has its last columns left out, and no cell on a line of its own.
    for (args, columns, words) in [
        (solve, 60, &["warning: the load vector sums to ", "\nno room for: "][..]),
        ("run nobody-of-this-name", 40, &["error: no scene"]),
        ("diff", 30, &["\nno room for: ", "Delta a"]),
        ("diff", 80, &["Delta a"]),
        ("list", 40, &["Scenes"]),
    ] {
        let Some(shown) = shown(&project, columns, args, DUMB) else { return };
        assert!(shown.lines().all(|line| line.chars().count() <= columns), "{shown}");
        assert!(shown.lines().count() > 1, "{shown}");
        assert!(words.iter().all(|words| shown.contains(words)), "{shown}");
        let is_narrow = words.contains(&"\nno room for: ");
        assert_eq!(shown.contains("\nno room for: "), is_narrow, "{shown}");
    }
    // What is no terminal gets the line as it is.
    assert!(project.run(&["run", "nobody-of-this-name"]).refusal().len() > 40);
}

#[test]
fn marks_of_a_comparison_have_colours_on_a_terminal() {
    let project = published();
    let Some(coloured) = shown(&project, 80, "diff", XTERM) else { return };
    // Green, yellow and red, each on a mark alone.
    for mark in ["\x1b[32m=", "\x1b[33m~", "\x1b[31m!"] {
        let thin = coloured.replace("\x1b[1m", "");
        assert!(thin.contains(&format!("{mark}\x1b[0m")), "{mark:?}: {coloured:?}");
    }
    let plain = shown(&project, 80, "diff", PLAIN).unwrap();
    assert!(!plain.contains('\x1b') && plain.contains("1=   1"), "{plain}");
}

#[test]
fn terminals_get_what_they_can_show() {
    let project = Project::with(TABLE);
    let Some(bar) = shown(&project, 80, "run -f", XTERM) else { return };
    assert!(bar.contains("\x1b[") && !bar.contains(" to run"), "{bar}");
    // The number of tasks, the elapsed time, and the tasks that run.
    assert!(bar.contains("0/3  0s  ") && bar.contains("solve/a/signed/r=1"), "{bar}");
    // A dumb terminal cannot draw over a line, and nobody watches a log grow.
    for env in [DUMB, &[("TERM", "xterm"), ("CI", "1")]] {
        let plain = shown(&project, 80, "run -f", env).unwrap();
        assert!(plain.contains("3 tasks to run") && plain.contains("took "), "{env:?}: {plain}");
        assert!(!plain.contains('\x1b'), "{env:?}: {plain}");
    }
    for (env, is_coloured) in [(XTERM, true), (DUMB, false), (PLAIN, false)] {
        let status = shown(&project, 80, "status", env).unwrap();
        assert_eq!(status.contains('\x1b'), is_coloured, "{env:?}: {status}");
    }
}

#[test]
fn data_on_standard_output_fit_eighty_columns() {
    let project = Project::with(TABLE);
    let f = "solve --f 'disc(0,0,0.2)=3; else=-1'";
    for line in [
        "run",
        "run --force",
        "status",
        "explain solve",
        "list",
        "solve a",
        f,
        &format!("{f} --solver spectral"),
        &format!("{f} --accuracy 0.1"),
        "solve --domain cube --f 'ball(0,0,0,0.2)=3; else=-1' --h 1/8",
    ] {
        let said = project.line(line);
        assert!(said.code != Some(2) && !said.out.is_empty(), "{said:?}");
        assert!(said.out.lines().all(|line| line.chars().count() <= 80), "{said:?}");
    }
}
