//! Requests to stop, as flags that long work polls: signals stop the whole program, a
//! [`Cancellation`] the threads of one rendering.
//!
//! SIGINT, SIGTERM and SIGHUP only set the flag. Loops return early if [`is_requested`], and the
//! command line discards their results: it calls [`check`] between its steps, so that destructors
//! run and remove temporary files. SIGXFSZ, which would end the program when a file reaches its
//! size limit, is ignored: the write fails with an error instead. A signal that the program was
//! started to ignore, as by `nohup` or in the background of a script, stays ignored.

use std::cell::RefCell;
use std::fmt;
use std::fs;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

#[cfg(unix)]
use crate::host::start_in_scope;

/// The number of the received signal, or 0.
static REQUESTED: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// The signals that set it.
static HEEDED: OnceLock<Vec<i32>> = OnceLock::new();

thread_local! {
    /// The cancellation that the work on this thread obeys.
    static CANCELLATION: RefCell<Option<Cancellation>> = const { RefCell::new(None) };
}

/// Why work was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stopped {
    /// A signal with this number.
    Signal(usize),
    /// A [`Cancellation`].
    Canceled,
}

impl Stopped {
    /// Returns the exit code of a stopped program: 128 plus the signal number, by the convention of
    /// shells, or SIGTERM's for a cancellation.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Signal(number) => (128 + number) as u8,
            Self::Canceled => 128 + signal_hook::consts::SIGTERM as u8,
        }
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Signal(number) => write!(f, "stopped by signal {number}"),
            Self::Canceled => write!(f, "canceled"),
        }
    }
}

/// Stops the work of some threads. Clones cancel the same work.
#[derive(Debug, Clone, Default)]
pub struct Cancellation(Arc<AtomicBool>);

impl Cancellation {
    /// Asks the work to end, from any thread. It ends at the next pixel.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns true if [`cancel`](Self::cancel) was called.
    pub fn is_canceled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Makes the work on this thread stop too when this is canceled.
    pub fn watch_on_this_thread(&self) {
        CANCELLATION.set(Some(self.clone()));
    }
}

impl std::error::Error for Stopped {}

/// Installs the signal handlers.
///
/// # Errors
/// An error of the operating system.
pub fn listen() -> io::Result<()> {
    let flag = REQUESTED.get_or_init(Arc::default);
    let heeded = HEEDED.get_or_init(|| not_ignored(&ENDING));
    for &signal in heeded {
        signal_hook::flag::register_usize(signal, Arc::clone(flag), signal as usize)?;
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

#[cfg(unix)]
const ENDING: [i32; 3] = [
    signal_hook::consts::SIGINT,
    signal_hook::consts::SIGTERM,
    signal_hook::consts::SIGHUP,
];
#[cfg(not(unix))]
const ENDING: [i32; 2] = [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM];

/// Sets the flag, as SIGTERM does.
pub fn request() {
    let flag = REQUESTED.get_or_init(Arc::default);
    flag.store(signal_hook::consts::SIGTERM as usize, Ordering::Relaxed);
}

/// Runs `work`, and `action` as soon as a signal arrives meanwhile.
///
/// # Errors
/// The operating system cannot watch signals, or refuses a thread; then `work` is not run.
#[cfg(unix)]
pub fn watching<T>(action: impl FnOnce() + Send, work: impl FnOnce() -> T) -> io::Result<T> {
    let heeded = HEEDED.get_or_init(|| not_ignored(&ENDING));
    let mut signals = signal_hook::iterator::Signals::new(heeded)?;
    let handle = signals.handle();
    std::thread::scope(|scope| {
        start_in_scope(scope, move || {
            // A signal may have arrived before the watch began.
            if is_requested() || signals.forever().next().is_some() {
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

/// Returns true if the work on this thread should end: the program or the thread's [`Cancellation`]
/// was asked to. Cheap enough to call for each pixel.
#[inline]
pub fn is_requested() -> bool {
    check().is_err()
}

/// Returns an error if [`is_requested`].
///
/// # Errors
/// The reason to end.
#[inline]
pub fn check() -> Result<(), Stopped> {
    match REQUESTED.get().map(|flag| flag.load(Ordering::Relaxed)) {
        None | Some(0) => {}
        Some(signal) => return Err(Stopped::Signal(signal)),
    }
    let is_canceled = |cancellation: &Cancellation| cancellation.is_canceled();
    if CANCELLATION.with_borrow(|cancellation| cancellation.as_ref().is_some_and(is_canceled)) {
        return Err(Stopped::Canceled);
    }
    Ok(())
}
