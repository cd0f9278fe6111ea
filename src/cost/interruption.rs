//! Whether the thread lost its processor, at the price of one load from memory.
//!
//! Linux keeps a small structure of each thread for restartable sequences
//! (`linux/rseq.h`), which the C library registers. Its field `rseq_cs` points to
//! a sequence of instructions that has to be begun anew when it is interrupted.
//! Whenever the system takes the processor from a thread, or delivers a signal to
//! it, outside of that sequence, it clears the field. An empty sequence is
//! interrupted nowhere: with a pointer to one, the field is null exactly if the
//! thread was switched out, moved or signalled since.
//!
//! `getrusage(RUSAGE_THREAD)` counts the same switches, for a system call, which
//! takes as long as a cheap pixel. Interrupts that return to the thread at once,
//! a timer's tick for one, are reported by neither.

/// Tells of the interruptions of one thread.
#[derive(Debug)]
pub struct Interruptions {
    /// The thread's field `rseq_cs`; null where the system tells nothing.
    field: *mut u64,
}

impl Interruptions {
    /// Those of the calling thread from now on. The value stays on it: a pointer
    /// is not [`Send`].
    pub fn of_this_thread() -> Self {
        let mut interruptions = Self {
            field: rseq::field_of_this_thread(),
        };
        interruptions.take();
        interruptions
    }

    /// Whether the system tells of them.
    pub fn is_reported(&self) -> bool {
        !self.field.is_null()
    }

    /// Whether there was one since the last call; never where the system does
    /// not tell.
    #[inline]
    pub fn take(&mut self) -> bool {
        self.is_reported() && rseq::rearm(self.field)
    }
}

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod rseq {
    use std::ptr;

    /// A sequence of instructions, as the system reads it: `struct rseq_cs`.
    #[repr(C, align(32))]
    struct Sequence {
        version: u32,
        flags: u32,
        start_ip: *const u32,
        post_commit_offset: u64,
        abort_ip: *const u32,
    }

    // SAFETY: it is never written to, and its pointers are never followed by
    // this program.
    #[expect(unsafe_code, reason = "a constant with pointers for the system")]
    unsafe impl Sync for Sequence {}

    /// What the C library registers on x86-64 as the mark that stands before the
    /// place where an interrupted sequence goes on: `RSEQ_SIG`.
    const SIGNATURE: u32 = 0x5305_3053;

    /// The mark, and the place behind it, where no sequence ever goes on.
    static ABORT: [u32; 2] = [SIGNATURE, 0];

    /// No instruction at all.
    static EMPTY: Sequence = Sequence {
        version: 0,
        flags: 0,
        start_ip: &raw const ABORT[1],
        post_commit_offset: 0,
        abort_ip: &raw const ABORT[1],
    };

    /// Bytes from the beginning of `struct rseq` to its field `rseq_cs`.
    const FIELD_OFFSET: isize = 8;

    /// The thread's field `rseq_cs`; null where the C library has registered none:
    /// glibc does from version 2.35 on.
    #[expect(
        unsafe_code,
        reason = "the C library's symbols and the thread's pointer"
    )]
    pub(super) fn field_of_this_thread() -> *mut u64 {
        // SAFETY: both names are strings that end with 0.
        let [offset, size] = unsafe {
            [c"__rseq_offset", c"__rseq_size"]
                .map(|name| libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()))
        };
        if offset.is_null() || size.is_null() {
            return ptr::null_mut();
        }
        // SAFETY: glibc documents them as `const ptrdiff_t` and `const unsigned
        // int`, the latter 0 where nothing was registered.
        let (offset, size) = unsafe { (*offset.cast::<isize>(), *size.cast::<u32>()) };
        if size == 0 {
            return ptr::null_mut();
        }
        let thread: *mut u8;
        // SAFETY: on x86-64 the word at fs:0 is the thread's own address, by the
        // ABI of thread-local storage.
        unsafe { std::arch::asm!("mov {}, fs:0", out(reg) thread, options(nostack, readonly)) };
        thread.wrapping_offset(offset + FIELD_OFFSET).cast()
    }

    /// Whether the field was cleared; points it to the empty sequence again.
    #[inline]
    #[expect(unsafe_code, reason = "the system writes to this memory, too")]
    pub(super) fn rearm(field: *mut u64) -> bool {
        // SAFETY: the field is that of this thread, which lives; glibc lets
        // programs use it, and the empty sequence lives as long as the program.
        unsafe {
            if field.read_volatile() != 0 {
                return false;
            }
            field.write_volatile(&raw const EMPTY as u64);
        }
        true
    }
}

#[cfg(not(all(target_os = "linux", target_arch = "x86_64")))]
mod rseq {
    pub(super) fn field_of_this_thread() -> *mut u64 {
        std::ptr::null_mut()
    }

    pub(super) fn rearm(_: *mut u64) -> bool {
        false
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::time::Duration;

    use nix::sys::resource::{Usage, UsageWho, getrusage};

    use super::*;

    /// Switches of this thread so far, by the system's own count.
    fn n_switches() -> i64 {
        let usage: Usage = getrusage(UsageWho::RUSAGE_THREAD).unwrap();
        usage.voluntary_context_switches() + usage.involuntary_context_switches()
    }

    #[test]
    fn a_thread_that_sleeps_is_switched_out() {
        let mut interruptions = Interruptions::of_this_thread();
        if !interruptions.is_reported() {
            return;
        }
        for _ in 0..10 {
            std::thread::sleep(Duration::from_micros(50));
            assert!(interruptions.take());
        }
    }

    #[test]
    fn without_a_switch_there_is_no_interruption() {
        let mut interruptions = Interruptions::of_this_thread();
        let mut n_quiet = 0;
        // Not each of a thousand short moments has a switch.
        for _ in 0..1000 {
            let before = n_switches();
            interruptions.take();
            let is_interrupted = interruptions.take();
            if n_switches() == before {
                assert!(!is_interrupted);
                n_quiet += 1;
            }
        }
        assert!(n_quiet > 0);
    }

    #[test]
    fn each_thread_has_its_own() {
        let wait = || {
            let mut interruptions = Interruptions::of_this_thread();
            std::thread::sleep(Duration::from_micros(50));
            (interruptions.take(), interruptions.is_reported())
        };
        let (is_noticed, is_reported) = std::thread::spawn(wait).join().unwrap();
        assert_eq!(is_noticed, is_reported);
    }
}
