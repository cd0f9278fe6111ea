//! Spheres from a table of comma-separated values.

use std::borrow::Cow;
use std::collections::HashSet;

use glam::{DVec3, Vec3};

use csv::{ByteRecord, Position};

use super::choice::{RadiusChoice, rounded_note};
use super::fault::cut;
use super::mesh::{Mesh, limited, point};
use super::table::{columns, missing_column, named_twice, number, of_table, open_table, word};
use super::{FileFault, FileLocation, GeometryFileReader, Result, listed};
use host::text::did_you_mean;
use world::geometry::{Located, Sphere, located_points};
use world::material::{ArrayChoice, ArrayOf};
use world::values::hex_color;

/// The spheres of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spheres {
    /// The point in object space that is the origin of all coordinates.
    pub origin: DVec3,
    /// The spheres, at least one.
    pub spheres: Vec<Sphere>,
    /// The color of each sphere: linear light, from 0 to 1; `None` if the file has no colors.
    pub colors: Option<Vec<Vec3>>,
    /// The number of an array for each sphere, if one was read; NaN for missing ones.
    pub scalars: Option<Vec<f64>>,
    /// The names of the arrays of the file that may give colors.
    pub arrays: Vec<String>,
    /// Sentences about what is left out of the file.
    pub notes: Vec<String>,
}

impl Spheres {
    /// Creates spheres of this radius at the vertices of a mesh, with their colors.
    pub(super) fn at_vertices(mesh: Mesh, radius: f32) -> Self {
        let Mesh {
            origin,
            vertices,
            mut left_out,
            mut notes,
            ..
        } = mesh;
        let colors = mesh.colors.map(|colors| colors.values);
        let mut colors = colors.filter(|colors| colors.len() == vertices.len());
        let is_finite: Vec<bool> = vertices.iter().map(|vertex| vertex.is_finite()).collect();
        if let Some(first) = is_finite.iter().position(|is_finite| !is_finite) {
            let place = FileLocation::Element("point".to_owned(), first as u64);
            let n_others = is_finite.iter().filter(|is_finite| !**is_finite).count();
            (0..n_others).for_each(|_| left_out.add("points that are not finite", &place));
        }
        notes.extend(left_out.note());
        if let Some(colors) = &mut colors {
            let mut is_kept = is_finite.iter();
            colors.retain(|_| is_kept.next() == Some(&true));
        }
        let centers = vertices.into_iter().filter(|vertex| vertex.is_finite());
        Self {
            origin,
            spheres: centers.map(|center| Sphere { center, radius }).collect(),
            colors,
            notes,
            ..Self::default()
        }
    }

    /// Returns the memory in bytes.
    pub fn n_bytes(&self) -> u64 {
        let n_color_bytes = self
            .colors
            .as_ref()
            .map_or(0, |colors| size_of_val(&colors[..]));
        let n_scalar_bytes = self
            .scalars
            .as_ref()
            .map_or(0, |scalars| size_of_val(&scalars[..]));
        (size_of_val(&self.spheres[..]) + n_color_bytes + n_scalar_bytes) as u64
    }
}

/// Reads a table. `radius` applies to all spheres unless there is a column of radii, or is a column
/// with a factor; `array` is the column of numbers.
pub(super) fn read(
    file: GeometryFileReader,
    radius: Option<&RadiusChoice>,
    array: Option<&ArrayChoice>,
) -> Result<Spheres> {
    let mut table = open_table(file)?;
    let header = table.byte_headers().map_err(of_table)?.clone();
    let columns = Columns::from_header(&header, "color", radius, array)
        .map_err(|fault| fault.at(FileLocation::Line(1)))?;
    // An array's colors replace the table's.
    let color_column = columns.extra.filter(|_| array.is_none());
    let mut found = Spheres {
        colors: color_column.map(|_| Vec::new()),
        scalars: array.map(|_| Vec::new()),
        ..Spheres::default()
    };
    let (mut centers, mut radii) = (Vec::new(), Vec::new());
    let mut is_rounded = false;
    let mut row = ByteRecord::new();
    while table.read_byte_record(&mut row).map_err(of_table)? {
        if centers.is_empty() {
            found.arrays = columns.arrays(&header, &row);
        }
        let line = row.position().map_or(0, Position::line);
        let at_line = |fault: FileFault| fault.at(FileLocation::Line(line));
        let (center, radius) = columns.sphere(&row).map_err(at_line)?;
        centers.push(center);
        radii.push(radius);
        if let (Some(column), Some(colors)) = (color_column, &mut found.colors) {
            colors.push(color(word(&row, column)).map_err(at_line)?);
        }
        if let Some(scalars) = &mut found.scalars {
            scalars.push(columns.number(&row).map_err(at_line)?);
            is_rounded |= columns.is_rounded(&row);
        }
    }
    let rounded = array.filter(|_| is_rounded);
    found.notes.extend(rounded.map(rounded_note));
    if centers.is_empty() {
        return Err(FileFault::new("no sphere in the file", "a line for each"));
    }
    let Located { origin, geometry } = located_points(&centers);
    let spheres = geometry.into_iter().zip(radii);
    let sphere = |(center, radius)| Sphere { center, radius };
    Ok(Spheres {
        origin,
        spheres: spheres.map(sphere).collect(),
        ..found
    })
}

/// The positions of a table's columns for points and radii, for one more column, and for numbers.
pub(super) struct Columns {
    center: [usize; 3],
    radius: Radius,
    pub(super) extra: Option<usize>,
    number: Option<usize>,
}

enum Radius {
    /// The column, and the factor from its numbers to radii.
    Column(usize, f32),
    OfAll(f32),
}

impl Columns {
    /// Parses the table's first line, which may have a column named `extra` and columns of other
    /// names. `radius` applies to all points unless there is a column of radii, or is the column of
    /// radii; `array` is the column of numbers.
    pub(super) fn from_header(
        header: &ByteRecord,
        extra: &str,
        radius: Option<&RadiusChoice>,
        array: Option<&ArrayChoice>,
    ) -> Result<Self> {
        let names: Vec<_> = header.iter().map(String::from_utf8_lossy).collect();
        let mut known = HashSet::new();
        let mut given = names.iter().filter(|name| !name.is_empty());
        if let Some(name) = given.find(|name| !known.insert(*name)) {
            return Err(named_twice(name));
        }
        let find = |name: &str| names.iter().position(|known| known == name);
        let column = |name: &str| {
            find(name).ok_or_else(|| missing_column(name, header, &format!("x,y,z,r,{extra}")))
        };
        let upper = ["X", "Y", "Z"].map(find);
        let of_paraview = ["Points:0", "Points:1", "Points:2"].map(find);
        let center = match (upper, of_paraview) {
            _ if find("x").is_some() => [column("x")?, column("y")?, column("z")?],
            ([Some(x), Some(y), Some(z)], _) | (_, [Some(x), Some(y), Some(z)]) => [x, y, z],
            _ => [column("x")?; 3],
        };
        let extra_column = find(extra);
        if extra_column.is_none() {
            let misspelled = names.iter().find(|name| is_nearly(name, extra));
            misspelled.map_or(Ok(()), |name| Err(unknown_column(name, extra)))?;
        }
        let chosen = |array: &ArrayChoice| chosen_column(array, &names, header);
        let radius = match (radius, find("r")) {
            (Some(RadiusChoice::Array { array, factor }), _) => {
                Radius::Column(chosen(array)?, *factor)
            }
            (_, Some(column)) => Radius::Column(column, 1.0),
            (Some(RadiusChoice::Same(radius)), None) => Radius::OfAll(*radius),
            (None, None) => {
                let expected = "one, or a `radius` in the scene: one for all, or `{ array: … }`";
                return Err(FileFault::new("there is no column `r`", expected));
            }
        };
        Ok(Self {
            center,
            radius,
            extra: extra_column,
            number: array.map(chosen).transpose()?,
        })
    }

    /// Returns the names of the other columns that have a number in this row.
    pub(super) fn arrays(&self, header: &ByteRecord, row: &ByteRecord) -> Vec<String> {
        let is_other = |i: usize| !self.center.contains(&i) && self.extra != Some(i);
        let is_number = |i: usize| word(row, i).parse::<f64>().is_ok();
        let names = header.iter().enumerate();
        let arrays = names.filter(|&(i, name)| name != b"r" && is_other(i) && is_number(i));
        arrays
            .map(|(_, name)| String::from_utf8_lossy(name).into_owned())
            .collect()
    }

    /// Parses the point of a row and its radius.
    pub(super) fn sphere(&self, row: &ByteRecord) -> Result<(DVec3, f32)> {
        let [x, y, z] = self.center.map(|column| number(word(row, column)));
        let radius = match self.radius {
            Radius::OfAll(radius) => radius,
            Radius::Column(column, factor) => factor * number::<f32>(word(row, column))?,
        };
        if !(radius.is_finite() && radius > 0.0) {
            let problem = format!("a radius is {radius}");
            return Err(FileFault::new(problem, "a number greater than 0"));
        }
        Ok((point([x?, y?, z?])?, radius))
    }

    /// Parses the number of a row in the column of numbers: NaN if it is empty, or if there is no
    /// such column.
    pub(super) fn number(&self, row: &ByteRecord) -> Result<f64> {
        let word = self.number.map_or("", |column| word(row, column));
        if word.is_empty() {
            Ok(f64::NAN)
        } else {
            number(word).map(limited)
        }
    }

    /// Returns true if the number of a row is an integer that 64-bit floats may round.
    fn is_rounded(&self, row: &ByteRecord) -> bool {
        let word = self.number.map_or("", |column| word(row, column));
        let is_long = word.len() >= f64::DIGITS as usize;
        is_long
            && word
                .parse()
                .is_ok_and(|n: i128| n.unsigned_abs() > 1 << f64::MANTISSA_DIGITS)
    }
}

/// Returns the column of an array.
fn chosen_column(array: &ArrayChoice, names: &[Cow<str>], header: &ByteRecord) -> Result<usize> {
    let name = cut(&array.name);
    if array.is_color || array.of == Some(ArrayOf::Cells) || array.component > Some(0) {
        let problem = format!("`{name}` can only be a column of a table");
        return Err(FileFault::new(problem, "one number for each point"));
    }
    let found = names.iter().position(|known| *known == array.name);
    found.ok_or_else(|| {
        let mut problem = format!("it has no column `{name}`");
        if let Some(suggestion) = did_you_mean(&array.name, names.iter().map(|name| &**name)) {
            problem += &format!(", {suggestion}");
        }
        let known: Vec<String> = columns(header)
            .iter()
            .map(|name| format!("`{name}`"))
            .collect();
        let expected = format!("one of its columns, such as {}", listed(&known));
        FileFault::new(problem, expected)
    })
}

/// Returns true if two names differ only by one missing or extra letter, or in case.
fn is_nearly(name: &str, other: &str) -> bool {
    let is_longer_by_one = name.len().abs_diff(other.len()) == 1;
    name.eq_ignore_ascii_case(other)
        || (is_longer_by_one && strsim::levenshtein(&name.to_lowercase(), other) == 1)
}

fn unknown_column(name: &str, extra: &str) -> FileFault {
    let problem = format!("unknown column `{}`, did you mean `{extra}`?", cut(name));
    let expected = format!("a first line such as `x,y,z,r,{extra}`, or another name");
    FileFault::new(problem, expected)
}

fn color(word: &str) -> Result<Vec3> {
    let color = hex_color(word).map(|rgb| Vec3::from(rgb.map(f32::from)) / 255.0);
    color.ok_or_else(|| FileFault::new(format!("`{}` is not a color", cut(word)), "`#rrggbb`"))
}
