//! Requests to stop, as flags that long work polls: signals stop the whole program, a
//! [`Cancellation`] the threads of one rendering.
//!
//! Loops return early if [`is_requested`], and the command line discards their results: it calls
//! [`check`] between its steps, so that destructors run and remove temporary files.

use std::cell::RefCell;
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

/// The number of the received signal, which stops the whole program; or 0.
pub static SIGNAL: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// The number of the signal that asks a program to end, on all systems.
const SIGTERM: usize = 15;

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
            Self::Canceled => (128 + SIGTERM) as u8,
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

/// Sets the flag, as SIGTERM does.
pub fn request() {
    SIGNAL.store(SIGTERM, Ordering::Relaxed);
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
    match SIGNAL.load(Ordering::Relaxed) {
        0 => {}
        signal => return Err(Stopped::Signal(signal)),
    }
    let is_canceled = |cancellation: &Cancellation| cancellation.is_canceled();
    if CANCELLATION.with_borrow(|cancellation| cancellation.as_ref().is_some_and(is_canceled)) {
        return Err(Stopped::Canceled);
    }
    Ok(())
}
