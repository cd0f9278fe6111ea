//! An instanced mesh.

use std::path::{Path, PathBuf};

use glam::{DAffine3, DQuat, DVec3, Vec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::file::MeshFile;
use super::generator::MAX_SHAPES;
use super::place_scale::PlaceScale;
use import::{InstancePlace, PlaceArrays};
use math::sampling::uniform;
use world::geometry::TransformStep;
use world::kinds;
use world::material::ArrayChoice;
use world::values::{self, NonEmpty};

/// Instances of a mesh: it is stored once, and each instance costs only the memory of its
/// placement. The object's `transform` applies to all of them.
///
/// ```
/// # use raycost_scene::config::InstancedMesh;
/// let pair: InstancedMesh = raycost_scene::yaml::from_str("
/// mesh: { file: meshes/spot.obj, normals: smooth }
/// places:                                  # the steps of an instance each, as in `transform`
///   - [{ translate: [-1, 0, 0] }]
///   - [{ scale: 0.5 }, { rotate: { axis: [0, 1, 0], angle_deg: 90 } }, { translate: [1, 0, 0] }]
/// ").unwrap();
/// let arrows: InstancedMesh = raycost_scene::yaml::from_str("
/// mesh: { file: meshes/spot.obj }
/// points: { file: grains.vtp, scale: { array: diameter, factor: 0.5 }, orient: { array: velocity } }
/// ").unwrap();
/// let herd: InstancedMesh = raycost_scene::yaml::from_str("
/// mesh: { file: meshes/spot.obj }
/// cloud: { count: 10000, min: [-50, 0, -50], max: [50, 0, 50], scale: [0.8, 1.2], turn: [0, 1, 0], seed: 1 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(try_from = "InstanceKeys", into = "InstanceKeys")]
pub struct InstancedMesh {
    /// The mesh.
    pub mesh: MeshFile,
    /// The places of the instances.
    pub places: InstancePlaces,
}

/// The places of instances.
#[derive(Debug, Clone, PartialEq)]
pub enum InstancePlaces {
    /// A list of steps per instance; at least one instance.
    Listed(Vec<Vec<TransformStep>>),
    /// The points of a file.
    Points(PlacePoints),
    /// Random places.
    Cloud(PlaceCloud),
}

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "instances such as { mesh: { file: … }, places: [ … ] }"
)]
struct InstanceKeys {
    /// The mesh.
    mesh: MeshFile,
    /// For each instance a list of steps as in `transform`.
    #[serde(default, with = "Places")]
    places: Option<Vec<Vec<TransformStep>>>,
    /// Instead of `places`, a table or a VTK file: an instance at each of its points.
    #[serde(default)]
    points: Option<PlacePoints>,
    /// Instead of `places`, random places in a box.
    #[serde(default)]
    cloud: Option<PlaceCloud>,
}

impl TryFrom<InstanceKeys> for InstancedMesh {
    type Error = &'static str;

    fn try_from(keys: InstanceKeys) -> Result<Self, Self::Error> {
        let mesh = keys.mesh;
        let places = match (keys.places, keys.points, keys.cloud) {
            (Some(places), None, None) => InstancePlaces::Listed(places),
            (None, Some(points), None) => InstancePlaces::Points(points),
            (None, None, Some(cloud)) => InstancePlaces::Cloud(cloud),
            _ => return Err("cannot be placed, expected one of `places`, `points`, `cloud`"),
        };
        Ok(Self { mesh, places })
    }
}

impl From<InstancedMesh> for InstanceKeys {
    fn from(InstancedMesh { mesh, places }: InstancedMesh) -> Self {
        let (places, points, cloud) = match places {
            InstancePlaces::Listed(places) => (Some(places), None, None),
            InstancePlaces::Points(points) => (None, Some(points), None),
            InstancePlaces::Cloud(cloud) => (None, None, Some(cloud)),
        };
        Self {
            mesh,
            places,
            points,
            cloud,
        }
    }
}

impl InstancedMesh {
    /// The YAML key.
    pub const KEY: &'static str = "instances";

    /// Returns the file of the points, relative to the scene file's folder, if there is one.
    pub fn points_file(&self) -> Option<&Path> {
        match &self.places {
            InstancePlaces::Points(points) => Some(&points.file),
            InstancePlaces::Listed(_) | InstancePlaces::Cloud(_) => None,
        }
    }
}

kinds! {
    Places: Vec<Vec<TransformStep>> = NonEmpty::<Vec<TransformStep>>::of("place");
}

/// A table of places: comma-separated values below a header with the columns `x`, `y` and `z`, and
/// optionally `scale`, or `scale_x`, `scale_y` and `scale_z`, and `direction_x`, `direction_y` and
/// `direction_z`, to which the x axis of the mesh is turned. Or a VTK file: an instance at each of
/// its points.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(deny_unknown_fields, expecting = "points such as { file: trees.csv }")]
pub struct PlacePoints {
    /// The file, relative to the scene file's folder.
    pub file: PathBuf,
    /// The scale of all instances; of a VTK file also an array.
    #[serde(default)]
    pub scale: PlaceScale,
    /// The array of vectors to which the x axis of the mesh is turned.
    #[serde(default)]
    pub orient: Option<OrientArray>,
}

/// An array of directions.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "an array such as { array: velocity }"
)]
pub struct OrientArray {
    /// The name of the array of vectors of points.
    #[serde(with = "values::Name")]
    array: String,
}

impl PlacePoints {
    /// Reads the places from their file at `path`, with the numbers of an array.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or lacks this array or any place.
    pub fn read(
        &self,
        path: &Path,
        color: Option<&ArrayChoice>,
    ) -> import::Result<Vec<InstancePlace>> {
        let scale = self.scale.array();
        let arrays = PlaceArrays {
            scale: scale.as_ref(),
            orient: self.orient.as_ref().map(|orient| orient.array.as_str()),
            color,
        };
        let mut places = import::read_places(path, arrays)?;
        for place in &mut places {
            place.scale *= self.scale.factor();
        }
        Ok(places)
    }
}

/// Random places in a box, with random scales in a range and random angles, all uniformly
/// distributed. The same seed gives the same places.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceCloud {
    /// The number of instances, at least 1.
    #[serde(with = "values::Count::<MAX_SHAPES>")]
    pub count: u32,
    /// One corner of the box of the positions.
    #[serde(with = "values::Point")]
    pub min: DVec3,
    /// The opposite corner.
    #[serde(with = "values::Point")]
    pub max: DVec3,
    /// Least and greatest scale, or a single one for all; 1 if not given.
    #[serde(default = "same_size", with = "values::PositiveRange")]
    pub scale: [f32; 2],
    /// The axis about which each instance is rotated by a random angle; no rotation if not given.
    #[serde(default, with = "values::Direction")]
    pub turn: Option<Vec3>,
    /// The seed of positions, scales and angles; 0 if not given.
    #[serde(with = "values::Unsigned", default)]
    pub seed: u64,
}

fn same_size() -> [f32; 2] {
    [1.0; 2]
}

impl PlaceCloud {
    /// Returns the place of instance `i`.
    pub fn place(&self, i: usize) -> DAffine3 {
        let [x, y, z, s] = uniform([self.seed, i as u64, 0]);
        let [angle, ..] = uniform([self.seed, i as u64, 1]);
        let [least, greatest] = self.scale;
        let turn = self.turn.map_or(DQuat::IDENTITY, |axis| {
            let angle = std::f64::consts::TAU * f64::from(angle);
            DQuat::from_axis_angle(axis.as_dvec3().normalize(), angle)
        });
        let position = self.min + (self.max - self.min) * DVec3::new(x.into(), y.into(), z.into());
        let scale = DVec3::splat((least + (greatest - least) * s).into());
        DAffine3::from_scale_rotation_translation(scale, turn, position)
    }
}
