//! What the process has taken from the operating system.

use serde::Serialize;

/// Work of the operating system for all threads together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SystemWork {
    /// Pages of memory that were given at their first touch, or read again.
    pub page_faults: u64,
    /// Times that a thread made room for another, of its own accord or not.
    pub context_switches: u64,
}

impl SystemWork {
    /// Since the process began; `None` where nobody counts it.
    #[cfg(unix)]
    pub(super) fn so_far() -> Option<Self> {
        let usage = usage()?;
        let count = |n: i64| u64::try_from(n).unwrap_or_default();
        Some(Self {
            page_faults: count(usage.minor_page_faults() + usage.major_page_faults()),
            context_switches: count(
                usage.voluntary_context_switches() + usage.involuntary_context_switches(),
            ),
        })
    }

    /// Nobody counts it.
    #[cfg(not(unix))]
    pub(super) fn so_far() -> Option<Self> {
        None
    }

    /// What was added since `before`.
    pub(super) fn since(self, before: Self) -> Self {
        Self {
            page_faults: self.page_faults - before.page_faults,
            context_switches: self.context_switches - before.context_switches,
        }
    }
}

/// The most physical memory that this program has had at a time, in bytes;
/// `None` where the system does not say.
///
/// Not `getrusage`: on Linux its `ru_maxrss` survives `exec`, and so is at
/// least that of the program which started this one.
#[cfg(target_os = "linux")]
pub(super) fn peak_memory_bytes() -> Option<u64> {
    peak_of_status(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// The most physical memory that this program has had at a time, in bytes;
/// `None` where the system does not say. On macOS each program is a task of its
/// own, with a maximum of its own.
#[cfg(target_os = "macos")]
pub(super) fn peak_memory_bytes() -> Option<u64> {
    u64::try_from(usage()?.max_rss()).ok()
}

/// `None`: this system is not asked.
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
pub(super) fn peak_memory_bytes() -> Option<u64> {
    None
}

/// The peak of the resident set in bytes, by the text of `/proc/PID/status`:
/// proc_pid_status(5).
#[cfg(target_os = "linux")]
fn peak_of_status(status: &str) -> Option<u64> {
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = peak.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kib << 10)
}

#[cfg(unix)]
fn usage() -> Option<nix::sys::resource::Usage> {
    use nix::sys::resource::{UsageWho, getrusage};
    getrusage(UsageWho::RUSAGE_SELF).ok()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_as_linux_writes_it() {
        let status = "Name:\traycost\nVmPeak:\t  456096 kB\nVmHWM:\t   12345 kB\nVmRSS:\t 11 kB\n";
        assert_eq!(peak_of_status(status), Some(12345 << 10));
        // A thread of the kernel has none.
        assert_eq!(peak_of_status("Name:\tkthreadd\n"), None);
        assert!(peak_memory_bytes().is_some_and(|bytes| bytes > 1 << 20));
    }
}
