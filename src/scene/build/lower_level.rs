//! Adds instanced meshes to the lower level of a scene.

use glam::{DAffine3, DVec3};

use super::geometries::MeshInstances;
use super::placement::Placement;
use crate::config::Config;
use crate::yaml::{Fault, FieldPath};
use import::Mesh;
use world::geometry::{InstanceTransform, RenderSpace};
use world::scene::{Attributes, LowerLevel, MaterialId};

/// Maximum number of triangles of all instances of an emissive material: each is a separate light.
const MAX_EMITTING: u64 = 1 << 20;

/// Adds a mesh and its instances, and its number of degenerate triangles to `n_degenerate`;
/// returns the index of the mesh's first triangle and its attributes.
///
/// # Errors
/// A placement exceeds the range of 32-bit numbers, or the mesh exceeds the memory.
pub(super) fn add_instances(
    lower_level: &mut LowerLevel,
    placement: &Placement,
    placed: MeshInstances,
    n_degenerate: &mut u64,
) -> Result<(u32, Attributes), Fault> {
    let MeshInstances {
        mut mesh,
        places,
        scalars,
    } = placed;
    // Add the triangles in the mesh's own space.
    let mesh_from_unit = to_unit_size(&mut mesh);
    let first = lower_level.triangles.len() as u32;
    let (in_mesh, render_from_object) = placement.in_object_space();
    let attributes = in_mesh.add_mesh(mesh, &mut lower_level.triangles, n_degenerate)?;
    // Add an instance for each place.
    let transforms = places
        .iter()
        .map(|place| InstanceTransform::new(&(render_from_object * *place * mesh_from_unit)));
    let stored = |number: &f64| placement.stored(0, *number);
    let scalars = scalars.as_ref().map(|scalars| scalars.iter().map(stored));
    lower_level
        .end_mesh(first, placement.id(), transforms, scalars)
        .map_err(|i| placement.place_out_of_range(i))?;
    Ok((first, attributes))
}

/// Checks that the instances that emit light are few enough to be sampled.
///
/// # Errors
/// The material with too many triangles.
pub(super) fn check_emission(lower_level: &LowerLevel, config: &Config) -> Result<(), Fault> {
    let numbered = (0..).map(MaterialId).zip(&config.materials);
    let emitting = numbered.filter(|(_, (_, material))| material.emits());
    let mut counted = emitting.map(|(id, (name, _))| (name, lower_level.n_triangles(id)));
    let Some((name, n)) = counted.find(|(_, n)| *n > MAX_EMITTING) else {
        return Ok(());
    };
    let path = FieldPath::default().key("materials").key(name);
    let message = format!("instances with the material `{name}` emit light from {n} triangles");
    let expected = format!("expected at most {MAX_EMITTING}");
    Err(Fault::new(path.key("emission"), message, expected)
        .with_help("emit light from fewer instances, or from a mesh of fewer triangles"))
}

/// Moves the center of a mesh to the origin, where numbers have the most digits, and scales it by a
/// power of two to unit size; returns the map from there back.
fn to_unit_size(mesh: &mut Mesh) -> DAffine3 {
    let bounds = mesh.bounds();
    let size = (bounds.max - bounds.min).max_element().into();
    let center = bounds.center();
    let unit = RenderSpace::new(size, DVec3::ZERO, size).unit();
    for vertex in &mut mesh.vertices {
        *vertex = ((vertex.as_dvec3() - center.as_dvec3()) / unit).as_vec3();
    }
    let origin = std::mem::take(&mut mesh.origin) + center.as_dvec3();
    DAffine3::from_translation(origin) * DAffine3::from_scale(DVec3::splat(unit))
}
