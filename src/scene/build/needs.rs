//! The attributes of corners that the materials of an object need.

use super::geometries::ObjectGeometry;
use crate::config::{Config, Geometry, GeometryFile, Object};
use crate::yaml::{Fault, FieldPath};
use world::material::Material;

/// Attributes that the materials of an object need at the corners of triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Needs {
    /// True for texture coordinates.
    pub(super) uvs: bool,
    /// True for colors.
    pub(super) colors: bool,
}

impl Needs {
    /// Finds the needs of the object at `path`.
    ///
    /// # Errors
    /// Its geometry lacks one of the attributes.
    pub(super) fn find(
        config: &Config,
        object: &Object,
        geometry: &ObjectGeometry,
        path: &FieldPath,
    ) -> Result<Self, Fault> {
        let material_with = |needs_it: fn(&Material) -> bool| {
            let mut names = object.material.0.iter();
            names.find(|name| config.materials.get(*name).is_some_and(needs_it))
        };
        let of_uvs = material_with(Material::needs_uvs);
        if let Some(name) = of_uvs.filter(|_| !geometry.has_uvs()) {
            return Err(lacks_uvs(object, name, path));
        }
        let of_colors = material_with(|material| material.color.is_of_vertices());
        if let Some(name) = of_colors.filter(|_| !geometry.has_vertex_colors()) {
            return Err(lacks_colors(object, name, path));
        }
        Ok(Self {
            uvs: of_uvs.is_some(),
            colors: of_colors.is_some(),
        })
    }
}

fn lacks_uvs(object: &Object, material: &str, path: &FieldPath) -> Fault {
    let which = match &object.geometry {
        Geometry::File(GeometryFile::Mesh(_)) | Geometry::Instances(_) => {
            "which not all faces of this mesh have".to_owned()
        }
        other => format!("which a {other} has not"),
    };
    let message =
        format!("the picture of material `{material}` needs texture coordinates, {which}");
    let expected = "expected a mesh with texture coordinates";
    Fault::new(path.clone().key("material"), message, expected)
        .with_help("give the picture a `mapping`: `planar`, `spherical` or `triplanar`")
}

fn lacks_colors(object: &Object, material: &str, path: &FieldPath) -> Fault {
    let message = format!(
        "the material `{material}` has the colors of vertices, which this {} has not",
        object.geometry
    );
    let expected = "expected a mesh with colors at all vertices, in a PLY, OBJ or glTF file";
    Fault::new(path.clone().key("material"), message, expected)
}
