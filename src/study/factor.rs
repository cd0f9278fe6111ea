//! What a study varies.

use serde::de::{Deserializer, MapAccess};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::config::{CostMode, MAX_SIDE, Structure, TileOrder, Tiling};
use crate::vtk::Codec;
use crate::yaml;

/// Something that a study varies, by flags of `raycost render`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Factor {
    /// Columns and rows of the picture: `[width, height]`.
    ImageSize,
    /// Samples of each pixel.
    SamplesPerPixel,
    /// Threads that render.
    Threads,
    /// How hits are found.
    Acceleration,
    /// Spheres that each generator of the scene makes.
    Objects,
    /// Longest path in bounces.
    MaxDepth,
    /// Pixels along a tile's side.
    TileSize,
    /// In which order threads take tiles.
    TileOrder,
    /// What is measured of each pixel.
    Cost,
    /// How the arrays of VTK files are compressed.
    Compress,
}

/// How choices stand in the study file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// As a list of at least one.
    List,
    /// As one value.
    One,
}

/// One choice for a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// What stands in the results: a number or a text.
    pub value: Value,
    /// What asks `raycost render` for it.
    pub flags: Vec<String>,
}

impl Factor {
    /// Its name in study files and results.
    pub fn name(self) -> &'static str {
        match self {
            Self::ImageSize => "image_size",
            Self::SamplesPerPixel => "samples_per_pixel",
            Self::Threads => "threads",
            Self::Acceleration => "acceleration",
            Self::Objects => "objects",
            Self::MaxDepth => "max_depth",
            Self::TileSize => "tile_size",
            Self::TileOrder => "tile_order",
            Self::Cost => "cost",
            Self::Compress => "compress",
        }
    }

    /// Reads what stands behind this factor's key.
    pub(super) fn next_levels<'de, A: MapAccess<'de>>(
        self,
        map: &mut A,
        form: Form,
    ) -> Result<Vec<Level>, A::Error> {
        match self {
            Self::ImageSize => levels(map, form, Size::level),
            Self::SamplesPerPixel => levels(map, form, |n: Count<65_536>| n.level("spp")),
            Self::Threads => levels(map, form, |n: Count<1024>| n.level("threads")),
            Self::Objects => levels(map, form, |n: Count<1_000_000_000>| n.level("count")),
            Self::MaxDepth => levels(map, form, |depth: u8| Level {
                value: json!(depth),
                flags: vec![format!("--max-depth={depth}")],
            }),
            Self::Acceleration => levels(map, form, |structure: Structure| {
                word("acceleration", structure)
            }),
            Self::TileSize => {
                const MOST: u64 = Tiling::MAX_SIZE as u64;
                levels(map, form, |n: Count<MOST>| n.level("tile-size"))
            }
            Self::TileOrder => levels(map, form, |order: TileOrder| word("tile-order", order)),
            Self::Cost => levels(map, form, |cost: CostMode| word("cost", cost)),
            Self::Compress => levels(map, form, |codec: Codec| word("compress", codec)),
        }
    }
}

fn levels<'de, T: Deserialize<'de>, A: MapAccess<'de>>(
    map: &mut A,
    form: Form,
    level: impl Fn(T) -> Level,
) -> Result<Vec<Level>, A::Error> {
    let choices = match form {
        Form::List => map.next_value::<Choices<T>>()?.0,
        Form::One => vec![map.next_value::<T>()?],
    };
    Ok(choices.into_iter().map(level).collect())
}

/// At least one.
struct Choices<T>(Vec<T>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Choices<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        yaml::non_empty(d, "choice").map(Self)
    }
}

/// A level whose flag takes one of clap's words.
fn word(flag: &str, value: impl Serialize) -> Level {
    let value = json!(value);
    let text = value.as_str().unwrap_or_default();
    Level {
        flags: vec![format!("--{flag}={text}")],
        value,
    }
}

/// A number from 1 to `MAX`.
struct Count<const MAX: u64>(u64);

impl<const MAX: u64> Count<MAX> {
    fn level(self, flag: &str) -> Level {
        Level {
            value: json!(self.0),
            flags: vec![format!("--{flag}={}", self.0)],
        }
    }
}

impl<'de, const MAX: u64> Deserialize<'de> for Count<MAX> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        yaml::whole(d, 1..=MAX).map(Self)
    }
}

/// Width and height of a picture.
#[derive(Deserialize)]
#[serde(expecting = "a size [width, height]")]
struct Size(Count<{ MAX_SIDE as u64 }>, Count<{ MAX_SIDE as u64 }>);

impl Size {
    fn level(self) -> Level {
        let Self(Count(width), Count(height)) = self;
        Level {
            value: json!(format!("{width}x{height}")),
            flags: vec![format!("--width={width}"), format!("--height={height}")],
        }
    }
}
