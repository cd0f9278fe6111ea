//! The rays: the primary rays of an image, and three from each of their hits.

use std::f32::consts::TAU;

use glam::Vec3;
use math::sampling::uniform;
use tracer::accel::{Accel, ShadowRay, ShadowStream};
use tracer::cost::NoProbe;
use world::geometry::{Aabb, Ray, RayStream};
use world::scene::Primitive;

use crate::scenes::View;

/// Rows and columns of a tile, as in the renderer.
const TILE_SIDE: usize = 16;

/// The kinds of rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// From the eye, tile by tile.
    Primary,
    /// From each of their hits, in a cosine-distributed direction.
    Diffuse,
    /// The same in another direction, with a length of a tenth of the scene.
    AmbientOcclusion,
    /// From each hit to a point of an area light.
    Shadow,
}

/// Rays by their query.
pub enum Rays {
    Nearest(RayStream),
    Any(ShadowStream),
}

impl Rays {
    pub fn len(&self) -> usize {
        match self {
            Self::Nearest(rays) => rays.len(),
            Self::Any(rays) => rays.len(),
        }
    }
}

impl Rays {
    /// Returns the rays in batches of `n`.
    pub fn batches(&self, n: usize) -> Vec<Self> {
        let starts = (0..self.len()).step_by(n);
        let batch = |first: usize| match self {
            Self::Nearest(rays) => Self::Nearest(rays.iter().skip(first).take(n).collect()),
            Self::Any(rays) => Self::Any(rays.iter().skip(first).take(n).collect()),
        };
        starts.map(batch).collect()
    }
}

/// Returns all kinds of rays for a square image of `side` rows.
pub fn all(accel: &Accel, primitives: &[Primitive], view: &View, side: usize) -> [(Kind, Rays); 4] {
    let bounds = primitives
        .iter()
        .map(Primitive::bounds)
        .fold(Aabb::EMPTY, Aabb::union);
    let size = (bounds.max - bounds.min).length();
    let primary: Vec<Ray> = tiled(side).map(|i| view.ray(i, side)).collect();
    let (mut diffuse, mut ambient, mut shadow) = (Vec::new(), Vec::new(), Vec::new());
    for (i, ray) in primary.iter().enumerate() {
        let Some(hit) = accel.nearest(ray, &mut NoProbe) else {
            continue;
        };
        let primitive = &primitives[hit.primitive as usize];
        let (position, outward) = primitive.project(ray.at(hit.t));
        let normal = outward * -outward.dot(ray.direction).signum();
        let error = primitive.rounding([position, normal]);
        let leaving = |direction| Ray::leaving([position, normal], error, direction);
        let random = |stream| uniform([stream, i as u64, 0]);
        diffuse.push(leaving(cosine_distributed(normal, random(0))));
        ambient.push(ShadowRay {
            ray: leaving(cosine_distributed(normal, random(1))),
            t_max: 0.1 * size,
            ignored: None,
        });
        let [x, y, z, _] = random(2);
        let light = view.light + 0.05 * size * (Vec3::new(x, y, z) - 0.5);
        let to_light = light - position;
        shadow.push(ShadowRay {
            ray: leaving(to_light.normalize()),
            t_max: 0.999 * to_light.length(),
            ignored: None,
        });
    }
    [
        (Kind::Primary, Rays::Nearest(primary.into_iter().collect())),
        (Kind::Diffuse, Rays::Nearest(diffuse.into_iter().collect())),
        (
            Kind::AmbientOcclusion,
            Rays::Any(ambient.into_iter().collect()),
        ),
        (Kind::Shadow, Rays::Any(shadow.into_iter().collect())),
    ]
}

/// Returns the pixels of a square image, as y * side + x, in the order of the tiles and of the
/// blocks within them.
fn tiled(side: usize) -> impl Iterator<Item = usize> {
    let starts = move |step| (0..side).step_by(step);
    let tiles = starts(TILE_SIDE).flat_map(move |y| starts(TILE_SIDE).map(move |x| (x, y)));
    let blocks = tiles.flat_map(|(x, y)| {
        let blocks = (0..TILE_SIDE / 4).flat_map(|j| (0..TILE_SIDE / 4).map(move |i| (i, j)));
        blocks.map(move |(i, j)| (x + 4 * i, y + 4 * j))
    });
    let pixels = blocks.flat_map(|(x, y)| (0..16).map(move |i| (x + i % 4, y + i / 4)));
    let is_inside = move |&(x, y): &(usize, usize)| x < side && y < side;
    pixels.filter(is_inside).map(move |(x, y)| y * side + x)
}

/// Returns a cosine-distributed unit vector above the surface: the normal plus a point of the unit
/// sphere, which is scaled by 0.999 so that it cannot cancel the normal.
fn cosine_distributed(normal: Vec3, [u, v, ..]: [f32; 4]) -> Vec3 {
    let z = 1.0 - 2.0 * v;
    let (sin, cos) = (TAU * u).sin_cos();
    let on_sphere = Vec3::new(cos, sin, 0.0) * (1.0 - z * z).max(0.0).sqrt() + Vec3::Z * z;
    (normal + 0.999 * on_sphere).normalize()
}
