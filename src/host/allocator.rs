//! An allocator that ends the program with a message if memory is exhausted.
//!
//! Rust aborts instead: a signal and exit code 134, which a script interprets as a crash.
//! (`std::alloc::set_alloc_error_hook` is not stable.)

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::ask_for_huge_pages;

/// The system's allocator. If it has no memory, the program ends with a message and exit code 1,
/// except within [`may_fail`]. Large blocks get huge pages where a program may ask for them.
///
/// A program selects it with `#[global_allocator]`.
#[derive(Debug, Clone, Copy)]
pub struct Allocator;

/// Least bytes of a block that gets huge pages.
const LARGE: usize = 4 << 20;

/// The number of the file for messages.
const STANDARD_ERROR: libc::c_int = 2;

thread_local! {
    /// No destructor and no allocation: an allocator may read it at any time.
    static MAY_FAIL: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work`, which handles failed allocations itself, as [`Vec::try_reserve`] does: only within
/// this function does it return an error.
pub fn may_fail<T>(work: impl FnOnce() -> T) -> T {
    let before = MAY_FAIL.replace(true);
    let done = work();
    MAY_FAIL.set(before);
    done
}

#[expect(unsafe_code, reason = "an allocator is an unsafe trait")]
// SAFETY: each call is forwarded to the system's allocator, and its result is returned unchanged, or
// cleared; for a null pointer the program may end instead. Advice changes no contents.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller fulfills the contract of `alloc`.
        granted(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // The system clears an aligned block itself: too early for huge pages.
        if layout.size() >= LARGE && layout.align() > align_of::<u128>() {
            // SAFETY: as for `alloc`; a block that is not null has this size.
            unsafe {
                let block = self.alloc(layout);
                if !block.is_null() {
                    block.write_bytes(0, layout.size());
                }
                return block;
            }
        }
        // SAFETY: the caller fulfills the contract of `alloc_zeroed`.
        granted(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller fulfills the contract of `realloc`.
        granted(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller fulfills the contract of `dealloc`.
        unsafe { System.dealloc(block, layout) }
    }
}

/// Returns the block, or ends the program if it is null outside of [`may_fail`].
#[inline]
fn granted(block: *mut u8, n_bytes: usize) -> *mut u8 {
    if block.is_null() && !MAY_FAIL.get() {
        exhausted(n_bytes);
    }
    if n_bytes >= LARGE && !block.is_null() {
        ask_for_huge_pages(block.addr(), n_bytes);
    }
    block
}

/// Ends the program without allocating: with one message, also if other threads find no memory at
/// the same time, and without the functions that run at an orderly exit, which may allocate.
#[cold]
fn exhausted(n_bytes: usize) -> ! {
    static IS_REPORTED: AtomicBool = AtomicBool::new(false);
    if IS_REPORTED.swap(true, Ordering::Relaxed) {
        loop {
            std::thread::sleep(Duration::MAX);
        }
    }
    let mut message = [0; 256];
    let mut rest = &mut message[..];
    let _ = writeln!(
        rest,
        "error: out of memory: the system refuses {n_bytes} more bytes\n  |\n  \
         = help: take a smaller picture or scene, or raise the limit of memory (`ulimit -v`)"
    );
    let n_unused = rest.len();
    let n = message.len() - n_unused;
    #[expect(unsafe_code, reason = "functions of the C library")]
    // SAFETY: the first call reads the first `n` bytes of the message; the second ends the process.
    // Neither waits for a lock that a thread without memory may hold.
    unsafe {
        libc::write(STANDARD_ERROR, message.as_ptr().cast(), n as _);
        libc::_exit(1)
    }
}
