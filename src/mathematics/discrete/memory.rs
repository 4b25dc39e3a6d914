//! An allocator for programs that solve on fine grids.

use std::alloc::{GlobalAlloc, Layout, System};

/// The system's allocator, with large pages for large blocks: with those of 4 KiB, the first touch of the memory of a
/// fine grid takes as long as the solution.
///
/// ```
/// use signorini_mathematics::discrete::memory::LargePages;
///
/// #[global_allocator]
/// static ALLOCATOR: LargePages = LargePages { refused: None };
/// ```
pub struct LargePages {
    /// What ends the program if the system refuses so many bytes; without it Rust does, with an abort.
    pub refused: Option<fn(usize) -> !>,
}

/// A large page on most machines, in bytes.
const LARGE_PAGE: usize = 2 << 20;

impl LargePages {
    /// Memory as the system gave it.
    fn given(&self, memory: *mut u8, size: usize) -> *mut u8 {
        if memory.is_null() {
            return self.refused.map_or(memory, |refused| refused(size));
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
}

// SAFETY: every call is passed on to `System` with the caller's own promises, and no pointer is changed.
unsafe impl GlobalAlloc for LargePages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        self.given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        self.given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        self.given(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { System.dealloc(memory, layout) }
    }
}
