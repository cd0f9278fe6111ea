//! The scene file as serde types: text → [`Config`].
//!
//! [`Document::parse`](crate::yaml::Document::parse) returns every section with its
//! defaults and checks the range of each value. [`build`](crate::build) resolves
//! references between sections, such as the names of materials.

mod adaptive;
mod isosurface;
mod normals;
mod file;
mod film;
mod generator;
mod tube;
mod same_or_array;
mod place_scale;
mod instances;
mod image;
mod kernels;
mod lanes;
mod object;
mod outputs;
mod array_check;
mod repeats;
mod resolved;

mod tiling;

use std::path::PathBuf;

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use adaptive::{Adaptive, MAX_SAMPLES, SampleRule};
pub use file::{
    GeometryFile, MeshFile, PointRadius, RadiusArray, SpheresFile, TubesFile, at_value,
};
pub use film::FilmSettings;
pub use generator::{Generator, MAX_SHAPES, SphereCloud, SphereGrid};
pub use image::{Image, MAX_SIDE, PictureWindow};
pub use instances::{InstancePlaces, InstancedMesh, OrientArray, PlaceCloud, PlacePoints};
pub use isosurface::Isosurface;
pub use kernels::{Pinning, SimdSet};
pub use lanes::{RayOrder, Warps};
pub use normals::{Creases, MeshNormals};
pub use object::{Geometry, MaterialNames, Object};
pub use outputs::{BvhLimits, ExtraArrays, OptionalOutput, Outputs, SampleCost};
pub use place_scale::{PlaceScale, ScaleArray};
pub use repeats::Repeats;
pub use same_or_array::SameOrArray;
pub use tiling::{TileOrder, Tiling};
pub use tube::Tube;

use crate::animation::Animation;
use crate::yaml::{Fault, FieldPath, Merging, Refusal, YamlFile, deserialize};
pub use math::sampling::{PixelFilter, PixelPattern};
pub use tracer::accel::{Acceleration, HierarchyUpdate, Quality, Structure, Traversal};
pub use tracer::cost::{CostMode, PixelArray, RatioMetric, RatioMetrics, WrittenArrays};
use vtk::Codec;
use world::background::Background;
use world::camera::Camera;
use world::fog::Fog;
use world::light::Light;
use world::material::Material;
pub use world::shading::{LightSampling, Shading, ShadingModel};

/// A whole scene file.
///
/// ```
/// # use raycost_scene::{config::Config, yaml::Source};
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
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(deny_unknown_fields, expecting = "sections such as `image: { … }`")]
pub struct Config {
    /// The files whose sections are part of the scene, relative to the file's folder.
    #[serde(default)]
    pub include: Vec<PathBuf>,
    /// Size and sampling of the picture.
    pub image: Image,
    /// The camera.
    pub camera: Camera,
    /// The color seen by rays without a hit; black if not given.
    #[serde(default)]
    #[schemars(extend("default" = 0))]
    pub background: Background,
    /// The fog around the objects; none if not given.
    #[serde(default)]
    pub fog: Option<Fog>,
    /// The shading model and its parameters.
    #[serde(default)]
    pub shading: Shading,
    /// The frames of a moving picture; a still if not given.
    #[serde(default)]
    pub animation: Option<Animation>,
    /// The conversion of light to the numbers of the picture.
    #[serde(default)]
    pub film: FilmSettings,
    /// The acceleration structure.
    #[serde(default)]
    #[schemars(extend("default" = Acceleration::default().kind()))]
    pub acceleration: Acceleration,
    /// The cost measured for each pixel.
    #[serde(default)]
    pub cost: CostMode,
    /// Ratios of costs as metrics of the scene's own.
    #[serde(default)]
    pub metrics: RatioMetrics,
    /// How many times the picture is rendered to time its pixels.
    #[serde(default)]
    pub repeats: Repeats,
    /// How the picture is divided among threads.
    #[serde(default)]
    pub tiles: Tiling,
    /// The optional outputs, and the arrays of VTK files.
    #[serde(default)]
    #[schemars(extend("default" = NO_OUTPUTS))]
    pub output: Outputs,
    /// The compression of the arrays in VTK files.
    #[serde(default)]
    pub compress: Codec,
    /// Materials by name; the index in this order is the material's id.
    pub materials: IndexMap<String, Material>,
    /// The lights; `[]` for none but the ambient light.
    pub lights: Vec<Light>,
    /// The objects, at least one; the index in this order is the object's id.
    pub objects: Vec<Object>,
}

/// No optional outputs, as they are written.
const NO_OUTPUTS: [(); 0] = [];

impl YamlFile for Config {
    fn from_yaml(text: &str) -> Result<Self, Refusal> {
        deserialize(text)
    }
}

impl Config {
    /// The sections to which each file of a scene adds.
    pub const MERGING: Merging = Merging {
        maps: &["materials"],
        lists: &["lights", "objects"],
    };

    /// Returns the additional arrays that the film must keep for the requested pictures and
    /// outputs.
    pub fn extra_arrays(&self) -> ExtraArrays {
        let has_exr = self.output.has(OptionalOutput::Exr);
        let radiance_in_vtk = self.output.has(OptionalOutput::Radiance);
        ExtraArrays {
            radiance: radiance_in_vtk || has_exr || self.film.bits > 8,
            radiance_in_vtk,
            noise: (self.output.has(OptionalOutput::Noise)).then_some(self.output.noise),
            albedo: has_exr,
            bounces: self.output.has(OptionalOutput::Bounces),
            groups: self.output.has(OptionalOutput::Groups),
            tests: self.output.has(OptionalOutput::Tests),
            lanes: (self.output.has(OptionalOutput::Lanes)).then_some(self.output.warps),
            cycles: false,
            sm: false,
            instance: self.has_instances(),
            metrics: self.metrics,
            written: self.output.written_arrays(),
        }
    }

    /// Returns the label of each object.
    pub fn object_labels(&self) -> impl Iterator<Item = String> {
        let objects = self.objects.iter().enumerate();
        objects.map(|(index, object)| object.label(index))
    }

    /// Returns true if there are instanced meshes.
    pub fn has_instances(&self) -> bool {
        let is_placed = |object: &Object| matches!(object.geometry, Geometry::Instances(_));
        self.objects.iter().any(is_placed)
    }

    /// Checks that the other settings allow all requested outputs.
    ///
    /// # Errors
    /// The impossible output, and the fault in the section `output`.
    pub fn check_output(&self) -> Result<(), (OptionalOutput, Fault)> {
        self.output.check(self.cost)?;
        (self.check_noise()).map_err(|fault| (OptionalOutput::Noise, fault))
    }

    /// Checks the sizes of the image and of its tiles, which a program may have
    /// changed.
    ///
    /// # Errors
    /// The first one that is out of its range.
    pub fn check_sizes(&self) -> Result<(), Fault> {
        let Image {
            width,
            height,
            samples_per_pixel,
            ..
        } = self.image;
        let tiles = Tiling::MIN_SIZE..=Tiling::MAX_SIZE;
        for (section, key, value, range) in [
            ("image", "width", width, 1..=MAX_SIDE),
            ("image", "height", height, 1..=MAX_SIDE),
            (
                "image",
                "samples_per_pixel",
                samples_per_pixel,
                1..=MAX_SAMPLES,
            ),
            ("tiles", "size", self.tiles.size, tiles),
        ] {
            if !range.contains(&value) {
                let path = FieldPath::default().key(section).key(key);
                let expected = format!("expected {} to {}", range.start(), range.end());
                return Err(Fault::new(
                    path,
                    format!("`{key}` cannot be {value}"),
                    expected,
                ));
            }
        }
        Ok(())
    }

    /// Checks that pixels are timed if several repeats are requested.
    ///
    /// # Errors
    /// The fault in the section `repeats`.
    pub fn check_repeats(&self) -> Result<(), Fault> {
        let is_once = matches!(self.repeats, Repeats::Auto | Repeats::ONCE);
        if is_once || self.cost.has_time() {
            return Ok(());
        }
        let message = "`repeats` requires times, and none are measured";
        let repeats = FieldPath::default().key("repeats");
        Err(Fault::new(
            repeats,
            message,
            "expected `auto`, `1`, or `cost: time`",
        ))
    }

    /// Sets the number of spheres of each `sphere_cloud`, from 1 to a billion,
    /// and scales their radii so that they fill the same share of space.
    ///
    /// # Errors
    /// The scene has no `sphere_cloud`.
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
        let objects = FieldPath::default().key("objects");
        let message = "the scene has no `sphere_cloud`, whose count could change";
        Err(Fault::new(objects, message, "no `sphere_cloud` here"))
    }
}
