//! The table of factors that a study can vary. A new factor is one row here, and a level type in
//! `factor_level.rs` if none of those fits.

use schemars::{Schema, SchemaGenerator, json_schema};
use serde::de::value::StringDeserializer;
use serde::de::{DeserializeOwned, Deserializer, Error, IntoDeserializer, MapAccess};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::factor_level::{BoundedCount, FactorForm, ImageSize, ProcessorCount, text_of};
use scene::config::{
    CostMode, MAX_SAMPLES, MAX_SHAPES, Pinning, SimdSet, Structure, TileOrder, Tiling, Traversal,
};
use vtk::Codec;
use world::values::{NonEmpty, expected};

/// Makes the enum of factors, their names and their parsers: one row per factor, `Variant "name":
/// type of a level in YAML => the flags that select it`.
macro_rules! factors {
    ($($(#[doc = $doc:literal])* $factor:ident $name:literal: $level:ty => $flags:expr;)+) => {
        /// A factor that a study varies through flags of `raycost render`.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
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

            /// Returns the flags that select a level; two share a size such as `100x75`.
            fn flags(self) -> &'static [&'static str] {
                match self {
                    $(Self::$factor => &$flags,)+
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
            ) -> Result<Vec<Value>, A::Error> {
                match self {
                    $(Self::$factor => next_levels::<$level, A>(map, form),)+
                }
            }
        }
    };
}

factors! {
    /// Width and height of the image in pixels: `[width, height]`.
    ImageSize "image_size": ImageSize => ["width", "height"];
    /// Samples per pixel.
    SamplesPerPixel "samples_per_pixel": BoundedCount<{ MAX_SAMPLES as u64 }> => ["spp"];
    /// Number of rendering threads.
    Threads "threads": ProcessorCount<1024> => ["threads"];
    /// Number of processes that render one picture by MPI, started by the `launcher`.
    Ranks "ranks": ProcessorCount<65_535> => [];
    /// The acceleration structure.
    Acceleration "acceleration": Structure => ["acceleration"];
    /// Number of spheres per generator of the scene.
    Objects "objects": BoundedCount<{ MAX_SHAPES as u64 }> => ["count"];
    /// Maximum number of bounces of a path.
    MaxDepth "max_depth": BoundedCount<255, 0> => ["max-depth"];
    /// Side of a tile in pixels.
    TileSize "tile_size": BoundedCount<{ Tiling::MAX_SIZE as u64 }> => ["tile-size"];
    /// The order in which threads take tiles.
    TileOrder "tile_order": TileOrder => ["tile-order"];
    /// The cost that is measured for each pixel.
    Cost "cost": CostMode => ["cost"];
    /// The places of the threads.
    Pin "pin": Pinning => ["pin"];
    /// The vector instructions.
    Simd "simd": SimdSet => ["simd"];
    /// The way in which the rays of a wave are traced.
    Traversal "traversal": Traversal => ["traversal"];
    /// What renders: `processor`, or `opencl` or `cuda`, these with `:` and a part of a name, if any.
    Device "device": String => ["device"];
    /// The codec of the arrays in VTK files.
    Compress "compress": Codec => ["compress"];
}

/// A quantity that a study varies.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
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

    /// Returns the names of the flags of `raycost render` that select a level; none for a value of the
    /// scene.
    pub(super) fn flag_names(&self) -> &'static [&'static str] {
        match self {
            Self::Flag(flag) => flag.flags(),
            Self::Setting(_) => &[],
        }
    }

    /// Returns the flags of `raycost render` that select a level.
    pub(super) fn flags(&self, level: &Value) -> Vec<String> {
        let Self::Flag(factor) = self else {
            return vec![format!("--set={}={level}", self.name())];
        };
        let (flags, text) = (factor.flags(), text_of(level));
        let values = text.splitn(flags.len(), 'x');
        let set = |(flag, value): (&&str, &str)| format!("--{flag}={value}");
        flags.iter().zip(values).map(set).collect()
    }

    /// Reads the value of this factor's key: at least one level.
    pub(super) fn next_levels<'de, A: MapAccess<'de>>(
        &self,
        map: &mut A,
        form: FactorForm,
    ) -> Result<Vec<Value>, A::Error> {
        match self {
            Self::Flag(flag) => flag.next_levels(map, form),
            Self::Setting(_) => next_levels::<Value, A>(map, form),
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

impl Serialize for Factor {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(self.name())
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

fn next_levels<'de, T: Deserialize<'de> + Serialize, A: MapAccess<'de>>(
    map: &mut A,
    form: FactorForm,
) -> Result<Vec<Value>, A::Error> {
    let levels = match form {
        FactorForm::List => map.next_value_seed(NonEmpty::<T>::of("choice"))?,
        FactorForm::One => vec![map.next_value::<T>()?],
    };
    let levels = levels.iter().map(serde_json::to_value);
    levels.collect::<Result<_, _>>().map_err(A::Error::custom)
}
