//! Signals that ask the program to end.
//!
//! SIGINT, SIGTERM and SIGHUP only set [`stop::SIGNAL`]. SIGXFSZ, which would end the program when
//! a file reaches its size limit, is ignored: the write fails with an error instead. A signal that
//! the program was started to ignore, as by `nohup` or in the background of a script, stays
//! ignored.

use std::fs;
use std::io;
use std::sync::{Arc, LazyLock};

use signal_hook::consts::{SIGINT, SIGTERM};

#[cfg(unix)]
use crate::start_in_scope;
use base::stop;

/// The signals that set the flag.
static HEEDED: LazyLock<Vec<i32>> = LazyLock::new(|| not_ignored(&ENDING));

#[cfg(unix)]
const ENDING: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const ENDING: [i32; 2] = [SIGINT, SIGTERM];

/// Installs the signal handlers.
///
/// # Errors
/// An error of the operating system.
pub fn listen() -> io::Result<()> {
    for &signal in &*HEEDED {
        signal_hook::flag::register_usize(signal, Arc::clone(&stop::SIGNAL), signal as usize)?;
    }
    #[cfg(unix)]
    for signal in not_ignored(&[signal_hook::consts::SIGXFSZ]) {
        signal_hook::flag::register(signal, Arc::default())?;
    }
    Ok(())
}

/// Returns the signals that the program was not started to ignore; all on systems without `/proc`.
fn not_ignored(signals: &[i32]) -> Vec<i32> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    let is_ignored = |signal: i32| mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1);
    let signals = signals.iter().copied();
    signals.filter(|&signal| !is_ignored(signal)).collect()
}

/// Runs `work`, and `action` as soon as a signal arrives meanwhile.
///
/// # Errors
/// The operating system cannot watch signals, or refuses a thread; then `work` is not run.
#[cfg(unix)]
pub fn watching<T>(action: impl FnOnce() + Send, work: impl FnOnce() -> T) -> io::Result<T> {
    let mut signals = signal_hook::iterator::Signals::new(&*HEEDED)?;
    let handle = signals.handle();
    std::thread::scope(|scope| {
        start_in_scope(scope, move || {
            // A signal may have arrived before the watch began.
            if stop::is_requested() || signals.forever().next().is_some() {
                action();
            }
        })?;
        let done = work();
        handle.close();
        Ok(done)
    })
}

/// Runs `work`; on this system, signals end the program.
#[cfg(not(unix))]
pub fn watching<T>(_: impl FnOnce() + Send, work: impl FnOnce() -> T) -> io::Result<T> {
    Ok(work())
}
