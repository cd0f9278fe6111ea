//! Renders a small picture and some rows of a scene, to see what its files will hold.

use std::io::{self, Seek, SeekFrom, Write};
use std::num::NonZeroU8;

use crate::writers;
use render::film::Film;
use render::tiles::{TilePlan, render, repeat, with_samples_planned};
use scene::build::Sensor;
use scene::config::{Config, Image, Repeats};
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Maximum number of pixels of the small picture: a hundredth of a second of rays, and the share of
/// hits to about 0.5 %.
const MOST_PIXELS: usize = 1 << 16;

/// Camera rays of the rows, unless the minimum number of rows has more: about half a second.
const N_SAMPLES: u64 = 1 << 19;

/// Minimum number of rows of tiles. If their camera rays are too many, pixels have fewer samples.
const LEAST_ROWS_OF_TILES: u32 = 3;
const MOST_SAMPLES: u64 = 1 << 20;

/// Two renderings, which show the spread of times.
const TWICE: Repeats = Repeats::Exactly(NonZeroU8::new(2).unwrap());

/// Renders a subset of the picture's columns and rows, with one sample each, on the current rayon
/// pool.
pub(crate) fn small_picture(config: &Config, tracer: Tracer) -> Film {
    let share = config.image.n_pixels() as f64 / MOST_PIXELS as f64;
    let stride = (share.sqrt().ceil() as u32).max(1);
    let image = config.image.shrunk(|side| side.div_ceil(stride));
    let sensor = Sensor::with_image(tracer.scene, config, image);
    let plan = TilePlan::new(tracer, &sensor, config.tiles);
    let (film, _) = render(tracer, &plan, &Meter::Off, &|_| {});
    film
}

/// Rows of the picture.
pub(crate) struct RowSample<'a> {
    config: &'a Config,
    film: Film,
}

impl<'a> RowSample<'a> {
    /// Renders some rows of the picture on the current rayon pool.
    pub(crate) fn render(config: &'a Config, tracer: Tracer) -> Self {
        let is_repeated = match config.repeats {
            Repeats::Auto => config.image.n_camera_rays() <= MOST_SAMPLES,
            repeats => repeats.has_spread(),
        };
        let (repeats, n) = if config.cost.has_time() && is_repeated {
            (TWICE, 2)
        } else {
            (Repeats::ONCE, 1)
        };
        let (image, n_rows) = rows(config, n);
        let sensor = Sensor::with_image(tracer.scene, config, image);
        let sensor = with_samples_planned(tracer, &sensor);
        let plan = TilePlan::with_rows(&sensor, config.tiles.size, n_rows);
        let meter = Meter::new(config.cost);
        let (film, ..) = repeat(repeats, tracer, &plan, &meter, &|_| {});
        Self { config, film }
    }

    /// Returns the bytes of a cloud of this many hits, and of a frame of this many rows, without
    /// their headers.
    pub(crate) fn array_bytes(&self, n_hits: u64, n_rows: u32) -> [u64; 2] {
        let empty = Film {
            strips: Vec::new(),
            tiles: Vec::new(),
            ..self.film
        };
        let codec = self.config.compress;
        let cloud = |film| Length::measure(|out| writers::write_hits(film, codec, out));
        let frame = |film| Length::measure(|out| writers::write_frame(film, codec, out));
        let of_hits = match self.film.n_hits() {
            0 => self.share(),
            n => n_hits as f64 / n as f64,
        };
        let of_rows = f64::from(n_rows) / f64::from(self.film.grid.height);
        [
            scaled(cloud(&self.film) - cloud(&empty), of_hits),
            scaled(frame(&self.film) - frame(&empty), of_rows),
        ]
    }

    /// Returns the bytes of the picture without its texts.
    pub(crate) fn picture_bytes(&self) -> u64 {
        let bits = self.config.film.bits;
        let of_rows = Length::measure(|out| writers::write_bare_picture(&self.film, bits, out));
        scaled(of_rows, self.share())
    }

    /// Returns the bytes of the cost map, 0 without one, whose pixels are blocks of pixels with
    /// this side.
    pub(crate) fn map_bytes(&self, side: u32) -> u64 {
        if !self.config.cost.has_counters() {
            return 0;
        }
        let [costs, none] = [true, false].map(|has_costs| {
            Length::measure(|out| writers::write_bare_map(&self.film, side, has_costs, out))
        });
        none + scaled(costs.saturating_sub(none), self.share())
    }

    /// Returns the rows of the picture per row of the film.
    fn share(&self) -> f64 {
        f64::from(self.config.image.height) / f64::from(self.film.grid.height)
    }
}

/// Returns the picture with at most the samples that there is time for, and the number of rows,
/// which are rendered `n_renderings` times.
fn rows(config: &Config, n_renderings: u64) -> (Image, u32) {
    let image = config.image;
    let per_row = u64::from(image.width) * n_renderings;
    let least = LEAST_ROWS_OF_TILES * config.tiles.size;
    let most_samples = MOST_SAMPLES / (per_row * u64::from(least));
    let n_samples = u64::from(image.samples_per_pixel).min(most_samples).max(1);
    let n_rows = N_SAMPLES / (per_row * n_samples);
    let image = Image {
        samples_per_pixel: n_samples as u32,
        ..image
    };
    (image, least.max(n_rows as u32))
}

fn scaled(n_bytes: u64, factor: f64) -> u64 {
    (n_bytes as f64 * factor).round() as u64
}

/// A writer that counts bytes and discards them.
#[derive(Debug, Default)]
pub(crate) struct Length {
    position: u64,
    length: u64,
}

impl Length {
    /// Returns the length that a function writes; 0 if it fails.
    pub(crate) fn measure(write: impl FnOnce(&mut Self) -> io::Result<()>) -> u64 {
        let mut out = Self::default();
        match write(&mut out) {
            Ok(()) => out.length,
            Err(_) => 0,
        }
    }
}

impl Write for Length {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.position += bytes.len() as u64;
        self.length = self.length.max(self.position);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Length {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let from = |base: u64, offset: i64| base.checked_add_signed(offset);
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::End(offset) => from(self.length, offset),
            SeekFrom::Current(offset) => from(self.position, offset),
        };
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}
