//! Help: `--help` shows all options, each in the words of its first paragraph; `-h` leaves out the rarer ones, and the
//! manual pages have all that is said of each.

use clap::builder::Resettable;
use clap::{Arg, ArgAction, Command};
use std::ffi::OsString;

/// Returns the words of the command line; `help COMMAND` is `COMMAND --help`.
pub(super) fn words() -> Vec<OsString> {
    let mut words: Vec<OsString> = std::env::args_os().collect();
    if words.get(1).is_some_and(|word| word == "help") {
        words.remove(1);
        words.push("--help".into());
    }
    words
}

/// Returns a program whose help is that of `--help`, in the compact form that clap has for `-h`.
pub(super) fn with_all_options(command: Command) -> Command {
    let after = command.get_after_long_help().or(command.get_after_help()).cloned();
    let help = Arg::new("help").short('h').long("help").action(ArgAction::HelpShort);
    command
        .disable_help_flag(true)
        .mut_args(|arg| arg.hide_short_help(false))
        .mut_subcommands(with_all_options)
        .arg(help.help("Print help; `signorini man` has more"))
        .after_help(after.map_or(Resettable::Reset, Resettable::Value))
}
