//! The `signorini` command: everything happens in the library.

use signorini::discrete::memory::LargePages;
use std::alloc::{GlobalAlloc, Layout};
use std::io::Write;
use std::process::{ExitCode, exit};

/// The allocator for fine grids; where the system refuses, the program ends with a line instead of an abort.
struct Allocator;

/// Memory as the system gave it, unless it refused.
fn given(memory: *mut u8, size: usize) -> *mut u8 {
    if memory.is_null() {
        refuse(size)
    }
    memory
}

fn refuse(size: usize) -> ! {
    // Standard error is not buffered: this takes no memory.
    let _ = writeln!(
        std::io::stderr(),
        "error: the system refuses {size} bytes of memory; take a coarser grid or raise the limit (`ulimit -v`)"
    );
    exit(3)
}

// SAFETY: every call is passed on to `LargePages` with the caller's own promises, and no pointer is changed.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        given(unsafe { LargePages.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        given(unsafe { LargePages.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        given(unsafe { LargePages.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { LargePages.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() -> ExitCode {
    signorini::cli::main()
}
