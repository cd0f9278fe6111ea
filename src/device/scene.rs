//! A scene as the arrays of a device's memory.

use std::borrow::Cow;

use glam::Vec3;

use tracer::accel::{Accel, LevelArrays};
use world::geometry::{ShapeKind, Transform};
use world::scene::{InstanceId, Instances, Primitive, World};

use crate::paths::next_start;
use crate::program::INSTANCE;

/// A primitive that a leaf holds has no record.
const NO_RECORD: u32 = u32::MAX;
/// Shapes whose parameters the leaves of a hierarchy hold.
const IN_LEAVES: [ShapeKind; 3] = [ShapeKind::Triangle, ShapeKind::Sphere, ShapeKind::Capsule];

/// The arrays of a scene.
#[derive(Default)]
pub(crate) struct SceneArrays<'a> {
    /// The cache lines of all levels; borrowed where there is one.
    pub(crate) lines: Cow<'a, [f32]>,
    /// For each level the index of its first cache line, the bits of its largest coordinate, the
    /// start and the length of its part of `unbounded`, and its number of cache lines.
    pub(crate) levels: Vec<u32>,
    /// Indices of the primitives that are tested before the hierarchies.
    pub(crate) unbounded: Vec<u32>,
    /// For each primitive its object, and the start of its record.
    pub(crate) primitives: Vec<u32>,
    /// The shapes that no leaf holds, and the instances.
    ///
    /// A shape has its kind, 1 if it needs a transform, its parameters, and the columns and the
    /// translation of the map to object space. An instance has its kind, its number plus 1, the
    /// level and the first triangle of its mesh, the largest coordinate of its box, the box, and
    /// the columns of the map to the mesh and its position.
    pub(crate) records: Vec<u32>,
    /// Levels of nodes of the world's hierarchy.
    pub(crate) world_levels: usize,
    /// The most levels of an instanced mesh; `None` without instances.
    pub(crate) mesh_levels: Option<usize>,
}

impl<'a> SceneArrays<'a> {
    /// Makes the arrays of a structure.
    ///
    /// # Errors
    /// There are too many records.
    pub(crate) fn new(accel: &'a Accel) -> Result<Self, String> {
        let (world, levels) = (accel.world(), accel.levels());
        let depth = |levels: &[LevelArrays]| levels.iter().map(|level| level.n_levels).max();
        let (upper, lower) = levels.split_at(1);
        let mut arrays = Self {
            world_levels: depth(upper).unwrap_or(0),
            mesh_levels: depth(lower),
            ..Self::default()
        };
        for level in &levels {
            arrays.push_level(level);
        }
        let is_brute_force = levels.iter().any(|level| level.lines.is_empty());
        for (i, primitive) in (0..).zip(world.primitives) {
            let is_in_leaf = |kind| IN_LEAVES.contains(&kind);
            let has_record = is_brute_force || !primitive.kind().is_some_and(is_in_leaf);
            let start = next_start(arrays.records.len(), "shapes and instances")?;
            let record = if has_record { start } else { NO_RECORD };
            arrays.primitives.extend([primitive.object.0, record]);
            if has_record {
                arrays.push_record(world, i, primitive);
            }
        }
        Ok(arrays)
    }

    /// Adds a level. All counts have 32 bits: a structure has fewer cache lines and primitives.
    fn push_level(&mut self, level: &LevelArrays<'a>) {
        self.levels.extend([
            (self.lines.len() / 16) as u32,
            level.largest.to_bits(),
            self.unbounded.len() as u32,
            level.unbounded.len() as u32,
            (level.lines.len() / 16) as u32,
        ]);
        if self.lines.is_empty() {
            self.lines = Cow::Borrowed(level.lines);
        } else {
            self.lines.to_mut().extend_from_slice(level.lines);
        }
        self.unbounded.extend_from_slice(&level.unbounded);
    }

    fn push_record(&mut self, world: World, i: u32, primitive: &Primitive) {
        let instance = world.instances.and_then(|instances| {
            let id = instances.by_box(i)?;
            ((id.0 as usize) < instances.n_instances()).then_some((instances, id))
        });
        match instance {
            Some((instances, id)) => self.push_instance(instances, id, primitive),
            None => self.push_shape(primitive),
        }
    }

    fn push_shape(&mut self, primitive: &Primitive) {
        let columns = primitive.placement().map(Transform::object_from_world);
        let kind = primitive.shape_kind() as u32;
        self.records.extend([kind, columns.is_some().into()]);
        self.push_numbers(primitive.parameters());
        let columns = columns.unwrap_or_default();
        self.push_numbers(columns.iter().flat_map(Vec3::to_array));
    }

    fn push_instance(&mut self, instances: &Instances, id: InstanceId, bounds: &Primitive) {
        let instance = instances.get(id);
        let first = instances.mesh_of(id).triangles.start;
        let head = [INSTANCE, id.0 + 1, instance.mesh + 1, first];
        self.records.extend(head);
        let bounds = bounds.bounds();
        self.push_numbers([bounds.largest()]);
        let bounds = [bounds.min, bounds.max];
        let columns = instance.transform.mesh_from_world();
        self.push_numbers(bounds.iter().chain(&columns).flat_map(Vec3::to_array));
    }

    fn push_numbers(&mut self, numbers: impl IntoIterator<Item = f32>) {
        self.records.extend(numbers.into_iter().map(f32::to_bits));
    }
}
