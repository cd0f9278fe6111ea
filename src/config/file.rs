//! Objects of many shapes that are read from files.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::de::{Deserializer, MapAccess};
use serde::{Deserialize, Serialize};

use crate::yaml;

/// A file of shapes.
#[derive(Debug, Clone, PartialEq)]
pub enum GeometryFile {
    /// A triangle mesh.
    Mesh(MeshFile),
    /// A table of spheres.
    Spheres(SpheresFile),
}

impl GeometryFile {
    /// The YAML keys of all kinds.
    pub const KEYS: &[&str] = &["mesh", "spheres"];

    /// Reads the value of `key` from `map`; returns `None` if `key` is not one of
    /// [`Self::KEYS`].
    pub fn next_value<'de, A: MapAccess<'de>>(
        key: &str,
        map: &mut A,
    ) -> Result<Option<Self>, A::Error> {
        match key {
            "mesh" => map.next_value().map(|mesh| Some(Self::Mesh(mesh))),
            "spheres" => map.next_value().map(|table| Some(Self::Spheres(table))),
            _ => Ok(None),
        }
    }

    /// The file, relative to the scene file's folder.
    pub fn file(&self) -> &Path {
        match self {
            Self::Mesh(mesh) => &mesh.file,
            Self::Spheres(spheres) => &spheres.file,
        }
    }
}

/// The YAML key.
impl fmt::Display for GeometryFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mesh(_) => "mesh",
            Self::Spheres(_) => "spheres",
        })
    }
}

/// A triangle mesh in an OBJ, PLY or STL file, or the surface of a data set in a VTK file.
///
/// ```
/// # use raycost::config::MeshFile;
/// let mesh: MeshFile = raycost::yaml::from_str("
/// { file: meshes/spot.obj, normals: smooth }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a mesh such as { file: meshes/spot.obj }"
)]
pub struct MeshFile {
    /// The file, relative to the scene file's folder.
    pub file: PathBuf,
    /// The shading normals.
    #[serde(default)]
    pub normals: MeshNormals,
}

/// The shading normals of a mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", expecting = "`file`, `smooth` or `flat`")]
pub enum MeshNormals {
    /// Those of the file, or flat normals if it has none.
    #[default]
    File,
    /// At each vertex the mean of the adjacent triangles' normals.
    Smooth,
    /// The geometric normals of the triangles.
    Flat,
}

/// A table of spheres: comma-separated values below a header with the columns
/// `x`, `y` and `z`, and optionally `r` (radius) and `color` (`#rrggbb`,
/// replaces the material's).
///
/// ```
/// # use raycost::config::SpheresFile;
/// let spheres: SpheresFile = raycost::yaml::from_str("
/// { file: particles.csv, radius: 0.01 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "spheres such as { file: particles.csv, radius: 0.01 }"
)]
pub struct SpheresFile {
    /// The file, relative to the scene file's folder.
    pub file: PathBuf,
    /// The radius of all spheres, greater than 0, if the table has no column `r`.
    #[serde(deserialize_with = "some_positive", default)]
    pub radius: Option<f32>,
}

fn some_positive<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f32>, D::Error> {
    yaml::positive(d).map(Some)
}
