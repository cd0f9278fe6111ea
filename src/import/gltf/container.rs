//! The two forms of a glTF file: JSON, or a binary file whose first chunk is JSON.

use std::collections::BTreeSet;

use gltf_json::Root;
use gltf_json::extensions::ENABLED_EXTENSIONS;
use gltf_json::validation::{Error, Validate};
use memchr::memchr_iter;
use serde::Deserialize;
use serde_json::{Map, Value};

use crate::budget::Budget;
use crate::fault::cut;
use crate::{FileFault, FileLocation, Result};
use base::numbers::counted;

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
    take_memory(json, budget)?;
    check_head(json)?;
    let root = match serde_json::from_slice(json) {
        Ok(root) => root,
        Err(error) => completed(json, budget)?.ok_or_else(|| damaged(&error))?,
    };
    match first_mistake(&root) {
        None => Ok((root, binary)),
        Some(fault) => Err(fault),
    }
}

/// Takes the memory of parsed JSON.
///
/// # Errors
/// Too little is left.
fn take_memory(json: &[u8], budget: &mut Budget) -> Result<()> {
    let n_objects = memchr_iter(b'{', json).count() as u64;
    budget.take(n_objects * OBJECT_BYTES + json.len() as u64 * BYTES_PER_BYTE)
}

/// Creates the fault of JSON that does not conform to glTF.
fn damaged(error: &serde_json::Error) -> FileFault {
    let line = FileLocation::Line(error.line() as u64);
    let text = error.to_string();
    let (reason, _) = text.rsplit_once(" at line ").unwrap_or((&text, ""));
    let reason: String = reason.chars().take(MAX_PLACE).collect();
    FileFault::new(format!("the JSON is damaged: {reason}"), "glTF 2.0").at(line)
}

/// Parses JSON that gltf-json refuses for no reason of glTF: scenes without nodes, whole numbers
/// with a decimal point, and animations and cameras, which are not read. Returns `None` for JSON
/// that has other mistakes.
///
/// # Errors
/// Too little memory is left.
fn completed(json: &[u8], budget: &mut Budget) -> Result<Option<Root>> {
    take_memory(json, budget)?;
    let Ok(mut value) = serde_json::from_slice(json) else {
        return Ok(None);
    };
    make_whole(&mut value);
    if let Some(root) = value.as_object_mut() {
        root.remove("cameras");
    }
    for animation in objects_of(&mut value, "animations") {
        for key in ["channels", "samplers"] {
            animation.insert(key.to_owned(), Value::Array(Vec::new()));
        }
    }
    for scene in objects_of(&mut value, "scenes") {
        scene
            .entry("nodes")
            .or_insert_with(|| Value::Array(Vec::new()));
    }
    for node in objects_of(&mut value, "nodes") {
        node.remove("camera");
    }
    Ok(serde_json::from_value(value).ok())
}

/// Returns the objects of a list of the file.
fn objects_of<'a>(
    root: &'a mut Value,
    key: &str,
) -> impl Iterator<Item = &'a mut Map<String, Value>> {
    let list = root.get_mut(key).and_then(Value::as_array_mut);
    list.into_iter().flatten().filter_map(Value::as_object_mut)
}

/// Writes whole numbers without a decimal point.
fn make_whole(value: &mut Value) {
    match value {
        Value::Number(number) => {
            let found = number
                .as_f64()
                .filter(|found| number.is_f64() && found.fract() == 0.0);
            if let Some(found) = found.filter(|found| found.abs() < MAX_WHOLE) {
                *number = (found as i64).into();
            }
        }
        Value::Array(values) => values.iter_mut().for_each(make_whole),
        Value::Object(values) => values.values_mut().for_each(make_whole),
        _ => {}
    }
}

/// The numbers below it are exact in 64 bits.
const MAX_WHOLE: f64 = (1_u64 << 53) as f64;

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

/// Extensions without which a file has no geometry, each with its effect.
const EFFECTS: [(&str, &str); 4] = [
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
    ("KHR_gaussian_splatting", "it is made of splats"),
];

/// Extensions that are read, but unknown to gltf-json: `KHR_mesh_quantization` allows whole numbers
/// for attributes.
const OWN_EXTENSIONS: [&str; 3] = ["KHR_mesh_quantization", INSTANCING, VISIBILITY];

/// The extension that repeats the mesh of a node.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The extension that hides nodes.
pub(super) const VISIBILITY: &str = "KHR_node_visibility";

/// Maximum number of extensions that a note names.
const MAX_NAMED: usize = 8;

/// Returns the sentence about extensions that are not read.
pub(super) fn unread_extensions(root: &Root) -> Option<String> {
    let is_read = |name: &str| ENABLED_EXTENSIONS.contains(&name) || OWN_EXTENSIONS.contains(&name);
    let named = root.extensions_used.iter().chain(&root.extensions_required);
    let unread: BTreeSet<&String> = named.filter(|name| !is_read(name)).collect();
    let shown = unread.iter().take(MAX_NAMED);
    let shown: Vec<String> = shown.map(|name| format!("`{}`", short(name))).collect();
    let number = counted(unread.len() as u64, "extension");
    let sentence = format!("{number} left out: {}", shown.join(", "));
    (!unread.is_empty()).then_some(sentence)
}

/// Returns the beginning of a name or a place for a message.
fn short(text: &str) -> String {
    text.chars().take(MAX_PLACE).collect()
}

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
    let is_required =
        |(name, _): &&(&str, &str)| extensions.iter().any(|required| required == name);
    let Some((name, what)) = EFFECTS.iter().find(is_required) else {
        return Ok(());
    };
    let problem = format!("it requires the extension `{name}`: {what}");
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
    let name = String::from_utf8_lossy(kind);
    let name = name.trim_end_matches('\0');
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
        let place = path();
        if first.is_none() && matters(place.as_str(), error) {
            let problem = format!("`{}`: {problem}", short(place.as_str()));
            first = Some(FileFault::new(problem, expected));
        }
    });
    first
}

/// Returns true if a mistake changes what is read, or may panic where it is looked up; a mistake of
/// an accessor is refused where it is used.
fn matters(place: &str, error: Error) -> bool {
    let is_unread = place.starts_with("animations[") || place.starts_with("cameras[");
    match error {
        _ if is_unread => false,
        // gltf-json checks bounds of positions, which are not read.
        Error::Missing if place.contains("attributes[\"POSITION\"]") => false,
        Error::Missing => !(place.starts_with("accessors[") && place.ends_with("].bufferView")),
        Error::Invalid => place.contains(".sparse.") || place.ends_with(".mode"),
        _ => true,
    }
}
