//! The world in render space, with ids instead of names: the tracer's input.
//!
//! A [`Scene`] grows by objects: [`Scene::new`] takes the materials, [`Scene::add_shapes`] an object,
//! [`Scene::add_lower_level`] instanced meshes; [`Scene::add_fog`] and [`Scene::add_lights`] end it.

mod primitive;
mod instances;
mod attributes;
mod surface_class;
mod emitter;
mod environment;
mod light_source;
mod light_choice;
mod lights;
mod lower_level;

use glam::Vec3;

use crate::background::Background;
use crate::fog::{Fog, FogSphere, HenyeyGreenstein};
use crate::geometry::{RenderSpace, Shape};
use crate::light::Light;
use crate::material::{FactorPictures, Material, TexturePoint};
use crate::shading::{Shading, ShadingModel};
use math::simd::Vector;

pub use attributes::{
    AttributeKind, Attributes, CornerAttributes, CornerValues, interpolated_color,
    interpolated_normal, interpolated_scalar, scalar_along, with_uv,
};
pub use emitter::Emitter;
pub use environment::EnvironmentLight;
pub use instances::{Instance, InstanceId, InstancedTriangles, Instances, PlacedPrimitive, World};
pub use light_source::LightNumbers;
pub use lights::{LightOrigin, Lights};
pub use lower_level::LowerLevel;
pub use primitive::{MaterialId, ObjectId, Primitive};
pub use surface_class::SurfaceClass;

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
    /// Warnings about ambiguous or ignored content of files.
    pub notes: Vec<String>,
    /// The attributes of the objects' primitives, by [`ObjectId`].
    attributes: Vec<ObjectAttributes>,
}

#[derive(Debug, Clone)]
struct ObjectAttributes {
    /// The index of the object's first primitive.
    first: u32,
    attributes: Attributes,
}

impl Scene {
    /// Creates a scene in this space without objects and lights; materials and shading are in its
    /// space already.
    pub fn new(
        space: RenderSpace,
        shading: Shading,
        materials: Vec<Material>,
        background: Background,
    ) -> Self {
        let has = |is_such: fn(&Material) -> bool| materials.iter().any(is_such);
        Self {
            space,
            background,
            shading,
            fog: None,
            lights: Lights::default(),
            has_media: has(|material| material.kind.medium().is_some()),
            has_openings: has(|material| material.opacity.is_some()),
            has_veils: has(Material::is_veil),
            has_images: has(Material::has_images),
            has_factors: has(|material| material.factors != FactorPictures::default()),
            materials,
            primitives: Vec::new(),
            instances: None,
            classes: Vec::new(),
            n_degenerate: 0,
            notes: Vec::new(),
            attributes: Vec::new(),
        }
    }

    /// Makes room for this number of primitives.
    pub fn reserve(&mut self, n_primitives: usize) {
        self.primitives.reserve(n_primitives);
        self.classes.reserve(n_primitives);
    }

    /// Adds an object of shapes in render space, all of one material. Returns `None`, and adds
    /// nothing, if one of them has no extent, or exceeds the range of coordinates.
    pub fn add_shapes(
        &mut self,
        shapes: impl IntoIterator<Item = Shape>,
        material: MaterialId,
    ) -> Option<ObjectId> {
        let object = ObjectId(self.attributes.len() as u32);
        let n_before = self.primitives.len();
        let primitive = |shape| Primitive::new(shape, None, object, material);
        self.primitives.extend(shapes.into_iter().map(primitive));
        let mut added = self.primitives[n_before..].iter();
        if !added.all(|primitive| primitive.is_in_range() && primitive.has_extent()) {
            self.primitives.truncate(n_before);
            return None;
        }
        self.end_object(Attributes::None);
        Some(object)
    }

    /// Ends the next object, with the primitives that were added since the last one and their
    /// attributes.
    pub fn end_object(&mut self, attributes: Attributes) {
        let first = self.classes.len() as u32;
        let kind = attributes.kind();
        let added = &self.primitives[first as usize..];
        self.classes.extend(
            added
                .iter()
                .map(|primitive| SurfaceClass::new(primitive, kind)),
        );
        self.attributes.push(ObjectAttributes { first, attributes });
    }

    /// Ends the next object, whose primitives are in the lower level from `first` on.
    pub fn end_instanced_object(&mut self, first: u32, attributes: Attributes) {
        self.attributes.push(ObjectAttributes { first, attributes });
    }

    /// Adds the fog around the objects, of this eye in render space: as an additional primitive,
    /// which no ray hits, and whose material is the fog's particles.
    pub fn add_fog(&mut self, fog: &Fog, eye: Vec3) {
        let bounds = lights::bounds(self.world().upper_level());
        let center = bounds.center();
        let to_corner = 0.5 * (bounds.max - bounds.min).length();
        let to_camera = eye.distance(center);
        let around_all = to_corner.max(to_camera).max(f32::MIN_POSITIVE);
        let phase = HenyeyGreenstein {
            anisotropy: fog.anisotropy,
        };
        self.fog = Some(FogSphere {
            center,
            radius: fog
                .radius
                .map_or(around_all, |radius| self.space.length(radius)),
            extinction: 1.0 / self.space.length(fog.mean_free_path),
            color: fog.color,
            phase,
        });
        let material = MaterialId(self.materials.len() as u32);
        self.materials.push(Material::particles(fog.color, phase));
        let class = SurfaceClass::particles(material);
        self.classes.push(class);
    }

    /// Adds the lights, once all objects are placed: listed ones, given in world space, emissive
    /// surfaces and the background.
    pub fn add_lights(&mut self, lights: &[Light]) {
        self.lights = match self.shading.model {
            ShadingModel::AmbientOcclusion => Lights::surroundings(self.shading.occlusion_distance),
            _ => Lights::new(
                lights.iter().map(|light| light.in_space(&self.space)),
                &self.materials,
                self.world(),
                self.scatters_paths().then_some(&self.background),
                self.shading.light_sampling,
                self.scattering_fog().copied(),
                self.weakens_lights(),
            ),
        };
    }

    /// Returns the fog whose particles scatter light.
    pub fn scattering_fog(&self) -> Option<&FogSphere> {
        self.fog.as_ref().filter(|_| self.scatters_paths())
    }

    /// Returns the fog that attenuates light without scattering it.
    pub fn fading_fog(&self) -> Option<&FogSphere> {
        self.fog.as_ref().filter(|_| !self.scatters_paths())
    }

    /// Returns the index of the fog's particles in hits: one past the last primitive.
    pub fn particles(&self) -> u32 {
        self.primitives.len() as u32
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

    /// Returns the opacities at the vertices of the primitive, a triangle, if there are any.
    pub fn vertex_opacities(&self, primitive: u32) -> Option<[f32; 3]> {
        match self.attributes(primitive) {
            (Attributes::Corners(corners), i) => Some(corners.opacities.as_ref()?.at(i)),
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
        let of_vertices = self
            .vertex_opacities(placed.primitive)
            .map_or(1.0, |of_vertices| {
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
