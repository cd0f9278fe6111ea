//! The breakdown of the threads' time.

use serde::Serialize;

use super::Rendering;

/// The busy time of the threads over all renderings, in nanoseconds, and its
/// parts, which sum to `busy_ns`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Accounts {
    /// Time from the start to the end of each tile.
    pub busy_ns: f64,
    /// The pixels' own times.
    pub pixels_ns: f64,
    /// One reading of the clock per pixel, at the measured cost of a reading.
    pub clock_ns: f64,
    /// Writing pixels to the film.
    pub film_ns: f64,
    /// Rendering warm-up pixels, before a tile's first pixel is timed.
    pub warm_up_ns: f64,
    /// The remainder.
    pub unexplained_ns: f64,
}

impl Accounts {
    /// Computes the breakdown of a rendering; `None` if pixels were not timed.
    pub fn of(rendering: &Rendering) -> Option<Self> {
        let clock = rendering.meter.clock()?;
        let repeats = rendering.repeats;
        let pixels_ns = repeats.iter().filter_map(|repeat| repeat.pixels_ns).sum();
        let busy_ns = repeats.iter().map(|repeat| repeat.busy_ns).sum::<u64>() as f64;
        let film_ns = repeats.iter().map(|repeat| repeat.film_ns).sum::<u64>() as f64;
        let warm_up_ns = repeats.iter().map(|repeat| repeat.warm_up_ns).sum::<u64>() as f64;
        let n_readings = repeats.len() * rendering.config.image.n_pixels();
        let clock_ns = n_readings as f64 * clock.overhead_ns();
        Some(Self {
            busy_ns,
            pixels_ns,
            clock_ns,
            film_ns,
            warm_up_ns,
            unexplained_ns: busy_ns - pixels_ns - clock_ns - film_ns - warm_up_ns,
        })
    }

    /// Returns a part in percent of the busy time; 0 without any.
    pub fn percent(&self, part_ns: f64) -> f64 {
        match self.busy_ns {
            0.0 => 0.0,
            busy_ns => 100.0 * part_ns / busy_ns,
        }
    }
}
