//! The start of threads within the limits of the process.

use std::sync::{Arc, Barrier, RwLock};
use std::thread::{Builder, JoinHandle, Scope, ScopedJoinHandle, available_parallelism};
use std::{env, io};

use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::memory::within_limits;

/// Bytes of a thread's stack.
const STACK: usize = 2 << 20;

/// Bytes of address space that a thread takes besides its stack: guard pages, thread-local data and
/// the stack for signals.
const BESIDES_STACK: u64 = 256 << 10;

/// Bytes that are left when the last thread has started: the threads before it still allocate their
/// queues, and a refusal is reported.
const RESERVE: u64 = 16 << 20;

/// Starts a pool of threads, each of which first calls `begin`; `None` for one per processor. No
/// thread looks for work before all have started: threads that find none would take the time that
/// the others need to start.
///
/// # Errors
/// The limits of the process (`ulimit -v`) leave too little memory, or the system refuses a thread.
pub fn start_threads(
    n_threads: Option<u16>,
    begin: impl Fn() + Send + Sync + 'static,
) -> Result<ThreadPool, ThreadPoolBuildError> {
    let gate = Arc::new(RwLock::new(()));
    let closed = gate.write();
    let pool = ThreadPoolBuilder::new()
        .num_threads(n_threads.map_or(0, usize::from))
        .start_handler(move |_| begin())
        .spawn_handler(|thread| start(thread, Arc::clone(&gate)))
        .build();
    drop(closed);
    pool
}

/// Returns the number of threads that rayon gives to a pool by default: `RAYON_NUM_THREADS`, or one
/// per processor. A pool for the sake of its number would take threads, and leave them behind for a
/// moment.
pub fn default_threads() -> usize {
    let variable = env::var("RAYON_NUM_THREADS").ok();
    let given = variable.and_then(|text| text.parse().ok());
    let given = given.filter(|&n_threads| n_threads > 0);
    given.unwrap_or_else(|| available_parallelism().map_or(1, usize::from))
}

/// Starts a thread that ends before its scope.
///
/// # Errors
/// The reasons of [`start_threads`], after "cannot start a thread".
pub fn start_in_scope<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> io::Result<ScopedJoinHandle<'scope, T>> {
    let thread = builder().and_then(|builder| builder.spawn_scoped(scope, work));
    thread.map_err(|error| refused(&error))
}

/// Starts a thread that may outlive its caller.
///
/// # Errors
/// The errors of [`start_in_scope`].
pub fn start_detached(work: impl FnOnce() + Send + 'static) -> io::Result<JoinHandle<()>> {
    let thread = builder().and_then(|builder| builder.spawn(work));
    thread.map_err(|error| refused(&error))
}

fn refused(error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("cannot start a thread: {error}"))
}

/// Starts a thread, which waits until the gate is open; returns once it has all that it needs.
fn start(thread: ThreadBuilder, gate: Arc<RwLock<()>>) -> io::Result<()> {
    let has_started = Arc::new(Barrier::new(2));
    let starts = Arc::clone(&has_started);
    builder()?.spawn(move || {
        starts.wait();
        drop(gate.read());
        thread.run();
    })?;
    has_started.wait();
    Ok(())
}

/// Returns the builder of a thread for which there is memory. A thread that found no room for its
/// signal stack would end the program without a message.
fn builder() -> io::Result<Builder> {
    let n_needed = STACK as u64 + BESIDES_STACK + RESERVE;
    let n_left = within_limits();
    if n_needed > n_left {
        let [needed, left] = [n_needed, n_left].map(|n_bytes| n_bytes >> 10);
        let message = format!("{needed} KiB of memory are needed, {left} KiB are left");
        return Err(io::Error::new(io::ErrorKind::OutOfMemory, message));
    }
    Ok(Builder::new().stack_size(STACK))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_number_is_that_of_a_pool() {
        let pool = start_threads(None, || {}).unwrap();
        assert_eq!(pool.current_num_threads(), default_threads());
    }
}
