//! Smooth metals.

use std::fmt;

use glam::Vec3;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::kinds;
use crate::values::{ColorForm, Number};

/// A smooth metal, which reflects light by Fresnel's equations and transmits none.
///
/// ```
/// # use raycost_world::material::Conductor;
/// # let copper: Conductor = scene::yaml::from_str("copper").unwrap();
/// let other: Conductor = scene::yaml::from_str("
/// index: [0.2, 0.92, 1.1]         # of refraction, by channel
/// extinction: [3.91, 2.45, 2.14]  # its imaginary part
/// ").unwrap();
/// # assert!((copper.index - other.index).abs().max_element() < 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "crate::values::Either<NamedMetal, ConductorKeys>", transform = crate::values::expected::<Self>))]
pub struct Conductor {
    /// The real part of the index of refraction in each channel.
    pub index: Vec3,
    /// The imaginary part, the extinction coefficient.
    pub extinction: Vec3,
}

/// Metals by name: index and extinction for light of the primaries of sRGB, after Johnson
/// and Christy, "Optical Constants of the Noble Metals", Phys. Rev. B 6, 1972, and Rakić,
/// "Algorithm for the determination of intrinsic optical constants of metal films:
/// application to aluminum", Applied Optics 34, 1995.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum NamedMetal {
    Aluminum,
    Copper,
    Gold,
    Silver,
}

impl From<NamedMetal> for Conductor {
    fn from(metal: NamedMetal) -> Self {
        let (index, extinction) = match metal {
            NamedMetal::Aluminum => ([1.657, 0.880, 0.521], [9.224, 6.270, 4.837]),
            NamedMetal::Copper => ([0.200, 0.924, 1.102], [3.913, 2.453, 2.142]),
            NamedMetal::Gold => ([0.143, 0.375, 1.442], [3.983, 2.386, 1.603]),
            NamedMetal::Silver => ([0.155, 0.117, 0.138], [4.828, 3.123, 2.147]),
        };
        Self {
            index: Vec3::from_array(index),
            extinction: Vec3::from_array(extinction),
        }
    }
}

impl<'de> Deserialize<'de> for Conductor {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ConductorVisitor)
    }
}

struct ConductorVisitor;

impl<'de> Visitor<'de> for ConductorVisitor {
    type Value = Conductor;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a metal such as gold, or { index: …, extinction: … }")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Conductor, E> {
        NamedMetal::deserialize(name.into_deserializer()).map(Conductor::from)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Conductor, A::Error> {
        let keys = ConductorKeys::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Conductor {
            index: keys.index,
            extinction: keys.extinction,
        })
    }
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct ConductorKeys {
    /// The real part of the index of refraction in each channel.
    #[serde(with = "OpticalConstant")]
    index: Vec3,
    /// The imaginary part, the extinction coefficient.
    #[serde(with = "OpticalConstant")]
    extinction: Vec3,
}

kinds! {
    // Less than 100 from the ultraviolet to the far infrared.
    OpticalConstant: Vec3 = ColorForm(Number {
        expected: "a number from 0 to 1000",
        ranges: &[[0.0, 1000.0]],
    });
}
