//! Tubes: lines through points with a radius at each.

use csv::{ByteRecord, Position};
use glam::DVec3;

use super::choice::RadiusChoice;
use super::mesh::count;
use super::spheres::Columns;
use super::table::{of_table, open_table};
use super::{FileFault, FileLocation, GeometryFileReader, Result};
use world::geometry::{Aabb, Capsule, Sphere, origin_near};
use world::material::ArrayChoice;

/// The column of a table that names the line of each point.
pub(super) const LINE: &str = "line";

/// The tubes of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tubes {
    /// The point in object space that is the origin of all coordinates.
    pub origin: DVec3,
    /// The points of all lines, each as the sphere that the tube touches there.
    points: Vec<Sphere>,
    /// The segments between distinct points, as indices of `points`.
    segments: Vec<[u32; 2]>,
    /// The numbers of an array at the two ends of each segment, if one was read; NaN for
    /// missing ones.
    pub scalars: Option<Vec<[f64; 2]>>,
    /// The names of the arrays of the file that may give colors, point arrays first.
    pub arrays: Vec<String>,
}

impl Tubes {
    /// Creates an empty set of tubes, with or without the numbers of an array.
    pub(super) fn with_scalars(has_scalars: bool) -> Self {
        Self {
            scalars: has_scalars.then(Vec::new),
            ..Self::default()
        }
    }

    /// Creates the tube through these points.
    ///
    /// # Errors
    /// All points are equal.
    pub fn of_line(points: impl IntoIterator<Item = Sphere>) -> Result<Self> {
        let mut tubes = Self::default();
        tubes.add_line(points.into_iter().map(|point| (point, 0.0)))?;
        tubes.at_least_one()
    }

    /// Adds the tube through points with a number each. Leaves out points that are equal to the one
    /// before.
    pub(super) fn add_line(&mut self, points: impl Iterator<Item = (Sphere, f64)>) -> Result<()> {
        let mut before: Option<(Sphere, f64)> = None;
        for (point, number) in points {
            let is_same = |(before, _): &(Sphere, f64)| before.center == point.center;
            if before.as_ref().is_some_and(is_same) {
                continue;
            }
            let index = count(self.points.len() + 1)? - 1;
            self.points.push(point);
            if let Some((_, number_before)) = before {
                self.segments.push([index - 1, index]);
                if let Some(scalars) = &mut self.scalars {
                    scalars.push([number_before, number]);
                }
            }
            before = Some((point, number));
        }
        Ok(())
    }

    /// Returns the same tubes around another origin.
    pub fn at(self, origin: DVec3) -> Self {
        Self { origin, ..self }
    }

    /// Returns true if there are no segments.
    pub(super) fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// Checks that there is a segment.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn at_least_one(self) -> Result<Self> {
        if self.is_empty() {
            let expected = "lines through at least two different points";
            return Err(FileFault::new("no line in the file", expected));
        }
        Ok(self)
    }

    /// Returns the smallest box around all points.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.points.iter().map(|point| point.center))
    }

    /// Returns the segments.
    pub fn capsules(&self) -> impl ExactSizeIterator<Item = Capsule> + '_ {
        self.segments.iter().map(|segment| {
            let [from, to] = segment.map(|point| self.points[point as usize]);
            Capsule::new([from.center, to.center], [from.radius, to.radius])
        })
    }

    /// Returns the memory in bytes.
    pub fn n_bytes(&self) -> u64 {
        let of_scalars = self.scalars.as_deref().map_or(0, size_of_val);
        (size_of_val(&self.points[..]) + size_of_val(&self.segments[..]) + of_scalars) as u64
    }
}

/// Reads a table: a line goes through the points of consecutive rows with the same number or name
/// in the column `line`. `radius` applies to all points unless there is a column of radii, or is a
/// column with a factor; `array` is the column of numbers.
pub(super) fn read(
    file: GeometryFileReader,
    radius: Option<&RadiusChoice>,
    array: Option<&ArrayChoice>,
) -> Result<Tubes> {
    let mut table = open_table(file)?;
    let header = table.byte_headers().map_err(of_table)?;
    let columns = Columns::from_header(header, LINE, radius, array)
        .map_err(|fault| fault.at(FileLocation::Line(1)))?;
    let header = header.clone();
    let mut arrays = None;
    // For each row: the index of the first point of its line, the center, the radius and the
    // number.
    let mut points: Vec<(usize, DVec3, f32, f64)> = Vec::new();
    let (mut line, mut name) = (0, Vec::new());
    let mut row = ByteRecord::new();
    while table.read_byte_record(&mut row).map_err(of_table)? {
        arrays.get_or_insert_with(|| columns.arrays(&header, &row));
        let line_number = row.position().map_or(0, Position::line);
        let at_line = |fault: FileFault| fault.at(FileLocation::Line(line_number));
        let (center, radius) = columns.sphere(&row).map_err(at_line)?;
        let number = columns.number(&row).map_err(at_line)?;
        let name_of_row = columns.extra.map_or(&b""[..], |column| &row[column]);
        if name != name_of_row {
            line = points.len();
            name = name_of_row.to_vec();
        }
        points.push((line, center, radius, number));
    }
    let origin = origin_near(points.iter().map(|(_, center, ..)| *center));
    let mut tubes = Tubes::with_scalars(array.is_some()).at(origin);
    tubes.arrays = arrays.unwrap_or_default();
    for line in points.chunk_by(|(a, ..), (b, ..)| a == b) {
        tubes.add_line(line.iter().map(|&(_, center, radius, number)| {
            let center = (center - origin).as_vec3();
            (Sphere { center, radius }, number)
        }))?;
    }
    tubes.at_least_one()
}
