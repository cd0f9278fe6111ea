//! Wavefront OBJ: its polygons, their normals, texture coordinates, materials and objects.
//!
//! The format is described in appendix B1 of the Advanced Visualizer's manual (Wavefront, 1992). No
//! crate fits: tobj 4 panics on some indices and reports no line numbers, obj-rs 0.7 panics on
//! unknown statements, and both allocate memory for each face.

mod mtl;
mod groups;

use std::collections::BTreeMap;
use std::fmt::Display;
use std::iter::{self, Peekable};
use std::str::FromStr;

use arrayvec::ArrayVec;
use glam::{DVec3, Vec2, Vec3};

use super::fault::cut;
use super::lines::Lines;
use super::materials::MeshMaterial;
use super::mesh::{MISSING, Mesh, completed, count, fan, finite, light};
use super::polygons::Polygons;
use super::{FileFault, FileLocation, GeometryFileReader, Result, Surroundings};
use groups::FaceGroups;
use world::scene::CornerValues;

/// Statements that are ignored: groups and display attributes.
const IGNORED: &[&str] = &[
    "g",
    "o",
    "s",
    "mg",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
];

/// The format of a corner of a face.
const CORNER: &str = "a number, as in `3`, `3/1`, `3/1/2` or `3//2`";

pub(super) fn read(file: GeometryFileReader, around: &Surroundings) -> Result<Mesh> {
    let mut lines = Lines::of_file(file)?;
    let mut reader = Reader::default();
    let mut groups = around.memory.map(|_| FaceGroups::default());
    while let Some((number, line)) = lines.next()? {
        let read = match &mut groups {
            None => reader.statement(&line, number),
            Some(groups) => reader.statement_with_materials(&line, number, groups),
        };
        read.map_err(|fault| fault.at(FileLocation::Line(number)))?;
    }
    if let Some((groups, available)) = groups.zip(around.memory) {
        let mesh = &mut reader.mesh;
        groups.give_to(mesh, around, available)?;
        mesh.notes.extend(doubts(&mesh.materials));
        if mesh.materials.iter().any(MeshMaterial::has_pictures) {
            reader.complete_uvs();
        }
    }
    Ok(reader.finish())
}

/// Returns a sentence about each kind of doubtful statement in the materials.
fn doubts(materials: &[MeshMaterial]) -> Vec<String> {
    let mut of_doubt = BTreeMap::<&str, Vec<&str>>::new();
    for material in materials {
        for doubt in &material.doubts {
            of_doubt.entry(doubt).or_default().push(&material.name);
        }
    }
    let sentence = |(doubt, names): (&str, Vec<&str>)| match names[..] {
        [name] => format!("material `{}`: {doubt}", cut(name)),
        _ => format!(
            "{} materials, such as `{}`: {doubt}",
            names.len(),
            cut(names[0])
        ),
    };
    of_doubt.into_iter().map(sentence).collect()
}

/// The part of the mesh read so far.
#[derive(Default)]
struct Reader {
    mesh: Mesh,
    vertices: Vec<DVec3>,
    normals: CornerValues<Vec3>,
    /// Texture coordinates of the triangles of all faces; [`MISSING`] for triangles without any.
    uvs: CornerValues<Vec2>,
    /// Colors of all vertices, unless some vertex lacks one.
    colors: Vec<Vec3>,
    polygons: Polygons,
    /// Vertices, normals and texture coordinates of one face's corners.
    face: Vec<u32>,
    face_normals: Vec<u32>,
    face_uvs: Vec<u32>,
}

impl Reader {
    /// Parses one line. Leaves out what no polygon needs.
    fn statement(&mut self, line: &str, number: u64) -> Result<()> {
        let place = FileLocation::Line(number);
        let words = line.split_ascii_whitespace();
        let mut words = words.take_while(|word| !word.starts_with('#')).peekable();
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        match keyword {
            "v" => {
                count(self.vertices.len() + 1)?;
                self.vertices.push(vector(&mut words)?.into());
                self.colors.extend(color(&mut words));
            }
            "vn" => {
                count(self.normals.values.len() + 1)?;
                let normal = vector(&mut words).and_then(finite);
                if normal.is_err() {
                    self.leave_out("normals that are not three finite numbers", &place);
                }
                self.normals.values.push(normal.unwrap_or_default());
            }
            "vt" => {
                count(self.uvs.values.len() + 1)?;
                let uv = texture_coordinates(&mut words);
                if uv.is_err() {
                    self.leave_out("texture coordinates that are not finite numbers", &place);
                }
                self.uvs.values.push(uv.unwrap_or_default());
            }
            "f" | "fo" => return self.face(words, &place),
            "mtllib" | "usemtl" => return Ok(()),
            // Old programs start comments with a dollar sign.
            _ if IGNORED.contains(&keyword) || keyword.starts_with('$') => return Ok(()),
            _ => {
                let place = format_args!("`{}` in {place}", cut(keyword));
                self.leave_out("statements other than polygons", place);
                return Ok(());
            }
        }
        if words.next().is_some() {
            self.leave_out("ends of lines after the numbers", place);
        }
        Ok(())
    }

    fn leave_out(&mut self, kind: &'static str, place: impl Display) {
        self.mesh.left_out.add(kind, place);
    }

    fn face<'a>(
        &mut self,
        words: impl Iterator<Item = &'a str>,
        place: &FileLocation,
    ) -> Result<()> {
        // Parse the corners.
        self.face.clear();
        self.face_normals.clear();
        self.face_uvs.clear();
        let (mut has_normals, mut has_uvs) = (false, false);
        for word in words {
            let mut indices = word.split('/');
            let mut next = || indices.next().unwrap_or_default();
            let (vertex, texture, normal) = (next(), next(), next());
            if indices.next().is_some() {
                return Err(no_corner(word));
            }
            let vertex = index(vertex, self.vertices.len())?;
            self.face.push(vertex.ok_or_else(|| self.no_vertex(word))?);
            if !normal.is_empty() {
                has_normals = true;
                self.face_normals
                    .extend(index(normal, self.normals.values.len())?);
            }
            // Some programs index texture coordinates that they do not write.
            if !texture.is_empty() && !self.uvs.values.is_empty() {
                has_uvs = true;
                self.face_uvs.extend(index(texture, self.uvs.values.len())?);
            }
        }
        // Check that all corners have the same attributes, and triangulate them.
        let (n, n_before) = (self.face.len(), self.mesh.triangles.len());
        if n < 3 {
            self.leave_out("faces of fewer than three corners", place);
            return Ok(());
        }
        if self.face_normals.len() == n {
            self.normals.triangles.resize(n_before, MISSING);
            self.normals.triangles.extend(fan(&self.face_normals));
        } else if has_normals {
            self.leave_out("normals that not all corners of a face have", place);
        }
        if self.face_uvs.len() == n {
            self.uvs.triangles.resize(n_before, MISSING);
            self.uvs.triangles.extend(fan(&self.face_uvs));
        } else if has_uvs {
            let kind = "texture coordinates that not all corners of a face have";
            self.leave_out(kind, place);
        }
        self.mesh.triangles.extend(fan(&self.face));
        self.polygons.add(n_before..self.mesh.triangles.len());
        Ok(())
    }

    fn no_vertex(&self, word: &str) -> FileFault {
        let (vertex, _) = word.split_once('/').unwrap_or((word, ""));
        FileFault::new(
            format!("there is no vertex {}", cut(vertex)),
            format!("one of the {} above", self.vertices.len()),
        )
    }

    /// Parses one line, including statements about materials and objects.
    fn statement_with_materials(
        &mut self,
        line: &str,
        number: u64,
        groups: &mut FaceGroups,
    ) -> Result<()> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "mtllib" => groups.library(rest.trim()),
            "usemtl" => groups.use_material(rest.trim(), number)?,
            "o" | "g" => groups.node(keyword, rest.trim()),
            _ => {
                self.statement(line, number)?;
                groups.triangles(self.mesh.triangles.len());
            }
        }
        Ok(())
    }

    /// Gives the lower left corner of pictures to faces without texture coordinates, if other faces
    /// have some.
    fn complete_uvs(&mut self) {
        let uvs = std::mem::take(&mut self.uvs);
        let n = self.mesh.triangles.len();
        self.uvs = completed(uvs, n, Vec2::ZERO).unwrap_or_default();
    }

    fn finish(mut self) -> Mesh {
        self.mesh.take_vertices(self.vertices);
        self.polygons.triangulate(
            &self.mesh.vertices,
            &mut self.mesh.triangles,
            &mut [&mut self.normals.triangles, &mut self.uvs.triangles],
        );
        let has_all = self.uvs.triangles.len() == self.mesh.triangles.len();
        if has_all && !self.uvs.triangles.contains(&MISSING) {
            self.mesh.uvs = Some(std::mem::take(&mut self.uvs));
        }
        if self.colors.len() == self.mesh.vertices.len() {
            self.mesh.colors = Some(CornerValues {
                values: std::mem::take(&mut self.colors),
                triangles: self.mesh.triangles.clone(),
            });
        }
        self.mesh.take_normals(self.normals);
        self.mesh
    }
}

/// Parses the optional values after a vertex: a weight, or a color of three numbers with an
/// optional weight or opacity. Returns the linear light of a color of three numbers from 0 to 1.
fn color<'a>(words: &mut Peekable<impl Iterator<Item = &'a str>>) -> Option<Vec3> {
    let is_number = |word: &&str| word.parse::<f32>().is_ok();
    let numbers = iter::from_fn(|| words.next_if(is_number)?.parse().ok());
    let numbers: ArrayVec<f32, 4> = numbers.take(4).collect();
    // Programs disagree on which of four numbers are the color.
    light(<[f32; 3]>::try_from(numbers.as_slice()).ok()?).ok()
}

/// Parses one to three numbers: the first two are the texture coordinates, the second one 0 if it
/// is missing.
fn texture_coordinates<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<Vec2> {
    let u = number(words.next().unwrap_or_default())?;
    let v = words.next().map_or(Ok(0.0), number)?;
    words.next();
    finite([u, v])
}

/// Parses a number; NaN and infinity as C writes them, too.
fn number<T: FromStr + From<f32>>(word: &str) -> Result<T> {
    word.parse().or_else(|_| {
        let (start, _) = word.split_once(['#', '(']).unwrap_or((word, ""));
        match start.trim_start_matches(['-', '+']) {
            "1." | "nan" if start.len() < word.len() => Ok(f32::NAN.into()),
            _ => Err(FileFault::new(
                format!("`{}` is not a number", cut(word)),
                "a coordinate",
            )),
        }
    })
}

/// Parses the first three words as numbers.
pub(super) fn vector<'a, T: FromStr + From<f32> + Default>(
    words: &mut impl Iterator<Item = &'a str>,
) -> Result<[T; 3]> {
    let mut numbers = <[T; 3]>::default();
    for (i, number) in numbers.iter_mut().enumerate() {
        let word = words
            .next()
            .ok_or_else(|| FileFault::new(format!("{i} coordinates"), "three: x, y and z"))?;
        *number = self::number(word)?;
    }
    Ok(numbers)
}

/// Converts an index of `n` elements that counts from 1, or from -1 backward, to one that counts
/// from 0; `None` if there is no such element.
fn index(word: &str, n: usize) -> Result<Option<u32>> {
    let n = n as i64;
    let found: i64 = word.parse().map_err(|_| no_corner(word))?;
    let index = if found < 0 {
        n.saturating_add(found)
    } else {
        found - 1
    };
    Ok((0..n).contains(&index).then_some(index as u32))
}

fn no_corner(word: &str) -> FileFault {
    FileFault::new(format!("`{}` is not a corner", cut(word)), CORNER)
}
