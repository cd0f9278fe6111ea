//! Scattering of light at surfaces in path tracing: one file for each kind of material, with its
//! formulas for one point or for lanes of points of one material.

mod lobes;
mod medium;
mod metal;
mod particle;
mod principled;
mod tilted;
#[cfg(test)]
mod tests;

use glam::Vec3;

use crate::trace::ShadingPoint;
use lobes::Lobes;
use math::optics::{Albedo, Ggx};
use math::simd::{Real, Vector};
use medium::Medium;
use metal::Metal;
use particle::Particle;
use principled::PrincipledBsdf;
use world::material::{Material, MaterialKind};

/// Scattering of light at the surfaces of a material.
#[derive(Debug, Clone, Copy)]
pub(super) enum Bsdf<'a> {
    /// Opaque surfaces.
    Lobes(Lobes<'a>),
    Metal(Metal<'a>),
    Medium(Medium<'a>),
    Particle(Particle),
    Principled(PrincipledBsdf<'a>),
}

/// The formulas of one kind of [`Bsdf`], for a surface that is perpendicular to the shading normal;
/// [`tilted`] adapts them to the actual surface.
pub(super) trait Scatters: Copy {
    /// Returns true if light samples contribute.
    fn is_lit(&self) -> bool;

    /// Returns true if light samples from behind the surface contribute, too.
    fn is_lit_from_all_sides(&self) -> bool {
        false
    }

    /// Returns the scattering from a direction in front of the surface, or from any direction if it
    /// is lit from all sides; only of light that light samples contribute to. `boundary` is read
    /// only for media.
    fn evaluate<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        to_light: Vector<R>,
    ) -> Scattering<R>;

    /// Chooses a direction: two numbers in [0, 1) choose it, a third one chooses among the ways in
    /// which the surface scatters. `boundary` is read only for media.
    fn sample<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        numbers: [R; 2],
        lobe: R,
    ) -> Scattered<R>;
}

/// Calls the function with the variant of a [`Bsdf`]: one copy of the code for each kind.
macro_rules! by_kind {
    ($bsdf:expr, |$kind:ident| $call:expr) => {
        match $bsdf {
            $crate::shade::bsdf::Bsdf::Lobes($kind) => $call,
            $crate::shade::bsdf::Bsdf::Metal($kind) => $call,
            $crate::shade::bsdf::Bsdf::Medium($kind) => $call,
            $crate::shade::bsdf::Bsdf::Particle($kind) => $call,
            $crate::shade::bsdf::Bsdf::Principled($kind) => $call,
        }
    };
}
pub(super) use by_kind;
pub(super) use tilted::{evaluate, sample};

/// A point that light leaves toward a viewer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaving<R> {
    pub(super) point: ShadingPoint<R>,
    /// The direction of the ray from the viewer.
    arriving: Vector<R>,
    /// The unit vector to the viewer, on the side of the shading normal.
    to_viewer: Vector<R>,
    /// The x and y axes of the surface's space, whose z axis is the shading normal.
    axes: [Vector<R>; 2],
}

/// Scattering from one direction to the viewer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scattering<R> {
    /// The light that arrives at the viewer, from white light of radiance 1 within one steradian,
    /// times pi.
    pub(super) value: Vector<R>,
    /// The density with which [`Bsdf::sample`] chooses the direction, per steradian.
    pub(super) density: R,
}

/// A direction from which light is scattered to the viewer, chosen at random.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scattered<R: Real> {
    /// The unit vector to the light.
    pub(super) direction: Vector<R>,
    /// The share of the light from this direction, over the density of the choice; zero ends the
    /// path.
    pub(super) factor: Vector<R>,
    /// The density of the choice; infinite if no light sample can have the direction.
    pub(super) density: R,
    /// True if the light is refracted.
    pub(super) is_refracted: R::Mask,
    /// True if the light is scattered diffusely.
    pub(super) is_diffuse: R::Mask,
}

/// The surface of a medium, as a ray meets it, or one per lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boundary<R: Real> {
    /// Ratio of the indices of refraction, before the surface over behind it.
    pub(super) eta: R,
    /// True if the effective medium changes.
    pub(super) is_visible: R::Mask,
}

impl<'a> Bsdf<'a> {
    /// Returns the scattering of surfaces of this material.
    #[inline]
    pub(super) fn new(material: &'a Material) -> Self {
        let rough = material.rough.as_deref();
        match (&material.kind, rough) {
            (MaterialKind::Opaque { reflection }, _) => {
                Self::Lobes(Lobes::new(material, *reflection))
            }
            (MaterialKind::Dielectric { .. }, _) => Self::Medium(Medium::new(rough)),
            (MaterialKind::Conductor { metal, .. }, _) => Self::Metal(Metal::new(metal, rough)),
            (MaterialKind::Principled { surface, .. }, Some(rough)) => {
                Self::Principled(PrincipledBsdf::new(surface, rough))
            }
            (MaterialKind::Principled { .. }, None) => {
                unreachable!("principled surfaces have facets in path tracing")
            }
            (&MaterialKind::Particles(phase), _) => Self::Particle(Particle { phase }),
        }
    }
}

impl<R: Real> Boundary<R> {
    /// Returns the boundary of a surface without a medium.
    #[inline(always)]
    pub(super) fn without_medium(like: R) -> Self {
        let one = like.splat(1.0);
        Self {
            eta: one,
            is_visible: one.splat_mask(true),
        }
    }
}

impl<R: Real> Leaving<R> {
    #[inline(always)]
    pub(super) fn new(point: ShadingPoint<R>, to_viewer: Vector<R>) -> Self {
        Self {
            point,
            arriving: -to_viewer,
            to_viewer: to_viewer.folded(point.normal),
            axes: point.normal.orthonormal_pair(),
        }
    }

    /// Transforms a direction into the space of the surface.
    #[inline(always)]
    fn in_surface(&self, direction: Vector<R>) -> Vector<R> {
        let [u, v] = self.axes;
        Vector {
            x: direction.dot(u),
            y: direction.dot(v),
            z: direction.dot(self.point.normal),
        }
    }

    /// Transforms a direction from the space of the surface into world space.
    #[inline(always)]
    fn in_world(&self, Vector { x, y, z }: Vector<R>) -> Vector<R> {
        let [u, v] = self.axes;
        (u * x + v * y + self.point.normal * z).normalize()
    }

    /// Returns the cosine of the angle between the normal and the direction to the viewer.
    #[inline(always)]
    fn cos_of_viewer(&self) -> R {
        let cos = self.to_viewer.dot(self.point.normal);
        cos.max(cos.splat(0.0)).min(cos.splat(1.0))
    }

    /// Returns the factor of the light that comes from the first facets, of a color, which adds the
    /// light reflected from facet to facet.
    #[inline(always)]
    fn gain(&self, albedo: Option<&Albedo>, color: Vector<R>) -> Vector<R> {
        match albedo {
            None => Vector::splat(color.x, Vec3::ONE),
            Some(albedo) => {
                let [all, _] = albedo.at(self.cos_of_viewer());
                gain(all, color)
            }
        }
    }

    /// Returns the direction from which one of the facets that the viewer sees mirrors light; two
    /// numbers choose the facet.
    #[inline(always)]
    fn mirrored_by(&self, facets: Ggx<R>, numbers: [R; 2]) -> Vector<R> {
        let facet = facets.facet(self.in_surface(self.to_viewer), numbers);
        let normal = self.in_world(facet);
        (-self.to_viewer).reflect(normal).normalize()
    }

    /// Returns light reflected from a direction with this scattering; none from behind the plane of
    /// the shading normal, where the scattering may be NaN: a facet that is seen edge-on mirrors
    /// light that goes straight on.
    #[inline(always)]
    fn reflected(&self, direction: Vector<R>, scattering: Scattering<R>) -> Scattered<R> {
        let Scattering { value, density } = scattering;
        let (zero, least) = (density.splat(0.0), density.splat(f32::MIN_POSITIVE));
        let is_in_front = zero.lt(direction.dot(self.point.normal)) & least.lt(density);
        let over_density = density.splat(std::f32::consts::FRAC_1_PI) / density.max(least);
        let none = Vector::splat(zero, Vec3::ZERO);
        Scattered {
            direction,
            factor: Vector::select(is_in_front, value * over_density, none),
            density: R::select(is_in_front, density, zero),
            is_refracted: zero.splat_mask(false),
            is_diffuse: zero.splat_mask(false),
        }
    }
}

/// Returns the factor of the light that comes from the first facets, of a color, if white facets
/// return this share of it.
#[inline(always)]
fn gain<R: Real>(returned: R, color: Vector<R>) -> Vector<R> {
    let one = returned.splat(1.0);
    Vector::splat(one, Vec3::ONE) + color * ((one - returned) / returned)
}

impl<R: Real> Scattered<R> {
    /// Returns `this` where `mask` is true, else `other`.
    #[inline(always)]
    fn select(mask: R::Mask, this: Self, other: Self) -> Self {
        Self {
            direction: Vector::select(mask, this.direction, other.direction),
            factor: Vector::select(mask, this.factor, other.factor),
            density: R::select(mask, this.density, other.density),
            is_refracted: this.is_refracted & mask | other.is_refracted & !mask,
            is_diffuse: this.is_diffuse & mask | other.is_diffuse & !mask,
        }
    }
}

impl<R: Real> Scattering<R> {
    /// Returns `this` where `mask` is true, else `other`.
    #[inline(always)]
    fn select(mask: R::Mask, this: Self, other: Self) -> Self {
        Self {
            value: Vector::select(mask, this.value, other.value),
            density: R::select(mask, this.density, other.density),
        }
    }

    #[inline(always)]
    fn none(like: R) -> Self {
        let zero = like.splat(0.0);
        Self {
            value: Vector::splat(zero, Vec3::ZERO),
            density: zero,
        }
    }

    /// Returns the scattering times a factor.
    #[inline(always)]
    fn scaled(self, factor: R) -> Self {
        Self {
            value: self.value * factor,
            density: self.density * factor,
        }
    }

    /// Returns the sum, where each part is chosen with the probability included in its density.
    #[inline(always)]
    fn with(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            density: self.density + other.density,
        }
    }
}
