//! Points of render space → points of files, in world space.

use glam::Vec3;

use vtk::array::Array;
use world::geometry::{LENGTH_UNIT, RenderSpace};

/// Returns the array of `n` points: 64-bit if the coordinates in world space need more than 32
/// bits.
pub(super) fn points<'a, I: Iterator<Item = Vec3> + 'a>(
    space: &RenderSpace,
    n: usize,
    points: impl Fn() -> I + Sync + 'a,
) -> Array<'a> {
    let space = *space;
    let array = if space.is_centered() {
        Array::new("Points", n, move || {
            points().map(move |point| space.world_point(point).as_vec3().to_array())
        })
    } else {
        Array::new("Points", n, move || {
            points().map(move |point| space.world_point(point).to_array())
        })
    };
    array.in_unit(LENGTH_UNIT)
}
