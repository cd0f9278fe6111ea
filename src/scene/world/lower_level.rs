//! Builds the lower level of a scene from instanced meshes: the boxes of instances, and the
//! triangles of meshes.

use glam::{DAffine3, DVec3};

use super::geometries::MeshInstances;
use super::instances::{Instance, InstanceId, InstancedTriangles, Instances};
use super::placement::Placement;
use super::primitive::{MaterialId, ObjectId, Primitive};
use super::surface_class::SurfaceClass;
use super::{ObjectAttributes, Scene};
use crate::config::Config;
use crate::geometry::{Aabb, Cuboid, InstanceTransform, RenderSpace, Shape};
use crate::import::Mesh;
use crate::yaml::{Fault, FieldPath};

/// Maximum number of triangles of all instances of an emissive material: each is a separate light.
const MAX_EMITTING: u64 = 1 << 20;

/// Collects the instances for a scene until all objects are placed.
#[derive(Default)]
pub(super) struct LowerLevel {
    instances: Instances,
    /// One box per instance.
    boxes: Vec<Primitive>,
    /// The triangles of the meshes; the meshes' ranges are indices into these.
    triangles: Vec<Primitive>,
    objects: Vec<ObjectId>,
}

impl LowerLevel {
    /// Adds a mesh and its instances, and its number of degenerate triangles to `n_degenerate`;
    /// returns the attributes of the mesh and its first triangle.
    ///
    /// # Errors
    /// A placement exceeds the range of 32-bit numbers, or the mesh exceeds the memory.
    pub(super) fn add(
        &mut self,
        placement: &Placement,
        placed: MeshInstances,
        n_degenerate: &mut u64,
    ) -> Result<ObjectAttributes, Fault> {
        let MeshInstances {
            mut mesh,
            places,
            scalars,
        } = placed;
        // Add the triangles in the mesh's own space.
        let mesh_from_unit = to_unit_size(&mut mesh);
        let first = self.triangles.len() as u32;
        let (in_mesh, render_from_object) = placement.in_object_space();
        let attributes = in_mesh.add_mesh(mesh, &mut self.triangles, n_degenerate)?;
        let triangles = &self.triangles[first as usize..];
        let bounds = triangles.iter().map(Primitive::bounds);
        let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
        // Add an instance and its box for each place.
        let material = triangles[0].material;
        let mesh = self.instances.meshes.len() as u32;
        let first_instance = InstanceId(self.instances.all.len() as u32);
        for (i, place) in places.iter().enumerate() {
            let place = render_from_object * *place * mesh_from_unit;
            let out_of_range = || placement.place_out_of_range(i);
            let transform = InstanceTransform::new(&place).ok_or_else(out_of_range)?;
            let shape = Shape::Cuboid(Cuboid::new(transform.world_bounds(&bounds)));
            let shape = Primitive::new(shape, None, placement.id(), material);
            if !shape.is_in_range() || !shape.has_extent() {
                return Err(out_of_range());
            }
            self.boxes.push(shape);
            self.instances.all.push(Instance { transform, mesh });
        }
        // Record the mesh and the numbers of its instances.
        if let Some(scalars) = &scalars {
            self.instances
                .scalars
                .resize(first_instance.0 as usize, f32::NAN);
            let stored = scalars.iter().map(|number| placement.stored(0, *number));
            self.instances.scalars.extend(stored);
        }
        let end = self.triangles.len() as u32;
        self.instances.meshes.push(InstancedTriangles {
            triangles: first..end,
            first: first_instance,
            has_scalars: scalars.is_some(),
        });
        self.objects.push(placement.id());
        Ok(ObjectAttributes { first, attributes })
    }

    /// Checks that the instances that emit light are few enough to be sampled.
    ///
    /// # Errors
    /// The material with too many triangles.
    pub(super) fn check_emission(&self, config: &Config) -> Result<(), Fault> {
        let Some((name, n)) = self.emitting(config).find(|(_, n)| *n > MAX_EMITTING) else {
            return Ok(());
        };
        let path = FieldPath::default().key("materials").key(name);
        let message = format!("instances with the material `{name}` emit light from {n} triangles");
        let expected = format!("expected at most {MAX_EMITTING}");
        Err(Fault::new(path.key("emission"), message, expected)
            .with_help("emit light from fewer instances, or from a mesh of fewer triangles"))
    }

    /// Returns the materials that emit light, with the number of triangles of their instances.
    fn emitting<'a>(&'a self, config: &'a Config) -> impl Iterator<Item = (&'a String, u64)> {
        let numbered = (0..).map(MaterialId).zip(&config.materials);
        let emitting = numbered.filter(|(_, (_, material))| material.emits());
        emitting.map(move |(id, (name, _))| {
            let with_it = self.boxes.iter().zip(&self.instances.all);
            let with_it = with_it.filter(|(of_instance, _)| of_instance.material == id);
            let n_triangles = |(_, instance): (&Primitive, &Instance)| {
                self.instances.meshes[instance.mesh as usize]
                    .triangles
                    .len() as u64
            };
            (name, with_it.map(n_triangles).sum())
        })
    }

    /// Appends the lower level to a scene whose other objects are placed.
    pub(super) fn add_to(self, scene: &mut Scene) {
        let Self {
            mut instances,
            boxes,
            triangles,
            objects,
        } = self;
        if objects.is_empty() {
            return;
        }
        instances.first_box = scene.primitives.len() as u32;
        scene.primitives.extend(boxes);
        let n_before = scene.primitives.len() as u32;
        for InstancedTriangles { triangles, .. } in &mut instances.meshes {
            *triangles = triangles.start + n_before..triangles.end + n_before;
        }
        for object in objects {
            scene.attributes[object.0 as usize].first += n_before;
        }
        scene.primitives.extend(triangles);
        let class = |primitive: &Primitive| {
            let of_object = &scene.attributes[primitive.object.0 as usize];
            SurfaceClass::new(primitive, of_object.attributes.kind())
        };
        let added = &scene.primitives[instances.first_box as usize..];
        scene.classes.extend(added.iter().map(class));
        scene.instances = Some(instances);
    }
}

/// Moves the center of a mesh to the origin, where numbers have the most digits, and scales it by a
/// power of two to unit size; returns the map from there back.
fn to_unit_size(mesh: &mut Mesh) -> DAffine3 {
    let bounds = mesh.bounds();
    let size = (bounds.max - bounds.min).max_element().into();
    let center = bounds.center();
    let unit = RenderSpace::new(size, DVec3::ZERO, size).unit();
    for vertex in &mut mesh.vertices {
        *vertex = ((vertex.as_dvec3() - center.as_dvec3()) / unit).as_vec3();
    }
    let origin = std::mem::take(&mut mesh.origin) + center.as_dvec3();
    DAffine3::from_translation(origin) * DAffine3::from_scale(DVec3::splat(unit))
}
