//! Angles in turns with their sines and cosines, bit-identical for single numbers and lanes.

use std::f32::consts::{FRAC_PI_4, TAU};

use super::real::Real;

/// Returns the cosine and the sine of an angle in turns, of magnitude below 2^20, within two units
/// in the last place of 1.
#[inline(always)]
pub fn cos_sin<R: Real>(turns: R) -> [R; 2] {
    let (quarter, half, one) = (turns.splat(0.25), turns.splat(0.5), turns.splat(1.0));
    let n_quarters = (turns.splat(4.0) * turns + half).floor();
    let [cos, sin] = polynomials((turns - n_quarters * quarter) * turns.splat(TAU));
    // 0 to 3.
    let quadrant = n_quarters - turns.splat(4.0) * (n_quarters * quarter).floor();
    let is_odd = quadrant.equals(one) | quadrant.equals(turns.splat(3.0));
    let [x, y] = [R::select(is_odd, sin, cos), R::select(is_odd, cos, sin)];
    let is_left = quadrant.equals(one) | quadrant.equals(turns.splat(2.0));
    let is_below = one.lt(quadrant);
    [R::select(is_left, -x, x), R::select(is_below, -y, y)]
}

/// Returns the cosine and the sine of an angle in eighths of a turn, from -1 to 1.
#[inline(always)]
pub fn cos_sin_of_eighths<R: Real>(eighths: R) -> [R; 2] {
    polynomials(eighths * eighths.splat(FRAC_PI_4))
}

/// Returns the angle of a vector (x, y) in turns, counterclockwise from the x axis, from -1/2 to
/// 1/2, within 1e-7; 0 for the zero vector.
#[inline(always)]
pub fn turns_of<R: Real>([x, y]: [R; 2]) -> R {
    let (zero, one) = (x.splat(0.0), x.splat(1.0));
    let (width, height) = (x.abs(), y.abs());
    let (least, most) = (width.min(height), width.max(height));
    let slope = R::select(zero.lt(most), least / most, zero);
    // Above the tangent of a sixteenth of a turn, reduce by an eighth.
    let is_wide = x.splat(0.414_213_57).lt(slope);
    let rest = R::select(is_wide, (slope - one) / (slope + one), slope);
    let turns = arc_tangent(rest) * x.splat(1.0 / TAU);
    let turns = R::select(is_wide, turns + x.splat(0.125), turns);
    let turns = R::select(width.lt(height), x.splat(0.25) - turns, turns);
    let turns = R::select(x.lt(zero), x.splat(0.5) - turns, turns);
    turns.flip_sign_by(y)
}

/// Returns the angle in radians with this tangent, of magnitude up to 0.42: a polynomial of
/// Moshier's Cephes library.
#[inline(always)]
fn arc_tangent<R: Real>(x: R) -> R {
    let square = x * x;
    let higher = parabola(square, [8.053_745e-2, -0.138_776_86, 0.199_777_1]);
    (higher * square - x.splat(0.333_329_5)) * square * x + x
}

/// Returns the cosine and the sine of an angle in radians, from -pi/4 to pi/4: the polynomials of
/// Moshier's Cephes library.
#[inline(always)]
fn polynomials<R: Real>(x: R) -> [R; 2] {
    let square = x * x;
    let sin = parabola(square, [-1.951_529_6e-4, 8.332_161e-3, -0.166_666_55]);
    let cos = parabola(square, [2.443_315_7e-5, -1.388_731_6e-3, 0.041_666_646]);
    [
        cos * square * square - x.splat(0.5) * square + x.splat(1.0),
        sin * square * x + x,
    ]
}

/// Returns `a x² + b x + c`.
#[inline(always)]
fn parabola<R: Real>(x: R, [a, b, c]: [f32; 3]) -> R {
    (x.splat(a) * x + x.splat(b)) * x + x.splat(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_and_sines_are_those_of_double_precision() {
        for i in -100_000_i32..=100_000 {
            let turns = i as f32 * 3.1e-5;
            let radians = f64::from(turns) * std::f64::consts::TAU;
            for (found, expected) in cos_sin(turns)
                .into_iter()
                .zip([radians.cos(), radians.sin()])
            {
                assert!(
                    (f64::from(found) - expected).abs() < 2.5e-7,
                    "{turns}: {found}"
                );
            }
        }
        let axes = [0.0, 0.25, 0.5, 0.75, 1.0].map(cos_sin::<f32>);
        assert_eq!(
            axes,
            [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]]
        );
        assert_eq!(cos_sin_of_eighths(-0.5_f32), cos_sin(-0.0625));
    }

    #[test]
    fn angles_are_those_of_double_precision() {
        for i in -50_000_i32..=50_000 {
            let radians = f64::from(i) * 1e-5 * std::f64::consts::TAU;
            for length in [1e-20, 1.0, 3e15] {
                let vector = [length * radians.cos(), length * radians.sin()].map(|x| x as f32);
                let [x, y] = vector.map(f64::from);
                let (found, expected) = (turns_of(vector), y.atan2(x) / std::f64::consts::TAU);
                assert!((f64::from(found) - expected).abs() < 1e-7, "{i}: {found}");
            }
        }
        let axes = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 0.0]];
        assert_eq!(axes.map(turns_of::<f32>), [0.0, 0.25, 0.5, -0.25, 0.0]);
    }
}
