//! The slow twins of the writers: the expected content of each file.

use glam::Vec3;

use crate::common::data_set::{Array, DataSet, integers, units};
use crate::common::{counts, rays};
use render::film::{Film, RenderedTile, STRIP_ROWS, Strip};
use render::schedule::TileGrid;
use scene::config::{CostMode, Repeats};
use tracer::cost::Counter;

/// The expected `tiles.vti`: the lower row of tiles first.
pub fn expected_tiles(cost: CostMode) -> DataSet {
    let upward = [3, 4, 5, 0, 1, 2];
    let f64s = |name: &str, value: fn(u32) -> f64| {
        let bytes = upward.iter().flat_map(|&tile| value(tile).to_ne_bytes());
        tile_array(name, "Float64", bytes.collect())
    };
    let u64s = |name: &str, value: fn(u64) -> u64| {
        let bytes = upward
            .iter()
            .flat_map(|&tile| value(tile.into()).to_ne_bytes());
        tile_array(name, "UInt64", bytes.collect())
    };
    let mut arrays = vec![
        f64s("start_ns", |tile| f64::from(tile) * 2_f64.powi(33)),
        f64s("end_ns", |tile| f64::from(tile) * 2_f64.powi(33) + 7.0),
        f64s("duration_ns", |_| 7.0),
        f64s("film_ns", |_| 3.0),
        f64s("warm_up_ns", |_| 2.0),
        f64s("waiting_ns", |_| 1.0),
        integers("thread", [1, 0, 1, 0, 1, 0].into_iter()),
        integers("position", [2, 1, 0, 5, 4, 3].into_iter()),
        integers("tile", [3, 4, 5, 0, 1, 2].into_iter()),
        integers("rank", [0, 1, 2, 0, 1, 2].into_iter()),
    ];
    if cost.has_counters() {
        arrays.extend([
            u64s("node_visits", |tile| tile << 34),
            u64s("primitive_tests", |_| 0),
            u64s("rays", |_| 15),
            u64s("shadow_rays", |_| 2),
            u64s("reflection_rays", |_| 3),
            u64s("refraction_rays", |_| 4),
            u64s("diffuse_rays", |_| 5),
            u64s("depth", |tile| tile),
        ]);
    }
    DataSet {
        kind: "ImageData".to_owned(),
        n_points: 4 * 3,
        n_cells: None,
        extent: Some([0, 3, 0, 2, 0, 0]),
        // Row 0 of the picture is up to y = 16.5 in frame.vti.
        origin: Some([-0.5, 16.5 - 32.0, 0.0]),
        spacing: Some([16.0; 3]),
        normals: None,
        texts: units(&arrays, unit),
        time: None,
        arrays,
    }
}

fn tile_array(name: &str, scalar: &str, bytes: Vec<u8>) -> Array {
    Array {
        name: name.to_owned(),
        scalar: scalar.to_owned(),
        n_components: 1,
        bytes,
    }
}

/// The expected `frame.vti`: the bottom row first, unlike the film.
pub fn expected_frame(film: &Film) -> DataSet {
    let [right, top] = [film.grid.width, film.grid.height].map(|n| n as i32 - 1);
    let upward = (0..film.grid.height).rev();
    let pixels: Vec<Pixel> = upward
        .flat_map(|y| (0..film.grid.width).map(move |x| Pixel { x, y }))
        .collect();
    let arrays = point_data(film, &pixels);
    DataSet {
        kind: "ImageData".to_owned(),
        n_points: pixels.len(),
        n_cells: None,
        extent: Some([0, right, 0, top, 0, 0]),
        origin: Some([0.0; 3]),
        spacing: Some([1.0; 3]),
        normals: None,
        texts: units(&arrays, unit),
        time: None,
        arrays,
    }
}

/// The expected `hits.vtu`: the pixels with a hit, row by row from the top.
pub fn expected_hits(film: &Film) -> DataSet {
    let mut hits = Vec::new();
    for y in 0..film.grid.height {
        for x in 0..film.grid.width {
            let pixel = Pixel { x, y };
            if pixel.of(film, |strip| &strip.object) >= 0 {
                hits.push(pixel);
            }
        }
    }
    let n = hits.len() as i32;
    let numbers = hits
        .iter()
        .map(|pixel| (pixel.y * film.grid.width + pixel.x) as i32);
    let mut arrays = point_data(film, &hits);
    arrays.push(integers("pixel", numbers));
    arrays.push(horizon(film, &hits));
    let points = hits.iter().flat_map(|pixel| {
        let point = film
            .space
            .world_point(pixel.of(film, |strip| &strip.position));
        point.as_vec3().to_array()
    });
    arrays.push(Array {
        name: "Points".to_owned(),
        scalar: "Float32".to_owned(),
        n_components: 3,
        bytes: points.flat_map(f32::to_ne_bytes).collect(),
    });
    arrays.push(integers("connectivity", 0..n));
    arrays.push(integers("offsets", 1..=n));
    arrays.push(Array {
        name: "types".to_owned(),
        scalar: "UInt8".to_owned(),
        n_components: 1,
        bytes: vec![1; hits.len()], // VTK_VERTEX
    });
    DataSet {
        kind: "UnstructuredGrid".to_owned(),
        n_points: hits.len(),
        n_cells: Some(hits.len()),
        extent: None,
        origin: None,
        spacing: None,
        normals: Some("Normals".to_owned()),
        texts: units(&arrays, unit),
        time: None,
        arrays,
    }
}

/// The unit of an array with this name.
fn unit(name: &str) -> Option<String> {
    match name {
        "distance" | "footprint" | "Points" => Some("world units".to_owned()),
        "depth" => Some("bounces".to_owned()),
        "rays_by_bounce" => Some("rays".to_owned()),
        _ if name.ends_with("_ns") => Some("ns".to_owned()),
        _ if ["rays", "visits", "tests"]
            .iter()
            .any(|end| name.ends_with(end)) =>
        {
            Some(name.replace('_', " "))
        }
        _ => None,
    }
}

/// Which of these pixels are more than four times as far as the lower median.
fn horizon(film: &Film, hits: &[Pixel]) -> Array {
    let mut finite: Vec<f32> = film.values(|strip| &strip.distance).collect();
    // Noise has negative distances, which no ray has.
    finite.retain(|distance| distance.is_finite() && *distance >= 0.0);
    finite.sort_by(f32::total_cmp);
    let median = finite.get(finite.len().saturating_sub(1) / 2);
    let is_horizon = |pixel: &Pixel| {
        let distance = pixel.of(film, |strip| &strip.distance);
        median.is_some_and(|median| distance > 4.0 * median)
    };
    Array {
        name: "horizon".to_owned(),
        scalar: "UInt8".to_owned(),
        n_components: 1,
        bytes: hits.iter().map(|pixel| is_horizon(pixel).into()).collect(),
    }
}

/// The arrays that both files have, in their order, for these pixels.
fn point_data(film: &Film, pixels: &[Pixel]) -> Vec<Array> {
    let counter = |counter| Field::Counts(counts(film, counter));
    let fields = [
        ("pixel_x", Field::Coordinate(|pixel| pixel.x)),
        ("pixel_y", Field::Coordinate(|pixel| pixel.y)),
        ("object", Field::I32(|strip| &strip.object)),
        ("material", Field::I32(|strip| &strip.material)),
        ("RGB", Field::Rgb(|strip| &strip.rgb)),
        ("Normals", Field::Vec3(|strip| &strip.normal)),
        ("distance", Field::F32(|strip| &strip.distance)),
        ("footprint", Field::F32(|strip| &strip.footprint)),
        ("time_ns", Field::F32(|strip| &strip.time_ns)),
        ("time_mad_ns", Field::F32(|strip| &strip.time_mad_ns)),
        ("node_visits", counter(Counter::NodeVisits)),
        ("primitive_tests", counter(Counter::PrimitiveTests)),
        ("rays", Field::Counts(rays(film))),
        ("shadow_rays", counter(Counter::ShadowRays)),
        ("reflection_rays", counter(Counter::ReflectionRays)),
        ("refraction_rays", counter(Counter::RefractionRays)),
        ("diffuse_rays", counter(Counter::DiffuseRays)),
        ("depth", counter(Counter::Depth)),
        ("tile", Field::Tile(|number, _| number)),
        ("thread", Field::Tile(|_, tile| tile.thread)),
    ];
    let array = |(name, field): &(&str, Field)| field.array(name, film, pixels);
    let (geometry, cost) = fields.split_at(8);
    let (time, counters) = cost.split_at(2);
    let (time, counters) = match (film.cost, film.repeats) {
        (CostMode::None, _) => (&[][..], &[][..]),
        (CostMode::Counters, _) => (&[][..], counters),
        (_, Repeats::ONCE) => (&time[..1], counters),
        _ => (time, counters),
    };
    let radiance = [("radiance", Field::Vec3(|strip| &strip.radiance))];
    let radiance = radiance.iter().filter(|_| film.extra.radiance_in_vtk);
    let bounces = [("rays_by_bounce", Field::Bounces)];
    let bounces = bounces.iter().filter(|_| film.extra.bounces);
    let instance = [("instance", Field::I32(|strip| &strip.instance))];
    let instance = instance.iter().filter(|_| film.extra.instance);
    let fields = geometry.iter().chain(time).chain(counters);
    let fields = fields.chain(radiance).chain(bounces).chain(instance);
    fields.map(array).collect()
}

/// The accessor of an array of the film, by its type.
enum Field {
    Coordinate(fn(&Pixel) -> u32),
    Rgb(fn(&Strip) -> &Vec<[u8; 3]>),
    Vec3(fn(&Strip) -> &Vec<Vec3>),
    F32(fn(&Strip) -> &Vec<f32>),
    I32(fn(&Strip) -> &Vec<i32>),
    Bounces,
    /// Of all pixels.
    Counts(Vec<u32>),
    /// By the tile and its number.
    Tile(fn(u32, &RenderedTile) -> u32),
}

impl Field {
    fn array(&self, name: &str, film: &Film, pixels: &[Pixel]) -> Array {
        let (scalar, n_components) = match self {
            Self::Coordinate(_) => ("UInt16", 1),
            Self::Rgb(_) => ("UInt8", 3),
            Self::Vec3(_) => ("Float32", 3),
            Self::F32(_) => ("Float32", 1),
            Self::I32(_) => ("Int32", 1),
            Self::Counts(_) => ("UInt32", 1),
            Self::Bounces => ("UInt32", 8),
            Self::Tile(_) => ("Int32", 1),
        };
        let mut bytes = Vec::new();
        for pixel in pixels {
            match self {
                Self::Coordinate(of) => bytes.extend((of(pixel) as u16).to_ne_bytes()),
                Self::Rgb(field) => bytes.extend(pixel.of(film, *field)),
                Self::Vec3(field) => {
                    let vector = pixel.of(film, *field).to_array();
                    bytes.extend(vector.iter().flat_map(|number| number.to_ne_bytes()));
                }
                Self::F32(field) => bytes.extend(pixel.of(film, *field).to_ne_bytes()),
                Self::I32(field) => bytes.extend(pixel.of(film, *field).to_ne_bytes()),
                Self::Bounces => {
                    let rays = pixel.of(film, |strip| &strip.bounces);
                    bytes.extend(rays.iter().flat_map(|n| n.to_ne_bytes()));
                }
                Self::Counts(counts) => {
                    let count = counts[(pixel.y * film.grid.width + pixel.x) as usize];
                    bytes.extend(count.to_ne_bytes());
                }
                Self::Tile(field) => {
                    let TileGrid {
                        tile_size,
                        n_columns,
                        ..
                    } = film.grid;
                    let number = pixel.y / tile_size * n_columns + pixel.x / tile_size;
                    let number = field(number, &film.tiles[number as usize]);
                    bytes.extend(number.to_ne_bytes());
                }
            }
        }
        Array {
            name: name.to_owned(),
            scalar: scalar.to_owned(),
            n_components,
            bytes,
        }
    }
}

/// A pixel by its column and its row, row 0 on top.
struct Pixel {
    x: u32,
    y: u32,
}

impl Pixel {
    fn of<T: Copy>(&self, film: &Film, field: fn(&Strip) -> &Vec<T>) -> T {
        let strip = &film.strips[(self.y / STRIP_ROWS) as usize];
        field(strip)[(self.y % STRIP_ROWS * film.grid.width + self.x) as usize]
    }
}
