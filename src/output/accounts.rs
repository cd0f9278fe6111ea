//! Where the threads' time went.

use serde::Serialize;

use super::Rendering;

/// The threads' time at the tiles of all renderings, in nanoseconds, and its
/// parts. They sum up to `busy_ns`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Accounts {
    /// From each tile's start to its end.
    pub busy_ns: f64,
    /// The pixels' own times.
    pub pixels_ns: f64,
    /// Readings of the clock, one a pixel, at what a reading costs.
    pub clock_ns: f64,
    /// Pixels written into the film.
    pub film_ns: f64,
    /// Pixels rendered before a tile's first one was timed, which count for
    /// nothing.
    pub warm_up_ns: f64,
    /// What is left: what no pixel is charged with.
    pub unexplained_ns: f64,
}

impl Accounts {
    /// The accounts of a rendering; `None` where pixels were not timed.
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

    /// A part of the busy time in percent of it; 0 without any.
    pub fn percent(&self, part_ns: f64) -> f64 {
        match self.busy_ns {
            0.0 => 0.0,
            busy_ns => 100.0 * part_ns / busy_ns,
        }
    }
}
