//! Ray → the surface point that it meets.

use glam::Vec3;

use crate::accel::{Accel, Hit, ShadowRay};
use crate::cost::{ByPixel, Probe, RayKind};
use crate::geometry::Ray;
use crate::scene::{MaterialId, ObjectId, Scene};

/// Follows rays through a scene and tells the probe of each.
#[derive(Debug, Clone, Copy)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    accel: &'a Accel<'a>,
}

/// Where a ray met a surface, in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point, brought back onto the surface after rounding.
    pub position: Vec3,
    /// The unit normal on the side that the ray came from.
    pub normal: Vec3,
    /// Distance along the ray, greater than 0.
    pub distance: f32,
    /// The object that was met.
    pub object: ObjectId,
    /// What it is made of there.
    pub material: MaterialId,
}

impl<'a> Tracer<'a> {
    /// Follows rays through `scene`, whose primitives `accel` finds.
    pub fn new(scene: &'a Scene, accel: &'a Accel<'a>) -> Self {
        Self { scene, accel }
    }

    /// The nearest surface point on the ray, whose direction is a unit vector.
    pub fn trace<P: Probe>(&self, ray: &Ray, kind: RayKind, probe: &mut P) -> Option<SurfacePoint> {
        probe.ray(kind);
        let hit = self.accel.nearest(ray, probe)?;
        Some(self.surface_point(ray, hit))
    }

    /// Whether anything is in the shadow ray's way.
    pub fn is_shadowed<P: Probe>(&self, shadow: &ShadowRay, probe: &mut P) -> bool {
        probe.ray(RayKind::Shadow);
        self.accel
            .occluded(&shadow.ray, shadow.t_max, shadow.ignored, probe)
    }

    /// The nearest hits of many rays of one kind: `hits` becomes one entry a
    /// ray.
    pub fn nearest_stream<P: Probe>(
        &self,
        rays: &[Ray],
        kind: RayKind,
        hits: &mut Vec<Option<Hit>>,
        mut probes: ByPixel<P>,
    ) {
        probes.rays(kind);
        self.accel.nearest_stream(rays, hits, &mut probes);
    }

    /// [`is_shadowed`](Self::is_shadowed) of many rays: `shadowed` becomes one
    /// entry a ray.
    pub fn shadow_stream<P: Probe>(
        &self,
        rays: &[ShadowRay],
        shadowed: &mut Vec<bool>,
        mut probes: ByPixel<P>,
    ) {
        probes.rays(RayKind::Shadow);
        self.accel.occluded_stream(rays, shadowed, &mut probes);
    }

    /// The surface point of a ray's hit.
    pub fn surface_point(&self, ray: &Ray, hit: Hit) -> SurfacePoint {
        let primitive = &self.scene.primitives[hit.primitive as usize];
        let (position, outward) = primitive.project(ray.at(hit.t));
        let faces_ray = outward.dot(ray.direction) <= 0.0;
        SurfacePoint {
            position,
            normal: if faces_ray { outward } else { -outward },
            distance: hit.t,
            object: primitive.object,
            material: primitive.material,
        }
    }
}
