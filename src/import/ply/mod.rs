//! The Stanford polygon format: `vertex` and `face` elements, `tristrips`, or vertices alone, as text
//! or binary.
//!
//! serde-ply decodes the encodings. It does not report the position of an error, accepts any header
//! and cannot read a last word without a newline: the [`Cursor`] below it and the checks of the
//! [`header`] compensate for that.

mod cursor;
mod header;
mod rows;

use std::iter;

use glam::{DVec3, Vec2, Vec3};
use serde::de::MapAccess;
use serde_ply::{DeserializeError, ElementDef, PlyFormat, PlyReader};

use super::materials::{MAX_MATERIALS, MeshMaterial, MeshPicture, PictureShelf, path_in};
use super::mesh::{MISSING, Mesh, completed, count, fan, finite, light};
use super::picture::bytes_of_file;
use super::polygons::Polygons;
use super::{FileFault, FileLocation, GeometryFileReader, Result, Surroundings};
use cursor::{Cursor, Position};
use header::{ColorProperties, FaceProperties, MeshHeader};
use rows::{ElementRow, Rows};
use world::scene::CornerValues;

pub(super) fn read(file: GeometryFileReader, around: &Surroundings) -> Result<Mesh> {
    let position = Position::default();
    let mut cursor = Cursor::new(file, &position)?;
    let mut reader = PlyReader::from_reader(&mut cursor).map_err(|error| {
        let problem = format!("the header is damaged: {}", error.0);
        FileFault::new(problem, "a PLY file").at(FileLocation::Line(position.line()))
    })?;
    let header = MeshHeader::new(reader.header())?;
    let elements = reader.header().elem_defs.clone();
    let is_text = reader.header().format == PlyFormat::Ascii;
    position.end_with_newline(is_text);
    let mut body = Body::new(header, &position, is_text);
    for element in &elements {
        body.read(element, &mut reader)?;
    }
    let mut mesh = body.mesh(around);
    if !cursor.is_at_end()? {
        let place = format_args!("after line {}", position.line());
        mesh.left_out.add("data after the last element", place);
    }
    Ok(mesh)
}

/// The elements read so far.
struct Body<'a> {
    header: MeshHeader,
    /// The position in the file.
    position: &'a Position,
    is_text: bool,
    mesh: Mesh,
    vertices: Vec<DVec3>,
    normals: Vec<Vec3>,
    /// Texture coordinates and colors of the vertices.
    uvs: Vec<Vec2>,
    colors: Vec<Vec3>,
    polygons: Polygons,
    /// Texture coordinates and colors of the faces' triangles.
    face_uvs: CornerValues<Vec2>,
    face_colors: CornerValues<Vec3>,
    /// The number of each triangle's picture.
    picture_of: Vec<f64>,
    /// The corners of one face.
    face: Vec<u32>,
}

impl<'a> Body<'a> {
    fn new(header: MeshHeader, position: &'a Position, is_text: bool) -> Self {
        Self {
            header,
            position,
            is_text,
            mesh: Mesh::default(),
            vertices: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            polygons: Polygons::default(),
            face_uvs: CornerValues::default(),
            face_colors: CornerValues::default(),
            picture_of: Vec::new(),
            face: Vec::new(),
        }
    }

    /// Reads all rows of the next element.
    fn read(&mut self, element: &ElementDef, reader: &mut PlyReader<&mut Cursor>) -> Result<()> {
        let (mut fault, mut n_rows) = (None, 0);
        let name = element.name.as_str();
        let rows = Rows {
            each: |row: &ElementRow, i: u64| match name {
                "vertex" => self.vertex(row, i),
                "face" => self.face(row, i),
                "tristrips" => self.strips(row),
                _ => Ok(()),
            },
            n_rows: &mut n_rows,
            fault: &mut fault,
        };
        // serde-ply presents the elements of a file as a map.
        let mut elements = reader;
        let read = elements.next_value_seed(rows);
        read.map_err(|error| {
            let fault = fault.unwrap_or_else(|| of_row(&error, element));
            fault.at(self.place(name, u64::max(n_rows, 1) - 1))
        })
    }

    /// Returns the position of row `i` of an element, which is being read.
    fn place(&self, element: &str, i: u64) -> FileLocation {
        if self.is_text {
            FileLocation::Line(self.position.line())
        } else {
            FileLocation::Element(element.to_owned(), i)
        }
    }

    fn vertex(&mut self, row: &ElementRow, i: u64) -> Result<()> {
        self.vertices.push(row.numbers(self.header.position).into());
        if let Some(normal) = self.header.normal {
            let normal = finite(row.numbers(normal).map(|number| number as f32));
            if normal.is_err() {
                let place = self.place("vertex", i);
                self.mesh.left_out.add("normals that are not finite", place);
            }
            self.normals.push(normal.unwrap_or_default());
        }
        if let Some(uv) = self.header.uv {
            let uv = self.uv(row.numbers(uv), i);
            self.uvs.push(uv);
        }
        if let Some(color) = self.header.color {
            self.colors.push(light_of(row, color)?);
        }
        Ok(())
    }

    /// Returns texture coordinates of row `i`: 0 for those that are not finite.
    fn uv(&mut self, uv: [f64; 2], i: u64) -> Vec2 {
        finite(uv.map(|number| number as f32)).unwrap_or_else(|_| {
            let place = self.place("row", i);
            let kind = "texture coordinates that are not finite";
            self.mesh.left_out.add(kind, place);
            Vec2::ZERO
        })
    }

    fn face(&mut self, row: &ElementRow, i: u64) -> Result<()> {
        let FaceProperties {
            corners,
            uvs,
            color,
            picture,
        } = self.header.face;
        self.take_corners(&row.lists[corners])?;
        if self.face.len() < 3 {
            let place = self.place("face", i);
            self.mesh
                .left_out
                .add("faces of fewer than three corners", place);
            return Ok(());
        }
        let n_before = self.mesh.triangles.len();
        self.mesh.triangles.extend(fan(&self.face));
        let n_new = self.mesh.triangles.len() - n_before;
        self.polygons.add(n_before..n_before + n_new);
        if let Some(list) = uvs {
            self.take_face_uvs(&row.lists[list], n_before, i)?;
        }
        if let Some(color) = color {
            let value = count(self.face_colors.values.len() + 1)? - 1;
            self.face_colors.values.push(light_of(row, color)?);
            self.face_colors.triangles.resize(n_before, MISSING);
            let triangles = iter::repeat_n([value; 3], n_new);
            self.face_colors.triangles.extend(triangles);
        }
        let number = picture.map_or(0.0, |picture| row.numbers[picture]);
        self.picture_of.resize(n_before, -1.0);
        self.picture_of.extend(iter::repeat_n(number, n_new));
        Ok(())
    }

    /// Adds the texture coordinates of the corners of face `i`; none for an empty list.
    fn take_face_uvs(&mut self, numbers: &[f64], n_before: usize, i: u64) -> Result<()> {
        if numbers.len() != 2 * self.face.len() {
            if !numbers.is_empty() {
                let place = self.place("face", i);
                let kind = "texture coordinates that not all corners of a face have";
                self.mesh.left_out.add(kind, place);
            }
            return Ok(());
        }
        let first = self.face_uvs.values.len();
        let end = count(first + self.face.len())?;
        for uv in numbers.as_chunks().0 {
            let uv = self.uv(*uv, i);
            self.face_uvs.values.push(uv);
        }
        let corners: Vec<u32> = (first as u32..end).collect();
        self.face_uvs.triangles.resize(n_before, MISSING);
        self.face_uvs.triangles.extend(fan(&corners));
        Ok(())
    }

    /// Stores the vertices of one face.
    fn take_corners(&mut self, indices: &[f64]) -> Result<()> {
        let n = self.header.n_vertices;
        self.face.clear();
        for &index in indices {
            self.face.push(vertex(index, n)?);
        }
        Ok(())
    }

    /// Adds the triangles of strips, each of which ends at an index of -1. Each vertex from the
    /// third on makes a triangle with the two before it; every second one is reversed, so that all
    /// have the same side outside.
    fn strips(&mut self, row: &ElementRow) -> Result<()> {
        for strip in row.lists[self.header.strip].split(|&index| index == -1.0) {
            self.take_corners(strip)?;
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

    /// Returns the mesh, with its pictures as materials if there is memory for them.
    fn mesh(mut self, around: &Surroundings) -> Mesh {
        self.mesh.take_vertices(self.vertices);
        let Mesh {
            vertices,
            triangles,
            ..
        } = &mut self.mesh;
        let of_faces = &mut self.face_uvs.triangles;
        self.polygons
            .triangulate(vertices, triangles, &mut [of_faces]);
        let (header, n) = (&self.header, self.mesh.triangles.len());
        let at_vertices = self.mesh.triangles.clone();
        self.mesh.normals = header.normal.map(|_| CornerValues {
            values: self.normals,
            triangles: at_vertices.clone(),
        });
        self.mesh.uvs = completed(self.face_uvs, n, Vec2::ZERO);
        if header.uv.is_some() && self.mesh.uvs.is_none() {
            self.mesh.uvs = Some(CornerValues {
                values: self.uvs,
                triangles: at_vertices.clone(),
            });
        }
        self.mesh.colors = match header.color {
            Some(_) => Some(CornerValues {
                values: self.colors,
                triangles: at_vertices,
            }),
            None => completed(self.face_colors, n, Vec3::ONE),
        };
        if let Some(available) = around.memory.filter(|_| self.mesh.uvs.is_some()) {
            self.picture_of.resize(n, -1.0);
            take_pictures(
                &mut self.mesh,
                &header.pictures,
                &self.picture_of,
                around,
                available,
            );
        }
        self.mesh
    }
}

/// Makes pictures the materials of a mesh, with a matte one for triangles without any; no material
/// without pictures.
fn take_pictures(
    mesh: &mut Mesh,
    names: &[String],
    picture_of: &[f64],
    around: &Surroundings,
    available: u64,
) {
    let names = &names[..names.len().min(MAX_MATERIALS - 1)];
    let mut shelf = PictureShelf::new(available);
    for name in names {
        let path = path_in(around.folder, name);
        let picture = shelf.picture_or_note(&path, None, || bytes_of_file(&path));
        mesh.materials.push(MeshMaterial {
            has_vertex_colors: picture.is_none() && mesh.colors.is_some(),
            picture: picture.map(|picture| MeshPicture::new(path, picture)),
            ..MeshMaterial::new(name, MeshMaterial::default().color)
        });
    }
    mesh.notes.append(&mut shelf.notes);
    if !names.is_empty() {
        mesh.materials.push(MeshMaterial {
            has_vertex_colors: mesh.colors.is_some(),
            ..MeshMaterial::default()
        });
        let is_known = |number: &f64| (0.0..names.len() as f64).contains(number);
        let material = |number: &f64| {
            if is_known(number) {
                *number as u32
            } else {
                names.len() as u32
            }
        };
        mesh.material_of = picture_of.iter().map(material).collect();
    }
}

/// Returns the linear light of a row's color.
///
/// # Errors
/// A number is not from 0 to 1.
fn light_of(row: &ElementRow, color: ColorProperties) -> Result<Vec3> {
    light(
        row.numbers(color.channels)
            .map(|number| number as f32 / color.maximum),
    )
}

/// Returns the index of one of `n` vertices.
fn vertex(index: f64, n: u32) -> Result<u32> {
    if (0.0..f64::from(n)).contains(&index) {
        return Ok(index as u32);
    }
    let problem = format!("there is no vertex {index}");
    Err(FileFault::new(
        problem,
        format!("one of the {n} vertices, from 0"),
    ))
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
