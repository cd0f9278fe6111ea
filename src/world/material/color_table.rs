//! Tables of colors by number.

use math::simd::{DeviceTable, LookupTable};

/// Maximum number of categories that a color bar lists.
pub const MAX_LISTED: usize = 256;

/// A table of colors by number; see the module's documentation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColorTable {
    /// The numbers of the first and the last color.
    pub ends: [f64; 2],
    /// True if there are numbers below the first, and above the last.
    pub clips: [bool; 2],
    /// The categories among the numbers in ascending order, at most 256 of them; empty unless a
    /// color bar lists them.
    pub categories: Vec<i64>,
    /// The number that surfaces store as 0: their 32 bits then distinguish numbers that differ little.
    pub(super) offset: f64,
    /// True if surfaces store categories modulo the number of colors, since the offset does not
    /// suffice.
    pub(super) is_cyclic: bool,
    pub(super) is_log: bool,
    pub(super) choice: ColorChoice,
    /// Linear light.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) nan_color: [f32; 3],
}

/// The choice of a number's color in a table.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum ColorChoice {
    /// The color at the nearest of the equally spaced positions from 0 to 1.
    #[default]
    Nearest,
    /// The color of the interval of equal width.
    Band,
    /// The color of the nearest whole number, modulo the number of colors.
    Category,
}

impl LookupTable<1, 3> for ColorTable {
    #[inline]
    fn values_at(&self, [number]: [f32; 1]) -> [f32; 3] {
        if number.is_nan() {
            return self.nan_color;
        }
        let n = self.colors.len();
        let number = f64::from(number) + self.offset;
        // The casts saturate.
        let position = || self.position(number);
        let index = match self.choice {
            ColorChoice::Nearest => (position() * n.saturating_sub(1) as f64 + 0.5) as usize,
            ColorChoice::Band => (position() * n as f64) as usize,
            ColorChoice::Category => category(number).rem_euclid(n.max(1) as i64) as usize,
        };
        let last = self.colors.last().copied().unwrap_or([1.0; 3]);
        self.colors.get(index).copied().unwrap_or(last)
    }

    /// The number of colors, the choice, 1 if the scale is logarithmic, the bits of the offset and of
    /// both ends, the color of NaN, and the colors.
    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        if self.colors.is_empty() {
            return Err("an array without colors");
        }
        let [low, high] = self.ends;
        let doubles = [self.offset, low, high].map(f64::to_bits);
        let halves = doubles
            .into_iter()
            .flat_map(|bits| [bits as u32, (bits >> 32) as u32]);
        let colors = self.nan_color.iter().chain(self.colors.as_flattened());
        let head = [
            self.colors.len() as u32,
            self.choice as u32,
            self.is_log.into(),
        ];
        let words = head.into_iter().chain(halves);
        Ok(DeviceTable {
            function: "color_table",
            words: words
                .chain(colors.map(|channel| channel.to_bits()))
                .collect(),
        })
    }
}

/// Returns the category of a number: the whole number nearest to it.
pub(super) fn category(number: f64) -> i64 {
    // The cast saturates.
    number.round() as i64
}

impl ColorTable {
    /// Converts a number of an array to the number that surfaces store.
    pub fn stored(&self, number: f64) -> f32 {
        if self.is_cyclic && !number.is_nan() {
            let from_offset = category(number).saturating_sub(category(self.offset));
            from_offset.rem_euclid(self.colors.len() as i64) as f32
        } else {
            (number - self.offset) as f32
        }
    }

    /// Returns the position of a number between the ends; from 0 to 1 if it is between them.
    fn position(&self, number: f64) -> f64 {
        let [low, high] = self.ends;
        if self.is_log {
            let number = number.max(f64::MIN_POSITIVE);
            libm::log(number / low) / libm::log(high / low)
        } else {
            (number - low) / (high - low)
        }
    }
}
