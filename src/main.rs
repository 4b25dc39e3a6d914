//! The `signorini` command: everything happens in the library.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::process::{ExitCode, exit};

/// The system's allocator; where it refuses, the program ends with a line instead of an abort.
struct Allocator;

fn refuse(size: usize) -> ! {
    // Standard error is not buffered: this takes no memory.
    let _ = writeln!(
        std::io::stderr(),
        "error: the system refuses {size} bytes of memory; take a coarser grid or raise the limit (`ulimit -v`)"
    );
    exit(3)
}

// SAFETY: every call is passed on to `System` with the caller's own promises, and no pointer is changed.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let memory = unsafe { System.alloc(layout) };
        if memory.is_null() { refuse(layout.size()) } else { memory }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let memory = unsafe { System.alloc_zeroed(layout) };
        if memory.is_null() { refuse(layout.size()) } else { memory }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let memory = unsafe { System.realloc(memory, layout, size) };
        if memory.is_null() { refuse(size) } else { memory }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() -> ExitCode {
    signorini::cli::main()
}
