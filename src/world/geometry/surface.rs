//! Points on the surfaces of shapes.

use glam::Vec3;

use math::simd::{Real, Vector};

/// Number of parameters that define a shape.
pub const N_PARAMETERS: usize = 9;

/// The projection onto a shape, for one point or for lanes of shapes and points.
pub trait Project {
    /// Returns the parameters that define the shape, padded with zeros.
    fn parameters(&self) -> [f32; N_PARAMETERS];

    /// Returns the point of the surface nearest to `near`, which lies on it up to rounding errors,
    /// and the outward unit normal there.
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>);

    /// Returns a bound of the distance between the surface and a point that
    /// [`project_onto`](Self::project_onto) found: proportional to the greatest coordinate or
    /// length that defines the shape.
    #[inline(always)]
    fn rounding<R: Real>(parameters: &[R; N_PARAMETERS], _point: Vector<R>) -> R {
        rounding_of(parameters)
    }

    /// Returns a bound of the same distance where the unit normal is known: for a flat shape,
    /// coordinates along the surface do not count.
    #[inline(always)]
    fn rounding_along<R: Real>(
        parameters: &[R; N_PARAMETERS],
        [point, _normal]: [Vector<R>; 2],
    ) -> R {
        Self::rounding(parameters, point)
    }

    /// Projects onto one shape, as [`project_onto`](Self::project_onto) does.
    #[inline]
    fn project(&self, near: Vec3) -> (Vec3, Vec3) {
        let (point, normal) = Self::project_onto(&self.parameters(), near.into());
        (point.into(), normal.into())
    }
}

/// Error bound of the surface formulas in units in the last place, 2^-24 of a number: a generous
/// multiple of the errors of sums with as many products.
const ROUNDING: f32 = 32.0 / 16_777_216.0;

/// Returns the rounding error bound of sums of products of these numbers with fractions.
#[inline(always)]
pub(crate) fn rounding_of<R: Real>(numbers: &[R]) -> R {
    let mut greatest = numbers[0].abs();
    for number in &numbers[1..] {
        greatest = greatest.max(number.abs());
    }
    greatest * greatest.splat(ROUNDING)
}

/// Returns the rounding error bound along a unit normal, for a point of the plane through `origin`:
/// each coordinate counts as far as the normal points along its axis.
#[inline(always)]
pub(super) fn rounding_of_plane<R: Real>(origin: Vector<R>, [point, normal]: [Vector<R>; 2]) -> R {
    let x = normal.x.abs() * origin.x.abs().max(point.x.abs());
    let y = normal.y.abs() * origin.y.abs().max(point.y.abs());
    let z = normal.z.abs() * origin.z.abs().max(point.z.abs());
    let sum = x + y + z;
    sum * sum.splat(ROUNDING)
}

/// Returns the vector of three parameters, starting at index `first`.
#[inline(always)]
pub(super) fn vector<R: Real>(parameters: &[R; N_PARAMETERS], first: usize) -> Vector<R> {
    Vector {
        x: parameters[first],
        y: parameters[first + 1],
        z: parameters[first + 2],
    }
}

/// Returns the parameters of up to three vectors.
#[inline(always)]
pub(super) fn parameters_of(vectors: &[Vec3]) -> [f32; N_PARAMETERS] {
    let mut parameters = [0.0; N_PARAMETERS];
    for (numbers, vector) in parameters.chunks_exact_mut(3).zip(vectors) {
        numbers.copy_from_slice(&vector.to_array());
    }
    parameters
}
