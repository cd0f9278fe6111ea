//! The particles of fog that rays meet.

use super::numbers::{PointNumbers, SampleIds};
use super::paths::PathWave;
use super::{PathRay, Shader, WaveShader};
use crate::accel::Hit;
use crate::trace::SurfacePoint;
use math::simd::Vector;
use world::geometry::Ray;

impl Shader<'_> {
    /// Returns the point that a ray of a path meets: a particle of fog if one is nearer than this
    /// hit, else the hit.
    pub fn met_in_fog(&self, path: &PathRay, hit: Option<SurfacePoint>) -> Option<SurfacePoint> {
        if !path.media.is_none() {
            return hit;
        }
        let distance = hit.as_ref().map_or(f32::INFINITY, |point| point.distance);
        let ray = [path.ray.origin, path.ray.direction].map(Vector::from);
        match self.formulas.flight(ray, distance, self.numbers(path)) {
            (true, t) => Some(SurfacePoint::fog_particle(self.scene, &path.ray, t)),
            (false, _) => hit,
        }
    }

    /// Returns true if a point is a particle of fog.
    pub fn is_particle(&self, point: &SurfacePoint) -> bool {
        point.primitive == self.scene.particles()
    }
}

impl WaveShader<'_> {
    /// Returns true if rays may meet particles of fog.
    pub fn has_particles(&self) -> bool {
        self.scene.scattering_fog().is_some()
    }

    /// Replaces hits by the particles of fog that rays meet before.
    pub fn meet_particles(&self, ids: &SampleIds, wave: &PathWave, hits: &mut [Option<Hit>]) {
        let Some(fog) = self.scene.scattering_fog() else {
            return;
        };
        let primitive = self.scene.particles();
        for (i, hit) in hits.iter_mut().enumerate() {
            if !wave.branches[i].media.is_none() {
                continue;
            }
            // Sample the distance to the next particle.
            let id = ids.sample_id(wave.slots()[i]);
            let numbers = PointNumbers::new(self.sampler, id, wave.depth);
            let distance = hit.map_or(f32::INFINITY, |hit| hit.t);
            let Ray { origin, direction } = wave.rays.get(i);
            let ray = [origin, direction].map(Vector::from);
            if let (true, t) = fog.flight(ray, distance, numbers.flight()) {
                *hit = Some(Hit {
                    t,
                    primitive,
                    instance: None,
                });
            }
        }
    }
}
