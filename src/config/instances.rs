//! A mesh that is placed many times.

use serde::Deserialize;
use serde::de::Deserializer;

use super::file::MeshFile;
use crate::geometry::TransformStep;
use crate::yaml;

/// Instances of a mesh: it is stored once, and each instance costs its place alone. The
/// object's `transform` applies to all of them.
///
/// ```
/// # use raycost::config::InstancedMesh;
/// let herd: InstancedMesh = raycost::yaml::from_str("
/// mesh: { file: meshes/spot.obj, normals: smooth }
/// places:                                  # the steps of an instance each, as in `transform`
///   - [{ translate: [-1, 0, 0] }]
///   - [{ scale: 0.5 }, { rotate: { axis: [0, 1, 0], angle_deg: 90 } }, { translate: [1, 0, 0] }]
/// ").unwrap();
/// # assert_eq!(herd.places.len(), 2);
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "instances such as { mesh: { file: … }, places: [ … ] }"
)]
pub struct InstancedMesh {
    /// The mesh.
    pub mesh: MeshFile,
    /// The places of the instances, at least one: for each a list of steps as in `transform`.
    #[serde(deserialize_with = "places")]
    pub places: Vec<Vec<TransformStep>>,
}

impl InstancedMesh {
    /// The YAML key.
    pub const KEY: &'static str = "instances";
}

fn places<'de, D: Deserializer<'de>>(d: D) -> Result<Vec<Vec<TransformStep>>, D::Error> {
    yaml::non_empty(d, "place")
}
