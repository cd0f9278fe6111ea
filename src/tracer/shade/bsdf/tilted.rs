//! Surfaces whose shading normal is tilted against the geometric normal.
//!
//! Formulas by the shading normal scatter a part of the light into the surface, where it would be
//! lost. As in Schüssler et al., "Microfacet-Based Normal Mapping for Robust Monte Carlo Path
//! Tracing", SIGGRAPH Asia 2017, this part is reflected once more, and none is lost. Where a mirror
//! would leave it close to the plane of the surface, and so double the light of a lamp that sets
//! behind a facet of a mesh, it is spread here: light from below is turned up to a height that is
//! greater by the reciprocal of the sine of the tilt, which takes the lowest to the normal. Solid
//! angles grow by the same factor, by Archimedes.

use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use math::simd::{Mask, Real, Vector};

/// Returns the scattering from a direction.
#[inline(always)]
pub(in crate::shade) fn evaluate<R: Real>(
    bsdf: impl Scatters,
    at: &Leaving<R>,
    boundary: &Boundary<R>,
    to_light: Vector<R>,
) -> Scattering<R> {
    let zero = to_light.x.splat(0.0);
    // Without a tilt, the formulas by the shading normal hold.
    let direct = bsdf.evaluate(at, boundary, to_light);
    let tilt = sine_of_tilt(at);
    if tilt.le(zero).all() {
        return direct;
    }
    // Light between the two planes is lost: it arrives after one more reflection.
    let height = to_light.dot(at.point.geometric_normal);
    let is_tilted = zero.lt(tilt);
    let is_between = is_tilted & (height * to_light.dot(at.point.normal)).lt(zero);
    let turned = turn(at, to_light, -height * tilt);
    let is_turned = is_tilted & zero.lt(height * turned.dot(at.point.normal));
    let none = Scattering::none(zero);
    let direct = Scattering::select(is_between, none, direct);
    // Add the light of the direction that is turned onto this one.
    let other = bsdf.evaluate(at, boundary, turned).scaled(tilt);
    Scattering::select(is_turned, direct.with(other), direct)
}

/// Chooses a direction.
#[inline(always)]
pub(in crate::shade) fn sample<R: Real>(
    bsdf: impl Scatters,
    at: &Leaving<R>,
    boundary: &Boundary<R>,
    numbers: [R; 2],
    lobe: R,
) -> Scattered<R> {
    // Sample by the shading normal.
    let chosen = bsdf.sample(at, boundary, numbers, lobe);
    let (zero, one) = (lobe.splat(0.0), lobe.splat(1.0));
    let tilt = sine_of_tilt(at);
    if tilt.le(zero).all() {
        return chosen;
    }
    // Find the lanes whose direction is on the wrong side of the surface.
    let side = R::select(chosen.is_refracted, -one, one);
    let cos = side * chosen.direction.dot(at.point.normal);
    let height = chosen.direction.dot(at.point.geometric_normal);
    let is_candidate = zero.lt(tilt) & zero.lt(cos);
    let is_lost = is_candidate & (side * height).lt(zero);
    // Turn those directions up; for the others, find the direction that would turn to them.
    let least = tilt.max(one.splat(f32::MIN_POSITIVE));
    let to = R::select(
        is_lost,
        (height.abs() / least).min(one) * side,
        -height * tilt,
    );
    let turned = turn(at, chosen.direction, to);
    let is_found = is_candidate & zero.lt(side * turned.dot(at.point.normal));
    // Add the densities of both ways to choose the direction.
    let of_turned = bsdf.evaluate(at, boundary, turned).density;
    let density = R::select(
        is_lost,
        chosen.density * tilt + of_turned,
        chosen.density + of_turned * tilt,
    );
    Scattered {
        direction: Vector::select(is_lost, turned, chosen.direction),
        density: R::select(is_found, density, chosen.density),
        ..chosen
    }
}

/// Returns the sine of the angle between the normals, 0 where they are equal.
#[inline(always)]
fn sine_of_tilt<R: Real>(at: &Leaving<R>) -> R {
    let chord = at.point.normal - at.point.geometric_normal;
    let chord2 = chord.dot(chord);
    let one = chord2.splat(1.0);
    (chord2 * (one - chord2 * one.splat(0.25)).max(one.splat(0.0))).sqrt()
}

/// Returns a direction turned about an axis in the plane of the surface, so that its cosine with
/// the geometric normal is `height`.
#[inline(always)]
fn turn<R: Real>(at: &Leaving<R>, direction: Vector<R>, height: R) -> Vector<R> {
    let (zero, one) = (height.splat(0.0), height.splat(1.0));
    let normal = at.point.geometric_normal;
    let before = direction.dot(normal);
    let along = direction - normal * before;
    let length2 = along.dot(along).max(one.splat(1e-12));
    let scale = ((one - height * height).max(zero) / length2).sqrt();
    along * scale + normal * height
}
