//! Converts the points of a piece to spheres.

use super::super::spheres::Spheres;
use super::super::{FileFault, FileLocation, Result};
use super::RadiusChoice;
use super::array_of_pieces::ArrayOfPieces;
use super::budget::Budget;
use super::piece::{GHOSTS, Piece};
use glam::Vec3;
use world::geometry::Sphere;
use world::material::{ArrayChoice, ArrayOf};

/// Adds a sphere for each point, except for hidden points and copies of other pieces' points.
///
/// # Errors
/// An array is missing or has values of cells, or a radius is invalid.
pub(super) fn add(
    piece: &Piece,
    radius: &RadiusChoice,
    (array, numbers): (Option<&ArrayChoice>, &mut ArrayOfPieces),
    spheres: &mut Spheres,
    budget: &mut Budget,
) -> Result<()> {
    let n = piece.n_points();
    budget.take_of::<[f32; 16]>(n)?;
    // Find the radii, numbers and colors at the points.
    let radii = Radii::read(piece, radius)?;
    let of_numbers = array.filter(|array| !array.is_color);
    let scalars = of_numbers
        .map(|array| numbers.scalars(piece, &at_points(array)?))
        .transpose()?;
    let colors = array.filter(|array| array.is_color);
    let colors = colors
        .map(|array| colors_of_points(piece, array))
        .transpose()?;
    let ghosts = piece.point_data.get(GHOSTS);
    if spheres.spheres.is_empty() {
        spheres.origin = piece.origin();
    }
    // Add the visible points.
    for point in 0..n {
        if ghosts.is_some_and(|ghosts| ghosts.at(point) != 0.0) {
            continue;
        }
        let radius = radii.at(point)?;
        let center = piece.position(point);
        let center = center.map_err(|fault| fault.at(at_point(point)))?;
        let center = (center - spheres.origin).as_vec3();
        spheres.spheres.push(Sphere { center, radius });
        if let (Some(scalars), Some(found)) = (&scalars, &mut spheres.scalars) {
            found.push(scalars.1[point]);
        }
        if let (Some(colors), Some(found)) = (&colors, &mut spheres.colors) {
            found.push(colors[point]);
        }
    }
    Ok(())
}

/// The radii at the points of a piece.
pub(super) struct Radii {
    of_points: Option<Vec<f64>>,
    factor: f32,
}

impl Radii {
    /// Finds the radii of a piece.
    ///
    /// # Errors
    /// The array is missing, or has values of cells.
    pub(super) fn read(piece: &Piece, choice: &RadiusChoice) -> Result<Self> {
        Ok(match choice {
            RadiusChoice::Same(radius) => Self {
                of_points: None,
                factor: *radius,
            },
            RadiusChoice::Array { array, factor } => Self {
                of_points: Some(of_points(piece, array)?),
                factor: *factor,
            },
        })
    }

    /// Returns the radius at a point.
    ///
    /// # Errors
    /// The radius is not a number greater than 0.
    pub(super) fn at(&self, point: usize) -> Result<f32> {
        let number = self
            .of_points
            .as_ref()
            .map_or(1.0, |radii| radii[point] as f32);
        let radius = self.factor * number;
        if radius.is_finite() && radius > 0.0 {
            return Ok(radius);
        }
        let problem = format!("a radius is {radius}");
        Err(FileFault::new(problem, "a number greater than 0").at(at_point(point)))
    }
}

/// Returns the position of a point in a file.
pub(super) fn at_point(point: usize) -> FileLocation {
    FileLocation::Element("point".into(), point as u64)
}

/// Returns the numbers of an array at the points of a piece.
pub(super) fn of_points(piece: &Piece, array: &ArrayChoice) -> Result<Vec<f64>> {
    piece.scalars(&at_points(array)?).map(|(_, values)| values)
}

fn colors_of_points(piece: &Piece, array: &ArrayChoice) -> Result<Vec<Vec3>> {
    piece.colors(&at_points(array)?).map(|(_, values)| values)
}

/// Returns the choice of a point array.
fn at_points(array: &ArrayChoice) -> Result<ArrayChoice> {
    if array.of == Some(ArrayOf::Cells) {
        let problem = format!("`{}` is an array of cells", array.name);
        let expected = "one of points, for the radii or the colors at points";
        return Err(FileFault::new(problem, expected));
    }
    Ok(ArrayChoice {
        of: Some(ArrayOf::Points),
        ..array.clone()
    })
}
