//! The operating system: available memory, the end of the program if an allocation
//! fails, and advice on other errors.

mod advice;
mod allocator;
mod cgroup;

use std::path::Path;

use sysinfo::System;

pub use advice::advice;
pub use allocator::{Allocator, may_fail};

/// Returns the memory available to the program in bytes: the least of the free memory
/// of the machine, the rest of the process's limits (`ulimit -v` and `-d`), and the
/// rest of the limits of its control groups. `u64::MAX` if the system reports none.
pub fn available_memory() -> u64 {
    let mut system = System::new();
    system.refresh_memory();
    let of_machine = match system.available_memory() {
        0 => u64::MAX,
        n_bytes => n_bytes,
    };
    of_machine.min(within_limits()).min(within_groups())
}

/// Returns the bytes available within the process's own limits.
#[cfg(unix)]
fn within_limits() -> u64 {
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

/// Returns no limit: other systems have none.
#[cfg(not(unix))]
fn within_limits() -> u64 {
    u64::MAX
}

/// Returns the bytes of address space, and of data and stack within it, that the
/// process uses; 0 if the system does not report them.
#[cfg(unix)]
fn bytes_in_use() -> [u64; 2] {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let of = |key: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(key))?;
        let kib: u64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
        Some(kib << 10)
    };
    [
        of("VmSize:").unwrap_or(0),
        of("VmData:").unwrap_or(0) + of("VmStk:").unwrap_or(0),
    ]
}

/// Returns the bytes available within the limits of the process's control groups.
fn within_groups() -> u64 {
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    cgroup::free(Path::new("/sys/fs/cgroup"), &groups).unwrap_or(u64::MAX)
}
