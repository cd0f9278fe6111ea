//! The Stanford polygon format: `vertex` and `face` elements, or `tristrips`, as text or binary.
//!
//! serde-ply decodes the encodings. It does not report the position of an error, accepts any header
//! and cannot read a last word without a newline: the [`Cursor`] below it and the checks of the
//! [`header`] compensate for that.

mod cursor;
mod header;
mod rows;

use glam::{DVec3, Vec2, Vec3};
use serde::Deserialize;
use serde::de::MapAccess;
use serde_ply::{DeserializeError, ElementDef, PlyFormat, PlyReader};

use super::mesh::{CornerValues, Mesh, fan, finite, light, point};
use super::polygons::Polygons;
use super::{FileFault, FileLocation, GeometryFileReader, Result};
use cursor::{Cursor, Position};
use header::{MeshHeader, UvNames};
use rows::Rows;

pub(super) fn read(file: GeometryFileReader) -> Result<Mesh> {
    let position = Position::default();
    let mut cursor = Cursor::new(file, &position);
    let mut reader = PlyReader::from_reader(&mut cursor).map_err(|error| {
        let problem = format!("the header is damaged: {}", error.0);
        FileFault::new(problem, "a PLY file").at(FileLocation::Line(position.line()))
    })?;
    let header = MeshHeader::new(reader.header())?;
    let elements = reader.header().elem_defs.clone();
    let is_text = reader.header().format == PlyFormat::Ascii;
    position.end_with_newline(is_text);
    let mut body = Body::new(header);
    for element in &elements {
        let mut n_rows = 0;
        body.read(element, &mut reader, &mut n_rows)
            .map_err(|fault| {
                fault.at(if is_text {
                    FileLocation::Line(position.line())
                } else {
                    FileLocation::Element(element.name.clone(), u64::max(n_rows, 1) - 1)
                })
            })?;
    }
    if cursor.is_at_end()? {
        Ok(body.mesh())
    } else {
        Err(FileFault::new(
            "there is more data than the header declares",
            "as many numbers in each row as it has properties",
        ))
    }
}

/// A row of a `vertex` element.
#[derive(Deserialize)]
struct Vertex {
    x: f64,
    y: f64,
    z: f64,
    #[serde(default)]
    nx: f32,
    #[serde(default)]
    ny: f32,
    #[serde(default)]
    nz: f32,
    // Programs disagree on the names of texture coordinates.
    #[serde(default)]
    u: f32,
    #[serde(default)]
    v: f32,
    #[serde(default)]
    s: f32,
    #[serde(default)]
    t: f32,
    #[serde(default)]
    texture_u: f32,
    #[serde(default)]
    texture_v: f32,
    #[serde(default)]
    red: f32,
    #[serde(default)]
    green: f32,
    #[serde(default)]
    blue: f32,
}

impl Vertex {
    fn uv(&self, names: UvNames) -> [f32; 2] {
        match names {
            UvNames::Uv => [self.u, self.v],
            UvNames::St => [self.s, self.t],
            UvNames::TextureUv => [self.texture_u, self.texture_v],
        }
    }
}

/// A row of a `face` or `tristrips` element.
#[derive(Deserialize)]
struct Face {
    #[serde(alias = "vertex_index")]
    vertex_indices: Vec<i64>,
}

/// A row of an element that is neither `vertex` nor `face`.
#[derive(Deserialize)]
struct Skipped {}

/// The elements read so far.
struct Body {
    header: MeshHeader,
    mesh: Mesh,
    vertices: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    colors: Vec<Vec3>,
    polygons: Polygons,
    /// The corners of one face.
    face: Vec<u32>,
}

impl Body {
    fn new(header: MeshHeader) -> Self {
        Self {
            header,
            mesh: Mesh::default(),
            vertices: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            polygons: Polygons::default(),
            face: Vec::new(),
        }
    }

    /// Reads all rows of the next element; `n_rows` counts the rows begun.
    fn read(
        &mut self,
        element: &ElementDef,
        reader: &mut PlyReader<&mut Cursor>,
        n_rows: &mut u64,
    ) -> Result<()> {
        let mut fault = None;
        // serde-ply presents the elements of a file as a map.
        let mut elements = reader;
        let read = match element.name.as_str() {
            "vertex" => {
                elements.next_value_seed(Rows::new(|row| self.vertex(&row), n_rows, &mut fault))
            }
            "face" => {
                elements.next_value_seed(Rows::new(|row| self.face(&row), n_rows, &mut fault))
            }
            "tristrips" => {
                elements.next_value_seed(Rows::new(|row| self.strips(&row), n_rows, &mut fault))
            }
            _ => elements.next_value_seed(Rows::new(|_: Skipped| Ok(()), n_rows, &mut fault)),
        };
        read.map_err(|error| fault.unwrap_or_else(|| of_row(&error, element)))
    }

    fn vertex(&mut self, row: &Vertex) -> Result<()> {
        self.vertices.push(point([row.x, row.y, row.z])?);
        if self.header.has_normals {
            self.normals.push(finite([row.nx, row.ny, row.nz])?);
        }
        if let Some(names) = self.header.uvs {
            self.uvs.push(finite(row.uv(names))?);
        }
        if let Some(maximum) = self.header.color_maximum {
            let numbers = [row.red, row.green, row.blue].map(|number| number / maximum);
            self.colors.push(light(numbers)?);
        }
        Ok(())
    }

    fn face(&mut self, row: &Face) -> Result<()> {
        let n = self.header.n_vertices;
        self.face.clear();
        for &index in &row.vertex_indices {
            self.face.push(vertex(index, n)?);
        }
        if self.face.len() < 3 {
            let problem = format!("a face has {} corners", self.face.len());
            return Err(FileFault::new(problem, "at least 3"));
        }
        let n_before = self.mesh.triangles.len();
        self.mesh.triangles.extend(fan(&self.face));
        self.polygons.add(n_before..self.mesh.triangles.len());
        Ok(())
    }

    /// Adds the triangles of strips, each of which ends at an index of -1. Each vertex from the
    /// third on makes a triangle with the two before it; every second one is reversed, so that all
    /// have the same side outside.
    fn strips(&mut self, row: &Face) -> Result<()> {
        let n = self.header.n_vertices;
        for strip in row.vertex_indices.split(|&index| index == -1) {
            self.face.clear();
            for &index in strip {
                self.face.push(vertex(index, n)?);
            }
            for (i, corners) in self.face.windows(3).enumerate() {
                let &[a, b, c] = corners else { continue };
                // Equal corners move a strip to another place.
                if a != b && b != c && c != a {
                    let triangle = if i % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    self.mesh.triangles.push(triangle);
                }
            }
        }
        Ok(())
    }

    fn mesh(mut self) -> Mesh {
        self.mesh.take_vertices(self.vertices);
        let Mesh {
            vertices,
            triangles,
            ..
        } = &mut self.mesh;
        self.polygons.triangulate(vertices, triangles, &mut []);
        if self.header.has_normals {
            self.mesh.normals = Some(CornerValues {
                values: self.normals,
                triangles: self.mesh.triangles.clone(),
            });
        }
        if self.header.uvs.is_some() {
            self.mesh.uvs = Some(CornerValues {
                values: self.uvs,
                triangles: self.mesh.triangles.clone(),
            });
        }
        if self.header.color_maximum.is_some() {
            self.mesh.colors = Some(CornerValues {
                values: self.colors,
                triangles: self.mesh.triangles.clone(),
            });
        }
        self.mesh
    }
}

/// Returns the index of one of `n` vertices.
fn vertex(index: i64, n: u32) -> Result<u32> {
    let vertex = u32::try_from(index).ok().filter(|vertex| *vertex < n);
    vertex.ok_or_else(|| {
        let problem = format!("there is no vertex {index}");
        FileFault::new(problem, format!("one of the {n} vertices, from 0"))
    })
}

/// Returns the fault of a row that serde-ply could not read.
fn of_row(error: &DeserializeError, element: &ElementDef) -> FileFault {
    let ElementDef { name, count, .. } = element;
    match error.0.kind() {
        std::io::ErrorKind::UnexpectedEof => FileFault::new(
            format!("the file ends within its `{name}` elements"),
            format!("{count} of them"),
        ),
        std::io::ErrorKind::InvalidData => FileFault::new(
            format!("a row of `{name}` is damaged: {}", error.0),
            "numbers of the types in the header",
        ),
        _ => FileFault::from(std::io::Error::new(error.0.kind(), error.0.to_string())),
    }
}
