//! The materials of mesh files, and the pictures that they name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;

use super::fault::READABLE;
use super::picture::{PictureBytes, read_picture_of};
use super::{FileFault, Result};
use world::color::Transfer;
use world::picture::{Picture, Sampling};

/// Maximum number of materials of a file.
pub(super) const MAX_MATERIALS: usize = 4096;

/// A material of a mesh file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshMaterial {
    /// The name in the file, or a generated one.
    pub name: String,
    /// The color: linear light, each channel from 0 to 1. Unused if there is a picture, whose
    /// tint it is.
    pub color: Vec3,
    /// The picture that gives the color.
    pub picture: Option<MeshPicture>,
    /// True if the mesh's vertex colors give the color, multiplied by the picture's.
    pub has_vertex_colors: bool,
    /// The scattering of light apart from its color.
    pub finish: Finish,
    /// The share of light that is transmitted through the surface, 0 to 1.
    pub transmission: f32,
    /// True if the surface shows its color without light.
    pub is_unlit: bool,
    /// The index of refraction of the inside, 1 to 10.
    pub index: f32,
    /// The radiance that the surface emits.
    pub emission: Vec3,
    /// The share of light that the surface meets; `None` for all.
    pub opacity: Option<MeshOpacity>,
    /// The picture of normals, and the factor of the slopes of its bumps.
    pub normal_map: Option<(MeshPicture, f32)>,
    /// The picture that multiplies `emission`.
    pub emission_map: Option<MeshPicture>,
    /// The picture of roughness, in green, and metallicness, in blue, and the factors of both; the
    /// finish has their means.
    pub facets_map: Option<(MeshPicture, [f32; 2])>,
    /// Statements that programs write with different meanings, each with the one it is given.
    pub doubts: Vec<&'static str>,
}

/// The opacity of a surface; that of its vertices multiplies it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshOpacity {
    /// The factor, 0 to 1.
    pub factor: f32,
    /// The picture whose opacity multiplies it.
    pub picture: Option<MeshPicture>,
    /// The least opacity of a surface with holes, which is opaque around them.
    pub threshold: Option<f32>,
}

impl MeshOpacity {
    /// Returns true if the surface meets all light, unless its vertices have opacities.
    pub(super) fn is_full(&self) -> bool {
        self.factor >= 1.0 && self.picture.is_none()
    }
}

/// The scattering of light by a surface, apart from its color.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finish {
    /// Diffusely, with a highlight.
    Highlight {
        /// Strength, 0 to 1.
        specular: f32,
        /// Exponent, at least 0.
        exponent: f32,
        /// The fraction of light that is mirrored, 0 to 1.
        reflection: f32,
    },
    /// By microscopic facets.
    Facets {
        /// The share of metal, 0 to 1.
        metallic: f32,
        /// The roughness, 0 to 1.
        roughness: f32,
    },
}

/// A picture of a mesh file's material, placed by texture coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPicture {
    /// The file, or its name in the mesh file.
    pub name: PathBuf,
    /// The picture.
    pub picture: Arc<Picture>,
    /// The factor of the picture's linear light, each channel from 0 to 1.
    pub tint: Vec3,
    /// The filtering of lookups.
    pub sampling: Sampling,
    /// Width and height in texture coordinates, negative for a mirrored picture.
    pub size: [f32; 2],
    /// The coordinates of the picture at texture coordinates of 0.
    pub offset: [f32; 2],
}

impl MeshPicture {
    /// Creates a picture that fills the texture coordinates from 0 to 1.
    pub(super) fn new(name: PathBuf, picture: Arc<Picture>) -> Self {
        Self {
            name,
            picture,
            tint: Vec3::ONE,
            sampling: Sampling::default(),
            size: [1.0; 2],
            offset: [0.0; 2],
        }
    }
}

impl MeshMaterial {
    /// Creates a matte surface.
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
            is_unlit: false,
            index: 1.5,
            emission: Vec3::ZERO,
            opacity: None,
            normal_map: None,
            emission_map: None,
            facets_map: None,
            doubts: Vec::new(),
        }
    }

    /// Returns the pictures.
    pub(super) fn pictures(&self) -> impl Iterator<Item = &MeshPicture> {
        let opacity = self.opacity.iter().flat_map(|of| &of.picture);
        let normals = self.normal_map.iter().map(|(picture, _)| picture);
        let facets = self.facets_map.iter().map(|(picture, _)| picture);
        let own = self.picture.iter().chain(&self.emission_map);
        own.chain(facets).chain(opacity).chain(normals)
    }

    /// Returns true if it has a picture.
    pub(super) fn has_pictures(&self) -> bool {
        self.pictures().next().is_some()
    }

    /// Removes the pictures, for a surface without texture coordinates.
    pub(super) fn without_pictures(self) -> Self {
        Self {
            picture: None,
            opacity: self.opacity.map(|of| MeshOpacity {
                picture: None,
                ..of
            }),
            normal_map: None,
            emission_map: None,
            facets_map: None,
            ..self
        }
    }
}

/// An unnamed gray material.
impl Default for MeshMaterial {
    fn default() -> Self {
        Self::new("none", Vec3::splat(0.8))
    }
}

/// Returns the memory of the pictures of some materials in bytes; shared pictures count once.
pub fn picture_bytes<'a>(materials: impl IntoIterator<Item = &'a MeshMaterial>) -> u64 {
    let pictures = materials.into_iter().flat_map(MeshMaterial::pictures);
    let by_place = pictures.map(|picture| (Arc::as_ptr(&picture.picture), picture));
    let different: HashMap<_, _> = by_place.collect();
    different.values().map(|of| of.picture.n_bytes()).sum()
}

/// Reads the pictures of a mesh file, each once.
pub(super) struct PictureShelf {
    /// Bytes of memory left for pictures.
    available: u64,
    read: HashMap<(PathBuf, Option<Transfer>), Arc<Picture>>,
    /// Sentences about pictures that cannot be read.
    pub(super) notes: Vec<String>,
}

impl PictureShelf {
    /// Creates a shelf for pictures that take at most this memory in bytes.
    pub(super) fn new(available: u64) -> Self {
        Self {
            available,
            read: HashMap::new(),
            notes: Vec::new(),
        }
    }

    /// Returns the picture of this name; `bytes` are the contents of its file.
    ///
    /// # Errors
    /// The file cannot be read or is not a picture; one sentence names it.
    pub(super) fn picture(
        &mut self,
        name: &Path,
        transfer: Option<Transfer>,
        bytes: impl FnOnce() -> Result<PictureBytes>,
    ) -> Result<Arc<Picture>> {
        let key = (name.to_owned(), transfer);
        if let Some(read) = self.read.get(&key) {
            return Ok(Arc::clone(read));
        }
        let read = bytes().and_then(|bytes| read_picture_of(bytes, transfer, self.available));
        let picture = read.map_err(|fault| of_reference(name, fault))?;
        self.available = self.available.saturating_sub(picture.n_bytes());
        self.read.insert(key, Arc::clone(&picture));
        Ok(picture)
    }

    /// Returns a picture as [`picture`](Self::picture) does; `None` and a note if it cannot be read.
    pub(super) fn picture_or_note(
        &mut self,
        name: &Path,
        transfer: Option<Transfer>,
        bytes: impl FnOnce() -> Result<PictureBytes>,
    ) -> Option<Arc<Picture>> {
        let read = self.picture(name, transfer, bytes);
        let read = read.map_err(|fault| {
            let note = missing_note(&fault);
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        });
        read.ok()
    }
}

/// Returns a note on a file that a mesh names and that cannot be read.
pub(super) fn missing_note(fault: &FileFault) -> String {
    match &*fault.expected {
        READABLE => format!("shown without {}", fault.problem),
        expected => format!("shown without {}, expected {expected}", fault.problem),
    }
}

/// Moves a fault in a referenced file to the place of the reference.
pub(super) fn of_reference(name: &Path, fault: FileFault) -> FileFault {
    let problem = format!("`{}`: {}", name.display(), fault.problem);
    FileFault::new(problem, fault.expected)
}

/// Returns the path of a file that another file names: in any case of its letters, or else in the
/// folder itself.
pub(super) fn path_in(folder: &Path, name: &str) -> PathBuf {
    // Files from Windows use its separators, and its names may differ in case.
    let name = name.replace('\\', "/");
    let path = folder.join(&name);
    if path.is_file() {
        return path;
    }
    let last = name.rsplit('/').next().unwrap_or_default();
    let known = in_any_case(folder, &name).or_else(|| in_any_case(folder, last));
    known.unwrap_or(path)
}

/// Returns the path of a file whose name may differ in case; `None` if there is none.
fn in_any_case(folder: &Path, name: &str) -> Option<PathBuf> {
    let mut found = folder.to_owned();
    for step in Path::new(name).components() {
        let step = step.as_os_str();
        if found.join(step).exists() {
            found.push(step);
            continue;
        }
        let names = Path::new(".")
            .join(&found)
            .read_dir()
            .ok()?
            .flatten()
            .map(|entry| entry.file_name());
        let wanted = step.to_string_lossy().to_lowercase();
        let same = names.filter(|name| name.to_string_lossy().to_lowercase() == wanted);
        found.push(same.min()?);
    }
    found.is_file().then_some(found)
}
