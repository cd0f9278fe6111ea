//! The light that a surface sends on from one light source.

use glam::Vec3;

use crate::light::Illumination;
use crate::material::Material;

/// Diffuse and specular light toward `to_viewer` (V) at a point of `color`
/// with unit normal `normal` (N), lit along L; all three unit vectors.
///
/// Blinn, "Models of Light Reflection for Computer Synthesized Pictures",
/// SIGGRAPH 1977: the highlight goes by the angle of N and the half vector of
/// L and V.
pub(super) fn reflected(
    material: &Material,
    color: Vec3,
    normal: Vec3,
    light: &Illumination,
    to_viewer: Vec3,
) -> Vec3 {
    let half_vector = (light.direction + to_viewer).normalize_or_zero();
    let diffuse = material.diffuse * normal.dot(light.direction).max(0.0);
    // libm's power gives the same bits on every machine.
    let highlight = libm::powf(normal.dot(half_vector).max(0.0), material.exponent);
    (diffuse * color + material.specular * highlight) * light.radiance
}
