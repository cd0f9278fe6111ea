//! Color maps: colors for numbers from 0 to 1, or for categories.

use super::{diverging, tables};
use base::keywords;

/// Number of colors of a named map for numbers, as matplotlib and VTK draw it.
const N_STEPS: f64 = 256.0;

/// Defines [`ColorMap`] and its colors from one list.
macro_rules! maps {
    (
        gradients { $($(#[doc = $doc:literal])* $kind:ident $name:literal = $gradient:ident,)* }
        categories { $($(#[doc = $about:literal])* $list:ident $word:literal = $colors:ident,)* }
    ) => {
        keywords! {
            /// Colors for numbers.
            #[derive(Default)]
            pub enum ColorMap {
                /// Blue, gray, red, as in ParaView
                #[default]
                CoolToWarm = "cool_to_warm",
                $($(#[doc = $doc])* $kind = $name,)*
                $($(#[doc = $about])* $list = $word,)*
            }
        }

        impl ColorMap {
            /// Returns red, green and blue at a position from 0 to 1, as sRGB numbers from 0 to 1.
            pub fn at(self, position: f64) -> [f64; 3] {
                match self {
                    Self::CoolToWarm => diverging::cool_to_warm(position),
                    $(Self::$kind => step_color(tables::$gradient, position),)*
                    $(Self::$list => channels(nearest(tables::$colors, position)),)*
                }
            }

            /// Returns the number of colors of a map for categories.
            pub fn n_categories(self) -> Option<usize> {
                match self {
                    $(Self::$list => Some(tables::$colors.len()),)*
                    _ => None,
                }
            }
        }
    };
}

maps! {
    gradients {
        /// Violet, green, yellow
        Viridis "viridis" = VIRIDIS,
        /// Black, red, pale yellow
        Inferno "inferno" = INFERNO,
        /// Black, purple, pale yellow
        Magma "magma" = MAGMA,
        /// Blue, purple, yellow
        Plasma "plasma" = PLASMA,
        /// Blue to yellow, for all kinds of color vision
        Cividis "cividis" = CIVIDIS,
        /// A rainbow of smooth lightness
        Turbo "turbo" = TURBO,
        /// Black to white through hues
        Cubehelix "cubehelix" = CUBEHELIX,
        /// White to black
        Greys "greys" = GREYS,
        /// White to blue
        Blues "blues" = BLUES,
        /// White to red
        Reds "reds" = REDS,
        /// Red, white, blue
        RedBlue "red_blue" = RED_BLUE,
        /// Orange, white, purple
        PurpleOrange "purple_orange" = PURPLE_ORANGE,
        /// Red, yellow, blue
        Spectral "spectral" = SPECTRAL,
    }
    categories {
        /// Ten categories
        Tableau10 "tableau10" = TABLEAU10,
        /// Nine strong colors
        Set1 "set1" = SET1,
        /// Eight soft colors
        Set2 "set2" = SET2,
        /// Twelve, in pairs
        Paired "paired" = PAIRED,
    }
}

/// Converts sRGB numbers to 8 bits each.
pub fn rgb8(color: [f64; 3]) -> [u8; 3] {
    color.map(|number| (255.0 * number).round() as u8)
}

/// Returns the color of the step that contains the position.
fn step_color(colors: &[u32], position: f64) -> [f64; 3] {
    let step = (position * N_STEPS).floor().clamp(0.0, N_STEPS - 1.0);
    let color = |i: usize| channels(&colors[i]);
    interpolated(colors.len(), color, step / (N_STEPS - 1.0))
}

fn channels(rgb: &u32) -> [f64; 3] {
    let [_, channels @ ..] = rgb.to_be_bytes();
    channels.map(|channel| f64::from(channel) / 255.0)
}

/// Returns the color at a position among `n` evenly spread colors.
pub(super) fn interpolated(n: usize, color: impl Fn(usize) -> [f64; 3], position: f64) -> [f64; 3] {
    let place = position.clamp(0.0, 1.0) * (n - 1) as f64;
    let first = (place as usize).min(n - 1);
    let [a, b] = [first, (first + 1).min(n - 1)].map(color);
    let share = place - first as f64;
    [0, 1, 2].map(|i| a[i] + share * (b[i] - a[i]))
}

/// Returns the color of the interval that contains the position, of `colors.len()` equal ones.
pub(super) fn nearest<T>(colors: &[T], position: f64) -> &T {
    let n = colors.len();
    &colors[((position * n as f64) as usize).min(n - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::Keyword;

    #[test]
    fn the_ends_of_cool_to_warm_are_those_of_paraview() {
        let bytes = |position| rgb8(ColorMap::CoolToWarm.at(position));
        assert_eq!(bytes(0.0), [59, 76, 192]);
        assert_eq!(bytes(0.5), [221, 221, 221]);
        assert_eq!(bytes(1.0), [180, 4, 38]);
    }

    /// The file has a row for each map for numbers of `matplotlib.colormaps`, in the order here, with
    /// the bytes of its 256 colors in matplotlib 3.11, which rounds down.
    #[test]
    fn maps_are_those_of_matplotlib() {
        let png = include_bytes!("matplotlib.png");
        let colors = image::load_from_memory(png).unwrap().into_rgb8();
        let is_for_numbers = |map: &&ColorMap| map.n_categories().is_none();
        let maps = ColorMap::KEYWORDS.iter().filter(is_for_numbers);
        let named: Vec<&ColorMap> = maps.skip(1).collect();
        assert_eq!(colors.dimensions(), (256, named.len() as u32));
        for (column, row, expected) in colors.enumerate_pixels() {
            for within in [0.01, 0.5, 0.99] {
                let found = rgb8(named[row as usize].at((f64::from(column) + within) / 256.0));
                let is_close = (0..3).all(|i| found[i].abs_diff(expected[i]) <= 1);
                assert!(is_close, "{row} at {column}: {found:?}, not {expected:?}");
            }
        }
    }

    #[test]
    fn each_position_has_a_color() {
        for map in ColorMap::KEYWORDS {
            for i in 0..=100 {
                let color = map.at(f64::from(i) / 100.0);
                assert!(color.iter().all(|x| (0.0..=1.0).contains(x)), "{map:?}");
            }
        }
    }
}
