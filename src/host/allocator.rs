//! An allocator that ends the program in plain words where memory is refused.
//!
//! Rust's own end is an abort: a signal and an exit code of 134, which a script
//! takes for a crash. (`std::alloc::set_alloc_error_hook` is not stable.)

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Write;

/// The system's allocator. Where it has no memory, the program ends with a
/// message and exit code 1, except within [`may_fail`].
///
/// A program takes it by `#[global_allocator]`.
#[derive(Debug, Clone, Copy)]
pub struct Allocator;

thread_local! {
    /// Without a destructor and without memory of its own: an allocator may
    /// read it at any time.
    static MAY_FAIL: Cell<bool> = const { Cell::new(false) };
}

/// Does work that can go on without the memory it asks for, such as
/// [`Vec::try_reserve`], which needs this to give its error.
pub fn may_fail<T>(work: impl FnOnce() -> T) -> T {
    let before = MAY_FAIL.replace(true);
    let done = work();
    MAY_FAIL.set(before);
    done
}

#[expect(unsafe_code, reason = "an allocator is an unsafe trait")]
// SAFETY: every call goes to the system's allocator as it is, and what that
// gives is handed on as it is; a null pointer is handed on, or nothing is.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps to the contract of `alloc`.
        granted(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps to the contract of `alloc_zeroed`.
        granted(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller keeps to the contract of `realloc`.
        granted(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps to the contract of `dealloc`.
        unsafe { System.dealloc(block, layout) }
    }
}

/// The block, if there is one or the work may go on without.
#[inline]
fn granted(block: *mut u8, n_bytes: usize) -> *mut u8 {
    if block.is_null() && !MAY_FAIL.get() {
        exhausted(n_bytes);
    }
    block
}

/// Ends the program. Nothing here takes memory.
#[cold]
fn exhausted(n_bytes: usize) -> ! {
    let _ = writeln!(
        std::io::stderr(),
        "error: out of memory: the system refuses {n_bytes} more bytes\n  |\n  \
         = help: take a smaller picture or scene, or raise the limit of memory (`ulimit -v`)"
    );
    std::process::exit(1)
}
