//! Surfaces that emit light.

use std::f32::consts::FRAC_1_PI;
use std::f64::consts::PI;

use super::primitive::MaterialId;
use crate::geometry::{Aabb, N_PARAMETERS, Seen, ShapeKind};
use crate::light::{Illumination, LitPoint};
use crate::material::Material;
use math::sampling::AliasTable;
use math::simd::{Real, Vector};

/// All shapes of one kind and one emissive material, as one light: points are uniform on their
/// total surface.
#[derive(Debug, Clone)]
pub struct Emitter {
    /// The material.
    pub material: MaterialId,
    /// The kind of the shapes.
    pub kind: ShapeKind,
    radiance: glam::Vec3,
    is_two_sided: bool,
    shapes: Vec<[f32; N_PARAMETERS]>,
    /// The shapes, sampled by area.
    by_area: AliasTable,
    /// The sum of the areas.
    area: f32,
    /// The center of a sphere around the shapes.
    center: glam::Vec3,
    /// The square of the sphere's radius.
    square_radius: f32,
    /// The luminance of a white surface that faces the shapes at a distance of 1, averaged over all
    /// directions from them.
    intensity: f32,
}

impl Emitter {
    /// Creates the light of shapes of a material; `None` if they cannot be sampled, because their
    /// area is not finite, or they are too many.
    pub(super) fn new(
        id: MaterialId,
        material: &Material,
        kind: ShapeKind,
        shapes: Vec<[f32; N_PARAMETERS]>,
        bounds: Aabb,
    ) -> Option<Self> {
        let area = |shape: &[f32; N_PARAMETERS]| f64::from(kind.area(shape));
        let areas: Vec<f64> = shapes.iter().map(area).collect();
        let area = areas.iter().sum::<f64>() as f32;
        // The visible share of the area, averaged over all directions.
        let share = match kind {
            ShapeKind::Sphere | ShapeKind::Cuboid => 0.25,
            _ if material.two_sided => 0.5,
            _ => 0.25,
        };
        Some(Self {
            material: id,
            kind,
            radiance: material.emission,
            is_two_sided: material.two_sided,
            by_area: AliasTable::new(&areas)?,
            area,
            shapes,
            center: bounds.center(),
            square_radius: 0.25 * (bounds.max - bounds.min).length_squared(),
            intensity: share * FRAC_1_PI * area * luminance(material.emission),
        })
    }

    /// Returns the number of shapes.
    pub(super) fn n_shapes(&self) -> usize {
        self.shapes.len()
    }

    /// Returns the light that arrives at a point from a sampled point of a shape, unless it is
    /// occluded; two numbers in [0, 1) select the shape, two more the point.
    #[inline(always)]
    pub(super) fn illuminate<R: Real>(
        &self,
        at: &LitPoint<R>,
        which: [R; 2],
        numbers: [R; 2],
    ) -> Illumination<R> {
        let shape = R::look_up(&self.shapes[..], [self.by_area.choose(which)]);
        let sample = self.kind.sample(&shape, at.position, numbers);
        let density = sample.density * self.share(&shape);
        let (zero, least) = (density.splat(0.0), density.splat(f32::MIN_POSITIVE));
        let weight = density.splat(FRAC_1_PI) / density.max(least);
        // Aim at the light from the origin of the shadow ray, which is off the point's surface: the
        // error of the point would move the ray's end across the light.
        let seen = sample.seen;
        let at_light = at.position + seen.direction * seen.distance;
        let aim = at_light - at.origin(seen.direction);
        let distance = aim.length().max(least);
        // A ray that ended on the surface itself would often hit it. It ends short of the plane by
        // the errors of the surface and of the ray.
        let on_way = distance * distance.splat(16.0 / 16_777_216.0);
        let errors = self.kind.rounding(&shape, at_light) + on_way;
        let gap = errors / seen.cos.abs().max(least);
        let is_front = zero.lt(seen.cos);
        let weight = if self.is_two_sided {
            weight
        } else {
            R::select(is_front, weight, zero)
        };
        Illumination {
            direction: aim / distance,
            distance: (distance - gap).max(zero),
            radiance: Vector::splat(zero, self.radiance) * weight,
            density,
        }
    }

    /// Returns the probability density of a direction to one of the shapes from the point `from`.
    #[inline(always)]
    pub fn density<R: Real>(
        &self,
        shape: &[R; N_PARAMETERS],
        from: Vector<R>,
        seen: &Seen<R>,
    ) -> R {
        self.kind.density(shape, from, seen) * self.share(shape)
    }

    /// Returns the probability of a shape.
    #[inline(always)]
    fn share<R: Real>(&self, shape: &[R; N_PARAMETERS]) -> R {
        let area = self.kind.area(shape);
        area / area.splat(self.area)
    }

    /// Returns an estimate of the luminance of a white surface at this point that faces the shapes.
    #[inline(always)]
    pub(super) fn arrival<R: Real>(&self, point: Vector<R>) -> R {
        let to_center = Vector::splat(point.x, self.center) - point;
        let square = to_center.dot(to_center);
        point.x.splat(self.intensity) / square.max(square.splat(self.square_radius))
    }

    /// Returns the emitted power.
    pub(super) fn power(&self) -> f64 {
        let sides = if self.is_two_sided { 2.0 } else { 1.0 };
        sides * PI * f64::from(self.area) * f64::from(luminance(self.radiance))
    }
}

/// Returns the luminance of linear light with the primaries of sRGB (ITU-R BT.709).
pub(super) fn luminance(color: glam::Vec3) -> f32 {
    luminance_of_lanes(color.into())
}

/// Returns the [`luminance`] per lane.
#[inline(always)]
pub(super) fn luminance_of_lanes<R: Real>(color: Vector<R>) -> R {
    color.dot(Vector::splat(
        color.x,
        glam::Vec3::new(0.2126, 0.7152, 0.0722),
    ))
}
