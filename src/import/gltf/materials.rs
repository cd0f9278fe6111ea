//! The materials of a glTF file.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Mat3, Vec2, Vec3};
use gltf_json::extensions::material::PbrSpecularGlossiness;
use gltf_json::extensions::texture::TextureTransform;
use gltf_json::material::{AlphaMode, Material};
use gltf_json::texture::{Info, MagFilter, Sampler, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root, image, texture};

use super::buffers::{Buffers, embedded};
use super::glossy::{MetallicColor, roughness_picture, specular_glossiness};
use crate::budget::Budget;
use crate::materials::{
    Finish, MAX_MATERIALS, MeshMaterial, MeshOpacity, MeshPicture, PictureShelf, path_in,
};
use crate::percent::percent_decoded;
use crate::picture::{PictureBytes, bytes_of_file};
use crate::{FileFault, Result};
use world::color::Transfer;
use world::picture::{Sampling, TexelFilter, Wrap};

/// Reads the materials.
pub(super) struct Materials<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: &'a Buffers<'a>,
    pub(super) folder: &'a Path,
    pub(super) budget: &'a mut Budget,
    pub(super) shelf: PictureShelf,
}

/// The placement of a material's pictures on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placing {
    /// The number of the set of texture coordinates.
    pub(super) set: u32,
    /// Maps the coordinates of the set to the picture's.
    pub(super) picture_from_set: Mat3,
}

/// The first set, without a transform.
impl Default for Placing {
    fn default() -> Self {
        Self {
            set: 0,
            picture_from_set: Mat3::IDENTITY,
        }
    }
}

impl Materials<'_> {
    /// Returns all materials; the last one is for triangles without any.
    ///
    /// # Errors
    /// There are too many.
    pub(super) fn read(&mut self) -> Result<Vec<MeshMaterial>> {
        if self.root.materials.len() >= MAX_MATERIALS {
            let expected = format!("at most {}", MAX_MATERIALS - 1);
            return Err(FileFault::new("too many materials", expected));
        }
        let mut found = Vec::with_capacity(self.root.materials.len() + 1);
        for (i, material) in self.root.materials.iter().enumerate() {
            let name = material
                .name
                .clone()
                .unwrap_or_else(|| format!("material {i}"));
            found.push(self.material(&name, material));
        }
        found.push(self.material("default", &Material::default()));
        Ok(found)
    }

    fn material(&mut self, name: &str, of: &Material) -> MeshMaterial {
        let Base {
            color,
            opacity,
            picture,
            finish,
        } = match specular_glossiness(of) {
            Some(glossy) => self.base_of_glossy(glossy),
            None => self.base(of),
        };
        let extensions = of.extensions.as_ref();
        let index = extensions
            .and_then(|of| of.ior.as_ref())
            .map_or(1.5, |of| of.ior.0);
        let (emission, emission_map) = self.emission(of);
        // Make the opaque surface.
        let mut made = MeshMaterial {
            finish,
            index: index.clamp(1.0, 10.0),
            emission,
            emission_map,
            facets_map: self.facets_map(of, finish),
            normal_map: self.normal_map(of),
            is_unlit: extensions.is_some_and(|of| of.unlit.is_some()),
            ..MeshMaterial::new(name, color)
        };
        // Add transmission, and opacity by the alpha mode.
        if let Some(transmission) = extensions.and_then(|of| of.transmission.as_ref()) {
            let [share, ..] = self.mean(
                transmission.transmission_texture.as_ref(),
                Some(Transfer::Linear),
            );
            made.transmission = (transmission.transmission_factor.0 * share).clamp(0.0, 1.0);
        }
        made.opacity = has_opacity(of).then(|| MeshOpacity {
            factor: opacity.clamp(0.0, 1.0),
            picture: picture.clone().filter(|of| !of.picture.is_opaque()),
            threshold: (of.alpha_mode == Checked::Valid(AlphaMode::Mask))
                .then(|| of.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0)),
        });
        made.picture = picture;
        made
    }

    /// Reads the color of a material, and the means of its roughness and metallicness.
    fn base(&mut self, of: &Material) -> Base {
        let pbr = &of.pbr_metallic_roughness;
        let [red, green, blue, opacity] = pbr.base_color_factor.0;
        let color = Vec3::new(red, green, blue).clamp(Vec3::ZERO, Vec3::ONE);
        let [_, rough, metal, _] = self.mean(
            pbr.metallic_roughness_texture.as_ref(),
            Some(Transfer::Linear),
        );
        Base {
            color,
            opacity,
            picture: self.tinted(pbr.base_color_texture.as_ref(), color),
            finish: Finish::Facets {
                metallic: (pbr.metallic_factor.0 * metal).clamp(0.0, 1.0),
                roughness: (pbr.roughness_factor.0 * rough).clamp(0.0, 1.0),
            },
        }
    }

    /// Reads the colors of diffuse and specular light as those of a surface with a share of metal,
    /// by their means; [`facets_map`](Self::facets_map) has the roughness of each texel.
    fn base_of_glossy(&mut self, of: &PbrSpecularGlossiness) -> Base {
        let [red, green, blue, opacity] = of.diffuse_factor.0;
        let factor = Vec3::new(red, green, blue).clamp(Vec3::ZERO, Vec3::ONE);
        let [red, green, blue, _] = self.mean(of.diffuse_texture.as_ref(), None);
        let diffuse = factor * Vec3::new(red, green, blue);
        let [red, green, blue, glossy] = self.mean(of.specular_glossiness_texture.as_ref(), None);
        let specular = Vec3::from(of.specular_factor.0) * Vec3::new(red, green, blue);
        let MetallicColor { color, share } =
            MetallicColor::of_specular(diffuse, specular.clamp(Vec3::ZERO, Vec3::ONE));
        // The picture varies the diffuse color, which metals do not have.
        let tint = (color * factor / diffuse.max(Vec3::splat(1e-6))).min(Vec3::ONE);
        let picture = of.diffuse_texture.as_ref().filter(|_| share < 0.5);
        Base {
            color,
            opacity,
            picture: self.tinted(picture, tint),
            finish: Finish::Facets {
                metallic: share,
                roughness: (1.0 - of.glossiness_factor.0 * glossy).clamp(0.0, 1.0),
            },
        }
    }

    /// Returns the radiance that a surface emits, and the picture that multiplies it; a picture
    /// placed differently from the material's others is replaced by its mean.
    fn emission(&mut self, of: &Material) -> (Vec3, Option<MeshPicture>) {
        let factor = Vec3::from(of.emissive_factor.0).max(Vec3::ZERO);
        if factor == Vec3::ZERO {
            return (factor, None);
        }
        let extensions = of.extensions.as_ref();
        let strength = extensions.and_then(|of| of.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |of| of.emissive_strength.0);
        let bright = factor * strength.max(0.0);
        let emission = if bright.is_finite() { bright } else { factor };
        let map = self.placed_as_others(of, of.emissive_texture.as_ref(), None);
        if map.is_some() {
            return (emission, map);
        }
        let [red, green, blue, _] = self.mean(of.emissive_texture.as_ref(), None);
        (emission * Vec3::new(red, green, blue), None)
    }

    /// Returns the picture of roughness and metallicness, with its factors, if it is placed as the
    /// others are. One of glossiness varies the roughness of a surface with this finish.
    fn facets_map(&mut self, of: &Material, finish: Finish) -> Option<(MeshPicture, [f32; 2])> {
        if let (Some(glossy), Finish::Facets { metallic, .. }) = (specular_glossiness(of), finish) {
            let info = glossy.specular_glossiness_texture.as_ref();
            let mut map = self.placed_as_others(of, info, None)?;
            self.budget.take(map.picture.n_bytes()).ok()?;
            let factor = glossy.glossiness_factor.0.clamp(0.0, 1.0);
            map.picture = Arc::new(roughness_picture(&map.picture, factor)?);
            return Some((map, [1.0, metallic]));
        }
        let pbr = &of.pbr_metallic_roughness;
        let info = pbr.metallic_roughness_texture.as_ref();
        let map = self.placed_as_others(of, info, Some(Transfer::Linear))?;
        let factors = [pbr.roughness_factor.0, pbr.metallic_factor.0];
        Some((map, factors.map(|factor| factor.clamp(0.0, 1.0))))
    }

    /// Reads a picture if it is placed as the material's others are.
    fn placed_as_others(
        &mut self,
        of: &Material,
        info: Option<&Info>,
        transfer: Option<Transfer>,
    ) -> Option<MeshPicture> {
        let info = info.filter(|info| placing(info) == of_material(of));
        self.picture(info, transfer)
    }

    /// Returns the picture of normals if it is placed as the picture of the color is.
    fn normal_map(&mut self, of: &Material) -> Option<(MeshPicture, f32)> {
        let map = of.normal_texture.as_ref()?;
        let info = Info {
            index: map.index,
            tex_coord: map.tex_coord,
            extensions: None,
            extras: Default::default(),
        };
        let picture = self.placed_as_others(of, Some(&info), Some(Transfer::Linear))?;
        let strength = if map.scale.is_finite() {
            map.scale.max(0.0)
        } else {
            1.0
        };
        Some((picture, strength))
    }

    /// Returns the mean of a picture, or ones without a picture.
    fn mean(&mut self, info: Option<&Info>, transfer: Option<Transfer>) -> [f32; 4] {
        let picture = self.picture(info, transfer);
        let picture = picture.map(|of| of.picture).unwrap_or_default();
        let (_, mut texels) = picture.reduced(1);
        texels.next().unwrap_or([1.0; 4])
    }

    /// Reads the picture of a color, which a tint multiplies.
    fn tinted(&mut self, info: Option<&Info>, tint: Vec3) -> Option<MeshPicture> {
        let picture = self.picture(info, None)?;
        Some(MeshPicture { tint, ..picture })
    }

    /// Reads a picture; `None` without one that can be read.
    fn picture(&mut self, info: Option<&Info>, transfer: Option<Transfer>) -> Option<MeshPicture> {
        let texture = self.root.get(info?.index)?;
        let (root, buffers, folder) = (self.root, self.buffers, self.folder);
        let image = root.get(texture.source)?;
        let name = name_of(texture.source, image, folder);
        let budget = &mut *self.budget;
        let bytes = || bytes_of(root, image, buffers, folder, budget);
        let picture = self.shelf.picture_or_note(&name, transfer, bytes)?;
        Some(MeshPicture {
            sampling: sampling(root, texture),
            ..MeshPicture::new(name, picture)
        })
    }
}

/// The color of a material, and its scattering.
struct Base {
    color: Vec3,
    opacity: f32,
    /// The picture, with the color as its tint.
    picture: Option<MeshPicture>,
    finish: Finish,
}

/// Returns true if the opacities of a material's color count.
pub(super) fn has_opacity(material: &Material) -> bool {
    let mode = &material.alpha_mode;
    *mode == Checked::Valid(AlphaMode::Mask) || *mode == Checked::Valid(AlphaMode::Blend)
}

/// Returns the placement of a material's pictures: of the first one among color, normals, facets
/// and emission.
pub(super) fn of_material(material: &Material) -> Placing {
    let pbr = &material.pbr_metallic_roughness;
    if let (None, Some(map)) = (&pbr.base_color_texture, &material.normal_texture) {
        return Placing {
            set: map.tex_coord,
            ..Placing::default()
        };
    }
    let (color, others) = match specular_glossiness(material) {
        Some(glossy) => (&glossy.diffuse_texture, &glossy.specular_glossiness_texture),
        None => (&pbr.base_color_texture, &pbr.metallic_roughness_texture),
    };
    let first = color.as_ref().or(others.as_ref());
    let first = first.or(material.emissive_texture.as_ref());
    first.map_or(Placing::default(), placing)
}

fn placing(info: &Info) -> Placing {
    let extensions = info.extensions.as_ref();
    let Some(transform) = extensions.and_then(|of| of.texture_transform.as_ref()) else {
        return Placing {
            set: info.tex_coord,
            ..Placing::default()
        };
    };
    let TextureTransform {
        offset,
        rotation,
        scale,
        tex_coord,
        ..
    } = transform;
    // v grows downward, so that a counterclockwise rotation has a negative angle.
    let (sin, cos) = libm::sincosf(-rotation.0);
    let turned = Mat3::from_cols_array(&[cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0]);
    Placing {
        set: tex_coord.unwrap_or(info.tex_coord),
        picture_from_set: Mat3::from_translation(Vec2::from(offset.0))
            * turned
            * Mat3::from_scale(Vec2::from(scale.0)),
    }
}

/// Returns the name of a picture in messages, unique in its file.
fn name_of(index: Index<image::Image>, image: &image::Image, folder: &Path) -> PathBuf {
    match &image.uri {
        Some(uri) if !uri.starts_with("data:") => path_in(folder, &percent_decoded(uri)),
        _ => PathBuf::from(format!("images[{}]", index.value())),
    }
}

/// Returns the bytes of a picture.
fn bytes_of(
    root: &Root,
    image: &image::Image,
    buffers: &Buffers,
    folder: &Path,
    budget: &mut Budget,
) -> Result<PictureBytes> {
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => match embedded(uri, budget) {
            Some(bytes) => bytes?,
            None => return bytes_of_file(&path_in(folder, &percent_decoded(uri))),
        },
        (None, Some(view)) => {
            let (bytes, _) = buffers.view(root, view)?;
            budget.take(bytes.len() as u64)?;
            bytes.to_vec()
        }
        (None, None) => return Err(FileFault::new("it has no bytes", "a `uri`")),
    };
    Ok(Box::new(Cursor::new(bytes)))
}

fn sampling(root: &Root, texture: &texture::Texture) -> Sampling {
    let Some(sampler) = texture.sampler.and_then(|sampler| root.get(sampler)) else {
        return Sampling::default();
    };
    let Sampler {
        mag_filter, wrap_s, ..
    } = sampler;
    Sampling {
        filter: match mag_filter {
            Some(Checked::Valid(MagFilter::Nearest)) => TexelFilter::Nearest,
            _ => TexelFilter::Trilinear,
        },
        wrap: match wrap_s {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            _ => Wrap::Repeat,
        },
    }
}
