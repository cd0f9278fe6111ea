//! Points on the surfaces of shapes.

use glam::Vec3;

use math::simd::{Real, Vector};

/// Number of numbers that define a shape.
pub const N_PARAMETERS: usize = 9;

/// The projection onto a shape, for one point or for lanes of shapes and points.
pub trait Project {
    /// The numbers that define the shape, followed by zeros.
    fn parameters(&self) -> [f32; N_PARAMETERS];

    /// The point of the surface nearest to `near`, which lies on it up to rounding
    /// errors, and the outward unit normal there.
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>);

    /// A bound of the distance between the surface and a point that
    /// [`project_onto`](Self::project_onto) found: in proportion to the greatest coordinate or
    /// length that defines the shape.
    #[inline(always)]
    fn rounding<R: Real>(parameters: &[R; N_PARAMETERS], _point: Vector<R>) -> R {
        rounding_of(parameters)
    }

    /// [`project_onto`](Self::project_onto) of one shape.
    #[inline]
    fn project(&self, near: Vec3) -> (Vec3, Vec3) {
        let (point, normal) = Self::project_onto(&self.parameters(), near.into());
        (point.into(), normal.into())
    }
}

/// Units in the last place, 2^-24 of a number, that the formulas of surfaces may be off: a
/// generous multiple of what is found in sums of as many products.
const ROUNDING: f32 = 32.0 / 16_777_216.0;

/// The bound of the rounding errors of sums of products of these numbers with fractions.
#[inline(always)]
pub(crate) fn rounding_of<R: Real>(numbers: &[R]) -> R {
    let mut greatest = numbers[0].abs();
    for number in &numbers[1..] {
        greatest = greatest.max(number.abs());
    }
    greatest * greatest.splat(ROUNDING)
}

/// The vector of three parameters from index `first` on.
#[inline(always)]
pub(super) fn vector<R: Real>(parameters: &[R; N_PARAMETERS], first: usize) -> Vector<R> {
    Vector {
        x: parameters[first],
        y: parameters[first + 1],
        z: parameters[first + 2],
    }
}

/// The parameters of up to three vectors.
#[inline(always)]
pub(super) fn parameters_of(vectors: &[Vec3]) -> [f32; N_PARAMETERS] {
    let mut parameters = [0.0; N_PARAMETERS];
    for (numbers, vector) in parameters.chunks_exact_mut(3).zip(vectors) {
        numbers.copy_from_slice(&vector.to_array());
    }
    parameters
}
