//! The `objects` section.

use std::fmt;
use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::{Serialize, Serializer};

use super::file::GeometryFile;
use super::generator::Generator;
use super::instances::InstancedMesh;
use super::tube::Tube;
use world::geometry::{KeyedShape, Shape, TransformStep};
use world::kinds;
use world::values::{self, NonEmpty};

/// One of the scene file's `objects`: a geometry under its own key, a material,
/// and optionally a name and a transform.
///
/// ```
/// # use raycost_scene::config::Object;
/// let object: Object = raycost_scene::yaml::from_str("
/// box: { min: [-1, -1, -1], max: [1, 1, 1] }
/// material: red
/// name: tilted box                       # for reports, optional
/// transform:                             # steps, applied in this order
///   - rotate: { axis: [0, 1, 0], angle_deg: 30 }
///   - translate: [0, 1, 4]
/// ").unwrap();
/// # assert_eq!(object.transform.len(), 2);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(
    deny_unknown_fields,
    transform = values::expected::<Self>,
    transform = values::one_needed("material mesh instances"),
)]
pub struct Object {
    /// The name in tables, arrays and messages.
    #[serde(with = "values::Name")]
    #[schemars(default)]
    pub name: Option<String>,
    /// The geometry.
    #[serde(flatten)]
    pub geometry: Geometry,
    /// The name of the material; many spheres may have several, and a mesh none.
    #[serde(skip_serializing_if = "MaterialNames::is_of_file")]
    #[schemars(default)]
    pub material: MaterialNames,
    /// The transform to world space; empty for the identity.
    #[schemars(default)]
    pub transform: Vec<TransformStep>,
}

/// The geometry of an object.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Geometry {
    /// A tube through points.
    Tube(Tube),
    /// A mesh at many places.
    Instances(Box<InstancedMesh>),
    /// One shape.
    #[serde(untagged)]
    Shape(KeyedShape),
    /// Many shapes from a generator.
    #[serde(untagged)]
    Generator(Generator),
    /// Many shapes from a file.
    #[serde(untagged)]
    File(GeometryFile),
}

/// One or more material names: `red` or `[red, green]`; none for the materials of a file.
#[derive(Debug, Clone, Default, PartialEq, JsonSchema)]
#[schemars(with = "values::Either<values::Text, Names>", transform = values::expected::<Self>)]
pub struct MaterialNames(pub Vec<String>);

impl MaterialNames {
    fn is_of_file(&self) -> bool {
        self.0.is_empty()
    }
}

impl Serialize for MaterialNames {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match self.0.as_slice() {
            [name] => s.serialize_str(name),
            names => names.serialize(s),
        }
    }
}

/// Formats the YAML key.
impl fmt::Display for Geometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape(shape) => f.write_str(shape.key()),
            Self::Generator(generator) => generator.fmt(f),
            Self::Tube(_) => f.write_str(Tube::KEY),
            Self::File(file) => file.fmt(f),
            Self::Instances(_) => f.write_str(InstancedMesh::KEY),
        }
    }
}

impl Object {
    /// Returns the name, or the kind and the position in the list.
    pub fn label(&self, index: usize) -> String {
        match &self.name {
            Some(name) => name.clone(),
            None => format!("{} {index}", self.geometry),
        }
    }
}

/// The keys that all objects share.
const COMMON: [&str; 3] = ["material", "name", "transform"];

/// The keys of geometries.
static GEOMETRIES: LazyLock<Vec<&str>> = LazyLock::new(|| {
    [
        Shape::KEYS,
        &[Tube::KEY, InstancedMesh::KEY],
        Generator::KEYS,
        GeometryFile::KEYS,
    ]
    .concat()
});

/// All keys.
static KEYS: LazyLock<Vec<&str>> = LazyLock::new(|| [&GEOMETRIES, &COMMON[..]].concat());

impl<'de> Deserialize<'de> for Object {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_map(ObjectVisitor)
    }
}

struct ObjectVisitor;

impl<'de> Visitor<'de> for ObjectVisitor {
    type Value = Object;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object such as { sphere: { … }, material: … }")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Object, A::Error> {
        let (mut name, mut geometry, mut material, mut transform) = (None, None, None, Vec::new());
        while let Some(ObjectKey(key)) = map.next_key()? {
            match key {
                "name" => name = Some(map.next_value::<Name>()?.0),
                "material" => material = Some(map.next_value()?),
                "transform" => transform = map.next_value()?,
                _ if geometry.is_some() => map.next_value::<SecondShape>().map(drop)?,
                _ => geometry = next_geometry(key, &mut map)?,
            }
        }
        let geometry = geometry.ok_or_else(|| {
            let keys = GEOMETRIES.join("`, `");
            A::Error::custom(format!("needs a shape, expected one of `{keys}`"))
        })?;
        let of_file = matches!(
            geometry,
            Geometry::File(GeometryFile::Mesh(_)) | Geometry::Instances(_)
        );
        let material = material.or_else(|| of_file.then(MaterialNames::default));
        Ok(Object {
            name,
            geometry,
            material: material.ok_or_else(|| A::Error::missing_field("material"))?,
            transform,
        })
    }
}

/// An object's name.
#[derive(serde::Deserialize)]
struct Name(#[serde(with = "values::Name")] String);

/// A value whose deserialization always fails, at the position of the second shape.
struct SecondShape;

impl<'de> Deserialize<'de> for SecondShape {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(D::Error::custom(
            "cannot be in the same object, expected one shape: begin the next with `- `",
        ))
    }
}

fn next_geometry<'de, A: MapAccess<'de>>(
    key: &str,
    map: &mut A,
) -> Result<Option<Geometry>, A::Error> {
    if let Some(shape) = KeyedShape::next_value(key, map)? {
        return Ok(Some(Geometry::Shape(shape)));
    }
    if key == Tube::KEY {
        return map.next_value().map(|tube| Some(Geometry::Tube(tube)));
    }
    if key == InstancedMesh::KEY {
        return map.next_value().map(|mesh| Some(Geometry::Instances(mesh)));
    }
    if let Some(generator) = Generator::next_value(key, map)? {
        return Ok(Some(Geometry::Generator(generator)));
    }
    Ok(GeometryFile::next_value(key, map)?.map(Geometry::File))
}

/// One of [`KEYS`].
struct ObjectKey(&'static str);

impl<'de> Deserialize<'de> for ObjectKey {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let found = String::deserialize(d)?;
        match KEYS.iter().find(|key| **key == found) {
            Some(key) => Ok(Self(key)),
            None => Err(D::Error::unknown_field(&found, &KEYS)),
        }
    }
}

impl<'de> Deserialize<'de> for MaterialNames {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(MaterialNamesVisitor)
    }
}

kinds! {
    Names: Vec<String> = NonEmpty::<String>::of("material name");
}

struct MaterialNamesVisitor;

impl<'de> Visitor<'de> for MaterialNamesVisitor {
    type Value = MaterialNames;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a material, or a list of names")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<MaterialNames, E> {
        Ok(MaterialNames(vec![name.to_owned()]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<MaterialNames, A::Error> {
        Names::deserialize(SeqAccessDeserializer::new(list)).map(MaterialNames)
    }
}
