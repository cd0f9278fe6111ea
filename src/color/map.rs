//! Color maps: colors for numbers from 0 to 1, or for categories.

use clap::ValueEnum;
use serde::{Deserialize, Deserializer};

use super::diverging;
use crate::text;

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
            /// Red, green and blue at a position from 0 to 1, as numbers of sRGB from 0 to 1.
            pub fn at(self, position: f64) -> [f64; 3] {
                match self {
                    Self::CoolToWarm => diverging::cool_to_warm(position),
                    $(Self::$kind => numbers(colorous::$gradient.eval_continuous(position)),)*
                    $(Self::$list => {
                        let n = colorous::$colors.len();
                        numbers(colorous::$colors[((position * n as f64) as usize).min(n - 1)])
                    })*
                }
            }

            /// Number of its colors, if it is one of categories.
            pub fn n_categories(self) -> Option<usize> {
                match self {
                    $(Self::$list => Some(colorous::$colors.len()),)*
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
        /// From red over white to blue
        RedBlue = RED_BLUE,
        /// From purple over white to orange
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

fn numbers(color: colorous::Color) -> [f64; 3] {
    color.into_array().map(|channel| f64::from(channel) / 255.0)
}

impl<'de> Deserialize<'de> for ColorMap {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        text::keyword(d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_cool_to_warm_are_those_of_paraview() {
        let bytes = |position| {
            ColorMap::CoolToWarm
                .at(position)
                .map(|x| (255.0 * x).round())
        };
        assert_eq!(bytes(0.0), [59.0, 76.0, 192.0]);
        assert_eq!(bytes(0.5), [221.0, 221.0, 221.0]);
        assert_eq!(bytes(1.0), [180.0, 4.0, 38.0]);
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
