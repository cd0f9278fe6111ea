//! A sample of some pixels → its rays, launch by launch.

use std::collections::{BTreeMap, VecDeque};
use std::iter::repeat_n;

use glam::Vec3;
use rayon::prelude::*;

use crate::tiles::{PathProbe, View, follow_sample};
use base::stop;
use tracer::cost::{Cost, RayKind};
use tracer::shade::{LightSample, PathRay};
use tracer::trace::SurfacePoint;
use world::geometry::Ray;

/// Columns and rows of the pixels whose rays are launched together, except at the edges of the
/// picture.
pub const LAUNCH_SIDE: u32 = 256;

/// A kind of rays that warps trace together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LaneKind {
    /// Camera rays.
    Camera,
    /// Rays toward lights.
    Shadow,
    /// Rays that continue a path: reflected, refracted or scattered.
    Bounce,
}

/// Rays that are traced at the same time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Launch {
    pub(super) kind: LaneKind,
    /// Number of bounces before the rays.
    bounce: u32,
    /// The number of each among the shadow rays of its hit, from 0; 0 for other rays.
    number: u32,
}

/// The rays of launches, each pixel by pixel, row by row.
pub(super) type Launches = BTreeMap<Launch, Vec<LaneRay>>;

/// A ray in a lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneRay {
    /// Index of the pixel in the block.
    pub(super) pixel: u16,
    /// The signs of the direction: bit 0 is set if x is negative, bit 1 for y, bit 2 for z.
    pub(super) octant: u8,
    /// Node visits and primitive tests.
    pub(super) steps: u32,
    /// The material that the ray starts from; [`NO_MATERIAL`] for none.
    pub(super) material: u32,
}

/// The material that camera rays start from, and rays from particles of fog.
const NO_MATERIAL: u32 = u32::MAX;

/// Pixels whose rays are launched together.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelBlock {
    /// The first column of pixels, and the one after the last.
    columns: [u32; 2],
    /// The first row of pixels, and the one after the last; row 0 is on top.
    rows: [u32; 2],
}

impl LaneKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Camera, Self::Shadow, Self::Bounce];

    /// Returns the kind's name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Shadow => "shadow",
            Self::Bounce => "bounce",
        }
    }
}

impl PixelBlock {
    /// Returns the blocks of a picture of this size, row by row.
    pub(super) fn all(width: u32, height: u32) -> impl Iterator<Item = Self> {
        let spans = |end: u32| {
            let starts = (0..end).step_by(LAUNCH_SIDE as usize);
            starts.map(move |first| [first, (first + LAUNCH_SIDE).min(end)])
        };
        spans(height).flat_map(move |rows| spans(width).map(move |columns| Self { columns, rows }))
    }

    /// Returns the number of pixels.
    pub(super) fn n_pixels(&self) -> u64 {
        let n = |[first, end]: [u32; 2]| u64::from(end - first);
        n(self.columns) * n(self.rows)
    }

    /// Returns the pixels (column, row), row by row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (block, [top, bottom]) = (*self, self.rows);
        (top..bottom).flat_map(move |y| block.row(y))
    }

    /// Returns the pixels of a row.
    fn row(&self, y: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
        let [left, right] = self.columns;
        (left..right).map(move |x| (x, y))
    }

    /// Returns the index of a pixel in a block of full size.
    pub(super) fn index(&self, place: (u32, u32)) -> usize {
        ((place.1 - self.rows[0]) * LAUNCH_SIDE + place.0 - self.columns[0]) as usize
    }

    /// Returns the column and the row of the pixel with an index.
    pub(super) fn place(&self, index: u16) -> (u32, u32) {
        let index = u32::from(index);
        (
            self.columns[0] + index % LAUNCH_SIDE,
            self.rows[0] + index / LAUNCH_SIDE,
        )
    }
}

/// Traces a sample of those pixels of a block that have it, on the current rayon pool.
pub(super) fn trace(
    view: &View,
    block: &PixelBlock,
    sample: u32,
    has_sample: impl Fn((u32, u32)) -> bool + Sync,
) -> Launches {
    let [top, bottom] = block.rows;
    let rows = (top..bottom).into_par_iter().map(|y| {
        let mut probe = LaneProbe {
            view,
            pixel: 0,
            starts: VecDeque::new(),
            launches: Launches::new(),
        };
        let mut paths = Vec::new();
        let places = block.row(y).take_while(|_| !stop::is_requested());
        for place in places.filter(|&place| has_sample(place)) {
            probe.pixel = block.index(place) as u16;
            follow_sample(view, place, sample, &mut paths, &mut probe);
        }
        probe.launches
    });
    let rows: Vec<Launches> = rows.collect();
    let mut launches = Launches::new();
    for (launch, rays) in rows.into_iter().flatten() {
        launches.entry(launch).or_default().extend(rays);
    }
    launches
}

/// Puts the rays of paths in launches.
struct LaneProbe<'a> {
    view: &'a View<'a>,
    pixel: u16,
    /// The materials that the path's rays still to be traced start from.
    starts: VecDeque<u32>,
    launches: Launches,
}

impl PathProbe for LaneProbe<'_> {
    fn trace(&mut self, path: &PathRay) -> Option<SurfacePoint> {
        let kind = match path.kind {
            RayKind::Camera => LaneKind::Camera,
            _ => LaneKind::Bounce,
        };
        let launch = Launch {
            kind,
            bounce: path.depth,
            number: 0,
        };
        let start = self.starts.pop_front().unwrap_or(NO_MATERIAL);
        let mut cost = Cost::default();
        let tracer = &self.view.tracer;
        let hit = tracer.trace_after(path.length, &path.ray, path.kind, &mut cost);
        self.add(launch, &path.ray, start, &cost);
        hit
    }

    fn shade(
        &mut self,
        eye: Vec3,
        path: &PathRay,
        met: Option<&SurfacePoint>,
        next: &mut Vec<PathRay>,
    ) -> Vec3 {
        let View { tracer, shader, .. } = self.view;
        let Some(point) = met else {
            return shader.miss(path);
        };
        let material = if shader.is_particle(point) {
            NO_MATERIAL
        } else {
            point.material.0
        };
        let mut arriving = |(number, sample): (usize, LightSample)| {
            if !shader.casts_shadows() {
                return Some(sample.light);
            }
            let launch = Launch {
                kind: LaneKind::Shadow,
                bounce: path.depth,
                number: number as u32,
            };
            let mut cost = Cost::default();
            let share = tracer.light_along(&sample.shadow, &mut cost);
            self.add(launch, &sample.shadow.ray, material, &cost);
            sample.light.weakened_to(share)
        };
        let lights = shader.light_samples(path, point).enumerate();
        let lights = lights.filter_map(&mut arriving);
        let n_before = next.len();
        let color = shader.shade(eye, path, point, lights, next);
        let n_new = next.len() - n_before;
        self.starts.extend(repeat_n(material, n_new));
        color
    }
}

impl LaneProbe<'_> {
    /// Adds a ray of the pixel, which starts from a material.
    fn add(&mut self, launch: Launch, ray: &Ray, material: u32, cost: &Cost) {
        self.launches.entry(launch).or_default().push(LaneRay {
            pixel: self.pixel,
            octant: ray.direction.is_negative_bitmask() as u8,
            steps: (cost.node_visits + cost.primitive_tests) as u32,
            material,
        });
    }
}
