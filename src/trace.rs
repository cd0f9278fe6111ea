//! Ray → the surface point that it meets.

use glam::Vec3;

use crate::accel::Accel;
use crate::cost::{Probe, RayKind};
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
        let primitive = &self.scene.primitives[hit.primitive as usize];
        let (position, outward) = primitive.project(ray.at(hit.t));
        let faces_ray = outward.dot(ray.direction) <= 0.0;
        Some(SurfacePoint {
            position,
            normal: if faces_ray { outward } else { -outward },
            distance: hit.t,
            object: primitive.object,
            material: primitive.material,
        })
    }

    /// Whether a shadow ray is stopped before `t_max` by anything but the
    /// `ignored` object.
    pub fn is_shadowed<P: Probe>(
        &self,
        ray: &Ray,
        t_max: f32,
        ignored: Option<ObjectId>,
        probe: &mut P,
    ) -> bool {
        probe.ray(RayKind::Shadow);
        self.accel.occluded(ray, t_max, ignored, probe)
    }
}
