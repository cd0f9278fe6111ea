//! Signals that ask the program to end, as flags that long work looks at.
//!
//! SIGINT, SIGTERM and SIGHUP set a flag and do nothing else. Loops leave early
//! when [`is_requested`] says so, and what they return is thrown away: the
//! command line asks [`check`] between its steps, so that destructors run,
//! temporary files go, and nothing is left half done. SIGXFSZ, which would end
//! the program where a file reaches its limit, does nothing: the write fails
//! with an error instead.

use std::fmt;
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// The number of the signal that asked, or 0.
static REQUESTED: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// The program was asked to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopped {
    signal: usize,
}

impl Stopped {
    /// The exit code of a program that a signal ended, as shells have it: 128
    /// and the signal's number.
    pub fn exit_code(self) -> u8 {
        (128 + self.signal) as u8
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stopped by signal {}", self.signal)
    }
}

impl std::error::Error for Stopped {}

/// Makes signals set the flag from now on.
///
/// # Errors
/// What the system says.
pub fn listen() -> io::Result<()> {
    let flag = REQUESTED.get_or_init(Arc::default);
    for signal in ENDING {
        let number = signal as usize;
        signal_hook::flag::register_usize(signal, Arc::clone(flag), number)?;
    }
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default())?;
    Ok(())
}

#[cfg(unix)]
const ENDING: [i32; 3] = [
    signal_hook::consts::SIGINT,
    signal_hook::consts::SIGTERM,
    signal_hook::consts::SIGHUP,
];
#[cfg(not(unix))]
const ENDING: [i32; 2] = [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM];

/// Sets the flag as SIGTERM does.
pub fn request() {
    let flag = REQUESTED.get_or_init(Arc::default);
    flag.store(signal_hook::consts::SIGTERM as usize, Ordering::Relaxed);
}

/// Does `work`, and `action` as soon as the program is asked to end meanwhile.
///
/// # Errors
/// What the system says where it cannot watch; then nothing is done.
#[cfg(unix)]
pub fn watching<T>(action: impl FnOnce() + Send, work: impl FnOnce() -> T) -> io::Result<T> {
    let mut signals = signal_hook::iterator::Signals::new(ENDING)?;
    let handle = signals.handle();
    Ok(std::thread::scope(|scope| {
        scope.spawn(move || {
            // A signal may have come before anyone watched.
            if is_requested() || signals.forever().next().is_some() {
                action();
            }
        });
        let done = work();
        handle.close();
        done
    }))
}

/// Does `work`: signals end the program here.
#[cfg(not(unix))]
pub fn watching<T>(_: impl FnOnce() + Send, work: impl FnOnce() -> T) -> io::Result<T> {
    Ok(work())
}

/// Whether the program was asked to end. Cheap: one relaxed load.
#[inline]
pub fn is_requested() -> bool {
    check().is_err()
}

/// Leads out of a function if the program was asked to end.
///
/// # Errors
/// If so.
#[inline]
pub fn check() -> Result<(), Stopped> {
    match REQUESTED.get().map(|flag| flag.load(Ordering::Relaxed)) {
        None | Some(0) => Ok(()),
        Some(signal) => Err(Stopped { signal }),
    }
}
