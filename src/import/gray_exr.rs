//! OpenEXR pictures that have a luminance in place of colors, and may have a chroma.

use std::io::{BufRead, Seek};

use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Text, Vec2};
use image::error::{DecodingError, ImageFormatHint};
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageResult};

/// Errors in parts that are not read are not reported.
const IS_STRICT: bool = false;

/// Luminance of red, green and blue light of Rec. 709.
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// The luminance of a pixel, how much more red and blue it has than a gray one, as shares, and its
/// opacity.
type Channels = (f32, f32, f32, f32);

/// The decoder of a picture with a luminance.
pub(super) struct GrayExr<R> {
    /// The file, at its start.
    pub(super) file: R,
    pub(super) header: Header,
}

/// Returns the header of the first part of a file with a luminance; `None` if there are colors, or
/// no header can be read.
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
            .optional("RY", 0.0_f32)
            .optional("BY", 0.0_f32)
            .optional("A", 1.0_f32)
            .collect_pixels(
                move |_, _| vec![[0.0_f32; 4]; width * height],
                move |pixels, at: Vec2<usize>, (luminance, red, blue, opacity): Channels| {
                    // The display window may leave out some pixels, and have more.
                    let Vec2(x, y) = at.to_i32() + first;
                    let is_shown =
                        (0..width as i32).contains(&x) && (0..height as i32).contains(&y);
                    if is_shown {
                        let [to_red, to_green, to_blue] = LUMINANCE;
                        let green = -(to_red * red + to_blue * blue) / to_green;
                        let [red, green, blue] =
                            [red, green, blue].map(|chroma| luminance * (1.0 + chroma));
                        pixels[y as usize * width + x as usize] = [red, green, blue, opacity];
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
