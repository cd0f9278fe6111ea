//! Resources of the operating system that the process has used.

/// Work of the operating system for all threads together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SystemWork {
    /// Page faults, minor and major.
    pub page_faults: u64,
    /// Context switches, voluntary and involuntary.
    pub context_switches: u64,
}

impl SystemWork {
    /// Returns the work since the start of the process; `None` if it is unknown.
    #[cfg(unix)]
    pub(super) fn so_far() -> Option<Self> {
        let usage = read_usage()?;
        let count = |n: i64| u64::try_from(n).unwrap_or_default();
        Some(Self {
            page_faults: count(usage.minor_page_faults() + usage.major_page_faults()),
            context_switches: count(
                usage.voluntary_context_switches() + usage.involuntary_context_switches(),
            ),
        })
    }

    /// Returns `None`: not reported by this system.
    #[cfg(not(unix))]
    pub(super) fn so_far() -> Option<Self> {
        None
    }

    /// Returns the work since `before`.
    pub(super) fn since(self, before: Self) -> Self {
        Self {
            page_faults: self.page_faults - before.page_faults,
            context_switches: self.context_switches - before.context_switches,
        }
    }
}

/// Returns the peak resident memory of this process in bytes; `None` if the system does not report
/// it.
///
/// `getrusage` is unsuitable: on Linux its `ru_maxrss` survives `exec`, and so includes the peak of
/// the program that started this one.
#[cfg(target_os = "linux")]
pub fn peak_memory_bytes() -> Option<u64> {
    let [peak] = host::bytes_of_status(["VmHWM:"]);
    peak
}

/// Returns the peak resident memory of this process in bytes; `None` if the system does not report
/// it. On macOS `exec` resets `ru_maxrss`.
#[cfg(target_os = "macos")]
pub fn peak_memory_bytes() -> Option<u64> {
    u64::try_from(read_usage()?.max_rss()).ok()
}

/// Returns `None`: not implemented for this system.
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
pub fn peak_memory_bytes() -> Option<u64> {
    None
}

#[cfg(unix)]
fn read_usage() -> Option<nix::sys::resource::Usage> {
    use nix::sys::resource::{UsageWho, getrusage};
    getrusage(UsageWho::RUSAGE_SELF).ok()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_at_least_what_is_used_now() {
        let now = host::resident_memory();
        let peak = peak_memory_bytes();
        assert!(now.is_some_and(|bytes| bytes > 1 << 20));
        assert!(peak >= now, "{peak:?} {now:?}");
    }
}
