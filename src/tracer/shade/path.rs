//! The rays of a path.

use glam::Vec3;

use super::eye_media::EyeMedia;
use super::media::Media;
use super::numbers::SampleId;
use crate::cost::RayKind;
use math::simd::{Real, Vector};
use world::geometry::Ray;

/// A ray that starts at the camera, or continues a path from a surface.
#[derive(Debug, Clone, Copy)]
pub struct PathRay {
    /// The ray.
    pub ray: Ray,
    /// The kind of the ray.
    pub kind: RayKind,
    /// Number of bounces before the ray.
    pub depth: u32,
    /// Length of the path before the ray, in world units.
    pub length: f32,
    /// The share of the radiance met by the ray that reaches the camera.
    pub(super) weight: Vec3,
    /// The media that the ray is in.
    pub(super) media: Media,
    /// The density with which the ray's direction was chosen, per steradian; infinite if there was
    /// no choice.
    pub(super) density: f32,
    /// The sample that the path belongs to.
    pub id: SampleId<u32>,
}

impl PathRay {
    /// Returns the camera ray of a sample, which starts in one of these media.
    pub fn from_camera(ray: Ray, eye_media: &EyeMedia, id: SampleId<u32>) -> Self {
        Self {
            ray,
            kind: RayKind::Camera,
            depth: 0,
            length: 0.0,
            weight: Vec3::ONE,
            media: eye_media.at(ray.origin),
            density: f32::INFINITY,
            id,
        }
    }
}

/// Least weight of a ray that is split off at a surface, in its greatest channel: without a limit,
/// the number of rays doubles with each bounce.
const MIN_WEIGHT: f32 = 1.0 / 4096.0;

/// Returns true if a ray of this weight, split off at a surface, is traced.
#[inline(always)]
pub(super) fn is_worth_tracing<R: Real>(Vector { x, y, z }: Vector<R>) -> R::Mask {
    x.splat(MIN_WEIGHT).le(x.max(y).max(z))
}
