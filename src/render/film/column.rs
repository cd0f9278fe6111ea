//! The arrays of a film in output files: one list for all writers.

use vtkio::model::ScalarType;

use super::{Film, Strip};
use scene::config::{Config, CostMode, ExtraArrays, Repeats};
use tracer::cost::{Metric, MetricSource};
use world::geometry::LENGTH_UNIT;

/// An array of the film as in files.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Name of the array in files.
    pub name: &'static str,
    /// Type of the numbers.
    pub scalar: ScalarType,
    /// Numbers per pixel.
    pub n_components: usize,
    /// Unit of the numbers; `None` for colors, IDs and flags.
    pub unit: Option<&'static str>,
    origin: Origin,
}

/// Source of the numbers of a column.
#[derive(Debug, Clone, Copy)]
enum Origin {
    /// The column (0) or the row (1) of the pixel, row 0 on top.
    Coordinate(usize),
    /// A field of [`Strip`].
    Stored(fn(&Strip) -> &[u8]),
    /// The positions in world space.
    Position,
    /// The counters of the tiles.
    Counted(Metric),
    /// A metric that is computed of others.
    Computed(Metric),
    /// The tiles of the image.
    Tile,
    /// The threads that rendered the tiles.
    Thread,
    /// The groups of pixels that are timed together.
    Group,
    /// The multiprocessors of a device.
    Sm,
}

/// A [`Column`] from a field of [`Strip`].
macro_rules! column {
    ($name:expr, $field:ident, $scalar:ident x $n:literal) => {
        column!($name, $field, $scalar x $n, None)
    };
    ($name:expr, $field:ident, $scalar:ident x $n:literal in $unit:expr) => {
        column!($name, $field, $scalar x $n, Some($unit))
    };
    ($name:expr, $field:ident, $scalar:ident x $n:literal, $unit:expr) => {
        Column {
            name: $name,
            scalar: ScalarType::$scalar,
            n_components: $n,
            unit: $unit,
            origin: Origin::Stored(|strip| bytemuck::cast_slice(&strip.$field)),
        }
    };
}

const fn computed(name: &'static str, scalar: ScalarType, origin: Origin) -> Column {
    Column {
        name,
        scalar,
        n_components: 1,
        unit: None,
        origin,
    }
}

// In the order in which ParaView lists the arrays of a pixel under the mouse.
const GEOMETRY: [Column; 8] = [
    // Column and row of the pixel, as `raycost trace --pixel` takes them.
    computed("pixel_x", ScalarType::U16, Origin::Coordinate(0)),
    computed("pixel_y", ScalarType::U16, Origin::Coordinate(1)),
    // Index into the file's `objects`; -1 without a hit.
    column!("object", object, I32 x 1),
    // Index into the file's `materials`; -1 without a hit.
    column!("material", material, I32 x 1),
    // The color in the picture, 8 bits per channel.
    column!("RGB", rgb, U8 x 3),
    // Shading normal, a unit vector on the visible side; NaN without a hit.
    column!("Normals", normal, F32 x 3),
    // Distance along the camera ray in world units; NaN without a hit.
    column!("distance", distance, F32 x 1 in LENGTH_UNIT),
    // Size of a pixel at that distance in world units; NaN without a hit.
    column!("footprint", footprint, F32 x 1 in LENGTH_UNIT),
];

// Thread time without the overhead of the clock, at least 1: the pixel's time, or its share of the
// time of its group.
const TIME: Column = column!(Metric::TIME.name, time_ns, F32 x 1 in Metric::TIME.unit_label());

// The spread of repeated times: their median absolute deviation.
const SPREAD: Column = column!("time_mad_ns", time_mad_ns, F32 x 1 in Metric::TIME.unit_label());

const WORK: [Column; 2] = [
    // The tile, numbered along rows from the top left.
    computed("tile", ScalarType::I32, Origin::Tile),
    // The thread, from 0.
    computed("thread", ScalarType::I32, Origin::Thread),
];

/// Returns the arrays of a film with this cost mode and this number of repeats, in the order of the
/// files: geometry, time and its spread, counters, tiles. Only arrays that exist with any settings
/// of samples.
pub fn columns(cost: CostMode, repeats: Repeats) -> impl Iterator<Item = Column> {
    all_columns(cost, repeats, false)
}

/// Returns the arrays that the files of a rendering with this config have for each pixel.
pub fn written_columns(config: &Config) -> impl Iterator<Item = Column> + use<> {
    let extra = config.extra_arrays();
    let counts_samples = config.image.adaptive.is_some();
    kept_columns(config.cost, config.repeats, counts_samples, extra)
        .filter(move |column| extra.written.has(column.name))
}

/// Returns [`columns`], with the numbers of samples if they are counted, and the arrays that a film
/// keeps on request.
pub(super) fn kept_columns(
    cost: CostMode,
    repeats: Repeats,
    counts_samples: bool,
    extra: ExtraArrays,
) -> impl Iterator<Item = Column> {
    let radiance = extra.radiance_in_vtk.then_some(Column::RADIANCE);
    let noise = extra.noise.map(|_| Column::NOISE);
    let efficiency = (noise.is_some() && cost.has_counters()).then_some(Metric::EFFICIENCY);
    let bounces = extra.bounces.then_some(Column::BOUNCES);
    let instance = extra.instance.then_some(Column::INSTANCE);
    let groups = extra.groups.then_some(Column::GROUP);
    let idle_lanes = extra.lanes.map(|_| Column::computed(Metric::IDLE_LANES));
    let cycles = extra.cycles.then(|| Column::computed(Metric::CYCLES));
    let tests = extra.tests.then(|| Metric::observed().map(Column::counted));
    all_columns(cost, repeats, counts_samples)
        .chain(radiance)
        .chain(noise)
        .chain(efficiency.map(Column::computed))
        .chain(bounces)
        .chain(instance)
        .chain(groups)
        .chain(tests.into_iter().flatten())
        .chain(idle_lanes)
        .chain(cycles)
        .chain(extra.sm.then_some(Column::SM))
        .chain(Metric::ratios(extra.metrics).map(Column::computed))
}

/// Returns [`columns`], with the numbers of samples if they are counted.
fn all_columns(
    cost: CostMode,
    repeats: Repeats,
    counts_samples: bool,
) -> impl Iterator<Item = Column> {
    let time = cost.has_time().then_some(TIME);
    let is_repeated = cost.has_time() && repeats.has_spread();
    let spread = is_repeated.then_some(SPREAD);
    let counted = Metric::counted(counts_samples).map(Column::counted);
    let work = || counted.chain(WORK);
    let work = cost.has_counters().then(work).into_iter().flatten();
    GEOMETRY.into_iter().chain(time).chain(spread).chain(work)
}

impl Column {
    /// Returns the array of a counted metric.
    fn counted(metric: Metric) -> Self {
        Self {
            unit: Some(metric.unit_label()),
            ..computed(metric.name, ScalarType::U32, Origin::Counted(metric))
        }
    }

    /// Returns the array of a metric that is computed of others.
    fn computed(metric: Metric) -> Self {
        computed(metric.name, ScalarType::F32, Origin::Computed(metric))
    }

    /// The hit points in world space: three numbers per pixel; NaN without a hit.
    pub const POSITION: Self = Self {
        n_components: 3,
        unit: Some(LENGTH_UNIT),
        ..computed("Points", ScalarType::F32, Origin::Position)
    };

    /// Returns the hit points in a file of points: numbers of 64 bits where the scene is so far
    /// from the origin of world space that 32 bits have too few digits.
    pub fn points(film: &Film) -> Self {
        if film.space.is_centered() {
            return Self::POSITION;
        }
        Self {
            scalar: ScalarType::F64,
            ..Self::POSITION
        }
    }

    /// The linear light of the pixel, with the primaries of sRGB; on request.
    pub const RADIANCE: Self = column!("radiance", radiance, F32 x 3);

    /// The standard error of the linear light, as the root of the mean over the channels; on request.
    pub const NOISE: Self = column!(Metric::NOISE.name, noise, F32 x 1);

    /// The rays after 0, 1, … 6, and after 7 or more bounces; on request.
    pub const BOUNCES: Self =
        column!("rays_by_bounce", bounces, U32 x 8 in Metric::RAYS.unit_label());

    /// Index of the instance; -1 without a hit, and on surfaces without an instance. In scenes with
    /// instances.
    pub const INSTANCE: Self = column!("instance", instance, I32 x 1);

    /// The first pixel of the group that is timed together; on request.
    pub const GROUP: Self = computed("group", ScalarType::I32, Origin::Group);

    /// The multiprocessor of the device that followed the pixel's paths; -1 without one; on request.
    pub const SM: Self = computed("sm", ScalarType::I32, Origin::Sm);

    /// The color of the surface; not in VTK files.
    pub const ALBEDO: Self = column!("albedo", albedo, F32 x 3);

    /// Returns the bytes per pixel.
    pub fn stride(&self) -> usize {
        let scalar = match self.scalar {
            ScalarType::U8 => 1,
            ScalarType::U16 => 2,
            ScalarType::F64 => 8,
            _ => 4,
        };
        scalar * self.n_components
    }

    /// Returns true if the film stores the array; others are computed from stored ones.
    pub fn is_stored(&self) -> bool {
        match self.origin {
            Origin::Stored(_) => true,
            Origin::Counted(metric) => metric.source != MetricSource::AllRays,
            Origin::Coordinate(_) | Origin::Position | Origin::Computed(_) => false,
            Origin::Tile | Origin::Thread | Origin::Group | Origin::Sm => false,
        }
    }

    /// Returns true if the array is a field of [`Strip`].
    pub fn is_in_strips(&self) -> bool {
        matches!(self.origin, Origin::Stored(_))
    }

    /// Returns the array's bytes in a strip of the film, in native order: a slice of the film, or
    /// of `buffer`, which is overwritten.
    pub fn bytes<'a>(&self, film: &Film, strip: &'a Strip, buffer: &'a mut Vec<u32>) -> &'a [u8] {
        match self.origin {
            Origin::Stored(bytes) => return bytes(strip),
            Origin::Coordinate(axis) => film.pixel_coordinates(strip, axis, buffer),
            Origin::Position => film.world_positions(strip, self.scalar, buffer),
            Origin::Counted(metric) => film.counts(strip, metric, buffer),
            Origin::Tile => film.tile_numbers(strip, buffer),
            Origin::Thread => film.threads(strip, buffer),
            Origin::Group => film.groups(strip, buffer),
            Origin::Sm => {
                buffer.clear();
                buffer.extend(strip.sm.iter().map(|&sm| sm as u32));
            }
            Origin::Computed(metric) => {
                let mut values = Vec::new();
                film.costs(strip, metric, &mut values);
                buffer.clear();
                buffer.extend(values.iter().map(|value| value.to_bits()));
            }
        }
        let n_pixels = (strip.n_rows * film.grid.width) as usize;
        &bytemuck::cast_slice(buffer)[..n_pixels * self.stride()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::stored_bytes_per_pixel;
    use crate::schedule::TileGrid;
    use base::Keyword;
    use scene::config::{PixelArray, SampleCost, Warps, WrittenArrays};

    #[test]
    fn every_column_has_as_many_bytes_per_pixel_as_its_stride() {
        let modes = [
            (CostMode::None, 43),
            (CostMode::Counters, 43),
            (CostMode::SingleRayTime, 47),
            (CostMode::Time, 47),
        ];
        for (mode, expected) in modes {
            let film = Film::new(TileGrid::new(5, 4, 3), 1, mode);
            for column in columns(mode, film.repeats) {
                let mut buffer = Vec::new();
                let bytes = column.bytes(&film, &film.strips[0], &mut buffer);
                assert_eq!(bytes.len(), 20 * column.stride(), "{}", column.name);
            }
            let with = |change: fn(&mut ExtraArrays)| {
                let mut extra = film.extra;
                change(&mut extra);
                stored_bytes_per_pixel(mode, extra)
            };
            assert_eq!(with(|_| ()), expected);
            assert_eq!(with(|extra| extra.radiance = true), expected + 12);
            let bounces = Column::BOUNCES.stride();
            assert_eq!(with(|extra| extra.bounces = true), expected + bounces);
            assert_eq!(with(|extra| extra.instance = true), expected + 4);
        }
    }

    #[test]
    fn every_array_can_be_chosen_by_its_name() {
        let extra = ExtraArrays {
            radiance_in_vtk: true,
            noise: Some(SampleCost::default()),
            bounces: true,
            instance: true,
            groups: true,
            tests: true,
            lanes: Some(Warps::default()),
            cycles: true,
            sm: true,
            written: WrittenArrays::only(&[]),
            ..ExtraArrays::default()
        };
        let mut n_chosen = 0;
        for column in kept_columns(CostMode::Time, Repeats::Auto, true, extra) {
            assert!(!extra.written.has(column.name), "{}", column.name);
            n_chosen += 1;
        }
        // Two of the cloud.
        assert_eq!(PixelArray::KEYWORDS.len(), n_chosen + 2);
    }

    #[test]
    fn every_array_is_a_cost_metric_or_known_not_to_be() {
        let others = [
            "RGB",
            "Normals",
            "distance",
            "footprint",
            "object",
            "material",
            "pixel_x",
            "pixel_y",
            "tile",
            "thread",
        ];
        let metrics = Metric::ALL.map(|metric| metric.name);
        for column in columns(CostMode::Time, Repeats::ONCE) {
            let names = metrics.iter().chain(&others);
            let n = names.filter(|name| **name == column.name).count();
            assert_eq!(n, 1, "{}", column.name);
        }
    }
}
