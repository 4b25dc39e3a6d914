//! An allocator for programs that solve on fine grids.

use std::alloc::{GlobalAlloc, Layout, System};

/// The system's allocator, with large pages for large blocks: with those of 4 KiB, the first touch of the memory of a
/// fine grid takes as long as the solution.
///
/// ```
/// use signorini_mathematics::machine::memory::LargePages;
///
/// #[global_allocator]
/// static ALLOCATOR: LargePages = LargePages { refused: None };
/// ```
pub struct LargePages {
    /// Function that ends the program if the system refuses so many bytes; without it Rust does, with an abort.
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
        // SAFETY: the caller's promises are those that `System` asks for.
        self.given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `System` asks for.
        self.given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promises are those that `System` asks for.
        self.given(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.dealloc(memory, layout) }
    }
}

/// Gives free memory back to the system, which the allocator would keep for later, in pieces between what is in use.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: the function may be called at any time, by any thread.
    unsafe {
        libc::malloc_trim(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    const LENIENT: LargePages = LargePages { refused: None };
    const STRICT: LargePages = LargePages { refused: Some(|size| panic!("{size} refused")) };

    /// More than any machine has.
    const TOO_MUCH: usize = isize::MAX as usize - (1 << 20);

    fn layout(size: usize, align: usize) -> Layout {
        Layout::from_size_align(size, align).expect("a valid layout")
    }

    #[test]
    fn blocks_keep_their_alignment_and_contents_when_they_grow_and_shrink() {
        let sizes = [100, LARGE_PAGE - 1, 2 * LARGE_PAGE, 2 * LARGE_PAGE + 1, 5 * LARGE_PAGE, 100];
        for align in [8, 64, 4096, 4 * LARGE_PAGE] {
            // SAFETY: each block is used within its size, and given back with the layout that it has.
            unsafe {
                let mut now = layout(sizes[0], align);
                let mut memory = LENIENT.alloc_zeroed(now);
                for (written, size) in (0..).zip(sizes) {
                    let kept = size.min(now.size());
                    memory = LENIENT.realloc(memory, now, size);
                    assert!(!memory.is_null() && memory.addr().is_multiple_of(align), "{align}");
                    now = layout(size, align);
                    let block = std::slice::from_raw_parts_mut(memory, size);
                    assert!(block[..kept].iter().all(|byte| *byte == written), "{size}");
                    block.fill(written + 1);
                }
                LENIENT.dealloc(memory, now);
                let zeros = layout(3 * LARGE_PAGE, align);
                let memory = LENIENT.alloc_zeroed(zeros);
                assert!(std::slice::from_raw_parts(memory, zeros.size()).iter().all(|b| *b == 0));
                LENIENT.dealloc(memory, zeros);
            }
        }
    }

    #[test]
    fn a_refusal_is_reported_with_the_bytes_asked_for() {
        let too_much = layout(TOO_MUCH, 64);
        let small = layout(100, 64);
        // SAFETY: a block that was refused is not used, and the small one is given back as it is.
        unsafe {
            assert!(LENIENT.alloc(too_much).is_null() && LENIENT.alloc_zeroed(too_much).is_null());
            let memory = STRICT.alloc(small);
            assert!(LENIENT.realloc(memory, small, TOO_MUCH).is_null());
            for refused in [
                catch_unwind(|| _ = STRICT.alloc(too_much)),
                catch_unwind(|| _ = STRICT.alloc_zeroed(too_much)),
                catch_unwind(|| _ = STRICT.realloc(memory, small, TOO_MUCH)),
            ] {
                let said = refused.expect_err("a refusal").downcast::<String>().expect("a text");
                assert_eq!(*said, format!("{TOO_MUCH} refused"));
            }
            STRICT.dealloc(memory, small);
        }
    }
}
