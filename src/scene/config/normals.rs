//! The shading normals of meshes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

use base::keywords;
use world::kinds;
use world::values::{Number, WordChoice, WordOr};

/// The shading normals of a mesh.
///
/// ```
/// # use raycost_scene::config::MeshNormals;
/// let keyword: MeshNormals = raycost_scene::yaml::from_str("smooth").unwrap();
/// let with_edges: MeshNormals = raycost_scene::yaml::from_str("
/// smooth: { angle_deg: 30 }   # edges of more than this angle stay sharp
/// ").unwrap();
/// # assert!(keyword != with_edges);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(from = "WordOr<NormalsWord, NormalsKeys>")]
pub enum MeshNormals {
    /// The normals in the file, else flat ones; of an isosurface, from the gradient.
    #[default]
    File,
    /// The means of the adjacent triangles' normals.
    Smooth(Option<Creases>),
    /// The geometric normals of the triangles.
    Flat,
}

/// Edges at which smooth normals stop.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(deny_unknown_fields, expecting = "creases such as { angle_deg: 30 }")]
pub struct Creases {
    /// The largest angle between the normals of two triangles at a smooth edge, 0 to 180.
    #[serde(with = "CreaseAngle")]
    pub angle_deg: f32,
}

kinds! {
    CreaseAngle: f32 = Number { expected: "an angle from 0 to 180", ranges: &[[0.0, 180.0]] };
}

keywords! {
    /// Normals as a word.
    enum NormalsWord {
        /// The normals in the file, else flat ones; of an isosurface, from the gradient.
        File = "file",
        /// The means of the adjacent triangles' normals.
        Smooth = "smooth",
        /// The geometric normals of the triangles.
        Flat = "flat",
    }
}

impl WordChoice for NormalsWord {
    const EXPECTED: &'static str = "`file`, `smooth` or `flat`";
}

/// Normals with keys.
#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(deny_unknown_fields, expecting = "normals such as `smooth`")]
struct NormalsKeys {
    /// The normals of `smooth`, except at creases.
    smooth: Creases,
}

impl From<WordOr<NormalsWord, NormalsKeys>> for MeshNormals {
    fn from(found: WordOr<NormalsWord, NormalsKeys>) -> Self {
        match found {
            WordOr::Word(NormalsWord::File) => Self::File,
            WordOr::Word(NormalsWord::Smooth) => Self::Smooth(None),
            WordOr::Word(NormalsWord::Flat) => Self::Flat,
            WordOr::Keys(NormalsKeys { smooth }) => Self::Smooth(Some(smooth)),
        }
    }
}

impl Serialize for MeshNormals {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::File => NormalsWord::File.serialize(s),
            Self::Flat => NormalsWord::Flat.serialize(s),
            Self::Smooth(None) => NormalsWord::Smooth.serialize(s),
            Self::Smooth(Some(smooth)) => NormalsKeys { smooth }.serialize(s),
        }
    }
}
