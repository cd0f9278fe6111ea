//! The table of factors that a study can vary. A new factor is one row here, and a level type in
//! `factor_level.rs` if none of those fits.

use schemars::{Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::StringDeserializer;
use serde::de::{DeserializeOwned, Deserializer, IntoDeserializer, MapAccess};
use serde_json::{Map, Value, json};

use super::factor_level::{
    BoundedCount, Choices, FactorForm, FactorLevel, ImageSize, ProcessorCount, keyword, max_depth,
    setting,
};
use scene::config::{
    CostMode, MAX_SAMPLES, MAX_SHAPES, Pinning, SimdSet, Structure, TileOrder, Tiling, Traversal,
};
use vtk::Codec;
use world::values::expected;

/// Makes the enum of factors, their names and their parsers: one row per factor, `Variant "name":
/// type of a level in YAML => function that makes a [`FactorLevel`]`.
macro_rules! factors {
    ($($(#[doc = $doc:literal])* $factor:ident $name:literal: $level:ty => $to_level:expr;)+) => {
        /// A factor that a study varies through a flag of `raycost render`.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
        pub enum FlagFactor {
            $($(#[doc = $doc])* #[serde(rename = $name)] $factor,)+
        }

        impl FlagFactor {
            /// The names of all factors.
            pub const NAMES: &[&str] = &[$($name),+];

            /// Returns the name in study files and results, such as `image_size`.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$factor => $name,)+
                }
            }

            /// Returns the name, the description and the schema of a level of each factor.
            fn schemas(generator: &mut SchemaGenerator) -> Vec<[Value; 3]> {
                vec![$([
                    $name.into(),
                    concat!($($doc),*).trim_ascii_start().into(),
                    generator.subschema_for::<$level>().into(),
                ]),+]
            }

            /// Reads the value of this factor's key: at least one level.
            fn next_levels<'de, A: MapAccess<'de>>(
                self,
                map: &mut A,
                form: FactorForm,
            ) -> Result<Vec<FactorLevel>, A::Error> {
                match self {
                    $(Self::$factor => next_levels::<$level, A>(map, form, $to_level),)+
                }
            }
        }
    };
}

factors! {
    /// Width and height of the image in pixels: `[width, height]`.
    ImageSize "image_size": ImageSize => ImageSize::level;
    /// Samples per pixel.
    SamplesPerPixel "samples_per_pixel": BoundedCount<{ MAX_SAMPLES as u64 }> => |n| n.level("spp");
    /// Number of rendering threads.
    Threads "threads": ProcessorCount<1024> => |n| n.level("threads");
    /// Number of processes that render one picture by MPI, started by the `launcher`.
    Ranks "ranks": ProcessorCount<65_535> => |n| n.level_of_launcher();
    /// The acceleration structure.
    Acceleration "acceleration": Structure => |structure| keyword("acceleration", structure);
    /// Number of spheres per generator of the scene.
    Objects "objects": BoundedCount<{ MAX_SHAPES as u64 }> => |n| n.level("count");
    /// Maximum number of bounces of a path.
    MaxDepth "max_depth": u8 => max_depth;
    /// Side of a tile in pixels.
    TileSize "tile_size": BoundedCount<{ Tiling::MAX_SIZE as u64 }> => |n| n.level("tile-size");
    /// The order in which threads take tiles.
    TileOrder "tile_order": TileOrder => |order| keyword("tile-order", order);
    /// The cost that is measured for each pixel.
    Cost "cost": CostMode => |cost| keyword("cost", cost);
    /// The places of the threads.
    Pin "pin": Pinning => |pin| keyword("pin", pin);
    /// The vector instructions.
    Simd "simd": SimdSet => |simd| keyword("simd", simd);
    /// The way in which the rays of a wave are traced.
    Traversal "traversal": Traversal => |traversal| keyword("traversal", traversal);
    /// The codec of the arrays in VTK files.
    Compress "compress": Codec => |codec| keyword("compress", codec);
}

/// A quantity that a study varies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Factor {
    /// A flag of `raycost render`.
    Flag(FlagFactor),
    /// The value at a path of the scene, such as `camera.look_at.fov_y_deg`.
    Setting(String),
}

impl Factor {
    /// Returns the name in study files and results.
    pub fn name(&self) -> &str {
        match self {
            Self::Flag(flag) => flag.name(),
            Self::Setting(path) => path,
        }
    }

    /// Reads the value of this factor's key: at least one level.
    pub(super) fn next_levels<'de, A: MapAccess<'de>>(
        &self,
        map: &mut A,
        form: FactorForm,
    ) -> Result<Vec<FactorLevel>, A::Error> {
        match self {
            Self::Flag(flag) => flag.next_levels(map, form),
            Self::Setting(path) => next_levels::<Value, A>(map, form, |value| setting(path, value)),
        }
    }
}

/// A name with a `.` or a `[` is the path of a value.
impl<'de> Deserialize<'de> for Factor {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let name = String::deserialize(d)?;
        if name.contains(['.', '[']) {
            return Ok(Self::Setting(name));
        }
        let name: StringDeserializer<D::Error> = name.into_deserializer();
        FlagFactor::deserialize(name).map(Self::Flag)
    }
}

/// Returns the schema of a mapping of factors, which a `T` is read from.
pub(super) fn schema<T: DeserializeOwned>(
    form: FactorForm,
    generator: &mut SchemaGenerator,
) -> Schema {
    let of_key = |level: Value| match form {
        FactorForm::One => level,
        FactorForm::List => json!({ "type": "array", "items": level, "minItems": 1 }),
    };
    let factors = FlagFactor::schemas(generator).into_iter();
    let properties = factors.map(|[name, description, level]| {
        let mut key = of_key(level);
        key["description"] = description;
        (name.as_str().unwrap_or_default().to_owned(), key)
    });
    let mut schema = json_schema!({
        "type": "object",
        "properties": properties.collect::<Map<String, Value>>(),
        "patternProperties": { "[.\\[]": of_key(json!({})) },
        "additionalProperties": false,
    });
    expected::<T>(&mut schema);
    schema
}

fn next_levels<'de, T: Deserialize<'de>, A: MapAccess<'de>>(
    map: &mut A,
    form: FactorForm,
    to_level: impl Fn(T) -> FactorLevel,
) -> Result<Vec<FactorLevel>, A::Error> {
    let choices = match form {
        FactorForm::List => map.next_value::<Choices<T>>()?.0,
        FactorForm::One => vec![map.next_value::<T>()?],
    };
    Ok(choices.into_iter().map(to_level).collect())
}
