//! The arrays of a film in output files: one list for all writers.

use vtkio::model::ScalarType;

use super::{Film, Strip};
use crate::config::{CostMode, Repeats};
use crate::cost::Counter;

/// An array of the film as in files.
pub struct Column {
    /// Its name in files.
    pub name: &'static str,
    /// The type of its numbers.
    pub scalar: ScalarType,
    /// Numbers per pixel.
    pub n_components: usize,
    /// Whether the film stores it; others are computed from what the film stores.
    pub is_stored: bool,
    /// Its bytes in a strip of the film, in native order: a slice of the film, or of
    /// the buffer, to which it then writes them.
    pub bytes: for<'a> fn(&Film, &'a Strip, &'a mut Vec<u32>) -> &'a [u8],
}

/// A [`Column`] from a field of [`Strip`].
macro_rules! column {
    ($name:literal, $field:ident, $scalar:ident x $n:literal) => {
        Column {
            name: $name,
            scalar: ScalarType::$scalar,
            n_components: $n,
            is_stored: true,
            bytes: |_, strip, _| bytemuck::cast_slice(&strip.$field),
        }
    };
}

/// A [`Column`] of numbers computed from what the film stores.
macro_rules! computed {
    ($name:literal, $scalar:ident, $write:expr) => {
        Column {
            name: $name,
            scalar: ScalarType::$scalar,
            n_components: 1,
            is_stored: false,
            bytes: |film, strip, numbers| {
                let write: fn(&Film, &Strip, &mut Vec<u32>) = $write;
                write(film, strip, numbers);
                bytemuck::cast_slice(numbers)
            },
        }
    };
}

/// A [`Column`] of a counter.
macro_rules! counter {
    ($name:literal, $counter:ident) => {
        Column {
            is_stored: true,
            ..computed!($name, U32, |film, strip, counts| {
                film.counts(strip, Counter::$counter, counts)
            })
        }
    };
}

const GEOMETRY: [Column; 6] = [
    // The color, 8 bits per channel.
    column!("RGB", rgb, U8 x 3),
    // Shading normal, a unit vector on the visible side; NaN without a hit.
    column!("Normals", normal, F32 x 3),
    // Distance along the camera ray in world units; NaN without a hit.
    column!("distance", distance, F32 x 1),
    // Size of a pixel at that distance in world units; NaN without a hit.
    column!("footprint", footprint, F32 x 1),
    // Index into the file's `objects`; -1 without a hit.
    column!("object", object, I32 x 1),
    // Index into the file's `materials`; -1 without a hit.
    column!("material", material, I32 x 1),
];

// Thread time without the overhead of the clock, at least 1.
const TIME: [Column; 1] = [column!("time_ns", time_ns, F32 x 1)];

// The spread of repeated times, and the number of rejected ones.
const REPEATED: [Column; 2] = [
    // Median absolute deviation of the accepted times.
    column!("time_mad_ns", time_mad_ns, F32 x 1),
    // Times during which the thread lost its CPU, or right after that.
    column!("n_rejected", n_rejected, U8 x 1),
];

const COUNTERS: [Column; 9] = [
    // BVH nodes visited by all rays of the pixel.
    counter!("node_visits", NodeVisits),
    // Ray-primitive tests of all rays of the pixel.
    counter!("primitive_tests", PrimitiveTests),
    // Number of all rays of the pixel.
    computed!("rays", U32, Film::rays),
    // Number of shadow rays.
    counter!("shadow_rays", ShadowRays),
    // Number of reflection rays.
    counter!("reflection_rays", ReflectionRays),
    // Number of refraction rays.
    counter!("refraction_rays", RefractionRays),
    // Longest path in bounces.
    counter!("depth", Depth),
    // The tile, numbered along rows from the top left.
    computed!("tile", I32, Film::tile_numbers),
    // The thread, from 0.
    computed!("thread", I32, Film::threads),
];

/// The arrays of a film with this cost mode for which so many renderings were asked,
/// in the order of the files.
pub fn columns(cost: CostMode, repeats: Repeats) -> impl Iterator<Item = &'static Column> {
    let (time, counters): (&[_], &[_]) = match cost {
        CostMode::None => (&[], &[]),
        CostMode::Counters => (&[], &COUNTERS),
        CostMode::Time => (&TIME, &COUNTERS),
    };
    let repeated: &[_] = if cost.has_time() && repeats.has_spread() {
        &REPEATED
    } else {
        &[]
    };
    GEOMETRY.iter().chain(time).chain(repeated).chain(counters)
}

impl Column {
    /// Bytes per pixel.
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
    fn every_column_has_as_many_bytes_per_pixel_as_its_stride() {
        let modes = [CostMode::None, CostMode::Counters, CostMode::Time];
        for (mode, expected) in modes.into_iter().zip([43, 67, 72]) {
            let film = Film::new(TileGrid::new(5, 4, 3), 1, mode);
            for column in columns(mode, film.repeats) {
                let mut buffer = Vec::new();
                let bytes = (column.bytes)(&film, &film.strips[0], &mut buffer);
                assert_eq!(bytes.len(), 20 * column.stride(), "{}", column.name);
            }
            assert_eq!(bytes_per_pixel(mode), expected);
        }
    }
}
