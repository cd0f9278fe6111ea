//! The bytes of an array, a window at a time: a thread generates the next window while the last one
//! is written.

use std::io::{self, Write};
use std::mem;
use std::panic::resume_unwind;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;

use crate::array::Array;
use host::affinity::allowed_cpus;
use host::start_in_scope;

/// Number of windows in memory: one is filled while another is written.
pub(super) const N_WINDOWS: usize = 2;

/// Calls `consume` with all bytes of an array in windows of `size` bytes; the last one may be shorter.
/// Starts no thread outside of a pool, in a pool of fewer than `least_threads`, on a thread that may run
/// on one CPU, or for an array of one window.
///
/// # Errors
/// The array has the wrong length, or `consume` fails.
pub(super) fn for_each(
    array: &Array,
    size: usize,
    least_threads: usize,
    mut consume: impl FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    if array.n_bytes <= size as u64 || !has_room(least_threads) {
        return consume_while_filling(array, size, &mut consume);
    }
    let (to_filler, empty) = mpsc::channel();
    let (to_consumer, full) = mpsc::channel();
    for _ in 1..N_WINDOWS {
        let _ = to_filler.send(Vec::with_capacity(size));
    }
    let exchange = move |window: Vec<u8>| {
        to_consumer.send(window).map_err(io::Error::other)?;
        empty.recv().map_err(io::Error::other)
    };
    thread::scope(|scope| {
        let fill = move || Windows::fill(array, size, exchange);
        let Ok(filler) = start_in_scope(scope, fill) else {
            // The system refuses the thread: work without it.
            return consume_while_filling(array, size, &mut consume);
        };
        let consumed = consume_all(full, to_filler, &mut consume);
        let filled = filler.join().unwrap_or_else(|panic| resume_unwind(panic));
        // If `consume` has failed, the filler's error only follows from that.
        consumed.and(filled)
    })
}

/// Returns true in a pool of at least this many threads, unless another thread would run on the same CPU.
fn has_room(least_threads: usize) -> bool {
    // Outside of a pool, asking for its threads would start one.
    let is_in_pool = rayon::current_thread_index().is_some();
    let is_pinned = || allowed_cpus().is_ok_and(|cpus| cpus.len() == 1);
    is_in_pool && rayon::current_num_threads() >= least_threads && !is_pinned()
}

/// Consumes each window on the thread that has filled it.
fn consume_while_filling(
    array: &Array,
    size: usize,
    consume: &mut impl FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    Windows::fill(array, size, |mut window| {
        consume(&window)?;
        window.clear();
        Ok(window)
    })
}

/// Consumes windows up to the last one or the first error, and gives them back.
fn consume_all(
    full: Receiver<Vec<u8>>,
    to_filler: Sender<Vec<u8>>,
    consume: &mut impl FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    for mut window in full {
        consume(&window)?;
        window.clear();
        let _ = to_filler.send(window);
    }
    Ok(())
}

/// Fills windows with bytes.
struct Windows<E> {
    size: usize,
    window: Vec<u8>,
    /// Takes a full window, and returns an empty one.
    exchange: E,
}

impl<E: FnMut(Vec<u8>) -> io::Result<Vec<u8>>> Windows<E> {
    /// Fills windows with the bytes of an array.
    fn fill(array: &Array, size: usize, exchange: E) -> io::Result<()> {
        let most = usize::try_from(array.n_bytes).unwrap_or(usize::MAX);
        let mut windows = Self {
            size,
            window: Vec::with_capacity(size.min(most)),
            exchange,
        };
        array.write_to(&mut windows)?;
        windows.exchange()
    }

    fn exchange(&mut self) -> io::Result<()> {
        self.window = (self.exchange)(mem::take(&mut self.window))?;
        Ok(())
    }
}

impl<E: FnMut(Vec<u8>) -> io::Result<Vec<u8>>> Write for Windows<E> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.window.len() == self.size {
            self.exchange()?;
        }
        let n = bytes.len().min(self.size - self.window.len());
        self.window.extend_from_slice(&bytes[..n]);
        Ok(n)
    }

    /// Does nothing: only full windows are exchanged.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::panic::catch_unwind;

    use super::*;

    /// Calls a function in a pool of this many threads.
    fn with_threads<T: Send>(n_threads: usize, work: impl FnOnce() -> T + Send) -> T {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        pool.build().unwrap().install(work)
    }

    #[test]
    fn windows_have_all_bytes_in_their_order() {
        for (n, n_threads) in [0, 1, 4, 5, 8, 1000, 1003]
            .into_iter()
            .flat_map(|n| [(n, 1), (n, 2)])
        {
            let windows = with_threads(n_threads, || {
                let array = Array::new("bytes", n, || (0..n).map(|i| i as u8));
                let mut windows = Vec::new();
                for_each(&array, 4, 2, |window| {
                    windows.push(window.to_vec());
                    Ok(())
                })
                .unwrap();
                windows
            });
            let all = windows.concat();
            assert!(all.iter().enumerate().all(|(i, byte)| *byte == i as u8));
            assert_eq!(all.len(), n);
            let (last, others) = windows.split_last().unwrap();
            assert!(others.iter().all(|window| window.len() == 4) && last.len() <= 4);
        }
    }

    #[test]
    fn a_panic_of_either_thread_reaches_the_caller() {
        for is_of_consumer in [false, true] {
            let result = catch_unwind(|| {
                with_threads(2, || {
                    let array = Array::new("bytes", 1 << 20, || {
                        (0..1 << 20).map(|i: u32| {
                            assert!(is_of_consumer || i < 100_000);
                            i as u8
                        })
                    });
                    let mut n = 0;
                    let _ = for_each(&array, 1 << 10, 2, |_| {
                        n += 1;
                        assert!(!is_of_consumer || n < 7);
                        Ok(())
                    });
                });
            });
            assert!(result.is_err());
        }
    }

    #[test]
    fn the_first_error_ends_both_threads() {
        let written = |n_threads, n_bytes, n_good: u32| {
            with_threads(n_threads, || {
                let array = Array {
                    n_bytes,
                    ..Array::new("bytes", 1 << 20, || std::iter::repeat_n(1_u8, 1 << 20))
                };
                let mut n = 0;
                let error = for_each(&array, 1 << 10, 2, |_| {
                    n += 1;
                    if n <= n_good {
                        Ok(())
                    } else {
                        Err(io::Error::other("full"))
                    }
                });
                error.unwrap_err().to_string()
            })
        };
        for n_threads in [1, 2] {
            assert_eq!(written(n_threads, 1 << 20, 7), "full");
            let wrong_length = "bytes: 1048576 bytes instead of 2097152";
            assert_eq!(written(n_threads, 1 << 21, 1 << 20), wrong_length);
        }
    }
}
