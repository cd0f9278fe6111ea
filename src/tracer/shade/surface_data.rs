//! The numbers of primitives that the formulas of whole paths read.

use glam::Vec3;

use math::simd::{Real, Vector};
use world::scene::{AttributeKind, PlacedPrimitive, Scene};

/// Appends the numbers of a primitive: the parameters of its shape; with a transform, both maps and
/// the bound of rounding errors; the opacities of its vertices; and its attributes of this kind. The
/// numbers of an instanced mesh are in the space of the mesh.
pub(super) fn surface_data(
    scene: &Scene,
    attributes: AttributeKind,
    has_opacities: bool,
    primitive: u32,
    numbers: &mut Vec<f32>,
) {
    let surface = &scene.primitives[primitive as usize];
    numbers.extend(surface.parameters());
    if let Some(transform) = surface.placement() {
        let [there, back] = [transform.world_from_object(), transform.object_from_world()];
        push_vectors(numbers, &there);
        push_vectors(numbers, &back);
        numbers.push(surface.rounding([Vec3::ZERO; 2]));
    }
    let placed = PlacedPrimitive::from(primitive);
    if has_opacities {
        numbers.extend(scene.vertex_opacities(primitive).unwrap_or_default());
    }
    if attributes.has_uvs() {
        let uvs = scene.vertex_uvs(primitive).unwrap_or_default();
        numbers.extend(uvs.as_flattened());
    }
    if attributes.has_normals() {
        push_vectors(numbers, &scene.vertex_normals(placed).unwrap_or_default());
    }
    if attributes.has_corner_colors() {
        push_vectors(numbers, &scene.vertex_colors(primitive).unwrap_or_default());
    }
    if attributes.has_corner_scalars() {
        numbers.extend(scene.vertex_scalars(placed).unwrap_or_default());
    }
    match attributes {
        AttributeKind::Scalars => numbers.push(scene.own_scalar(primitive).unwrap_or(f32::NAN)),
        AttributeKind::Ends => {
            numbers.extend(scene.end_scalars(primitive).unwrap_or([f32::NAN; 2]));
        }
        AttributeKind::Colors => {
            push_vectors(numbers, &[scene.own_color(primitive).unwrap_or_default()]);
        }
        AttributeKind::Corners { .. } => {}
    }
}

fn push_vectors(numbers: &mut Vec<f32>, vectors: &[Vec3]) {
    numbers.extend(vectors.iter().flat_map(Vec3::to_array));
}

/// Reads the numbers of [`surface_data`] in their order.
pub(super) struct DataReader<'a, R>(pub(super) &'a mut dyn FnMut() -> R);

impl<R: Real> DataReader<'_, R> {
    pub(super) fn number(&mut self) -> R {
        (self.0)()
    }

    pub(super) fn numbers<const N: usize>(&mut self) -> [R; N] {
        std::array::from_fn(|_| self.number())
    }

    pub(super) fn vector(&mut self) -> Vector<R> {
        let [x, y, z] = self.numbers();
        Vector { x, y, z }
    }

    pub(super) fn vectors<const N: usize>(&mut self) -> [Vector<R>; N] {
        std::array::from_fn(|_| self.vector())
    }
}
