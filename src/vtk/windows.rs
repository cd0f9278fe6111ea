//! The bytes of an array, a window at a time: a thread generates the next window while the last one
//! is written.

use std::io::{self, Write};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::thread;

use crate::array::Array;
use host::start_in_scope;

/// Number of windows in memory: one is filled while another is written.
pub(super) const N_WINDOWS: usize = 2;

/// Calls `consume` with all bytes of an array in windows of `size` bytes, the last one of what is
/// left. Short arrays take one window and no thread.
///
/// # Errors
/// The array has the wrong length, `consume` fails, or the system refuses the thread.
pub(super) fn for_each(
    array: &Array,
    size: usize,
    mut consume: impl FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    if array.n_bytes <= size as u64 {
        let mut window = Vec::with_capacity(array.n_bytes as usize);
        array.write_to(&mut window)?;
        return consume(&window);
    }
    let (to_filler, empty) = mpsc::channel();
    let (to_consumer, full) = mpsc::sync_channel(N_WINDOWS);
    for _ in 0..N_WINDOWS {
        let _ = to_filler.send(Vec::with_capacity(size));
    }
    thread::scope(|scope| {
        let filler = start_in_scope(scope, || Filler::fill(array, size, empty, to_consumer))?;
        let consumed = consume_all(full, to_filler, &mut consume);
        // The filler stops where it fails to get a window, whose error says less.
        let filled = filler
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        consumed.and(filled)
    })
}

/// Consumes windows until there are no more or one fails, and gives them back.
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
struct Filler {
    size: usize,
    window: Vec<u8>,
    empty: Receiver<Vec<u8>>,
    to_consumer: SyncSender<Vec<u8>>,
}

impl Filler {
    fn fill(
        array: &Array,
        size: usize,
        empty: Receiver<Vec<u8>>,
        to_consumer: SyncSender<Vec<u8>>,
    ) -> io::Result<()> {
        let window = empty.recv().map_err(io::Error::other)?;
        let mut filler = Self {
            size,
            window,
            empty,
            to_consumer,
        };
        array.write_to(&mut filler)?;
        filler.send()
    }

    fn send(&mut self) -> io::Result<()> {
        let full = std::mem::take(&mut self.window);
        self.to_consumer.send(full).map_err(io::Error::other)
    }
}

impl Write for Filler {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.window.len() == self.size {
            self.send()?;
            self.window = self.empty.recv().map_err(io::Error::other)?;
        }
        let n = bytes.len().min(self.size - self.window.len());
        self.window.extend_from_slice(&bytes[..n]);
        Ok(n)
    }

    /// Does nothing: only full windows are sent.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_have_all_bytes_in_their_order() {
        for n in [0, 1, 4, 5, 8, 1000, 1003] {
            let array = Array::new("bytes", n, || (0..n).map(|i| i as u8));
            let mut lengths = Vec::new();
            let mut all = Vec::new();
            for_each(&array, 4, |window| {
                lengths.push(window.len());
                all.extend_from_slice(window);
                Ok(())
            })
            .unwrap();
            assert!(all.iter().enumerate().all(|(i, byte)| *byte == i as u8));
            assert_eq!(all.len(), n);
            let last = lengths.pop().unwrap();
            assert!(lengths.iter().all(|length| *length == 4) && last <= 4);
        }
    }

    #[test]
    fn the_first_error_ends_both_threads() {
        let array = Array::new("bytes", 1 << 20, || std::iter::repeat_n(1_u8, 1 << 20));
        let mut n = 0;
        let error = for_each(&array, 1 << 10, |_| {
            n += 1;
            if n < 7 {
                Ok(())
            } else {
                Err(io::Error::other("full"))
            }
        })
        .unwrap_err();
        assert_eq!((n, error.to_string().as_str()), (7, "full"));
        // A wrong length.
        let array = Array {
            n_bytes: 1 << 21,
            ..array
        };
        let error = for_each(&array, 1 << 10, |_| Ok(())).unwrap_err();
        let expected = "bytes: 1048576 bytes instead of 2097152";
        assert_eq!(error.to_string(), expected);
    }
}
