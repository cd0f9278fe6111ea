//! Spheres from a table of comma-separated values.

use glam::Vec3;

use csv::{ByteRecord, ErrorKind, Position, ReaderBuilder, Trim};

use super::fault::cut;
use super::mesh::finite;
use super::{FileFault, FileLocation, GeometryFileReader, Result};
use crate::geometry::Sphere;
use crate::text::did_you_mean;
use crate::yaml::hex_color;

/// The spheres of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spheres {
    /// The spheres, at least one.
    pub spheres: Vec<Sphere>,
    /// The color of each sphere: linear light, from 0 to 1; `None` if the file has no colors.
    pub colors: Option<Vec<Vec3>>,
    /// The number of an array for each sphere, if one was read; NaN for missing ones.
    pub scalars: Option<Vec<f32>>,
}

impl Spheres {
    /// Their memory in bytes.
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

pub(super) fn read(file: GeometryFileReader, radius: Option<f32>) -> Result<Spheres> {
    let mut table = ReaderBuilder::new().trim(Trim::All).from_reader(file);
    let columns = Columns::of(table.byte_headers().map_err(of_table)?, "color", radius)
        .map_err(|fault| fault.at(FileLocation::Line(1)))?;
    let mut found = Spheres {
        spheres: Vec::new(),
        colors: columns.extra.map(|_| Vec::new()),
        scalars: None,
    };
    let mut row = ByteRecord::new();
    while table.read_byte_record(&mut row).map_err(of_table)? {
        let line = row.position().map_or(0, Position::line);
        let at_line = |fault: FileFault| fault.at(FileLocation::Line(line));
        found.spheres.push(columns.sphere(&row).map_err(at_line)?);
        if let (Some(column), Some(colors)) = (columns.extra, &mut found.colors) {
            colors.push(color(word(&row, column)).map_err(at_line)?);
        }
    }
    if found.spheres.is_empty() {
        Err(FileFault::new("no sphere in the file", "a line for each"))
    } else {
        Ok(found)
    }
}

/// The positions of a table's columns of points with radii, and of one more column.
pub(super) struct Columns {
    center: [usize; 3],
    radius: Radius,
    pub(super) extra: Option<usize>,
}

enum Radius {
    Column(usize),
    OfAll(f32),
}

impl Columns {
    /// Reads the table's first line, in which there may be a column named `extra`. `radius`
    /// is the radius of all points if there is no column of radii.
    pub(super) fn of(header: &ByteRecord, extra: &str, radius: Option<f32>) -> Result<Self> {
        let names = ["x", "y", "z", "r", extra];
        let mut columns = [None; 5];
        for (i, name) in header.iter().enumerate() {
            let name = String::from_utf8_lossy(name);
            let known = names.iter().position(|known| *known == name);
            let column = &mut columns[known.ok_or_else(|| unknown_column(&name, names))?];
            if column.replace(i).is_some() {
                let problem = format!("two columns are named `{}`", cut(&name));
                return Err(FileFault::new(problem, "different names"));
            }
        }
        let [x, y, z, r, extra_column] = columns;
        let column = |column: Option<usize>, name: &str| {
            let problem = || format!("there is no column `{name}`");
            let expected = || format!("a first line such as `x,y,z,r,{extra}`");
            column.ok_or_else(|| FileFault::new(problem(), expected()))
        };
        Ok(Self {
            center: [column(x, "x")?, column(y, "y")?, column(z, "z")?],
            radius: match (r, radius) {
                (Some(column), _) => Radius::Column(column),
                (None, Some(radius)) => Radius::OfAll(radius),
                (None, None) => {
                    let expected = "one, or a `radius` for all in the scene";
                    return Err(FileFault::new("there is no column `r`", expected));
                }
            },
            extra: extra_column,
        })
    }

    /// The point of a row, as a sphere.
    pub(super) fn sphere(&self, row: &ByteRecord) -> Result<Sphere> {
        let [x, y, z] = self.center.map(|column| number(word(row, column)));
        let radius = match self.radius {
            Radius::OfAll(radius) => radius,
            Radius::Column(column) => number(word(row, column))?,
        };
        if !(radius.is_finite() && radius > 0.0) {
            let problem = format!("a radius is {radius}");
            return Err(FileFault::new(problem, "a number greater than 0"));
        }
        Ok(Sphere {
            center: finite([x?, y?, z?])?,
            radius,
        })
    }
}

fn unknown_column(name: &str, names: [&str; 5]) -> FileFault {
    let problem = match did_you_mean(name, names) {
        Some(suggestion) => format!("unknown column `{name}`, {suggestion}"),
        None => format!("unknown column `{}`", cut(name)),
    };
    let [x, y, z, r, extra] = names;
    let expected = format!("a first line of `{x}`, `{y}`, `{z}`, `{r}` and `{extra}`");
    FileFault::new(problem, expected)
}

/// One field of a row, all of which are as long as the header.
fn word(row: &ByteRecord, column: usize) -> &str {
    str::from_utf8(&row[column]).unwrap_or("\u{fffd}")
}

fn number(word: &str) -> Result<f32> {
    word.parse()
        .map_err(|_| FileFault::new(format!("`{}` is no number", cut(word)), "a number"))
}

fn color(word: &str) -> Result<Vec3> {
    let color = hex_color(word).map(|rgb| Vec3::from(rgb.map(f32::from)) / 255.0);
    color.ok_or_else(|| FileFault::new(format!("`{}` is no color", cut(word)), "`#rrggbb`"))
}

pub(super) fn of_table(error: csv::Error) -> FileFault {
    let line = error
        .position()
        .map(|position| FileLocation::Line(position.line()));
    let fault = match error.into_kind() {
        ErrorKind::Io(error) => FileFault::from(error),
        ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => FileFault::new(
            format!("{len} fields"),
            format!("{expected_len}, as in line 1"),
        ),
        _ => FileFault::new("the table is damaged", "comma-separated values"),
    };
    match line {
        Some(line) => fault.at(line),
        None => fault,
    }
}
