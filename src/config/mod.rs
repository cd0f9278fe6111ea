//! The scene file as serde types: text → [`Config`].
//!
//! Takes a [`Source`](crate::yaml::Source), gives every section with its
//! defaults, each value in its range. What hangs on two places of the file (a
//! material's name, say) is resolved in [`scene`](crate::scene).

mod acceleration;
mod background;
mod codec;
mod cost_mode;
mod file;
mod generator;
mod image;
mod object;
mod outputs;
mod repeats;
mod shading;
mod tiling;

use indexmap::IndexMap;
use serde::Deserialize;

pub use acceleration::{Acceleration, Quality, Structure};
pub use background::Background;
pub use codec::Codec;
pub use cost_mode::CostMode;
pub use file::{GeometryFile, MeshFile, MeshNormals, SpheresFile};
pub use generator::{Generator, SphereCloud, SphereGrid};
pub use image::{Image, MAX_SIDE};
pub use object::{Geometry, MaterialNames, Object};
pub use outputs::{BvhLimits, Extra, Outputs};
pub use repeats::Repeats;
pub use shading::{Shading, ShadingModel};
pub use tiling::{TileOrder, Tiling};

use crate::camera::Camera;
use crate::light::Light;
use crate::material::Material;
use crate::yaml::{Fault, Path};

/// A whole scene file.
///
/// ```
/// # use raycost::{config::Config, yaml::Source};
/// let config: Config = Source::new("scene.yaml", "
/// image: { width: 320, height: 240 }
/// camera:
///   look_at: { eye: [0, 1, 5], target: [0, 0, 0], fov_y_deg: 40 }
/// materials:
///   blue: { color: [0.1, 0.2, 0.9], specular: 0.5 }
/// lights:
///   - point: { position: [5, 5, 10] }
/// objects:
///   - sphere: { center: [0, 0, 0], radius: 1 }
///     material: blue
/// ").parse().unwrap();
/// # assert_eq!(config.objects.len(), 1);
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, expecting = "sections such as `image: { … }`")]
pub struct Config {
    /// Size and sampling of the picture.
    pub image: Image,
    /// Where it is seen from.
    pub camera: Camera,
    /// What rays see that hit nothing; black if not given.
    #[serde(default)]
    pub background: Background,
    /// How light is computed.
    #[serde(default)]
    pub shading: Shading,
    /// How hits are found.
    #[serde(default)]
    pub acceleration: Acceleration,
    /// What is measured of each pixel.
    #[serde(default)]
    pub cost: CostMode,
    /// How often the picture is rendered to measure it.
    #[serde(default)]
    pub repeats: Repeats,
    /// How the picture is dealt out to the threads.
    #[serde(default)]
    pub tiles: Tiling,
    /// What is written beside the files of every run.
    #[serde(default)]
    pub output: Outputs,
    /// How the arrays of VTK files are compressed.
    #[serde(default)]
    pub compress: Codec,
    /// Materials by name; their ids count from 0 in this order.
    pub materials: IndexMap<String, Material>,
    /// The lights; `[]` for none but the ambient light.
    pub lights: Vec<Light>,
    /// The objects, at least one; their ids count from 0 in this order.
    pub objects: Vec<Object>,
}

impl Config {
    /// Makes sure that all files that are asked for can be written.
    ///
    /// # Errors
    /// What cannot be, and the fault of the section `output`.
    pub fn check_output(&self) -> Result<(), (Extra, Fault)> {
        self.output.check(self.cost, self.acceleration)
    }

    /// Makes sure that there are times where several of them are asked for.
    ///
    /// # Errors
    /// The fault of the section `repeats`.
    pub fn check_repeats(&self) -> Result<(), Fault> {
        let is_once = matches!(self.repeats, Repeats::Auto | Repeats::ONCE);
        if is_once || self.cost.has_time() {
            return Ok(());
        }
        let message = "`repeats` needs times, and none are taken";
        let repeats = Path::default().key("repeats");
        Err(Fault::new(
            repeats,
            message,
            "expected `auto`, `1`, or `cost: time`",
        ))
    }

    /// Gives each `sphere_cloud` so many spheres, from 1 to a billion; their
    /// radii change so that they fill the same share of space.
    ///
    /// # Errors
    /// If there is no such cloud.
    pub fn set_count(&mut self, count: u32) -> Result<(), Fault> {
        let clouds = self
            .objects
            .iter_mut()
            .filter_map(|object| match &mut object.geometry {
                Geometry::Generator(Generator::SphereCloud(cloud)) => Some(cloud),
                _ => None,
            });
        let mut has_cloud = false;
        clouds.for_each(|cloud| {
            cloud.set_count(count);
            has_cloud = true;
        });
        if has_cloud {
            return Ok(());
        }
        let objects = Path::default().key("objects");
        let message = "there is no `sphere_cloud` whose count could change";
        Err(Fault::new(objects, message, "no cloud among them"))
    }
}
