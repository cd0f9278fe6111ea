//! The transfer function of sRGB (IEC 61966-2-1).

use std::sync::LazyLock;

use glam::Vec3;

/// Encodes linear light as an sRGB number, both from 0 to 1.
pub(super) fn encoded(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * libm::pow(light, 1.0 / 2.4) - 0.055
    }
}

/// Decodes an sRGB number to linear light, both from 0 to 1.
pub(super) fn decoded(number: f64) -> f64 {
    if number <= 0.040_45 {
        number / 12.92
    } else {
        libm::pow((number + 0.055) / 1.055, 2.4)
    }
}

/// Returns the table of levels of linear light.
///
/// Three powers would take longer than tracing a ray, so levels are looked up.
pub(super) fn levels() -> &'static Levels {
    &LEVELS
}

/// Light below this has level 0.
const DARKEST: f32 = 1.0 / 8192.0;

/// The largest number below 1.
const BRIGHTEST: f32 = 1.0 - f32::EPSILON / 2.0;

/// Numbers that differ only in this many low bits share a bucket: 128 buckets per power of two, so
/// that no bucket has more than two levels.
const BUCKET_BITS: u32 = f32::MANTISSA_DIGITS - 1 - 7;

/// Numbers in a bucket.
const BUCKET: u32 = 1 << BUCKET_BITS;

const N_BUCKETS: usize = ((1_f32.to_bits() - DARKEST.to_bits()) >> BUCKET_BITS) as usize;

static LEVELS: LazyLock<Levels> = LazyLock::new(Levels::new);

/// Maps linear light to the nearest of 256 levels: 255 times [`encoded`], rounded. Light is clamped
/// to 0..1; NaN becomes 0.
///
/// A bucket has the level of its first number in the high bits. The low bits are such that the sum
/// with the low bits of a number carries from the least light of the next level on.
pub(super) struct Levels([u32; N_BUCKETS]);

impl Levels {
    fn new() -> Self {
        let least: [_; 256] = std::array::from_fn(|level| least_light(level).to_bits());
        let begins = (DARKEST.to_bits()..).step_by(BUCKET as usize);
        let mut buckets = [0; N_BUCKETS];
        for (bucket, begin) in buckets.iter_mut().zip(begins) {
            let next = least.partition_point(|&light| light <= begin);
            let to_next = least.get(next).map_or(BUCKET, |light| light - begin);
            *bucket = ((next as u32 - 1) << BUCKET_BITS) + BUCKET - to_next.min(BUCKET);
        }
        Self(buckets)
    }

    /// Returns the levels of the channels.
    #[inline(always)]
    pub(super) fn encode(&self, light: Vec3) -> [u8; 3] {
        [
            self.level(light.x),
            self.level(light.y),
            self.level(light.z),
        ]
    }

    #[inline(always)]
    fn level(&self, light: f32) -> u8 {
        // One instruction each; NaN becomes the darkest.
        let light = if light > DARKEST { light } else { DARKEST };
        let light = if light < BRIGHTEST { light } else { BRIGHTEST };
        let bits = light.to_bits() - DARKEST.to_bits();
        let bucket = self.0[(bits >> BUCKET_BITS) as usize];
        ((bucket + bits % BUCKET) >> BUCKET_BITS) as u8
    }
}

/// Returns the least light whose rounded level is `level`.
fn least_light(level: usize) -> f32 {
    if level == 0 {
        return 0.0;
    }
    let half = level as f64 - 0.5;
    let reaches = |light: f32| 255.0 * encoded(light.into()) >= half;
    let mut light = decoded(half / 255.0) as f32;
    while reaches(light.next_down()) {
        light = light.next_down();
    }
    while !reaches(light) {
        light = light.next_up();
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(light: f32) -> u8 {
        (255.0 * encoded(light.clamp(0.0, 1.0).into())).round() as u8
    }

    #[test]
    fn levels_are_the_rounded_function() {
        let thresholds = (0..256).map(least_light);
        let close = thresholds.flat_map(|light| [light.next_down(), light, light.next_up()]);
        let everywhere = (0..0x3f90_0000_u32).step_by(997).map(f32::from_bits);
        for light in close.chain(everywhere).chain([f32::INFINITY, -1.0]) {
            assert_eq!(LEVELS.level(light), rounded(light), "{light}");
        }
        assert_eq!(LEVELS.level(f32::NAN), 0);
    }

    #[test]
    fn no_bucket_has_more_than_two_levels() {
        let first = LEVELS.0.map(|bucket| bucket >> BUCKET_BITS);
        assert!(first.windows(2).all(|pair| pair[1] - pair[0] <= 1));
    }

    #[test]
    fn the_function_is_that_of_the_standard() {
        // Table of the standard's 8-bit numbers and their light, to six digits.
        for (number, light) in [
            (10, 0.003_035),
            (11, 0.003_347),
            (55, 0.038_204),
            (118, 0.181_164),
            (188, 0.502_886),
            (254, 0.991_102),
        ] {
            let number = f64::from(number) / 255.0;
            assert!((decoded(number) - light).abs() < 5e-7);
            assert!((encoded(decoded(number)) - number).abs() < 1e-6);
        }
        assert_eq!([encoded(0.0), decoded(0.0)], [0.0; 2]);
        assert!((encoded(1.0) - 1.0).abs() < 1e-15);
    }
}
