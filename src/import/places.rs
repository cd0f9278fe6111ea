//! The placements of instances: from a table of comma-separated values, or the points of a VTK
//! file.

use std::ops::Range;
use std::str::FromStr;

use csv::{ByteRecord, Position};
use glam::{DAffine3, DQuat, DVec3, Vec3};

use super::fault::cut;
use super::mesh::{finite, point};
use super::table::{missing_column, named_twice, number, of_table, open_table, word};
use super::{FileFault, FileLocation, GeometryFileReader, Result};
use host::text::did_you_mean;
use world::material::ArrayChoice;

/// The placement of an instance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InstancePlace {
    /// The position of the mesh's origin.
    pub position: DVec3,
    /// The factors along the axes of the mesh.
    pub scale: Vec3,
    /// The direction of the mesh's x axis, of any length; 0 for a mesh that is not rotated.
    pub direction: Vec3,
    /// The number of an array; NaN without one.
    pub scalar: f64,
}

/// The arrays at the points of a VTK file that describe the placements of instances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceArrays<'a> {
    /// The factors of the scale.
    pub scale: Option<&'a ArrayChoice>,
    /// The vectors to which the x axis of the mesh is turned.
    pub orient: Option<&'a str>,
    /// The numbers that give colors.
    pub color: Option<&'a ArrayChoice>,
}

impl PlaceArrays<'_> {
    /// Refuses any array.
    ///
    /// # Errors
    /// There is one.
    pub(super) fn none(self) -> Result<()> {
        if self.scale.is_none() && self.orient.is_none() && self.color.is_none() {
            return Ok(());
        }
        let problem = "it is a table, which has no arrays";
        let expected = "a VTK file, or columns `scale` and `direction_x`";
        Err(FileFault::new(problem, expected))
    }
}

impl InstancePlace {
    /// Returns the map from the space of the mesh: it scales, turns the x axis to the direction by
    /// the smallest angle, and moves the origin to the position.
    pub fn matrix(&self) -> DAffine3 {
        let turn = self.direction.as_dvec3().try_normalize();
        let turn = turn.map_or(DQuat::IDENTITY, |to| DQuat::from_rotation_arc(DVec3::X, to));
        DAffine3::from_scale_rotation_translation(self.scale.as_dvec3(), turn, self.position)
    }
}

/// Reads a table.
pub(super) fn read(file: GeometryFileReader) -> Result<Vec<InstancePlace>> {
    let mut table = open_table(file)?;
    let columns = PlaceColumns::from_header(table.byte_headers().map_err(of_table)?)
        .map_err(|fault| fault.at(FileLocation::Line(1)))?;
    let mut places = Vec::new();
    let mut row = ByteRecord::new();
    while table.read_byte_record(&mut row).map_err(of_table)? {
        let line = row.position().map_or(0, Position::line);
        let place = columns.place(&row);
        places.extend(place.map_err(|fault| fault.at(FileLocation::Line(line)))?);
    }
    if places.is_empty() {
        return Err(FileFault::new("no place in the file", "a line for each"));
    }
    Ok(places)
}

/// The columns of a table.
const NAMES: [&str; 10] = [
    "x",
    "y",
    "z",
    "scale",
    "scale_x",
    "scale_y",
    "scale_z",
    "direction_x",
    "direction_y",
    "direction_z",
];

/// The position of each column of a table, if the table has it.
struct PlaceColumns([Option<usize>; NAMES.len()]);

impl PlaceColumns {
    /// Parses the table's first line.
    fn from_header(header: &ByteRecord) -> Result<Self> {
        let mut columns = [None; NAMES.len()];
        for (i, name) in header.iter().enumerate() {
            let name = String::from_utf8_lossy(name);
            let known = NAMES.iter().position(|known| *known == name);
            let column = &mut columns[known.ok_or_else(|| unknown_column(&name))?];
            if column.replace(i).is_some() {
                return Err(named_twice(&name));
            }
        }
        let lacks = |range: Range<usize>| {
            let missing = range.clone().find(|&i| columns[i].is_none());
            let is_begun = range.start == 0 || range.clone().any(|i| columns[i].is_some());
            missing.filter(|_| is_begun)
        };
        let missing = lacks(0..3).or(lacks(4..7)).or(lacks(7..10));
        if let Some(missing) = missing {
            return Err(missing_column(NAMES[missing], header, "x,y,z,scale"));
        }
        Ok(Self(columns))
    }

    /// Parses the placement in a row; `None` if its scale is 0 or missing.
    fn place(&self, row: &ByteRecord) -> Result<Option<InstancePlace>> {
        let of_scale = self.0[3..7].iter().flatten();
        let mut words = of_scale.map(|&column| word(row, column).trim());
        if words.any(|word| word.is_empty() || word.eq_ignore_ascii_case("nan")) {
            return Ok(None);
        }
        let factor: f32 = match self.0[3] {
            None => 1.0,
            Some(column) => number(word(row, column))?,
        };
        let scale = factor * finite::<3, Vec3>(self.numbers(row, 4, 1.0)?)?;
        if scale.cmpeq(Vec3::ZERO).any() {
            return Ok(None);
        }
        if !is_scale(scale) {
            let problem = format!("a scale is {scale}");
            return Err(FileFault::new(problem, "numbers other than 0"));
        }
        Ok(Some(InstancePlace {
            position: point(self.numbers(row, 0, 0.0)?)?,
            scale,
            direction: finite(self.numbers(row, 7, 0.0)?)?,
            scalar: f64::NAN,
        }))
    }

    /// Parses the numbers of a row in three columns; `default` for columns that the table lacks.
    fn numbers<T: FromStr + Copy>(
        &self,
        row: &ByteRecord,
        first: usize,
        default: T,
    ) -> Result<[T; 3]> {
        let mut numbers = [default; 3];
        for (number_of, column) in numbers.iter_mut().zip(&self.0[first..]) {
            if let Some(column) = column {
                *number_of = number(word(row, *column))?;
            }
        }
        Ok(numbers)
    }
}

/// Returns true if these factors have an inverse.
fn is_scale(scale: Vec3) -> bool {
    scale.is_finite() && scale.cmpne(Vec3::ZERO).all()
}

fn unknown_column(name: &str) -> FileFault {
    let problem = match did_you_mean(name, NAMES) {
        Some(suggestion) => format!("unknown column `{name}`, {suggestion}"),
        None => format!("unknown column `{}`", cut(name)),
    };
    FileFault::new(problem, format!("some of `{}`", NAMES.join("`, `")))
}

/// Keeps the placements whose scale is neither 0 nor missing.
///
/// # Errors
/// There is none.
pub(super) fn usable(mut places: Vec<InstancePlace>) -> Result<Vec<InstancePlace>> {
    if places.is_empty() {
        return Err(FileFault::new(
            "no point in the file",
            "a point for each instance",
        ));
    }
    places.retain(|place| is_scale(place.scale) && place.direction.is_finite());
    if places.is_empty() {
        let problem = "no point of the file has a scale and a direction";
        return Err(FileFault::new(problem, "numbers other than 0"));
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_a_scale_have_no_instance() {
        let header = ByteRecord::from(vec!["x", "y", "z", "scale"]);
        let columns = PlaceColumns::from_header(&header).unwrap();
        for (scale, expected) in [("2", Some(2.0)), ("0", None), ("", None), ("NaN", None)] {
            let row = ByteRecord::from(vec!["1", "2", "3", scale]);
            let place = columns.place(&row).unwrap();
            assert_eq!(place.map(|place| place.scale.x), expected, "{scale}");
        }
        let row = ByteRecord::from(vec!["1", "2", "3", "big"]);
        assert!(columns.place(&row).is_err());
    }

    #[test]
    fn the_x_axis_turns_to_the_direction() {
        let place = |direction| InstancePlace {
            position: DVec3::ONE,
            scale: Vec3::new(2.0, 3.0, 4.0),
            direction,
            scalar: 0.0,
        };
        for direction in [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::new(3.0, -4.0, 12.0)] {
            let matrix = place(direction).matrix();
            let turned = matrix.transform_vector3(DVec3::X);
            assert!(
                turned.abs_diff_eq(2.0 * direction.as_dvec3().normalize(), 1e-5),
                "{turned}"
            );
            assert_eq!(matrix.transform_point3(DVec3::ZERO), DVec3::ONE);
            assert!((matrix.matrix3.determinant() - 24.0).abs() < 1e-4);
        }
        let unturned = place(Vec3::ZERO).matrix();
        assert_eq!(unturned.transform_vector3(DVec3::Y), 3.0 * DVec3::Y);
        // A turn within a plane keeps what is upright.
        let upright = place(Vec3::new(-1.0, 0.0, 0.5)).matrix();
        assert!(
            upright
                .transform_vector3(DVec3::Y)
                .abs_diff_eq(3.0 * DVec3::Y, 1e-6)
        );
    }
}
