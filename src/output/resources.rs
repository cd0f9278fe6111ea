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

/// The most memory that the process has had at a time; `None` where nobody
/// knows.
#[cfg(unix)]
pub(super) fn peak_memory_bytes() -> Option<u64> {
    // In KiB, but for macOS, which has bytes: getrusage(2) of each.
    let unit = if cfg!(target_os = "macos") { 1 } else { 1024 };
    Some(u64::try_from(usage()?.max_rss()).ok()? * unit)
}

/// Nobody knows.
#[cfg(not(unix))]
pub(super) fn peak_memory_bytes() -> Option<u64> {
    None
}

#[cfg(unix)]
fn usage() -> Option<nix::sys::resource::Usage> {
    use nix::sys::resource::{UsageWho, getrusage};
    getrusage(UsageWho::RUSAGE_SELF).ok()
}
