//! The `signorini` command: everything happens in the library.

use signorini::discrete::memory::LargePages;
use std::io::Write;
use std::process::{ExitCode, exit};

/// Where the system refuses memory, the program ends with a line instead of an abort.
fn refuse(size: usize) -> ! {
    // Standard error is not buffered: this takes no memory.
    let _ = writeln!(
        std::io::stderr(),
        "error: the system refuses {size} bytes of memory; take a coarser grid or raise the limit (`ulimit -v`)"
    );
    exit(3)
}

#[global_allocator]
static ALLOCATOR: LargePages = LargePages { refused: Some(refuse) };

fn main() -> ExitCode {
    signorini::cli::main()
}
