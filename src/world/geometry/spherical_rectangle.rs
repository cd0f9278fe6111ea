//! Rectangles as seen from a point: uniform sampling of their directions.
//!
//! Ureña, Fajardo and King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR
//! 2013.

use std::f32::consts::TAU;

use math::simd::{Real, Vector, cos_sin, turns_of};

/// A rectangle in the coordinates of its edges around a point, or one per lane.
pub(super) struct SphericalRectangle<R: Real> {
    /// Unit vectors along the edges, and from the rectangle to the point.
    axes: [Vector<R>; 3],
    /// The range along the first edge.
    x: [R; 2],
    /// The range along the second edge.
    y: [R; 2],
    /// The distance of the rectangle's plane.
    distance: R,
    /// The sum, in turns, of the angles at its start along the first edge, from which the solid
    /// angle is computed.
    first: R,
    /// The solid angle, in turns of a unit circle.
    turns: R,
}

impl<R: Real> SphericalRectangle<R> {
    /// Creates the rectangle with perpendicular edges at a corner, which is at `to_corner` from the
    /// point.
    #[inline(always)]
    pub(super) fn new(to_corner: Vector<R>, [u, v]: [Vector<R>; 2]) -> Self {
        // Express the rectangle in the axes of its edges.
        let (width, height) = (u.length(), v.length());
        let (right, up) = (u / width, v / height);
        let normal = right.cross(up);
        let depth = to_corner.dot(normal);
        let (left, lower) = (to_corner.dot(right), to_corner.dot(up));
        let (x, y) = ([left, left + width], [lower, lower + height]);
        let distance = depth.abs();
        // The solid angle is the difference of the angles at both ends.
        let first = corner(x[0], y[1], distance) - corner(x[0], y[0], distance);
        let last = corner(x[1], y[1], distance) - corner(x[1], y[0], distance);
        Self {
            axes: [right, up, -normal.flip_sign_by(depth)],
            x,
            y,
            distance,
            first,
            turns: last - first,
        }
    }

    /// Returns the density of uniform directions to it, per steradian.
    #[inline(always)]
    pub(super) fn density(&self) -> R {
        let least = self.turns.splat(f32::MIN_POSITIVE);
        self.turns.splat(1.0 / TAU) / self.turns.max(least)
    }

    /// Returns true if the solid angle is large enough for rounding errors not to matter: if it is
    /// small, uniform points on the surface are as good.
    #[inline(always)]
    pub(super) fn is_wide(&self) -> R::Mask {
        self.turns.splat(0.01 / TAU).lt(self.turns)
    }

    /// Samples a direction uniformly with two numbers in [0, 1); returns the vector to the
    /// rectangle's point.
    #[inline(always)]
    pub(super) fn way(&self, [u, v]: [R; 2]) -> Vector<R> {
        let (zero, one) = (u.splat(0.0), u.splat(1.0));
        let least = u.splat(f32::MIN_POSITIVE);
        let ([x0, x1], [y0, y1], distance) = (self.x, self.y, self.distance);
        // The plane through the point that has the share `u` of the solid angle to its left.
        let [cos, sin] = cos_sin(self.first + u * self.turns);
        let (lower, upper) = (sine(y0, distance), sine(y1, distance));
        let along = upper - cos * lower;
        let across = lower * sin;
        let cosine = sin.flip_sign_by(along) / (along * along + across * across).sqrt().max(least);
        let x = distance * cosine / (one - cosine * cosine).max(least).sqrt();
        let x = x.max(x0).min(x1);
        // The share `v` of the segment in that plane.
        let to_line = (x * x + distance * distance).sqrt();
        let (lower, upper) = (sine(y0, to_line), sine(y1, to_line));
        let height = lower + v * (upper - lower);
        let y = height * to_line / (one - height * height).max(least).sqrt();
        let y = y.max(y0).min(y1);
        let [right, up, toward] = self.axes;
        right * x + up * y + toward * (zero - distance)
    }
}

/// Returns the solid angle, in turns of a unit circle, of the rectangle between a point's foot on a
/// plane and this corner.
#[inline(always)]
fn corner<R: Real>(x: R, y: R, distance: R) -> R {
    let length = (x * x + y * y + distance * distance).sqrt();
    turns_of([distance * length, x * y])
}

/// Returns the sine of the angle at which a height is seen from a distance.
#[inline(always)]
fn sine<R: Real>(height: R, distance: R) -> R {
    let least = height.splat(f32::MIN_POSITIVE);
    height / (height * height + distance * distance).sqrt().max(least)
}
