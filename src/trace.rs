//! Ray → the surface point that it hits.

use glam::Vec3;

use crate::accel::{Accel, Hit, ShadowRay, TraversalStep};
use crate::cost::{ByPixel, PixelProbe, Probe, RayKind};
use crate::geometry::Ray;
use crate::scene::{MaterialId, ObjectId, Scene};

/// Traces rays through a scene and reports their counters to a probe.
#[derive(Debug, Clone, Copy)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    accel: &'a Accel<'a>,
}

/// A point of a surface that a ray has hit, in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point, projected onto the surface to remove the rounding error.
    pub position: Vec3,
    /// The shading normal, a unit vector on the same side as the geometric one.
    pub normal: Vec3,
    /// The geometric normal, a unit vector on the side from which the ray came: it
    /// distinguishes the sides of the surface.
    pub geometric_normal: Vec3,
    /// The color of the surface there.
    pub color: Vec3,
    /// Distance along the ray, greater than 0.
    pub distance: f32,
    /// The object that was hit.
    pub object: ObjectId,
    /// Its material.
    pub material: MaterialId,
    /// Whether both normals are opposite to the surface's own, because the ray came
    /// from its other side.
    pub is_flipped: bool,
}

impl SurfacePoint {
    /// The surface's own normal for one of the point's normals, whichever side the
    /// ray came from.
    pub fn outward(&self, normal: Vec3) -> Vec3 {
        if self.is_flipped { -normal } else { normal }
    }

    /// Whether a direction points away from the visible side of the surface, by
    /// both normals.
    pub fn is_faced_by(&self, direction: Vec3) -> bool {
        self.normal.dot(direction) > 0.0 && self.geometric_normal.dot(direction) > 0.0
    }

    /// The mirror direction of an incoming direction, a unit vector: by the shading
    /// normal, or by the geometric one if the former would point into the
    /// surface.
    pub fn mirrored(&self, direction: Vec3) -> Vec3 {
        let by = |normal| direction.reflect(normal).normalize();
        let mirrored = by(self.normal);
        if mirrored.dot(self.geometric_normal) > 0.0 {
            mirrored
        } else {
            by(self.geometric_normal)
        }
    }
}

impl<'a> Tracer<'a> {
    /// Traces rays through `scene`; `accel` is a structure over its primitives.
    pub fn new(scene: &'a Scene, accel: &'a Accel<'a>) -> Self {
        Self { scene, accel }
    }

    /// The nearest surface point on the ray, whose direction is a unit vector.
    pub fn trace<P: Probe>(&self, ray: &Ray, kind: RayKind, probe: &mut P) -> Option<SurfacePoint> {
        probe.ray(kind);
        let hit = self.accel.nearest(ray, probe)?;
        Some(self.surface_point(ray, hit))
    }

    /// Whether the shadow ray is occluded.
    pub fn is_shadowed<P: Probe>(&self, shadow: &ShadowRay, probe: &mut P) -> bool {
        probe.ray(RayKind::Shadow);
        self.accel
            .occluded(&shadow.ray, shadow.t_max, shadow.ignored, probe)
    }

    /// The hit that [`trace`](Self::trace) finds; appends every step of the
    /// traversal to `steps`.
    pub fn record(&self, ray: &Ray, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        self.accel.record_nearest(ray, steps)
    }

    /// The hit that occludes the ray of [`is_shadowed`](Self::is_shadowed); appends
    /// every step of the traversal to `steps`.
    pub fn record_shadow(&self, shadow: &ShadowRay, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        self.accel.record_occluded(shadow, steps)
    }

    /// The nearest hits of many rays. Overwrites `hits` with one entry per ray.
    /// Reports the traversals to the probes, but not the starts of the rays: that
    /// is up to the caller.
    pub fn nearest_stream<P: PixelProbe>(
        &self,
        rays: &[Ray],
        hits: &mut Vec<Option<Hit>>,
        mut probes: ByPixel<P>,
    ) {
        self.accel.nearest_stream(rays, hits, &mut probes);
    }

    /// [`is_shadowed`](Self::is_shadowed) of many rays, in the manner of
    /// [`nearest_stream`](Self::nearest_stream). Overwrites `shadowed` with one
    /// entry per ray.
    pub fn shadow_stream<P: PixelProbe>(
        &self,
        rays: &[ShadowRay],
        shadowed: &mut Vec<bool>,
        mut probes: ByPixel<P>,
    ) {
        self.accel.occluded_stream(rays, shadowed, &mut probes);
    }

    /// The surface point of a hit.
    pub fn surface_point(&self, ray: &Ray, hit: Hit) -> SurfacePoint {
        let primitive = &self.scene.primitives[hit.primitive as usize];
        let (position, outward) = primitive.project(ray.at(hit.t));
        let is_flipped = outward.dot(ray.direction) > 0.0;
        let geometric_normal = if is_flipped { -outward } else { outward };
        let normal = match self.scene.shading_normal(hit.primitive, position) {
            None => geometric_normal,
            Some(normal) if normal.dot(geometric_normal) < 0.0 => -normal,
            Some(normal) => normal,
        };
        SurfacePoint {
            position,
            normal,
            geometric_normal,
            color: self.scene.color(hit.primitive, position),
            distance: hit.t,
            object: primitive.object,
            material: primitive.material,
            is_flipped,
        }
    }
}
