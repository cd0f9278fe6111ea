//! Rays through surfaces that are not [opaque](world::material::Opacity).
//!
//! A ray that passes a surface is traced again from past it, until it hits something else. It
//! remains one ray, and its visits past openings are counted as its visits.
//!
//! A shadow ray passes with the share of light that each surface lets through. Any other ray passes
//! holes; where a surface is partly open, path tracing decides by chance, and the other models hit
//! it and split the path there.

use super::Tracer;
use crate::accel::{Hit, ShadowRay, ShadowStream};
use crate::cost::{ByPixel, PixelProbe};
use math::sampling::uniform_of_halves;
use math::simd::{N_LANES, Real, Vector};
use world::geometry::{Ray, RayStream};
use world::scene::Scene;

/// The rest of a ray past some surfaces.
#[derive(Clone, Copy)]
struct Passage {
    ray: Ray,
    /// Distance from the ray's first origin.
    length: f32,
    /// The share of light that has passed.
    share: f32,
}

impl Passage {
    fn new(ray: Ray) -> Self {
        Self {
            ray,
            length: 0.0,
            share: 1.0,
        }
    }

    /// Returns the hit as a hit of the whole ray.
    fn hit(&self, hit: Hit) -> Hit {
        Hit {
            t: self.length + hit.t,
            ..hit
        }
    }
}

/// The light that a ray takes past a surface of an opacity.
type Passing = fn(&Tracer, &Ray, f32) -> f32;

/// Returns the share of light that passes.
fn light_share(_: &Tracer, _: &Ray, opacity: f32) -> f32 {
    1.0 - opacity
}

/// Returns 1 if the whole ray passes, or else 0.
fn all_or_nothing(tracer: &Tracer, ray: &Ray, opacity: f32) -> f32 {
    let ray = [ray.origin, ray.direction].map(Vector::from);
    f32::from(u8::from(opacity <= passed_opacity(tracer.scene, ray)))
}

/// Returns the greatest opacity that a whole ray, with this origin and direction, passes: in path
/// tracing a uniform number in [0, 1), the same in any order and on any thread.
pub(crate) fn passed_opacity<R: Real>(scene: &Scene, ray: [Vector<R>; 2]) -> R {
    let [origin, direction] = ray;
    if !scene.scatters_paths() {
        return origin.x.splat(0.0);
    }
    let [number, ..] = uniform_of_halves(
        [origin.x, origin.z, direction.y].map(R::to_integer_bits),
        [origin.y, direction.x, direction.z].map(R::to_integer_bits),
    );
    number
}

impl Tracer<'_> {
    /// Returns the nearest hit of a ray on a surface that it does not pass. `nearest` finds the
    /// nearest hit.
    pub(super) fn hit_past_openings(
        &self,
        ray: &Ray,
        nearest: impl FnMut(&Ray) -> Option<Hit>,
    ) -> Option<Hit> {
        self.follow(ray, f32::INFINITY, all_or_nothing, nearest).0
    }

    /// Returns the share of light that passes along a shadow ray.
    pub(super) fn light_past_openings(
        &self,
        shadow: &ShadowRay,
        nearest: impl FnMut(&Ray) -> Option<Hit>,
    ) -> f32 {
        let (hit, share) = self.follow(&shadow.ray, shadow.t_max, light_share, nearest);
        hit.map_or(share, |_| 0.0)
    }

    /// Returns the hit on a shadow ray past which there is no light.
    pub(super) fn occluder_past_openings(
        &self,
        shadow: &ShadowRay,
        nearest: impl FnMut(&Ray) -> Option<Hit>,
    ) -> Option<Hit> {
        let (hit, _) = self.follow(&shadow.ray, shadow.t_max, light_share, nearest);
        hit
    }

    /// Returns the first hit that a ray does not pass, before `limit`, and the share of light that
    /// has passed before it.
    fn follow(
        &self,
        ray: &Ray,
        limit: f32,
        passing: Passing,
        mut nearest: impl FnMut(&Ray) -> Option<Hit>,
    ) -> (Option<Hit>, f32) {
        let mut passage = Passage::new(*ray);
        loop {
            let Some(hit) = nearest(&passage.ray) else {
                return (None, passage.share);
            };
            match self.past(&passage, hit, limit, passing) {
                Some(next) => passage = next,
                None => {
                    let hit = Some(passage.hit(hit)).filter(|hit| hit.t < limit);
                    return (hit, passage.share);
                }
            }
        }
    }

    /// Replaces the nearest hits of rays on surfaces that they pass by hits past these.
    pub(super) fn hits_past_openings<P: PixelProbe>(
        &self,
        rays: &RayStream,
        hits: &mut [Option<Hit>],
        probes: ByPixel<P>,
    ) {
        let limit = |_| f32::INFINITY;
        self.follow_all(rays, limit, all_or_nothing, hits, probes, |_, _| {});
    }

    /// Finds the light along shadow rays, as [`shadow_stream`](Tracer::shadow_stream) does, by
    /// their nearest hits.
    pub(super) fn shadows_past_openings<P: PixelProbe>(
        &self,
        shadows: &ShadowStream,
        shares: &mut Vec<f32>,
        mut probes: ByPixel<P>,
    ) {
        let mut hits = Vec::new();
        let (rays, limit) = (shadows.rays(), |i: usize| shadows.t_max(i));
        self.accel.nearest_stream(rays, &mut hits, &mut probes);
        shares.resize(rays.len(), 1.0);
        let keep = |i: usize, share| shares[i] = share;
        self.follow_all(rays, limit, light_share, &mut hits, probes, keep);
        for (i, (share, hit)) in shares.iter_mut().zip(&hits).enumerate() {
            if hit.is_some_and(|hit| hit.t < limit(i)) {
                *share = 0.0;
            }
        }
    }

    /// Replaces the nearest hits of rays, before the limit of each, on surfaces that they pass by
    /// hits past these. Calls `keep` with the index of each such ray and its share of light.
    fn follow_all<P: PixelProbe>(
        &self,
        rays: &RayStream,
        limit: impl Fn(usize) -> f32,
        passing: Passing,
        hits: &mut [Option<Hit>],
        mut probes: ByPixel<P>,
        mut keep: impl FnMut(usize, f32),
    ) {
        // Find the rays that pass surfaces.
        let past = |i: usize| self.past(&Passage::new(rays.get(i)), hits[i]?, limit(i), passing);
        let mut passages: Vec<(usize, Passage)> = (0..rays.len())
            .filter_map(|i| Some((i, past(i)?)))
            .collect();
        let mut found = Vec::new();
        // Trace them from past these, until none passes another.
        while !passages.is_empty() {
            let rays: RayStream = passages.iter().map(|(_, passage)| passage.ray).collect();
            let indices = passages.iter().map(|&(i, _)| i);
            let mut pixels: Vec<u32> = indices.map(|i| probes.pixel(i)).collect();
            pixels.resize(pixels.len() + 2 * N_LANES, 0);
            self.accel
                .nearest_stream(&rays, &mut found, &mut probes.with_pixels(&pixels));
            let mut next = Vec::new();
            for ((i, passage), found) in passages.into_iter().zip(&found) {
                hits[i] = found.map(|hit| passage.hit(hit));
                keep(i, passage.share);
                let past = found.and_then(|hit| self.past(&passage, hit, limit(i), passing));
                next.extend(past.map(|passage| (i, passage)));
            }
            passages = next;
        }
    }

    /// Returns the rest of a ray past its hit, if the hit is before `limit` and light passes it.
    fn past(&self, before: &Passage, hit: Hit, limit: f32, passing: Passing) -> Option<Passage> {
        let Passage { ray, length, share } = before;
        let primitive = &self.scene.primitives[hit.primitive as usize];
        self.scene.material(primitive.material).opacity.as_ref()?;
        if length + hit.t >= limit {
            return None;
        }
        // Find the share that passes the hit.
        let (position, normal) = self.scene.project(hit.placed(), ray.at(hit.t));
        let at = [position, normal];
        let share = share * passing(self, ray, self.scene.opacity(hit.placed(), at));
        if share <= 0.0 {
            return None;
        }
        // Continue just past the surface.
        let error = self.scene.rounding(hit.placed(), at);
        let past = Ray::leaving(at, error, ray.direction);
        let next = length + (past.origin - ray.origin).dot(ray.direction);
        // By rounding errors, a ray along the surface may not advance: it ends there.
        (next > *length).then_some(Passage {
            ray: past,
            length: next,
            share,
        })
    }
}
