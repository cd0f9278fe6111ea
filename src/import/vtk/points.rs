//! The points of a piece as spheres.

use super::super::spheres::Spheres;
use super::super::{FileFault, FileLocation, Result};
use super::budget::Budget;
use super::piece::{GHOSTS, Piece};
use super::{ArrayChoice, ArrayOf, RadiusChoice};
use crate::geometry::Sphere;

/// Adds a sphere for each point, except for copies of other pieces' points and hidden ones.
///
/// # Errors
/// An array that is missing or one of cells, or a radius that is none.
pub(super) fn add(
    piece: &Piece,
    radius: &RadiusChoice,
    array: Option<&ArrayChoice>,
    spheres: &mut Spheres,
    budget: &mut Budget,
) -> Result<()> {
    let n = piece.n_points();
    budget.take_of::<[f32; 16]>(n)?;
    let (radii, factor) = match radius {
        RadiusChoice::Same(radius) => (None, *radius),
        RadiusChoice::Array { array, factor } => (Some(of_points(piece, array)?), *factor),
    };
    let scalars = array.map(|array| of_points(piece, array)).transpose()?;
    let ghosts = piece.point_data.get(GHOSTS);
    for point in 0..n {
        if ghosts.is_some_and(|ghosts| ghosts.at(point) != 0.0) {
            continue;
        }
        let at = |fault: FileFault| fault.at(FileLocation::Element("point".into(), point as u64));
        let radius = factor * radii.as_ref().map_or(1.0, |radii| radii[point]);
        if !(radius.is_finite() && radius > 0.0) {
            let problem = format!("a radius is {radius}");
            return Err(at(FileFault::new(problem, "a number greater than 0")));
        }
        let center = piece.position(point).map_err(at)?;
        spheres.spheres.push(Sphere { center, radius });
        if let (Some(scalars), Some(found)) = (&scalars, &mut spheres.scalars) {
            found.push(scalars[point]);
        }
    }
    Ok(())
}

fn of_points(piece: &Piece, array: &ArrayChoice) -> Result<Vec<f32>> {
    let array = ArrayChoice {
        of: array.of.or(Some(ArrayOf::Points)),
        ..array.clone()
    };
    match piece.scalars(&array)? {
        (ArrayOf::Points, values) => Ok(values),
        (ArrayOf::Cells, _) => {
            let problem = format!("`{}` is an array of cells", array.name);
            Err(FileFault::new(
                problem,
                "one of points, for spheres at the points",
            ))
        }
    }
}
