//! The memory that the program may use.

use std::path::Path;
use std::sync::OnceLock;

use sysinfo::System;

use crate::cgroup;

/// The limit that the user has set, in bytes.
static LIMIT: OnceLock<u64> = OnceLock::new();

/// Limits what [`available_memory`] returns from now on, so that the program uses at most this many
/// bytes. Only the first limit counts.
pub fn limit_memory(n_bytes: u64) {
    let _ = LIMIT.set(n_bytes);
}

/// Returns the limit that the user has set, in bytes.
pub fn memory_limit() -> Option<u64> {
    LIMIT.get().copied()
}

/// Returns the memory available to the program in bytes: the minimum of the free memory of the
/// machine, the rest of the process's limits (`ulimit -v` and `-d`), the rest of the limits of its
/// control groups, and the rest of [the user's limit](limit_memory). `u64::MAX` if there is no
/// limit.
pub fn available_memory() -> u64 {
    let mut system = System::new();
    system.refresh_memory();
    let of_machine = match system.available_memory() {
        0 => u64::MAX,
        n_bytes => n_bytes,
    };
    let own = memory_limit().map(|limit| limit.saturating_sub(resident_memory().unwrap_or(0)));
    of_machine
        .min(within_limits())
        .min(within_groups())
        .min(own.unwrap_or(u64::MAX))
}

/// Returns the bytes available within the process's own limits.
#[cfg(unix)]
pub(crate) fn within_limits() -> u64 {
    use nix::sys::resource::{Resource, getrlimit};
    let n_used = bytes_in_use();
    let left = |(resource, n_used): (Resource, u64)| {
        let (limit, _) = getrlimit(resource).ok()?;
        Some(limit.saturating_sub(n_used))
    };
    let limits = [Resource::RLIMIT_AS, Resource::RLIMIT_DATA];
    let left = limits.into_iter().zip(n_used).filter_map(left);
    left.min().unwrap_or(u64::MAX)
}

/// Returns `u64::MAX`: other systems have no such limits.
#[cfg(not(unix))]
pub(crate) fn within_limits() -> u64 {
    u64::MAX
}

/// Returns the resident memory of this process in bytes; `None` if the system does not
/// report it.
pub fn resident_memory() -> Option<u64> {
    let [resident] = bytes_of_status(["VmRSS:"]);
    resident
}

/// Returns the bytes of address space, and of data and stack within it, that the
/// process uses; 0 if the system does not report them.
#[cfg(unix)]
fn bytes_in_use() -> [u64; 2] {
    let [size, data, stack] = bytes_of_status(["VmSize:", "VmData:", "VmStk:"]);
    [size.unwrap_or(0), data.unwrap_or(0) + stack.unwrap_or(0)]
}

/// Returns values of `/proc/self/status` in bytes, as proc_pid_status(5) describes them; `None` for
/// values that the system does not report.
pub fn bytes_of_status<const N: usize>(keys: [&str; N]) -> [Option<u64>; N] {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    keys.map(|key| {
        let line = status.lines().find_map(|line| line.strip_prefix(key))?;
        let kib: u64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
        Some(kib << 10)
    })
}

/// Returns the bytes available within the limits of the process's control groups.
fn within_groups() -> u64 {
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    cgroup::free(Path::new("/sys/fs/cgroup"), &groups).unwrap_or(u64::MAX)
}
