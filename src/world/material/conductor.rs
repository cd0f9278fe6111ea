//! Smooth metals.

use std::fmt;

use glam::Vec3;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::values::{self, Number};

/// A smooth metal, which reflects light by Fresnel's equations and transmits none.
///
/// ```
/// # use world::material::Conductor;
/// # let copper: Conductor = scene::yaml::from_str("copper").unwrap();
/// let other: Conductor = scene::yaml::from_str("
/// index: [0.2, 0.92, 1.1]         # of refraction, by channel
/// extinction: [3.91, 2.45, 2.14]  # its imaginary part
/// ").unwrap();
/// # assert!((copper.index - other.index).abs().max_element() < 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
const METALS: [(&str, Conductor); 4] = [
    (
        "aluminum",
        metal([1.657, 0.880, 0.521], [9.224, 6.270, 4.837]),
    ),
    (
        "copper",
        metal([0.200, 0.924, 1.102], [3.913, 2.453, 2.142]),
    ),
    ("gold", metal([0.143, 0.375, 1.442], [3.983, 2.386, 1.603])),
    (
        "silver",
        metal([0.155, 0.117, 0.138], [4.828, 3.123, 2.147]),
    ),
];

const NAMES: [&str; METALS.len()] = {
    let mut names = [""; METALS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = METALS[i].0;
        i += 1;
    }
    names
};

const fn metal(index: [f32; 3], extinction: [f32; 3]) -> Conductor {
    Conductor {
        index: Vec3::from_array(index),
        extinction: Vec3::from_array(extinction),
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
        let found = METALS.iter().find(|(known, _)| *known == name);
        let unknown = || E::unknown_variant(name, &NAMES);
        found.map(|(_, metal)| *metal).ok_or_else(unknown)
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
#[serde(deny_unknown_fields)]
struct ConductorKeys {
    #[serde(deserialize_with = "optical_constant")]
    index: Vec3,
    #[serde(deserialize_with = "optical_constant")]
    extinction: Vec3,
}

/// Reads an optical constant. Metals' are less than 100 from the ultraviolet to the far infrared.
fn optical_constant<'de, D: Deserializer<'de>>(d: D) -> Result<Vec3, D::Error> {
    let number: Number = Number {
        expected: "a number from 0 to 1000",
        accepts: |n| (0.0..=1000.0).contains(&n),
    };
    values::channels(d, number)
}
