//! The materials of mesh files, and the pictures that they name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;

use super::picture::{PictureBytes, Reading, read_picture_of};
use super::{FileFault, Result};
use crate::color::Transfer;
use crate::picture::{Picture, Sampling};

/// Largest number of materials of a file.
pub(super) const MAX_MATERIALS: usize = 4096;

/// A material of a mesh file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshMaterial {
    /// Its name in the file, or one made up.
    pub name: String,
    /// The color: linear light, each channel from 0 to 1. Of no use beside a picture, which
    /// is multiplied by it already.
    pub color: Vec3,
    /// The picture that gives the color.
    pub picture: Option<MeshPicture>,
    /// Whether the colors of the mesh's vertices give the color, times that of the picture.
    pub has_vertex_colors: bool,
    /// How the surface scatters light.
    pub finish: Finish,
    /// The share of light that goes through the surface, 0 to 1.
    pub transmission: f32,
    /// The index of refraction of what is behind it, 1 to 10.
    pub index: f32,
    /// The radiance that the surface emits.
    pub emission: Vec3,
    /// The picture whose opacity cuts holes, and the least opacity of the surface.
    pub cutout: Option<(MeshPicture, f32)>,
    /// The picture of normals, and the factor of the slopes of its bumps.
    pub normal_map: Option<(MeshPicture, f32)>,
    /// The picture that `emission` is multiplied by.
    pub emission_map: Option<MeshPicture>,
    /// The picture of roughness, in green, and metal, in blue, and the factors of both; the
    /// finish has their means.
    pub facets_map: Option<(MeshPicture, [f32; 2])>,
}

/// How a surface scatters light besides its color.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finish {
    /// Diffusely, with a highlight.
    Highlight {
        /// Its strength, 0 to 1.
        specular: f32,
        /// Its exponent, at least 0.
        exponent: f32,
        /// The fraction of light that is mirrored, 0 to 1.
        reflection: f32,
    },
    /// By microscopic facets.
    Facets {
        /// The share of metal, 0 to 1.
        metallic: f32,
        /// Their roughness, 0 to 1.
        roughness: f32,
    },
}

/// A picture of a mesh file's material, by its texture coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPicture {
    /// Its file, or what the mesh file calls it.
    pub name: PathBuf,
    /// The picture.
    pub picture: Arc<Picture>,
    /// How it is looked up.
    pub sampling: Sampling,
    /// Its width and height in texture coordinates.
    pub size: [f32; 2],
}

impl MeshMaterial {
    /// A matte surface.
    pub(super) fn new(name: &str, color: Vec3) -> Self {
        Self {
            name: name.to_owned(),
            color,
            picture: None,
            has_vertex_colors: false,
            finish: Finish::Highlight {
                specular: 0.0,
                exponent: 50.0,
                reflection: 0.0,
            },
            transmission: 0.0,
            index: 1.5,
            emission: Vec3::ZERO,
            cutout: None,
            normal_map: None,
            emission_map: None,
            facets_map: None,
        }
    }

    /// Its pictures.
    pub(super) fn pictures(&self) -> impl Iterator<Item = &MeshPicture> {
        let with_numbers = [&self.cutout, &self.normal_map].into_iter().flatten();
        let others = with_numbers.map(|(picture, _)| picture);
        let facets = self.facets_map.iter().map(|(picture, _)| picture);
        let own = self.picture.iter().chain(&self.emission_map);
        own.chain(facets).chain(others)
    }

    /// Whether it has a picture.
    pub(super) fn has_pictures(&self) -> bool {
        self.pictures().next().is_some()
    }

    /// Leaves out its pictures, for a surface without texture coordinates.
    pub(super) fn without_pictures(self) -> Self {
        Self {
            picture: None,
            cutout: None,
            normal_map: None,
            emission_map: None,
            facets_map: None,
            ..self
        }
    }
}

/// Without a name: gray.
impl Default for MeshMaterial {
    fn default() -> Self {
        Self::new("none", Vec3::splat(0.8))
    }
}

/// The memory of the pictures of some materials in bytes, of which some may be the same.
pub fn picture_bytes<'a>(materials: impl IntoIterator<Item = &'a MeshMaterial>) -> u64 {
    let pictures = materials.into_iter().flat_map(MeshMaterial::pictures);
    let by_place = pictures.map(|picture| (Arc::as_ptr(&picture.picture), picture));
    let different: HashMap<_, _> = by_place.collect();
    different.values().map(|of| of.picture.n_bytes()).sum()
}

/// Reads the pictures of a mesh file, each once.
pub(super) struct PictureShelf {
    /// Bytes of memory that are left for them.
    available: u64,
    read: HashMap<(PathBuf, Option<Transfer>, [u32; 3]), Arc<Picture>>,
}

impl PictureShelf {
    /// Pictures that take at most this memory in bytes.
    pub(super) fn new(available: u64) -> Self {
        Self {
            available,
            read: HashMap::new(),
        }
    }

    /// The picture of this name, whose colors are multiplied by a `tint`; `bytes` are those
    /// of its file.
    ///
    /// # Errors
    /// A file that cannot be read or is not a picture, in one sentence that names it.
    pub(super) fn picture(
        &mut self,
        name: &Path,
        transfer: Option<Transfer>,
        tint: Vec3,
        bytes: impl FnOnce() -> Result<PictureBytes>,
    ) -> Result<Arc<Picture>> {
        let key = (name.to_owned(), transfer, tint.to_array().map(f32::to_bits));
        if let Some(read) = self.read.get(&key) {
            return Ok(Arc::clone(read));
        }
        let reading = Reading {
            transfer,
            tint,
            available: self.available,
        };
        let read = bytes().and_then(|bytes| read_picture_of(bytes, reading));
        let picture = read.map_err(|fault| of_reference(name, fault))?;
        self.available = self.available.saturating_sub(picture.n_bytes());
        self.read.insert(key, Arc::clone(&picture));
        Ok(picture)
    }
}

/// A fault in a file that another one names, where that one names it.
pub(super) fn of_reference(name: &Path, fault: FileFault) -> FileFault {
    let problem = format!("`{}`: {}", name.display(), fault.problem);
    FileFault::new(problem, fault.expected)
}

/// The path of a file that another one names.
pub(super) fn path_in(folder: &Path, name: &str) -> PathBuf {
    // Files of Windows have its separators.
    folder.join(name.replace('\\', "/"))
}
