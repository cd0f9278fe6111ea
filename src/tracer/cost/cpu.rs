//! The CPU that runs a thread.

/// Returns the number of the CPU that runs the calling thread; 0 where the system does not report
/// it.
#[inline]
pub(super) fn current() -> u32 {
    #[cfg(target_os = "linux")]
    return rustix::thread::sched_getcpu() as u32;
    #[cfg(not(target_os = "linux"))]
    return 0;
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn it_is_a_valid_cpu() {
        // Linux supports at most 8192 CPUs.
        assert!(current() < 8192);
    }
}
