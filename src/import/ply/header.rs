//! The header of a mesh or a point cloud, checked.

use std::collections::HashSet;

use serde_ply::{ElementDef, PlyHeader, PropertyType, ScalarType};

use crate::fault::cut;
use crate::mesh::count;
use crate::{FileFault, Result};

/// The accepted names of a face's list of vertices.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The names that programs give to the properties of texture coordinates.
const UVS: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];

/// The names that programs give to the properties of colors.
const COLORS: [[&str; 3]; 3] = [
    ["red", "green", "blue"],
    ["r", "g", "b"],
    ["diffuse_red", "diffuse_green", "diffuse_blue"],
];

/// The beginning of a comment that names a picture, as MeshLab and others write it.
const PICTURE: &str = "TextureFile ";

/// The properties of a mesh, as indices of their element's properties.
#[derive(Debug, Clone, Default)]
pub(super) struct MeshHeader {
    pub(super) n_vertices: u32,
    pub(super) position: [usize; 3],
    pub(super) normal: Option<[usize; 3]>,
    pub(super) uv: Option<[usize; 2]>,
    pub(super) color: Option<ColorProperties>,
    pub(super) face: FaceProperties,
    /// The list of vertices of `tristrips`.
    pub(super) strip: usize,
    /// The names of pictures.
    pub(super) pictures: Vec<String>,
}

/// The properties of a face.
#[derive(Debug, Clone, Default)]
pub(super) struct FaceProperties {
    /// The list of vertices.
    pub(super) corners: usize,
    /// The list of the texture coordinates of its corners.
    pub(super) uvs: Option<usize>,
    pub(super) color: Option<ColorProperties>,
    /// The number of its picture.
    pub(super) picture: Option<usize>,
}

/// The properties of a color.
#[derive(Debug, Clone, Copy)]
pub(super) struct ColorProperties {
    pub(super) channels: [usize; 3],
    /// The value of a channel at full light.
    pub(super) maximum: f32,
}

impl MeshHeader {
    /// Checks that a header defines vertices, each element and property once, and finds the
    /// properties of vertices and faces.
    pub(super) fn new(header: &PlyHeader) -> Result<Self> {
        let mut names = HashSet::new();
        for element in &header.elem_defs {
            expect_new(&mut names, &element.name, "element")?;
            check(element)?;
        }
        let vertex = header.get_element("vertex").ok_or_else(|| {
            FileFault::new(
                "the header has no element `vertex`",
                "elements `vertex` and `face`",
            )
        })?;
        let mut found = Self {
            n_vertices: count(vertex.count)?,
            position: expect_numbers(vertex, ["x", "y", "z"])?,
            uv: UVS.iter().find_map(|names| numbers(vertex, names)),
            color: ColorProperties::of(vertex),
            pictures: pictures(header),
            ..Self::default()
        };
        if vertex.has_property("nx") {
            found.normal = Some(expect_numbers(vertex, ["nx", "ny", "nz"])?);
        }
        if let Some(face) = header.get_element("face") {
            let list = |name| position(face, name, |of| matches!(of, PropertyType::List { .. }));
            found.face = FaceProperties {
                corners: expect_corners(face)?,
                uvs: list("texcoord"),
                color: ColorProperties::of(face),
                picture: position(face, "texnumber", is_number),
            };
        }
        if let Some(strips) = header.get_element("tristrips") {
            found.strip = expect_corners(strips)?;
        }
        Ok(found)
    }
}

impl ColorProperties {
    /// Finds the color of an element.
    fn of(element: &ElementDef) -> Option<Self> {
        let channels = COLORS.iter().find_map(|names| numbers(element, names))?;
        let kinds = channels.map(|channel| match element.properties[channel].property_type {
            PropertyType::Scalar(kind) => Some(kind),
            PropertyType::List { .. } => None,
        });
        let maximum = match kinds {
            [Some(red), Some(green), Some(blue)] if red == green && green == blue => match red {
                ScalarType::U8 => 255.0,
                ScalarType::U16 => 65_535.0,
                ScalarType::F32 | ScalarType::F64 => 1.0,
                _ => return None,
            },
            _ => return None,
        };
        Some(Self { channels, maximum })
    }
}

/// Returns the names of pictures in the comments.
fn pictures(header: &PlyHeader) -> Vec<String> {
    let names = header.comments.iter();
    let names = names.filter_map(|comment| comment.strip_prefix(PICTURE));
    names.map(str::to_owned).collect()
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

/// Returns the index of a property of this name and a type that `is_right` accepts.
fn position(
    element: &ElementDef,
    name: &str,
    is_right: impl Fn(&PropertyType) -> bool,
) -> Option<usize> {
    let mut properties = element.properties.iter();
    properties.position(|property| property.name == name && is_right(&property.property_type))
}

fn is_number(kind: &PropertyType) -> bool {
    matches!(kind, PropertyType::Scalar(_))
}

/// Returns the indices of numbers with these names, if there are all of them.
fn numbers<const N: usize>(element: &ElementDef, names: &[&str; N]) -> Option<[usize; N]> {
    let found = names.map(|name| position(element, name, is_number));
    let is_whole = found.iter().all(Option::is_some);
    is_whole.then(|| found.map(Option::unwrap_or_default))
}

/// Returns the indices of numbers of the vertices.
fn expect_numbers<const N: usize>(vertex: &ElementDef, names: [&str; N]) -> Result<[usize; N]> {
    let mut missing = names
        .iter()
        .filter(|name| position(vertex, name, is_number).is_none());
    numbers(vertex, &names).ok_or_else(|| {
        let name = missing.next().unwrap_or(&"x");
        FileFault::new(
            format!("element `vertex` has no number `{name}`"),
            format!("`property float {name}` in the header"),
        )
    })
}

/// Returns the index of the list of vertices of an element.
fn expect_corners(element: &ElementDef) -> Result<usize> {
    let is_whole = |kind: &ScalarType| !matches!(kind, ScalarType::F32 | ScalarType::F64);
    let is_list = |kind: &PropertyType| match kind {
        PropertyType::List {
            count_type,
            data_type,
        } => is_whole(count_type) && is_whole(data_type),
        PropertyType::Scalar(_) => false,
    };
    match CORNERS.map(|name| {
        element
            .has_property(name)
            .then(|| position(element, name, is_list))
    }) {
        [Some(Some(list)), None] | [None, Some(Some(list))] => Ok(list),
        _ => Err(FileFault::new(
            format!("element `{}` has no list of vertices", element.name),
            "`property list uchar int vertex_indices` in the header",
        )),
    }
}
