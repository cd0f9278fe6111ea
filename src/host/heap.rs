//! The heap of the GNU C library: how it grows, and what it keeps.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::may_fail;

/// Bytes by which the heap grows.
const GROWTH: usize = 4 << 20;

/// Least size of a block that is mapped outside of the heap.
const LEAST_MAPPED: usize = 32 << 20;

/// Maximum free memory that the heap keeps at its end.
const MOST_FREE: usize = 128 << 20;

/// Bytes that a thread maps at a time.
const MAPPED: usize = 4 << 20;

/// Bytes of a page.
const PAGE: usize = 4096;

/// True once the program has called [`configure_heap`].
static IS_CONFIGURED: AtomicBool = AtomicBool::new(false);

/// Lets all threads share one heap, which grows by megabytes and keeps large blocks. By default
/// each thread has a heap that grows by a page at a time, with a system call that locks the whole
/// process.
pub fn configure_heap() {
    set(libc::M_ARENA_MAX, 1);
    set(libc::M_TOP_PAD, GROWTH);
    set(libc::M_MMAP_THRESHOLD, LEAST_MAPPED);
    set(libc::M_TRIM_THRESHOLD, MOST_FREE);
    IS_CONFIGURED.store(true, Ordering::Relaxed);
}

/// Grows the heap by the bytes that will be allocated next, in blocks of any size, and maps its new
/// pages, huge ones if the system lets a program ask for them, on all threads of the current rayon
/// pool: touching unmapped pages sequentially takes twice as long on two threads. Does nothing for a
/// few bytes, or if the program has not called [`configure_heap`].
pub fn grow_heap(n_bytes: usize) {
    // Small films, such as a single tile's, are made often.
    if n_bytes < MAPPED || !IS_CONFIGURED.load(Ordering::Relaxed) {
        return;
    }
    let info = read_statistics();
    let n_missing = n_bytes.saturating_sub(info.fordblks);
    if n_missing < MAPPED {
        return;
    }
    // Otherwise the system reclaims what is not allocated yet.
    set(libc::M_TRIM_THRESHOLD, n_bytes.saturating_add(MOST_FREE));
    set(libc::M_TOP_PAD, n_missing);
    set(libc::M_MMAP_THRESHOLD, usize::MAX);
    let begin = end_of_heap();
    // A block that does not fit makes the heap grow.
    drop(may_fail(|| {
        let mut block = Vec::<u8>::new();
        block.try_reserve_exact(info.keepcost + 1).map(|()| block)
    }));
    set(libc::M_MMAP_THRESHOLD, LEAST_MAPPED);
    set(libc::M_TOP_PAD, GROWTH);
    let n_new = n_missing.min(end_of_heap().saturating_sub(begin));
    ask_for_huge_pages(begin, n_new);
    let parts = (0..n_new.div_ceil(MAPPED)).into_par_iter();
    parts.for_each(|part| {
        let first = part * MAPPED;
        let n_bytes = MAPPED.min(n_new - first);
        advise(begin + first, n_bytes, libc::MADV_POPULATE_WRITE);
    });
}

/// Returns the allocator's statistics in bytes: `fordblks` are free, of which `keepcost` are at the
/// end of the heap.
fn read_statistics() -> libc::mallinfo2 {
    #[expect(unsafe_code, reason = "a function of the C library")]
    // SAFETY: the call takes nothing and returns numbers.
    unsafe {
        libc::mallinfo2()
    }
}

/// Sets a parameter of the allocator.
fn set(parameter: libc::c_int, value: usize) {
    let value = libc::c_int::try_from(value).unwrap_or(libc::c_int::MAX);
    #[expect(unsafe_code, reason = "a function of the C library")]
    // SAFETY: the parameters that are set here take any number of bytes or heaps; values out
    // of range are ignored.
    unsafe {
        libc::mallopt(parameter, value);
    }
}

/// Returns the address past the heap, at the end of a page.
fn end_of_heap() -> usize {
    #[expect(unsafe_code, reason = "a function of the C library")]
    // SAFETY: an increment of 0 changes nothing.
    let end = unsafe { libc::sbrk(0) };
    end.addr()
}

/// Asks for huge pages for a block of memory that begins at this address: a fault of one maps as much
/// as 512 faults of small ones.
pub fn ask_for_huge_pages(begin: usize, n_bytes: usize) {
    advise(begin.next_multiple_of(PAGE), n_bytes, libc::MADV_HUGEPAGE);
}

/// Advises the system how to map pages of the heap; `begin` is the start of a page. The advice is
/// to take huge pages or to map the pages now.
fn advise(begin: usize, n_bytes: usize, advice: libc::c_int) {
    let begin = std::ptr::without_provenance_mut(begin);
    #[expect(unsafe_code, reason = "a function of the C library")]
    // SAFETY: the advice changes no contents, and an error, as on Linux before 5.14, has no effect.
    unsafe {
        libc::madvise(begin, n_bytes, advice);
    }
}
