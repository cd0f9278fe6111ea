//! Converts the points of a piece to placements of instances.

use glam::Vec3;

use super::super::Result;
use super::super::places::{InstancePlace, PlaceArrays};
use super::budget::Budget;
use super::piece::{GHOSTS, Piece};
use super::points::{at_point, of_points};
use world::material::ArrayChoice;

/// Adds a placement for each point, except for hidden points and copies of other pieces' points.
///
/// # Errors
/// An array is missing or has values of cells, or positions are not finite.
pub(super) fn add(
    piece: &Piece,
    arrays: PlaceArrays,
    places: &mut Vec<InstancePlace>,
    budget: &mut Budget,
) -> Result<()> {
    let n = piece.n_points();
    budget.take_of::<[f32; 48]>(n)?;
    // Find the numbers, scales and directions at the points.
    let numbers = |array: Option<&ArrayChoice>| -> Result<Option<Vec<f64>>> {
        array.map(|array| of_points(piece, array)).transpose()
    };
    let (scalars, scales) = (numbers(arrays.color)?, numbers(arrays.scale)?);
    let component =
        |of, component| of_points(piece, &ArrayChoice::point_array(of, Some(component)));
    let directions = match arrays.orient {
        None => None,
        Some(of) => Some([component(of, 0)?, component(of, 1)?, component(of, 2)?]),
    };
    let ghosts = piece.point_data.get(GHOSTS);
    // Add the visible points.
    for point in 0..n {
        if ghosts.is_some_and(|ghosts| ghosts.at(point) != 0.0) {
            continue;
        }
        let position = piece.position(point);
        let direction = directions
            .as_ref()
            .map(|of| of.each_ref().map(|of| of[point] as f32));
        places.push(InstancePlace {
            position: position.map_err(|fault| fault.at(at_point(point)))?,
            scale: Vec3::splat(scales.as_ref().map_or(1.0, |scales| scales[point] as f32)),
            direction: direction.map_or(Vec3::ZERO, Vec3::from),
            scalar: scalars.as_ref().map_or(f64::NAN, |scalars| scalars[point]),
        });
    }
    Ok(())
}
