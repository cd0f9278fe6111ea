//! Requests to end, as flags that long work looks at: signals ask the whole
//! program, a [`Cancellation`] the threads of one rendering.
//!
//! SIGINT, SIGTERM and SIGHUP only set the flag. Loops return early if
//! [`is_requested`], and the command line discards their results: it calls [`check`]
//! between its steps, so that destructors run and remove temporary files. SIGXFSZ,
//! which would end the program when a file reaches its size limit, is ignored: the
//! write fails with an error instead.

use std::cell::RefCell;
use std::fmt;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// The number of the received signal, or 0.
static REQUESTED: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

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
    /// The exit code of a program that was stopped: 128 plus the number of the
    /// signal, as shells have it, or that of SIGTERM.
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
    /// Asks the work to end, from any thread. It ends soon, at the next pixel.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) was called.
    pub fn is_canceled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Stops the work on this thread, too, when it is canceled.
    pub fn watch_on_this_thread(&self) {
        CANCELLATION.set(Some(self.clone()));
    }
}

impl std::error::Error for Stopped {}

/// Installs the signal handlers.
///
/// # Errors
/// An error of the system.
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

/// Sets the flag, as SIGTERM does.
pub fn request() {
    let flag = REQUESTED.get_or_init(Arc::default);
    flag.store(signal_hook::consts::SIGTERM as usize, Ordering::Relaxed);
}

/// Does `work`, and `action` as soon as a signal arrives meanwhile.
///
/// # Errors
/// An error of the system, if signals cannot be watched; then `work` is not done.
#[cfg(unix)]
pub fn watching<T>(action: impl FnOnce() + Send, work: impl FnOnce() -> T) -> io::Result<T> {
    let mut signals = signal_hook::iterator::Signals::new(ENDING)?;
    let handle = signals.handle();
    Ok(std::thread::scope(|scope| {
        scope.spawn(move || {
            // A signal may have arrived before the watch began.
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

/// Whether the work on this thread should end: the program was asked to, or the
/// thread's [`Cancellation`] was. Cheap enough to ask for each pixel.
#[inline]
pub fn is_requested() -> bool {
    check().is_err()
}

/// Returns an error if [`is_requested`].
///
/// # Errors
/// Why the work should end.
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
