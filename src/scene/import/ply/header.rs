//! The header of a mesh, checked.

use std::collections::HashSet;

use serde_ply::{ElementDef, PlyHeader, PropertyType, ScalarType};

use crate::import::fault::cut;
use crate::import::mesh::count;
use crate::import::{FileFault, Result};

/// The accepted names of a face's list of vertices.
const FACE_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The properties of a mesh that its header defines.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshHeader {
    pub(super) n_vertices: u32,
    /// True if vertices have normals.
    pub(super) has_normals: bool,
    /// The names of the vertices' texture coordinates, if there are any.
    pub(super) uvs: Option<UvNames>,
    /// The greatest value of the vertices' color channels, if there are any.
    pub(super) color_maximum: Option<f32>,
}

/// The names of the properties that are texture coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) enum UvNames {
    /// `u` and `v`.
    Uv,
    /// `s` and `t`.
    St,
    /// `texture_u` and `texture_v`.
    TextureUv,
}

const UV_NAMES: [(UvNames, [&str; 2]); 3] = [
    (UvNames::Uv, ["u", "v"]),
    (UvNames::St, ["s", "t"]),
    (UvNames::TextureUv, ["texture_u", "texture_v"]),
];

impl MeshHeader {
    /// Checks that a header defines vertices and faces, each element and property
    /// once.
    pub(super) fn new(header: &PlyHeader) -> Result<Self> {
        let mut names = HashSet::new();
        for element in &header.elem_defs {
            expect_new(&mut names, &element.name, "element")?;
            check(element)?;
        }
        let vertex = find(header, "vertex")?;
        for name in ["x", "y", "z"] {
            expect_scalar(vertex, name)?;
        }
        let has_normals = vertex.has_property("nx");
        if has_normals {
            expect_scalar(vertex, "nx")?;
            expect_scalar(vertex, "ny")?;
            expect_scalar(vertex, "nz")?;
        }
        let mut uvs = UV_NAMES.into_iter();
        let uvs = uvs.find(|(_, names)| names.iter().all(|name| is_scalar(vertex, name)));
        let color_maximum = color_maximum(vertex);
        let [faces, strips] = ["face", "tristrips"].map(|name| header.get_element(name));
        match (faces, strips) {
            (Some(faces), _) => expect_list(faces)?,
            (None, Some(_)) => {}
            (None, None) => {
                find(header, "face")?;
            }
        }
        if let Some(strips) = strips {
            expect_list(strips)?;
        }
        Ok(Self {
            n_vertices: count(vertex.count)?,
            has_normals,
            uvs: uvs.map(|(names, _)| names),
            color_maximum,
        })
    }
}

/// Checks that the element's rows are not empty, so that reading them ends, and that its properties
/// have distinct names.
fn check(element: &ElementDef) -> Result<()> {
    let mut names = HashSet::new();
    for property in &element.properties {
        expect_new(&mut names, &property.name, "property")?;
    }
    if names.is_empty() {
        Err(FileFault::new(
            format!("element `{}` has no properties", cut(&element.name)),
            "at least one",
        ))
    } else {
        Ok(())
    }
}

/// Adds a name, which must be new.
fn expect_new<'a>(names: &mut HashSet<&'a str>, name: &'a str, kind: &str) -> Result<()> {
    if !names.insert(name) {
        Err(FileFault::new(
            format!("the header has {kind} `{}` twice", cut(name)),
            "different names",
        ))
    } else {
        Ok(())
    }
}

fn find<'a>(header: &'a PlyHeader, name: &str) -> Result<&'a ElementDef> {
    header.get_element(name).ok_or_else(|| {
        FileFault::new(
            format!("the header has no element `{name}`"),
            "elements `vertex` and `face`",
        )
    })
}

fn expect_scalar(vertex: &ElementDef, name: &str) -> Result<()> {
    if is_scalar(vertex, name) {
        return Ok(());
    }
    Err(FileFault::new(
        format!("element `vertex` has no number `{name}`"),
        format!("`property float {name}` in the header"),
    ))
}

fn is_scalar(vertex: &ElementDef, name: &str) -> bool {
    let property = vertex.get_property(name);
    let kind = property.map(|property| &property.property_type);
    matches!(kind, Some(PropertyType::Scalar(_)))
}

/// Returns the value of a channel at full light, if vertices have colors.
fn color_maximum(vertex: &ElementDef) -> Option<f32> {
    let kind = |name| match vertex.get_property(name)?.property_type {
        PropertyType::Scalar(kind) => Some(kind),
        PropertyType::List { .. } => None,
    };
    let [red, green, blue] = ["red", "green", "blue"].map(kind);
    let kind = red.filter(|_| red == green && green == blue)?;
    match kind {
        ScalarType::U8 => Some(255.0),
        ScalarType::U16 => Some(65_535.0),
        ScalarType::F32 | ScalarType::F64 => Some(1.0),
        _ => None,
    }
}

fn expect_list(face: &ElementDef) -> Result<()> {
    let name = &face.name;
    let is_whole = |kind: &ScalarType| !matches!(kind, ScalarType::F32 | ScalarType::F64);
    let lists = FACE_LISTS.map(|name| face.get_property(name));
    let mut lists = lists.iter().flatten().map(|list| &list.property_type);
    match (lists.next(), lists.next()) {
        (
            Some(PropertyType::List {
                count_type,
                data_type,
            }),
            None,
        ) if is_whole(count_type) && is_whole(data_type) => Ok(()),
        _ => Err(FileFault::new(
            format!("element `{name}` has no list of vertices"),
            "`property list uchar int vertex_indices` in the header",
        )),
    }
}
