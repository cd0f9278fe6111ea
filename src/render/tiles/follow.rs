//! The loop that follows the paths of a pixel, ray by ray.

use glam::Vec3;

use super::rounds::{Rounds, SampleSums};
use super::view::View;
use tracer::shade::PathRay;
use tracer::trace::SurfacePoint;

/// Traces and shades the rays of paths: as fast as possible, or with a record of each.
pub(crate) trait PathProbe {
    /// Traces a ray and returns the point that it hits.
    fn trace(&mut self, path: &PathRay) -> Option<SurfacePoint>;

    /// Returns the radiance that the ray traced last adds to its path, whose camera ray starts at
    /// `eye`, given the point that it met; appends the rays that continue the path to `next`.
    fn shade(
        &mut self,
        eye: Vec3,
        path: &PathRay,
        met: Option<&SurfacePoint>,
        next: &mut Vec<PathRay>,
    ) -> Vec3;
}

/// Follows the paths of a pixel in rounds of samples until it needs no more. Returns the sums of the
/// samples and their number. `paths` is a reused buffer.
pub(crate) fn follow(
    view: &View,
    rounds: &Rounds,
    at: (u32, u32),
    paths: &mut Vec<PathRay>,
    probe: &mut impl PathProbe,
) -> (SampleSums<f32>, u32) {
    let mut sums = SampleSums::zero(0.0);
    let mut round = rounds.first();
    while !round.is_empty() {
        for sample in round.clone() {
            let color = follow_sample(view, at, sample, paths, probe);
            sums.add(view.limited(color.into()), sample == 0);
        }
        round = rounds.next(&sums, round.end);
    }
    (sums, round.end)
}

/// Follows the paths of one sample of a pixel. Returns its radiance, without limits. `paths` is a
/// reused buffer.
pub(crate) fn follow_sample(
    view: &View,
    (x, y): (u32, u32),
    sample: u32,
    paths: &mut Vec<PathRay>,
    probe: &mut impl PathProbe,
) -> Vec3 {
    paths.clear();
    paths.push(view.camera_path(x, y, sample));
    let eye = paths[0].ray.origin;
    let (mut color, mut n_traced) = (Vec3::ZERO, 0);
    // All rays of a depth before the rays of the next, as in waves.
    while let Some(&path) = paths.get(n_traced) {
        n_traced += 1;
        let hit = probe.trace(&path);
        let met = view.shader.met_in_fog(&path, hit);
        color += probe.shade(eye, &path, met.as_ref(), paths);
    }
    color
}
