//! Options before the command: they are moved behind the command, so that each has a single place of definition.

use clap::{ArgAction, Command};
use std::ffi::OsString;

/// Returns the arguments, the program's name first, with the options before a command of `cli` behind that command.
///
/// Arguments without such a command stay as they are.
pub(super) fn options_last(cli: &Command, mut args: Vec<OsString>) -> Vec<OsString> {
    let at = after_options(cli, &args);
    let is_command =
        |arg: &OsString| arg.to_str().is_some_and(|name| cli.find_subcommand(name).is_some());
    if at > 1 && args.get(at).is_some_and(is_command) {
        args[1..=at].rotate_right(1);
    }
    args
}

/// Returns the first argument that is neither an option of the program nor the value of one.
pub(super) fn first_word<'a>(cli: &Command, args: &'a [OsString]) -> Option<&'a str> {
    args.get(after_options(cli, args))?.to_str()
}

/// Position of the first argument after the options with which the arguments begin.
fn after_options(cli: &Command, args: &[OsString]) -> usize {
    let mut at = 1;
    while let Some(option) =
        args.get(at).and_then(|arg| arg.to_str()).filter(|arg| arg.starts_with('-'))
    {
        at += if takes_next(cli, option) { 2 } else { 1 };
    }
    at
}

/// True if the value of an option is the argument that follows.
fn takes_next(cli: &Command, option: &str) -> bool {
    let named = cli.get_arguments().find(|arg| match option.strip_prefix("--") {
        Some(long) => arg.get_long() == Some(long),
        // Of short options in one word, the last one may have a value.
        None => arg.get_short().is_some_and(|short| option.ends_with(short)),
    });
    named.is_some_and(|arg| matches!(arg.get_action(), ArgAction::Set | ArgAction::Append))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// Arguments after the name of the program, before and after.
    fn ordered(line: &str) -> String {
        let mut args: Vec<OsString> = vec!["signorini".into()];
        args.extend(line.split_whitespace().map(OsString::from));
        let args = options_last(&crate::cli::Cli::command(), args);
        args[1..].join(" ".as_ref()).into_string().unwrap()
    }

    #[test]
    fn options_and_their_values_move_behind_the_command() {
        for (before, after) in [
            ("-v run plate", "run -v plate"),
            ("-v -j 2 run plate -n", "run -v -j 2 plate -n"),
            ("--cache-dir run diff --md", "diff --cache-dir run --md"),
            ("--cache-dir=x -kj 1 run", "run --cache-dir=x -kj 1"),
        ] {
            assert_eq!(ordered(before), after);
        }
        for same in ["", "-v", "-v plate", "run -v", "plate run", "--only run", "-j", "--help run"]
        {
            let expected = if same == "--help run" { "run --help" } else { same };
            assert_eq!(ordered(same), expected);
        }
    }
}
