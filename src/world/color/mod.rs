//! Radiance → the numbers of a picture.
//!
//! All light is linear: numbers are proportional to radiance, with the primaries of sRGB. A
//! [`Development`] turns it into a picture, as a darkroom does with a negative: exposure, a tone
//! curve, the transfer function of the display, and rounding to whole numbers.

mod aces;
mod agx;
mod levels;
mod srgb;
mod diverging;
mod tables;
mod map;
mod palette;
mod tone_curve;

use std::sync::LazyLock;

use glam::Vec3;

use base::keywords;
use levels::linear8;
pub use map::ColorMap;
pub use map::rgb8;
pub use palette::Palette;
pub use tone_curve::ToneCurve;

/// The conversion of radiance to the numbers of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Development {
    /// The factor of the radiance: 2 to the power of the exposure.
    gain: f32,
    curve: ToneCurve,
    transfer: Transfer,
}

keywords! {
    /// The function from linear light to the numbers of a picture.
    #[derive(Default, Hash)]
    pub enum Transfer {
        /// Of sRGB displays (IEC 61966-2-1)
        #[default]
        Srgb = "srgb",
        /// Numbers proportional to the light
        Linear = "linear",
    }
}

impl Development {
    /// Creates a development that exposes by `exposure` stops, each of which doubles the light.
    pub fn new(exposure: f32, curve: ToneCurve, transfer: Transfer) -> Self {
        Self {
            gain: libm::exp2f(exposure),
            curve,
            transfer,
        }
    }

    /// Returns the factor from radiance to light in the picture.
    pub fn gain(&self) -> f32 {
        self.gain
    }

    /// Converts radiance to a pixel of 8 bits per channel, rounded.
    pub fn rgb8(&self, radiance: Vec3) -> [u8; 3] {
        let mut numbers = [[0; 3]];
        self.develop8(&[radiance], &mut numbers);
        numbers[0]
    }

    /// Overwrites `numbers` with the developed `radiance` of all pixels, as [`rgb8`](Self::rgb8)
    /// does.
    pub fn develop8(&self, radiance: &[Vec3], numbers: &mut [[u8; 3]]) {
        let exposed = |radiance: &Vec3| self.gain * *radiance;
        let developed = |radiance: &Vec3| self.curve.displayed(exposed(radiance));
        // One loop per case, without decisions per pixel.
        match (self.curve, self.transfer) {
            (ToneCurve::None, Transfer::Linear) => {
                fill(radiance, numbers, |of| linear8(exposed(of)))
            }
            (_, Transfer::Linear) => fill(radiance, numbers, |of| linear8(developed(of))),
            (ToneCurve::None, Transfer::Srgb) => {
                let levels = srgb::levels();
                fill(radiance, numbers, |of| levels.encode(exposed(of)));
            }
            (_, Transfer::Srgb) => {
                let levels = srgb::levels();
                fill(radiance, numbers, |of| levels.encode(developed(of)));
            }
        }
    }

    /// Converts radiance to a pixel of 16 bits per channel, rounded.
    pub fn rgb16(&self, radiance: Vec3) -> [u16; 3] {
        let light = self.curve.displayed(self.gain * radiance);
        let encoded = |channel: f32| match self.transfer {
            Transfer::Srgb => srgb::encoded(channel.into()),
            Transfer::Linear => channel.into(),
        };
        // Conversions of floats saturate: NaN becomes 0.
        let level = |channel: f32| (65_535.0 * encoded(channel.clamp(0.0, 1.0))).round() as u16;
        light.to_array().map(level)
    }
}

impl Transfer {
    /// Returns the linear light of every 8-bit number.
    #[inline(always)]
    pub fn light_of_bytes(self) -> &'static [f32; 256] {
        match self {
            Self::Srgb => &LIGHT_OF_SRGB,
            Self::Linear => &LIGHT_OF_LINEAR,
        }
    }

    /// Converts linear light, clamped to 0..1, to 8-bit numbers, rounded.
    pub fn bytes(self, light: Vec3) -> [u8; 3] {
        match self {
            Self::Srgb => srgb::levels().encode(light),
            Self::Linear => linear8(light),
        }
    }

    /// Returns the linear light of a number from 0 to 1, extrapolated above 1.
    pub fn light(self, number: f32) -> f32 {
        match self {
            Self::Srgb => srgb::decoded(number.into()) as f32,
            Self::Linear => number,
        }
    }
}

static LIGHT_OF_SRGB: LazyLock<[f32; 256]> = LazyLock::new(|| light_of_bytes(Transfer::Srgb));
static LIGHT_OF_LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| light_of_bytes(Transfer::Linear));

fn light_of_bytes(transfer: Transfer) -> [f32; 256] {
    std::array::from_fn(|number| transfer.light(number as f32 / 255.0))
}

#[inline(always)]
fn fill<T>(pixels: &[T], numbers: &mut [[u8; 3]], of: impl Fn(&T) -> [u8; 3]) {
    for (numbers, pixel) in numbers.iter_mut().zip(pixels) {
        *numbers = of(pixel);
    }
}

/// sRGB without exposure or tone curve.
impl Default for Development {
    fn default() -> Self {
        Self::new(0.0, ToneCurve::default(), Transfer::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_doubles_the_light_before_the_curve() {
        for curve in [ToneCurve::None, ToneCurve::Agx, ToneCurve::Aces] {
            for transfer in [Transfer::Srgb, Transfer::Linear] {
                let [plain, brighter] = [0.0, 1.0].map(|ev| Development::new(ev, curve, transfer));
                for i in 0..200 {
                    let light = Vec3::new(0.003, 0.002, 0.001) * i as f32;
                    assert_eq!(brighter.rgb8(light), plain.rgb8(2.0 * light));
                    assert_eq!(brighter.rgb16(light), plain.rgb16(2.0 * light));
                }
            }
        }
    }

    #[test]
    fn both_depths_show_the_same_picture() {
        for transfer in [Transfer::Srgb, Transfer::Linear] {
            let development = Development::new(0.0, ToneCurve::None, transfer);
            for i in 0..=4000 {
                let light = Vec3::splat(i as f32 / 3900.0);
                let [few, ..] = development.rgb8(light);
                let [many, ..] = development.rgb16(light);
                let rounding = f32::from(many) / 257.0 - f32::from(few);
                assert!(rounding.abs() <= 0.502, "{light}: {few} and {many}");
            }
        }
    }

    #[test]
    fn what_no_display_shows_becomes_its_nearest_number() {
        for transfer in [Transfer::Srgb, Transfer::Linear] {
            let development = Development::new(0.0, ToneCurve::None, transfer);
            let light = Vec3::new(-1.0, f32::INFINITY, f32::NAN);
            assert_eq!(development.rgb8(light), [0, 255, 0]);
            assert_eq!(development.rgb16(light), [0, 65_535, 0]);
        }
    }
}
