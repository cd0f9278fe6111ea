//! The CPUs on which threads may run.

use std::io;

/// Returns the CPUs on which the calling thread may run, in ascending order.
///
/// # Errors
/// The system does not report them: all but Linux.
#[cfg(target_os = "linux")]
pub fn allowed_cpus() -> io::Result<Vec<usize>> {
    use rustix::thread::{CpuSet, sched_getaffinity};
    let set = sched_getaffinity(None)?;
    Ok((0..CpuSet::MAX_CPU)
        .filter(|&cpu| set.is_set(cpu))
        .collect())
}

/// Restricts the calling thread to one CPU.
///
/// # Errors
/// The system refuses, or is not Linux.
#[cfg(target_os = "linux")]
pub fn pin_to_cpu(cpu: usize) -> io::Result<()> {
    use rustix::thread::{CpuSet, sched_setaffinity};
    let mut set = CpuSet::new();
    set.set(cpu);
    Ok(sched_setaffinity(None, &set)?)
}

/// Returns an error: this system does not report on which CPUs threads may run.
///
/// # Errors
/// Always.
#[cfg(not(target_os = "linux"))]
pub fn allowed_cpus() -> io::Result<Vec<usize>> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Returns an error: this system does not restrict threads to CPUs.
///
/// # Errors
/// Always.
#[cfg(not(target_os = "linux"))]
pub fn pin_to_cpu(_: usize) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Returns the CPUs on which each thread of the current rayon pool may run, as Linux lists them,
/// such as `0-3,8`; `None` where the system does not report them.
pub fn of_threads() -> Vec<Option<String>> {
    rayon::broadcast(|_| allowed_cpus().ok().map(|cpus| cpu_list(&cpus)))
}

/// Returns the CPUs on which the calling thread may run, one of each core before the second
/// hardware threads of any.
///
/// # Errors
/// The system does not report them: all but Linux.
pub fn cpus_by_core() -> io::Result<Vec<usize>> {
    let mut cpus = allowed_cpus()?;
    let rank = |&cpu: &usize| {
        let siblings = read_siblings(cpu).unwrap_or_default();
        siblings.iter().filter(|&&other| other < cpu).count()
    };
    // The sort is stable: CPUs of the same rank keep their order.
    cpus.sort_by_key(rank);
    Ok(cpus)
}

/// Returns the hardware threads of a CPU's core; `None` if the system does not report them.
fn read_siblings(cpu: usize) -> Option<Vec<usize>> {
    let file = format!("/sys/devices/system/cpu/cpu{cpu}/topology/thread_siblings_list");
    parse_cpu_list(&std::fs::read_to_string(file).ok()?)
}

/// Parses a list of CPUs as Linux writes it, such as `0-3,8`; `None` if it is none.
pub fn parse_cpu_list(text: &str) -> Option<Vec<usize>> {
    let mut cpus = Vec::new();
    for range in text.trim().split(',') {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        cpus.extend(first.parse::<usize>().ok()?..=last.parse().ok()?);
    }
    Some(cpus)
}

/// Formats CPUs, in ascending order, as Linux does: `0-3,8`.
pub fn cpu_list(cpus: &[usize]) -> String {
    let runs = cpus.chunk_by(|a, b| a + 1 == *b);
    let text = |run: &[usize]| match run {
        [only] => only.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    };
    runs.map(text).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_of_cpus_is_read_as_it_is_written() {
        for text in ["0", "0-1", "0-3,8", "2,4,6-7"] {
            assert_eq!(cpu_list(&parse_cpu_list(text).unwrap()), text);
        }
        assert_eq!(parse_cpu_list("0-"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_pinned_thread_may_run_on_its_cpu_only() {
        for cpu in cpus_by_core().unwrap() {
            let pinned = std::thread::spawn(move || {
                pin_to_cpu(cpu).unwrap();
                allowed_cpus().unwrap()
            });
            assert_eq!(pinned.join().unwrap(), [cpu]);
        }
    }
}
