//! Converts an object's geometry to primitives in render space.

use glam::{DAffine3, DVec3, Vec3};

use super::geometries::ObjectGeometry;
use super::needs::Needs;
use crate::config::{Geometry, InstancePlaces, InstancedMesh, Object};
use crate::yaml::{Fault, FieldPath};
use base::stop;
use import::{Mesh, Spheres};
use world::geometry::{Located, RenderSpace, Shape, Transform, world_from_object};
use world::material::Material;
use world::scene::{Attributes, CornerAttributes, CornerValues, MaterialId, ObjectId, Primitive};

/// The id, the materials and the transform of an object.
#[derive(Clone)]
pub(super) struct Placement<'a> {
    object: &'a Object,
    id: ObjectId,
    /// The materials, at least one.
    materials: &'a [MaterialId],
    all_materials: &'a [Material],
    needs: Needs,
    /// The map from the object to the space of its primitives.
    render_from_object: DAffine3,
    path: &'a FieldPath,
}

impl<'a> Placement<'a> {
    /// Creates the placement of the object at `path` in a space.
    pub(super) fn new(
        object: &'a Object,
        id: ObjectId,
        materials: &'a [MaterialId],
        all_materials: &'a [Material],
        needs: Needs,
        path: &'a FieldPath,
        space: &RenderSpace,
    ) -> Self {
        Self {
            object,
            id,
            materials,
            all_materials,
            needs,
            render_from_object: space.render_from_world() * world_from_object(&object.transform),
            path,
        }
    }

    /// Returns the object.
    pub(super) fn id(&self) -> ObjectId {
        self.id
    }

    /// Returns the placement in the object's own space, and the map from there.
    pub(super) fn in_object_space(&self) -> (Self, DAffine3) {
        let in_object_space = Self {
            render_from_object: DAffine3::IDENTITY,
            ..*self
        };
        (in_object_space, self.render_from_object)
    }

    /// Returns the number that surfaces with the material of this index store for one of an array.
    pub(super) fn stored(&self, material: usize, number: f64) -> f32 {
        let MaterialId(material) = self.materials[material];
        let texture = self.all_materials[material as usize].color.array();
        texture.map_or(number as f32, |texture| texture.table.stored(number))
    }

    /// Returns the transform of a geometry whose coordinates are relative to `origin`.
    ///
    /// # Errors
    /// The transform has no inverse.
    fn transform(&self, origin: DVec3) -> Result<Transform, Fault> {
        let from_origin = DAffine3::from_translation(origin);
        Transform::new(&(self.render_from_object * from_origin))
            .ok_or_else(|| out_of_range(self.object, self.path))
    }

    /// Creates the fault of an instance that is too small, too large or too far away.
    pub(super) fn place_out_of_range(&self, index: usize) -> Fault {
        let path = self.path.clone().key(InstancedMesh::KEY);
        let path = match &self.object.geometry {
            Geometry::Instances(instances) => match instances.places {
                InstancePlaces::Listed(_) => path.key("places").index(index),
                InstancePlaces::Points(_) => path.key("points").key("file"),
                InstancePlaces::Cloud(_) => path.key("cloud").key("count"),
            },
            _ => path,
        };
        let message = format!("instance {index} is too small, too large or too far away");
        let expected = "expected coordinates within 1e16, and scales from 1e-9 to 1e9";
        Fault::new(path, message, expected)
    }

    /// Adds the primitives of a geometry to `primitives`, and its number of degenerate triangles to
    /// `n_degenerate`; returns the primitives' attributes.
    ///
    /// # Errors
    /// A transform or a size exceeds the range of 32-bit numbers.
    pub(super) fn add_geometry(
        &self,
        geometry: ObjectGeometry,
        primitives: &mut Vec<Primitive>,
        n_degenerate: &mut u64,
    ) -> Result<Attributes, Fault> {
        match geometry {
            ObjectGeometry::Shape(Located { origin, geometry }) => {
                self.add(geometry, 0, &self.transform(origin)?, primitives)?;
            }
            ObjectGeometry::Generator(generator) => {
                let Located { origin, geometry } = generator.corners();
                let transform = self.transform(origin)?;
                for i in 0..generator.n_spheres() {
                    // The caller discards the incomplete scene.
                    if stop::is_requested() {
                        break;
                    }
                    let (sphere, material) = generator.sphere(geometry, i, self.materials.len());
                    self.add(Shape::Sphere(sphere), material, &transform, primitives)?;
                }
            }
            ObjectGeometry::Spheres(Spheres {
                origin,
                spheres,
                colors,
                scalars,
                arrays: _,
                notes: _,
            }) => {
                let transform = self.transform(origin)?;
                for (i, sphere) in spheres.into_iter().enumerate() {
                    let material = i % self.materials.len();
                    self.add(Shape::Sphere(sphere), material, &transform, primitives)?;
                }
                let colors = colors.map(Attributes::Colors);
                let n = self.materials.len();
                let stored = |(i, number): (usize, f64)| self.stored(i % n, number);
                let scalars = scalars.map(|numbers| {
                    let numbered = numbers.into_iter().enumerate();
                    Attributes::Scalars(numbered.map(stored).collect())
                });
                return Ok(colors.or(scalars).unwrap_or_default());
            }
            ObjectGeometry::Tubes(tubes) => {
                let transform = self.transform(tubes.origin)?;
                for capsule in tubes.capsules() {
                    self.add(Shape::Capsule(capsule), 0, &transform, primitives)?;
                }
                let ends = tubes.scalars.map(|ends| {
                    let stored = |ends: [f64; 2]| ends.map(|number| self.stored(0, number));
                    Attributes::Ends(ends.into_iter().map(stored).collect())
                });
                return Ok(ends.unwrap_or_default());
            }
            ObjectGeometry::Mesh(mesh) => return self.add_mesh(*mesh, primitives, n_degenerate),
            // Instances are not primitives in render space: see `LowerLevel`.
            ObjectGeometry::Instances(_) => {}
        }
        Ok(Attributes::None)
    }

    /// Adds the mesh's triangles, except for degenerate ones.
    pub(super) fn add_mesh(
        &self,
        mut mesh: Mesh,
        primitives: &mut Vec<Primitive>,
        n_degenerate: &mut u64,
    ) -> Result<Attributes, Fault> {
        let n_before = primitives.len();
        let transform = self.transform(mesh.origin)?;
        let (normals, uvs) = (mesh.normals.take(), mesh.uvs.take());
        let (scalars, colors) = (mesh.scalars.take(), mesh.colors.take());
        let opacities = mesh.opacities.take();
        // Add the triangles that have an area.
        let mut kept = Vec::with_capacity(mesh.triangles.len());
        for &indices in &mesh.triangles {
            let primitive = self.primitive(Shape::Triangle(mesh.triangle(indices)), 0, &transform);
            if !primitive.is_in_range() {
                return Err(out_of_range(self.object, self.path));
            }
            let is_kept = !is_degenerate(&primitive);
            kept.push(is_kept);
            if is_kept {
                primitives.push(primitive);
            } else {
                *n_degenerate += 1;
            }
        }
        if primitives.len() == n_before {
            return Err(self.without_area(&mesh));
        }
        // Keep the attributes of these triangles that the materials need.
        let kept_corners = |triangles| placed_corners(only(triangles, &kept), &transform);
        Ok(Attributes::Corners(Box::new(CornerAttributes {
            normals: normals.map(|normals| CornerValues {
                values: world_normals(normals.values, &transform),
                triangles: kept_corners(normals.triangles),
            }),
            uvs: uvs.filter(|_| self.needs.uvs).map(|uvs| CornerValues {
                triangles: kept_corners(uvs.triangles),
                ..uvs
            }),
            scalars: scalars.map(|scalars| CornerValues {
                values: scalars
                    .values
                    .into_iter()
                    .map(|number| self.stored(0, number))
                    .collect(),
                triangles: kept_corners(scalars.triangles),
            }),
            colors: colors
                .filter(|_| self.needs.colors)
                .map(|colors| CornerValues {
                    triangles: kept_corners(colors.triangles),
                    ..colors
                }),
            opacities: opacities.map(|opacities| CornerValues {
                triangles: kept_corners(opacities.triangles),
                ..opacities
            }),
        })))
    }

    /// Creates the fault of a mesh whose triangles have no area: in the file, or beside a scene that
    /// is much larger.
    fn without_area(&self, mesh: &Mesh) -> Fault {
        let path = match self.object.geometry {
            Geometry::Instances(_) => self.path.clone().key(InstancedMesh::KEY),
            _ => self.path.clone(),
        };
        let path = path.key("mesh").key("file");
        let has_area = |&indices: &[u32; 3]| mesh.triangle(indices).normal().is_some();
        if !mesh.triangles.iter().any(has_area) {
            let message = "no triangle of the mesh has an area";
            let expected = "expected corners that are not on one line";
            return Fault::new(path, message, expected);
        }
        // The scene spans about one unit of render space.
        let corners = mesh.triangles.iter().flatten();
        let corners = corners.map(|&index| mesh.vertices[index as usize].as_dvec3());
        let placed = corners.map(|corner| self.render_from_object.transform_vector3(corner));
        let (min, max) = placed.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), at| {
            (min.min(at), max.max(at))
        });
        let size = (max - min).max_element();
        let message = format!(
            "the mesh is too small beside the rest of the scene: it has {size:.0e} of the scene's size"
        );
        Fault::new(path, message, "expected a size that shows in 7 digits")
            .with_help("bring the objects nearer together, or make the mesh larger")
    }

    /// Adds one primitive.
    fn add(
        &self,
        shape: Shape,
        material: usize,
        transform: &Transform,
        primitives: &mut Vec<Primitive>,
    ) -> Result<(), Fault> {
        let primitive = self.primitive(shape, material, transform);
        if !primitive.is_in_range() || !primitive.has_extent() {
            return Err(out_of_range(self.object, self.path));
        }
        primitives.push(primitive);
        Ok(())
    }

    fn primitive(&self, shape: Shape, material: usize, transform: &Transform) -> Primitive {
        let material = self.materials[material];
        Primitive::new(shape, Some(transform), self.id, material)
    }
}

/// Returns a mesh's normals as unit vectors in render space; NaN for a zero vector.
fn world_normals(mut vectors: Vec<Vec3>, transform: &Transform) -> Vec<Vec3> {
    for vector in &mut vectors {
        *vector = transform.world_normal(*vector);
    }
    vectors
}

/// Returns the triangles that are kept.
fn only(mut triangles: Vec<[u32; 3]>, kept: &[bool]) -> Vec<[u32; 3]> {
    let mut kept = kept.iter();
    triangles.retain(|_| kept.next().copied().unwrap_or(false));
    triangles
}

/// Orders the corners as those of the placed triangles, which a mirror reverses.
fn placed_corners(mut triangles: Vec<[u32; 3]>, transform: &Transform) -> Vec<[u32; 3]> {
    if transform.is_mirrored() {
        triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    triangles
}

/// Returns true if the primitive is a triangle without area.
fn is_degenerate(primitive: &Primitive) -> bool {
    let triangle = match primitive.world_shape() {
        Some(Shape::Triangle(triangle)) => Some(triangle),
        _ => None,
    };
    triangle.is_some_and(|triangle| triangle.normal().is_none())
}

/// Creates the fault of an object whose position or size exceeds the range of 32-bit numbers.
fn out_of_range(object: &Object, path: &FieldPath) -> Fault {
    let (key, help) = if object.transform.is_empty() {
        (
            object.geometry.to_string(),
            "make it larger, or bring it nearer to the origin",
        )
    } else {
        (
            "transform".to_owned(),
            "bring the `scale` factors nearer to 1, and the object nearer to the origin",
        )
    };
    Fault::new(
        path.clone().key(key),
        format!("`{path}` is too small, too large or too far away"),
        "expected coordinates within 1e16, and a size that shows in their 7 digits",
    )
    .with_help(help)
}
