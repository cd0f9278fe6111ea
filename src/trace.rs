//! Ray → the surface point that it meets.

use glam::Vec3;

use crate::accel::{Accel, Hit, ShadowRay, TraversalStep};
use crate::cost::{ByPixel, PixelProbe, Probe, RayKind};
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
    /// The unit normal to shade with, on the same side as the geometric one.
    pub normal: Vec3,
    /// The surface's own unit normal, on the side that the ray came from: what
    /// tells the sides of the surface apart.
    pub geometric_normal: Vec3,
    /// Its colour there.
    pub color: Vec3,
    /// Distance along the ray, greater than 0.
    pub distance: f32,
    /// The object that was met.
    pub object: ObjectId,
    /// What it is made of there.
    pub material: MaterialId,
    /// Whether both normals are turned against those that the surface has
    /// itself, since the ray came from its other side.
    pub is_turned: bool,
}

impl SurfacePoint {
    /// One of the point's normals as the surface has it, whichever side the ray
    /// came from.
    pub fn outward(&self, normal: Vec3) -> Vec3 {
        if self.is_turned { -normal } else { normal }
    }

    /// Whether a direction leaves the surface on the seen side, by both of its
    /// normals.
    pub fn is_faced_by(&self, direction: Vec3) -> bool {
        self.normal.dot(direction) > 0.0 && self.geometric_normal.dot(direction) > 0.0
    }

    /// The unit direction of the mirror image of one that comes to the point,
    /// by the shading normal; by the geometric one where that would lead into
    /// the surface.
    pub fn mirrored(&self, direction: Vec3) -> Vec3 {
        let by = |normal| direction.reflect(normal).normalize();
        let mirrored = by(self.normal);
        match mirrored.dot(self.geometric_normal) > 0.0 {
            true => mirrored,
            false => by(self.geometric_normal),
        }
    }
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

    /// The hit that [`trace`](Self::trace) finds, with every step of the ray
    /// added to `steps`.
    pub fn record(&self, ray: &Ray, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        self.accel.record_nearest(ray, steps)
    }

    /// The hit that [`is_shadowed`](Self::is_shadowed) finds, with every step of
    /// the ray added to `steps`.
    pub fn record_shadow(&self, shadow: &ShadowRay, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        self.accel.record_occluded(shadow, steps)
    }

    /// The nearest hits of many rays: `hits` becomes one entry a ray. The probes
    /// hear of each ray's traversal; that it started is for them who made it to
    /// tell.
    pub fn nearest_stream<P: PixelProbe>(
        &self,
        rays: &[Ray],
        hits: &mut Vec<Option<Hit>>,
        mut probes: ByPixel<P>,
    ) {
        self.accel.nearest_stream(rays, hits, &mut probes);
    }

    /// [`is_shadowed`](Self::is_shadowed) of many rays, as
    /// [`nearest_stream`](Self::nearest_stream) does it: `shadowed` becomes one
    /// entry a ray.
    pub fn shadow_stream<P: PixelProbe>(
        &self,
        rays: &[ShadowRay],
        shadowed: &mut Vec<bool>,
        mut probes: ByPixel<P>,
    ) {
        self.accel.occluded_stream(rays, shadowed, &mut probes);
    }

    /// The surface point of a ray's hit.
    pub fn surface_point(&self, ray: &Ray, hit: Hit) -> SurfacePoint {
        let primitive = &self.scene.primitives[hit.primitive as usize];
        let (position, outward) = primitive.project(ray.at(hit.t));
        let is_turned = outward.dot(ray.direction) > 0.0;
        let geometric_normal = if is_turned { -outward } else { outward };
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
            is_turned,
        }
    }
}
