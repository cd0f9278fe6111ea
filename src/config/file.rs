//! Objects of many shapes that are read from files.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

use crate::import::{self, ArrayChoice, ArrayOf, FileFault, RadiusChoice, Spheres};
use crate::yaml;

/// A file of shapes.
#[derive(Debug, Clone, PartialEq)]
pub enum GeometryFile {
    /// A triangle mesh.
    Mesh(MeshFile),
    /// A table of spheres, or points as spheres.
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
/// replaces the material's). Or a VTK file: a sphere for each of its points.
///
/// ```
/// # use raycost::config::SpheresFile;
/// let spheres: SpheresFile = raycost::yaml::from_str("
/// { file: particles.csv, radius: 0.01 }
/// ").unwrap();
/// let grains: SpheresFile = raycost::yaml::from_str("
/// { file: grains.vtp, radius: { array: diameter, scale: 0.5 } }
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
    /// The radius of all spheres, greater than 0, if the table has no column `r`; of the
    /// points of a VTK file also an array of radii.
    #[serde(default)]
    pub radius: Option<SphereRadius>,
}

/// The radii of spheres: one number, or an array of a VTK file.
#[derive(Debug, Clone, PartialEq)]
pub enum SphereRadius {
    /// The same for all.
    Same(f32),
    /// Those of an array.
    Array(RadiusArray),
}

/// An array of radii.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "an array such as { array: diameter, scale: 0.5 }"
)]
pub struct RadiusArray {
    /// The name of the array of points.
    pub array: String,
    /// The factor from its numbers to radii, greater than 0; 1 by default.
    #[serde(default = "one", deserialize_with = "yaml::positive")]
    pub scale: f32,
}

fn one() -> f32 {
    1.0
}

impl SpheresFile {
    /// Reads the spheres from their file at `path`, with the numbers of an array.
    ///
    /// # Errors
    /// A file that cannot be read, is damaged, or has no radius, no such array or no sphere.
    pub fn read(&self, path: &Path, array: Option<&ArrayChoice>) -> import::Result<Spheres> {
        if !import::is_vtk(path) {
            let radius = match &self.radius {
                None => None,
                Some(SphereRadius::Same(radius)) => Some(*radius),
                Some(SphereRadius::Array(_)) => {
                    return Err(FileFault::without_arrays(path, "a number as `radius`"));
                }
            };
            return match array {
                None => import::read_spheres(path, radius),
                Some(_) => Err(FileFault::without_arrays(path, "points of a VTK file")),
            };
        }
        let radius = match &self.radius {
            None => return Err(FileFault::without_radius(path)),
            Some(SphereRadius::Same(radius)) => RadiusChoice::Same(*radius),
            Some(SphereRadius::Array(RadiusArray { array, scale })) => RadiusChoice::Array {
                array: ArrayChoice {
                    name: array.clone(),
                    component: None,
                    of: Some(ArrayOf::Points),
                },
                factor: *scale,
            },
        };
        import::read_points(path, &radius, array)
    }
}

impl<'de> Deserialize<'de> for SphereRadius {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(RadiusVisitor)
    }
}

struct RadiusVisitor;

impl<'de> Visitor<'de> for RadiusVisitor {
    type Value = SphereRadius;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a radius greater than 0, or { array: … }")
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<SphereRadius, E> {
        yaml::positive(found.into_deserializer()).map(SphereRadius::Same)
    }

    fn visit_i64<E: Error>(self, found: i64) -> Result<SphereRadius, E> {
        self.visit_f64(found as f64)
    }

    fn visit_u64<E: Error>(self, found: u64) -> Result<SphereRadius, E> {
        self.visit_f64(found as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<SphereRadius, A::Error> {
        RadiusArray::deserialize(MapAccessDeserializer::new(map)).map(SphereRadius::Array)
    }
}
