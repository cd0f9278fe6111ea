//! Tone curves: bright light → light that a display can show.

use glam::Vec3;

use super::{aces, agx};
use base::keywords;

keywords! {
    /// A function from exposed light to displayed light, both linear and with the primaries of sRGB.
    #[derive(Default)]
    pub enum ToneCurve {
        /// Light above 1 is cut off, channel by channel
        #[default]
        None = "none",
        /// AgX: 16.5 stops; bright colors fade to white
        Agx = "agx",
        /// The fit by Stephen Hill of ACES' reference and sRGB transforms
        Aces = "aces",
    }
}

impl ToneCurve {
    /// Returns the light that the display shows; channels may lie outside of 0 to 1.
    #[inline]
    pub(super) fn displayed(self, light: Vec3) -> Vec3 {
        match self {
            Self::None => light,
            Self::Agx => agx::displayed(light),
            Self::Aces => aces::displayed(light),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_light_is_brighter_and_gray_stays_gray() {
        for curve in [ToneCurve::Agx, ToneCurve::Aces] {
            let mut last = -1.0;
            for i in 0..=400 {
                let light = libm::exp2f(i as f32 / 20.0 - 12.0);
                let shown = curve.displayed(Vec3::splat(light));
                let spread = shown.max_element() - shown.min_element();
                assert!(spread < 2e-3, "{curve:?} shows gray {light} as {shown}");
                assert!(shown.y >= last, "{curve:?} at {light}");
                last = shown.y;
            }
            assert!((0.97..1.06).contains(&last), "{curve:?} ends at {last}");
        }
    }
}
