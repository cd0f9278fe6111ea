//! Detects context switches of a thread with a single load from memory.
//!
//! Linux has a small structure per thread for restartable sequences (`linux/rseq.h`), which the C
//! library registers. Its field `rseq_cs` points to a critical section, which restarts when it is
//! interrupted. When the kernel preempts or migrates a thread outside of that section, or delivers
//! a signal to it, it clears the field. With a pointer to an empty section, which contains no
//! instruction, the field is null exactly if the thread was preempted, migrated or signaled since.
//!
//! `getrusage(RUSAGE_THREAD)` counts the same switches, but its system call takes as long as a
//! cheap pixel. Neither reports interrupts that return to the thread at once, such as a timer tick.

/// Detects interruptions of one thread.
#[derive(Debug)]
pub struct Interruptions {
    /// The thread's field `rseq_cs`; null where it is not registered.
    field: *mut u64,
}

impl Interruptions {
    /// Starts detecting interruptions of the calling thread. The value is not [`Send`], so it stays
    /// on this thread.
    pub fn of_this_thread() -> Self {
        let mut interruptions = Self {
            field: rseq::field_of_this_thread(),
        };
        interruptions.take();
        interruptions
    }

    /// Returns true if the system reports interruptions.
    pub fn is_reported(&self) -> bool {
        !self.field.is_null()
    }

    /// Returns true if the thread was interrupted since the last call; always false where the
    /// system does not report it.
    #[inline]
    pub fn take(&mut self) -> bool {
        self.is_reported() && rseq::rearm(self.field)
    }
}

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod rseq {
    use std::ptr;

    /// A critical section, as the kernel reads it: `struct rseq_cs`.
    #[repr(C, align(32))]
    struct CriticalSection {
        version: u32,
        flags: u32,
        start_ip: *const u32,
        post_commit_offset: u64,
        abort_ip: *const u32,
    }

    // SAFETY: this program never writes to it and never dereferences its pointers.
    #[expect(unsafe_code, reason = "a constant with pointers for the kernel")]
    unsafe impl Sync for CriticalSection {}

    /// The signature that the C library registers on x86-64, which precedes each abort handler:
    /// `RSEQ_SIG`.
    const SIGNATURE: u32 = 0x5305_3053;

    /// The signature, and the abort handler, which is never executed.
    static ABORT: [u32; 2] = [SIGNATURE, 0];

    /// A section without instructions.
    static EMPTY: CriticalSection = CriticalSection {
        version: 0,
        flags: 0,
        start_ip: &raw const ABORT[1],
        post_commit_offset: 0,
        abort_ip: &raw const ABORT[1],
    };

    /// Offset of the field `rseq_cs` in `struct rseq`.
    const FIELD_OFFSET: isize = 8;

    /// Returns the thread's field `rseq_cs`; null if the C library has not registered it, as glibc
    /// does since version 2.35.
    #[expect(
        unsafe_code,
        reason = "the C library's symbols and the thread's pointer"
    )]
    pub(super) fn field_of_this_thread() -> *mut u64 {
        // SAFETY: both names are null-terminated.
        let [offset, size] = unsafe {
            [c"__rseq_offset", c"__rseq_size"]
                .map(|name| libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()))
        };
        if offset.is_null() || size.is_null() {
            return ptr::null_mut();
        }
        // SAFETY: glibc documents them as `const ptrdiff_t` and `const unsigned int`, the latter 0
        // if nothing was registered.
        let (offset, size) = unsafe { (*offset.cast::<isize>(), *size.cast::<u32>()) };
        if size == 0 {
            return ptr::null_mut();
        }
        let thread: *mut u8;
        // SAFETY: on x86-64 the word at fs:0 is the thread's own address, by the ABI of
        // thread-local storage.
        unsafe { std::arch::asm!("mov {}, fs:0", out(reg) thread, options(nostack, readonly)) };
        thread.wrapping_offset(offset + FIELD_OFFSET).cast()
    }

    /// Returns true if the kernel has cleared the field; points it to [`EMPTY`] again.
    #[inline]
    #[expect(unsafe_code, reason = "the kernel also writes to this memory")]
    pub(super) fn rearm(field: *mut u64) -> bool {
        // SAFETY: the field belongs to this running thread; glibc permits its use, and `EMPTY` is
        // static.
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

    /// Returns the context switches of this thread so far, as counted by the kernel.
    fn n_switches() -> i64 {
        let usage: Usage = getrusage(UsageWho::RUSAGE_THREAD).unwrap();
        usage.voluntary_context_switches() + usage.involuntary_context_switches()
    }

    #[test]
    fn sleeping_is_an_interruption() {
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
        // Some of a thousand short moments have no switch.
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
    fn threads_are_observed_separately() {
        let wait = || {
            let mut interruptions = Interruptions::of_this_thread();
            std::thread::sleep(Duration::from_micros(50));
            (interruptions.take(), interruptions.is_reported())
        };
        let (is_noticed, is_reported) = std::thread::spawn(wait).join().unwrap();
        assert_eq!(is_noticed, is_reported);
    }
}
