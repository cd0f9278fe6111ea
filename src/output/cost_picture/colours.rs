//! Inferno over a logarithmic range: dark for cheap, light for dear, monotone in lightness. For
//! changes ColorBrewer's blue and red, light in the middle: blue for cheaper, red for dearer.

use image::Rgb;

use super::range::{Range, Scale};

/// Of pixels without a value on the scale; no scale has this grey.
pub const NO_VALUE: Rgb<u8> = Rgb([128; 3]);

/// The colours of a range of values.
///
/// The bits of positive floats sort like the floats, so a table over equal pieces of a logarithmic
/// range's bits replaces one logarithm a pixel. A piece spans less than a fifth of a colour's share,
/// so that both ways give the same picture; a test compares them.
pub struct Colours {
    range: Range,
    /// Equal steps of position from 0 to 1.
    ladder: Vec<Rgb<u8>>,
    /// Empty where the scale is not logarithmic.
    by_piece: Vec<Rgb<u8>>,
    low_bits: u32,
    high_bits: u32,
    /// Binary logarithm of the number of floats in a piece.
    piece_log2: u32,
}

impl Colours {
    /// The scale's first colour at `range.low`, its last at `range.high`.
    pub fn over(range: &Range) -> Self {
        let (low_bits, high_bits) = ((range.low as f32).to_bits(), (range.high as f32).to_bits());
        let mut colours = Self {
            range: *range,
            ladder: ladder(range.scale),
            by_piece: Vec::new(),
            low_bits,
            high_bits,
            piece_log2: 0,
        };
        if range.scale == Scale::Logarithmic {
            colours.fill_pieces();
        }
        colours
    }

    fn fill_pieces(&mut self) {
        let (low_bits, high_bits) = (self.low_bits, self.high_bits);
        let n_floats = high_bits - low_bits + 1;
        self.piece_log2 = (n_floats / N_PIECES).checked_ilog2().unwrap_or(0);
        let middle = (1 << self.piece_log2) / 2;
        self.by_piece = (low_bits..=high_bits)
            .step_by(1 << self.piece_log2)
            .map(|bits| f32::from_bits((bits + middle).min(high_bits)))
            .map(|value| self.at(self.range.position(value.into()) as f32))
            .collect();
    }

    /// The colour of one value; that of the nearer end outside the range.
    pub fn of(&self, value: f32) -> Rgb<u8> {
        if !self.range.can_show(value) {
            return NO_VALUE;
        }
        if self.by_piece.is_empty() {
            return self.at(self.range.position(value.into()) as f32);
        }
        let bits = value.to_bits().clamp(self.low_bits, self.high_bits);
        self.by_piece[((bits - self.low_bits) >> self.piece_log2) as usize]
    }

    /// The colour at `position` between the range's low (0) and high (1) end.
    pub fn at(&self, position: f32) -> Rgb<u8> {
        let step = position * (N_COLOURS - 1) as f32;
        // The cast saturates: below the range to 0.
        self.ladder[((step + 0.5) as usize).min(N_COLOURS - 1)]
    }
}

/// A scale's colours in equal steps.
fn ladder(scale: Scale) -> Vec<Rgb<u8>> {
    let colour = |i| match scale {
        Scale::Logarithmic => colorous::INFERNO.eval_rational(i, N_COLOURS),
        Scale::AroundZero => colorous::RED_BLUE.eval_rational(N_COLOURS - 1 - i, N_COLOURS),
    };
    (0..N_COLOURS)
        .map(|i| Rgb(colour(i).into_array()))
        .collect()
}

/// Finer than 8 bits can tell apart, so that the bar shows no bands of its own.
const N_COLOURS: usize = 1024;
/// At most twice as many pieces are made: 96 KiB of colours.
const N_PIECES: u32 = 1 << 14;

#[cfg(test)]
mod tests {
    use super::*;

    fn inferno(t: f64) -> Rgb<u8> {
        Rgb(colorous::INFERNO.eval_continuous(t).into_array())
    }

    #[test]
    fn the_ends_have_the_end_colours() {
        for (low, high) in [(1.0, 2.0), (100.0, 101.5), (37.0, 9.1e6), (2e-38, f32::MAX)] {
            let colours = Colours::over(&Range::of(&[low, high]));
            assert_eq!(
                [colours.of(low), colours.of(high)],
                [inferno(0.0), inferno(1.0)]
            );
            assert_eq!(
                [colours.at(0.0), colours.at(1.0)],
                [inferno(0.0), inferno(1.0)]
            );
        }
    }

    #[test]
    fn values_and_positions_agree() {
        let range = Range::of(&[20.0, 70_000.0]);
        let colours = Colours::over(&range);
        for i in 0..=200 {
            let position = f64::from(i) / 200.0;
            let value = range.low * (range.high / range.low).powf(position);
            let apart = |a: Rgb<u8>, b: Rgb<u8>| (0..3).map(|c| a[c].abs_diff(b[c])).max();
            assert!(apart(colours.of(value as f32), colours.at(position as f32)) <= Some(2));
            assert!(apart(colours.of(value as f32), inferno(position)) <= Some(2));
        }
    }

    #[test]
    fn dearer_is_lighter() {
        let colours = Colours::over(&Range::of(&[1.0, 1e6]));
        let lightness = |v: f32| colours.of(v).0.into_iter().map(u32::from).sum::<u32>();
        let ladder: Vec<u32> = (0..20)
            .map(|i| lightness(10f32.powf(i as f32 * 0.3)))
            .collect();
        assert!(ladder.is_sorted_by(|a, b| a < b), "{ladder:?}");
    }

    #[test]
    fn cheaper_is_blue_and_dearer_is_red() {
        let colours = Colours::over(&Range::on(Scale::AroundZero, &[-50.0, 20.0]));
        let [cheaper, same, dearer] = [-50.0, 0.0, 50.0].map(|change| colours.of(change).0);
        assert!(cheaper[2] > 2 * cheaper[0] && dearer[0] > 2 * dearer[2]);
        assert!(same.iter().all(|&channel| channel > 230), "{same:?}");
        assert_eq!([colours.of(-1e9).0, colours.of(1e9).0], [cheaper, dearer]);
        assert_eq!(colours.of(f32::NAN), NO_VALUE);
    }

    #[test]
    fn outside_the_scale_is_grey() {
        let colours = Colours::over(&Range::of(&[1.0, 10.0]));
        for value in [f32::NAN, f32::INFINITY, -f32::INFINITY, 0.0, -1.0, 1e-40] {
            assert_eq!(colours.of(value), NO_VALUE);
        }
        assert_eq!(
            [colours.of(0.5), colours.of(20.0)],
            [inferno(0.0), inferno(1.0)]
        );
    }
}
