//! STL: triangles without shared vertices, as text or binary.
//!
//! The format: 3D Systems, StereoLithography Interface Specification (1989). A binary
//! file begins with 80 arbitrary bytes, often `solid` as in a text: the two are distinguished by
//! the length, which the number of triangles determines. Equal vertices are merged, so that normals
//! can be smooth; the normals in the file are ignored, since they follow from the vertices.

use std::collections::HashMap;
use std::io::{BufRead, Cursor, Read};

use glam::{DVec3, Vec3};

use super::fault::cut;
use super::lines::Lines;
use super::mesh::{Mesh, count, point};
use super::obj::vector;
use super::{FileFault, FileLocation, GeometryFileReader, Result};
use crate::geometry::{Located, located_points};

/// Bytes before the triangles of a binary file: a comment, and their number.
const HEADER: u64 = 84;
/// Bytes of a triangle: its normal, three vertices, and two bytes for applications.
const TRIANGLE: usize = 50;

pub(super) fn read(mut file: GeometryFileReader) -> Result<Mesh> {
    let length = file.get_ref().length()?;
    let mut header = Vec::new();
    file.by_ref().take(HEADER).read_to_end(&mut header)?;
    let n_triangles = header.last_chunk().map(|bytes| u32::from_le_bytes(*bytes));
    let length_of = |n: u32| HEADER + TRIANGLE as u64 * u64::from(n);
    match n_triangles.filter(|_| header.len() as u64 == HEADER) {
        Some(n) if length_of(n) == length => read_binary(file, n),
        _ if header.trim_ascii_start().starts_with(b"solid") => {
            read_text(Lines::new(Cursor::new(header).chain(file)))
        }
        Some(n) => {
            let problem = format!("{n} triangles do not fit {length} bytes");
            let expected = format!("{} bytes, or a text that begins with `solid`", length_of(n));
            Err(FileFault::new(problem, expected))
        }
        None => Err(FileFault::new(
            format!("the file has {length} bytes"),
            "84 bytes and 50 for each triangle, or a text that begins with `solid`",
        )),
    }
}

fn read_binary(mut file: GeometryFileReader, n_triangles: u32) -> Result<Mesh> {
    let mut soup = Soup::default();
    let mut bytes = [0; TRIANGLE];
    for i in 0..n_triangles {
        let at = |fault: FileFault| fault.at(FileLocation::Element("triangle".into(), i.into()));
        file.read_exact(&mut bytes)
            .map_err(|error| at(error.into()))?;
        let number = |k: usize| {
            let at = 12 + 4 * k;
            f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        let corner = |k: usize| point([0, 1, 2].map(|i| number(3 * k + i).into()));
        let corners = [corner(0), corner(1), corner(2)];
        for corner in corners {
            soup.corners.push(corner.map_err(at)?);
        }
        soup.close()?;
    }
    soup.finish()
}

/// The position within the statements of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Within {
    /// Outside of any statement.
    File,
    Solid,
    Facet,
    Loop,
    /// In a facet whose loop has ended.
    ClosedFacet,
}

fn read_text<R: BufRead>(mut lines: Lines<R>) -> Result<Mesh> {
    let mut soup = Soup::default();
    let mut within = Within::File;
    loop {
        let read = match lines.next()? {
            Some(line) => soup.statement(&line, within),
            None if within == Within::File => return soup.finish(),
            None => Err(FileFault::new("the file ends within a solid", "`endsolid`")),
        };
        within = read.map_err(|fault| fault.at(FileLocation::Line(lines.number())))?;
    }
}

/// The triangles so far.
#[derive(Default)]
struct Soup {
    /// The corners of all triangles, including the current one.
    corners: Vec<DVec3>,
    n_triangles: usize,
}

impl Soup {
    /// Completes the current triangle.
    fn close(&mut self) -> Result<()> {
        let n = self.corners.len() - 3 * self.n_triangles;
        if n != 3 {
            let problem = format!("a facet has {n} corners");
            return Err(FileFault::new(problem, "three lines of `vertex x y z`"));
        }
        self.n_triangles += 1;
        Ok(())
    }

    /// Returns the mesh of all triangles, with corners at the same position merged into one vertex.
    fn finish(self) -> Result<Mesh> {
        let Located { origin, geometry } = located_points(&self.corners);
        drop(self.corners);
        let mut vertices: Vec<Vec3> = Vec::new();
        // Vertices by the bits of their coordinates.
        let mut known = HashMap::new();
        let mut vertex_at = |corner: Vec3| -> Result<u32> {
            // Adding 0 turns -0 into 0.
            let bits = (corner + 0.0).to_array().map(f32::to_bits);
            let next = count(vertices.len())?;
            let index = *known.entry(bits).or_insert(next);
            if index == next {
                vertices.push(corner);
            }
            Ok(index)
        };
        let corners = geometry.as_chunks().0.iter();
        let triangles = corners.map(|&[a, b, c]| Ok([vertex_at(a)?, vertex_at(b)?, vertex_at(c)?]));
        let triangles = triangles.collect::<Result<_>>()?;
        Ok(Mesh {
            origin,
            vertices,
            triangles,
            ..Mesh::default()
        })
    }

    /// Parses one line of a text in the form that the specification shows.
    fn statement(&mut self, line: &str, within: Within) -> Result<Within> {
        let mut words = line.split_ascii_whitespace();
        let Some(keyword) = words.next() else {
            return Ok(within);
        };
        let next = match (within, keyword.to_ascii_lowercase().as_str()) {
            // A name may follow.
            (Within::File, "solid") => return Ok(Within::Solid),
            (Within::Solid, "endsolid") => return Ok(Within::File),
            (Within::Solid, "facet") => {
                expect(words.next(), "normal")?;
                // The value is ignored: it follows from the vertices.
                vector_or_nan(&mut words)?;
                Within::Facet
            }
            (Within::Facet, "outer") => {
                expect(words.next(), "loop")?;
                Within::Loop
            }
            (Within::Loop, "vertex") => {
                self.corners.push(point(vector(&mut words)?)?);
                Within::Loop
            }
            (Within::Loop, "endloop") => {
                self.close()?;
                Within::ClosedFacet
            }
            (Within::ClosedFacet, "endfacet") => Within::Solid,
            _ => {
                let problem = format!("`{}` does not belong here", cut(keyword));
                return Err(FileFault::new(problem, within.expected()));
            }
        };
        match words.next() {
            None => Ok(next),
            Some(word) => {
                let problem = format!("`{}` follows a statement", cut(word));
                Err(FileFault::new(problem, "the end of the line"))
            }
        }
    }
}

impl Within {
    /// Describes the statements that may come next.
    fn expected(self) -> &'static str {
        match self {
            Self::File => "`solid`",
            Self::Solid => "`facet normal x y z` or `endsolid`",
            Self::Facet => "`outer loop`",
            Self::Loop => "`vertex x y z` or `endloop`",
            Self::ClosedFacet => "`endfacet`",
        }
    }
}

fn expect(found: Option<&str>, keyword: &str) -> Result<()> {
    let found = found.unwrap_or("nothing");
    if found.eq_ignore_ascii_case(keyword) {
        Ok(())
    } else {
        let problem = format!("`{}` does not belong here", cut(found));
        Err(FileFault::new(problem, format!("`{keyword}`")))
    }
}

/// Skips three numbers, possibly NaN: the normal of a triangle without area is undefined.
fn vector_or_nan<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<()> {
    for _ in 0..3 {
        let word = words.next().unwrap_or_default();
        if word.parse::<f32>().is_err() {
            let problem = format!("`{}` is not a number", cut(word));
            return Err(FileFault::new(problem, "a normal: three numbers"));
        }
    }
    Ok(())
}
