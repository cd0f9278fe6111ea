//! Primitives: the shapes that rays hit.

use glam::Vec3;

use crate::geometry::{
    Aabb, Intersectable, N_PARAMETERS, Patch, Ray, Shape, ShapeKind, Transform, rounding_of,
};

/// The index of an object in the file's `objects`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ObjectId(pub u32);

/// The index of a material in the file's `materials`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MaterialId(pub u32);

/// A shape in render space, its object and its material.
#[derive(Debug, Clone, PartialEq)]
pub struct Primitive {
    shape: Shape,
    /// The transform of a shape whose image in render space is not one of the shapes: an ellipsoid,
    /// a rotated box.
    placement: Option<Box<Transform>>,
    /// The object.
    pub object: ObjectId,
    /// The material.
    pub material: MaterialId,
}

impl Primitive {
    /// Creates a primitive, with a transform if the shape needs one.
    pub fn new(
        shape: Shape,
        transform: Option<&Transform>,
        object: ObjectId,
        material: MaterialId,
    ) -> Self {
        let (shape, placement) = match transform.map(|t| (t, shape.transformed(t))) {
            None => (shape, None),
            Some((_, Some(in_world))) => (in_world, None),
            Some((transform, None)) => (shape, Some(Box::new(*transform))),
        };
        Self {
            shape,
            placement,
            object,
            material,
        }
    }

    /// Returns the shape in render space; `None` if it needs a transform.
    #[inline]
    pub fn world_shape(&self) -> Option<&Shape> {
        self.placement.is_none().then_some(&self.shape)
    }

    /// Returns the kind of the shape in render space; `None` if it needs a transform.
    #[inline]
    pub fn kind(&self) -> Option<ShapeKind> {
        match self.placement {
            None => Some(self.shape.kind()),
            Some(_) => None,
        }
    }

    /// Returns the kind of the shape, in render space or before its transform.
    pub fn shape_kind(&self) -> ShapeKind {
        self.shape.kind()
    }

    /// Returns the map from the space of the [`parameters`](Self::parameters) to render space and
    /// back; `None` if these are in render space.
    pub fn placement(&self) -> Option<&Transform> {
        self.placement.as_deref()
    }

    /// Returns the parameters that define the shape, padded with zeros.
    #[inline(always)]
    pub fn parameters(&self) -> [f32; N_PARAMETERS] {
        self.shape.parameters()
    }

    /// Returns the least `t` in (0, `t_max`) at which the ray hits the primitive.
    #[inline]
    pub fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        match &self.placement {
            None => self.shape.intersect(ray, t_max),
            Some(placement) => self.shape.intersect(&placement.object_ray(ray), t_max),
        }
    }

    /// Returns the point of the surface nearest to `near`, which lies on it up to rounding errors,
    /// and the outward unit normal there.
    #[inline]
    pub fn project(&self, near: Vec3) -> (Vec3, Vec3) {
        match &self.placement {
            None => self.shape.project(near),
            Some(placement) => {
                let (point, normal) = self.shape.project(placement.object_point(near));
                (placement.world_point(point), placement.world_normal(normal))
            }
        }
    }

    /// Returns a bound of the distance between the surface and a point that
    /// [`project`](Self::project) found on it, given with its normal.
    #[inline]
    pub fn rounding(&self, at: [Vec3; 2]) -> f32 {
        let Some(placement) = &self.placement else {
            let parameters = self.shape.parameters();
            return self
                .shape
                .kind()
                .rounding_along(&parameters, at.map(Into::into));
        };
        let bounds = placement.world_bounds(&self.shape.bounds());
        let (min, max) = (bounds.min, bounds.max);
        rounding_of(&[min.x, min.y, min.z, max.x, max.y, max.z])
    }

    /// Converts a point from render space to the space of the [`parameters`](Self::parameters).
    pub(super) fn object_point(&self, point: Vec3) -> Vec3 {
        match &self.placement {
            None => point,
            Some(placement) => placement.object_point(point),
        }
    }

    /// Returns the smallest known bounding box; [`Aabb::ALL`] for a plane.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        match &self.placement {
            None => self.shape.bounds(),
            Some(placement) => placement.world_bounds(&self.shape.bounds()),
        }
    }

    /// Returns the cell that a viewer draws for the primitive, in render space; `None` for a plane.
    pub fn patch(&self) -> Option<Patch> {
        let patch = self.shape.patch()?;
        Some(match &self.placement {
            None => patch,
            Some(placement) => patch.transformed(placement),
        })
    }

    /// Returns true if it is unbounded.
    #[inline]
    pub fn is_unbounded(&self) -> bool {
        self.shape.bounds() == Aabb::ALL
    }

    /// Returns true if its coordinates in render space are within the range of the arithmetic.
    pub fn is_in_range(&self) -> bool {
        if self.is_unbounded() {
            return self.project(Vec3::ZERO).0.is_finite();
        }
        self.bounds().largest() <= 1e16
    }

    /// Returns true if it has an extent in render space.
    pub fn has_extent(&self) -> bool {
        let bounds = self.bounds();
        (bounds.max - bounds.min).max_element() > 1e-16
    }
}
