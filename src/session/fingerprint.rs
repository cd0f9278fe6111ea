//! The fingerprint of a frame: equal where its files would be equal.

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use super::Session;
use host::folder::checksum_of;
use host::provenance::{Checksum, Hasher};
use output::summary::{Build, FrameSection};
use render::checkpoint::{Header, PicturePart, RecordLayout};
use render::film;
use render::tiles::least_repeats;
use scene::build::SceneFrame;
use scene::config::{
    Acceleration, Config, CostMode, Geometry, Outputs, RatioMetrics, Repeats, Tiling,
};

use super::this_build;
use host::text::Diagnostic;
use scene::yaml::{Document, FieldPath, Folders};
use vtk::Codec;
use world::background::Background;

impl Session {
    /// Returns a hash of the contents of the scene and of its files.
    ///
    /// # Errors
    /// If a file of the scene cannot be read.
    pub(crate) fn contents(&self) -> Result<Checksum, Diagnostic> {
        let (document, config) = (&self.document, &self.config);
        hash_pixels(config, None, None, files(document, config))
    }

    /// Returns a hash of all that determines the picture, without the settings that change only the
    /// work for it and its files.
    ///
    /// # Errors
    /// If a file of the scene cannot be read.
    pub(crate) fn picture(&self) -> Result<Checksum, Diagnostic> {
        let config = Config {
            animation: None,
            acceleration: Acceleration::default(),
            cost: CostMode::default(),
            metrics: RatioMetrics::default(),
            repeats: Repeats::default(),
            tiles: Tiling::default(),
            output: Outputs::default(),
            compress: Codec::default(),
            ..self.config.filled()
        };
        hash_pixels(&config, None, None, files(&self.document, &config))
    }

    /// Returns the header that identifies finished tiles of this scene, rendered by this program.
    /// `flags` are the flags of the command line that change its settings.
    ///
    /// # Errors
    /// If a file of the scene cannot be read.
    pub(crate) fn header(
        &self,
        flags: Vec<String>,
        part: Option<PicturePart>,
    ) -> Result<Header, Diagnostic> {
        let (document, config) = (&self.document, &self.config);
        let frame = self.frame.as_ref();
        let frame_time = frame.map(|frame| (frame.number, frame.time));
        let base = self.base_contents.get().copied();
        let Build {
            version, commit, ..
        } = this_build();
        let folder = std::env::current_dir().unwrap_or_default();
        let n_bytes = film::stored_bytes_per_pixel(config.cost, config.extra_arrays());
        Ok(Header {
            raycost: version,
            commit,
            byte_order: Header::BYTE_ORDER.to_owned(),
            scene: self.scene_file().to_owned(),
            flags,
            folder: folder.to_string_lossy().into_owned(),
            frame: frame.map(|frame| frame.number),
            fingerprint: hash_pixels(config, frame_time, base, files(document, config))?,
            part,
            layout: RecordLayout {
                width: config.image.width,
                height: config.image.height,
                tile_size: config.tiles.size,
                n_renderings: least_repeats(config),
                cost: config.cost,
                bytes_per_pixel: n_bytes as u32,
            },
        })
    }
}

/// Returns the section of a frame in its summary. `flags` are the flags that change its files,
/// besides flags that change the config.
pub(super) fn section_of(
    document: &Document,
    config: &Config,
    frame: SceneFrame,
    flags: &str,
) -> FrameSection {
    let SceneFrame {
        number,
        n_frames,
        time,
    } = frame;
    let Build {
        version, commit, ..
    } = this_build();
    let settings: Vec<&str> = document.settings().collect();
    let scene = (document.name(), settings, config, config.image.window);
    let mut hasher = Hasher::default();
    hasher.add_value(&(version, commit, flags, scene, number, time));
    let states = states_of(files(document, config));
    hasher.add(&states.bits().to_le_bytes());
    FrameSection {
        number,
        n_frames,
        time,
        fingerprint: hasher.checksum(),
        states: serde_json::Value::Null,
    }
}

/// Returns a hash of all that determines the pixels of a scene, except for the program: the config,
/// the time of a frame, the frame whose hierarchy may be refitted, and the contents of these files.
/// Files and scene may be elsewhere on another machine.
///
/// # Errors
/// If a file cannot be read.
fn hash_pixels(
    config: &Config,
    frame: Option<(u32, f64)>,
    base: Option<Checksum>,
    files: impl Iterator<Item = PathBuf>,
) -> Result<Checksum, Diagnostic> {
    let mut hasher = Hasher::default();
    hasher.add_value(&(config, config.image.window, frame, base));
    hasher.add(&contents_of(files)?.bits().to_le_bytes());
    Ok(hasher.checksum())
}

/// Returns a hash of the contents of files.
///
/// # Errors
/// If a file cannot be read.
pub(crate) fn contents_of(
    files: impl Iterator<Item = impl AsRef<Path>>,
) -> Result<Checksum, Diagnostic> {
    let mut hasher = Hasher::default();
    for file in files {
        let file = file.as_ref();
        // Not a regular file: skipped; the scene's own files were read earlier.
        if file.is_file() {
            let sum = checksum_of(file).map_err(|error| {
                let shown = file.display();
                Diagnostic::new(format!("cannot read `{shown}`: {error}"))
            })?;
            hasher.add(&sum.bits().to_le_bytes());
        }
    }
    Ok(hasher.checksum())
}

/// Returns a hash of the lengths and modification times of files.
pub(crate) fn states_of(files: impl Iterator<Item = impl AsRef<Path>>) -> Checksum {
    let mut hasher = Hasher::default();
    for file in files {
        let (path, length, changed) = state_of(file.as_ref());
        hasher.add(path.as_os_str().as_encoded_bytes());
        hasher.add(&length.to_le_bytes());
        hasher.add(&changed.to_le_bytes());
    }
    hasher.checksum()
}

/// Returns all files that determine the picture of a scene: its text, the files that it includes,
/// and the files that the config names.
pub(crate) fn scene_files(document: &Document, config: &Config) -> impl Iterator<Item = PathBuf> {
    let texts: Vec<PathBuf> = document.files().map(PathBuf::from).collect();
    texts.into_iter().chain(files(document, config))
}

/// Returns the path of a file, its length, and its modification time.
fn state_of(file: &Path) -> (&Path, u64, u128) {
    let Ok(metadata) = file.metadata() else {
        return (file, 0, 0);
    };
    let changed = metadata.modified().ok();
    let since = changed.and_then(|changed| changed.duration_since(UNIX_EPOCH).ok());
    (file, metadata.len(), since.unwrap_or_default().as_nanos())
}

/// Returns a hash of all that determines the primitives of the scene and the acceleration structure
/// over them.
pub(super) fn hash_geometry(document: &Document, config: &Config) -> Checksum {
    let materials: Vec<&String> = config.materials.keys().collect();
    let mut hasher = Hasher::default();
    hasher.add_value(&(&config.objects, materials, config.acceleration));
    let states = states_of(geometry_files(document, config).into_iter());
    hasher.add(&states.bits().to_le_bytes());
    hasher.checksum()
}

/// Returns all files that the config names.
fn files(document: &Document, config: &Config) -> impl Iterator<Item = PathBuf> {
    let pictures = picture_files(document, config).into_iter();
    pictures.chain(geometry_files(document, config))
}

/// Returns the files of textures that the config names.
fn picture_files(document: &Document, config: &Config) -> Vec<PathBuf> {
    let root = FieldPath::default;
    let mut found = Vec::new();
    for (name, material) in &config.materials {
        let folder = document.folder_of(&root().key("materials").key(name));
        found.extend(material.images().map(|(_, image)| folder.join(&image.file)));
    }
    if let Background::EnvironmentMap(map) = &config.background {
        let folder = document.folder_of(&root().key("background"));
        found.push(folder.join(&map.file));
    }
    found
}

/// Returns the files of objects that the config names, with the pieces of data sets.
fn geometry_files(document: &Document, config: &Config) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for file in named_files(document, config) {
        found.extend(import::pieces_of(&file));
        found.push(file);
    }
    found
}

/// Returns the files of objects that the config names.
fn named_files(document: &Document, config: &Config) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for (index, object) in config.objects.iter().enumerate() {
        let path = FieldPath::default().key("objects").index(index);
        let path = path.key(object.geometry.to_string());
        let mut named = Vec::new();
        match &object.geometry {
            Geometry::File(file) => named.push((path.key("file"), file.file())),
            Geometry::Instances(placed) => {
                let of_mesh = path.clone().key("mesh").key("file");
                named.push((of_mesh, &*placed.mesh.file));
                let points = placed.points_file();
                named.extend(points.map(|file| (path.key("points").key("file"), file)));
            }
            Geometry::Shape(_) | Geometry::Generator(_) | Geometry::Tube(_) => {}
        }
        let in_folder = |(path, file): (FieldPath, &Path)| document.folder_of(&path).join(file);
        found.extend(named.into_iter().map(in_folder));
    }
    found
}
