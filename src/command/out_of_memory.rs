//! What is said when there is no memory left. Rust would abort, with a trace of calls that helps nobody.

#![expect(unsafe_code, reason = "an allocator; every call is handed on to that of the system")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;

/// The memory of the system. Asked for more than there is, the program ends with an error that says how much was wanted.
pub(crate) struct Allocator;

// SAFETY: what the system's allocator promises, this one does; it differs only in not coming back without memory.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        there(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        there(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promise.
        there(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[inline(always)]
fn there(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() { end(bytes) } else { memory }
}

#[cold]
fn end(bytes: usize) -> ! {
    // Written without a buffer that would have to be allocated.
    let mut text = [0u8; 256];
    let mut rest = &mut text[..];
    let _ = writeln!(
        rest,
        "error: memory: {bytes} bytes more were wanted, and there are none left; expected more memory, a smaller --memory, \
         fewer points or a smaller --max-frequency"
    );
    let left = rest.len();
    let _ = std::io::stderr().write_all(&text[..text.len() - left]);
    std::process::exit(1)
}
