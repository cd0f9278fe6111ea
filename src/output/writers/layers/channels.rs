//! The channels of `image.exr`.
//!
//! Compositors know the names: `R`, `G`, `B` and `Z`, `N` for normals, `P` for positions, `albedo`;
//! an array of one number per pixel is the channel `X` of a layer of its name, as Cycles writes its
//! passes. A layer `depth` would be mistaken for `Z`, so the depth of paths is `path_depth`.

use exr::meta::attribute::{ChannelDescription, SampleType, Text};
use glam::Vec3;
use vtkio::model::ScalarType;

use render::film::{Column, Film, Strip};
use world::camera::{ImagePlane, Projection};

/// Bytes of a number in each channel.
pub(super) const CHANNEL_BYTES: usize = 4;

/// Depth and distance without a hit, as in Cycles: NaN and infinity would spread when compositors
/// filter.
const FAR: f32 = 1e10;

/// A channel of the file.
pub(super) struct Channel {
    name: String,
    kind: SampleType,
    origin: ChannelOrigin,
}

/// The source of a channel's numbers.
enum ChannelOrigin {
    /// A component of an array of the film. Floats without a hit become `miss`.
    Array {
        column: Column,
        component: usize,
        miss: f32,
    },
    /// The distance of the hit from the camera, along the viewing axis if there is one.
    Depth {
        eye: Vec3,
        axis: Option<Vec3>,
        /// World units per unit of render space.
        unit: f32,
    },
}

/// The names of three components.
const COLOR: [&str; 3] = ["R", "G", "B"];
const SPACE: [&str; 3] = ["X", "Y", "Z"];

/// Returns the channels of a film that keeps its radiance and its albedo, sorted by name as the
/// format requires.
pub(super) fn channels(film: &Film, plane: ImagePlane) -> Vec<Channel> {
    let mut channels = Vec::new();
    channels.extend(vector("", COLOR, Column::RADIANCE));
    channels.extend(vector("albedo.", COLOR, Column::ALBEDO));
    channels.extend(vector("P.", SPACE, Column::POSITION));
    for column in film.kept_columns() {
        match column.name {
            // Skip the 8-bit picture, arrays that are channels already, and the places of pixels.
            "RGB" | "radiance" | "pixel_x" | "pixel_y" => {}
            "Normals" => channels.extend(vector("N.", SPACE, column)),
            _ => channels.extend((0..column.n_components).map(|i| number(column, i))),
        }
    }
    channels.push(depth(plane));
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    channels
}

fn vector(layer: &str, names: [&str; 3], column: Column) -> impl Iterator<Item = Channel> {
    let channel = move |(component, name)| Channel {
        name: format!("{layer}{name}"),
        kind: SampleType::F32,
        origin: ChannelOrigin::Array {
            column,
            component,
            miss: 0.0,
        },
    };
    names.into_iter().enumerate().map(channel)
}

/// Returns the channel of one of the numbers of an array.
fn number(column: Column, component: usize) -> Channel {
    let is_float = column.scalar == ScalarType::F32 || is_signed(&column);
    let layer = match column.name {
        "depth" => "path_depth",
        name => name,
    };
    Channel {
        name: match column.n_components {
            1 => format!("{layer}.X"),
            _ => format!("{layer}.{component}"),
        },
        kind: if is_float {
            SampleType::F32
        } else {
            SampleType::U32
        },
        origin: ChannelOrigin::Array {
            column,
            component,
            miss: if column.name == "distance" { FAR } else { 0.0 },
        },
    }
}

fn depth(plane: ImagePlane) -> Channel {
    let ahead = plane.right.cross(plane.down).normalize_or_zero();
    let axis = match plane.projection {
        Projection::Perspective => {
            let is_behind = ahead.dot(plane.to_first) < 0.0;
            Some(if is_behind { -ahead } else { ahead })
        }
        Projection::Parallel { direction } => Some(direction),
        Projection::Panorama { .. } => None,
    };
    Channel {
        name: "Z".to_owned(),
        kind: SampleType::F32,
        origin: ChannelOrigin::Depth {
            eye: plane.eye,
            axis,
            unit: plane.space.world_length(1.0),
        },
    }
}

/// Returns true if the numbers of an array may be -1: the format has no signed integers.
fn is_signed(column: &Column) -> bool {
    column.scalar == ScalarType::I32 && column.is_in_strips()
}

impl Channel {
    /// Returns the description for the header.
    pub(super) fn described(&self) -> ChannelDescription {
        let is_linear = false;
        ChannelDescription::new(Text::from(&*self.name), self.kind, is_linear)
    }

    /// Appends the bits of the channel's numbers in a strip of the film, row by row.
    pub(super) fn add_words(&self, film: &Film, strip: &Strip, words: &mut Vec<u32>) {
        match &self.origin {
            ChannelOrigin::Array {
                column,
                component,
                miss,
            } => {
                let mut buffer = Vec::new();
                let bytes = column.bytes(film, strip, &mut buffer);
                let of_component = bytes.chunks_exact(column.stride());
                words.extend(of_component.map(|pixel| match column.scalar {
                    ScalarType::U8 => u32::from(pixel[*component]),
                    ScalarType::F32 => finite(f32::from_bits(word(pixel, *component)), *miss),
                    _ if is_signed(column) => (word(pixel, 0) as i32 as f32).to_bits(),
                    _ => word(pixel, *component),
                }));
            }
            ChannelOrigin::Depth { eye, axis, unit } => {
                let depth = |position: &Vec3| {
                    let from_eye = *position - *eye;
                    let depth = axis.map_or(from_eye.length(), |axis| axis.dot(from_eye));
                    finite(unit * depth, FAR)
                };
                words.extend(strip.position.iter().map(depth));
            }
        }
    }
}

/// Returns a number of four bytes in native order.
fn word(pixel: &[u8], component: usize) -> u32 {
    let (words, _) = pixel.as_chunks();
    u32::from_ne_bytes(words[component])
}

/// Returns the bits of a number, or of `miss` for NaN.
fn finite(number: f32, miss: f32) -> u32 {
    if number.is_nan() { miss } else { number }.to_bits()
}
