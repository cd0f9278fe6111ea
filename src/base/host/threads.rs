//! The start of a pool's threads within the limits of the process.

use std::{io, thread};

use super::within_limits;

/// Bytes of a thread's stack.
const STACK: usize = 2 << 20;

/// Bytes of address space that a thread takes besides its stack: guard pages, thread-local data and
/// the stack for signals.
const BESIDES_STACK: u64 = 256 << 10;

/// Starts a thread of a pool, if the limits of the process (`ulimit -v`) leave room for all that it
/// and the threads before it need: a thread that finds no room for its signal stack ends the
/// program without a message.
///
/// # Errors
/// The memory that is left is not enough, or the system refuses the thread.
pub fn spawn_one_of_pool(thread: rayon::ThreadBuilder) -> io::Result<()> {
    // The threads before this one may not have taken theirs yet.
    let n_needed = STACK as u64 + (thread.index() as u64 + 1) * BESIDES_STACK;
    let n_left = within_limits();
    if n_needed > n_left {
        let [needed, left] = [n_needed, n_left].map(|n_bytes| n_bytes >> 10);
        let message = format!("{needed} KiB of memory are needed, {left} KiB are left");
        return Err(io::Error::new(io::ErrorKind::OutOfMemory, message));
    }
    let builder = thread::Builder::new().stack_size(STACK);
    builder.spawn(|| thread.run()).map(drop)
}
