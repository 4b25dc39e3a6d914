//! What a person sees: colours, bars and columns, as far as the terminal can show them.

use crate::common::{Project, TABLE, TALK, skip};
use std::process::{Command, Stdio};

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
        assert!(
            !escapes(args, &[("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")]),
            "NO_COLOR: {args:?}"
        );
    }
    assert!(!escapes(&["run", "-f", "-v"], &[]), "no bar without a terminal");
}

/// What a command shows on a terminal, with these variables; `None` where no terminal can be had.
fn on_a_terminal(project: &Project, args: &str, env: &[(&str, &str)]) -> Option<String> {
    shown_by(project, &format!("'{}' {args}", env!("CARGO_BIN_EXE_signorini")), env)
}

/// What a line for a shell shows on a terminal.
fn shown_by(project: &Project, line: &str, env: &[(&str, &str)]) -> Option<String> {
    let mut script = Command::new("script");
    script.args(["-qec", line, "/dev/null"]);
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

#[test]
fn lines_are_broken_between_words_where_the_terminal_ends() {
    let project = Project::with(TABLE);
    let solve = "solve --f 'quadrant(ll)=-6; else=1.998' --load nodal --stop signed";
    let line = format!("stty rows 24 cols 60; '{}' {solve}", env!("CARGO_BIN_EXE_signorini"));
    let Some(shown) = shown_by(&project, &line, &[("TERM", "dumb")]) else { return };
    assert!(shown.lines().all(|line| line.chars().count() <= 60), "{shown}");
    assert!(shown.contains("warning: the load vector sums to "), "{shown}");
    // A table has its last columns left out, and no cell on a line of its own.
    assert!(shown.contains("\nno room for: "), "{shown}");
    let line = format!(
        "stty rows 24 cols 40; '{}' run nobody-of-this-name",
        env!("CARGO_BIN_EXE_signorini")
    );
    let shown = shown_by(&project, &line, &[("TERM", "dumb")]).unwrap();
    assert!(shown.lines().count() > 1, "{shown}");
    assert!(shown.lines().all(|line| line.chars().count() <= 40), "{shown}");
    // What is no terminal gets the line as it is.
    assert!(project.run(&["run", "nobody-of-this-name"]).refusal().len() > 40);
}

#[test]
fn tables_of_narrow_terminals_lack_columns_and_no_cell_is_broken() {
    let project = Project::with(&(TABLE.to_owned() + "paper_table = 1\n"));
    let program = env!("CARGO_BIN_EXE_signorini");
    for (command, columns, missing) in
        [("diff", 30, Some("Delta a")), ("diff", 80, None), ("list", 40, None)]
    {
        let line = format!("stty rows 24 cols {columns}; '{program}' {command}");
        let Some(shown) = shown_by(&project, &line, &[("TERM", "dumb")]) else { return };
        assert!(shown.lines().all(|line| line.chars().count() <= columns), "{shown}");
        assert_eq!(shown.contains("\nno room for: "), missing.is_some(), "{shown}");
        assert!(missing.is_none_or(|missing| shown.contains(missing)), "{shown}");
    }
}

#[test]
fn marks_of_a_comparison_have_colours_on_a_terminal() {
    let project = Project::with(&(TABLE.to_owned() + "paper_table = 1\n"));
    let Some(shown) = on_a_terminal(&project, "diff", &[("TERM", "xterm")]) else { return };
    // Green, yellow and red, each on a mark alone.
    for mark in ["\x1b[32m=", "\x1b[33m~", "\x1b[31m!"] {
        let plain = shown.replace("\x1b[1m", "");
        assert!(plain.contains(&format!("{mark}\x1b[0m")), "{mark:?}: {shown:?}");
    }
    let plain = on_a_terminal(&project, "diff", &[("TERM", "xterm"), ("NO_COLOR", "1")]).unwrap();
    assert!(!plain.contains('\x1b') && plain.contains("1=   1"), "{plain}");
}

#[test]
fn terminals_get_what_they_can_show() {
    let project = Project::with(TABLE);
    let shown = |args, env: &[(&str, &str)]| on_a_terminal(&project, args, env);
    let Some(bar) = shown("run -f", &[("TERM", "xterm")]) else { return };
    assert!(bar.contains("\x1b[") && !bar.contains(" to run"), "{bar}");
    // The number of tasks, the elapsed time, and the tasks that run.
    assert!(bar.contains("0/3  0s  ") && bar.contains("solve/a/signed/r=1"), "{bar}");
    // A dumb terminal cannot draw over a line, and nobody watches a log grow.
    for env in [&[("TERM", "dumb")][..], &[("TERM", "xterm"), ("CI", "1")]] {
        let plain = shown("run -f", env).unwrap();
        assert!(plain.contains("3 tasks to run") && plain.contains("took "), "{env:?}: {plain}");
        assert!(!plain.contains('\x1b'), "{env:?}: {plain}");
    }
    assert!(shown("status", &[("TERM", "xterm")]).unwrap().contains("\x1b["));
    for env in [&[("TERM", "dumb")][..], &[("TERM", "xterm"), ("NO_COLOR", "1")]] {
        assert!(!shown("status", env).unwrap().contains('\x1b'), "{env:?}");
    }
}

#[test]
fn data_on_standard_output_fit_eighty_columns() {
    let project = Project::with(TABLE);
    let f = ["--f", "disc(0,0,0.2)=3; else=-1"];
    let cube = ["--domain", "cube", "--f", "ball(0,0,0,0.2)=3; else=-1", "--h", "1/8"];
    let solve = |options: &[&'static str]| [&["solve"], options].concat();
    let commands = [
        vec!["run"],
        vec!["run", "--force"],
        vec!["status"],
        vec!["explain", "solve"],
        vec!["list"],
        solve(&["a"]),
        solve(&f),
        solve(&[&f[..], &["--solver", "spectral"]].concat()),
        solve(&[&f[..], &["--accuracy", "0.1"]].concat()),
        solve(&cube),
    ];
    for command in commands {
        let said = project.run(&command);
        assert!(said.code != Some(2) && !said.out.is_empty(), "{said:?}");
        for line in said.out.lines() {
            assert!(line.chars().count() <= 80, "{command:?}: {line}");
        }
    }
}
