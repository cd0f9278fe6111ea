//! Limits the size of a page by showing fewer pixels.

use std::io::{self, Write};

use super::Page;
use super::frame::MAX_PIXELS;
use base::numbers::bytes;
use host::text::Diagnostic;
use output::results::Results;

/// Least number of pixels that are tried: fewer would not show the picture.
const MIN_PIXELS: u64 = 16 * 16;
/// The share of the budget that the next attempt aims at: fewer pixels are less similar to their
/// neighbors, so each takes more bytes.
const AIM: f64 = 0.97;

impl Page {
    /// Reads the content of a page, with the most pixels that fit into `max_bytes`.
    ///
    /// # Errors
    /// As for [`Page::new`], or if even the smallest page has more bytes.
    pub fn within(max_bytes: u64, results: &Results) -> Result<Self, Diagnostic> {
        let mut n_pixels = MAX_PIXELS;
        loop {
            let page = Self::read_at_most(n_pixels, results)?;
            let n_bytes = page.n_bytes();
            if n_bytes <= max_bytes {
                return Ok(page);
            }
            if n_pixels <= MIN_PIXELS {
                return Err(too_small(max_bytes, n_bytes));
            }
            let n_others = n_bytes - page.n_pixel_bytes;
            let share = max_bytes.saturating_sub(n_others) as f64 / page.n_pixel_bytes as f64;
            n_pixels = ((page.n_pixels as f64 * share * AIM) as u64).max(MIN_PIXELS);
        }
    }

    /// Returns the length of the page in bytes.
    fn n_bytes(&self) -> u64 {
        let mut counter = ByteCounter(0);
        self.write(&mut counter)
            .expect("counting bytes cannot fail");
        counter.0
    }
}

fn too_small(max_bytes: u64, n_bytes: u64) -> Diagnostic {
    let [wanted, needed] = [max_bytes, n_bytes].map(bytes);
    let message = format!("no page of this output has at most {wanted}: the smallest has {needed}");
    // Rounded up, so that the advice works.
    let advised = (n_bytes as f64 / 1e4).ceil() / 100.0;
    Diagnostic::new(message).with_help(format!("give `--max-mb {advised}` or more"))
}

/// A writer that only counts bytes.
struct ByteCounter(u64);

impl Write for ByteCounter {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0 += buffer.len() as u64;
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
