//! Numbers in 16 bits.

/// A number from 0 to 65504 as a half float (IEEE 754), within 2^-12 of it from 2^-14 on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Half(u16);

/// 2^112, the ratio of the biases of the exponents: bits of a half, moved to the place of a float's,
/// are those of the float divided by it.
const SCALE: f32 = f32::from_bits((127 + 112) << 23);

/// Bits that the fraction of a float has more than that of a half.
const N_MORE_BITS: u32 = 13;

impl Half {
    /// Rounds a number; of two that are equally near, to the even one.
    pub(super) fn nearest(number: f32) -> Self {
        let bits = (number / SCALE).to_bits();
        let below_half = (1 << (N_MORE_BITS - 1)) - 1;
        let is_odd = (bits >> N_MORE_BITS) & 1;
        Self(((bits + below_half + is_odd) >> N_MORE_BITS) as u16)
    }

    /// Returns the number. Two operations, unlike in crates that ask which instructions the processor
    /// has.
    #[inline(always)]
    pub(super) fn get(self) -> f32 {
        f32::from_bits(u32::from(self.0) << N_MORE_BITS) * SCALE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_nearest_halves() {
        for (number, bits) in [
            (0.0, 0),
            (1.0, 0x3c00),
            (1.0 / 3.0, 0x3555),
            (65504.0, 0x7bff),
            // The least one, the least normal one, and numbers between two.
            (2_f32.powi(-24), 1),
            (2_f32.powi(-14), 0x400),
            (1.0 + 2_f32.powi(-11), 0x3c00),
            (1.0 + 3.0 * 2_f32.powi(-11), 0x3c02),
        ] {
            assert_eq!(Half::nearest(number), Half(bits), "{number}");
        }
        for bits in 0..0x7c00 {
            assert_eq!(Half::nearest(Half(bits).get()), Half(bits));
        }
    }
}
