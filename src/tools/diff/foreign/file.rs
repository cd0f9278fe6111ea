//! A picture or a cost map of another program.

use std::path::{Path, PathBuf};

use super::source::{ForeignNumbers, ForeignSource};
use super::{exr, netpbm, npy, png};
use host::text::Diagnostic;

/// A file of another program.
#[derive(Debug)]
pub struct ForeignFile {
    /// The path as the user typed it.
    pub path: PathBuf,
    /// The pixels.
    pub content: ForeignContent,
}

/// The content of a file, row-major, row 0 on top.
#[derive(Debug)]
pub enum ForeignContent {
    /// Colors of 8 bits.
    Colors(Vec<[u8; 3]>),
    /// Linear light, three finite channels of each pixel.
    Light(Vec<f32>),
    /// The cost of each pixel in an unknown unit: at least 0, with a finite sum above 0.
    Cost(Vec<f64>),
}

impl ForeignFile {
    /// Reads a file whose picture must have this size.
    ///
    /// # Errors
    /// The file cannot be read, has an unknown format or another size, or is damaged.
    pub fn read(path: &Path, size: [u32; 2]) -> Result<Self, Diagnostic> {
        let source = ForeignSource::read(path, size)?;
        let content = match &source.bytes[..] {
            [0x89, b'P', b'N', b'G', ..] => ForeignContent::Colors(png::read(&source)?),
            [b'P', b'3' | b'6', ..] => ForeignContent::Colors(netpbm::colors(&source)?),
            [b'P', b'F' | b'f', ..] => content(&source, netpbm::numbers(&source)?)?,
            bytes if bytes.starts_with(exr::SIGNATURE) => content(&source, exr::read(&source)?)?,
            bytes if bytes.starts_with(npy::SIGNATURE) => {
                let (numbers, are_bytes) = npy::read(&source)?;
                if are_bytes && numbers.n_channels == 3 {
                    let values = numbers.values.iter();
                    let bytes: Vec<u8> = values.map(|&value| value as u8).collect();
                    ForeignContent::Colors(bytes.as_chunks().0.to_vec())
                } else {
                    content(&source, numbers)?
                }
            }
            _ => {
                let problem = "it is not a picture or a cost map of a known format";
                let help = "give a folder that `raycost render` wrote, or a PNG, PPM, PFM, \
                            OpenEXR or NPY file";
                return Err(source.refuse(problem, help));
            }
        };
        Ok(Self {
            path: path.to_owned(),
            content,
        })
    }

    /// Returns the name of the file without its extension.
    pub fn label(&self) -> String {
        let name = self.path.file_stem().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// Returns the file and its content, as one line.
    pub(super) fn sentence(&self) -> String {
        let content = match self.content {
            ForeignContent::Colors(_) => "a picture of 8-bit colors",
            ForeignContent::Light(_) => "a picture of linear light",
            ForeignContent::Cost(_) => "a cost map",
        };
        format!("{}: {content}, of another program", self.path.display())
    }
}

/// Checks numbers that are not bytes of colors.
fn content(source: &ForeignSource, numbers: ForeignNumbers) -> Result<ForeignContent, Diagnostic> {
    let ForeignNumbers { n_channels, values } = numbers;
    let is_cost = n_channels == 1;
    // Light is compared in 32 bits.
    let greatest = if is_cost { f64::MAX } else { f32::MAX.into() };
    let is_finite = |value: f64| value.abs() <= greatest;
    if let Some(at) = values.iter().position(|&value| !is_finite(value)) {
        let what = "is not a finite number";
        return Err(source.refuse_pixel(at / n_channels, what, "write a finite number"));
    }
    if !is_cost {
        let light = values.into_iter().map(|value| value as f32);
        return Ok(ForeignContent::Light(light.collect()));
    }
    if let Some(pixel) = values.iter().position(|&cost| cost < 0.0) {
        let what = "has a negative cost";
        return Err(source.refuse_pixel(pixel, what, "write costs of at least 0"));
    }
    let total: f64 = values.iter().sum();
    if total == 0.0 || !total.is_finite() {
        let problem = format!("its costs add up to {total}");
        return Err(source.refuse(problem, "write the time or the work of each pixel"));
    }
    Ok(ForeignContent::Cost(values))
}
