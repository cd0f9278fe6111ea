//! Homogeneous fog around the objects of a scene.

mod phase;
mod sphere;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::kinds;
use crate::values::{self, Number};

pub use phase::HenyeyGreenstein;
pub use sphere::FogSphere;

/// The `fog` section: the same fog everywhere in a sphere around the objects.
///
/// ```
/// # use raycost_world::fog::Fog;
/// let fog: Fog = scene::yaml::from_str("
/// mean_free_path: 12     # in world units: 37 % of the light gets as far
/// color: [0.8, 0.85, 1]
/// anisotropy: 0.4        # in path tracing: most light is scattered forward
/// radius: 50             # of the sphere that it fills
/// ").unwrap();
/// # assert_eq!(fog.mean_free_path, 12.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "fog such as { mean_free_path: 10, color: 0.8 }"
)]
pub struct Fog {
    /// The distance at which 1/e of the light is left.
    #[serde(with = "values::Positive")]
    pub mean_free_path: f32,
    /// In path tracing, the share of light that particles scatter; in `blinn_phong`, the color that
    /// distant objects fade to.
    #[serde(default = "values::white", with = "values::Color")]
    pub color: Vec3,
    /// The mean cosine of the angle by which particles scatter, above 0 for forward, in path
    /// tracing; 0, the same in all directions, by default.
    #[serde(default, with = "Anisotropy")]
    pub anisotropy: f32,
    /// The radius of the fog around the center of the box of all objects, in which an instance has its
    /// turned box; by default it holds the objects and the camera.
    #[serde(default, with = "values::Positive")]
    pub radius: Option<f32>,
}

kinds! {
    Anisotropy: f32 = Number { expected: "a number from -0.99 to 0.99", ranges: &[[-0.99, 0.99]] };
}
