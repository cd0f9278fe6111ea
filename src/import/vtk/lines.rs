//! Converts the lines of a piece to tubes.

use super::super::Result;
use super::super::tubes::Tubes;
use super::RadiusChoice;
use super::array_of_pieces::ArrayOfPieces;
use super::budget::Budget;
use super::piece::{GHOSTS, Piece, Topology};
use super::points::{Radii, at_point};
use world::geometry::Sphere;
use world::material::{ArrayChoice, ArrayOf};

/// Adds a tube for each line, except for hidden lines and copies of other pieces' lines.
///
/// # Errors
/// An array is missing, a radius is invalid, or there are too many lines for the memory.
pub(super) fn add(
    piece: &Piece,
    radius: &RadiusChoice,
    (array, numbers): (Option<&ArrayChoice>, &mut ArrayOfPieces),
    tubes: &mut Tubes,
    budget: &mut Budget,
) -> Result<()> {
    let Topology::Cells(cells) = &piece.topology else {
        return Ok(());
    };
    if tubes.arrays.is_empty() {
        tubes.arrays = piece.color_arrays();
    }
    // Find the radii and the numbers at the points.
    budget.take_of::<[f64; 2]>(piece.n_points())?;
    let radii = Radii::read(piece, radius)?;
    if tubes.is_empty() {
        tubes.origin = piece.origin();
    }
    let scalars = array
        .map(|array| numbers.scalars(piece, array))
        .transpose()?;
    let ghosts = piece.cell_data.get(GHOSTS);
    // Add the visible lines.
    for cell in 0..cells.len() {
        let Some(points) = cells.line(cell) else {
            continue;
        };
        if ghosts.is_some_and(|ghosts| ghosts.at(cell) != 0.0) {
            continue;
        }
        let points: Vec<u32> = points.collect();
        if piece.has_hidden(&points) {
            continue;
        }
        budget.take_of::<[f32; 16]>(points.len())?;
        let number = |point: usize| match &scalars {
            None => 0.0,
            Some((ArrayOf::Points, values)) => values[point],
            Some((ArrayOf::Cells, values)) => values[cell],
        };
        let mut line = Vec::with_capacity(points.len());
        for point in points {
            let point = point as usize;
            let center = piece
                .position(point)
                .map_err(|fault| fault.at(at_point(point)))?;
            let center = (center - tubes.origin).as_vec3();
            let radius = radii.at(point)?;
            line.push((Sphere { center, radius }, number(point)));
        }
        tubes.add_line(line.into_iter())?;
    }
    Ok(())
}
