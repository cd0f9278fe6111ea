//! Materials of mesh files as materials of scenes.

use glam::Vec3;

use import::{Finish, MeshMaterial, MeshOpacity, MeshPicture};
use world::material::{
    Dielectric, ImageTexture, Mapping, Material, MaterialKind, NormalMap, Opacity, Principled,
    Texture, VertexColors,
};

/// The part of a mesh file's material that a shading model shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MaterialDetail {
    /// The color and the highlight.
    Surface,
    /// Also transmitted light, opacity, and emitted light; metals as mirrors of their color.
    Light,
    /// All, with the roughness of the facets.
    Facets,
}

/// The least transmitted share of light for a medium, in shading models where a surface transmits
/// all light or none.
const MOSTLY: f32 = 0.5;

/// Converts the material of a mesh file.
pub(super) fn material_of_mesh(of: &MeshMaterial, detail: MaterialDetail) -> Material {
    let mut made = Material::matte(color_of(of));
    made.normal_map = of.normal_map.as_ref().map(|(picture, strength)| NormalMap {
        image: image(picture),
        strength: *strength,
    });
    take_finish(&mut made, of, detail);
    if detail == MaterialDetail::Surface {
        return made;
    }
    if of.is_unlit {
        show_unlit(&mut made);
    } else {
        made.emission = of.emission;
        made.factors.emission = of.emission_map.as_ref().map(image).map(Texture::Image);
    }
    // Media are closed, and a surface with holes is not a medium.
    let is_open = |opacity: &&MeshOpacity| opacity.threshold.is_some() || of.transmission == 0.0;
    if let Some(opacity) = of.opacity.as_ref().filter(is_open) {
        made.opacity = Some(Opacity {
            factor: opacity.factor,
            image: opacity.picture.as_ref().map(image),
            threshold: opacity.threshold,
        });
    } else if detail == MaterialDetail::Facets && of.transmission > 0.0 {
        let (metallic, roughness) = facets(of.finish);
        take_principled(
            &mut made,
            Principled {
                metallic,
                roughness,
                transmission: of.transmission,
                index: of.index,
            },
        );
    } else if of.transmission > MOSTLY {
        (made.ambient, made.diffuse) = (0.0, 0.0);
        made.kind = MaterialKind::Dielectric {
            medium: Dielectric {
                index: of.index,
                absorption: Vec3::ZERO,
                priority: 0,
            },
            roughness: 0.0,
        };
    }
    made
}

fn take_finish(made: &mut Material, of: &MeshMaterial, detail: MaterialDetail) {
    match of.finish {
        Finish::Highlight {
            specular,
            exponent,
            reflection,
        } => {
            (made.specular, made.exponent) = (specular, exponent);
            made.kind = MaterialKind::Opaque { reflection };
        }
        Finish::Facets {
            metallic,
            roughness,
        } if detail == MaterialDetail::Facets => {
            let map = of.facets_map.as_ref();
            // A medium is the same everywhere.
            let map = map.filter(|_| of.transmission == 0.0);
            let means = [roughness, metallic];
            let [roughness, metallic] = map.map_or(means, |(_, factors)| *factors);
            made.factors.facets = map.map(|(picture, _)| image(picture));
            take_principled(
                made,
                Principled {
                    metallic,
                    roughness,
                    transmission: 0.0,
                    index: of.index,
                },
            );
        }
        Finish::Facets {
            metallic,
            roughness,
        } => {
            // The highlight that path tracing produces for these facets.
            let alpha = (roughness * roughness).max(0.05);
            made.exponent = 2.0 / (alpha * alpha) - 2.0;
            made.specular = (0.2 + 0.5 * metallic) * (1.0 - roughness);
            let reflection = metallic * (1.0 - roughness);
            made.diffuse = 1.0 - reflection;
            made.kind = MaterialKind::Opaque { reflection };
        }
    }
}

/// Emits the color in place of reflecting light.
fn show_unlit(made: &mut Material) {
    *made = Material {
        emission: Vec3::ONE,
        ambient: 0.0,
        diffuse: 0.0,
        ..Material::matte(made.color.clone())
    };
    made.factors.emission = Some(made.color.clone());
}

fn take_principled(made: &mut Material, principled: Principled) {
    made.kind = principled.into();
    made.specular = 0.0;
}

/// Returns the metallicness and the roughness that give a highlight as wide as the finish's.
fn facets(finish: Finish) -> (f32, f32) {
    match finish {
        Finish::Facets {
            metallic,
            roughness,
        } => (metallic, roughness),
        Finish::Highlight { exponent, .. } => (0.0, (2.0 / (2.0 + exponent)).sqrt().sqrt()),
    }
}

fn color_of(of: &MeshMaterial) -> Texture {
    let image = of.picture.as_ref().map(image);
    match (of.has_vertex_colors, image) {
        (true, image) => Texture::VertexColors(VertexColors {
            // The color tints a picture.
            tint: image.as_ref().map_or(of.color, |_| Vec3::ONE),
            image: image.map(Box::new),
            array: None,
        }),
        (false, Some(image)) => Texture::Image(image),
        (false, None) => Texture::Color(of.color),
    }
}

fn image(of: &MeshPicture) -> ImageTexture {
    ImageTexture {
        file: of.name.clone(),
        mapping: Mapping::Uv,
        size: of.size,
        wrap: of.sampling.wrap,
        filter: of.sampling.filter,
        transfer: None,
        offset: of.offset,
        tint: of.tint,
        picture: of.picture.clone(),
    }
}
