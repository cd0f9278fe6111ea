//! The colors of vertices.

use super::geometries::ObjectGeometry;
use crate::config::{Config, Object};
use crate::yaml::{Fault, FieldPath};
use world::material::Texture;

/// Returns true if one of the materials of the object at `path` shows vertex colors.
///
/// # Errors
/// One does, but the object lacks vertex colors.
pub(super) fn are_needed(
    config: &Config,
    object: &Object,
    geometry: &ObjectGeometry,
    path: &FieldPath,
) -> Result<bool, Fault> {
    let mut names = object.material.0.iter();
    let color_of = |name: &String| config.materials.get(name).map(|material| &material.color);
    let Some(name) = names.find(|name| color_of(name).is_some_and(Texture::is_of_vertices)) else {
        return Ok(false);
    };
    if geometry.has_vertex_colors() {
        return Ok(true);
    }
    let message = format!(
        "the material `{name}` has the colors of vertices, which this {} has not",
        object.geometry
    );
    let expected = "expected a mesh with colors at all vertices, in a PLY, OBJ or glTF file";
    Err(Fault::new(path.clone().key("material"), message, expected))
}
