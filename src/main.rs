//! The `signorini` command: everything happens in the library.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::process::{ExitCode, exit};

/// The system's allocator; where it refuses, the program ends with a line instead of an abort.
///
/// Large blocks ask for large pages: with those of 4 KiB, the first touch of the memory of a fine grid takes as long
/// as the solution.
struct Allocator;

/// A large page on most machines, in bytes.
const LARGE_PAGE: usize = 2 << 20;

/// Memory as the system gave it, unless it refused.
fn given(memory: *mut u8, size: usize) -> *mut u8 {
    if memory.is_null() {
        refuse(size)
    }
    #[cfg(target_os = "linux")]
    if size >= 2 * LARGE_PAGE {
        let before = memory.align_offset(LARGE_PAGE);
        // SAFETY: the range lies within the block, and the advice changes nothing that can be read. Where the
        // system does not follow it, pages stay small.
        unsafe {
            libc::madvise(memory.add(before).cast(), size - before, libc::MADV_HUGEPAGE);
        }
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

// SAFETY: every call is passed on to `System` with the caller's own promises, and no pointer is changed.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        given(unsafe { System.realloc(memory, layout, size) }, size)
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
