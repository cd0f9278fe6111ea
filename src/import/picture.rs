//! Picture files: PNG, JPEG, Radiance HDR and OpenEXR.
//!
//! The first bytes of the file determine its format, not its name. Nothing is allocated by the size
//! in its header before that is known to fit into memory.

use std::error::Error;
use std::io::{self, BufRead, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use image::codecs::hdr::HdrDecoder;
use image::{
    ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, ImageResult,
};

use super::gray_exr::{GrayExr, gray_header};
use super::{FileFault, Result, length_of, open};
use base::numbers::memory_sizes;
use world::color::Transfer;
use world::picture::{Picture, Texels};

/// Reads a picture, to be shared by materials. Its numbers are decoded by `transfer`; by default
/// sRGB in PNG and JPEG files, and linear in others.
///
/// # Errors
/// The file cannot be read, has an unknown format, is damaged, is too large for `available` bytes
/// of memory, or has a color that is not finite.
pub fn read_picture(
    path: &Path,
    transfer: Option<Transfer>,
    available: u64,
) -> Result<Arc<Picture>> {
    let read = bytes_of_file(path).and_then(|bytes| read_picture_of(bytes, transfer, available));
    read.map_err(|fault| fault.in_file(path))
}

/// The bytes of a picture's file.
pub(super) type PictureBytes = Box<dyn SeekableBytes>;

/// The bytes of a file, or of a part of one.
pub(super) trait SeekableBytes: BufRead + Seek {}

impl<T: BufRead + Seek> SeekableBytes for T {}

/// Opens the file of a picture.
///
/// # Errors
/// The file cannot be opened, or is not a regular file.
pub(super) fn bytes_of_file(path: &Path) -> Result<PictureBytes> {
    length_of(path)?;
    Ok(Box::new(open(path)?))
}

/// Reads a picture from the bytes of its file.
///
/// # Errors
/// As [`read_picture`].
pub(super) fn read_picture_of(
    mut file: PictureBytes,
    transfer: Option<Transfer>,
    available: u64,
) -> Result<Arc<Picture>> {
    let mut head = Vec::new();
    let start = file.fill_buf()?;
    head.extend_from_slice(&start[..start.len().min(MAX_SIGNATURE)]);
    file.seek(SeekFrom::Start(0))?;
    let is_of = |format: &&Format| head.starts_with(format.signature);
    let format = FORMATS.iter().find(is_of);
    let format = format.ok_or_else(|| unknown_format(&head))?;
    let damaged = |error| format.damaged(&error);
    let decoder = format.decoder(file).map_err(damaged)?;
    check_size(&decoder, available)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    let size = [decoded.width(), decoded.height()];
    let texels = decode_texels(decoded, transfer.unwrap_or(format.transfer))?;
    let picture = Picture::new(size, texels).ok_or_else(|| wrong_size(size))?;
    Ok(Arc::new(picture))
}

/// A format of pictures.
struct Format {
    name: &'static str,
    /// The first bytes of its files.
    signature: &'static [u8],
    /// The default transfer function.
    transfer: Transfer,
    kind: ImageFormat,
}

const FORMATS: [Format; 5] = [
    Format::new(
        "PNG",
        b"\x89PNG\r\n\x1a\n",
        Transfer::Srgb,
        ImageFormat::Png,
    ),
    Format::new("JPEG", b"\xff\xd8\xff", Transfer::Srgb, ImageFormat::Jpeg),
    Format::new(
        "OpenEXR",
        b"\x76\x2f\x31\x01",
        Transfer::Linear,
        ImageFormat::OpenExr,
    ),
    Format::new(
        "Radiance HDR",
        b"#?RADIANCE",
        Transfer::Linear,
        ImageFormat::Hdr,
    ),
    Format::new(
        "Radiance HDR",
        b"#?RGBE",
        Transfer::Linear,
        ImageFormat::Hdr,
    ),
];

/// Formats that are not read, with the first bytes of their files.
const UNREAD: [(&str, &[u8]); 8] = [
    ("BMP", b"BM"),
    ("DDS", b"DDS "),
    ("GIF", b"GIF8"),
    ("KTX", b"\xabKTX"),
    ("Photoshop", b"8BPS"),
    ("TIFF", b"II*\0"),
    ("TIFF", b"MM\0*"),
    ("WebP", b"RIFF"),
];

/// Length of the longest signature in bytes: the header of TGA, which has none.
const MAX_SIGNATURE: usize = 18;

/// Upper bound of the memory to read one-byte channels, in bytes per channel of a texel: the
/// decoded byte and the smaller copies, two of which are temporarily 32-bit numbers.
const BYTES_PER_CHANNEL: u64 = 4;

/// Upper bound of the memory to read a texel of larger channels, in bytes.
const BYTES_PER_LARGE_TEXEL: u64 = 56;

/// Checks that the picture is not too large, according to its header.
fn check_size(decoder: &dyn ImageDecoder, available: u64) -> Result<()> {
    let (width, height) = decoder.dimensions();
    let most = Picture::MAX_SIDE;
    if [width, height]
        .iter()
        .any(|side| !(1..=most).contains(side))
    {
        return Err(wrong_size([width, height]));
    }
    let per_texel = match decoder.color_type() {
        ColorType::L8 => BYTES_PER_CHANNEL,
        ColorType::Rgb8 => 3 * BYTES_PER_CHANNEL,
        ColorType::La8 | ColorType::Rgba8 => 4 * BYTES_PER_CHANNEL,
        _ => BYTES_PER_LARGE_TEXEL,
    };
    let needed = u64::from(width) * u64::from(height) * per_texel;
    if needed <= available {
        return Ok(());
    }
    let [needed, free] = memory_sizes([needed, available]);
    let problem = format!(
        "{width} x {height} pixels are too many: up to {needed} of memory are needed to read \
         them, {free} are free"
    );
    Err(FileFault::new(problem, "a smaller picture"))
}

fn decode_texels(decoded: DynamicImage, transfer: Transfer) -> Result<Texels> {
    match decoded.color() {
        ColorType::L8 => Ok(Texels::Gray(decoded.into_luma8().into_raw(), transfer)),
        ColorType::Rgb8 => {
            let bytes = decoded.into_rgb8().into_raw();
            Ok(Texels::Rgb(bytes.as_chunks().0.to_vec(), transfer))
        }
        ColorType::La8 | ColorType::Rgba8 => {
            let bytes = decoded.into_rgba8().into_raw();
            Ok(Texels::Bytes(bytes.as_chunks().0.to_vec(), transfer))
        }
        _ => {
            let width = decoded.width();
            let numbers = decoded.into_rgba32f().into_raw();
            let mut texels = numbers.as_chunks().0.to_vec();
            for (i, texel) in (0..).zip(&mut texels) {
                decode(texel, transfer).ok_or_else(|| not_finite(i % width, i / width))?;
            }
            Ok(Texels::Floats(texels))
        }
    }
}

/// Decodes a texel's numbers to linear light; `None` if one is not finite.
fn decode(texel: &mut [f32; 4], transfer: Transfer) -> Option<()> {
    if texel.iter().any(|number| !number.is_finite()) {
        return None;
    }
    let [colors @ .., opacity] = texel;
    for number in colors {
        // No surface reflects less than nothing.
        *number = transfer.light(number.max(0.0));
    }
    *opacity = opacity.clamp(0.0, 1.0);
    Some(())
}

fn not_finite(column: u32, row: u32) -> FileFault {
    let problem =
        format!("the pixel in column {column}, row {row} has a number that is not finite");
    FileFault::new(problem, "finite numbers")
}

fn wrong_size([width, height]: [u32; 2]) -> FileFault {
    let most = Picture::MAX_SIDE;
    FileFault::new(
        format!("it has {width} x {height} pixels"),
        format!("1 to {most} in each direction"),
    )
}

/// Creates the fault of a file that begins with these bytes.
fn unknown_format(head: &[u8]) -> FileFault {
    let expected = "a PNG, JPEG, Radiance HDR or OpenEXR picture";
    let unread = UNREAD
        .iter()
        .find(|(_, signature)| head.starts_with(signature));
    let name = unread.map(|(name, _)| *name);
    match name.or_else(|| is_tga(head).then_some("TGA")) {
        None => FileFault::new("it is not a picture of a known format", expected),
        Some(name) => FileFault::new(
            format!("raycost does not read {name} pictures"),
            format!("{expected}: ImageMagick's `magick FILE FILE.png` converts it"),
        ),
    }
}

/// Returns true if a file begins as TGA does: the kind of its color map, its own kind, and its bits
/// per pixel are known ones.
fn is_tga(head: &[u8]) -> bool {
    match head {
        [_, 0 | 1, 1..=3 | 9..=11, .., 8 | 15 | 16 | 24 | 32, _] => head.len() == MAX_SIGNATURE,
        _ => false,
    }
}

impl Format {
    /// Returns the decoder of a picture, whose size is not checked yet.
    fn decoder(&self, mut file: PictureBytes) -> ImageResult<Box<dyn ImageDecoder>> {
        if self.signature == b"#?RGBE" {
            // The strict decoder knows one of the two signatures.
            return Ok(Box::new(HdrDecoder::new_nonstrict(file)?));
        }
        if self.kind == ImageFormat::OpenExr {
            let header = gray_header(&mut file);
            file.seek(SeekFrom::Start(0))?;
            if let Some(header) = header {
                return Ok(Box::new(GrayExr { file, header }));
            }
        }
        let mut reader = ImageReader::with_format(file, self.kind);
        reader.no_limits();
        Ok(Box::new(reader.into_decoder()?))
    }

    const fn new(
        name: &'static str,
        signature: &'static [u8],
        transfer: Transfer,
        kind: ImageFormat,
    ) -> Self {
        Self {
            name,
            signature,
            transfer,
            kind,
        }
    }

    fn damaged(&self, error: &ImageError) -> FileFault {
        let name = self.name;
        match error {
            ImageError::IoError(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                FileFault::new(format!("the {name} picture ends early"), "a whole file")
            }
            ImageError::IoError(error) => FileFault::new(
                format!("cannot read it: {error}"),
                "a file that can be read",
            ),
            other => {
                // The source error has the decoder's message.
                let reason = other
                    .source()
                    .map_or(other.to_string(), |own| own.to_string());
                if reason.contains("subsampling") {
                    let problem = "its channels have different resolutions, as luminance and \
                                   chroma (`Y`, `RY`, `BY`) often do";
                    return FileFault::new(problem, "the channels `R`, `G` and `B`");
                }
                FileFault::new(
                    format!("the {name} picture cannot be decoded: {}", reason.trim()),
                    "a picture that other programs show",
                )
            }
        }
    }
}
