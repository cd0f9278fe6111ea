//! The lower level of a scene while it is built: the boxes of instances, and the triangles of meshes.

use super::Scene;
use super::instances::{Instance, InstanceId, InstancedTriangles, Instances};
use super::primitive::{MaterialId, ObjectId, Primitive};
use super::surface_class::SurfaceClass;
use crate::geometry::{Aabb, Cuboid, InstanceTransform, Shape};

/// Collects the instanced meshes for a scene until all objects are placed.
#[derive(Debug, Default)]
pub struct LowerLevel {
    instances: Instances,
    /// One box per instance.
    boxes: Vec<Primitive>,
    /// The triangles of the meshes, each in its mesh's space; the meshes' ranges are indices into
    /// these.
    pub triangles: Vec<Primitive>,
    objects: Vec<ObjectId>,
}

impl LowerLevel {
    /// Ends an instanced mesh: the triangles from `first` on, at least one, of an object. It is
    /// placed by `transforms`, each with its number of an array, if there are any.
    ///
    /// # Errors
    /// The index of the first transform that is beyond the range of 32-bit numbers.
    pub fn end_mesh(
        &mut self,
        first: u32,
        object: ObjectId,
        transforms: impl Iterator<Item = Option<InstanceTransform>>,
        scalars: Option<impl Iterator<Item = f32>>,
    ) -> Result<(), usize> {
        let triangles = &self.triangles[first as usize..];
        let bounds = triangles.iter().map(Primitive::bounds);
        let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
        // Add an instance and its box for each place.
        let material = triangles[0].material;
        let mesh = self.instances.meshes.len() as u32;
        let first_instance = InstanceId(self.instances.all.len() as u32);
        for (i, transform) in transforms.enumerate() {
            let transform = transform.ok_or(i)?;
            let shape = Shape::Cuboid(Cuboid::new(transform.world_bounds(&bounds)));
            let shape = Primitive::new(shape, None, object, material);
            if !shape.is_in_range() || !shape.has_extent() {
                return Err(i);
            }
            self.boxes.push(shape);
            self.instances.all.push(Instance { transform, mesh });
        }
        // Record the mesh and the numbers of its instances.
        let has_scalars = scalars.is_some();
        if let Some(scalars) = scalars {
            let stored = &mut self.instances.scalars;
            stored.resize(first_instance.0 as usize, f32::NAN);
            stored.extend(scalars);
        }
        let end = self.triangles.len() as u32;
        self.instances.meshes.push(InstancedTriangles {
            triangles: first..end,
            first: first_instance,
            has_scalars,
        });
        self.objects.push(object);
        Ok(())
    }

    /// Returns the number of triangles of all instances with this material.
    pub fn n_triangles(&self, material: MaterialId) -> u64 {
        let with_it = self.boxes.iter().zip(&self.instances.all);
        let with_it = with_it.filter(|(of_instance, _)| of_instance.material == material);
        let n_triangles = |(_, instance): (&Primitive, &Instance)| {
            let mesh = &self.instances.meshes[instance.mesh as usize];
            mesh.triangles.len() as u64
        };
        with_it.map(n_triangles).sum()
    }
}

impl Scene {
    /// Appends the lower level, once all other objects are placed.
    pub fn add_lower_level(&mut self, lower_level: LowerLevel) {
        let LowerLevel {
            mut instances,
            boxes,
            triangles,
            objects,
        } = lower_level;
        if objects.is_empty() {
            return;
        }
        instances.first_box = self.primitives.len() as u32;
        self.primitives.extend(boxes);
        let n_before = self.primitives.len() as u32;
        for InstancedTriangles { triangles, .. } in &mut instances.meshes {
            *triangles = triangles.start + n_before..triangles.end + n_before;
        }
        for object in objects {
            self.attributes[object.0 as usize].first += n_before;
        }
        self.primitives.extend(triangles);
        let class = |primitive: &Primitive| {
            let of_object = &self.attributes[primitive.object.0 as usize];
            SurfaceClass::new(primitive, of_object.attributes.kind())
        };
        let added = &self.primitives[instances.first_box as usize..];
        self.classes.extend(added.iter().map(class));
        self.instances = Some(instances);
    }
}
