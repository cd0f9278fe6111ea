//! Points of surfaces that rays have hit.

use glam::Vec3;

use math::simd::{Real, Vector};
use world::camera::RayCone;
use world::geometry::Ray;
use world::light::LitPoint;
use world::material::PictureFactors;
use world::scene::{InstanceId, MaterialId, ObjectId, PlacedPrimitive, Scene};

/// A point of a surface that a ray has hit, in render space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point, projected onto the surface to remove the rounding error.
    pub position: Vec3,
    /// The shading normal, a unit vector on the same side as the geometric normal.
    pub normal: Vec3,
    /// The geometric normal, a unit vector on the side from which the ray came: it distinguishes
    /// the sides of the surface.
    pub geometric_normal: Vec3,
    /// The color of the surface at the point.
    pub color: Vec3,
    /// Distance along the ray, greater than 0.
    pub distance: f32,
    /// A bound of the distance of `position` from the surface.
    pub error: f32,
    /// The object that was hit.
    pub object: ObjectId,
    /// The material of the surface.
    pub material: MaterialId,
    /// The primitive that was hit.
    pub primitive: u32,
    /// The instance that the primitive belongs to, if any.
    pub instance: Option<InstanceId>,
    /// True if both normals are opposite to the surface's outward normals, because the ray came
    /// from the other side.
    pub is_flipped: bool,
    /// The factors of the material's textures at the point.
    pub factors: PictureFactors<f32>,
    /// The share of light that the surface meets; 1 where rays hit it or pass it by chance.
    pub opacity: f32,
}

/// The part of a surface point, or of one per lane, that shading reads.
#[derive(Debug, Clone, Copy)]
pub struct ShadingPoint<R> {
    /// The point, on the surface.
    pub position: Vector<R>,
    /// The shading normal.
    pub normal: Vector<R>,
    /// The geometric normal.
    pub geometric_normal: Vector<R>,
    /// The color of the surface.
    pub color: Vector<R>,
    /// A bound of the distance of the position from the surface.
    pub error: R,
    /// -1 where both normals are opposite to the surface's outward normals, else 1.
    pub side: R,
    /// The factors of the material's textures at the point.
    pub factors: PictureFactors<R>,
}

impl SurfacePoint {
    /// Returns the particle of the scene's fog that a ray meets at a distance. It has no normals.
    pub fn fog_particle(scene: &Scene, ray: &Ray, distance: f32) -> Self {
        let color = scene.fog.map_or(Vec3::ZERO, |fog| fog.color);
        Self {
            position: ray.at(distance),
            normal: Vec3::ZERO,
            geometric_normal: Vec3::ZERO,
            color,
            distance,
            error: 0.0,
            object: ObjectId(0),
            material: scene.class(scene.particles()).material(),
            primitive: scene.particles(),
            instance: None,
            is_flipped: false,
            factors: PictureFactors::ones(0.0),
            opacity: 1.0,
        }
    }

    /// Returns the primitive that was hit.
    pub fn placed(&self) -> PlacedPrimitive {
        PlacedPrimitive {
            primitive: self.primitive,
            instance: self.instance,
        }
    }

    /// Returns the part that shading reads.
    #[inline(always)]
    pub fn shading(&self) -> ShadingPoint<f32> {
        ShadingPoint {
            position: self.position.into(),
            normal: self.normal.into(),
            geometric_normal: self.geometric_normal.into(),
            color: self.color.into(),
            error: self.error,
            side: if self.is_flipped { -1.0 } else { 1.0 },
            factors: self.factors,
        }
    }

    /// Calls [`ShadingPoint::is_faced_by`].
    pub fn is_faced_by(&self, direction: Vec3) -> bool {
        self.shading().is_faced_by(direction.into())
    }

    /// Calls [`ShadingPoint::mirrored`].
    pub fn mirrored(&self, direction: Vec3) -> Vec3 {
        self.shading().mirrored(direction.into()).into()
    }
}

impl<R: Real> ShadingPoint<R> {
    /// Returns the origin of a ray in a direction that does not hit the surface again.
    #[inline(always)]
    pub fn origin(&self, direction: Vector<R>) -> Vector<R> {
        self.lit().origin(direction)
    }

    /// Returns the part that lights read.
    #[inline(always)]
    pub fn lit(&self) -> LitPoint<R> {
        LitPoint {
            position: self.position,
            normal: self.normal,
            geometric_normal: self.geometric_normal,
            error: self.error,
        }
    }

    /// Returns the surface's outward normal for one of the point's normals, whichever side the ray
    /// came from.
    #[inline(always)]
    pub fn outward(&self, normal: Vector<R>) -> Vector<R> {
        normal.flip_sign_by(self.side)
    }

    /// Returns true if a direction points away from the visible side of the surface, by both
    /// normals.
    #[inline(always)]
    pub fn is_faced_by(&self, direction: Vector<R>) -> R::Mask {
        let zero = self.side.splat(0.0);
        zero.lt(self.normal.dot(direction)) & zero.lt(self.geometric_normal.dot(direction))
    }

    /// Returns true if a direction points away from the hidden side of the surface, by both
    /// normals.
    #[inline(always)]
    pub fn is_backed_by(&self, direction: Vector<R>) -> R::Mask {
        let zero = self.side.splat(0.0);
        self.normal.dot(direction).lt(zero) & self.geometric_normal.dot(direction).lt(zero)
    }

    /// Returns the mirror direction of an incoming direction, a unit vector. Mirrors by the shading
    /// normal unless the direction comes from behind it, then by the geometric normal if the result
    /// points into the surface.
    #[inline(always)]
    pub fn mirrored(&self, direction: Vector<R>) -> Vector<R> {
        let mirrored = direction.folded(self.normal).normalize();
        mirrored.folded(self.geometric_normal)
    }
}

/// Returns the width of the part of a surface that a ray covers, at a distance from the camera
/// along the path.
#[inline(always)]
pub(super) fn width<R: Real>(
    cone: RayCone,
    distance: R,
    geometric_normal: Vector<R>,
    direction: Vector<R>,
) -> R {
    cone.width_at(distance) / geometric_normal.dot(direction).abs()
}

/// Returns the side from which rays in `direction` hit surfaces with this outward normal: -1 from
/// behind, else 1.
#[inline(always)]
pub(super) fn side<R: Real>(outward: Vector<R>, direction: Vector<R>) -> R {
    let cos = outward.dot(direction);
    let one = cos.splat(1.0);
    R::select(cos.splat(0.0).lt(cos), -one, one)
}

/// Returns a shading normal flipped to the side of the geometric normal.
#[inline(always)]
pub(super) fn on_side_of<R: Real>(geometric: Vector<R>, normal: Vector<R>) -> Vector<R> {
    let cos = normal.dot(geometric);
    let one = cos.splat(1.0);
    normal.flip_sign_by(R::select(cos.lt(cos.splat(0.0)), -one, one))
}
