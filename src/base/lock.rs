//! Locks.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks a value that no thread leaves half-written, even one that panics.
pub fn locked<T: ?Sized>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
