//! Smooth metals.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::kinds;
use crate::values::{ColorForm, Number, WordChoice, WordOr};
use base::keywords;

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
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(with = "WordOr<NamedMetal, ConductorKeys>")
)]
#[serde(from = "WordOr<NamedMetal, ConductorKeys>")]
pub struct Conductor {
    /// The real part of the index of refraction in each channel.
    pub index: Vec3,
    /// The imaginary part, the extinction coefficient.
    pub extinction: Vec3,
}

keywords! {
    /// Metals by name: index and extinction for light of the primaries of sRGB, after Johnson
    /// and Christy, "Optical Constants of the Noble Metals", Phys. Rev. B 6, 1972, and Rakić,
    /// "Algorithm for the determination of intrinsic optical constants of metal films:
    /// application to aluminum", Applied Optics 34, 1995.
    enum NamedMetal {
        /// After Rakić
        Aluminum = "aluminum",
        /// After Johnson and Christy
        Copper = "copper",
        /// After Johnson and Christy
        Gold = "gold",
        /// After Johnson and Christy
        Silver = "silver",
    }
}

impl WordChoice for NamedMetal {
    const EXPECTED: &'static str = "a metal such as gold, or { index: …, extinction: … }";
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

impl From<WordOr<NamedMetal, ConductorKeys>> for Conductor {
    fn from(found: WordOr<NamedMetal, ConductorKeys>) -> Self {
        match found {
            WordOr::Word(metal) => metal.into(),
            WordOr::Keys(ConductorKeys { index, extinction }) => Self { index, extinction },
        }
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
