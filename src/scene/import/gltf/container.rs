//! The two forms of a glTF file: JSON, or a binary file whose first chunk is JSON.

use gltf_json::Root;
use gltf_json::extensions::ENABLED_EXTENSIONS;
use gltf_json::validation::{Error, Validate};
use memchr::memchr_iter;
use serde::Deserialize;
use serde_json::Value;

use crate::import::budget::Budget;
use crate::import::fault::cut;
use crate::import::{FileFault, FileLocation, Result};

const MAGIC: &[u8] = b"glTF";
/// Length of the header of a binary file, and of the header of a chunk, in bytes.
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
/// Maximum memory per JSON object, and additionally per byte of the JSON.
const OBJECT_BYTES: u64 = 1024;
const BYTES_PER_BYTE: u64 = 32;
/// Maximum length of a JSON path that a message shows.
const MAX_PLACE: usize = 80;

/// Parses a file: the JSON, and the bytes of its first buffer if it is a binary file.
///
/// # Errors
/// The file is damaged, or the JSON does not conform to glTF 2.0.
pub(super) fn parse<'a>(file: &'a [u8], budget: &mut Budget) -> Result<(Root, Option<&'a [u8]>)> {
    let (json, binary) = match file.strip_prefix(MAGIC) {
        Some(_) => chunks(file)?,
        None => (file, None),
    };
    let n_objects = memchr_iter(b'{', json).count() as u64;
    budget.take(n_objects * OBJECT_BYTES + json.len() as u64 * BYTES_PER_BYTE)?;
    check_head(json)?;
    let root: Root = serde_json::from_slice(json).map_err(|error| {
        let line = FileLocation::Line(error.line() as u64);
        let text = error.to_string();
        let (reason, _) = text.rsplit_once(" at line ").unwrap_or((&text, ""));
        let reason: String = reason.chars().take(MAX_PLACE).collect();
        FileFault::new(format!("the JSON is damaged: {reason}"), "glTF 2.0").at(line)
    })?;
    match first_mistake(&root) {
        None => Ok((root, binary)),
        Some(fault) => Err(fault),
    }
}

/// The version and the extensions of a file.
#[derive(Deserialize)]
struct GltfHead {
    asset: GltfAsset,
    #[serde(default, rename = "extensionsRequired")]
    extensions: Vec<String>,
}

#[derive(Deserialize)]
struct GltfAsset {
    /// A text, or a number in old files.
    version: Value,
}

/// Extensions that change the bytes of a file or the light of its surfaces, each with its effect.
const EFFECTS: [(&str, &str); 11] = [
    (
        "KHR_draco_mesh_compression",
        "its meshes are compressed by Draco",
    ),
    (
        "EXT_meshopt_compression",
        "its buffers are compressed by meshoptimizer",
    ),
    (
        "KHR_meshopt_compression",
        "its buffers are compressed by meshoptimizer",
    ),
    ("EXT_texture_webp", "its pictures are WebP files"),
    ("EXT_texture_avif", "its pictures are AVIF files"),
    ("KHR_texture_basisu", "its pictures are KTX files"),
    ("MSFT_texture_dds", "its pictures are DDS files"),
    ("EXT_mesh_gpu_instancing", "its nodes repeat meshes"),
    ("KHR_gaussian_splatting", "it is made of splats"),
    (
        "KHR_materials_pbrSpecularGlossiness",
        "its materials have specular colors and glossiness, not metallicness and roughness",
    ),
    (
        "KHR_materials_unlit",
        "its surfaces show their colors without light",
    ),
];

/// Refuses glTF of another version, and extensions without which a file means something else: their
/// consequences would be reported as mistakes in the rest of the JSON.
fn check_head(json: &[u8]) -> Result<()> {
    // A mistake here is also one in the whole file.
    let Ok(GltfHead { asset, extensions }) = serde_json::from_slice(json) else {
        return Ok(());
    };
    let version = match asset.version {
        Value::String(version) => version,
        other => other.to_string(),
    };
    if version.split('.').next() != Some("2") {
        let problem = format!("it is glTF {}", cut(&version));
        return Err(FileFault::new(problem, "glTF 2.0"));
    }
    let is_known = |name: &str| ENABLED_EXTENSIONS.contains(&name) || name == QUANTIZATION;
    let Some(unknown) = extensions.iter().find(|name| !is_known(name)) else {
        return Ok(());
    };
    let effect = EFFECTS.iter().find(|(name, _)| name == unknown);
    let what = effect.map_or(String::new(), |(_, what)| format!(": {what}"));
    let name: String = unknown.chars().take(MAX_PLACE).collect();
    let problem = format!("it requires the extension `{name}`{what}");
    Err(FileFault::new(
        problem,
        "a file that was exported without it",
    ))
}

/// Returns the JSON and the first buffer of a binary file.
fn chunks(file: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    let number = |at: usize| {
        let bytes = file.get(at..at + 4).and_then(|bytes| bytes.first_chunk());
        bytes.map(|bytes| u32::from_le_bytes(*bytes))
    };
    let (version, length) = (number(4), number(8));
    if version != Some(2) {
        let version = version.map_or("of no version".to_owned(), |version| version.to_string());
        return Err(FileFault::new(format!("it is glTF {version}"), "glTF 2.0"));
    }
    let end = length.unwrap_or_default() as usize;
    let whole = file.get(HEADER..end).ok_or_else(|| {
        let problem = format!("the file has {} bytes", file.len());
        FileFault::new(problem, format!("the {end} of its header"))
    })?;
    let (json, rest) = chunk(whole, b"JSON")?;
    // Chunks of other kinds may follow.
    let binary = rest.get(4..8).filter(|kind| *kind == b"BIN\0");
    let binary = binary.map(|_| chunk(rest, b"BIN\0")).transpose()?;
    Ok((json, binary.map(|(binary, _)| binary)))
}

/// Returns the first chunk, which must be of this kind, and the rest.
fn chunk<'a>(chunks: &'a [u8], kind: &[u8; 4]) -> Result<(&'a [u8], &'a [u8])> {
    let name = String::from_utf8_lossy(&kind[..3]);
    let header = chunks.first_chunk::<CHUNK_HEADER>();
    let header = header.filter(|header| header[4..] == *kind);
    let header = header.ok_or_else(|| {
        let problem = "the binary file does not begin with JSON";
        FileFault::new(problem, format!("a chunk of {name}"))
    })?;
    let [a, b, c, d, ..] = *header;
    let n = u32::from_le_bytes([a, b, c, d]) as usize;
    let behind = &chunks[CHUNK_HEADER..];
    behind.split_at_checked(n).ok_or_else(|| {
        let problem = format!("the chunk `{name}` has {} bytes", behind.len());
        FileFault::new(problem, format!("the {n} of its header"))
    })
}

/// Integer vertex attributes: supported, but unknown to gltf-json.
const QUANTIZATION: &str = "KHR_mesh_quantization";

/// Returns the first index that is out of range, or value that glTF does not define.
fn first_mistake(root: &Root) -> Option<FileFault> {
    let mut first = None;
    // gltf-json looks these up before it has checked them.
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut indices = primitives.flat_map(|primitive| primitive.attributes.values());
    if let Some(wrong) = indices.find(|index| index.value() >= root.accessors.len()) {
        let problem = format!("a mesh has attributes of `accessors[{}]`", wrong.value());
        let expected = format!("one of the {} accessors, from 0", root.accessors.len());
        return Some(FileFault::new(problem, expected));
    }
    root.validate(root, gltf_json::Path::new, &mut |path, error| {
        let (problem, expected) = match error {
            Error::IndexOutOfBounds => ("there is none with this index", "one that there is"),
            Error::Invalid => ("it has no valid value", "one of glTF 2.0"),
            Error::Missing => ("it is missing", "a value"),
            Error::Oversize => ("it is too large", "a smaller number"),
            // Extensions were checked before.
            Error::Unsupported => return,
        };
        first.get_or_insert_with(|| {
            let place: String = path().as_str().chars().take(MAX_PLACE).collect();
            FileFault::new(format!("`{place}`: {problem}"), expected)
        });
    });
    first
}
