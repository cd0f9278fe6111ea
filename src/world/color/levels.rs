//! Linear light → whole numbers.

use glam::Vec3;

/// Returns the color clamped to 0..1 and rounded to 8 bits per channel, without a transfer
/// function.
pub(super) fn linear8(color: Vec3) -> [u8; 3] {
    (color.clamp(Vec3::ZERO, Vec3::ONE) * 255.0)
        .to_array()
        .map(rounded)
}

/// Returns the integer nearest to a number from 0 to 255, halves rounded up, as `f32::round` does,
/// which is a function call on x86-64 without SSE 4.1.
#[inline(always)]
fn rounded(channel: f32) -> u8 {
    let whole = channel as u8;
    // The difference is exact: it is less than 1.
    whole + u8::from(channel - f32::from(whole) >= 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_equals_that_of_the_standard_library() {
        let halves = (0..255).map(|whole| whole as f32 + 0.5);
        let close = halves.flat_map(|half| [half.next_down(), half, half.next_up()]);
        let everywhere = (0..=255_000).map(|thousandth| thousandth as f32 / 1000.0);
        for channel in close.chain(everywhere) {
            assert_eq!(rounded(channel), channel.round() as u8, "{channel}");
        }
    }
}
