//! Primitives: what rays hit.

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

/// A shape in world space, its object and its material.
#[derive(Debug, Clone, PartialEq)]
pub struct Primitive {
    shape: Shape,
    /// The transform of a shape whose image in world space is a shape of no known
    /// kind: an ellipsoid, a rotated box.
    placement: Option<Box<Transform>>,
    /// Its object.
    pub object: ObjectId,
    /// Its material.
    pub material: MaterialId,
}

impl Primitive {
    /// A shape under a transform, if it has one.
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

    /// Its shape in world space; `None` if it needs a transform.
    #[inline]
    pub fn world_shape(&self) -> Option<&Shape> {
        self.placement.is_none().then_some(&self.shape)
    }

    /// The kind of its shape in world space; `None` if it needs a transform.
    #[inline]
    pub fn kind(&self) -> Option<ShapeKind> {
        match self.placement {
            None => Some(self.shape.kind()),
            Some(_) => None,
        }
    }

    /// The numbers that define its shape, followed by zeros.
    #[inline(always)]
    pub fn parameters(&self) -> [f32; N_PARAMETERS] {
        self.shape.parameters()
    }

    /// The least `t` in (0, `t_max`) at which the ray hits it.
    #[inline]
    pub fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        match &self.placement {
            None => self.shape.intersect(ray, t_max),
            Some(placement) => self.shape.intersect(&placement.object_ray(ray), t_max),
        }
    }

    /// The point of its surface nearest to `near`, which lies on it up to rounding
    /// errors, and the outward unit normal there.
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

    /// A bound of the distance between its surface and a point of it that
    /// [`project`](Self::project) found.
    #[inline]
    pub fn rounding(&self, point: Vec3) -> f32 {
        let Some(placement) = &self.placement else {
            let parameters = self.shape.parameters();
            return self.shape.kind().rounding(&parameters, point.into());
        };
        let bounds = placement.world_bounds(&self.shape.bounds());
        let (min, max) = (bounds.min, bounds.max);
        rounding_of(&[min.x, min.y, min.z, max.x, max.y, max.z])
    }

    /// A point of world space in the space of its [`parameters`](Self::parameters).
    pub(super) fn object_point(&self, point: Vec3) -> Vec3 {
        match &self.placement {
            None => point,
            Some(placement) => placement.object_point(point),
        }
    }

    /// The smallest known box around it; [`Aabb::ALL`] for a plane.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        match &self.placement {
            None => self.shape.bounds(),
            Some(placement) => placement.world_bounds(&self.shape.bounds()),
        }
    }

    /// The cell that a viewer draws for it, in world space; `None` for a plane.
    pub fn patch(&self) -> Option<Patch> {
        let patch = self.shape.patch()?;
        Some(match &self.placement {
            None => patch,
            Some(placement) => patch.transformed(placement),
        })
    }

    /// Whether it has no bounds.
    #[inline]
    pub fn is_unbounded(&self) -> bool {
        self.shape.bounds() == Aabb::ALL
    }

    /// Whether its coordinates in world space are in the range of the arithmetic.
    pub(super) fn is_in_range(&self) -> bool {
        if self.is_unbounded() {
            return self.project(Vec3::ZERO).0.is_finite();
        }
        let bounds = self.bounds();
        bounds.min.abs().max(bounds.max.abs()).max_element() <= 1e16
    }

    /// Whether it has an extent in world space.
    pub(super) fn has_extent(&self) -> bool {
        let bounds = self.bounds();
        (bounds.max - bounds.min).max_element() > 1e-16
    }
}
