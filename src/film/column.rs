//! The arrays of a film that go into files, in one list for all writers.

use vtkio::model::ScalarType;

use super::Strip;
use crate::config::CostMode;

/// An array of the film as files have it.
pub struct Column {
    /// Its name in files.
    pub name: &'static str,
    /// Its numbers.
    pub scalar: ScalarType,
    /// How many numbers a pixel.
    pub n_components: usize,
    /// Its bytes in one strip, in native order.
    pub bytes: fn(&Strip) -> &[u8],
}

/// Makes a [`Column`] of a field of [`Strip`].
macro_rules! column {
    ($name:literal, $field:ident, $scalar:ident x $n:literal) => {
        Column {
            name: $name,
            scalar: ScalarType::$scalar,
            n_components: $n,
            bytes: |strip| bytemuck::cast_slice(&strip.$field),
        }
    };
}

const GEOMETRY: [Column; 6] = [
    // The colour, 8 bits a channel.
    column!("RGB", rgb, U8 x 3),
    // Unit normal on the side seen; NaN without a hit.
    column!("Normals", normal, F32 x 3),
    // Distance along the camera ray in world units; NaN without a hit.
    column!("distance", distance, F32 x 1),
    // World size of a pixel at that distance; NaN without a hit.
    column!("footprint", footprint, F32 x 1),
    // Index into the file's `objects`; -1 without a hit.
    column!("object", object, I32 x 1),
    // Index into the file's `materials`; -1 without a hit.
    column!("material", material, I32 x 1),
];

// Thread time, the clock's own cost taken off, at least 1.
const TIME: [Column; 1] = [column!("time_ns", time_ns, F32 x 1)];

// How far repeated times are from `time_ns`, and how many were not taken.
const REPEATED: [Column; 2] = [
    // Median absolute deviation of the samples that were kept.
    column!("time_mad_ns", time_mad_ns, F32 x 1),
    // Samples during which the thread changed its CPU.
    column!("n_rejected", n_rejected, U8 x 1),
];

const COUNTERS: [Column; 9] = [
    // BVH nodes entered by all rays of the pixel.
    column!("node_visits", node_visits, U32 x 1),
    // Ray-primitive tests of all rays of the pixel.
    column!("primitive_tests", primitive_tests, U32 x 1),
    // All rays of the pixel.
    column!("rays", rays, U32 x 1),
    // Those toward lights.
    column!("shadow_rays", shadow_rays, U32 x 1),
    // Those mirrored off surfaces.
    column!("reflection_rays", reflection_rays, U32 x 1),
    // Those through surfaces.
    column!("refraction_rays", refraction_rays, U32 x 1),
    // Longest path in bounces.
    column!("depth", depth, U32 x 1),
    // The tile, numbered along rows from the top left.
    column!("tile", tile, I32 x 1),
    // The thread, from 0.
    column!("thread", thread, I32 x 1),
];

/// The arrays of a film of this mode that was rendered so many times, in the
/// order of the files.
pub fn columns(cost: CostMode, n_repeats: u8) -> impl Iterator<Item = &'static Column> {
    let (time, counters): (&[_], &[_]) = match cost {
        CostMode::None => (&[], &[]),
        CostMode::Counters => (&[], &COUNTERS),
        CostMode::Time => (&TIME, &COUNTERS),
    };
    let repeated: &[_] = match cost.has_time() && n_repeats > 1 {
        true => &REPEATED,
        false => &[],
    };
    GEOMETRY.iter().chain(time).chain(repeated).chain(counters)
}

impl Column {
    /// Bytes a pixel.
    pub fn stride(&self) -> usize {
        let scalar = match self.scalar {
            ScalarType::U8 => 1,
            _ => 4,
        };
        scalar * self.n_components
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, bytes_per_pixel};

    #[test]
    fn every_column_has_its_stride_of_bytes_a_pixel() {
        let modes = [CostMode::None, CostMode::Counters, CostMode::Time];
        for (mode, expected) in modes.into_iter().zip([43, 79, 84]) {
            let film = Film::new(5, 4, mode);
            for column in columns(mode, film.n_repeats) {
                let bytes = (column.bytes)(&film.strips[0]);
                assert_eq!(bytes.len(), 20 * column.stride(), "{}", column.name);
            }
            assert_eq!(bytes_per_pixel(mode), expected);
        }
    }
}
