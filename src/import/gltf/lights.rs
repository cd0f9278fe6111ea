//! The lights of a glTF file: the extension `KHR_lights_punctual`.

use std::f32::consts::FRAC_1_PI;

use glam::{DAffine3, DVec3, Vec3};
use gltf_json::extensions::scene::khr_lights_punctual::{Light as GltfLight, Type};
use gltf_json::scene::Node;
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

use crate::{FileFault, Result};
use world::light::{DirectionalLight, Falloff, Light, PointLight, SpotLight};

/// Returns the light of a node, if it has one.
///
/// # Errors
/// A number of the light is out of its range.
pub(super) fn of_node<'a>(root: &'a Root, node: &Node) -> Result<Option<&'a GltfLight>> {
    let extensions = node.extensions.as_ref();
    let index = extensions.and_then(|known| known.khr_lights_punctual.as_ref());
    let Some(index) = index.map(|found| found.light) else {
        return Ok(None);
    };
    let light = root.get(index);
    light.map(|light| check(light, index)).transpose()?;
    Ok(light)
}

/// Returns the light of a node in the space of the scene; `None` if its node is scaled to nothing, or
/// its type is unknown.
pub(super) fn placed(light: &GltfLight, scene_from_node: &DAffine3) -> Option<Light> {
    // Only the place and the direction of the node count, not its scale.
    let axis = scene_from_node.transform_vector3(DVec3::NEG_Z);
    let axis = axis.try_normalize().map(|axis| axis.as_vec3());
    // A white matte surface reflects a share of 1 / pi of an illuminance into each direction; the
    // intensities of a scene are the radiance that it reflects.
    let intensity = FRAC_1_PI * light.intensity;
    let color = Vec3::from(light.color);
    let at_point = PointLight {
        position: scene_from_node.translation,
        color,
        intensity,
        falloff: Falloff::InverseSquare,
    };
    match (&light.type_, &light.spot) {
        (Checked::Valid(Type::Directional), _) => axis.map(|direction| {
            Light::Directional(DirectionalLight {
                direction,
                color,
                intensity,
            })
        }),
        (Checked::Valid(Type::Spot), Some(spot)) => axis.map(|axis| {
            let angles = [spot.outer_cone_angle, spot.inner_cone_angle];
            Light::Spot(SpotLight::new(at_point, axis, angles.map(f64::from)))
        }),
        (Checked::Valid(Type::Point), _) => Some(Light::Point(at_point)),
        _ => None,
    }
}

/// Refuses numbers that the extension does not allow.
fn check(light: &GltfLight, index: Index<GltfLight>) -> Result<()> {
    let is_intensity = |number: f32| number.is_finite() && number >= 0.0;
    let has_cone = light.spot.as_ref().is_none_or(|spot| {
        let [inner, outer] = [spot.inner_cone_angle, spot.outer_cone_angle];
        // Programs round a half turn up.
        0.0 <= inner && inner <= outer && outer > 0.0 && outer < 1.571
    });
    let (what, expected) = if !is_intensity(light.intensity) {
        ("intensity", "a number, at least 0")
    } else if !light.color.into_iter().all(is_intensity) {
        ("color", "three numbers, at least 0")
    } else if !has_cone {
        (
            "cone",
            "an inner angle from 0 to the outer one, which is at most pi / 2",
        )
    } else {
        return Ok(());
    };
    let problem = format!("the {what} of light {} is out of range", index.value());
    Err(FileFault::new(problem, expected))
}
