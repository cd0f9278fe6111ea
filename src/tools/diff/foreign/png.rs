//! PNG pictures.

use std::io::Cursor;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, ImageError};

use super::source::ForeignSource;
use host::text::Diagnostic;

/// Reads the colors of the pixels; 16-bit channels are rounded to 8 bits.
pub(super) fn read(source: &ForeignSource) -> Result<Vec<[u8; 3]>, Diagnostic> {
    let damaged = |error: ImageError| {
        let problem = format!("the PNG cannot be decoded: {error}");
        source.refuse(problem, "write it again, and close the file")
    };
    let decoder = PngDecoder::new(Cursor::new(&source.bytes)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    source.check_size([width.into(), height.into()])?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    if decoded.color().has_alpha() {
        let rgba = decoded.to_rgba8();
        let transparent = rgba.pixels().position(|pixel| pixel.0[3] != u8::MAX);
        if let Some(pixel) = transparent {
            let help = "write a picture without an alpha channel";
            return Err(source.refuse_pixel(pixel, "is transparent", help));
        }
    }
    let bytes = decoded.into_rgb8().into_raw();
    Ok(bytes.as_chunks().0.to_vec())
}
