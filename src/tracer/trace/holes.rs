//! Rays through the holes of surfaces with a [cutout](scene::material::Cutout).
//!
//! A ray that hits a hole is traced again from behind it, until it hits something else. It remains
//! one ray, and its visits behind holes are counted as its visits.

use super::Tracer;
use crate::accel::{Hit, ShadowStream};
use crate::cost::{ByPixel, PixelProbe};
use math::simd::N_LANES;
use scene::geometry::{Ray, RayStream};
use scene::material::TexturePoint;

/// The rest of a ray behind some holes.
struct Passage {
    ray: Ray,
    /// Distance from the ray's first origin.
    length: f32,
}

impl Passage {
    /// Returns the hit as a hit of the whole ray.
    fn hit(&self, hit: Hit) -> Hit {
        Hit {
            t: self.length + hit.t,
            ..hit
        }
    }
}

impl Tracer<'_> {
    /// Returns the nearest hit of a ray that is not in a hole, if it lies before `limit`. `nearest`
    /// finds the nearest hit.
    pub(super) fn hit_behind_holes(
        &self,
        ray: &Ray,
        limit: f32,
        mut nearest: impl FnMut(&Ray) -> Option<Hit>,
    ) -> Option<Hit> {
        let mut passage = Passage {
            ray: *ray,
            length: 0.0,
        };
        loop {
            let hit = nearest(&passage.ray)?;
            match self.behind_hole(&passage, hit, limit) {
                Some(next) => passage = next,
                None => return Some(passage.hit(hit)).filter(|hit| hit.t < limit),
            }
        }
    }

    /// Replaces the nearest hits of rays that are in holes, before the limit of each, by hits
    /// behind the holes.
    pub(super) fn hits_behind_holes<P: PixelProbe>(
        &self,
        rays: &RayStream,
        limit: impl Fn(usize) -> f32,
        hits: &mut [Option<Hit>],
        mut probes: ByPixel<P>,
    ) {
        let whole = |i| Passage {
            ray: rays.get(i),
            length: 0.0,
        };
        // Find the rays that hit holes.
        let behind = |i: usize| self.behind_hole(&whole(i), hits[i]?, limit(i));
        let mut passages: Vec<(usize, Passage)> = (0..rays.len())
            .filter_map(|i| Some((i, behind(i)?)))
            .collect();
        let mut found = Vec::new();
        // Trace them from behind their holes, until none hits another.
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
                let behind = found.and_then(|hit| self.behind_hole(&passage, hit, limit(i)));
                next.extend(behind.map(|passage| (i, passage)));
            }
            passages = next;
        }
    }

    /// Tests shadow rays, as [`shadow_stream`](Tracer::shadow_stream) does, by their nearest hits.
    pub(super) fn shadows_behind_holes<P: PixelProbe>(
        &self,
        shadows: &ShadowStream,
        shadowed: &mut Vec<bool>,
        mut probes: ByPixel<P>,
    ) {
        let mut hits = Vec::new();
        let limit = |i: usize| shadows.t_max(i);
        self.accel
            .nearest_stream(shadows.rays(), &mut hits, &mut probes);
        self.hits_behind_holes(shadows.rays(), limit, &mut hits, probes);
        shadowed.clear();
        let is_shadowed = |(i, hit): (usize, &Option<Hit>)| hit.is_some_and(|hit| hit.t < limit(i));
        shadowed.extend(hits.iter().enumerate().map(is_shadowed));
    }

    /// Returns the rest of a ray past its hit, if the hit is in a hole before `limit`.
    fn behind_hole(
        &self,
        Passage { ray, length }: &Passage,
        hit: Hit,
        limit: f32,
    ) -> Option<Passage> {
        let primitive = &self.scene.primitives[hit.primitive as usize];
        let cutout = self.scene.material(primitive.material).cutout.as_ref()?;
        if length + hit.t >= limit {
            return None;
        }
        // Look up the cutout at the hit.
        let (position, normal) = self.scene.project(hit.placed(), ray.at(hit.t));
        let at = TexturePoint::new(position.into(), normal.into());
        let at = self.scene.with_uv(hit.placed(), at);
        if !cutout.is_hole(&at) {
            return None;
        }
        // Continue just behind the surface.
        let at = [position, normal];
        let error = self.scene.rounding(hit.placed(), at);
        let behind = Ray::leaving(at, error, ray.direction);
        let next = length + (behind.origin - ray.origin).dot(ray.direction);
        // By rounding errors, a ray along the surface may not advance: it ends there.
        (next > *length).then_some(Passage {
            ray: behind,
            length: next,
        })
    }
}
