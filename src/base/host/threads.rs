//! The start of a pool's threads within the limits of the process.

use std::sync::{Arc, Barrier, RwLock};
use std::{io, thread};

use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use super::within_limits;

/// Bytes of a thread's stack.
const STACK: usize = 2 << 20;

/// Bytes of address space that a thread takes besides its stack: guard pages, thread-local data and
/// the stack for signals.
const BESIDES_STACK: u64 = 256 << 10;

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

/// Starts a thread, which waits until the gate is open; returns once it has all that it needs. A
/// thread that found no room for its signal stack would end the program without a message.
fn start(thread: ThreadBuilder, gate: Arc<RwLock<()>>) -> io::Result<()> {
    let n_needed = STACK as u64 + BESIDES_STACK;
    let n_left = within_limits();
    if n_needed > n_left {
        let [needed, left] = [n_needed, n_left].map(|n_bytes| n_bytes >> 10);
        let message = format!("{needed} KiB of memory are needed, {left} KiB are left");
        return Err(io::Error::new(io::ErrorKind::OutOfMemory, message));
    }
    let has_started = Arc::new(Barrier::new(2));
    let starts = Arc::clone(&has_started);
    thread::Builder::new().stack_size(STACK).spawn(move || {
        starts.wait();
        drop(gate.read());
        thread.run();
    })?;
    has_started.wait();
    Ok(())
}
