//! Config → [`Scene`]: everything placed in world space, ids instead of names.
//!
//! Takes a checked [`Config`]; gives what the tracer reads, or a
//! [`Fault`] where two places of the file do not fit together: a material that
//! nobody defines, a transform that flattens its object.

mod primitive;

use crate::camera::ImagePlane;
use crate::config::{Background, Config, Geometry, Object, Shading};
use crate::geometry::{Shape, Transform};
use crate::light::Light;
use crate::material::Material;
use crate::yaml::{Fault, Path, did_you_mean};

pub use primitive::{MaterialId, ObjectId, Primitive};

/// A scene in world space.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Where the pixels lie.
    pub image_plane: ImagePlane,
    /// What rays see that hit nothing.
    pub background: Background,
    /// How light is computed.
    pub shading: Shading,
    /// The lights.
    pub lights: Vec<Light>,
    /// The materials, by [`MaterialId`].
    pub materials: Vec<Material>,
    /// All that rays can hit, object by object.
    pub primitives: Vec<Primitive>,
}

impl Scene {
    /// The scene of a config.
    ///
    /// # Errors
    /// The first place of the file that does not fit the others.
    pub fn new(config: &Config) -> Result<Self, Fault> {
        if config.objects.is_empty() {
            return Err(Fault::new(
                Path::default().key("objects"),
                "the scene has no objects",
                "expected at least one",
            )
            .with_help("add `- sphere: { center: [0, 0, 0], radius: 1 }` with a `material`"));
        }
        let mut primitives = Vec::with_capacity(n_primitives(config));
        for (index, object) in config.objects.iter().enumerate() {
            let path = Path::default().key("objects").index(index);
            let materials = material_ids(config, object, &path)?;
            place(
                object,
                ObjectId(index as u32),
                &materials,
                &path,
                &mut primitives,
            )?;
        }
        Ok(Self {
            image_plane: config
                .camera
                .image_plane(config.image.width, config.image.height),
            background: config.background,
            shading: config.shading,
            lights: config.lights.clone(),
            materials: config.materials.values().cloned().collect(),
            primitives,
        })
    }

    /// The material with this id.
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }
}

/// How many primitives the config's objects make.
pub fn n_primitives(config: &Config) -> usize {
    let of_object = |object: &Object| match &object.geometry {
        Geometry::Shape(_) => 1,
        Geometry::Generator(generator) => generator.n_spheres(),
    };
    config.objects.iter().map(of_object).sum()
}

fn material_ids(config: &Config, object: &Object, path: &Path) -> Result<Vec<MaterialId>, Fault> {
    let names = &object.material.0;
    let path = path.clone().key("material");
    if let (Geometry::Shape(shape), true) = (&object.geometry, names.len() > 1) {
        let message = format!("a {shape} has one material, not {}", names.len());
        return Err(Fault::new(path, message, "expected one name")
            .with_help("a list of names is for generators, which deal them out"));
    }
    let id_of = |(i, name): (usize, &String)| match config.materials.get_index_of(name) {
        Some(id) => Ok(MaterialId(id as u32)),
        None => Err(unknown_material(config, name, path.clone().index(i))),
    };
    names.iter().enumerate().map(id_of).collect()
}

fn unknown_material(config: &Config, name: &str, path: Path) -> Fault {
    let known: Vec<&str> = config.materials.keys().map(String::as_str).collect();
    let list = match known.is_empty() {
        true => "there are no `materials`".to_owned(),
        false => format!("the materials are {}", known.join(", ")),
    };
    let help = match did_you_mean(name, known) {
        Some(suggestion) => format!("{suggestion} ({list})"),
        None => list,
    };
    Fault::new(
        path,
        format!("unknown material `{name}`"),
        "expected a key of `materials`",
    )
    .with_help(help)
}

/// Adds the object's primitives.
fn place(
    object: &Object,
    id: ObjectId,
    materials: &[MaterialId],
    path: &Path,
    primitives: &mut Vec<Primitive>,
) -> Result<(), Fault> {
    let transform = match object.transform.as_slice() {
        [] => None,
        steps => Some(Transform::of_steps(steps).ok_or_else(|| out_of_range(object, path))?),
    };
    let mut add = |shape, material| {
        let primitive = Primitive::new(shape, transform.as_ref(), id, material);
        let sane = primitive.is_sane();
        primitives.push(primitive);
        sane.then_some(()).ok_or_else(|| out_of_range(object, path))
    };
    match &object.geometry {
        Geometry::Shape(shape) => add(shape.clone(), materials[0]),
        Geometry::Generator(generator) => (0..generator.n_spheres()).try_for_each(|i| {
            let (sphere, material) = generator.sphere(i, materials.len());
            add(Shape::Sphere(sphere), materials[material])
        }),
    }
}

/// The fault of an object whose size 32-bit numbers cannot hold at its place.
fn out_of_range(object: &Object, path: &Path) -> Fault {
    let (key, help) = match object.transform.is_empty() {
        true => (
            object.geometry.to_string(),
            "make it larger, or bring it nearer to the origin",
        ),
        false => (
            "transform".to_owned(),
            "bring the `scale` factors nearer to 1, and the object nearer to the origin",
        ),
    };
    Fault::new(
        path.clone().key(key),
        format!("`{path}` is too small, too large or too far away"),
        "expected coordinates within 1e16, and a size that shows in their 7 digits",
    )
    .with_help(help)
}
