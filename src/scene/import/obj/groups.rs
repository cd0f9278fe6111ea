//! The materials that an OBJ file assigns to its faces.

use std::path::Path;

use super::mtl;
use crate::import::fault::cut;
use crate::import::materials::{MAX_MATERIALS, MeshMaterial, PictureShelf, of_reference, path_in};
use crate::import::{FileFault, FileLocation, Result, Surroundings};
use base::text::did_you_mean;

/// The statements about materials so far.
#[derive(Default)]
pub(super) struct MaterialGroups {
    /// The names of material files, each with its line.
    libraries: Vec<(String, u64)>,
    /// The names of materials, each with the line of its first use.
    used: Vec<(String, u64)>,
    /// The index of the current material name.
    present: Option<u32>,
    /// The group of each triangle; `u32::MAX` for none.
    of_triangles: Vec<u32>,
}

/// The index that means no material.
const NONE: u32 = u32::MAX;

impl MaterialGroups {
    /// Handles `mtllib`.
    pub(super) fn library(&mut self, names: &str, line: u64) {
        if !names.is_empty() && !self.libraries.iter().any(|(known, _)| known == names) {
            self.libraries.push((names.to_owned(), line));
        }
    }

    /// Handles `usemtl`.
    ///
    /// # Errors
    /// There are too many different materials.
    pub(super) fn use_material(&mut self, name: &str, line: u64) -> Result<()> {
        let known = self.used.iter().position(|(known, _)| known == name);
        let index = known.unwrap_or(self.used.len());
        if index == MAX_MATERIALS {
            let expected = format!("at most {MAX_MATERIALS}");
            return Err(FileFault::new("too many materials", expected));
        }
        if known.is_none() {
            self.used.push((name.to_owned(), line));
        }
        self.present = Some(index as u32);
        Ok(())
    }

    /// Assigns the current material to the new triangles, up to this number of triangles.
    pub(super) fn triangles(&mut self, n: usize) {
        self.of_triangles.resize(n, self.present.unwrap_or(NONE));
    }

    /// Returns the materials, and the index of each triangle's material; none if the file names no
    /// material file.
    ///
    /// # Errors
    /// A material file cannot be read, or a material is in none of them.
    pub(super) fn materials(
        mut self,
        around: &Surroundings,
        available: u64,
    ) -> Result<(Vec<MeshMaterial>, Vec<u32>)> {
        if self.libraries.is_empty() {
            return Ok(Default::default());
        }
        let mut known = Vec::new();
        let mut shelf = PictureShelf::new(available);
        for (names, line) in &self.libraries {
            let read = read_library(around.folder, names, &mut shelf, &mut known);
            read.map_err(|fault| fault.at(FileLocation::Line(*line)))?;
        }
        let of_name = |(name, line): &(String, u64)| {
            let found = known.iter().find(|material| material.name == *name);
            found.cloned().ok_or_else(|| unknown(name, *line, &known))
        };
        let mut materials = self.used.iter().map(of_name).collect::<Result<Vec<_>>>()?;
        if self.of_triangles.contains(&NONE) {
            for index in self.of_triangles.iter_mut().filter(|index| **index == NONE) {
                *index = materials.len() as u32;
            }
            materials.push(MeshMaterial::default());
        }
        Ok((materials, self.of_triangles))
    }
}

/// Reads one material file, whose name may contain blanks, or several.
fn read_library(
    folder: &Path,
    names: &str,
    shelf: &mut PictureShelf,
    found: &mut Vec<MeshMaterial>,
) -> Result<()> {
    let whole = path_in(folder, names);
    let files = if whole.is_file() {
        vec![whole]
    } else {
        let names = names.split_ascii_whitespace();
        names.map(|name| path_in(folder, name)).collect()
    };
    for file in files {
        if !file.is_file() {
            let fault = FileFault::new("there is no such file", "the file of materials");
            return Err(of_reference(&file, fault));
        }
        mtl::read(&file, shelf, found).map_err(|fault| fault.in_file(&file))?;
    }
    Ok(())
}

fn unknown(name: &str, line: u64, known: &[MeshMaterial]) -> FileFault {
    let names = known.iter().map(|material| material.name.as_str());
    let problem = format!("there is no material `{}`", cut(name));
    let expected = match did_you_mean(name, names) {
        Some(suggestion) => format!("one of those in `mtllib`: {suggestion}"),
        None => "one of those in `mtllib`".to_owned(),
    };
    FileFault::new(problem, expected).at(FileLocation::Line(line))
}
