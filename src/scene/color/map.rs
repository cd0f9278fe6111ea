//! Color maps: colors for numbers from 0 to 1, or for categories.

use clap::ValueEnum;

use super::{diverging, tables};
use base::deserialize_keywords;

/// Number of colors of a named map for numbers, as matplotlib and VTK draw it.
const N_STEPS: f64 = 256.0;

/// Defines [`ColorMap`] and its colors from one list.
macro_rules! maps {
    (
        gradients { $($(#[$doc:meta])* $kind:ident = $gradient:ident,)* }
        categories { $($(#[$of_list:meta])* $list:ident = $colors:ident,)* }
    ) => {
        /// Colors for numbers.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
        #[value(rename_all = "snake_case")]
        pub enum ColorMap {
            /// From blue over gray to red: ParaView's Cool to Warm
            #[default]
            CoolToWarm,
            $($(#[$doc])* $kind,)*
            $($(#[$of_list])* $list,)*
        }

        impl ColorMap {
            /// Returns red, green and blue at a position from 0 to 1, as sRGB numbers from 0 to 1.
            pub fn at(self, position: f64) -> [f64; 3] {
                match self {
                    Self::CoolToWarm => diverging::cool_to_warm(position),
                    $(Self::$kind => of_numbers(tables::$gradient, position),)*
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
        /// From violet over green to yellow
        Viridis = VIRIDIS,
        /// From black over red to pale yellow
        Inferno = INFERNO,
        /// From black over purple to pale yellow
        Magma = MAGMA,
        /// From blue over purple to yellow
        Plasma = PLASMA,
        /// From blue to yellow, for all kinds of color vision
        Cividis = CIVIDIS,
        /// A rainbow of smooth lightness
        Turbo = TURBO,
        /// From black to white in a spiral of hues
        Cubehelix = CUBEHELIX,
        /// From white to black
        Greys = GREYS,
        /// From white to blue
        Blues = BLUES,
        /// From white to red
        Reds = REDS,
        /// From red over white to blue: matplotlib's RdBu
        RedBlue = RED_BLUE,
        /// From orange over white to purple: matplotlib's PuOr
        PurpleOrange = PURPLE_ORANGE,
        /// From red over yellow to blue
        Spectral = SPECTRAL,
    }
    categories {
        /// Ten colors for categories
        Tableau10 = TABLEAU10,
        /// Nine strong colors for categories
        Set1 = SET1,
        /// Eight soft colors for categories
        Set2 = SET2,
        /// Twelve colors for categories, in pairs
        Paired = PAIRED,
    }
}

/// Converts sRGB numbers to 8 bits each.
pub fn rgb8(color: [f64; 3]) -> [u8; 3] {
    color.map(|number| (255.0 * number).round() as u8)
}

/// Returns the color of the step that contains the position.
fn of_numbers(colors: &[u32], position: f64) -> [f64; 3] {
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

deserialize_keywords!(ColorMap);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_cool_to_warm_are_those_of_paraview() {
        let bytes = |position| rgb8(ColorMap::CoolToWarm.at(position));
        assert_eq!(bytes(0.0), [59, 76, 192]);
        assert_eq!(bytes(0.5), [221, 221, 221]);
        assert_eq!(bytes(1.0), [180, 4, 38]);
    }

    /// `matplotlib.colormaps[NAME](k / 10)` for k from 0 to 10, in matplotlib 3.11.
    const MATPLOTLIB: [(&str, &str); 13] = [
        (
            "viridis",
            "440154 482475 414487 355f8d 2a788e 21918c 22a884 44bf70 7ad151 bddf26 fde725",
        ),
        (
            "inferno",
            "000004 160b39 420a68 6a176e 932667 bc3754 dd513a f37819 fca50a f6d746 fcffa4",
        ),
        (
            "magma",
            "000004 140e36 3b0f70 641a80 8c2981 b73779 de4968 f7705c fe9f6d fecf92 fcfdbf",
        ),
        (
            "plasma",
            "0d0887 41049d 6a00a8 8f0da4 b12a90 cc4778 e16462 f2844b fca636 fcce25 f0f921",
        ),
        (
            "cividis",
            "00224e 083370 35456c 4f576c 666970 7d7c78 948e77 aea371 c8b866 e5cf52 fee838",
        ),
        (
            "turbo",
            "30123b 4559cb 3e9bfe 19d5cd 46f884 a4fc3c e1dd37 fea431 f05b12 c32503 7a0403",
        ),
        (
            "cubehelix",
            "000000 1a142f 163d4e 1e6542 54792f a1794a d07e93 cf9ddb c1caf3 d3eeef ffffff",
        ),
        (
            "greys",
            "ffffff f3f3f3 e2e2e2 cecece b5b5b5 959595 7a7a7a 5f5f5f 404040 1d1d1d 000000",
        ),
        (
            "blues",
            "f7fbff e3eef9 d0e1f2 b7d4ea 94c4df 6aaed6 4a98c9 2e7ebc 1764ab 084a91 08306b",
        ),
        (
            "reds",
            "fff5f0 fee5d8 fdcab5 fcab8f fc8a6a fb694a f14432 d92523 bc141a 980c13 67000d",
        ),
        (
            "red_blue",
            "67001f b1182b d6604d f3a481 fddbc7 f6f7f7 d1e5f0 90c4dd 4393c3 2065ab 053061",
        ),
        (
            "purple_orange",
            "7f3b08 b25706 e08214 fcb761 fee0b6 f6f6f7 d8daeb b1aad1 8073ac 532687 2d004b",
        ),
        (
            "spectral",
            "9e0142 d43d4f f46d43 fdad60 fee08b ffffbe e6f598 aadca4 66c2a5 3387bc 5e4fa2",
        ),
    ];

    #[test]
    fn maps_are_those_of_matplotlib() {
        for (name, colors) in MATPLOTLIB {
            let map = ColorMap::from_str(name, false).unwrap();
            for (k, color) in colors.split(' ').enumerate() {
                let expected = rgb8(channels(&u32::from_str_radix(color, 16).unwrap()));
                let found = rgb8(map.at(k as f64 / 10.0));
                let is_close = (0..3).all(|i| found[i].abs_diff(expected[i]) <= 1);
                assert!(is_close, "{name} at {k}: {found:?}, not {expected:?}");
            }
        }
    }

    #[test]
    fn each_position_has_a_color() {
        for map in ColorMap::value_variants() {
            for i in 0..=100 {
                let color = map.at(f64::from(i) / 100.0);
                assert!(color.iter().all(|x| (0.0..=1.0).contains(x)), "{map:?}");
            }
        }
    }
}
