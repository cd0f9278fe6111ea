//! The colors of an array: a named map, or colors listed in the scene file.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::map::{ColorMap, interpolated, nearest};
use crate::values::{self, WordChoice, WordOr};

/// Maximum number of colors of a list.
const MAX_COLORS: usize = 1024;

/// Colors for numbers, in sRGB.
///
/// ```
/// # use raycost_world::color::Palette;
/// let named: Palette = scene::yaml::from_str("inferno").unwrap();
/// let blue_to_red: Palette = scene::yaml::from_str(r##"
/// colors: ["#0000ff", "#ffffff", [1, 0, 0]]   # evenly spread and interpolated
/// "##).unwrap();
/// let steps: Palette = scene::yaml::from_str("bands: [0.2, 0.5, 1]").unwrap();
/// let phases: Palette = scene::yaml::from_str("categories: [[0, 0, 1], [1, 0, 0]]").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "WordOr<ColorMap, PaletteKeys>", rename_all = "snake_case")]
pub enum Palette {
    /// Evenly spread colors, interpolated between them.
    Colors(ColorList),
    /// Steps of equal width, one color per step.
    Bands(ColorList),
    /// One color per category.
    Categories(ColorList),
    /// A named map.
    #[serde(untagged)]
    Named(ColorMap),
}

/// Red, green and blue of some colors, from 0 to 1.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "Vec<ListedColor>")]
pub struct ColorList(Vec<[f64; 3]>);

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(transparent)]
struct ListedColor {
    #[serde(with = "values::Color")]
    color: Vec3,
}

impl TryFrom<Vec<ListedColor>> for ColorList {
    type Error = &'static str;

    fn try_from(list: Vec<ListedColor>) -> Result<Self, Self::Error> {
        if list.is_empty() || list.len() > MAX_COLORS {
            return Err("cannot have this length, expected 1 to 1024 colors");
        }
        let channels = |listed: ListedColor| listed.color.to_array().map(f64::from);
        Ok(Self(list.into_iter().map(channels).collect()))
    }
}

/// The palettes with keys.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum PaletteKeys {
    /// The colors of equally spaced numbers, from the first of the range to the last.
    Colors(ColorList),
    /// The colors of equally wide parts of the range.
    Bands(ColorList),
    /// The colors of categories: the whole number nearest to each value selects one, modulo their
    /// number.
    Categories(ColorList),
}

impl Palette {
    /// Returns red, green and blue at a position from 0 to 1, as sRGB numbers from 0 to 1.
    pub fn at(&self, position: f64) -> [f64; 3] {
        match self {
            Self::Named(map) => map.at(position),
            Self::Colors(list) => interpolated(list.0.len(), |i| list.0[i], position),
            Self::Bands(list) | Self::Categories(list) => *nearest(&list.0, position),
        }
    }

    /// Returns the number of colors of a palette for categories.
    pub fn n_categories(&self) -> Option<usize> {
        match self {
            Self::Named(map) => map.n_categories(),
            Self::Categories(list) => Some(list.0.len()),
            Self::Colors(_) | Self::Bands(_) => None,
        }
    }

    /// Returns the number of colors of a palette of bands.
    pub fn n_bands(&self) -> Option<usize> {
        match self {
            Self::Bands(list) => Some(list.0.len()),
            Self::Named(_) | Self::Colors(_) | Self::Categories(_) => None,
        }
    }
}

impl Default for Palette {
    fn default() -> Self {
        Self::Named(ColorMap::default())
    }
}

impl WordChoice for ColorMap {
    const EXPECTED: &'static str =
        "the name of a color map, { colors: … }, { bands: … } or { categories: … }";
}

impl From<WordOr<ColorMap, PaletteKeys>> for Palette {
    fn from(found: WordOr<ColorMap, PaletteKeys>) -> Self {
        match found {
            WordOr::Word(map) => Self::Named(map),
            WordOr::Keys(PaletteKeys::Colors(list)) => Self::Colors(list),
            WordOr::Keys(PaletteKeys::Bands(list)) => Self::Bands(list),
            WordOr::Keys(PaletteKeys::Categories(list)) => Self::Categories(list),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn palette(text: &str) -> Palette {
        scene::yaml::from_str(text).unwrap()
    }

    #[test]
    fn colors_are_interpolated_and_bands_are_not() {
        let colors = palette("colors: [0, '#ffffff', [1, 0, 0]]");
        let bands = palette("bands: [0, '#ffffff', [1, 0, 0]]");
        let gray = |of: f64| [of; 3];
        for (position, interpolated, of_band) in [
            (0.0, gray(0.0), gray(0.0)),
            (0.25, gray(0.5), gray(0.0)),
            (0.5, gray(1.0), gray(1.0)),
            (0.75, [1.0, 0.5, 0.5], [1.0, 0.0, 0.0]),
            (1.0, [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ] {
            assert_eq!(colors.at(position), interpolated, "{position}");
            assert_eq!(bands.at(position), of_band, "{position}");
        }
        assert_eq!(palette("colors: [0.5]").at(0.3), gray(0.5));
    }
}
