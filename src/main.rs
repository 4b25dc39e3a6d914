//! The `signorini` command: everything happens in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    signorini::cli::main()
}
