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

/// Rows in a strip but the last; the height of a tile.
pub const STRIP_ROWS: u32 = 16;

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

    /// Puts a pixel at index `i` of every array.
    pub fn put(&mut self, i: usize, pixel: &Pixel) {
        self.rgb[i] = to_rgb8(pixel.color);
        match &pixel.surface {
            Some(surface) => {
                self.position[i] = surface.position;
                self.normal[i] = surface.normal;
                self.distance[i] = surface.distance;
                self.footprint[i] = pixel.footprint;
                self.object[i] = surface.object.0 as i32;
                self.material[i] = surface.material.0 as i32;
            }
            None => {
                self.position[i] = Vec3::NAN;
                self.normal[i] = Vec3::NAN;
                self.distance[i] = f32::NAN;
                self.footprint[i] = f32::NAN;
                self.object[i] = -1;
                self.material[i] = -1;
            }
        }
        if let Some(cost) = &pixel.cost {
            self.put_cost(i, cost);
        }
    }

    fn put_cost(&mut self, i: usize, cost: &PixelCost) {
        // A pixel with more than 2^32 of anything shows 2^32 - 1.
        let shown = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        let counted = &cost.counted;
        if let Some(time_ns) = cost.time_ns {
            self.time_ns[i] = time_ns;
        }
        self.node_visits[i] = shown(counted.node_visits);
        self.primitive_tests[i] = shown(counted.primitive_tests);
        self.rays[i] = shown(counted.n_rays());
        self.shadow_rays[i] = shown(counted.rays_of(RayKind::Shadow));
        self.reflection_rays[i] = shown(counted.rays_of(RayKind::Reflection));
        self.refraction_rays[i] = shown(counted.rays_of(RayKind::Refraction));
        self.depth[i] = shown(counted.depth);
        self.tile[i] = cost.tile as i32;
        self.thread[i] = cost.thread as i32;
    }
}

/// Limited to 0..1, then to 8 bits by rounding; no gamma.
fn to_rgb8(color: Vec3) -> [u8; 3] {
    (color.clamp(Vec3::ZERO, Vec3::ONE) * 255.0)
        .round()
        .to_array()
        .map(|channel| channel as u8)
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
}
