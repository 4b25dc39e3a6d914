//! The `signorini` command: everything happens in the library.

use signorini_mathematics::machine::memory::LargePages;
use std::io::Write;
use std::process::{ExitCode, exit};

/// Ends the program with an error line instead of an abort if the system refuses memory.
fn refuse(size: usize) -> ! {
    // Standard error is not buffered: this takes no memory.
    let _ = writeln!(
        std::io::stderr(),
        "error: the system refuses {size} bytes of memory; ask for less, such as a coarser grid or mesh or a \
         shorter page, or raise the limit (`ulimit -v`)"
    );
    exit(3)
}

#[global_allocator]
static ALLOCATOR: LargePages = LargePages { refused: Some(refuse) };

fn main() -> ExitCode {
    signorini::cli::main()
}
