//! `raycost render SCENE -o picture.png`: the file of the picture.

use std::path::PathBuf;
use std::str::FromStr;

use crate::cli::scene::PictureFormat;

/// A file to which a picture is written.
#[derive(Debug, Clone)]
pub(super) struct PictureFile {
    pub(super) path: PathBuf,
    /// Chosen by the file's extension.
    pub(super) format: PictureFormat,
}

impl FromStr for PictureFile {
    type Err = &'static str;

    fn from_str(path: &str) -> Result<Self, Self::Err> {
        let path = PathBuf::from(path);
        let extension = path.extension().unwrap_or_default();
        let format = match extension.to_ascii_lowercase().to_str() {
            Some("png") => PictureFormat::Png,
            Some("exr") => PictureFormat::Exr,
            _ => return Err("expected a name that ends in .png or .exr"),
        };
        Ok(Self { path, format })
    }
}
