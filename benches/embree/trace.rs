//! Embree's kernels: one ray at a time, and packets of 16.

use std::array::from_fn;

use crate::device::Scene;
use crate::ffi::{HitFields, INVALID_ID, Ray1, Ray16, RayFields, RayHit1, RayHit16, Valid16};
use crate::kernel::Kernel;
use tracer::accel::{Hit, ShadowStream};
use world::geometry::{Ray, RayStream};

/// `rtcIntersect1` and `rtcOccluded1`.
pub struct Singles<'a>(pub &'a Scene<'a>);

impl Kernel for Singles<'_> {
    fn nearest(&self, rays: &RayStream, hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| {
            let mut traced = RayHit1 {
                ray: fields(&ray, f32::INFINITY),
                hit: NO_HIT,
            };
            self.0.intersect1(&mut traced);
            hit(traced.hit.geometry, traced.ray.t_far, traced.hit.primitive)
        }));
    }

    fn any(&self, rays: &ShadowStream, occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.extend(rays.iter().map(|shadow| {
            let mut traced = Ray1(fields(&shadow.ray, shadow.t_max));
            self.0.occluded1(&mut traced);
            traced.0.t_far < 0.0
        }));
    }
}

/// `rtcIntersect16` and `rtcOccluded16`.
pub struct Packets<'a> {
    pub scene: &'a Scene<'a>,
    /// True if the rays of a packet are coherent.
    pub is_coherent: bool,
}

impl Kernel for Packets<'_> {
    fn nearest(&self, rays: &RayStream, hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        for first in (0..rays.len()).step_by(16) {
            let n = 16.min(rays.len() - first);
            let mut traced = RayHit16 {
                ray: lanes(n, |i| (rays.get(first + i), f32::INFINITY)),
                hit: NO_HITS,
            };
            self.scene
                .intersect16(&valid(n), self.is_coherent, &mut traced);
            let RayHit16 { ray, hit: found } = &traced;
            let lane = |i| hit(found.geometry[i], ray.t_far[i], found.primitive[i]);
            hits.extend((0..n).map(lane));
        }
    }

    fn any(&self, rays: &ShadowStream, occluded: &mut Vec<bool>) {
        occluded.clear();
        for first in (0..rays.len()).step_by(16) {
            let n = 16.min(rays.len() - first);
            let shadow = |i| rays.get(first + i);
            let mut traced = Ray16(lanes(n, |i| (shadow(i).ray, shadow(i).t_max)));
            self.scene
                .occluded16(&valid(n), self.is_coherent, &mut traced);
            occluded.extend(traced.0.t_far[..n].iter().map(|&t| t < 0.0));
        }
    }
}

const NO_HIT: HitFields<f32, u32> = HitFields {
    normal: [0.0; 3],
    uv: [0.0; 2],
    primitive: INVALID_ID,
    geometry: INVALID_ID,
    instance: INVALID_ID,
    instance_primitive: INVALID_ID,
};

const NO_HITS: HitFields<[f32; 16], [u32; 16]> = HitFields {
    normal: [[0.0; 16]; 3],
    uv: [[0.0; 16]; 2],
    primitive: [INVALID_ID; 16],
    geometry: [INVALID_ID; 16],
    instance: [INVALID_ID; 16],
    instance_primitive: [INVALID_ID; 16],
};

fn hit(geometry: u32, t: f32, primitive: u32) -> Option<Hit> {
    (geometry != INVALID_ID).then_some(Hit {
        t,
        primitive,
        instance: None,
    })
}

#[inline]
fn fields(ray: &Ray, t_max: f32) -> RayFields<f32, u32> {
    RayFields {
        origin: ray.origin.to_array(),
        t_near: 0.0,
        direction: ray.direction.to_array(),
        time: 0.0,
        t_far: t_max,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

/// Returns the rays `0..n` lane by lane, and the last one in the remaining lanes.
#[inline]
fn lanes(n: usize, ray: impl Fn(usize) -> (Ray, f32)) -> RayFields<[f32; 16], [u32; 16]> {
    let ray = |lane: usize| ray(lane.min(n - 1));
    RayFields {
        origin: from_fn(|axis| from_fn(|lane| ray(lane).0.origin[axis])),
        t_near: [0.0; 16],
        direction: from_fn(|axis| from_fn(|lane| ray(lane).0.direction[axis])),
        time: [0.0; 16],
        t_far: from_fn(|lane| ray(lane).1),
        mask: [u32::MAX; 16],
        id: [0; 16],
        flags: [0; 16],
    }
}

/// Returns the active mask: one lane per ray.
fn valid(n: usize) -> Valid16 {
    Valid16(from_fn(|lane| if lane < n { -1 } else { 0 }))
}
