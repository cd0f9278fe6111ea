//! The materials and the objects that an OBJ file assigns to its faces.

use std::path::{Path, PathBuf};

use indexmap::IndexSet;

use super::mtl;
use crate::fault::{READABLE, cut};
use crate::materials::{
    MAX_MATERIALS, MeshMaterial, PictureShelf, missing_note, of_reference, path_in,
};
use crate::mesh::Mesh;
use crate::{FileFault, Result, Surroundings};

/// The statements about materials and objects so far.
#[derive(Default)]
pub(super) struct FaceGroups {
    /// The names of material files.
    libraries: Vec<String>,
    /// The names of materials, each with the line of its first use.
    used: Vec<(String, u64)>,
    /// The index of the current material name.
    present: Option<u32>,
    /// The group of each triangle; `u32::MAX` for none.
    of_triangles: Vec<u32>,
    /// The names of objects, or else of groups.
    nodes: IndexSet<String>,
    /// True if there was an object, so that groups no longer count.
    has_objects: bool,
    /// The number of the current name, from 1; 0 for none.
    present_node: u32,
    /// The number of each triangle's name.
    node_of: Vec<u32>,
}

/// The index that means no material.
const NONE: u32 = u32::MAX;

impl FaceGroups {
    /// Handles `mtllib`.
    pub(super) fn library(&mut self, names: &str) {
        if !names.is_empty() && !self.libraries.iter().any(|known| known == names) {
            self.libraries.push(names.to_owned());
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

    /// Handles `o` and `g`: groups count only in front of the first object.
    pub(super) fn node(&mut self, keyword: &str, name: &str) {
        self.has_objects |= keyword == "o";
        if keyword == "o" || !self.has_objects {
            self.present_node = match name {
                "" => 0,
                name => self.nodes.insert_full(name.to_owned()).0 as u32 + 1,
            };
        }
    }

    /// Assigns the current material and name to the new triangles, up to this number of triangles.
    pub(super) fn triangles(&mut self, n: usize) {
        self.node_of.resize(n, self.present_node);
        self.of_triangles.resize(n, self.present.unwrap_or(NONE));
    }

    /// Gives the objects and the materials to a mesh, and the indices of each triangle's ones; no
    /// materials if the file names no material file.
    ///
    /// # Errors
    /// There are too many materials.
    pub(super) fn give_to(
        mut self,
        mesh: &mut Mesh,
        around: &Surroundings,
        available: u64,
    ) -> Result<()> {
        mesh.take_nodes(self.nodes.iter().map(String::as_str), self.node_of);
        if self.libraries.is_empty() {
            return Ok(());
        }
        let mut known = Vec::new();
        let mut shelf = PictureShelf::new(available);
        for names in &self.libraries {
            for file in files_of(around.folder, names) {
                let read = mtl::read(&file, &mut shelf, &mut known, &mut mesh.left_out);
                match read {
                    Err(fault) if fault.expected == READABLE => {
                        let fault = of_reference(&file, fault);
                        shelf.notes.push(missing_note(&fault));
                    }
                    read => read.map_err(|fault| fault.in_file(&file))?,
                }
            }
        }
        for (name, line) in &self.used {
            let found = known.iter().find(|material| material.name == *name);
            if found.is_none() && !known.is_empty() {
                let place = format_args!("`{}` in line {line}", cut(name));
                mesh.left_out.add("materials that no `mtllib` has", place);
            }
            let missing = || MeshMaterial::new(name, MeshMaterial::default().color);
            mesh.materials.push(found.cloned().unwrap_or_else(missing));
        }
        if self.of_triangles.contains(&NONE) {
            for index in self.of_triangles.iter_mut().filter(|index| **index == NONE) {
                *index = mesh.materials.len() as u32;
            }
            mesh.materials.push(MeshMaterial::default());
        }
        mesh.material_of = self.of_triangles;
        mesh.notes.append(&mut shelf.notes);
        Ok(())
    }
}

/// Returns the path of one material file, whose name may contain blanks, or of several.
fn files_of(folder: &Path, names: &str) -> Vec<PathBuf> {
    let whole = path_in(folder, names);
    if whole.is_file() {
        return vec![whole];
    }
    let names = names.split_ascii_whitespace();
    names.map(|name| path_in(folder, name)).collect()
}
