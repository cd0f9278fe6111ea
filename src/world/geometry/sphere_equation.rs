//! The decision whether a ray hits a sphere, and where.

use math::simd::{Arithmetic, Vector};

/// The equation `a t^2 - 2 b t + c = 0` for the points where a ray's line meets a sphere.
///
/// Haines, Günther and Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray
/// Tracing Gems (2019), chapter 7: the discriminant is computed from the point of the line nearest
/// to the center, which avoids cancellation for small and distant spheres.
pub struct SphereEquation<R> {
    /// The squared length of the direction, and its reciprocal.
    a: (R, R),
    b: R,
    c: R,
    discriminant: R,
}

impl<R: Arithmetic> SphereEquation<R> {
    /// Creates the equation, given the vector from the ray's origin to the center, the squared
    /// radius, the direction and its [`squared_length`].
    #[inline(always)]
    pub fn new(to_center: Vector<R>, r2: R, direction: Vector<R>, a: (R, R)) -> Self {
        let b = to_center.dot(direction);
        // The vector from the line's nearest point to the center decides if it hits.
        let nearest = to_center - direction * (b * a.1);
        let discriminant = r2 - nearest.dot(nearest);
        let c = to_center.dot(to_center) - r2;
        Self {
            a,
            b,
            c,
            discriminant,
        }
    }

    /// Returns true if the line hits the sphere; otherwise the roots have no meaning.
    #[inline(always)]
    pub fn hits(&self) -> R::Mask {
        self.b.splat(0.0).le(self.discriminant)
    }

    /// Returns the ray's parameters where its line enters and leaves the sphere.
    #[inline(always)]
    pub fn roots(&self) -> (R, R) {
        let (a, inverse_a) = self.a;
        // Solve without cancellation.
        let q = self.b + (a * self.discriminant).sqrt().flip_sign_by(self.b);
        let (t0, t1) = (self.c / q, q * inverse_a);
        (t0.min(t1), t1.max(t0))
    }

    /// Returns the near root if it lies in front of the origin, else the far one.
    #[inline(always)]
    pub fn first(&self) -> R {
        let (near, far) = self.roots();
        R::select(near.splat(0.0).lt(near), near, far)
    }
}

/// Returns the squared length of a direction, and its reciprocal. Not as an array: the compiler would
/// pack an array of two numbers into an integer, and unpack it.
#[inline(always)]
pub fn squared_length<R: Arithmetic>(direction: Vector<R>) -> (R, R) {
    let a = direction.dot(direction);
    (a, a.splat(1.0) / a)
}
