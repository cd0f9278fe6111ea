//! The arrays of a film that go into files, in one list for all writers.

use vtkio::model::ScalarType;

use super::{Film, Strip};
use crate::config::CostMode;
use crate::cost::Counter;

/// An array of the film as files have it.
pub struct Column {
    /// Its name in files.
    pub name: &'static str,
    /// Its numbers.
    pub scalar: ScalarType,
    /// How many numbers a pixel.
    pub n_components: usize,
    /// Whether the film keeps it; others are made of what it keeps.
    pub is_kept: bool,
    /// Its bytes in a strip of the film, in native order: those of the film, or
    /// of a buffer that they are written to.
    pub bytes: for<'a> fn(&Film, &'a Strip, &'a mut Vec<u32>) -> &'a [u8],
}

/// Makes a [`Column`] of a field of [`Strip`].
macro_rules! column {
    ($name:literal, $field:ident, $scalar:ident x $n:literal) => {
        Column {
            name: $name,
            scalar: ScalarType::$scalar,
            n_components: $n,
            is_kept: true,
            bytes: |_, strip, _| bytemuck::cast_slice(&strip.$field),
        }
    };
}

/// Makes a [`Column`] of numbers that are made of what a film keeps.
macro_rules! made {
    ($name:literal, $scalar:ident, $write:expr) => {
        Column {
            name: $name,
            scalar: ScalarType::$scalar,
            n_components: 1,
            is_kept: false,
            bytes: |film, strip, numbers| {
                let write: fn(&Film, &Strip, &mut Vec<u32>) = $write;
                write(film, strip, numbers);
                bytemuck::cast_slice(numbers)
            },
        }
    };
}

/// Makes a [`Column`] of one of the counters.
macro_rules! counter {
    ($name:literal, $counter:ident) => {
        Column {
            is_kept: true,
            ..made!($name, U32, |film, strip, counts| {
                film.counts(strip, Counter::$counter, counts)
            })
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
    counter!("node_visits", NodeVisits),
    // Ray-primitive tests of all rays of the pixel.
    counter!("primitive_tests", PrimitiveTests),
    // All rays of the pixel.
    made!("rays", U32, Film::rays),
    // Those toward lights.
    counter!("shadow_rays", ShadowRays),
    // Those mirrored off surfaces.
    counter!("reflection_rays", ReflectionRays),
    // Those through surfaces.
    counter!("refraction_rays", RefractionRays),
    // Longest path in bounces.
    counter!("depth", Depth),
    // The tile, numbered along rows from the top left.
    made!("tile", I32, Film::tile_numbers),
    // The thread, from 0.
    made!("thread", I32, Film::threads),
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
    use crate::film::bytes_per_pixel;
    use crate::schedule::TileGrid;

    #[test]
    fn every_column_has_its_stride_of_bytes_a_pixel() {
        let modes = [CostMode::None, CostMode::Counters, CostMode::Time];
        for (mode, expected) in modes.into_iter().zip([43, 67, 72]) {
            let film = Film::new(TileGrid::new(5, 4, 3), 1, mode);
            for column in columns(mode, film.n_repeats) {
                let mut buffer = Vec::new();
                let bytes = (column.bytes)(&film, &film.strips[0], &mut buffer);
                assert_eq!(bytes.len(), 20 * column.stride(), "{}", column.name);
            }
            assert_eq!(bytes_per_pixel(mode), expected);
        }
    }
}
