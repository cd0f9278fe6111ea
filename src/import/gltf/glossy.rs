//! Materials of specular colors and glossiness as surfaces with a share of metal.

use glam::Vec3;
use gltf_json::extensions::material::PbrSpecularGlossiness;
use gltf_json::material::Material;
use world::color::Transfer;
use world::picture::{Picture, Texels};

/// A surface with a share of metal.
pub(super) struct MetallicColor {
    pub(super) color: Vec3,
    /// The share of metal, 0 to 1.
    pub(super) share: f32,
}

impl MetallicColor {
    /// Finds the surface that has these colors of diffuse and specular light, as the appendix of
    /// the extension `KHR_materials_pbrSpecularGlossiness` does: the color of a metal is that of
    /// its specular light; other surfaces reflect 4 % without color.
    pub(super) fn of_specular(diffuse: Vec3, specular: Vec3) -> Self {
        let white = 1.0 - specular.max_element();
        let share = share_of_metal(brightness(diffuse) * white, brightness(specular));
        let of_diffuse = diffuse * white / (1.0 - CLEAR) / (1.0 - share).max(1e-6);
        let of_specular = (specular - CLEAR * (1.0 - share)) / share.max(1e-6);
        let color = of_diffuse.lerp(of_specular, share * share);
        Self {
            color: color.clamp(Vec3::ZERO, Vec3::ONE),
            share,
        }
    }
}

/// The share of light that a surface without metal reflects as a mirror.
const CLEAR: f32 = 0.04;

/// Solves `diffuse = color (1 - CLEAR) (1 - share)` and `specular = CLEAR (1 - share) + color share`
/// for the share.
fn share_of_metal(diffuse: f32, specular: f32) -> f32 {
    if specular <= CLEAR {
        return 0.0;
    }
    let b = diffuse / (1.0 - CLEAR) + specular - 2.0 * CLEAR;
    let discriminant = (b * b - 4.0 * CLEAR * (CLEAR - specular)).max(0.0);
    ((discriminant.sqrt() - b) / (2.0 * CLEAR)).clamp(0.0, 1.0)
}

/// Returns the perceived brightness of a color.
fn brightness(color: Vec3) -> f32 {
    (color * color).dot(Vec3::new(0.299, 0.587, 0.114)).sqrt()
}

/// Returns the picture of a surface's roughness, in green, by one of its glossiness, the opacity;
/// `factor` multiplies the glossiness.
pub(super) fn roughness_picture(glossy: &Picture, factor: f32) -> Option<Picture> {
    let (size, texels) = glossy.reduced(usize::MAX);
    let rough = |[.., glossy]: [f32; 4]| [0, ((1.0 - factor * glossy) * 255.0).round() as u8, 255];
    Picture::new(
        size,
        Texels::Rgb(texels.map(rough).collect(), Transfer::Linear),
    )
}

/// Returns the description of a material by the colors of its diffuse and specular light.
pub(super) fn specular_glossiness(of: &Material) -> Option<&PbrSpecularGlossiness> {
    of.extensions.as_ref()?.pbr_specular_glossiness.as_ref()
}
