//! Camera rays as cones.

use super::image_plane::{ImagePlane, Projection};
use math::simd::Real;

/// The footprint of a camera ray in the scene, as a cone around the ray. Mirrors and surfaces of
/// media are treated as planes: they deflect the cone and keep its spread.
///
/// Akenine-Möller et al., "Improved Shader and Texture Level of Detail Using Ray Cones", JCGT
/// 10(1), 2021.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayCone {
    /// The width at the ray's origin.
    pub width: f32,
    /// The growth of the width per length.
    pub spread: f32,
}

/// The least fraction of a pixel's side that a sample represents.
const LEAST_SHARE: f32 = 1.0 / 8.0;

impl ImagePlane {
    /// Returns the cone of a ray through the center of the picture with `n_samples` per pixel: its
    /// width is a sample's share of a pixel. Rays toward the edges are narrower, and a lens does
    /// not widen them.
    pub fn ray_cone(&self, n_samples: u32) -> RayCone {
        let share = (1.0 / (n_samples as f32).sqrt()).max(LEAST_SHARE);
        let side = share * self.pitch();
        let (width, spread) = match self.projection {
            Projection::Perspective => (0.0, side / self.center().distance(self.eye)),
            Projection::Parallel { .. } => (side, 0.0),
            Projection::Panorama { .. } => (0.0, side),
        };
        RayCone { width, spread }
    }
}

impl RayCone {
    /// Returns the width at a distance from the camera along the path.
    #[inline(always)]
    pub fn width_at<R: Real>(&self, distance: R) -> R {
        distance.splat(self.width) + distance.splat(self.spread) * distance
    }
}

#[cfg(test)]
mod tests {
    use crate::camera::Camera;
    use crate::geometry::RenderSpace;

    #[test]
    fn a_cone_is_as_wide_as_a_sample() {
        for camera in [
            "look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 50 }",
            "orthographic: { eye: [0, 0, 5], target: [0, 0, 0], height: 3 }",
            "panorama: { eye: [0, 0, 5], target: [0, 0, 0] }",
        ] {
            let camera: Camera = scene::yaml::from_str(camera).unwrap();
            let plane = camera.image_plane([21, 11], &RenderSpace::default());
            let pixel = plane.footprints(plane.pitch(), [10.0, 5.0], 7.0);
            for (n_samples, share) in [(1, 1.0), (4, 0.5), (9, 1.0 / 3.0), (10_000, 0.125)] {
                let width = plane.ray_cone(n_samples).width_at(7.0);
                assert!(
                    (width - share * pixel).abs() < 1e-5 * pixel,
                    "{n_samples}: {width}"
                );
            }
        }
    }
}
