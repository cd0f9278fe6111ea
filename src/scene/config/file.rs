//! Objects of many shapes read from files.

use std::fmt;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::de::MapAccess;
use serde::{Deserialize, Serialize};

use super::isosurface::Isosurface;
use super::normals::MeshNormals;
use super::same_or_array::{NumberArray, SameOrArray};
use crate::yaml::{Fault, FieldPath};
use import::{DataFile, FileFault, RadiusChoice, Spheres, TimeStep, Tubes};
use world::kinds;
use world::material::ArrayChoice;
use world::values::{self, Whole};

/// A file of shapes.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GeometryFile {
    /// A triangle mesh.
    Mesh(MeshFile),
    /// A table of spheres, or points as spheres.
    Spheres(SpheresFile),
    /// Lines as tubes.
    Tubes(TubesFile),
}

impl GeometryFile {
    /// The YAML keys of all kinds.
    pub const KEYS: &[&str] = &["mesh", "spheres", "tubes"];

    /// Reads the value of `key` from `map`; returns `None` if `key` is not one of
    /// [`Self::KEYS`].
    pub fn next_value<'de, A: MapAccess<'de>>(
        key: &str,
        map: &mut A,
    ) -> Result<Option<Self>, A::Error> {
        match key {
            "mesh" => map.next_value().map(|mesh| Some(Self::Mesh(mesh))),
            "spheres" => map.next_value().map(|table| Some(Self::Spheres(table))),
            "tubes" => map.next_value().map(|lines| Some(Self::Tubes(lines))),
            _ => Ok(None),
        }
    }

    /// Returns the file, relative to the scene file's folder, or a series of files.
    pub fn file(&self) -> &Path {
        match self {
            Self::Mesh(mesh) => &mesh.file,
            Self::Spheres(spheres) => &spheres.file,
            Self::Tubes(tubes) => &tubes.file,
        }
    }

    /// Returns the file with the time step that the scene chooses.
    pub fn data_file(&self) -> DataFile<'_> {
        let step = match self {
            Self::Mesh(mesh) => mesh.step,
            Self::Spheres(spheres) => spheres.step,
            Self::Tubes(tubes) => tubes.step,
        };
        let path = self.file();
        DataFile { path, step }
    }

    /// Returns the same file at a time step.
    pub fn at(&self, step: &TimeStep) -> Self {
        let (file, step) = (step.file.clone(), step.step);
        match self.clone() {
            Self::Mesh(mesh) => Self::Mesh(MeshFile { file, step, ..mesh }),
            Self::Spheres(spheres) => Self::Spheres(SpheresFile {
                file,
                step,
                ..spheres
            }),
            Self::Tubes(tubes) => Self::Tubes(TubesFile {
                file,
                step,
                ..tubes
            }),
        }
    }
}

/// Formats the YAML key.
impl fmt::Display for GeometryFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mesh(_) => "mesh",
            Self::Spheres(_) => "spheres",
            Self::Tubes(_) => "tubes",
        })
    }
}

/// A triangle mesh in an OBJ, PLY, STL or glTF file, or the surface of a data set in a VTK file.
/// Without a `material` next to it, it has the materials of the file.
///
/// ```
/// # use raycost_scene::config::MeshFile;
/// let mesh: MeshFile = raycost_scene::yaml::from_str("
/// { file: meshes/spot.obj, normals: smooth }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "a mesh such as { file: meshes/spot.obj }"
)]
pub struct MeshFile {
    /// The file, relative to the scene file's folder, or a data series: `step_%04d.vtu`, `.pvd`.
    pub file: PathBuf,
    /// The time step of a VTKHDF file or a `.pvd`, from 0; all of them, as frames, if not given.
    #[serde(default, with = "Step")]
    pub step: Option<usize>,
    /// The shading normals.
    #[serde(default)]
    pub normals: MeshNormals,
    /// Instead of the surface of the data set in a VTK file, the surface within it where an array
    /// has a value.
    #[serde(default)]
    pub isosurface: Option<Isosurface>,
    /// A factor on the lights of a glTF file, at least 0; 1 by default.
    #[serde(default = "values::one", with = "values::Intensity")]
    pub lights: f32,
}

/// A table of spheres: comma-separated values below a header with the columns
/// `x`, `y` and `z`, and optionally `r` (radius), `color` (`#rrggbb`,
/// replaces the material's) and others, which are arrays. Or a VTK file or a mesh: a sphere for
/// each of its points or vertices.
///
/// ```
/// # use raycost_scene::config::SpheresFile;
/// let spheres: SpheresFile = raycost_scene::yaml::from_str("
/// { file: particles.csv, radius: 0.01 }
/// ").unwrap();
/// let grains: SpheresFile = raycost_scene::yaml::from_str("
/// { file: grains.vtp, radius: { array: diameter, scale: 0.5 } }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "spheres such as { file: particles.csv, radius: 0.01 }"
)]
pub struct SpheresFile {
    /// The file, relative to the scene file's folder, or a data series: `step_%04d.vtp`, `.pvd`.
    pub file: PathBuf,
    /// The radius, if the table has no column `r`; or an array of radii.
    #[serde(default)]
    pub radius: Option<PointRadius>,
    /// The time step of a VTKHDF file or a `.pvd`, from 0; all of them, as frames, if not given.
    #[serde(default, with = "Step")]
    pub step: Option<usize>,
}

/// The lines of a VTK file as tubes, with a radius that changes from point to point. Or a
/// table: comma-separated values below a header with the columns `x`, `y` and `z`, and
/// optionally `r` (radius), `line` (a number or a name; where it changes, another line
/// begins) and others, which are arrays.
///
/// ```
/// # use raycost_scene::config::TubesFile;
/// let bonds: TubesFile = raycost_scene::yaml::from_str("
/// { file: bonds.csv, radius: 0.01 }
/// ").unwrap();
/// let streamlines: TubesFile = raycost_scene::yaml::from_str("
/// { file: streamlines.vtp, radius: { array: speed, scale: 0.02 } }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "tubes such as { file: streamlines.vtp, radius: 0.01 }"
)]
pub struct TubesFile {
    /// The file, relative to the scene file's folder, or a data series: `step_%04d.vtp`, `.pvd`.
    pub file: PathBuf,
    /// The radius, if the table has no column `r`; or an array of radii.
    #[serde(default)]
    pub radius: Option<PointRadius>,
    /// The time step of a VTKHDF file or a `.pvd`, from 0; all of them, as frames, if not given.
    #[serde(default, with = "Step")]
    pub step: Option<usize>,
}

/// The radii of spheres or tubes: one number, or an array of a VTK file or a table.
pub type PointRadius = SameOrArray<RadiusArray>;

/// An array of radii.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "an array such as { array: diameter, scale: 0.5 }"
)]
pub struct RadiusArray {
    /// The name of the array of points, or of the column of a table.
    pub array: String,
    /// The factor from its numbers to radii, greater than 0; 1 by default.
    #[serde(default = "values::one", with = "values::Positive")]
    pub scale: f32,
}

impl NumberArray for RadiusArray {
    const EXPECTED: &str = "a radius greater than 0, or { array: … }";
}

kinds! {
    Step: usize = Whole(0..=MAX_STEP) => |step| step as usize;
}

/// The maximum time step of a file with several.
const MAX_STEP: u32 = 999_999;

impl MeshFile {
    /// Returns the file at `path`, with the time step.
    pub fn data_file<'a>(&self, path: &'a Path) -> DataFile<'a> {
        let step = self.step;
        DataFile { path, step }
    }
}

/// Returns the conversion of the fault of a file to the fault of the scene's value at `path`, which
/// names the file.
pub fn at_value(path: &FieldPath) -> impl Fn(FileFault) -> Fault {
    move |fault| Fault {
        help: fault.why_missing(),
        ..Fault::new(path.clone(), fault.message(), fault.expectation())
    }
}

impl SpheresFile {
    /// Reads the spheres from their file at `path`, with the numbers of an array.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or lacks a radius, this array or any sphere.
    pub fn read(&self, path: &Path, array: Option<&ArrayChoice>) -> import::Result<Spheres> {
        let (step, radius) = (self.step, self.radius.as_ref().map(PointRadius::choice));
        let file = DataFile { path, step };
        if import::is_mesh(path) || import::is_vtk(path) {
            let radius = radius.ok_or_else(|| FileFault::without_radius(path))?;
            return import::read_points(file, &radius, array);
        }
        import::read_spheres(file, radius.as_ref(), array)
    }
}

impl TubesFile {
    /// Reads the tubes from their file at `path`, with the numbers of an array.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or lacks a radius, this array or any line.
    pub fn read(&self, path: &Path, array: Option<&ArrayChoice>) -> import::Result<Tubes> {
        let (step, radius) = (self.step, self.radius.as_ref().map(PointRadius::choice));
        let file = DataFile { path, step };
        if import::is_vtk(path) {
            let radius = radius.ok_or_else(|| FileFault::without_radius(path))?;
            return import::read_lines(file, &radius, array);
        }
        import::read_tubes(file, radius.as_ref(), array)
    }
}

impl PointRadius {
    fn choice(&self) -> RadiusChoice {
        match self {
            Self::Same(radius) => RadiusChoice::Same(*radius),
            Self::Array(RadiusArray { array, scale }) => RadiusChoice::Array {
                array: ArrayChoice::point_array(array, None),
                factor: *scale,
            },
        }
    }
}
