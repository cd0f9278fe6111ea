//! Geometry files → checked values.
//!
//! Takes the path of a file; gives a [`Mesh`] or [`Spheres`] whose numbers are
//! finite and whose indices are in range, or a [`FileFault`] that names the
//! line or the element. To add a mesh format, write its file, its `mod` line
//! and its line in `FORMATS`.

mod fault;
mod lines;
mod mesh;
mod obj;
mod ply;
mod spheres;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

pub use fault::{FileFault, Place};
pub use mesh::{Mesh, Normals};
pub use spheres::Spheres;

/// What a reader gives.
pub type Result<T> = std::result::Result<T, FileFault>;

/// An open file on its way through a reader.
type Input = BufReader<File>;

/// Bytes of memory that a reader takes for each byte of its file, at most. A
/// corner of a polygon is one more triangle, and takes two bytes in a text and
/// one in a binary file; a triangle is twelve bytes, of which a growing vector
/// holds up to three times as many.
pub const MAX_BYTES_PER_BYTE: u64 = 36;

/// Reads a file of one format.
type MeshReader = fn(Input) -> Result<Mesh>;

/// The mesh formats by the extension of their files, in lower case.
const FORMATS: &[(&str, MeshReader)] = &[("obj", obj::read), ("ply", ply::read)];

/// Reads a triangle mesh in the format that the extension tells.
///
/// # Errors
/// A file that cannot be read, is of no known format, is damaged, or has no
/// triangle.
pub fn read_mesh(path: &Path) -> Result<Mesh> {
    let extension = extension(path);
    let known = FORMATS.iter().find(|(known, _)| *known == extension);
    let read = || {
        let (_, read) = known.ok_or_else(|| unknown_format(&extension))?;
        let mesh = read(open(path)?)?;
        match mesh.triangles.is_empty() {
            true => Err(FileFault::new("no triangle in the file", "faces")),
            false => Ok(mesh),
        }
    };
    read().map_err(|fault| fault.in_file(path))
}

/// Reads a list of spheres from a table of comma-separated values; `radius` is
/// that of all spheres where the table has no column of radii.
///
/// # Errors
/// A file that cannot be read, is damaged, has no radius or has no sphere.
pub fn read_spheres(path: &Path, radius: Option<f32>) -> Result<Spheres> {
    open(path)
        .and_then(|file| spheres::read(file, radius))
        .map_err(|fault| fault.in_file(path))
}

/// The length of a geometry file in bytes.
///
/// # Errors
/// What is no file, or cannot be asked.
pub fn n_bytes(path: &Path) -> Result<u64> {
    let metadata = std::fs::metadata(path).map_err(FileFault::from);
    let length = metadata.and_then(|metadata| match metadata.is_file() {
        true => Ok(metadata.len()),
        false => Err(FileFault::new("it is no file", "a file")),
    });
    length.map_err(|fault| fault.in_file(path))
}

fn open(path: &Path) -> Result<Input> {
    Ok(BufReader::with_capacity(1 << 18, File::open(path)?))
}

/// The file name's extension in lower case; empty for none.
fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

fn unknown_format(extension: &str) -> FileFault {
    let known: Vec<String> = FORMATS
        .iter()
        .map(|(known, _)| format!(".{known}"))
        .collect();
    let problem = match extension {
        "" => "its name does not tell its format".to_owned(),
        _ => format!("unknown mesh format `.{extension}`"),
    };
    FileFault::new(
        problem,
        format!("a file that ends in {}", known.join(" or ")),
    )
}
