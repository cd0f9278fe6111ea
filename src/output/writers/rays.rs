//! `rays.vtp`: the rays of some pixels as lines.

use std::io::{self, Seek, Write};

use glam::{DVec3, Vec3};

use super::bounding_sphere::BoundingSphere;
use super::points::points;
use render::attribution::{ObservedPixel, TracedRay};
use render::film::Film;
use tracer::cost::Metric;
use vtk::appended;
use vtk::array::{Array, Entry, separate_cells};
use vtk::data_set::{CellMesh, DataSet};
use vtk::encoding::Encoding;
use world::camera::ImagePlane;
use world::geometry::LENGTH_UNIT;
use world::scene::{Primitive, Scene};

/// The name of the file.
pub const FILE: &str = "rays.vtp";
/// The name of the file with the cloud around the rays.
pub(super) const CLOUD: &str = "rays_cloud.vtu";

/// Traced pixels of a picture with all of their rays, and a cloud of the scene.
#[derive(Debug, Clone, Copy)]
pub struct Traced<'a> {
    /// The name of the scene.
    pub name: &'a str,
    /// The time of the frame, for an animated scene.
    pub time: Option<f64>,
    /// The scene that the rays were traced through.
    pub scene: &'a Scene,
    /// The image plane of the picture.
    pub plane: &'a ImagePlane,
    /// The pixels, with at most `i32::MAX` rays.
    pub pixels: &'a [ObservedPixel],
    /// True if the rays were timed.
    pub is_timed: bool,
    /// A small film of the scene, whose hits form the cloud.
    pub cloud: &'a Film,
}

/// The rays of traced pixels, in the order of the file.
pub(super) struct Rays<'a> {
    traced: Traced<'a>,
    /// Determines the length of rays without a hit.
    pub(super) bounding_sphere: BoundingSphere,
    /// The number of rays.
    pub(super) n: usize,
}

impl<'a> Rays<'a> {
    pub(super) fn new(traced: &Traced<'a>) -> Self {
        let n_rays = traced.pixels.iter().map(|pixel| pixel.tree.rays.len());
        Self {
            traced: *traced,
            bounding_sphere: BoundingSphere::new(traced.scene, traced.plane),
            n: n_rays.sum(),
        }
    }

    /// Returns the name of the scene.
    pub(super) fn name(&self) -> &'a str {
        self.traced.name
    }

    /// Returns the image plane of the picture.
    pub(super) fn plane(&self) -> &'a ImagePlane {
        self.traced.plane
    }

    /// Returns the center and the radius of the bounding sphere in world space.
    pub(super) fn sphere_in_world(&self) -> (DVec3, f32) {
        let (space, BoundingSphere { center, radius }) = (self.plane().space, self.bounding_sphere);
        (space.world_point(center), space.world_length(radius))
    }

    /// Returns the film whose hits form the cloud.
    pub(super) fn cloud(&self) -> &'a Film {
        self.traced.cloud
    }

    /// Writes them as PolyData with one line per ray.
    pub(super) fn write(
        &self,
        encoding: Encoding,
        out: &mut (impl Write + Seek),
    ) -> io::Result<()> {
        let [connectivity, offsets] = separate_cells(2, self.n);
        let lines = CellMesh {
            n_points: 2 * self.n,
            n_cells: self.n,
            point_data: Vec::new(),
            cell_data: self.cell_data(),
            points: points(&self.traced.scene.space, 2 * self.n, || {
                self.iter().flat_map(|ray| self.line(ray))
            }),
            cells: vec![connectivity, offsets],
        };
        appended::write(&DataSet::Lines(lines), encoding, out)
    }

    fn cell_data(&self) -> Vec<Array<'_>> {
        let mut arrays = vec![
            self.array("kind", |ray| ray.kind as i32),
            Array::new("parent", self.n, || self.parents()),
            self.pixel_numbers(),
            self.array("sample", |ray| ray.sample as i32),
            self.array("bounce", |ray| ray.bounce as i32),
            self.array("light", |ray| ray.light.map_or(-1, |light| light as i32)),
            self.array("object", |ray| self.met(ray, |met| met.object.0)),
            self.array("material", |ray| self.met(ray, |met| met.material.0)),
            self.array("primitive", |ray| {
                ray.surface().map_or(-1, |hit| hit.primitive as i32)
            }),
            self.lengths("distance", |ray| ray.end().unwrap_or(f32::NAN)),
            self.lengths("length", |ray| self.bounding_sphere.length(ray)),
            self.cost(Metric::NODE_VISITS, |ray| ray.node_visits),
            self.cost(Metric::PRIMITIVE_TESTS, |ray| ray.primitive_tests),
        ];
        if self.traced.scene.instances.is_some() {
            arrays.push(self.array("instance", |ray| {
                let instance = ray.surface().and_then(|hit| hit.instance);
                instance.map_or(-1, |id| id.0 as i32)
            }));
        }
        if self.traced.is_timed {
            arrays.push(self.cost(Metric::TIME, |ray| ray.time_ns));
        }
        arrays.push(self.array("contribution", |ray| ray.contribution.to_array()));
        arrays.push(self.array("direction", |ray| ray.ray.direction.to_array()));
        arrays
    }

    /// Returns the rays, pixel by pixel.
    pub(super) fn iter(&self) -> impl Iterator<Item = &'a TracedRay> + use<'a> {
        self.traced.pixels.iter().flat_map(|pixel| &pixel.tree.rays)
    }

    /// Returns the line that shows a ray, in render space.
    pub(super) fn line(&self, ray: &TracedRay) -> [Vec3; 2] {
        [ray.ray.origin, ray.ray.at(self.bounding_sphere.length(ray))]
    }

    /// Returns an array of lengths in world space, given lengths in render space.
    fn lengths<'s>(
        &'s self,
        name: &'static str,
        length: impl Fn(&TracedRay) -> f32 + Copy + Sync + 's,
    ) -> Array<'s> {
        let space = self.traced.scene.space;
        self.array(name, move |ray| space.world_length(length(ray)))
            .in_unit(LENGTH_UNIT)
    }

    fn array<'s, E: Entry>(
        &'s self,
        name: &'static str,
        value: impl Fn(&TracedRay) -> E + Copy + Sync + 's,
    ) -> Array<'s> {
        Array::new(name, self.n, move || self.iter().map(value))
    }

    fn cost<'s, E: Entry>(
        &'s self,
        metric: Metric,
        value: impl Fn(&TracedRay) -> E + Copy + Sync + 's,
    ) -> Array<'s> {
        self.array(metric.name, value).in_unit(metric.unit_label())
    }

    /// Returns the index of each ray's parent in the file; -1 for none.
    fn parents(&self) -> impl Iterator<Item = i32> + '_ {
        let mut first = 0;
        self.traced.pixels.iter().flat_map(move |pixel| {
            let first_of_pixel = first;
            first += pixel.tree.rays.len() as i32;
            let number = move |parent: u32| first_of_pixel + parent as i32;
            pixel
                .tree
                .rays
                .iter()
                .map(move |ray| ray.parent.map_or(-1, number))
        })
    }

    /// Returns the pixel of each ray, y * width + x, in the smallest integer type that holds all
    /// pixels.
    fn pixel_numbers(&self) -> Array<'_> {
        let [width, height] = self.traced.plane.size.map(i64::from);
        match i32::try_from(width * height) {
            Ok(_) => self.pixel_array(move |x, y| (y * width + x) as i32),
            Err(_) => self.pixel_array(move |x, y| y * width + x),
        }
    }

    fn pixel_array<'s, E: Entry>(
        &'s self,
        number: impl Fn(i64, i64) -> E + Copy + Sync + 's,
    ) -> Array<'s> {
        Array::new("pixel", self.n, move || {
            self.traced.pixels.iter().flat_map(move |pixel| {
                let (x, y) = pixel.place;
                std::iter::repeat_n(number(x.into(), y.into()), pixel.tree.rays.len())
            })
        })
    }

    /// Returns a number of the primitive that each ray hits; -1 without a hit.
    fn met(&self, ray: &TracedRay, number: impl Fn(&Primitive) -> u32) -> i32 {
        ray.surface().map_or(-1, |hit| {
            number(&self.traced.scene.primitives[hit.primitive as usize]) as i32
        })
    }
}
