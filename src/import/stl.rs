//! STL: triangles without shared vertices, as text or binary.
//!
//! The format: 3D Systems, StereoLithography Interface Specification (1989). A binary
//! file begins with 80 arbitrary bytes, often `solid` as in a text: the two are distinguished by
//! the length, which the number of triangles determines, or by a zero among these bytes. Equal vertices are merged, so that normals
//! can be smooth; the normals in the file are ignored, since they follow from the vertices.

use std::collections::HashMap;
use std::io::{BufRead, Cursor, Read};

use glam::{DVec3, Vec3};

use super::fault::cut;
use super::left_out::LeftOut;
use super::lines::{BYTE_ORDER_MARK, Lines};
use super::mesh::{Mesh, count};
use super::obj::vector;
use super::{FileFault, FileLocation, GeometryFileReader, Result, Surroundings};
use world::geometry::{Located, located_points};

/// Bytes before the triangles of a binary file: a comment, and their number.
const HEADER: u64 = 84;
/// Bytes of a triangle: its normal, three vertices, and two bytes for applications.
const TRIANGLE: usize = 50;

pub(super) fn read(mut file: GeometryFileReader, _: &Surroundings) -> Result<Mesh> {
    let length = file.get_ref().length()?;
    let mut header = Vec::new();
    file.by_ref().take(HEADER).read_to_end(&mut header)?;
    let n_triangles = header.last_chunk().map(|bytes| u32::from_le_bytes(*bytes));
    let length_of = |n: u32| HEADER + TRIANGLE as u64 * u64::from(n);
    let binary = n_triangles.filter(|n| header.len() as u64 == HEADER && length_of(*n) <= length);
    match binary.map(|n| (n, length - length_of(n))) {
        Some((n, 0)) => read_binary(file, n),
        _ if is_solid(&header) && !header.contains(&0) => {
            read_text(Lines::new(Cursor::new(header).chain(file)))
        }
        Some((n, _)) => {
            let mut mesh = read_binary(file, n)?;
            let place = format_args!("byte {}", length_of(n));
            mesh.left_out.add("bytes after the last triangle", place);
            Ok(mesh)
        }
        None => Err(wrong_length(length, n_triangles)),
    }
}

fn wrong_length(length: u64, n_triangles: Option<u32>) -> FileFault {
    let problem = match n_triangles.filter(|_| length >= HEADER) {
        Some(n) => format!("{n} triangles do not fit {length} bytes"),
        None => format!("the file has {length} bytes"),
    };
    let expected = "84 bytes and 50 for each triangle, or a text that begins with `solid`";
    FileFault::new(problem, expected)
}

/// Returns true if a text begins as STL does.
fn is_solid(text: &[u8]) -> bool {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let word = text.trim_ascii_start().first_chunk::<5>();
    word.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn read_binary(mut file: GeometryFileReader, n_triangles: u32) -> Result<Mesh> {
    let mut soup = Soup::default();
    let mut bytes = [0; TRIANGLE];
    for i in 0..n_triangles {
        let place = FileLocation::Element("triangle".into(), i.into());
        file.read_exact(&mut bytes)
            .map_err(|error| FileFault::from(error).at(place.clone()))?;
        let number = |k: usize| {
            let at = 12 + 4 * k;
            f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        let corner = |k: usize| DVec3::from([0, 1, 2].map(|i| number(3 * k + i).into()));
        soup.corners.extend([corner(0), corner(1), corner(2)]);
        soup.close(&place)?;
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
            Some((number, line)) => soup.statement(&line, FileLocation::Line(number), within),
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
    left_out: LeftOut,
}

impl Soup {
    /// Completes the current triangle, and leaves it out if it has a corner that is not finite.
    fn close(&mut self, place: &FileLocation) -> Result<()> {
        let corners = &self.corners[3 * self.n_triangles..];
        if corners.len() != 3 {
            let problem = format!("a facet has {} corners", corners.len());
            return Err(FileFault::new(problem, "three lines of `vertex x y z`"));
        }
        if corners.iter().all(|corner| corner.as_vec3().is_finite()) {
            self.n_triangles += 1;
        } else {
            self.corners.truncate(3 * self.n_triangles);
            self.left_out
                .add("triangles with a corner that is not finite", place);
        }
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
            left_out: self.left_out,
            ..Mesh::default()
        })
    }

    /// Parses one line of a text in the form that the specification shows.
    fn statement(&mut self, line: &str, place: FileLocation, within: Within) -> Result<Within> {
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
                return Ok(Within::Facet);
            }
            (Within::Facet, "outer") => {
                expect(words.next(), "loop")?;
                Within::Loop
            }
            (Within::Loop, "vertex") => {
                self.corners.push(vector(&mut words)?.into());
                Within::Loop
            }
            (Within::Loop, "endloop") => {
                self.close(&place)?;
                Within::ClosedFacet
            }
            (Within::ClosedFacet, "endfacet") => Within::Solid,
            _ => {
                let problem = format!("`{}` does not belong here", cut(keyword));
                return Err(FileFault::new(problem, within.expected()));
            }
        };
        if words.next().is_some() {
            self.left_out.add("ends of lines after the numbers", place);
        }
        Ok(next)
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
