//! What was rendered, pixel by pixel.
//!
//! A [`Film`] is a stack of [`Strip`]s of a few rows each, and a strip is a
//! structure of arrays. Strips let threads write side by side without a copy,
//! and writers walk them in order; [`columns`] lists the arrays that go into
//! files, in one place for all writers.

mod column;

use glam::Vec3;

pub use column::{Column, columns};

use crate::config::CostMode;
use crate::cost::{Cost, RayKind};
use crate::trace::SurfacePoint;

/// Rows in a strip but the last: fewer than a tile's, so that threads whose
/// tiles stand side by side do not wait for one another for long, and enough to
/// be written into a file at one go.
pub const STRIP_ROWS: u32 = 4;

/// A rendered picture: colours, geometry and cost of every pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Which of the cost arrays are there.
    pub cost: CostMode,
    /// The counters of all pixels together; zero where nothing was counted.
    pub totals: Cost,
    /// The rows, top strip first.
    pub strips: Vec<Strip>,
}

/// Some rows of a film. Every array is row-major, `width * n_rows` long, the
/// uppermost row first; cost arrays that were not asked for are empty.
#[derive(Debug, Clone, Default, PartialEq)]
#[expect(missing_docs, reason = "each array is told in `columns`")]
pub struct Strip {
    /// The number of the uppermost row, 0 on top of the film.
    pub first_row: u32,
    /// How many rows.
    pub n_rows: u32,
    pub rgb: Vec<[u8; 3]>,
    /// World-space point of the pixel's hit; NaN for none.
    pub position: Vec<Vec3>,
    pub normal: Vec<Vec3>,
    pub distance: Vec<f32>,
    pub footprint: Vec<f32>,
    pub object: Vec<i32>,
    pub material: Vec<i32>,
    pub time_ns: Vec<f32>,
    pub node_visits: Vec<u32>,
    pub primitive_tests: Vec<u32>,
    pub rays: Vec<u32>,
    pub shadow_rays: Vec<u32>,
    pub reflection_rays: Vec<u32>,
    pub refraction_rays: Vec<u32>,
    pub depth: Vec<u32>,
    pub tile: Vec<i32>,
    pub thread: Vec<i32>,
}

/// One pixel on its way into the film.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pixel {
    /// Mean colour of the samples, not yet limited to 1.
    pub color: Vec3,
    /// What the middle sample's camera ray met.
    pub surface: Option<SurfacePoint>,
    /// World-space size of the pixel there.
    pub footprint: f32,
    /// What it cost, where that was measured.
    pub cost: Option<PixelCost>,
}

/// What one pixel cost.
#[derive(Debug, Clone, Copy)]
pub struct PixelCost {
    /// The counters.
    pub counted: Cost,
    /// Thread time in nanoseconds, where it was measured.
    pub time_ns: Option<f32>,
    /// The tile that it was in.
    pub tile: u32,
    /// The thread that rendered it.
    pub thread: u32,
}

/// Bytes of memory that a film takes for each pixel.
pub fn bytes_per_pixel(cost: CostMode) -> usize {
    size_of::<Vec3>() + columns(cost).map(Column::stride).sum::<usize>()
}

impl Film {
    /// An empty film of `width * height` pixels.
    pub fn new(width: u32, height: u32, cost: CostMode) -> Self {
        let strip = |first_row| {
            let n_rows = STRIP_ROWS.min(height - first_row);
            Strip::new(first_row, n_rows, width, cost)
        };
        Self {
            width,
            height,
            cost,
            totals: Cost::default(),
            strips: (0..height)
                .step_by(STRIP_ROWS as usize)
                .map(strip)
                .collect(),
        }
    }

    /// How many pixels have a hit.
    pub fn n_hits(&self) -> usize {
        let hits = |strip: &Strip| strip.object.iter().filter(|&&object| object >= 0).count();
        self.strips.iter().map(hits).sum()
    }

    /// The sum of `time_ns` over all pixels; 0 where no time was measured.
    pub fn total_time_ns(&self) -> f64 {
        self.values(|strip| &strip.time_ns).map(f64::from).sum()
    }

    /// One array's rows, the film's uppermost first, each a slice of its strip.
    pub fn rows<'a, T: 'a>(
        &'a self,
        array: fn(&Strip) -> &Vec<T>,
    ) -> impl DoubleEndedIterator<Item = &'a [T]> {
        let width = self.width as usize;
        self.strips
            .iter()
            .flat_map(move |strip| array(strip).chunks_exact(width))
    }

    /// One array, row-major, `width * height`, row 0 on top.
    pub fn values<'a, T: Copy + 'a>(
        &'a self,
        array: fn(&Strip) -> &Vec<T>,
    ) -> impl DoubleEndedIterator<Item = T> + 'a {
        self.rows(array).flatten().copied()
    }
}

impl Strip {
    fn new(first_row: u32, n_rows: u32, width: u32, cost: CostMode) -> Self {
        let n = n_rows as usize * width as usize;
        let n_times = if cost.has_time() { n } else { 0 };
        let n_counters = if cost.has_counters() { n } else { 0 };
        Self {
            first_row,
            n_rows,
            rgb: vec![[0; 3]; n],
            position: vec![Vec3::ZERO; n],
            normal: vec![Vec3::ZERO; n],
            distance: vec![0.0; n],
            footprint: vec![0.0; n],
            object: vec![0; n],
            material: vec![0; n],
            time_ns: vec![0.0; n_times],
            node_visits: vec![0; n_counters],
            primitive_tests: vec![0; n_counters],
            rays: vec![0; n_counters],
            shadow_rays: vec![0; n_counters],
            reflection_rays: vec![0; n_counters],
            refraction_rays: vec![0; n_counters],
            depth: vec![0; n_counters],
            tile: vec![0; n_counters],
            thread: vec![0; n_counters],
        }
    }

    /// Puts neighbouring pixels of a row at the indices from `first` on of
    /// every array.
    pub fn put(&mut self, first: usize, pixels: &[Pixel]) {
        // Array by array: its bounds are looked at once, and its memory is
        // written in one go.
        fill(&mut self.rgb, first, pixels, |pixel| to_rgb8(pixel.color));
        fill(&mut self.footprint, first, pixels, |pixel| {
            seen(pixel, f32::NAN, |_| pixel.footprint)
        });
        fill(&mut self.position, first, pixels, |pixel| {
            seen(pixel, Vec3::NAN, |surface| surface.position)
        });
        fill(&mut self.normal, first, pixels, |pixel| {
            seen(pixel, Vec3::NAN, |surface| surface.normal)
        });
        fill(&mut self.distance, first, pixels, |pixel| {
            seen(pixel, f32::NAN, |surface| surface.distance)
        });
        fill(&mut self.object, first, pixels, |pixel| {
            seen(pixel, -1, |surface| surface.object.0 as i32)
        });
        fill(&mut self.material, first, pixels, |pixel| {
            seen(pixel, -1, |surface| surface.material.0 as i32)
        });
        self.put_costs(first, pixels);
    }

    fn put_costs(&mut self, first: usize, pixels: &[Pixel]) {
        let time_ns = |pixel: &Pixel| pixel.cost.as_ref().and_then(|cost| cost.time_ns);
        fill(&mut self.time_ns, first, pixels, |pixel| {
            time_ns(pixel).unwrap_or_default()
        });
        macro_rules! put_counter {
            ($field:ident, $count:expr) => {
                fill(&mut self.$field, first, pixels, |pixel| {
                    shown(pixel, $count)
                })
            };
        }
        put_counter!(node_visits, |cost| cost.node_visits);
        put_counter!(primitive_tests, |cost| cost.primitive_tests);
        put_counter!(rays, Cost::n_rays);
        put_counter!(shadow_rays, |cost| cost.rays_of(RayKind::Shadow));
        put_counter!(reflection_rays, |cost| cost.rays_of(RayKind::Reflection));
        put_counter!(refraction_rays, |cost| cost.rays_of(RayKind::Refraction));
        put_counter!(depth, |cost| cost.depth);
        fill(&mut self.tile, first, pixels, |pixel| {
            pixel.cost.as_ref().map_or(0, |cost| cost.tile as i32)
        });
        fill(&mut self.thread, first, pixels, |pixel| {
            pixel.cost.as_ref().map_or(0, |cost| cost.thread as i32)
        });
    }
}

/// Writes a value of each pixel at the indices from `first` on of an array;
/// nothing into one that was not asked for, which is empty.
#[inline(always)]
fn fill<T>(array: &mut [T], first: usize, pixels: &[Pixel], value: impl Fn(&Pixel) -> T) {
    if array.is_empty() {
        return;
    }
    let places = &mut array[first..first + pixels.len()];
    for (place, pixel) in places.iter_mut().zip(pixels) {
        *place = value(pixel);
    }
}

/// What the pixel's surface has, or `none` without one.
#[inline(always)]
fn seen<T>(pixel: &Pixel, none: T, value: impl Fn(&SurfacePoint) -> T) -> T {
    pixel.surface.as_ref().map_or(none, value)
}

/// A counter of the pixel. One with more than 2^32 of anything shows 2^32 - 1.
#[inline(always)]
fn shown(pixel: &Pixel, count: impl Fn(&Cost) -> u64) -> u32 {
    let count = pixel.cost.as_ref().map_or(0, |cost| count(&cost.counted));
    u32::try_from(count).unwrap_or(u32::MAX)
}

/// Limited to 0..1, then to 8 bits by rounding; no gamma.
pub(crate) fn to_rgb8(color: Vec3) -> [u8; 3] {
    (color.clamp(Vec3::ZERO, Vec3::ONE) * 255.0)
        .to_array()
        .map(rounded)
}

/// The nearest whole number of one from 0 to 255, halves up: as `f32::round`,
/// which is a call of a function where x86-64 has no SSE 4.1.
#[inline(always)]
fn rounded(channel: f32) -> u8 {
    let whole = channel as u8;
    // Exact: the two are less than 1 apart.
    whole + u8::from(channel - f32::from(whole) >= 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_cover_every_row_once() {
        for height in [1, 15, 16, 17, 40] {
            let film = Film::new(3, height, CostMode::Time);
            let rows: Vec<u32> = film
                .strips
                .iter()
                .flat_map(|strip| strip.first_row..strip.first_row + strip.n_rows)
                .collect();
            assert_eq!(rows, (0..height).collect::<Vec<_>>());
            assert_eq!(film.values(|strip| &strip.depth).count() as u32, 3 * height);
        }
    }

    #[test]
    fn rounding_is_that_of_the_library() {
        let halves = (0..255).map(|whole| whole as f32 + 0.5);
        let close = halves.flat_map(|half| [half.next_down(), half, half.next_up()]);
        let everywhere = (0..=255_000).map(|thousandth| thousandth as f32 / 1000.0);
        for channel in close.chain(everywhere) {
            assert_eq!(rounded(channel), channel.round() as u8, "{channel}");
        }
    }
}
