//! A page that keeps to a number of bytes: fewer pixels until it does.

use std::io::{self, Write};

use super::View;
use super::frame::MAX_PIXELS;
use crate::results::Results;
use crate::text::Diagnostic;
use crate::text::numbers::bytes;

/// Fewer pixels show nothing.
const MIN_PIXELS: u64 = 16 * 16;
/// Part of the room that the next attempt aims at: fewer pixels are less like
/// their neighbors, and take more bytes each.
const AIM: f64 = 0.97;

impl View {
    /// Reads what the page shows, thinned out until the page has at most
    /// `max_bytes`.
    ///
    /// # Errors
    /// As [`View::of`]; and if even a few pixels take more.
    pub fn within(max_bytes: u64, results: &Results) -> Result<Self, Diagnostic> {
        let mut n_pixels = MAX_PIXELS;
        loop {
            let view = Self::of_at_most(n_pixels, results)?;
            let n_bytes = view.n_bytes();
            if n_bytes <= max_bytes {
                return Ok(view);
            }
            if n_pixels <= MIN_PIXELS {
                return Err(too_small(max_bytes, n_bytes));
            }
            let n_others = n_bytes - view.n_pixel_bytes;
            let share = max_bytes.saturating_sub(n_others) as f64 / view.n_pixel_bytes as f64;
            n_pixels = ((view.n_pixels as f64 * share * AIM) as u64).max(MIN_PIXELS);
        }
    }

    /// How long the page is.
    fn n_bytes(&self) -> u64 {
        let mut counter = Counter(0);
        self.write(&mut counter)
            .expect("counting bytes cannot fail");
        counter.0
    }
}

fn too_small(max_bytes: u64, n_bytes: u64) -> Diagnostic {
    let [wanted, needed] = [max_bytes, n_bytes].map(bytes);
    let message = format!("no page of this output has at most {wanted}: the smallest has {needed}");
    // Rounded up, so that what is advised works.
    let advised = (n_bytes as f64 / 1e4).ceil() / 100.0;
    Diagnostic::new(message).with_help(format!("give `--max-mb {advised}` or more"))
}

/// Takes all that is written and keeps its length.
struct Counter(u64);

impl Write for Counter {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0 += buffer.len() as u64;
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
