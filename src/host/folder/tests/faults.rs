//! Faults that tests inject into the calls that change the disk.

use std::cell::Cell;
use std::io;

/// The fault of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DiskFault {
    /// The call fails with this error, later ones do not.
    Error(i32),
    /// The call and all later ones fail with this error, as if the process were killed: none
    /// changes the disk.
    Errors(i32),
}

thread_local! {
    static PLAN: Cell<Option<(usize, DiskFault)>> = const { Cell::new(None) };
    static N_CALLS: Cell<usize> = const { Cell::new(0) };
}

/// Runs `work` and injects the fault into the call with this number; also returns the number of
/// calls.
pub(super) fn with<T>(number: usize, fault: DiskFault, work: impl FnOnce() -> T) -> (T, usize) {
    N_CALLS.set(0);
    PLAN.set(Some((number, fault)));
    let done = work();
    PLAN.set(None);
    (done, N_CALLS.get())
}

/// Counts a call, and returns its fault.
pub(in crate::folder) fn fault() -> io::Result<()> {
    let Some((number, fault)) = PLAN.get() else {
        return Ok(());
    };
    let n = N_CALLS.get();
    N_CALLS.set(n + 1);
    match fault {
        DiskFault::Error(code) if n == number => Err(io::Error::from_raw_os_error(code)),
        DiskFault::Errors(code) if n >= number => Err(io::Error::from_raw_os_error(code)),
        _ => Ok(()),
    }
}
