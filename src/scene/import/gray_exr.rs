//! Gray OpenEXR pictures, which have a luminance in place of colors.

use std::io::{BufRead, Seek};

use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Text, Vec2};
use image::error::{DecodingError, ImageFormatHint};
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageResult};

/// Errors in parts that are not read are not reported.
const IS_STRICT: bool = false;

/// The decoder of a gray picture.
pub(super) struct GrayExr<R> {
    /// The file, at its start.
    pub(super) file: R,
    pub(super) header: Header,
}

/// Returns the header of the first gray part of a file; `None` if there are colors, or none can be
/// read.
pub(super) fn gray_header(file: &mut (impl BufRead + Seek)) -> Option<Header> {
    let parts = MetaData::read_from_buffered(file, IS_STRICT).ok()?.headers;
    let has = |part: &Header, channel: &str| {
        let found = part.channels.find_index_of_channel(&Text::from(channel));
        !part.deep && found.is_some()
    };
    let has_colors = |part: &Header| ["R", "G", "B"].iter().all(|channel| has(part, channel));
    if parts.iter().any(has_colors) {
        return None;
    }
    parts.into_iter().find(|part| has(part, "Y"))
}

impl<R: BufRead + Seek> ImageDecoder for GrayExr<R> {
    fn dimensions(&self) -> (u32, u32) {
        let Vec2(width, height) = self.header.shared_attributes.display_window.size;
        (width as u32, height as u32)
    }

    fn color_type(&self) -> ColorType {
        ColorType::Rgba32F
    }

    fn read_image(self, bytes: &mut [u8]) -> ImageResult<()> {
        let window = self.header.shared_attributes.display_window;
        let first = self.header.own_attributes.layer_position - window.position;
        let Vec2(width, height) = window.size;
        let read = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .specific_channels()
            .required("Y")
            .optional("A", 1.0_f32)
            .collect_pixels(
                move |_, _| vec![[0.0_f32; 4]; width * height],
                move |pixels, at: Vec2<usize>, (luminance, opacity): (f32, f32)| {
                    // The display window may leave out some pixels, and have more.
                    let Vec2(x, y) = at.to_i32() + first;
                    let is_shown =
                        (0..width as i32).contains(&x) && (0..height as i32).contains(&y);
                    if is_shown {
                        pixels[y as usize * width + x as usize] =
                            [luminance, luminance, luminance, opacity];
                    }
                },
            )
            .first_valid_layer()
            .all_attributes()
            .non_parallel();
        let image = read.from_buffered(self.file).map_err(|error| {
            let hint = ImageFormatHint::Exact(ImageFormat::OpenExr);
            ImageError::Decoding(DecodingError::new(hint, error.to_string()))
        })?;
        let pixels = image.layer_data.channel_data.pixels;
        bytes.copy_from_slice(bytemuck::cast_slice(&pixels));
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, bytes: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(bytes)
    }
}
