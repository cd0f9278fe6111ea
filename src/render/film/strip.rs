//! Some rows of a film as a structure of arrays.

use std::ops::Range;

use glam::Vec3;

use super::{PixelColumns, Rendered};
use scene::config::{CostMode, ExtraArrays};
use tracer::cost::{RaysByBounce, StepCounts};
use world::color::Development;

/// Some rows of a film. Every array is row-major, `width * n_rows` long, with the uppermost row
/// first. Arrays of times are empty without times.
#[derive(Debug, Clone, Default, PartialEq)]
#[expect(missing_docs, reason = "`columns` documents each array")]
pub struct Strip {
    /// Index of the uppermost row; row 0 is at the top of the film.
    pub first_row: u32,
    /// Number of rows.
    pub n_rows: u32,
    pub rgb: Vec<[u8; 3]>,
    /// The mean radiance of the samples; empty if the film does not keep it.
    pub radiance: Vec<Vec3>,
    /// The standard error of the radiance; empty if the film does not keep it.
    pub noise: Vec<f32>,
    /// The color of the surface at the pixel's hit; empty if the film does not keep it.
    pub albedo: Vec<Vec3>,
    /// The rays by bounce; empty if the film does not keep them.
    pub bounces: Vec<RaysByBounce>,
    /// The steps of the pixel's rays; empty before they are observed, and without observation.
    pub step_counts: Vec<StepCounts>,
    /// The share of idle lanes; empty before the lanes are counted, and if they are not.
    pub idle_lanes: Vec<f32>,
    /// The cycles of a device's clock; empty before they are measured, and without such a clock.
    pub cycles: Vec<f32>,
    /// The multiprocessor that followed the pixel's paths, or the last of several; -1 for a pixel
    /// without; empty before they are found, and without a device that says it.
    pub sm: Vec<i32>,
    /// The instance at the pixel's hit; empty if the film does not keep it.
    pub instance: Vec<i32>,
    /// The point of the pixel's hit in world space; NaN without a hit.
    pub position: Vec<Vec3>,
    pub normal: Vec<Vec3>,
    pub distance: Vec<f32>,
    pub footprint: Vec<f32>,
    pub object: Vec<i32>,
    pub material: Vec<i32>,
    pub time_ns: Vec<f32>,
    /// Empty if no spread was requested.
    pub time_mad_ns: Vec<f32>,
}

impl Strip {
    /// Reserves memory for the pixels of a strip; [`fill`](Self::fill) gives it pixels. Threads that
    /// reserve at the same time would wait for the lock of the heap.
    pub(super) fn reserve(
        [first_row, n_rows, width]: [u32; 3],
        cost: CostMode,
        extra: ExtraArrays,
    ) -> Self {
        let n = n_rows as usize * width as usize;
        let n_if = |is_kept: bool| if is_kept { n } else { 0 };
        let n_times = n_if(cost.has_time());
        Self {
            first_row,
            n_rows,
            rgb: Vec::with_capacity(n),
            radiance: Vec::with_capacity(n_if(extra.radiance)),
            noise: Vec::with_capacity(n_if(extra.noise.is_some())),
            albedo: Vec::with_capacity(n_if(extra.albedo)),
            bounces: Vec::with_capacity(n_if(extra.bounces)),
            step_counts: Vec::new(),
            idle_lanes: Vec::new(),
            cycles: Vec::new(),
            sm: Vec::new(),
            instance: Vec::with_capacity(n_if(extra.instance)),
            position: Vec::with_capacity(n),
            normal: Vec::with_capacity(n),
            distance: Vec::with_capacity(n),
            footprint: Vec::with_capacity(n),
            object: Vec::with_capacity(n),
            material: Vec::with_capacity(n),
            time_ns: Vec::with_capacity(n_times),
            time_mad_ns: Vec::new(),
        }
    }

    /// Fills the reserved arrays with zeros, for rows of `width` pixels that are not rendered yet.
    pub(super) fn fill(&mut self, width: u32) {
        let n = self.n_rows as usize * width as usize;
        macro_rules! fill {
            ($($field:ident),*) => {
                $(self.$field.resize(n.min(self.$field.capacity()), Default::default());)*
            };
        }
        fill!(
            rgb, radiance, noise, albedo, bounces, instance, position, normal
        );
        fill!(distance, footprint, object, material, time_ns);
    }

    /// Writes the pixels `row` of `rendered`, which are adjacent in a row, to the indices from
    /// `first` on of every array; their colors are developed.
    pub fn put(
        &mut self,
        first: usize,
        rendered: &Rendered,
        row: Range<usize>,
        development: &Development,
    ) {
        let places = first..first + row.len();
        self.put_pixels(places.clone(), rendered.pixels, row.clone());
        let colors = &rendered.pixels.color[row.clone()];
        development.develop8(colors, &mut self.rgb[places.clone()]);
        if !rendered.bounces.is_empty() {
            self.bounces[places.clone()].copy_from_slice(&rendered.bounces[row.clone()]);
        }
        if !rendered.time_ns.is_empty() {
            self.time_ns[places].copy_from_slice(&rendered.time_ns[row]);
        }
    }

    fn put_pixels(&mut self, places: Range<usize>, pixels: &PixelColumns, row: Range<usize>) {
        macro_rules! put {
            ($field:ident) => {
                self.$field[places.clone()].copy_from_slice(&pixels.$field[row.clone()])
            };
        }
        put!(position);
        put!(normal);
        put!(distance);
        put!(footprint);
        put!(object);
        put!(material);
        if !self.noise.is_empty() {
            put!(noise);
        }
        if !self.albedo.is_empty() {
            put!(albedo);
        }
        if !self.instance.is_empty() {
            put!(instance);
        }
        if !self.radiance.is_empty() {
            self.radiance[places].copy_from_slice(&pixels.color[row]);
        }
    }
}
