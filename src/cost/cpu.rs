//! Which CPU a thread is on.

/// A number of the CPU that the thread is on now; 0 where the system does not
/// tell.
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
    fn it_is_one_of_the_machine() {
        // Above 8192 CPUs no Linux was ever built.
        assert!(current() < 8192);
    }
}
