//! Config → [`Scene`]: everything placed in render space, ids instead of names.
//!
//! Takes a checked [`Config`] and its [`Geometries`]; returns the tracer's input, or a [`Fault`] if
//! two parts of the file contradict each other: an undefined material, a transform without an
//! inverse.

mod primitive;
mod instances;
mod pictures;
mod arrays;
mod own_materials;
mod geometries;
mod vertex_colors;
mod attributes;
mod surface_class;
mod space;
mod placement;
mod lower_level;
mod emitter;
mod environment;
mod fog;
mod light_source;
mod light_choice;
mod lights;
mod timeline;
mod sensor;

use glam::Vec3;

use crate::background::Background;
use crate::config::{Config, Geometry, GeometryFile, Object, Shading, ShadingModel};
use crate::fog::FogSphere;
use crate::geometry::RenderSpace;
use crate::material::{ArrayTexture, FactorPictures, Material, MaterialKind, TexturePoint};
use crate::yaml::{Fault, FieldPath};
use base::text::{did_you_mean, keyword_name};
use math::simd::Vector;

use attributes::Attributes;
pub use attributes::{
    AttributeKind, interpolated_color, interpolated_normal, interpolated_scalar, scalar_along,
    with_uv,
};
use geometries::ObjectGeometry;
use lower_level::LowerLevel;
use placement::{Needs, Placement};

pub use emitter::Emitter;
pub use environment::EnvironmentLight;
pub use geometries::Geometries;
pub use instances::{Instance, InstanceId, Instances, PlacedPrimitive, World};
pub use light_source::LightNumbers;
pub use lights::{LightOrigin, Lights};
pub use primitive::{MaterialId, ObjectId, Primitive};
pub use sensor::Sensor;
pub use surface_class::SurfaceClass;
pub use timeline::{SceneFrame, Timeline};

/// A scene in render space.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The space of all coordinates and lengths, with the way back to world space.
    pub space: RenderSpace,
    /// The radiance of rays without a hit.
    pub background: Background,
    /// The shading model and its parameters.
    pub shading: Shading,
    /// The fog around the objects.
    pub fog: Option<FogSphere>,
    /// The lights.
    pub lights: Lights,
    /// The materials, by [`MaterialId`].
    pub materials: Vec<Material>,
    /// Everything that rays can hit, object by object; with instances in the order of [`World`].
    pub primitives: Vec<Primitive>,
    /// The instanced meshes, if there are any.
    pub instances: Option<Instances>,
    /// The classes of the primitives.
    classes: Vec<SurfaceClass>,
    /// True if any material is a dielectric.
    has_media: bool,
    /// True if light passes any material in part or at holes.
    has_openings: bool,
    /// True if light passes any material in part.
    has_veils: bool,
    /// True if any material has a picture.
    pub has_images: bool,
    /// True if pictures vary the roughness, the metallicness or the emission of any material.
    pub has_factors: bool,
    /// Number of triangles of meshes that were left out because they have no area.
    pub n_degenerate: u64,
    /// Sentences about what files may have meant otherwise, or what is left out of them.
    pub notes: Vec<String>,
    /// The attributes of the objects' primitives, by [`ObjectId`].
    attributes: Vec<ObjectAttributes>,
}

/// Checks the settings that may contradict each other.
fn check(config: &Config) -> Result<(), Fault> {
    if config.objects.is_empty() {
        let objects = FieldPath::default().key("objects");
        let fault = Fault::new(objects, "the scene has no objects", "expected at least one");
        let help = "add `- sphere: { center: [0, 0, 0], radius: 1 }` with a `material`";
        return Err(fault.with_help(help));
    }
    check_materials(config)?;
    fog::check(config)?;
    config.image.check_sampling()
}

#[derive(Debug, Clone)]
struct ObjectAttributes {
    /// The index of the object's first primitive.
    first: u32,
    attributes: Attributes,
}

impl Scene {
    /// Creates the scene of a config and the geometries of its objects.
    ///
    /// # Errors
    /// The first value of the file that contradicts others.
    pub fn new(config: &Config, geometries: Geometries) -> Result<Self, Fault> {
        let space = space::render_space(config, &geometries);
        Self::in_space(config, geometries, space)
    }

    /// Creates the same scene in another render space.
    ///
    /// # Errors
    /// The first value of the file that contradicts others.
    pub fn in_space(
        config: &Config,
        geometries: Geometries,
        space: RenderSpace,
    ) -> Result<Self, Fault> {
        check(config)?;
        let mut scene = Self::without_objects(config, &geometries, space);
        scene.complete_materials(config, &geometries)?;
        let lower_level = scene.place_objects(config, geometries)?;
        // The instances, the fog and the lights need all primitives.
        if scene.scatters_paths() {
            lower_level.check_emission(config)?;
        }
        lower_level.add_to(&mut scene);
        scene.add_fog(config);
        scene.add_lights(config);
        Ok(scene)
    }

    /// Returns the scene with its settings and materials, but neither objects nor lights.
    fn without_objects(config: &Config, geometries: &Geometries, space: RenderSpace) -> Self {
        let has = |is_such: fn(&Material) -> bool| config.materials.values().any(is_such);
        let is_path = config.shading.model == ShadingModel::Path;
        let masking = is_path.then_some(config.shading.masking);
        let materials = config.materials.values().cloned();
        Self {
            space,
            background: geometries.pictures.background(config),
            shading: config.shading.in_space(&space),
            fog: None,
            lights: Lights::default(),
            materials: materials
                .map(|material| material.in_scene(&space, masking))
                .collect(),
            has_media: has(|material| material.kind.medium().is_some()),
            has_openings: has(|material| material.opacity.is_some()),
            has_veils: has(Material::is_veil),
            has_images: has(Material::has_images),
            has_factors: has(|material| material.factors != FactorPictures::default()),
            primitives: Vec::with_capacity(geometries.n_primitives()),
            instances: None,
            classes: Vec::with_capacity(geometries.n_primitives()),
            n_degenerate: 0,
            notes: geometries.notes.clone(),
            attributes: Vec::with_capacity(config.objects.len()),
        }
    }

    /// Gives the materials their pictures and the colors of arrays.
    fn complete_materials(
        &mut self,
        config: &Config,
        geometries: &Geometries,
    ) -> Result<(), Fault> {
        for (name, material) in config.materials.keys().zip(&mut self.materials) {
            geometries.pictures.give_to(name, material);
        }
        let numbers_of =
            |object: usize, texture: &ArrayTexture| geometries.objects[object].numbers_for(texture);
        arrays::prepare(config, &geometries.places, numbers_of, &mut self.materials)
    }

    /// Adds the primitives of all objects; returns the lower level, with the instanced meshes.
    fn place_objects(
        &mut self,
        config: &Config,
        geometries: Geometries,
    ) -> Result<LowerLevel, Fault> {
        let space = self.space;
        let mut lower_level = LowerLevel::default();
        let objects = config.objects.iter().zip(geometries.objects);
        for (index, (object, geometry)) in objects.enumerate() {
            let path = FieldPath::default()
                .key("objects")
                .index(geometries.places[index]);
            let materials = material_ids(config, object, &path)?;
            let needs = Needs {
                uvs: pictures::needs_uvs(config, object, &materials, geometry.has_uvs(), &path)?,
                colors: vertex_colors::are_needed(config, object, &geometry, &path)?,
            };
            let first = self.primitives.len() as u32;
            let id = ObjectId(index as u32);
            let placement = Placement::new(
                object,
                id,
                &materials,
                &self.materials,
                needs,
                &path,
                &space,
            );
            if let ObjectGeometry::Instances(placed) = geometry {
                let added = lower_level.add(&placement, *placed, &mut self.n_degenerate)?;
                self.attributes.push(added);
                continue;
            }
            let attributes =
                placement.add_geometry(geometry, &mut self.primitives, &mut self.n_degenerate)?;
            let kind = attributes.kind();
            let added = &self.primitives[first as usize..];
            let class = |primitive| SurfaceClass::new(primitive, kind);
            self.classes.extend(added.iter().map(class));
            self.attributes.push(ObjectAttributes { first, attributes });
        }
        Ok(lower_level)
    }

    /// Adds the lights: listed ones, emissive surfaces and the background.
    fn add_lights(&mut self, config: &Config) {
        self.lights = match config.shading.model {
            ShadingModel::AmbientOcclusion => Lights::surroundings(self.shading.occlusion_distance),
            _ => Lights::new(
                config
                    .lights
                    .iter()
                    .map(|light| light.in_space(&self.space)),
                &self.materials,
                self.world(),
                self.scatters_paths().then_some(&self.background),
                config.shading.light_sampling,
                self.scattering_fog().copied(),
                self.weakens_lights(),
            ),
        };
    }

    /// Returns true if any material is a dielectric.
    #[inline]
    pub fn has_media(&self) -> bool {
        self.has_media
    }

    /// Returns true if media attenuate light samples: the medium of the ray to the point.
    pub fn weakens_lights(&self) -> bool {
        self.has_media && self.scatters_paths()
    }

    /// Returns true if light passes any material, in part or at holes.
    #[inline]
    pub fn has_openings(&self) -> bool {
        self.has_openings
    }

    /// Returns true if surfaces of which light passes a part split paths.
    #[inline]
    pub fn splits_at_veils(&self) -> bool {
        self.has_veils && !self.scatters_paths()
    }

    /// Returns true if paths continue in sampled directions.
    pub fn scatters_paths(&self) -> bool {
        self.shading.model == ShadingModel::Path
    }

    /// Returns true if media, or surfaces of which light passes a part, split paths.
    pub fn splits_paths(&self) -> bool {
        (self.has_media || self.has_veils) && !self.scatters_paths()
    }

    /// Returns true if rays need more than an origin and a direction: media, or the density of
    /// their sampling.
    pub fn has_branches(&self) -> bool {
        self.splits_paths() || self.scatters_paths()
    }

    /// Returns true if points need the random numbers of their samples.
    pub fn is_random(&self) -> bool {
        self.scatters_paths() || self.lights.are_random()
    }

    /// Returns the number of objects.
    pub fn n_objects(&self) -> usize {
        self.attributes.len()
    }

    /// Returns the number of materials of surfaces; the last one may be of the fog's particles.
    pub fn n_materials(&self) -> usize {
        self.materials.len() - usize::from(self.fog.is_some())
    }

    /// Returns the material with this id.
    #[inline]
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }

    /// Returns the color of a primitive at one of its points: its own color, or else its
    /// material's.
    pub fn color(&self, primitive: u32, point: &TexturePoint<f32>) -> Vec3 {
        let material = self.primitives[primitive as usize].material;
        self.own_color(primitive)
            .unwrap_or_else(|| self.material(material).color.color_at(point).into())
    }

    /// Returns the primitive's own color, if it has one.
    #[inline]
    pub fn own_color(&self, primitive: u32) -> Option<Vec3> {
        match self.attributes(primitive) {
            (Attributes::Colors(colors), i) => Some(colors[i]),
            _ => None,
        }
    }

    /// Returns the normals at the vertices of the primitive, a triangle, if there are any: unit
    /// vectors on either side; NaN for a missing one.
    #[inline]
    pub fn vertex_normals(&self, placed: PlacedPrimitive) -> Option<[Vec3; 3]> {
        let normals = match self.attributes(placed.primitive) {
            (Attributes::Corners(corners), i) => corners.normals.as_ref()?.at(i),
            _ => return None,
        };
        Some(match self.transform(placed) {
            None => normals,
            Some(transform) => normals.map(|normal| transform.world_normal(normal)),
        })
    }

    /// Returns the texture coordinates at the vertices of the primitive, a triangle, if there are
    /// any and its material needs them.
    #[inline]
    pub fn vertex_uvs(&self, primitive: u32) -> Option<[[f32; 2]; 3]> {
        match self.attributes(primitive) {
            (Attributes::Corners(corners), i) => {
                let uvs = corners.uvs.as_ref()?.at(i);
                Some(uvs.map(|uv| uv.to_array()))
            }
            _ => None,
        }
    }

    /// Returns the numbers of an array at the vertices of the primitive, a triangle, if there are
    /// any.
    #[inline]
    pub fn vertex_scalars(&self, placed: PlacedPrimitive) -> Option<[f32; 3]> {
        if let (Some(instances), Some(id)) = (&self.instances, placed.instance)
            && let Some(scalar) = instances.scalar(id)
        {
            return Some([scalar; 3]);
        }
        match self.attributes(placed.primitive) {
            (Attributes::Corners(corners), i) => Some(corners.scalars.as_ref()?.at(i)),
            _ => None,
        }
    }

    /// Returns the colors at the vertices of the primitive, a triangle, if there are any and its
    /// material needs them.
    #[inline]
    pub fn vertex_colors(&self, primitive: u32) -> Option<[Vec3; 3]> {
        match self.attributes(primitive) {
            (Attributes::Corners(corners), i) => Some(corners.colors.as_ref()?.at(i)),
            _ => None,
        }
    }

    /// Adds the interpolated vertex color to a point of a primitive, if there is one.
    pub fn with_color(
        &self,
        placed: PlacedPrimitive,
        point: TexturePoint<f32>,
    ) -> TexturePoint<f32> {
        let Some(colors) = self.vertex_colors(placed.primitive) else {
            return point;
        };
        let triangle = self.parameters(placed);
        let colors = colors.map(Vector::from);
        TexturePoint {
            color: interpolated_color(&triangle, colors, point.position),
            ..point
        }
    }

    /// Returns the primitive's own number of an array, if it has one.
    #[inline]
    pub fn own_scalar(&self, primitive: u32) -> Option<f32> {
        match self.attributes(primitive) {
            (Attributes::Scalars(scalars), i) => Some(scalars[i]),
            _ => None,
        }
    }

    /// Returns the numbers of an array at the ends of the primitive, a capsule, if there are any.
    #[inline]
    pub fn end_scalars(&self, primitive: u32) -> Option<[f32; 2]> {
        match self.attributes(primitive) {
            (Attributes::Ends(scalars), i) => Some(scalars[i]),
            _ => None,
        }
    }

    /// Returns the number of an array at a point of a primitive, or else NaN.
    pub fn scalar(&self, placed: PlacedPrimitive, point: Vec3) -> f32 {
        let primitive = placed.primitive;
        if let Some(scalars) = self.vertex_scalars(placed) {
            let triangle = self.parameters(placed);
            return interpolated_scalar(&triangle, scalars, point.into());
        }
        if let Some(scalars) = self.end_scalars(primitive) {
            let primitive = &self.primitives[primitive as usize];
            let point = primitive.object_point(point);
            return scalar_along(&primitive.parameters(), scalars, point.into());
        }
        self.own_scalar(primitive).unwrap_or(f32::NAN)
    }

    /// Adds the texture coordinates to a point of a primitive, if there are any.
    pub fn with_uv(&self, placed: PlacedPrimitive, point: TexturePoint<f32>) -> TexturePoint<f32> {
        let Some(uvs) = self.vertex_uvs(placed.primitive) else {
            return point;
        };
        let triangle = self.parameters(placed);
        with_uv(point, &triangle, uvs)
    }

    /// Returns the opacity of a primitive at one of its points, where this is the outward normal.
    pub fn opacity(&self, placed: PlacedPrimitive, [point, normal]: [Vec3; 2]) -> f32 {
        let material = self.primitives[placed.primitive as usize].material;
        let Some(opacity) = &self.material(material).opacity else {
            return 1.0;
        };
        let of_vertices = match self.attributes(placed.primitive) {
            (Attributes::Corners(corners), i) => corners.opacities.as_ref().map(|of| of.at(i)),
            _ => None,
        };
        let of_vertices = of_vertices.map_or(1.0, |of_vertices| {
            interpolated_scalar(&self.parameters(placed), of_vertices, point.into())
        });
        let at = TexturePoint::new(point.into(), normal.into());
        opacity.at(&self.with_uv(placed, at), of_vertices)
    }

    /// Returns the shading normal of a primitive at one of its points, a unit vector on either
    /// side: `geometric` if it has no other.
    pub fn shading_normal(
        &self,
        placed: PlacedPrimitive,
        point: Vec3,
        geometric: Vector<f32>,
    ) -> Vector<f32> {
        let Some(normals) = self.vertex_normals(placed) else {
            return geometric;
        };
        let triangle = self.parameters(placed);
        interpolated_normal(
            &triangle,
            normals.map(Vector::from),
            point.into(),
            geometric,
        )
    }

    /// Returns the class of a primitive.
    #[inline(always)]
    pub fn class(&self, primitive: u32) -> SurfaceClass {
        self.classes[primitive as usize]
    }

    /// Returns the attributes of the primitive's object, and the primitive's index in that object.
    fn attributes(&self, primitive: u32) -> (&Attributes, usize) {
        let object = self.primitives[primitive as usize].object;
        let ObjectAttributes { first, attributes } = &self.attributes[object.0 as usize];
        (attributes, (primitive - first) as usize)
    }
}

/// Checks that the shading model supports the materials.
fn check_materials(config: &Config) -> Result<(), Fault> {
    let model = config.shading.model;
    let is_seed = model == ShadingModel::Seed;
    let is_path = model == ShadingModel::Path;
    for (name, material) in &config.materials {
        let is_principled = matches!(material.kind, MaterialKind::Principled { .. });
        let (key, what, help) = if is_seed && material.kind.medium().is_some() {
            ("dielectric", "refraction", NOT_SEED)
        } else if is_seed && material.emits() {
            ("emission", "surfaces that emit light", NOT_SEED)
        } else if is_seed && let Some(opacity) = &material.opacity {
            (opacity.keys()[0], "openings of surfaces", NOT_SEED)
        } else if is_seed && !material.two_sided {
            ("two_sided", "sides", NOT_SEED)
        } else if !is_path && material.kind.roughness() > 0.0 {
            ("roughness", "rough media and metals", PATH)
        } else if !is_path && is_principled {
            ("principled", "principled surfaces", PATH)
        } else {
            continue;
        };
        let path = FieldPath::default().key("materials").key(name).key(key);
        let message = format!("the shading model `{}` has no {what}", keyword_name(&model));
        return Err(Fault::new(path, message, "expected a material without it").with_help(help));
    }
    Ok(())
}

const NOT_SEED: &str = "remove `model: seed` from `shading`";
const PATH: &str = "trace paths by `shading: { model: path }`";

fn material_ids(
    config: &Config,
    object: &Object,
    path: &FieldPath,
) -> Result<Vec<MaterialId>, Fault> {
    let names = &object.material.0;
    if names.is_empty() {
        let message = format!("the {} has no material", object.geometry);
        return Err(Fault::new(path.clone(), message, "expected a `material`"));
    }
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

fn unknown_material(config: &Config, name: &str, path: FieldPath) -> Fault {
    let known: Vec<&str> = config.materials.keys().map(String::as_str).collect();
    let list = if known.is_empty() {
        "there are no `materials`".to_owned()
    } else {
        format!("the materials are {}", known.join(", "))
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
