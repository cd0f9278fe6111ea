//! Instances: meshes that are stored once and placed many times.
//!
//! A scene's list of primitives has three parts: the primitives in render space, then a box for each
//! instance, then the triangles of the instanced meshes, each in its mesh's space. The first two
//! parts are the upper level of an acceleration structure, and each mesh is a lower one.

use std::ops::Range;

use glam::Vec3;

use super::Scene;
use super::primitive::Primitive;
use crate::geometry::{InstanceTransform, N_PARAMETERS, Project, Triangle};

/// The index of an instance, among all instances of the scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct InstanceId(pub u32);

/// An instance of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// The placement.
    pub transform: InstanceTransform,
    /// The index of its mesh.
    pub mesh: u32,
}

/// An instanced mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct InstancedTriangles {
    /// The range of the triangles among the primitives.
    pub triangles: Range<u32>,
    /// First instance.
    pub first: InstanceId,
    /// True if each of the instances has a number of an array.
    pub(super) has_scalars: bool,
}

/// All instances of a scene, and their meshes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Instances {
    /// The index of the first instance's box among the primitives.
    pub(super) first_box: u32,
    /// The instances, in the order of their boxes.
    pub(super) all: Vec<Instance>,
    /// The meshes, in the order of their triangles.
    pub(super) meshes: Vec<InstancedTriangles>,
    /// The number of an array for each instance, NaN if it has none; empty if no instance has one.
    pub(super) scalars: Vec<f32>,
}

impl Instances {
    /// Returns the instance whose box has this index among the primitives of the upper level.
    #[inline]
    pub fn by_box(&self, primitive: u32) -> Option<InstanceId> {
        primitive.checked_sub(self.first_box).map(InstanceId)
    }

    /// Returns the index of the box of an instance among the primitives.
    #[inline]
    pub fn box_of(&self, id: InstanceId) -> u32 {
        self.first_box + id.0
    }

    /// Returns an instance.
    #[inline]
    pub fn get(&self, id: InstanceId) -> &Instance {
        &self.all[id.0 as usize]
    }

    /// Returns the number of instances.
    pub fn n_instances(&self) -> usize {
        self.all.len()
    }

    /// Returns the number of an array for an instance, if its object has one per instance.
    #[inline]
    pub fn scalar(&self, id: InstanceId) -> Option<f32> {
        let scalar = *self.scalars.get(id.0 as usize)?;
        self.mesh_of(id).has_scalars.then_some(scalar)
    }

    /// Returns the meshes, in the order of their triangles.
    pub fn meshes(&self) -> &[InstancedTriangles] {
        &self.meshes
    }

    /// Returns the mesh of an instance.
    #[inline]
    pub fn mesh_of(&self, id: InstanceId) -> &InstancedTriangles {
        &self.meshes[self.get(id).mesh as usize]
    }

    /// Returns the index of the first triangle of a mesh among the primitives.
    pub fn first_triangle(&self) -> u32 {
        self.first_box + self.all.len() as u32
    }

    /// Returns the index of the mesh that contains the primitive with this index, if there is one.
    pub fn mesh_with(&self, primitive: u32) -> Option<u32> {
        let n_before = |mesh: &InstancedTriangles| mesh.triangles.start <= primitive;
        let n_before = self.meshes.partition_point(n_before);
        n_before.checked_sub(1).map(|mesh| mesh as u32)
    }

    /// Returns the number of triangles of all instances.
    pub fn n_placed(&self) -> u64 {
        let of_mesh = |mesh: &InstancedTriangles| mesh.triangles.len() as u64;
        let of_instance = |instance: &Instance| of_mesh(&self.meshes[instance.mesh as usize]);
        self.all.iter().map(of_instance).sum()
    }
}

impl InstancedTriangles {
    /// Returns the range of the triangles among the primitives.
    pub fn range(&self) -> Range<usize> {
        self.triangles.start as usize..self.triangles.end as usize
    }
}

/// Everything that rays can hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct World<'a> {
    /// The primitives in render space; then, if there are any, the boxes of instances and the
    /// triangles of their meshes.
    pub primitives: &'a [Primitive],
    /// The instances, if there are any.
    pub instances: Option<&'a Instances>,
}

impl<'a> World<'a> {
    /// Returns the number of stored primitives, without the boxes of instances.
    pub fn n_primitives(&self) -> usize {
        let n_boxes = self.instances.map_or(0, Instances::n_instances);
        self.primitives.len() - n_boxes
    }

    /// Returns the primitives of the upper level: the primitives in render space, and the boxes of
    /// instances.
    pub fn upper_level(&self) -> &'a [Primitive] {
        match self.instances {
            None => self.primitives,
            Some(instances) => {
                let n = instances.first_box as usize + instances.n_instances();
                &self.primitives[..n]
            }
        }
    }

    /// Returns the primitives in render space, without the boxes of instances.
    pub fn in_render_space(&self) -> &'a [Primitive] {
        match self.instances {
            None => self.primitives,
            Some(instances) => &self.primitives[..instances.first_box as usize],
        }
    }

    /// Returns the instances with the triangles of their meshes, which are in the spaces of the
    /// meshes.
    pub fn placed_meshes(&self) -> impl Iterator<Item = (&'a Instance, &'a [Primitive])> {
        let (instances, primitives) = (self.instances, self.primitives);
        instances.into_iter().flat_map(move |instances| {
            let triangles = move |instance: &Instance| {
                let mesh = &instances.meshes[instance.mesh as usize];
                &primitives[mesh.range()]
            };
            let all = instances.all.iter();
            all.map(move |instance| (instance, triangles(instance)))
        })
    }
}

/// Primitives in render space.
impl<'a> From<&'a [Primitive]> for World<'a> {
    fn from(primitives: &'a [Primitive]) -> Self {
        Self {
            primitives,
            instances: None,
        }
    }
}

/// Primitives in render space.
impl<'a> From<&'a Vec<Primitive>> for World<'a> {
    fn from(primitives: &'a Vec<Primitive>) -> Self {
        Self::from(&primitives[..])
    }
}

/// A primitive that a ray can hit: in render space, or in an instance's mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlacedPrimitive {
    /// The primitive's index in the scene.
    pub primitive: u32,
    /// The instance; `None` for a primitive in render space.
    pub instance: Option<InstanceId>,
}

/// A primitive in render space.
impl From<u32> for PlacedPrimitive {
    fn from(primitive: u32) -> Self {
        Self {
            primitive,
            instance: None,
        }
    }
}

impl Scene {
    /// Returns everything that rays can hit.
    pub fn world(&self) -> World<'_> {
        World {
            primitives: &self.primitives,
            instances: self.instances.as_ref(),
        }
    }

    /// Returns the placement of the instance that the primitive belongs to, if it belongs to one.
    #[inline]
    pub fn transform(&self, placed: PlacedPrimitive) -> Option<&InstanceTransform> {
        let instances = self.instances.as_ref()?;
        Some(&instances.get(placed.instance?).transform)
    }

    /// Returns the parameters of a primitive's shape, padded with zeros: in render space, unless the
    /// primitive has its own transform.
    #[inline]
    pub fn parameters(&self, placed: PlacedPrimitive) -> [f32; N_PARAMETERS] {
        let parameters = self.primitives[placed.primitive as usize].parameters();
        match self.transform(placed) {
            None => parameters,
            Some(transform) => transform.world_triangle(&parameters),
        }
    }

    /// Returns the point of a primitive's surface nearest to `near`, which lies on it up to
    /// rounding errors, and the outward unit normal there.
    pub fn project(&self, placed: PlacedPrimitive, near: Vec3) -> (Vec3, Vec3) {
        let Some(transform) = self.transform(placed) else {
            return self.primitives[placed.primitive as usize].project(near);
        };
        let triangle = self.parameters(placed);
        let (position, normal) = Triangle::project_onto(&triangle, near.into());
        let normal = Vec3::from(normal);
        let outward = if transform.is_mirrored() {
            -normal
        } else {
            normal
        };
        (position.into(), outward)
    }
}

impl Scene {
    /// Returns a bound of the distance between a primitive's surface and a point that
    /// [`project`](Self::project) found on it, given with its normal.
    pub fn rounding(&self, placed: PlacedPrimitive, at: [Vec3; 2]) -> f32 {
        match self.transform(placed) {
            None => self.primitives[placed.primitive as usize].rounding(at),
            Some(_) => Triangle::rounding(&self.parameters(placed), at[0].into()),
        }
    }
}

/// Everything in a scene that rays can hit.
impl<'a> From<&'a Scene> for World<'a> {
    fn from(scene: &'a Scene) -> Self {
        scene.world()
    }
}
