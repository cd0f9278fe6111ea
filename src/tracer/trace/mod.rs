//! Rays → the surface points that they hit.
//!
//! [`Tracer`] traces rays one by one or as a stream. [`Points`] are the surface points of a
//! stream's hits, computed in lanes, with the formulas of a single point.

mod surface_point;
mod parameters;
mod points;
mod hit_attributes;
mod group_points;
mod find_points;
mod openings;

use crate::accel::{Accel, Hit, ShadowRay, ShadowStream, TraversalStep};
use crate::cost::{ByPixel, PixelProbe, Probe, RayKind};
use find_points::FindPoints;
pub(crate) use hit_attributes::{HitAttributes, HitPlace, shading_point};
use math::simd::{Simd, Vector};
pub(crate) use openings::passed_opacity;
pub use points::{PointGroup, PointLanes, Points};
pub use surface_point::{ShadingPoint, SurfacePoint};
use surface_point::{on_side_of, side, width};
use world::camera::RayCone;
use world::geometry::{Ray, RayStream};
use world::material::TexturePoint;
use world::scene::Scene;

/// A scene with a structure over its primitives: traces rays and reports their counters to a probe.
#[derive(Debug, Clone, Copy)]
pub struct Tracer<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The structure.
    pub accel: &'a Accel<'a>,
    /// The footprint of a camera ray, by which textures are filtered; `None` for a point.
    cone: Option<RayCone>,
}

/// The light along many shadow rays, and memory that their search reuses.
#[derive(Debug, Default)]
pub struct ShadowLight {
    /// The share of light that passes along each ray, 0 to 1.
    pub shares: Vec<f32>,
    occluded: Vec<bool>,
}

impl<'a> Tracer<'a> {
    /// Creates a tracer of rays through `scene`; `accel` is a structure over its primitives.
    pub fn new(scene: &'a Scene, accel: &'a Accel<'a>) -> Self {
        Self {
            scene,
            accel,
            cone: None,
        }
    }

    /// Filters textures by the footprint of a camera ray.
    pub fn with_cone(self, cone: Option<RayCone>) -> Self {
        Self { cone, ..self }
    }

    /// Returns the footprint of the camera rays, by which textures are filtered.
    pub fn cone(&self) -> Option<RayCone> {
        self.cone
    }

    /// Returns the nearest surface point on a camera ray, whose direction is a unit vector.
    pub fn trace<P: Probe>(&self, ray: &Ray, kind: RayKind, probe: &mut P) -> Option<SurfacePoint> {
        self.trace_after(0.0, ray, kind, probe)
    }

    /// Returns the nearest surface point on a ray, whose direction is a unit vector, after a path
    /// of this length from the camera.
    pub fn trace_after<P: Probe>(
        &self,
        length: f32,
        ray: &Ray,
        kind: RayKind,
        probe: &mut P,
    ) -> Option<SurfacePoint> {
        probe.ray(kind);
        let mut nearest = |ray: &Ray| self.accel.nearest(ray, probe);
        let hit = if self.scene.has_openings() {
            self.hit_past_openings(ray, nearest)?
        } else {
            nearest(ray)?
        };
        Some(self.surface_point(length, ray, hit))
    }

    /// Returns the share of light that passes along a shadow ray, 0 to 1.
    pub fn light_along<P: Probe>(&self, shadow: &ShadowRay, probe: &mut P) -> f32 {
        probe.ray(RayKind::Shadow);
        let ShadowRay {
            ray,
            t_max,
            ignored,
        } = shadow;
        if self.scene.has_openings() {
            return self.light_past_openings(shadow, |ray| self.accel.nearest(ray, probe));
        }
        share(self.accel.occluded(ray, *t_max, *ignored, probe))
    }

    /// Returns the hit that [`trace`](Self::trace) finds; appends every step of the traversal to
    /// `steps`.
    pub fn record(&self, ray: &Ray, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        let mut record = |ray: &Ray| self.accel.record_nearest(ray, steps);
        if self.scene.has_openings() {
            return self.hit_past_openings(ray, record);
        }
        record(ray)
    }

    /// Returns the hit that ends the light of [`light_along`](Self::light_along), if none passes;
    /// appends every step of the traversal to `steps`.
    pub fn record_shadow(&self, shadow: &ShadowRay, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        if self.scene.has_openings() {
            let record = |ray: &Ray| self.accel.record_nearest(ray, steps);
            return self.occluder_past_openings(shadow, record);
        }
        self.accel.record_occluded(shadow, steps)
    }

    /// Finds the nearest hits of many rays. Overwrites `hits` with one entry per ray. Reports the
    /// traversals to the probes, but not the starts of the rays, which the caller reports.
    pub fn nearest_stream<P: PixelProbe>(
        &self,
        rays: &RayStream,
        hits: &mut Vec<Option<Hit>>,
        mut probes: ByPixel<P>,
    ) {
        self.accel.nearest_stream(rays, hits, &mut probes);
        if self.scene.has_openings() {
            self.hits_past_openings(rays, hits, probes);
        }
    }

    /// Finds the light along many rays, as [`light_along`](Self::light_along) does, in the manner
    /// of [`nearest_stream`](Self::nearest_stream). Overwrites the shares with one per ray.
    pub fn shadow_stream<P: PixelProbe>(
        &self,
        rays: &ShadowStream,
        ShadowLight { shares, occluded }: &mut ShadowLight,
        mut probes: ByPixel<P>,
    ) {
        shares.clear();
        if self.scene.has_openings() {
            return self.shadows_past_openings(rays, shares, probes);
        }
        self.accel.occluded_stream(rays, occluded, &mut probes);
        shares.extend(occluded.iter().map(|&is_occluded| share(is_occluded)));
    }

    /// Returns the instruction set that waves are shaded with.
    pub fn simd(&self) -> Simd {
        self.accel.simd()
    }

    /// Divides these hits into groups of points, which [`surface_points`](Self::surface_points)
    /// computes.
    pub fn group_hits(&self, hits: &[Option<Hit>], points: &mut Points) {
        points.group(self.scene, hits);
    }

    /// Computes the surface points of the grouped hits of these rays. `lengths` are the lengths of
    /// the paths before the rays, with a [cone](Self::with_cone).
    pub fn surface_points(
        &self,
        lengths: &[f32],
        rays: &RayStream,
        hits: &[Option<Hit>],
        points: &mut Points,
    ) {
        self.simd().run(FindPoints {
            scene: self.scene,
            cone: self.cone,
            lengths,
            rays,
            hits,
            points,
        });
        if self.scene.splits_at_veils() {
            points.find_opacities(self.scene);
        }
    }

    /// Returns the surface point of a hit, after a path of this length.
    fn surface_point(&self, length: f32, ray: &Ray, hit: Hit) -> SurfacePoint {
        let primitive = &self.scene.primitives[hit.primitive as usize];
        // Project the hit onto the surface, which removes the rounding error.
        let placed = hit.placed();
        let (position, outward) = self.scene.project(placed, ray.at(hit.t));
        let opacity = if self.scene.splits_at_veils() {
            self.scene.opacity(placed, [position, outward])
        } else {
            1.0
        };
        let outward = Vector::from(outward);
        // Turn the normals to the side of the ray.
        let side = side(outward, ray.direction.into());
        let geometric_normal = outward.flip_sign_by(side);
        let normal = self
            .scene
            .shading_normal(placed, position, geometric_normal);
        let normal = on_side_of(geometric_normal, normal);
        // Find the attributes that textures read.
        let mut at = TexturePoint::new(position.into(), normal);
        at.scalar = self.scene.scalar(placed, position);
        at = self.scene.with_color(placed, at);
        if self.scene.has_images {
            at = self.scene.with_uv(placed, at);
        }
        if let Some(cone) = self.cone {
            at.width = width(cone, length + hit.t, geometric_normal, ray.direction.into());
        }
        // Evaluate the textures.
        let material = self.scene.material(primitive.material);
        SurfacePoint {
            position,
            normal: material.normal_at(&at, geometric_normal).into(),
            geometric_normal: geometric_normal.into(),
            color: self.scene.color(hit.primitive, &at),
            distance: hit.t,
            error: self
                .scene
                .rounding(placed, [position, geometric_normal.into()]),
            object: primitive.object,
            material: primitive.material,
            primitive: hit.primitive,
            instance: hit.instance,
            is_flipped: side < 0.0,
            factors: material.factors.at(&at),
            opacity,
        }
    }
}

/// Returns the share of light that arrives.
fn share(is_occluded: bool) -> f32 {
    if is_occluded { 0.0 } else { 1.0 }
}
