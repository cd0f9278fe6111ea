//! Colors from the arrays of VTK files and the columns of tables.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use glam::Vec3;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::array_choice::{ArrayChoice, ArrayOf};
use super::color_table::{ColorChoice, ColorTable, MAX_LISTED, category};
use super::texture_point::TexturePoint;
use crate::color::{Palette, Transfer};
use crate::values;
use base::keywords;
use math::simd::{Real, Vector};

/// The numbers of an array of a VTK file as colors.
///
/// ```
/// # use raycost_world::material::Texture;
/// let hot: Texture = scene::yaml::from_str("
/// array:
///   name: temperature
///   map: inferno           # cool_to_warm by default
///   range: [280, 360]      # or data, the default, or quantiles
///   scale: linear          # or log
///   nan_color: [1, 1, 0]
///   bar: temperature in K  # the title of a color bar in image.png
/// ").unwrap();
/// let phases: Texture = scene::yaml::from_str("
/// array: { name: phase, map: set1, bar: phase, labels: [gas, liquid, solid] }
/// ").unwrap();
/// let vertical: Texture = scene::yaml::from_str("
/// array: { name: velocity, component: 2, of: points }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(
    try_from = "ArrayKeys",
    into = "ArrayKeys",
    expecting = "an array such as { name: temperature }"
)]
pub struct ArrayTexture {
    /// The choice of the array.
    pub choice: ArrayChoice,
    /// The colors.
    pub map: Palette,
    /// The numbers of the first and the last color.
    pub range: ArrayRange,
    /// The scale between these numbers. On `log`, numbers that are not positive have the first
    /// color.
    pub scale: ArrayScale,
    /// The color of numbers that are NaN.
    pub nan_color: Vec3,
    /// The title of the color bar in the picture, if there is one.
    pub bar: Option<String>,
    /// The labels of the categories 0, 1 and so on in the color bar; other categories show their
    /// numbers.
    pub labels: Vec<String>,
    /// The colors by number; empty until the array is read.
    pub table: Arc<ColorTable>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "an array such as { name: temperature }"
)]
struct ArrayKeys {
    /// The name of the array in the file.
    #[serde(with = "values::Name")]
    name: String,
    /// The component of a vector array, counted from 0; the magnitude by default.
    #[serde(default, with = "values::Between::<0, MAX_COMPONENT>")]
    component: Option<u32>,
    /// The kind of the array; by default, whichever the file has.
    #[serde(default)]
    of: Option<ArrayOf>,
    /// The colors.
    #[serde(default)]
    map: Palette,
    /// The numbers of the first and the last color.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("default" = ArrayRange::default())))]
    range: Option<ArrayRange>,
    /// The scale between these numbers. On `log`, numbers that are not positive have the first
    /// color.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("default" = ArrayScale::default())))]
    scale: Option<ArrayScale>,
    /// The color of numbers that are NaN; yellow by default.
    #[serde(default = "yellow", with = "values::Color")]
    nan_color: Vec3,
    /// The title of a color bar that is drawn onto `image.png`; without it there is none.
    #[serde(default, with = "values::Name")]
    bar: Option<String>,
    /// The labels of the categories 0, 1 and so on in the color bar; other categories show their
    /// numbers.
    #[serde(default)]
    labels: Vec<CategoryLabel>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(transparent)]
struct CategoryLabel(#[serde(with = "values::Name")] String);

/// The numbers of the first and the last color of a map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(rename_all = "snake_case")]
pub enum ArrayRange {
    /// The least and the greatest number of the data of the material's objects.
    #[default]
    Data,
    /// The 1 % and the 99 % quantiles of these numbers.
    Quantiles,
    /// Given numbers, ascending.
    #[serde(untagged)]
    Given(#[serde(with = "values::Range")] [f64; 2]),
}

keywords! {
    /// How numbers become positions in a color map.
    #[derive(Default)]
    pub enum ArrayScale {
        /// In equal steps.
        #[default]
        Linear = "linear",
        /// In equal ratios, of positive numbers.
        Log = "log",
    }
}

/// The maximum index of a component.
const MAX_COMPONENT: u32 = 255;

fn yellow() -> Vec3 {
    Vec3::new(1.0, 1.0, 0.0)
}

impl TryFrom<ArrayKeys> for ArrayTexture {
    type Error = &'static str;

    fn try_from(keys: ArrayKeys) -> Result<Self, Self::Error> {
        let has_categories = keys.map.n_categories().is_some();
        if has_categories && (keys.range.is_some() || keys.scale.is_some()) {
            return Err("cannot have a `range` or a `scale`, \
                 expected neither of them beside a `map` of categories");
        }
        let shows_labels = has_categories && keys.bar.is_some();
        if !shows_labels && !keys.labels.is_empty() {
            return Err("cannot have `labels`, \
                 expected them beside a `map` of categories and a `bar` alone");
        }
        let (range, scale) = (
            keys.range.unwrap_or_default(),
            keys.scale.unwrap_or_default(),
        );
        if scale == ArrayScale::Log && matches!(range, ArrayRange::Given([low, _]) if low <= 0.0) {
            return Err("cannot have a `range` that begins at 0 or below, \
                 expected one of positive numbers beside `scale: log`");
        }
        Ok(Self {
            choice: ArrayChoice {
                name: keys.name,
                component: keys.component.map(|component| component as usize),
                is_color: false,
                of: keys.of,
            },
            map: keys.map,
            range,
            scale,
            nan_color: keys.nan_color,
            bar: keys.bar,
            labels: keys.labels.into_iter().map(|label| label.0).collect(),
            table: Arc::default(),
        })
    }
}

impl From<ArrayTexture> for ArrayKeys {
    fn from(texture: ArrayTexture) -> Self {
        let has_categories = texture.map.n_categories().is_some();
        Self {
            name: texture.choice.name,
            component: texture.choice.component.map(|component| component as u32),
            of: texture.choice.of,
            map: texture.map,
            range: (!has_categories).then_some(texture.range),
            scale: (!has_categories).then_some(texture.scale),
            nan_color: texture.nan_color,
            bar: texture.bar,
            labels: texture.labels.into_iter().map(CategoryLabel).collect(),
        }
    }
}

impl ArrayTexture {
    #[inline(always)]
    pub(super) fn color_at<R: Real>(&self, point: &TexturePoint<R>) -> Vector<R> {
        let [x, y, z] = R::look_up(&*self.table, [point.scalar]);
        Vector { x, y, z }
    }

    /// Builds the table of colors for the numbers on all surfaces of the material; `transfer` is
    /// the picture's, so that a surface in white light has the colors of the map.
    pub fn prepare(&mut self, numbers: &[f64], transfer: Transfer) {
        let [low, high] = self.ends(numbers);
        let (n_categories, n_bands) = (self.map.n_categories(), self.map.n_bands());
        let n = n_categories.or(n_bands).unwrap_or(N_COLORS);
        let choice = match (n_categories, n_bands) {
            (Some(_), _) => ColorChoice::Category,
            (_, Some(_)) => ColorChoice::Band,
            (None, None) => ColorChoice::Nearest,
        };
        let color = |i: usize| {
            // The centers of categories and bands; the ends of gradients.
            let position = match choice {
                ColorChoice::Nearest => i as f64 / (n - 1) as f64,
                _ => (i as f64 + 0.5) / n as f64,
            };
            self.map
                .at(position)
                .map(|number| transfer.light(number as f32))
        };
        self.table = Arc::new(ColorTable {
            ends: [low, high],
            offset: self.offset([low, high]),
            is_cyclic: n_categories.is_some() && high - low >= N_EXACT,
            clips: [
                numbers.iter().any(|number| *number < low),
                numbers.iter().any(|number| *number > high),
            ],
            categories: match (n_categories, &self.bar) {
                (Some(_), Some(_)) => categories(numbers),
                _ => Vec::new(),
            },
            is_log: self.scale == ArrayScale::Log,
            choice,
            colors: (0..n).map(color).collect(),
            nan_color: self.nan_color.to_array(),
        });
    }

    /// Returns the number that surfaces store as 0, given the ends of the colors: 0 itself where 32 bits
    /// are precise enough.
    fn offset(&self, [low, high]: [f64; 2]) -> f64 {
        let size = low.abs().max(high.abs());
        match self.map.n_categories() {
            Some(_) if size >= N_EXACT => low.round(),
            None if size > MAX_SIZE * (high - low) => low,
            _ => 0.0,
        }
    }

    /// Returns the numbers of the first and the last color, in ascending order.
    fn ends(&self, numbers: &[f64]) -> [f64; 2] {
        if let ArrayRange::Given(ends) = self.range {
            return ends;
        }
        let [low, high] = self.shown_ends(numbers).unwrap_or([1.0; 2]);
        // A single number has the middle color.
        match (low < high, self.scale) {
            (true, _) => [low, high],
            (false, ArrayScale::Log) => [low / 2.0, low * 2.0],
            (false, ArrayScale::Linear) => {
                let margin = (low.abs() * 1e-3).max(0.5);
                [low - margin, low + margin]
            }
        }
    }

    /// Returns true if the colors depend on all numbers of the data.
    pub fn is_of_data(&self) -> bool {
        self.map.n_categories().is_none() && !matches!(self.range, ArrayRange::Given(_))
    }

    /// Returns true if the range is that of the whole data set, with numbers off the surface.
    pub fn spans_data(&self) -> bool {
        self.is_of_data() && self.range == ArrayRange::Data
    }

    /// Sets the range to span these ends of several lists of numbers, and returns it.
    pub fn span(&mut self, ends: &[[f64; 2]]) -> [f64; 2] {
        self.range = ArrayRange::Data;
        let ends = self.ends(ends.as_flattened());
        self.range = ArrayRange::Given(ends);
        ends
    }

    /// Returns the least and the greatest of the numbers that have colors, or their quantiles;
    /// `None` if none has a color.
    pub fn shown_ends(&self, numbers: &[f64]) -> Option<[f64; 2]> {
        let least = match self.scale {
            ArrayScale::Linear => f64::NEG_INFINITY,
            ArrayScale::Log => f32::MIN_POSITIVE.into(),
        };
        let shown = numbers.iter().copied();
        let shown = shown.filter(|number| number.is_finite() && *number >= least);
        if self.range != ArrayRange::Quantiles {
            return Some([shown.clone().reduce(f64::min)?, shown.reduce(f64::max)?]);
        }
        let mut shown: Vec<f64> = shown.collect();
        shown.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let index = share * (shown.len().max(1) - 1) as f64;
            shown.get(index.round() as usize).copied()
        };
        Some([at(0.01)?, at(0.99)?])
    }
}

/// Returns the least [`MAX_LISTED`] categories among the numbers, in ascending order.
fn categories(numbers: &[f64]) -> Vec<i64> {
    let mut found = BTreeSet::new();
    for number in numbers.iter().filter(|number| number.is_finite()) {
        if found.insert(category(*number)) && found.len() > MAX_LISTED {
            found.pop_last();
        }
    }
    found.into_iter().collect()
}

/// Number of successive whole numbers that 32 bits store to less than a half.
const N_EXACT: f64 = (1 << 23) as f64;
/// The numbers, in lengths of the range of the colors, up to which 32 bits are precise enough.
const MAX_SIZE: f64 = 16.0;

/// Number of colors of a gradient: with 1024 the nearest one is within one 8-bit level.
const N_COLORS: usize = 1024;

impl<'de> Deserialize<'de> for ArrayRange {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(RangeVisitor)
    }
}

struct RangeVisitor;

impl<'de> Visitor<'de> for RangeVisitor {
    type Value = ArrayRange;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`data`, `quantiles` or [from, to]")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<ArrayRange, E> {
        match word {
            "data" => Ok(ArrayRange::Data),
            "quantiles" => Ok(ArrayRange::Quantiles),
            _ => {
                let message =
                    format!("unknown variant `{word}`, expected `data`, `quantiles` or [from, to]");
                Err(E::custom(message))
            }
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<ArrayRange, A::Error> {
        values::Range::deserialize(SeqAccessDeserializer::new(list)).map(ArrayRange::Given)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use math::simd::LookupTable;

    fn prepared(keys: &str, numbers: &[f64]) -> ArrayTexture {
        let mut texture: ArrayTexture =
            scene::yaml::from_str(&format!("{{ name: a{keys} }}")).unwrap();
        texture.prepare(numbers, Transfer::Linear);
        texture
    }

    /// Checks that a number has the map's color at this position.
    fn assert_shows(texture: &ArrayTexture, number: f64, position: f64) {
        let found = texture.table.values_at([texture.table.stored(number)]);
        let expected = texture.map.at(position).map(|channel| channel as f32);
        let is_near = |(a, b): (f32, f32)| (a - b).abs() < 0.01;
        let all_near = found.into_iter().zip(expected).all(is_near);
        assert!(all_near, "{number}: {found:?}, expected {expected:?}");
    }

    #[test]
    fn numbers_have_the_colors_of_their_positions() {
        let numbers = [3.0, f64::NAN, -1.0, f64::INFINITY, 7.0];
        let texture = prepared(", map: viridis, nan_color: [1, 0, 0]", &numbers);
        assert_eq!(texture.table.ends, [-1.0, 7.0]);
        for (number, position) in [
            (-1.0, 0.0),
            (3.0, 0.5),
            (7.0, 1.0),
            (-1e30, 0.0),
            (1e30, 1.0),
        ] {
            assert_shows(&texture, number, position);
        }
        assert_shows(&texture, f64::INFINITY, 1.0);
        assert_shows(&texture, f64::NEG_INFINITY, 0.0);
        assert_eq!(texture.table.values_at([f32::NAN]), [1.0, 0.0, 0.0]);
        let given = prepared(", range: [0, 4]", &numbers);
        assert_eq!(
            (given.table.ends, given.table.clips),
            ([0.0, 4.0], [true, true])
        );
    }

    #[test]
    fn a_logarithmic_scale_has_equal_ratios() {
        let texture = prepared(", map: magma, scale: log", &[-5.0, 0.0, 0.01, 100.0]);
        assert_eq!(texture.table.ends, [0.01, 100.0]);
        for (number, position) in [
            (0.01, 0.0),
            (1.0, 0.5),
            (100.0, 1.0),
            (0.0, 0.0),
            (-5.0, 0.0),
        ] {
            assert_shows(&texture, number, position);
        }
    }

    #[test]
    fn quantiles_leave_out_the_extremes() {
        let mut numbers: Vec<f64> = (0..1000).map(f64::from).collect();
        numbers.extend([1e9, -1e9]);
        let [low, high] = prepared(", range: quantiles", &numbers).table.ends;
        assert!(
            (0.0..20.0).contains(&low) && (980.0..1000.0).contains(&high),
            "{low} {high}"
        );
    }

    #[test]
    fn bands_are_steps_of_equal_width() {
        let texture = prepared(
            ", map: { bands: [0, 0.5, 1] }, scale: log, range: [1, 8]",
            &[],
        );
        for (number, gray) in [
            (0.1, 0.0),
            (1.9, 0.0),
            (2.1, 0.5),
            (3.9, 0.5),
            (4.1, 1.0),
            (8.0, 1.0),
            (9.0, 1.0),
        ] {
            assert_eq!(texture.table.values_at([number]), [gray; 3], "{number}");
        }
    }

    #[test]
    fn categories_have_the_colors_in_turn() {
        let texture = prepared(", map: set1", &[0.0, 20.0]);
        let of = |number: f32| texture.table.values_at([number]);
        assert_eq!([of(0.4), of(9.0), of(-8.9)], [of(0.0); 3]);
        assert_ne!(of(1.0), of(0.0));
    }

    #[test]
    fn a_color_bar_lists_the_categories_of_the_data() {
        let numbers = [3.2, -1.0, 2.7, f64::NAN, f64::INFINITY, 7.0, -0.2];
        let texture = prepared(", map: set1, bar: rank", &numbers);
        assert_eq!(texture.table.categories, [-1, 0, 3, 7]);
        assert!(
            prepared(", map: set1", &numbers)
                .table
                .categories
                .is_empty()
        );
        let many: Vec<f64> = (0..1000).rev().map(f64::from).collect();
        let table = &prepared(", map: set1, bar: rank", &many).table;
        let listed = table.categories.iter().copied();
        assert!(listed.eq(0..MAX_LISTED as i64));
    }

    #[test]
    fn one_number_or_none_has_a_range_too() {
        for scale in ["linear", "log"] {
            for numbers in [
                &[][..],
                &[5.0],
                &[5.0; 3],
                &[f64::NAN],
                &[-1.0],
                &[f32::MAX.into(); 2],
            ] {
                let [low, high] = prepared(&format!(", scale: {scale}"), numbers).table.ends;
                assert!(low < high, "{scale} {numbers:?}: {low} {high}");
            }
        }
        assert_shows(&prepared("", &[5.0]), 5.0, 0.5);
    }

    /// Pressures, seconds since 1970, Julian dates: the offset is more than a million times the range.
    #[test]
    fn a_large_offset_changes_no_color() {
        let numbers: Vec<f64> = (0..=1000).map(|i| f64::from(i) / 1000.0).collect();
        for keys in [
            "",
            ", range: quantiles",
            ", scale: log",
            ", map: { bands: [0, 0.5, 1] }",
        ] {
            for (offset, span) in [
                (101_325.0, 0.02),
                (1.7e9, 60.0),
                (-2.4603105e6, 1.0),
                (3e14, 1000.0),
            ] {
                if offset < 0.0 && keys.contains("log") {
                    continue;
                }
                let far: Vec<f64> = numbers
                    .iter()
                    .map(|number| offset + span * number)
                    .collect();
                let [near_table, far_table] = [(&numbers, ", range: [0, 1]"), (&far, keys)]
                    .map(|(numbers, keys)| prepared(keys, numbers).table);
                if keys.is_empty() {
                    for (near, far) in numbers.iter().zip(&far) {
                        let near = near_table.values_at([near_table.stored(*near)]);
                        let far = far_table.values_at([far_table.stored(*far)]);
                        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() < 0.01;
                        assert!(near.iter().zip(&far).all(is_near), "{near:?} {far:?}");
                    }
                }
                let mut colors: Vec<_> = far
                    .iter()
                    .map(|number| {
                        far_table
                            .values_at([far_table.stored(*number)])
                            .map(f32::to_bits)
                    })
                    .collect();
                colors.dedup();
                let n = if keys.contains("bands") { 3 } else { 250 };
                assert!(colors.len() >= n, "{keys} {offset}: {}", colors.len());
            }
        }
    }

    #[test]
    fn large_identifiers_keep_their_colors() {
        let first = 9_007_199_254_740_000.0;
        for numbers in [
            vec![20_000_000.0, 20_000_001.0, 20_000_003.0],
            vec![0.0, 1.0, 20_000_001.0, 1e12 + 5.0, -7e12],
            vec![first, first + 1.0, first + 2.0],
        ] {
            let table = prepared(", map: set1, bar: id", &numbers).table;
            let n = table.colors.len() as i64;
            for number in numbers.iter().copied() {
                let expected = table.colors[(number as i64).rem_euclid(n) as usize];
                assert_eq!(
                    table.values_at([table.stored(number)]),
                    expected,
                    "{number}"
                );
            }
            let mut sorted: Vec<i64> = numbers.iter().map(|number| *number as i64).collect();
            sorted.sort_unstable();
            assert_eq!(table.categories, sorted);
            assert_eq!(table.values_at([table.stored(f64::NAN)]), table.nan_color);
        }
    }
}
