//! Wavefront OBJ: its polygons, their normals, texture coordinates and materials.
//!
//! The format is described in appendix B1 of the Advanced Visualizer's manual (Wavefront, 1992). No
//! crate fits: tobj 4 panics on some indices and reports no line numbers, obj-rs 0.7 panics on
//! unknown statements, and both allocate memory for each face.

mod mtl;
mod groups;

use std::collections::BTreeMap;
use std::str::FromStr;

use arrayvec::ArrayVec;
use glam::{DVec3, Vec2, Vec3};

use super::fault::cut;
use super::lines::Lines;
use super::materials::MeshMaterial;
use super::mesh::{CornerValues, MISSING, Mesh, count, fan, finite, light, point};
use super::polygons::Polygons;
use super::{FileFault, FileLocation, GeometryFileReader, Result, Surroundings};
use groups::MaterialGroups;

/// Statements that are ignored: other elements, groups and display
/// attributes.
const IGNORED: &[&str] = &[
    "vp",
    "p",
    "l",
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
    let mut groups = around.memory.map(|_| MaterialGroups::default());
    while let Some(line) = lines.next()? {
        let read = match &mut groups {
            None => reader.statement(&line),
            Some(groups) => {
                let (line, number) = (line.into_owned(), lines.number());
                reader.statement_with_materials(&line, number, groups)
            }
        };
        read.map_err(|fault| fault.at(FileLocation::Line(lines.number())))?;
    }
    let Some((groups, available)) = groups.zip(around.memory) else {
        return Ok(reader.finish());
    };
    let (materials, material_of) = groups.materials(around, available)?;
    if materials.iter().any(MeshMaterial::has_pictures) {
        reader.complete_uvs();
    }
    Ok(Mesh {
        notes: doubts(&materials),
        materials,
        material_of,
        ..reader.finish()
    })
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
    /// Parses one line.
    fn statement(&mut self, line: &str) -> Result<()> {
        let words = line.split_ascii_whitespace();
        let mut words = words.take_while(|word| !word.starts_with('#'));
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        match keyword {
            "v" => {
                count(self.vertices.len() + 1)?;
                self.vertices.push(point(vector(&mut words)?)?);
                self.colors.extend(weight_or_color(words)?);
            }
            "vn" => {
                count(self.normals.values.len() + 1)?;
                self.normals.values.push(finite(vector(&mut words)?)?);
                if let Some(word) = words.next() {
                    let problem = format!("`{}` follows a normal", cut(word));
                    return Err(FileFault::new(problem, "three coordinates alone"));
                }
            }
            "vt" => {
                count(self.uvs.values.len() + 1)?;
                self.uvs.values.push(texture_coordinates(words)?);
            }
            "f" | "fo" => return self.face(words),
            "mtllib" | "usemtl" => {}
            // Old programs start comments with a dollar sign.
            _ if IGNORED.contains(&keyword) || keyword.starts_with('$') => {}
            _ => return Err(unknown_statement(keyword)),
        }
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<()> {
        // Parse the corners.
        self.face.clear();
        self.face_normals.clear();
        self.face_uvs.clear();
        for word in words {
            let mut indices = word.split('/');
            let mut next = || indices.next().unwrap_or_default();
            let (vertex, texture, normal) = (next(), next(), next());
            let is_texture = texture.is_empty() || texture.parse::<i64>().is_ok();
            if indices.next().is_some() || !is_texture {
                return Err(no_corner(word));
            }
            self.face
                .push(index(vertex, "vertex", self.vertices.len())?);
            if !normal.is_empty() {
                let n = self.normals.values.len();
                self.face_normals.push(index(normal, "normal", n)?);
            }
            // Some programs index texture coordinates that they do not write.
            if !texture.is_empty() && !self.uvs.values.is_empty() {
                let n = self.uvs.values.len();
                self.face_uvs.push(index(texture, "texture coordinate", n)?);
            }
        }
        // Check that all corners have the same attributes, and triangulate them.
        let (n, n_normals) = (self.face.len(), self.face_normals.len());
        if n < 3 {
            let problem = format!("a face has {n} corners");
            return Err(FileFault::new(problem, "at least 3"));
        }
        let n_before = self.mesh.triangles.len();
        if n_normals == n {
            self.normals.triangles.resize(n_before, MISSING);
            self.normals.triangles.extend(fan(&self.face_normals));
        } else if n_normals > 0 {
            let problem = format!("{n_normals} of {n} corners have a normal");
            return Err(FileFault::new(problem, "normals at all corners or at none"));
        }
        if self.face_uvs.len() == n {
            self.uvs.triangles.resize(n_before, MISSING);
            self.uvs.triangles.extend(fan(&self.face_uvs));
        }
        self.mesh.triangles.extend(fan(&self.face));
        self.polygons.add(n_before..self.mesh.triangles.len());
        Ok(())
    }

    /// Parses one line, including statements about materials.
    fn statement_with_materials(
        &mut self,
        line: &str,
        number: u64,
        groups: &mut MaterialGroups,
    ) -> Result<()> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "mtllib" => groups.library(rest.trim(), number),
            "usemtl" => groups.use_material(rest.trim(), number)?,
            _ => {
                self.statement(line)?;
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
        self.uvs = uvs.completed(n, Vec2::ZERO).unwrap_or_default();
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
fn weight_or_color<'a>(words: impl Iterator<Item = &'a str>) -> Result<Option<Vec3>> {
    const EXPECTED: &str = "three coordinates, then a weight or a color of three or four numbers";
    let mut numbers = ArrayVec::<f32, 4>::new();
    for word in words {
        let number = word.parse().ok().filter(|number: &f32| number.is_finite());
        if number.is_none_or(|number| numbers.try_push(number).is_err()) {
            let problem = format!("`{}` follows a vertex", cut(word));
            return Err(FileFault::new(problem, EXPECTED));
        }
    }
    // Programs disagree on which of four numbers are the color.
    let color = <[f32; 3]>::try_from(numbers.as_slice()).ok();
    Ok(color.and_then(|color| light(color).ok()))
}

/// Parses one to three numbers: the first two are the texture coordinates, the second one 0 if it
/// is missing.
fn texture_coordinates<'a>(words: impl Iterator<Item = &'a str>) -> Result<Vec2> {
    let mut numbers = [0.0; 3];
    let mut n = 0;
    for word in words {
        let place = numbers.get_mut(n).ok_or_else(|| {
            let problem = format!("`{}` follows a texture coordinate", cut(word));
            FileFault::new(problem, "one to three numbers")
        })?;
        *place = number(word)?;
        n += 1;
    }
    if n == 0 {
        return Err(FileFault::new("no texture coordinate", "two: u and v"));
    }
    finite([numbers[0], numbers[1]])
}

fn number<T: FromStr>(word: &str) -> Result<T> {
    word.parse()
        .map_err(|_| FileFault::new(format!("`{}` is not a number", cut(word)), "a coordinate"))
}

/// Parses the first three words as numbers.
pub(super) fn vector<'a, T: FromStr + Default>(
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
/// from 0.
fn index(word: &str, kind: &str, n: usize) -> Result<u32> {
    let n = n as i64;
    let found = word.parse::<i64>().ok();
    let index = found.map(|found| if found < 0 { n + found } else { found - 1 });
    match index {
        Some(index) if (0..n).contains(&index) => Ok(index as u32),
        Some(_) => Err(FileFault::new(
            format!("there is no {kind} {}", cut(word)),
            format!("one of the {n} above"),
        )),
        None => Err(FileFault::new(
            format!("`{}` is no {kind}", cut(word)),
            CORNER,
        )),
    }
}

fn no_corner(word: &str) -> FileFault {
    FileFault::new(format!("`{}` is not a corner", cut(word)), CORNER)
}

fn unknown_statement(keyword: &str) -> FileFault {
    FileFault::new(
        format!("unknown statement `{}`", cut(keyword)),
        "an OBJ file of polygons: `v`, `vn` and `f`",
    )
}
