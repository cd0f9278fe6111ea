//! Config → [`Scene`]: everything placed in world space, ids instead of names.
//!
//! Takes a checked [`Config`] and its [`Geometries`]; gives what the tracer
//! reads, or a [`Fault`] where two places of the file do not fit together: a
//! material that nobody defines, a transform that flattens its object.

mod primitive;
mod geometries;
mod attributes;
mod place;

use glam::Vec3;

use crate::camera::ImagePlane;
use crate::config::{Background, Config, Geometry, GeometryFile, Object, Shading};
use crate::light::Light;
use crate::material::Material;
use crate::yaml::{Fault, Path, did_you_mean};

use attributes::Attributes;
use place::Place;

pub use geometries::Geometries;
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
    /// How many triangles of meshes were left out because they have no area.
    pub n_degenerate: u64,
    /// What the primitives of an object have beside, by [`ObjectId`].
    attributes: Vec<ObjectAttributes>,
}

#[derive(Debug, Clone)]
struct ObjectAttributes {
    /// The object's first primitive.
    first: u32,
    attributes: Attributes,
}

impl Scene {
    /// The scene of a config whose objects are made of `geometries`.
    ///
    /// # Errors
    /// The first place of the file that does not fit the others.
    pub fn new(config: &Config, geometries: Geometries) -> Result<Self, Fault> {
        if config.objects.is_empty() {
            return Err(Fault::new(
                Path::default().key("objects"),
                "the scene has no objects",
                "expected at least one",
            )
            .with_help("add `- sphere: { center: [0, 0, 0], radius: 1 }` with a `material`"));
        }
        let mut scene = Self {
            image_plane: config
                .camera
                .image_plane(config.image.width, config.image.height),
            background: config.background,
            shading: config.shading,
            lights: config.lights.clone(),
            materials: config.materials.values().cloned().collect(),
            primitives: Vec::with_capacity(geometries.n_primitives()),
            n_degenerate: 0,
            attributes: Vec::with_capacity(config.objects.len()),
        };
        for (index, (object, solid)) in config.objects.iter().zip(geometries.0).enumerate() {
            let path = Path::default().key("objects").index(index);
            let materials = material_ids(config, object, &path)?;
            let first = scene.primitives.len() as u32;
            let place = Place::new(object, ObjectId(index as u32), &materials, &path)?;
            let attributes = place.solid(solid, &mut scene)?;
            scene
                .attributes
                .push(ObjectAttributes { first, attributes });
        }
        Ok(scene)
    }

    /// How many objects.
    pub fn n_objects(&self) -> usize {
        self.attributes.len()
    }

    /// The material with this id.
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }

    /// The colour of this primitive at a point of it: its own if it has one,
    /// or its material's.
    pub fn color(&self, primitive: u32, point: Vec3) -> Vec3 {
        let found = &self.primitives[primitive as usize];
        match self.attributes(primitive) {
            (Attributes::Colors(colors), i) => Vec3::from(colors[i].map(f32::from)) / 255.0,
            _ => self.material(found.material).color.color_at(point),
        }
    }

    /// The unit normal that this primitive is shaded with at a point of it, on
    /// either side; `None` for that of its shape.
    pub fn shading_normal(&self, primitive: u32, point: Vec3) -> Option<Vec3> {
        match self.attributes(primitive) {
            (Attributes::Normals(normals), i) => {
                normals.at(&self.primitives[primitive as usize], i, point)
            }
            _ => None,
        }
    }

    /// The attributes of the primitive's object, and its number among that
    /// object's primitives.
    fn attributes(&self, primitive: u32) -> (&Attributes, usize) {
        let object = self.primitives[primitive as usize].object;
        let ObjectAttributes { first, attributes } = &self.attributes[object.0 as usize];
        (attributes, (primitive - first) as usize)
    }
}

fn material_ids(config: &Config, object: &Object, path: &Path) -> Result<Vec<MaterialId>, Fault> {
    let names = &object.material.0;
    let path = path.clone().key("material");
    let takes_many = matches!(
        object.geometry,
        Geometry::Generator(_) | Geometry::File(GeometryFile::Spheres(_))
    );
    if names.len() > 1 && !takes_many {
        let message = format!(
            "a {} has one material, not {}",
            object.geometry,
            names.len()
        );
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
